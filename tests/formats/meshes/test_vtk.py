"""Legacy VTK files as other programs write them: scalars with a lookup table, and data sets that are not read."""

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.read import read_model
from stickslip.structure.mesh import IntArray

MODELS = Path(__file__).parents[2] / "data" / "models"
TWO_CUBES = (MODELS / "cubes.vtk").read_text(encoding="utf-8")


def _binary(version: str, cells: bytes, number: str = "int") -> bytes:
    """The two cubes as VTK writes them in binary; the numbers of their bodies have the type ``number``."""
    points, _ = _two_cubes()
    parts = [
        f"# vtk DataFile Version {version}\ncubes\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n".encode(),
        points.astype(">f8").tobytes(),
        cells,
        b"\nCELL_TYPES 2\n" + np.full(2, 12).astype(">i4").tobytes(),
        f"\nCELL_DATA 2\nFIELD FieldData 1\nbody 1 2 {number}\n".encode(),
        np.array([3, 5]).astype(">i8" if "64" in number else ">i4").tobytes(),
    ]
    return b"".join(parts)


def _two_cubes() -> tuple[FloatArray, IntArray]:
    mesh = read_model(MODELS / "cubes.vtk", "m").mesh
    return mesh.points, mesh.blocks[0].cells


@pytest.mark.parametrize("number", ["int", "vtktypeint64", "vtkIdType"])
def test_binary_files_of_new_vtk(tmp_path: Path, number: str) -> None:
    """Version 5.1 has offsets and connectivity, and "int" has 32 bits; no line end follows the last number."""
    _, corners = _two_cubes()
    path = tmp_path / "new.vtk"
    cells = b"\nCELLS 3 16\nOFFSETS vtktypeint64\n" + np.array([0, 8, 16]).astype(">i8").tobytes()
    cells += b"\nCONNECTIVITY vtktypeint64\n" + corners.astype(">i8").tobytes()
    path.write_bytes(_binary("5.1", cells, number))
    assert read_model(path, "m").mesh.body_names == ("body 3", "body 5")


@pytest.mark.parametrize("number", ["int", "vtktypeint64"])
def test_binary_files_of_old_vtk(tmp_path: Path, number: str) -> None:
    _, corners = _two_cubes()
    path = tmp_path / "old.vtk"
    cells = b"\nCELLS 2 18\n" + np.insert(corners, 0, 8, axis=1).astype(">i4").tobytes()
    path.write_bytes(_binary("4.1", cells, number))
    assert read_model(path, "m").mesh.body_names == ("body 3", "body 5")


def test_mirrored_cells_are_converted(tmp_path: Path) -> None:
    """Programs that only show a mesh write cells of either order; the volume is the same."""
    path = tmp_path / "mirrored.vtk"
    words = TWO_CUBES.split("\n")
    at = next(place for place, line in enumerate(words) if line.startswith("8 "))
    corners = words[at].split()[1:]
    words[at] = " ".join(["8", *(corners[place] for place in (0, 3, 2, 1, 4, 7, 6, 5))])
    path.write_text("\n".join(words), encoding="utf-8")
    model = read_model(path, "m")
    assert any("1 elements have the mirrored order" in message for message in model.messages)
    whole = read_model(MODELS / "cubes.vtk", "m").mesh
    np.testing.assert_array_equal(np.sort(model.mesh.blocks[0].cells), np.sort(whole.blocks[0].cells))


def test_scalars_are_bodies_and_sets() -> None:
    """The surface cell has the body 0, which no solid has."""
    mesh = read_model(MODELS / "cubes.vtk", "m").mesh
    assert mesh.body_names == ("body 3", "body 5")
    np.testing.assert_array_equal(mesh.body, [0, 1])
    np.testing.assert_array_equal(mesh.node_set("top"), [8, 9, 10, 11])
    np.testing.assert_array_equal(np.sort(mesh.sides("below")[0][0]), [0, 1, 2, 3])


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("DATASET UNSTRUCTURED_GRID", "DATASET STRUCTURED_POINTS\nDIMENSIONS 100000 100000 100000"),
        ("# vtk DataFile", "# other file"),
        ("8 4 5 6 7", "8 4 5 6 77"),
        ("POINTS 12", "POINTS 13"),
    ],
)
def test_other_data_sets_and_damage(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "cubes.vtk"
    path.write_text(TWO_CUBES.replace(old, new), encoding="utf-8")
    with rejects(ImportFileError):
        read_model(path, "m")
