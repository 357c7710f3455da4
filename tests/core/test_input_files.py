"""Pipes, devices, huge files, packed bombs and HDF5 files that read other files: refused at once, by a sentence."""

import base64
import io
import os
import zipfile
import zlib
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io

from bombs import flat_memory
from sentences import printed_sentence, rejects
from stickslip.case.load import load_case
from stickslip.core import input_files
from stickslip.core.errors import ImportFileError, InputError, ResultsFileError, StickslipError, StudyFileError
from stickslip.core.input_files import UnsuitableFileError, open_regular, read_regular
from stickslip.formats.matrices.exchange import read_superelement
from stickslip.formats.matrices.read import read_matrices
from stickslip.formats.meshes.read import read_model
from stickslip.formats.profile_file import read_profile
from stickslip.results.storage import load_results

ZEROS = 3_000_000_000  # bytes that the bombs would unpack to
READERS: dict[str, Callable[[Path], object]] = {
    **{f"k{ending}": lambda path: read_matrices(path, path) for ending in (".mtx", ".npy", ".npz", ".mat", ".sti")},
    **{f"k{ending}": lambda path: read_matrices(path, path) for ending in (".hb", ".op4", ".full")},
    **{f"m{ending}": lambda path: read_model(path, "mm") for ending in (".inp", ".bdf", ".msh", ".vtu", ".med")},
    "superelement.npz": read_superelement,
    "results.nc": load_results,
    "study.toml": load_case,
    "profile.txt": lambda path: read_profile(path, "mm", "um"),
}
KINDS = {"results.nc": ResultsFileError, "study.toml": StudyFileError, "profile.txt": InputError}


def rejects_file(name: str) -> AbstractContextManager[pytest.ExceptionInfo[StickslipError]]:
    """The error of the reader of ``name``; matrices are all read as the stiffness."""
    return rejects(KINDS.get(name, ImportFileError), *(["stiffness"] if name.startswith("k.") else []))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("name", READERS)
def test_a_named_pipe_is_rejected_at_once(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    with rejects_file(name):
        READERS[name](tmp_path / name)


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="this system has no /dev/zero")
@pytest.mark.parametrize("name", READERS)
def test_a_device_is_rejected_at_once(tmp_path: Path, name: str) -> None:
    (tmp_path / name).symlink_to("/dev/zero")
    with rejects_file(name):
        READERS[name](tmp_path / name)


@pytest.mark.parametrize("name", READERS)
def test_a_folder_is_rejected(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    with rejects_file(name):
        READERS[name](tmp_path / name)


@pytest.mark.parametrize("name", [name for name in READERS if name != "results.nc"])
def test_a_huge_file_is_rejected_before_it_is_read(tmp_path: Path, name: str) -> None:
    """A sparse file takes no room on the disk. Own results may have any size."""
    with (tmp_path / name).open("wb") as stream:
        stream.truncate(input_files.LARGEST_FILE + 1)
    with flat_memory(), rejects_file(name):
        READERS[name](tmp_path / name)


def test_the_opener(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"content")
    assert read_regular(tmp_path / "file") == b"content"
    with pytest.raises(UnsuitableFileError) as caught:
        read_regular(tmp_path / "file", 6)
    printed_sentence(str(caught.value.strerror))
    with pytest.raises(UnsuitableFileError) as caught:
        open_regular(tmp_path)
    printed_sentence(str(caught.value.strerror))
    with pytest.raises(FileNotFoundError):
        open_regular(tmp_path / "nowhere")


# --- packed bombs: what they would unpack to is told before it is unpacked


def packed_zeros(count: int, head: bytes = b"", window: int = 15) -> bytes:
    """``head`` and about ``count`` zeros, packed by zlib; one packed piece stands there again and again."""
    packer = zlib.compressobj(9, zlib.DEFLATED, window)
    start = packer.compress(head) + packer.flush(zlib.Z_FULL_FLUSH)
    piece = packer.compress(bytes(10_000_000)) + packer.flush(zlib.Z_FULL_FLUSH)
    return start + piece * (count // 10_000_000) + zlib.compressobj(9, zlib.DEFLATED, -15).flush()


def zip_of_zeros(path: Path) -> None:
    """A .npz whose one array has 3 GB of zeros."""
    size = int((ZEROS / 8) ** 0.5)
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": (size, size)})
    packed = packed_zeros(ZEROS, head.getvalue(), -15)
    with zipfile.ZipFile(path, "w") as archive:
        entry = zipfile.ZipInfo("K.npy")
        entry.compress_type, entry.compress_size = zipfile.ZIP_DEFLATED, len(packed)
        entry.CRC = 0
        entry.file_size = len(head.getvalue()) + size * size * 8
        entry.header_offset = 0
        assert archive.fp is not None
        archive.fp.write(entry.FileHeader(zip64=False) + packed)
        archive.filelist.append(entry)
        archive.start_dir = archive.fp.tell()
        archive.comment = b" "  # the list is written, as the archive has changed


def packed_matlab(path: Path) -> None:
    """A version 5 file with one packed element that unpacks to 3 GB."""
    packed = packed_zeros(ZEROS)
    header = b"MATLAB 5.0 MAT-file".ljust(124) + (0x0100).to_bytes(2, "little") + b"IM"
    path.write_bytes(header + (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed)


def hdf5_of_zeros(path: Path, name: str = "data") -> None:
    with h5py.File(path, "a") as file:
        file.create_dataset(name, (ZEROS // 8,), "f8", chunks=(1_000_000,), compression="gzip")


def packed_vtu(path: Path) -> None:
    """One packed array that many arrays name: 3 GB in total, though each is small."""
    block = zlib.compress(bytes(30_000_000), 9)
    numbers = np.array([1, 30_000_000, 0, len(block)], dtype="<u4").tobytes()
    data = base64.b64encode(numbers).decode() + base64.b64encode(block).decode()
    array = '<DataArray type="UInt8" Name="a{}" format="appended" offset="0"/>'
    arrays = "".join(array.format(number) for number in range(ZEROS // 30_000_000))
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" compressor="vtkZLibDataCompressor">'
        f'<UnstructuredGrid><Piece NumberOfPoints="1" NumberOfCells="0"><PointData>{arrays}</PointData></Piece>'
        f'</UnstructuredGrid><AppendedData encoding="base64">_{data}</AppendedData></VTKFile>'
    )


BOMBS = {
    "k.npz": zip_of_zeros,
    "superelement.npz": zip_of_zeros,
    "k.mat": packed_matlab,
    "m.med": hdf5_of_zeros,
    "m.vtu": packed_vtu,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", BOMBS)
def test_a_packed_bomb_is_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setattr(
        input_files, "LARGEST_UNPACKED", 200_000_000
    )  # as the bombs are counted while they are unpacked
    path = tmp_path / name
    BOMBS[name](path)
    assert path.stat().st_size < 5_000_000
    with (
        flat_memory(700_000_000),
        rejects_file(name),
    ):
        READERS[name](path)


def test_a_packed_bomb_in_results_and_in_matlab_73(tmp_path: Path) -> None:
    hdf5_of_zeros(tmp_path / "results.nc", "frequency")
    with flat_memory(), rejects(ResultsFileError):
        load_results(tmp_path / "results.nc")
    hdf5_of_zeros(tmp_path / "k.mat")
    with flat_memory(), rejects(ImportFileError, "stiffness"):
        read_matrices(tmp_path / "k.mat", tmp_path / "k.mat")


def test_what_is_packed_well_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A packed matrix of a model that is no bomb, also where small files may unpack to less."""
    matrix = np.diag(np.arange(1.0, 201.0))
    np.savez_compressed(tmp_path / "k.npz", K=matrix, M=matrix)
    scipy.io.savemat(tmp_path / "k.mat", {"K": matrix, "M": matrix}, do_compression=True)
    for name in ("k.npz", "k.mat"):
        assert read_matrices(tmp_path / name, tmp_path / name).size == 200
    monkeypatch.setattr(input_files, "LARGEST_UNPACKED", 100_000)
    for name in ("k.npz", "k.mat"):
        with rejects(ImportFileError, "stiffness"):
            read_matrices(tmp_path / name, tmp_path / name)


@pytest.mark.slow
def test_entities_of_xml_do_not_grow(tmp_path: Path) -> None:
    """A billion laughs: the parser stops."""
    levels = "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 12))
    (tmp_path / "m.vtu").write_text(f'<!DOCTYPE v [<!ENTITY e0 "lol">{levels}]><VTKFile>&e11;</VTKFile>')
    with flat_memory(), rejects(ImportFileError):
        read_model(tmp_path / "m.vtu", "mm")


# --- HDF5 files that read other files


def external_storage(file: h5py.File, secret: Path) -> None:
    file.create_dataset("K", (2, 4), "u1", external=[(str(secret), 0, 8)])


def external_link(file: h5py.File, secret: Path) -> None:
    file["K"] = h5py.ExternalLink(str(secret), "/K")


def virtual_data(file: h5py.File, secret: Path) -> None:
    layout = h5py.VirtualLayout((2, 4), "u1")
    layout[...] = h5py.VirtualSource(str(secret), "K", (2, 4))
    file.create_virtual_dataset("K", layout)


@pytest.mark.parametrize("make", [external_storage, external_link, virtual_data])
@pytest.mark.parametrize("name", ["k.mat", "m.med", "results.nc"])
def test_hdf5_files_that_read_other_files_are_rejected(
    tmp_path: Path, name: str, make: Callable[[h5py.File, Path], None]
) -> None:
    secret = tmp_path / "secret"
    secret.write_bytes(b"password")
    with h5py.File(tmp_path / name, "w") as file:
        inner = file.create_group("a/b")
        inner["loop"] = file  # groups may hold each other
        make(inner, secret)
    with rejects_file(name) as caught:
        READERS[name](tmp_path / name)
    assert "password" not in str(caught.value)


def test_an_error_shows_no_line_of_a_file_that_is_another_one(tmp_path: Path) -> None:
    """A map, positions or a matrix that is a list of passwords."""
    (tmp_path / "passwd").write_text("root:x:0:0:root 1.5\nme:x:1 2:secret\n")
    np.save(tmp_path / "k.npy", np.eye(6))
    for keys in ({"unknown_map": "passwd"}, {"node_positions": "passwd"}):
        files: dict[str, Any] = {key: tmp_path / name for key, name in keys.items()}
        with rejects(ImportFileError, *keys) as caught:
            read_matrices(tmp_path / "k.npy", tmp_path / "k.npy", **files)
        assert "root:" not in str(caught.value)
        assert "secret" not in str(caught.value)
    for ending in ("mtx", "sti", "hb", "op4"):
        path = tmp_path / f"k.{ending}"
        path.write_text("root:x:0:0:root\n" * 9)
        with rejects(ImportFileError, "stiffness") as caught:
            read_matrices(path, path)
        assert "root:" not in str(caught.value)


def test_a_study_file_may_not_be_a_device() -> None:
    with rejects(StudyFileError):
        load_case(os.devnull)
