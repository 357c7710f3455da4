"""What is wrong in a model file is told with the file, the line and the entry."""

from pathlib import Path

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.meshes.read import read_model
from stickslip.formats.meshes.unit_systems import UNIT_SYSTEMS, find_unit_system

MODELS = Path(__file__).parents[2] / "data" / "models"


def changed(tmp_path: Path, name: str, old: str, new: str, count: int = 1) -> Path:
    text = (MODELS / name).read_text(encoding="utf-8")
    assert old in text, "the file of the test has changed"
    path = tmp_path / name
    path.write_text(text.replace(old, new, count), encoding="utf-8")
    return path


ABAQUS = [
    ("TYPE=C3D8I", "TYPE=C3D5"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 4, 3, 2, 1, 8, 7, 6,\n5"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 1, 2, 3, 3, 5, 6, 7,\n8"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 1, 2, 3, 4, 5, 6, 7,\n99"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 1, 2, 3, 4, 5, 6, 7\n"),
    ("8\n*ELEMENT", "8\n7, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT"),
    ("2, 9,", "1, 9,"),
    ("*NODE, NSET=everything", "*NODE, NSET=everything\n,"),
    ("*NSET, NSET=base\n1, 2, 3, 4", "*NSET, NSET=base"),
    ("*NSET, NSET=base\n1,", "*NSET, NSET=base\n77,"),
    ("1, S2", "1, S7"),
    ("1, S2", "5, S2"),
    ("1, S2", "rim, S2"),
    ("*ELASTIC\n", "*ELASTIC, TYPE=ORTHO\n"),
    ("NAME=steel", "NAME=iron"),
    (
        "*SOLID SECTION, ELSET=UPPER, MATERIAL=Steel\n",
        "",
    ),
    ("ELSET=UPPER", "ELSET=LOWER"),
    ("210000.0, 0.3", "210000.0, 0.7"),
    ("210000.0, 0.3", "210000.0, zero"),
    ("base, 1, 3", "base, 4, 3"),
    ("base, 1, 3", "bottom, 1, 3"),
    ("*HEADING", "*PART, NAME=a\n*HEADING"),
    ("*BOUNDARY", "*EQUATION\n3\n1,1,1.,2,1,-1.\n*BOUNDARY"),
    ("*BOUNDARY", "*EQUATION\n2\n1,1,0.,2,1,-1.\n*BOUNDARY"),
    ("*BOUNDARY", "*EQUATION\n2\n1,7,1.,2,1,-1.\n*BOUNDARY"),
    ("*BOUNDARY", "*EQUATION\n2\n99,1,1.,2,1,-1.\n*BOUNDARY"),
    ("*BOUNDARY", "*EQUATION\n2\nbase,1,1.,everything,1,-1.\n*BOUNDARY"),
    ("*BOUNDARY", "*EQUATION\n2\n13,1,1.,14,1,-1.\n2\n13,1,1.,15,1,-1.\n*BOUNDARY"),
    ("*BOUNDARY", "*EQUATION, REMOVE\n1,1\n*BOUNDARY"),
    ("*BOUNDARY", "*TIE, NAME=t\nopposite, nothing\n*BOUNDARY"),
    ("*BOUNDARY", "*NSET, NSET=far\n16\n*SURFACE, NAME=far, TYPE=NODE\nfar\n*TIE, NAME=t\nfar, contact\n*BOUNDARY"),
    ("*BOUNDARY", "*TIE, NAME=t, MULTISTAGE\nopposite, contact\n*BOUNDARY"),
    ("*BOUNDARY", "*RIGID BODY, NSET=base\n*BOUNDARY"),
    ("*BOUNDARY", "*RIGID BODY, NSET=base, REF NODE=base\n*BOUNDARY"),
    ("*BOUNDARY", "*Coupling, ref node=1, surface=contact\n*BOUNDARY"),
    ("*BOUNDARY", "*Coupling, ref node=1, surface=contact, orientation=o\n*Kinematic\n*BOUNDARY"),
    ("*BOUNDARY", "*NSET, NSET=edge\n14, 15\n*Coupling, ref node=1, surface=edge\n*Distributing\n*BOUNDARY"),
    ("*BOUNDARY", "*Kinematic\n*BOUNDARY"),
    ("*BOUNDARY", "*MPC\nBEAM, 1, 2, 3\n*BOUNDARY"),
    ("*BOUNDARY", "*MPC\nMEANROT, 1, 1, 1, 2, 2, 2, 3\n*BOUNDARY"),
    ("*BOUNDARY", "*MPC\nPLANE, 13, 14, 15\n*BOUNDARY"),
    ("*BOUNDARY", "*TRANSFORM, NSET=base, TYPE=S\n0., 0., 0., 0., 0., 1.\n*BOUNDARY"),
    ("*BOUNDARY", "*TRANSFORM, NSET=base\n1., 0., 0., 2., 0., 0.\n*BOUNDARY"),
    ("*NODE", "*SYSTEM\n1., 2., 3., 4.\n*NODE"),
    ("*HEADING", "1, 2, 3\n*HEADING"),
    ("*HEADING", "*INCLUDE, INPUT=nowhere.inp\n*HEADING"),
    ("*HEADING", "*INCLUDE, INPUT=cubes.inp\n*HEADING"),
]


@pytest.mark.parametrize(("old", "new"), ABAQUS)
def test_abaqus_decks(tmp_path: Path, old: str, new: str) -> None:
    with rejects(ImportFileError):
        read_model(changed(tmp_path, "cubes.inp", old, new), "mm")


NASTRAN = [
    ("PSOLID,2,7", "PSOLID,3,7"),
    ("PSOLID,2,7", "PSOLID,2,8"),
    ("GRID,1,,0,0,0", "GRID,1,5,0,0,0"),
    ("GRID,1,,0,0,0", "GRID,1,,0,x,0"),
    ("GRID,2,", "GRID,1,"),
    ("MAT1,7,210000.0,,0.3", "MAT1,7,210000.0,,0.6"),
    ("CQUAD4,3,100,5,6,7,8", "CQUAD4,3,100,5,6,7,2"),
    ("SPC1,1,123,1", "SPC1,1,127,1"),
    ("SPC1,1,123,1", "SPC1,1,123,99"),
    ("PSOLID,1,7", "CPYRAM,9,1,1,2,3,4,5\nPSOLID,1,7"),
]


@pytest.mark.parametrize(("old", "new"), NASTRAN)
def test_nastran(tmp_path: Path, old: str, new: str) -> None:
    with rejects(ImportFileError):
        read_model(changed(tmp_path, "cubes.bdf", old, new), "mm")


def test_a_pressed_side_is_a_face_set(tmp_path: Path) -> None:
    path = changed(tmp_path, "cubes.bdf", "PSOLID,1,7", "PLOAD4,4,1,1.0,,,,5,7\nFORCE,3,16,,2.,0.,0.,-1.5\nPSOLID,1,7")
    model = read_model(path, "mm")
    np.testing.assert_array_equal(model.mesh.node_set("PLOAD4 4"), model.mesh.node_set("contact"))
    assert model.node_forces[15] == pytest.approx([0.0, 0.0, -3.0])
    assert model.mesh.node_set("FORCE 3").tolist() == [15]
    with rejects(ImportFileError):
        read_model(changed(tmp_path, "cubes.bdf", "PSOLID,1,7", "PLOAD4,4,1,1.0,,,,5,6\nPSOLID,1,7"), "mm")


def test_other_cards_are_reported(tmp_path: Path) -> None:
    model = read_model(changed(tmp_path, "cubes.bdf", "PSOLID,1,7", "CMASS2,50,1.,1,1\nPSOLID,1,7"), "mm")
    printed_sentence("\n".join(model.messages), "CMASS2")
    model = read_model(changed(tmp_path, "cubes.inp", "*BOUNDARY", "*CONTACT PAIR\nopposite, contact\n*BOUNDARY"), "mm")
    printed_sentence("\n".join(model.messages), "contact pair")


def test_generated_sets_free_sides_and_forces(tmp_path: Path) -> None:
    cards = (
        "*NSET, NSET=odd, GENERATE\n1, 999999999, 2\n*SURFACE, NAME=skin\nupper\n"
        "*STEP\n*CLOAD\nodd, 2, 1.5\n*END STEP\n*BOUNDARY\n"
    )
    model = read_model(changed(tmp_path, "cubes.inp", "*BOUNDARY\n", cards), "mm")
    np.testing.assert_array_equal(model.mesh.node_set("odd"), np.arange(0, 16, 2))
    assert [len(side) for side in model.mesh.sides("skin")] == [6]
    assert model.node_forces.sum(axis=0) == pytest.approx([0.0, 12.0, 0.0])
    assert model.node_numbers(np.array([16, 1])).tolist() == [15, 0]


def test_odd_units_are_warned_of() -> None:
    sound = read_model(MODELS / "cubes.inp", "mm")
    assert sound.warnings == ()
    wrong = read_model(MODELS / "cubes.inp", "m")
    printed_sentence("\n".join(wrong.warnings), "7.85e-09 kg/m3", "2.1e+05 Pa")
    other = read_model(MODELS / "cubes.inp", "mm", "mm-kg-ms")
    printed_sentence("\n".join(other.warnings), "7.85 kg/m3")


@pytest.mark.parametrize(
    ("name", "pressure", "density", "force"),
    [
        ("mm-t-s", 1e6, 1e12, 1.0),
        ("mm-kg-ms", 1e9, 1e9, 1e3),
        ("SI", 1.0, 1.0, 1.0),
        ("in-lbf-s", 6894.757, None, 4.448222),
    ],
)
def test_unit_systems(name: str, pressure: float, density: float | None, force: float) -> None:
    system = UNIT_SYSTEMS[name]
    assert system.pressure == pytest.approx(pressure, rel=1e-6)
    assert system.force == pytest.approx(force, rel=1e-6)
    assert density is None or system.density == pytest.approx(density)


def test_units_that_do_not_exist_or_fit() -> None:
    with rejects(InputError, "length_unit"):
        find_unit_system("yard")
    with rejects(InputError, "unit_system", "length_unit"):
        find_unit_system("mm", "SI")
    with rejects(ImportFileError):
        read_model("part.stp", "mm")
    with rejects(ImportFileError):
        read_model("part.inp", "mm")


def test_one_name_for_two_sets_is_reported(tmp_path: Path) -> None:
    cards = "*NSET, NSET=upper\n9, 10\n*BOUNDARY"
    model = read_model(changed(tmp_path, "cubes.inp", "*BOUNDARY", cards), "mm")
    assert model.mesh.node_set("upper").tolist() == [8, 9]
    printed_sentence("\n".join(model.messages), "upper")
    assert read_model(MODELS / "cubes.inp", "mm").messages == ()


def test_nodes_that_are_not_merged_are_counted(tmp_path: Path) -> None:
    """Both cubes as one body: the four nodes of each meet the four of the other, unjoined."""
    path = changed(tmp_path, "cubes.bdf", "CHEXA          2       2", "CHEXA          2       1")
    messages = read_model(path, "mm").doubts
    printed_sentence("\n".join(messages), "lower")
