"""Legacy VTK files as other programs write them: scalars with a lookup table, and data sets that are not read."""

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.read import read_model

MODELS = Path(__file__).parents[2] / "data" / "models"
TWO_CUBES = (MODELS / "cubes.vtk").read_text(encoding="utf-8")


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
