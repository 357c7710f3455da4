"""What is wrong with a study beyond its schema names the line of every key that it is about, or what gave it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from own_cases import EXAMPLE, MATRIX_STUDY, mesh_case, write_matrices
from sentences import printed_sentence, rejects
from stickslip.case.toml_text import KeyPositions
from stickslip.cli.main import app
from stickslip.core.errors import ImportFileError, InputError, concerning, keys_of_section

BLADES = """\
[geometry]
platform_angle = "30 deg"
damper_length = "28 mm"
excitation_height = "3.67 mm"
[mesh]
chordwise = 2
airfoil_rows = 4
[reduction]
modes = 5
[preload]
centrifugal_force = "500 N"
"""

# What stands in the file, what is put in its place, and the beginning of the message after the file's name.
BLADES_WRONG = {
    "a default beside a key": (
        '"28 mm"', '"29 mm"', "line 3 (geometry.damper_length), geometry.width (not in the file: default)",
    ),
    "two defaults": (
        '"3.67 mm"',
        '"40 mm"',
        "line 4 (geometry.excitation_height), geometry.underside_height_at_shank (not in the file: default)",
    ),
    "five keys": (
        'damper_length = "28 mm"',
        'blade_length = "44 mm"\nplatform_edge_thickness = "5 mm"',
        "geometry.underside_height_at_shank (not in the file: default), geometry.contact_face_width (not in the file: "
        "default), line 2 (geometry.platform_angle), line 4 (geometry.platform_edge_thickness), line 3 "
        "(geometry.blade_length)",
    ),
    "preload of another mesh": ('centrifugal_force = "500 N"', "values = [1.0, 2.0]", "line 11"),
    "no contact left": (
        'centrifugal_force = "500 N"',
        'centrifugal_force = "0.5 mN"\n[roughness]\nfractal_roughness = "1e-7 m"\nfractal_dimension = 2.001',
        "line 12 (roughness), line 11 (preload.centrifugal_force)",
    ),
}  # fmt: skip

MESH = f"""\
[structure]
kind = "mesh"
file = "{(EXAMPLE / "beam_and_block.inp").as_posix()}"
length_unit = "mm"
[bodies.damper]
density = "8200 kg/m^3"
[interfaces.sole]
first = "damper_bottom"
second = "beam_top"
normal_load = "40 N"
friction = 0.2
[interfaces.lid]
first = "damper_top"
second = "ground"
normal_load = "40 N"
[forces.push]
set = "tip"
direction = [0, 0, 1]
amplitude = "0.2 N"
[responses.block]
point = ["48 mm", "3.67 mm", "14 mm"]
direction = [1, 0, 0]
[roughness]
sq = "1 um"
[solver]
frequency_start = "1600 Hz"
frequency_stop = "2000 Hz"
"""

MESH_WRONG = {
    "no such file": ("beam_and_block.inp", "beam.inp", "line 3 (structure.file)"),
    "unit of length": ('"mm"', '"furlong"', "line 4 (structure.length_unit)"),
    "no such face": ("damper_bottom", "bottom", "line 8 (interfaces.sole.first)"),
    "second face": ('"beam_top"', '"top"', "line 9 (interfaces.sole.second)"),
    "one face twice": (
        '"damper_bottom"', '"beam_top"', "line 8 (interfaces.sole.first), line 9 (interfaces.sole.second)",
    ),
    "gap of two faces": ("friction = 0.2", 'gap = "1 um"', "line 11 (interfaces.sole.gap)"),
    "search of the ground": (
        'second = "ground"',
        'second = "ground"\nsearch_distance = "1 mm"',
        "line 15 (interfaces.lid.search_distance)",
    ),
    "force on no set": ('set = "tip"', 'set = "toe"', "line 17 (forces.push.set)"),
    "far point": ('"48 mm"', '"4.8 m"', "line 21 (responses.block.point)"),
    "unknown body": ("[bodies.damper]", "[bodies.dampr]", "line 5"),
}  # fmt: skip


def rejected(*arguments: object) -> str:
    """What the command line says on input that it refuses, without the lines on defaults."""
    result = CliRunner().invoke(app, [str(each) for each in arguments])
    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.stderr
    sentence = next(line for line in result.stderr.splitlines() if line.startswith("Error: "))
    printed_sentence(sentence)
    return sentence.removeprefix("Error: ")


@pytest.mark.parametrize(("found", "put", "start"), BLADES_WRONG.values(), ids=BLADES_WRONG)
def test_two_blades(found: str, put: str, start: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    assert BLADES.count(found) == 1
    path.write_text(BLADES.replace(found, put), encoding="utf-8")
    assert rejected("check", path).startswith(f"{path}, {start}: ")


@pytest.mark.slow
@pytest.mark.parametrize(("found", "put", "start"), MESH_WRONG.values(), ids=MESH_WRONG)
def test_own_mesh(found: str, put: str, start: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    assert MESH.count(found) == 1
    path.write_text(MESH.replace(found, put), encoding="utf-8")
    assert rejected("check", path).startswith(f"{path}, {start}: ")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("found", "put", "start"),
    [
        ('first = "lid"', 'first = "led"', "line 5"),
        ('"superelement.npz"', '"none.npz"', "line 3 (structure.file)"),
        ('set = "lid"', "node = 999999", "line 13"),
        ('"48 mm"', '"4.8 m"', "line 17"),
    ],
)
def test_matrices(found: str, put: str, start: str, matrices: Path) -> None:
    path = matrices / "study.toml"
    assert found in MATRIX_STUDY
    path.write_text(MATRIX_STUDY.replace(found, put), encoding="utf-8")
    assert rejected("check", path).startswith(f"{path}, {start}: ")


@pytest.fixture(scope="module")
def matrices(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a superelement."""
    folder = tmp_path_factory.mktemp("matrices")
    write_matrices(folder, mesh_case())
    return folder


def test_a_matrix_file_names_the_key_of_its_own(tmp_path: Path) -> None:
    np.save(tmp_path / "stiffness.npy", np.eye(6))
    np.save(tmp_path / "mass.npy", np.eye(5))
    head = 'kind = "matrices"\nstiffness = "stiffness.npy"\nmass = "mass.npy"\nlength_unit = "mm"'
    path = tmp_path / "study.toml"
    path.write_text(MATRIX_STUDY.replace('kind = "matrices"\nfile = "superelement.npz"', head), encoding="utf-8")
    assert rejected("check", path).startswith(f"{path}, line 4 (structure.mass), line 3 (structure.stiffness): ")
    (tmp_path / "mass.npy").unlink()
    assert rejected("check", path).startswith(f"{path}, line 4 (structure.mass): ")


@pytest.mark.slow
def test_what_a_run_finds_out_late(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    coarse = "airfoil_rows = 1\nshank_rows = 1\nplatform_rows = 1\nshank_columns = 1\ninner_columns = 1"
    text = BLADES.replace("airfoil_rows = 4", coarse).replace("modes = 5", "modes = 2000")
    path.write_text(text, encoding="utf-8")
    line = 1 + text[: text.index("modes")].count("\n")
    printed = rejected("run", path, "--out", tmp_path / "out")
    assert printed.startswith(f"{path}, line {line} (reduction.modes): ")


def test_a_sweep_names_the_option_instead_of_a_line(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(BLADES, encoding="utf-8")
    vary = "geometry.damper_length=29 mm,30 mm"
    printed = rejected("sweep", path, "--vary", vary, "--out", tmp_path / "out", "--workers", 1)
    assert printed.startswith(f"{path}, --vary geometry.damper_length, geometry.width (not in the file: default): ")


def test_a_key_without_a_line_of_its_own_has_that_around_it(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    head, _, _ = MESH.partition("[responses.block]")
    tail = MESH[MESH.index("[roughness]") :]
    table = '[responses]\nblock = {point = ["4.8 m", "0 m", "0 m"], direction = [1, 0, 0]}\n'
    path.write_text(head + table + tail, encoding="utf-8")
    assert rejected("check", path).startswith(f"{path}, line 21 (responses.block.point): ")


def test_a_dotted_key_is_not_called_a_default(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text('geometry.damper_length = "29 mm"\ngeometry.width = "28 mm"\n', encoding="utf-8")
    assert rejected("check", path).startswith(f"{path}, geometry.damper_length, geometry.width: ")


@pytest.mark.long
def test_a_real_process_says_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(BLADES.replace('"28 mm"', '"29 mm"\nwidth = "28 mm"'), encoding="utf-8")
    code = "from stickslip.cli.main import main; main()"
    result = subprocess.run(
        [sys.executable, "-c", code, "run", "study.toml", "--out", "out"],
        capture_output=True, text=True, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.splitlines()[-1] == (
        "Error: study.toml, line 3 (geometry.damper_length), line 4 (geometry.width): damper_length is 29 mm; it must "
        "be at most 28 mm, the width of the blades; a longer damper does not fit under the platforms."
    )
    assert "Traceback" not in result.stderr


def test_the_closest_keys_win_and_the_kind_of_error_stays() -> None:
    with (
        rejects(ImportFileError, "interfaces.joint.first") as caught,
        concerning("interfaces.joint"),
        keys_of_section("interfaces.joint"),
    ):
        raise ImportFileError("no set", ["first"])
    again = caught.value.reworded("in words: no set")
    assert (type(again), again.keys, str(again)) == (ImportFileError, ("interfaces.joint.first",), "in words: no set")
    with rejects(InputError, "geometry"), concerning("geometry"), keys_of_section("geometry"):
        raise InputError("inverted")


def test_arguments_of_a_function_are_no_keys_of_the_study_file() -> None:
    """A section has the name of an argument by chance; who calls the function knows the key."""
    error = InputError("preload is -1, but it must be above 0.", arguments=["preload"])
    places = KeyPositions("study.toml", {"preload": {"values": [-1.0]}}, {("preload",): 3})
    assert places.sentence(error) == f"study.toml: {error}"
    assert places.sentence(InputError("it is -1.", ["preload"])) == "study.toml, line 3 (preload): it is -1."
    again = error.reworded("in words")
    assert (again.keys, again.are_arguments) == (("preload",), True)
    with rejects(InputError, "preload"), keys_of_section("structure"):
        raise error
    with rejects(InputError, "preload.values") as caught, concerning("preload.values"):
        raise error
    assert places.sentence(caught.value) == f"study.toml, line 3 (preload.values): {error}"
