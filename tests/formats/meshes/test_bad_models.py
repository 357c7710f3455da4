"""What is wrong in a model file is told with the file, the line and the entry."""

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.meshes.read import read_model
from stickslip.formats.meshes.unit_systems import UNIT_SYSTEMS, find_unit_system

MODELS = Path(__file__).parents[2] / "data" / "models"


def changed(tmp_path, name, old, new, count=1):
    text = (MODELS / name).read_text(encoding="utf-8")
    assert old in text, "the file of the test has changed"
    path = tmp_path / name
    path.write_text(text.replace(old, new, count), encoding="utf-8")
    return path


ABAQUS = [
    ("TYPE=C3D8I", "TYPE=C3D5", r"line 20: \*ELEMENT: the element type C3D5 is not known.*C3D10"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 4, 3, 2, 1, 8, 7, 6,\n5", r"line 21: element 1 \(hexahedron\) is inverted"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 1, 2, 3, 3, 5, 6, 7,\n8", r"line 21: element 1 \(hexahedron\) has a node more"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 1, 2, 3, 4, 5, 6, 7,\n99", r"line 21: element 1 has node 99, which the file"),
    ("1, 1, 2, 3, 4, 5, 6, 7,\n8", "1, 1, 2, 3, 4, 5, 6, 7\n", r"line 21: \*ELEMENT: the last element has 7 of 8"),
    ("8\n*ELEMENT", "8\n7, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT", "line 23: element 7 has the same nodes as element 1"),
    ("2, 9,", "1, 9,", r"line 24: element 1 is defined twice \(first in line 21\)"),
    ("*NSET, NSET=base\n1, 2, 3, 4", "*NSET, NSET=base", r"line 26: \*NSET: node set 'base' is empty"),
    ("*NSET, NSET=base\n1,", "*NSET, NSET=base\n77,", "line 26: node set 'base' names node 77, which the file does"),
    ("1, S2", "1, S7", r'line 31: \*SURFACE: "S7" is no side'),
    ("1, S2", "5, S2", "line 31: surface 'contact' names element 5, which is no solid"),
    ("1, S2", "rim, S2", r"line 31: \*SURFACE: there is no element set 'rim'"),
    ("*ELASTIC\n", "*ELASTIC, TYPE=ORTHO\n", r"\*ELASTIC: TYPE=ORTHO is not read"),
    ("NAME=steel", "NAME=iron", "body 'lower' has the material 'STEEL', which the file does not define"),
    (
        "*SOLID SECTION, ELSET=UPPER, MATERIAL=Steel\n",
        "",
        "line 24: element 2 belongs to no section .*material is miss",
    ),
    ("ELSET=UPPER", "ELSET=LOWER", "element 1 belongs to 'lower' and to 'lower'"),
    ("210000.0, 0.3", "210000.0, 0.7", "material 'STEEL': poisson_ratio is 0.7"),
    ("210000.0, 0.3", "210000.0, zero", r'\*ELASTIC: "zero" is no number'),
    ("base, 1, 3", "base, 1, 3, 0.5", r"\*BOUNDARY: a displacement other than 0"),
    ("base, 1, 3", "bottom, 1, 3", r"\*BOUNDARY: there is no node set 'bottom' above"),
    ("*HEADING", "*PART, NAME=a\n*HEADING", r"line 35: \*MATERIAL: it stands inside of the part 'a' \(line 1\)"),
    ("*BOUNDARY", "*EQUATION\n2\n1,1,1.,2,1,-1.\n*BOUNDARY", r"line \d+: \*EQUATION: it ties nodes .* interface of"),
    ("*BOUNDARY", "*TIE, NAME=t\nopposite, contact\n*BOUNDARY", r"\*TIE: it ties nodes"),
    ("*BOUNDARY", "*RIGID BODY, NSET=base, REF NODE=1\n*BOUNDARY", r"\*RIGID BODY: it ties nodes"),
    ("*BOUNDARY", "*Coupling, ref node=1, surface=contact\n*Kinematic\n*BOUNDARY", r"\*COUPLING: it ties nodes"),
    ("*BOUNDARY", "*MPC\nBEAM, 1, 2\n*BOUNDARY", r"\*MPC: it ties nodes"),
    ("*HEADING", "1, 2, 3\n*HEADING", "line 1: .* stands before the first keyword"),
    ("*HEADING", "*INCLUDE, INPUT=nowhere.inp\n*HEADING", "nowhere.inp: the file cannot be read"),
    ("*HEADING", "*INCLUDE, INPUT=cubes.inp\n*HEADING", "include each other more than 5 deep"),
]


@pytest.mark.parametrize(("old", "new", "words"), ABAQUS)
def test_abaqus_decks(tmp_path, old, new, words):
    with pytest.raises(ImportFileError, match=words) as caught:
        read_model(changed(tmp_path, "cubes.inp", old, new), "mm")
    assert "cubes.inp" in str(caught.value) or "nowhere.inp" in str(caught.value)


NASTRAN = [
    ("PSOLID,2,7", "PSOLID,3,7", "element 2 has the property 2, but there is no such PSOLID"),
    ("PSOLID,2,7", "PSOLID,2,8", "body 'upper' has the material '8', which the file does not define"),
    ("GRID,1,,0,0,0", "GRID,1,5,0,0,0", r"line 5: GRID: there is no coordinate system 5. Read are CORD1R"),
    ("GRID,1,,0,0,0", "GRID,1,,0,x,0", 'GRID: field 5 is "x", not a number'),
    ("GRID,2,", "GRID,1,", r"node 1 is defined twice \(first in line 5\)"),
    ("MAT1,7,210000.0,,0.3", "MAT1,7,210000.0,,0.6", "material '7': poisson_ratio is 0.6"),
    ("CQUAD4,3,100,5,6,7,8", "CQUAD4,3,100,5,6,7,2", "surface 'contact' has a side with nodes 5, 6, 7, 2, which is no"),
    ("SPC1,1,123,1", "SPC1,1,127,1", "SPC1: it needs components out of 1 to 6"),
    ("SPC1,1,123,1", "SPC1,1,123,99", "node 99 does not exist"),
    ("PSOLID,1,7", "CPYRAM,9,1,1,2,3,4,5\nPSOLID,1,7", "CPYRAM: pyramids are not read"),
]


@pytest.mark.parametrize(("old", "new", "words"), NASTRAN)
def test_nastran(tmp_path, old, new, words):
    with pytest.raises(ImportFileError, match=words) as caught:
        read_model(changed(tmp_path, "cubes.bdf", old, new), "mm")
    assert "cubes.bdf" in str(caught.value)


def test_a_pressed_side_is_a_face_set(tmp_path):
    path = changed(tmp_path, "cubes.bdf", "PSOLID,1,7", "PLOAD4,4,1,1.0,,,,5,7\nFORCE,3,16,,2.,0.,0.,-1.5\nPSOLID,1,7")
    model = read_model(path, "mm")
    np.testing.assert_array_equal(model.mesh.node_set("PLOAD4 4"), model.mesh.node_set("contact"))
    assert model.node_forces[15] == pytest.approx([0.0, 0.0, -3.0])
    assert model.mesh.node_set("FORCE 3").tolist() == [15]
    with rejects(ImportFileError):
        read_model(changed(tmp_path, "cubes.bdf", "PSOLID,1,7", "PLOAD4,4,1,1.0,,,,5,6\nPSOLID,1,7"), "mm")


def test_other_cards_are_told(tmp_path):
    model = read_model(changed(tmp_path, "cubes.bdf", "PSOLID,1,7", "CONM2,50,1,,1.\nPSOLID,1,7"), "mm")
    assert any("CONM2" in message and "without effect" in message for message in model.messages)
    model = read_model(changed(tmp_path, "cubes.inp", "*BOUNDARY", "*CONTACT PAIR\nopposite, contact\n*BOUNDARY"), "mm")
    assert any("*CONTACT PAIR" in message for message in model.messages)


def test_generated_sets_free_sides_and_forces(tmp_path):
    cards = (
        "*NSET, NSET=odd, GENERATE\n1, 999999999, 2\n*SURFACE, NAME=skin\nupper\n"
        "*STEP\n*CLOAD\nodd, 2, 1.5\n*END STEP\n*BOUNDARY\n"
    )
    model = read_model(changed(tmp_path, "cubes.inp", "*BOUNDARY\n", cards), "mm")
    np.testing.assert_array_equal(model.mesh.node_set("odd"), np.arange(0, 16, 2))
    assert [len(side) for side in model.mesh.sides("skin")] == [6]
    assert model.node_forces.sum(axis=0) == pytest.approx([0.0, 12.0, 0.0])
    assert model.node_numbers(np.array([16, 1])).tolist() == [15, 0]


def test_odd_units_are_warned_of():
    sound = read_model(MODELS / "cubes.inp", "mm")
    assert sound.warnings == ()
    wrong = read_model(MODELS / "cubes.inp", "m")
    assert any("density 7.85e-09 kg/m3" in sentence for sentence in wrong.warnings)
    assert any("Young's modulus 2.1e+05 Pa" in sentence for sentence in wrong.warnings)
    other = read_model(MODELS / "cubes.inp", "mm", "mm-kg-ms")
    assert any("density 7.85 kg/m3" in sentence for sentence in other.warnings)


@pytest.mark.parametrize(
    ("name", "pressure", "density", "force"),
    [
        ("mm-t-s", 1e6, 1e12, 1.0),
        ("mm-kg-ms", 1e9, 1e9, 1e3),
        ("SI", 1.0, 1.0, 1.0),
        ("in-lbf-s", 6894.757, None, 4.448222),
    ],
)
def test_unit_systems(name, pressure, density, force):
    system = UNIT_SYSTEMS[name]
    assert system.pressure == pytest.approx(pressure, rel=1e-6)
    assert system.force == pytest.approx(force, rel=1e-6)
    assert density is None or system.density == pytest.approx(density)


def test_units_that_do_not_exist_or_fit():
    with rejects(InputError, "length_unit"):
        find_unit_system("yard")
    with rejects(InputError, "unit_system", "length_unit"):
        find_unit_system("mm", "SI")
    with rejects(ImportFileError):
        read_model("part.stp", "mm")
    with rejects(ImportFileError):
        read_model("part.inp", "mm")


def test_one_name_for_two_sets_is_told(tmp_path):
    cards = "*NSET, NSET=upper\n9, 10\n*BOUNDARY"
    model = read_model(changed(tmp_path, "cubes.inp", "*BOUNDARY", cards), "mm")
    assert model.mesh.node_set("upper").tolist() == [8, 9]
    assert any("'upper' is that of an element set and of a node set with other" in words for words in model.messages)
    assert read_model(MODELS / "cubes.inp", "mm").messages == ()


def test_nodes_that_are_not_merged_are_counted(tmp_path):
    """Both cubes as one body: the four nodes of each meet the four of the other, unjoined."""
    path = changed(tmp_path, "cubes.bdf", "CHEXA          2       2", "CHEXA          2       1")
    messages = read_model(path, "mm").messages
    assert any("body 'lower' has 8 nodes that lie at the place of another" in words for words in messages)
    assert any("body 'lower' consists of 2 separate parts" in words for words in messages)
