"""Nastran: combined sets of constraints and loads, coordinate systems, constraints at grids, cards that are refused."""

from pathlib import Path

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model, read_raw

CUBES = Path(__file__).parents[2] / "data" / "models" / "cubes.bdf"
GRID = "GRID,2,,10,0,0\n"


def cubes(tmp_path: Path, cards: str = "", case: str = "SPC = 1", **changes: str) -> ImportedModel:
    """The two cubes with more bulk data, another case control, and GRID 2 as given."""
    text = CUBES.read_text(encoding="utf-8").replace("SPC = 1", case).replace("ENDDATA", cards + "\nENDDATA")
    assert GRID in text
    path = tmp_path / "cubes.bdf"
    path.write_text(text.replace(GRID, changes.get("grid", GRID)), encoding="utf-8")
    return read_model(path, "mm")


def test_added_constraints_combine_those_of_each_set(tmp_path: Path) -> None:
    model = cubes(tmp_path, "SPCADD,9,1,2\nSPC1,2,3,16\nSPC1,3,1,15", "SPC = 9 $ both")
    assert model.fixed_unknowns.tolist() == [*range(12), 3 * 15 + 2]


def test_combined_loads_have_their_factors(tmp_path: Path) -> None:
    cards = "LOAD,7,2.0,3.0,4,-0.5,5\nFORCE,4,16,,1.,0.,0.,1.\nFORCE,5,15,,4.,1.,0.,0.\nFORCE,6,15,,9.,1.,0.,0."
    model = cubes(tmp_path, cards, "SPC = 1\n  LOAD = 7")
    assert model.node_forces[15].tolist() == [0.0, 0.0, 6.0]
    assert model.node_forces[14].tolist() == [-4.0, 0.0, 0.0]
    assert np.count_nonzero(model.node_forces) == 2


@pytest.mark.parametrize(
    ("cards", "case"),
    [
        ("", "SPC = 3"),
        ("SPCADD,9,1,4", "SPC = 9"),
        ("SPCADD,9", "SPC = 9"),
        ("SPCADD,9,1\nSPCADD,9,1", "SPC = 9"),
        ("LOAD,9,x,1.,4", "LOAD = 9"),
        ("RBE2,50,1,129,2", "SPC = 1"),
        ("RBE2,50,1,123", "SPC = 1"),
        ("RBE2,50,1,123,14\nRBE2,51,2,123,14", "SPC = 1"),
        ("RBE1,50,1,123456,,,,,,+\n+,UM,2,123", "SPC = 1"),
        ("RBE3,50,,14,123456,1.,12,1,2", "SPC = 1"),
        ("RBE3,50,,14,123456,1.,123,1,2", "SPC = 1"),
        ("RBE3,50,,14,123456,0.,123,1,2,+\n+,4", "SPC = 1"),
        ("RBAR,50,1,2,123,456", "SPC = 1"),
        ("RROD,50,1,99", "SPC = 1"),
        ("MPC,5,1,12,1.,2,1,-1.", "SPC = 1\nMPC = 5"),
        ("MPC,5,1,1,0.,2,1,-1.", "SPC = 1\nMPC = 5"),
        ("MPC,5,99,1,1.,2,1,-1.", "SPC = 1\nMPC = 5"),
        ("MPC,5,1,1,1.,2,1,-1.", "SPC = 1\nMPC = 6"),
        ("MPCADD,7,5\nMPCADD,7,5\nMPC,5,1,1,1.,2,1,-1.", "SPC = 1\nMPC = 7"),
        ("BEGIN SUPER=1", "SPC = 1"),
    ],
)
def test_what_cannot_be_resolved_is_rejected(tmp_path: Path, cards: str, case: str) -> None:
    with rejects(ImportFileError):
        cubes(tmp_path, cards, case)


def test_what_does_not_act_is_reported(tmp_path: Path) -> None:
    model = cubes(tmp_path, "MPC,5,1,1,1.,2,1,-1.")
    printed_sentence("\n".join(model.messages), "MPC")
    model = cubes(tmp_path, "LOAD,7,1.0,1.0,4", "LOAD = 7")
    printed_sentence("\n".join(model.messages), "LOAD 7", "FORCE", "SPC")
    model = cubes(tmp_path, "SPC1,2,1,15", "SUBCASE 1\nSPC = 1\nSUBCASE 2\nSPC = 2")
    printed_sentence("\n".join(model.messages), "SPC = 1, 2")


def test_a_grid_in_a_turned_system(tmp_path: Path) -> None:
    """System 4 is turned by 90 degrees about x of system 3, which lies at (10, 0, 0)."""
    systems = "CORD2R,4,3,0.,0.,0.,0.,-1.,0.,+\n+,1.,0.,0.\nCORD2R,3,,10.,0.,0.,10.,0.,1.,+\n+,11.,0.,0."
    model = cubes(tmp_path, systems, grid="GRID,2,4,0.,0.,0.\n")
    np.testing.assert_allclose(model.mesh.points[1], [0.01, 0.0, 0.0], atol=1e-15)
    # z of system 4 is -y, x stays, y is z
    model = cubes(tmp_path, systems, grid="GRID,2,4,1.,2.,3.\n")
    np.testing.assert_allclose(model.mesh.points[1], [0.011, -0.003, 0.002], atol=1e-15)


@pytest.mark.parametrize(
    "system",
    [
        "CORD2R,4,,0.,0.,0.,0.,0.,1.,+\n+,0.,0.,2.",
        "CORD2R,4,4,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,2.",
        "CORD3R,4,1,2,3",
    ],
)
def test_systems_that_give_no_axes(tmp_path: Path, system: str) -> None:
    with rejects(ImportFileError):
        cubes(tmp_path, system, grid="GRID,2,4,0.,0.,0.\n")


def test_permanent_constraints_of_a_grid_act(tmp_path: Path) -> None:
    model = cubes(tmp_path, grid="GRID,2,,10.,0.,0.,,3456\n", case="")
    assert 5 in model.fixed_unknowns
    model = cubes(tmp_path, grid="GRID,2,,10.,0.,0.,,456\n", case="SPC = 1")
    assert model.fixed_unknowns.size == 12


def test_replicated_entries(tmp_path: Path) -> None:
    """ "=" copies a field, "*1" adds to it, "==" copies the others, "=2" repeats the line above two times."""
    bulk = CUBES.read_text(encoding="utf-8").partition("BEGIN BULK\n")[2]
    case = "BEGIN BULK\nGRID,101,,0.,0.,0.,,123\n=,*1,=,*1.5,==\n=(2)\n=,201,=,=,2.,==\n=,*(1),=,*-1.5+0,==\n"
    raw = read_raw(_deck(tmp_path, case + bulk))
    new = raw.node_labels > 100
    assert raw.node_labels[new].tolist() == [101, 102, 103, 104, 201, 202]
    assert raw.coordinates[new].tolist() == [
        [0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [3.0, 0.0, 0.0], [4.5, 0.0, 0.0], [4.5, 2.0, 0.0], [3.0, 2.0, 0.0],
    ]  # fmt: skip
    assert sum(101 in each.nodes or 202 in each.nodes for each in raw.constraints) == 2


@pytest.mark.parametrize(
    "cards",
    [
        "=,*1,==\n",
        "GRID,101,,0.,0.,0.\n=2\n",
        "GRID,101,,0.,0.,0.\n=,*1,==\n=two\n",
        "GRID,101,,0.,0.,0.\n=,*x,==\n",
        "GRID,101,,0.,0.,0.\n=,*1,==\n=999999999\n",
        "CHEXA,101,1,1,2,3,4,5,6\n,7,8\n=,*1,==\n",
    ],
)
def test_wrong_replication(tmp_path: Path, cards: str) -> None:
    with rejects(ImportFileError):
        read_raw(_deck(tmp_path, f"BEGIN BULK\n{cards}"))


def test_deck_without_properties(tmp_path: Path) -> None:
    """Gmsh writes no PSOLID: the bodies are there, without material."""
    lines = CUBES.read_text(encoding="utf-8").splitlines()
    model = read_model(_deck(tmp_path, "\n".join(line for line in lines if not line.startswith("PSOLID"))), "mm")
    assert len(model.mesh.body_names) == 2
    assert not model.materials
    assert any("no PSOLID" in message for message in model.messages)


def _deck(folder: Path, text: str) -> Path:
    path = folder / "deck.bdf"
    path.write_text(text, encoding="utf-8")
    return path
