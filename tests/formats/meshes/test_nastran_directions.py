"""Nastran: forces (CID) and constraints (CD) in directions of cylindrical, spherical and turned systems."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.structure.constraints import eliminate

CUBES = (Path(__file__).parents[2] / "data" / "models" / "cubes.bdf").read_text(encoding="utf-8")
CYLINDER = "CORD2C,5,,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\n"  # about z
SPHERE = "CORD2S,5,,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\n"
PERMUTED = "CORD2R,5,,0.,0.,0.,1.,0.,0.,+\n+,0.,1.,0.\n"  # axes 1, 2, 3 are y, z, x
TURNED = "CORD2R,5,,0.,0.,0.,0.,0.,1.,+\n+,1.,{},0.\n"
OWN_SPC = "SPC1,1,123,1\nSPC1,1,123,2\nSPC1,1,123,3\nSPC1,1,123,4\n"


def cubes(
    tmp_path: Path, cards: str = "", grids: dict[int, Any] | None = None, constraints: str = OWN_SPC
) -> ImportedModel:
    """The two cubes with more cards, CD of some grids (in lines 5 to 20) by label, and other constraints."""
    text = CUBES.replace(OWN_SPC, constraints).replace("ENDDATA", f"{cards}ENDDATA")
    assert constraints in text
    for label, system in (grids or {}).items():
        at = next(line for line in text.splitlines() if line.startswith(f"GRID,{label},"))
        text = text.replace(f"{at}\n", f"{at},{system}\n")
    path = tmp_path / "cubes.bdf"
    path.write_text(text, encoding="utf-8")
    return read_model(path, "mm")


@pytest.mark.parametrize(
    ("system", "label", "force", "wanted"),
    [
        # grid 16 is at (0, 10, 20): r is y and theta is -x; grid 14 at (10, 0, 20): x and y
        (CYLINDER, 16, "2.,1.,3.,4.", (-6.0, 2.0, 8.0)),
        (CYLINDER, 14, "2.,1.,3.,4.", (2.0, 6.0, 8.0)),
        (CYLINDER, 13, "2.,0.,0.,4.", (0.0, 0.0, 8.0)),  # on the axis, along it
        # r is (0, 1, 2) / root 5, theta (0, 2, -1) / root 5, phi -x
        (SPHERE, 16, "2.236067977499790,1.,0.,0.", (0.0, 1.0, 2.0)),
        (SPHERE, 16, "2.236067977499790,0.,1.,0.", (0.0, 2.0, -1.0)),
        (SPHERE, 16, "3.,0.,0.,1.", (-3.0, 0.0, 0.0)),
        (SPHERE, 13, "3.,1.,0.,0.", (0.0, 0.0, 3.0)),
        (PERMUTED, 16, "2.,1.,3.,4.", (8.0, 2.0, 6.0)),
        (PERMUTED, 1, "2.,1.,3.,4.", (8.0, 2.0, 6.0)),
    ],
)
def test_forces_in_a_system(
    tmp_path: Path, system: str, label: int, force: str, wanted: tuple[float, float, float]
) -> None:
    model = cubes(tmp_path, f"FORCE,3,{label},5,{force}\n{system}")
    np.testing.assert_allclose(model.node_forces[label - 1], wanted, atol=1e-14)
    assert np.count_nonzero(np.abs(model.node_forces).sum(axis=1)) == 1


@pytest.mark.parametrize(
    "cards",
    [
        "FORCE,3,16,5,2.,1.\n",
        f"FORCE,3,99,5,2.,1.\n{CYLINDER}",
        f"FORCE,3,13,5,2.,1.\n{CYLINDER}",
        f"FORCE,3,13,5,2.,,1.\n{SPHERE}",
        f"FORCE,3,1,5,2.,1.\n{SPHERE}",
        f"FORCE,3,16,5,1+200,1+200\n{CYLINDER}",
        # no warning of numpy on the way to a sentence
        f"FORCE,3,99,5,1.,1.\nGRID,99,,1+200,1.,0.\n{SPHERE}",
        f"FORCE,3,99,5,1.,1.\nGRID,99,5,1+308,45.,0.\n{SPHERE}",
    ],
)
def test_forces_that_have_no_direction(tmp_path: Path, cards: str) -> None:
    with rejects(ImportFileError):
        cubes(tmp_path, cards)


@pytest.mark.parametrize(
    ("system", "grids", "constraints", "held"),
    [
        # all three at once, or in two sets, in any directions
        (CYLINDER, {2: 5, 3: 5}, "SPC1,1,123,2,3\n", [3, 4, 5, 6, 7, 8]),
        (TURNED.format(0.3), {3: 5}, "SPC1,1,12,3\nSPC,1,3,3456,0.\n", [6, 7, 8]),
        (SPHERE, {1: 5}, "SPC1,1,123,1\n", [0, 1, 2]),
        # grid 2 at (10, 0, 0): r is x; grid 4 at (0, 10, 0): r is y; grid 3 at (10, 10, 0)
        (CYLINDER, {2: 5, 4: 5}, "SPC1,1,1,2,3,4\n", [3, 6, 10]),
        (CYLINDER, {2: 5, 4: 5}, "SPC1,1,2,2,4\n", [4, 9]),
        (CYLINDER, {3: 5}, "SPC1,1,12,3\n", [6, 7]),
        (CYLINDER, {3: 5}, "SPC1,1,3,3\n", [8]),
        (CYLINDER, {5: 5}, "SPC1,1,12456,5\n", [12, 13]),  # on the axis: the plane across it
        (SPHERE, {4: 5}, "SPC1,1,2,4\n", [11]),  # theta is -z there
        (SPHERE, {3: 5}, "SPC1,1,13,3\n", [6, 7]),
        (PERMUTED, {1: 5, 3: 5}, "SPC1,1,3,1,3\nSPC1,1,1,3\n", [0, 6, 7]),
        (TURNED.format(1e-11), {3: 5}, "SPC1,1,1,3\n", [6]),
        # rotations of solid grids are nothing
        (TURNED.format(0.3), {3: 5}, "SPC1,1,456,3\nSPC1,1,1,2\n", [3]),
        # sets that do not act
        (TURNED.format(0.3), {3: 5}, "SPC1,2,1,3\nSPC1,1,1,2\n", [3]),
    ],
)
def test_constraints_along_basic_directions(
    tmp_path: Path, system: str, grids: dict[int, Any], constraints: str, held: list[int]
) -> None:
    model = cubes(tmp_path, system, grids, constraints)
    assert model.fixed_unknowns.tolist() == held
    printed_sentence("\n".join(model.messages), f"{len(grids)} grids", "(CD)")


@pytest.mark.parametrize(
    ("system", "grids", "constraints"),
    [
        (CYLINDER, {5: 5}, "SPC1,1,2,5\n"),  # on the axis
        (SPHERE, {5: 5}, "SPC1,1,13,5\n"),
        (SPHERE, {1: 5}, "SPC1,1,12,1\n"),
        ("", {16: 5}, "SPC1,1,1,3\n"),
        ("", {16: "x"}, "SPC1,1,1,3\n"),
    ],
)
def test_constraints_in_other_directions_are_rejected(
    tmp_path: Path, system: str, grids: dict[int, Any], constraints: str
) -> None:
    with rejects(ImportFileError):
        cubes(tmp_path, system, grids, constraints)


@pytest.mark.parametrize(
    ("system", "grids", "constraints", "node", "rows"),
    [
        # grid 3 at (10, 10, 0), grid 2 at (10, 0, 0), grid 8 at (0, 10, 10)
        (CYLINDER, {3: 5}, "SPC1,1,1,3\nSPC1,1,3,3\n", 2, [[1, 1, 0], [0, 0, 1]]),
        (SPHERE, {8: 5}, "SPC1,1,1,8\n", 7, [[0, 1, 1]]),
        (TURNED.format(1e-8), {3: 5}, "SPC1,1,1,3\n", 2, [[1, 1e-8, 0]]),
        (TURNED.format(0.3), {3: "5,1"}, "SPC1,1,2,2\n", 2, [[1, 0.3, 0]]),
        ("GRDSET,,,,,,5\n" + CYLINDER, {}, "SPC1,1,1,3\n", 2, [[1, 1, 0]]),
    ],
)
def test_constraints_in_other_directions_become_equations(
    tmp_path: Path, system: str, grids: dict[int, Any], constraints: str, node: int, rows: list[list[float]]
) -> None:
    model = cubes(tmp_path, system, grids, constraints)
    assert model.equations is not None
    tied = eliminate(model.equations, model.fixed_unknowns).transformation[3 * node : 3 * node + 3].toarray()
    wanted = np.array(rows) / np.linalg.norm(rows, axis=1)[:, None]
    np.testing.assert_allclose(wanted @ tied, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(tied) == 3 - len(rows)


def test_directions_of_a_grid_outside_of_solids_do_not_matter(tmp_path: Path) -> None:
    model = cubes(tmp_path, f"{TURNED.format(0.3)}GRID,50,,1.,2.,3.,5\n", {}, "SPC1,1,1,2,50\n")
    assert model.fixed_unknowns.tolist() == [3]
    assert model.messages == ()


def test_permanent_constraints_stay_out_of_the_named_set(tmp_path: Path) -> None:
    model = cubes(tmp_path, "", {16: ",3"}, "SPC1,1,1,2\n")
    assert model.fixed_unknowns.tolist() == [3, 47]
    assert model.mesh.node_set("SPC 1").tolist() == [1]
