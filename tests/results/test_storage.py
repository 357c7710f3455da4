"""One file for one run: read back equal, whole or not at all, and refused with a sentence when it is not right."""

import dataclasses
import os
import random
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray

from helpers import unmeasured
from sentences import printed_sentence, rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.results.groups import FORMAT_VERSION
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results, results_bytes, save_results
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def response() -> ForcedResponse:
    return dataclasses.replace(
        synthetic_response(columns=4, rows=3, n_points=20), warnings=("harmonic 3 holds 2 % of the energy",)
    )


def changed_pairs(response: ForcedResponse, **constants: Any) -> ContactPairs:
    """The pairs of a response with other constants of their Coulomb law."""
    return ContactPairs.with_laws(response.pairs.operator, [dataclasses.replace(response.pairs.coulomb, **constants)])


@pytest.fixture(scope="module")
def stored(response: ForcedResponse) -> bytes:
    return results_bytes(response, synthetic_study(4, 3))


@pytest.fixture
def saved(stored: bytes, tmp_path: Path) -> Path:
    (tmp_path / "results.nc").write_bytes(stored)
    return tmp_path / "results.nc"


@pytest.mark.slow
def test_response_and_study_come_back_equal(response: ForcedResponse, saved: Path) -> None:
    again = load_results(saved)
    assert again.response == response
    assert again.study == synthetic_study(4, 3)
    assert os.listdir(saved.parent) == ["results.nc"]


@pytest.mark.slow
def test_a_file_without_a_rough_face_is_read(response: ForcedResponse, tmp_path: Path) -> None:
    """Files of runs before the picture was kept, cases of sweeps, and studies without roughness have none."""
    study = dataclasses.replace(synthetic_study(4, 3), rough_patch=None)
    save_results(tmp_path / "plain.nc", response, study)
    with h5netcdf.File(tmp_path / "plain.nc", "r") as file:
        assert not [name for name in file["study"].variables if name.startswith("rough")]
    assert load_results(tmp_path / "plain.nc").study == study != synthetic_study(4, 3)


@pytest.mark.slow
def test_response_alone_and_anisotropic_pairs(response: ForcedResponse, tmp_path: Path) -> None:
    springs = np.column_stack([response.pairs.tangential_stiffness, 0.9 * response.pairs.tangential_stiffness])
    changed = dataclasses.replace(
        response,
        pairs=changed_pairs(response, tangential_stiffness=springs),
        converged=False,
        message="stopped at 420 Hz – “fold”",
    )
    changed.save(tmp_path / "a.nc")
    assert ForcedResponse.load(tmp_path / "a.nc") == changed
    assert load_results(tmp_path / "a.nc").study is None


@pytest.mark.slow
def test_residual_tractions_come_back(response: ForcedResponse, tmp_path: Path) -> None:
    traction = 0.5 * response.pairs.friction_coefficient[:, None] * response.pairs.normal_load[:, None] * [[0.6, -0.8]]
    changed = dataclasses.replace(response, pairs=changed_pairs(response, residual_traction=traction))
    changed.save(tmp_path / "kept.nc")
    again = ForcedResponse.load(tmp_path / "kept.nc")
    assert again == changed
    assert again.pairs.residual_traction is not None


@pytest.mark.slow
def test_long_study_file_survives(response: ForcedResponse, tmp_path: Path) -> None:
    study = dataclasses.replace(synthetic_study(4, 3), inputs="# line of the study file\n" * 8000)
    save_results(tmp_path / "long.nc", response, study)
    assert load_results(tmp_path / "long.nc").study == study


@pytest.mark.slow
def test_file_is_labelled_for_other_readers(response: ForcedResponse, saved: Path) -> None:
    with xarray.open_dataset(saved, engine="h5netcdf") as root:
        assert root.attrs["stickslip_format"] == FORMAT_VERSION
        assert root["displacement_cosine"].dims == ("point", "unknown", "harmonic")
        assert root["displacement_sine"].attrs["units"] == "m"
        assert root["frequency"].attrs["units"] == "Hz"
        np.testing.assert_array_equal(root["displacement_sine"].values, response.displacement[:, :, 2::2])
        for name, variable in root.variables.items():
            assert variable.attrs["long_name"], name
            assert variable.dtype.kind in "fiUO", f"{name} is {variable.dtype}: complex breaks other readers"


def test_missing_file(tmp_path: Path) -> None:
    with rejects(ResultsFileError):
        load_results(tmp_path / "none.nc")


def test_file_that_is_not_netcdf(tmp_path: Path) -> None:
    path = tmp_path / "text.nc"
    path.write_text("frequency,amplitude\n")
    with rejects(ResultsFileError):
        load_results(path)


def test_netcdf_of_another_program(tmp_path: Path) -> None:
    with h5netcdf.File(tmp_path / "other.nc", "w") as file:
        file.dimensions = {"x": 3}
    with rejects(ResultsFileError):
        load_results(tmp_path / "other.nc")


@pytest.mark.slow
def test_file_of_another_version(saved: Path) -> None:
    with h5py.File(saved, "r+") as file:
        file.attrs["stickslip_format"] = FORMAT_VERSION + 1
    with rejects(ResultsFileError):
        load_results(saved)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.9, 0.999])
def test_truncated_file(saved: Path, share: float) -> None:
    whole = saved.read_bytes()
    saved.write_bytes(whole[: int(share * len(whole))])
    with rejects(ResultsFileError):
        load_results(saved)


def test_flipped_bits_in_the_data_are_noticed(saved: Path) -> None:
    with h5py.File(saved) as file:
        chunk = file["displacement_cosine"].id.get_chunk_info(0)
    data = bytearray(saved.read_bytes())
    data[chunk.byte_offset + chunk.size // 2] ^= 0x10
    saved.write_bytes(data)
    with rejects(ResultsFileError):
        load_results(saved)


def test_missing_variable_is_damage(saved: Path) -> None:
    with h5py.File(saved, "r+") as file:
        del file["message"]
    with rejects(ResultsFileError):
        load_results(saved)


@pytest.mark.slow
def test_failed_save_leaves_the_old_file_and_no_other(
    response: ForcedResponse, saved: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = saved.read_bytes()

    def full(*_: object, **__: object) -> NoReturn:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with rejects(ResultsFileError):
        save_results(saved, response)
    assert saved.read_bytes() == before
    assert os.listdir(saved.parent) == ["results.nc"]


@pytest.mark.long
@pytest.mark.skipif(os.name != "posix", reason="limits of files are of POSIX systems")
def test_a_full_disk_is_a_sentence_and_no_fault_of_hdf5(tmp_path: Path) -> None:
    """HDF5 ended the process with a segmentation fault where a file could not grow."""
    code = """
import resource, sys
from pathlib import Path
from stickslip.results.storage import save_results
from synthetic import synthetic_response, synthetic_study
response, study = synthetic_response(), synthetic_study()
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
save_results(Path(sys.argv[1]) / "results.nc", response, study)
"""
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)],
        capture_output=True,
        text=True,
        check=False,
        env={**unmeasured(), "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path])},
    )
    assert done.returncode == 1
    (error,) = re.findall(r"ResultsFileError: (.*)", done.stderr)
    printed_sentence(error, "results.nc")
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="only Linux has a file that no disk can read")
def test_a_disk_that_fails_while_it_is_read_is_reported(tmp_path: Path) -> None:
    (tmp_path / "results.nc").symlink_to("/proc/self/mem")
    with rejects(ResultsFileError):
        load_results(tmp_path / "results.nc")


def test_folder_that_does_not_exist(response: ForcedResponse, tmp_path: Path) -> None:
    with rejects(ResultsFileError):
        save_results(tmp_path / "none" / "results.nc", response)


def test_study_of_another_run_is_rejected(response: ForcedResponse, tmp_path: Path) -> None:
    with rejects(InputError):
        save_results(tmp_path / "results.nc", response, synthetic_study(11, 5))


@pytest.mark.slow
def test_a_changed_letter_of_a_text_is_noticed(response: ForcedResponse, tmp_path: Path) -> None:
    """The message of the solver is a text of the file; HDF5 has checksums for arrays only."""
    path = tmp_path / "results.nc"
    save_results(path, response)
    content, message = path.read_bytes(), response.message.encode()
    assert content.count(message) == 1
    path.write_bytes(content.replace(message, message[:-1] + bytes([message[-1] ^ 1])))
    with rejects(ResultsFileError):
        load_results(path)


ABSURD = {
    "array": np.array([64, 128]),
    "not a number": np.nan,
    "huge": 1e300,
    "beyond all": 2**62,
    "negative": -1,
    "text": "64",
    "not UTF-8": np.bytes_(b"\xff\xfe"),
    "empty": h5py.Empty("i8"),
    "missing": None,
}


@pytest.mark.slow
@pytest.mark.parametrize("value", ABSURD.values(), ids=ABSURD)
@pytest.mark.parametrize("name", ["samples", "converged", "stickslip_format"])
def test_absurd_attributes_get_a_sentence(saved: Path, name: str, value: Any) -> None:
    with h5py.File(saved, "r+") as file:
        del file.attrs[name]
        if value is not None:
            file.attrs[name] = value
    with rejects(ResultsFileError) as caught:
        load_results(saved)
    assert name in str(caught.value)
    assert not re.search("Error|object|dtype|<class|Traceback", str(caught.value))


BAD_TEXTS = [
    "",
    "[",
    "[" * 5000,
    "nothing",
    "[1, 2]",
    '{"a": [1]}',
    '[["a", "b"]]',
    "null",
    '"text"',
    "9" * 5000,
    "{" * 100,
]


@pytest.mark.long
@pytest.mark.parametrize("text", BAD_TEXTS, ids=range(len(BAD_TEXTS)))
def test_texts_that_no_run_writes_get_a_sentence(saved: Path, text: str) -> None:
    for place in ("warnings", "settings", "provenance", "study/output_names", "study/signal_groups", "study/face_names",
                  "study/mode_table", "study/derived", "study/warnings", "study/rough_numbers"):  # fmt: skip
        with h5py.File(saved, "r+") as file:
            retained = file[place][()]
            file[place][()] = text
            file[place].attrs.pop("crc32", None)  # as in files of older versions: the content itself is checked
        with rejects(ResultsFileError):
            load_results(saved)
        with h5py.File(saved, "r+") as file:
            file[place][()] = retained
    load_results(saved)


@pytest.mark.slow
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300, -1e308])
def test_values_that_no_run_writes_get_a_sentence(saved: Path, value: Any) -> None:
    for place in ("frequency", "displacement_cosine", "pairs/preload", "linear/stuck_mean", "study/pair_area"):
        with h5py.File(saved, "r+") as file:
            retained = file[place][()]
            file[place][(0,) * retained.ndim] = value
        with rejects(ResultsFileError):
            load_results(saved)
        with h5py.File(saved, "r+") as file:
            file[place][()] = retained


def replaced(path: Path, name: str, make: Callable[[h5py.File], object]) -> None:
    """Put another object in the place of a variable."""
    with h5py.File(path, "r+") as file:
        del file[name]
        make(file)


@pytest.mark.slow
@pytest.mark.parametrize(
    "make",
    [
        lambda file: file.create_dataset("residual", 20, "f8", external=[("/etc/passwd", 0, 160)]),
        lambda file: file.__setitem__("residual", h5py.ExternalLink("other.nc", "/residual")),
        lambda file: file.__setitem__("residual", h5py.SoftLink("/residual")),
        lambda file: file.create_dataset("residual", (10**12,), "f8", chunks=(1000,)),
        lambda file: file.create_group("residual"),
        lambda file: file.create_dataset("residual", data="text"),
        lambda file: file.create_dataset("residual", data=np.zeros(3)),
    ],
)
def test_variables_from_elsewhere_and_of_other_kinds_are_rejected(
    saved: Path, make: Callable[[h5py.File], object]
) -> None:
    replaced(saved, "residual", make)
    with rejects(ResultsFileError):
        load_results(saved)


def test_a_contact_state_beyond_a_byte_is_not_mistaken_for_another(saved: Path) -> None:
    def make(file: h5py.File) -> None:
        file.create_dataset("contact_state", data=np.full((20, 24), 256, dtype=np.int32))

    replaced(saved, "contact_state", make)
    with rejects(ResultsFileError):
        load_results(saved)


def test_a_record_of_another_run_is_noticed_when_read(saved: Path) -> None:
    with h5py.File(saved, "r+") as file:
        rows = file["study/output_rows"][()]
        del file["study/output_rows"]
        file["study"].create_dataset("output_rows", data=rows[:, :-1])
    with rejects(ResultsFileError):
        load_results(saved)


@pytest.mark.long
@pytest.mark.parametrize("share", [0.3, 0.9])
def test_the_command_says_one_sentence_and_no_traceback(saved: Path, share: float) -> None:
    """Libraries that fail while they open a file told of it once more when their objects were thrown away."""
    whole = saved.read_bytes()
    saved.write_bytes(whole[: int(share * len(whole))])
    code = "from stickslip.cli.main import main; main()"
    command = [sys.executable, "-c", code, "report", str(saved.parent)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    printed_sentence(line)


@pytest.mark.long
def test_flipped_bits_anywhere_end_in_a_sentence_or_a_sound_file(saved: Path) -> None:
    """Seeded damage: a file is read whole, or a sentence without words of Python says that it is not."""
    whole, rng = saved.read_bytes(), random.Random(18)
    rejected = 0
    for _ in range(120):
        data = bytearray(whole)
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        saved.write_bytes(data)
        try:
            load_results(saved)
        except ResultsFileError as error:
            rejected += 1
            printed = str(error)
        else:
            printed = ""
        assert not re.search(r"\w+Error|h5py|object", printed)
    assert rejected > 60
