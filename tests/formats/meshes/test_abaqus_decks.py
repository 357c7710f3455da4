"""Abaqus and CalculiX decks with shells on surfaces, bolts, sectors, and sets below the lines that use them."""

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.study.model_study import study_of_model

DECK = (Path(__file__).parents[2] / "data" / "models" / "cubes.inp").read_text(encoding="utf-8")
SHELL = "*ELEMENT, TYPE=S4, ELSET=skin\n50, 5, 6, 7, 8\n*SHELL SECTION, ELSET=skin, MATERIAL=steel\n1.\n"
STEP = "*STEP\n*STATIC\n*END STEP\n"


def cubes(folder: Path, cards: str, text: str = DECK) -> ImportedModel:
    path = folder / "cubes.inp"
    head, end, tail = text.partition("*BOUNDARY")
    path.write_text(f"{head}{cards}{end}{tail}", encoding="utf-8")
    return read_model(path, "mm")


def test_sides_of_shells_are_omitted(tmp_path: Path) -> None:
    """A surface keeps its sides of solids; one of shells alone is no face set, and its tie has no effect."""
    surfaces = "*SURFACE, NAME=mixed\n1, S2\nskin, SPOS\n*SURFACE, NAME=shells\nskin, SNEG\n"
    model = cubes(tmp_path, f"{SHELL}{surfaces}*TIE, NAME=t\ncontact, shells\n")
    assert set(model.mesh.face_sets) == {"contact", "opposite", "mixed"}
    np.testing.assert_array_equal(model.mesh.face_sets["mixed"][0], model.mesh.face_sets["contact"][0])
    assert model.equations is None
    assert any("'mixed': its 1 elements without volume" in message for message in model.messages)
    assert any("omitted: 'shells'" in message for message in model.messages)


def test_shell_side_of_a_solid(tmp_path: Path) -> None:
    with rejects(ImportFileError):
        cubes(tmp_path, "*SURFACE, NAME=wrong\n1, SPOS\n")


def test_force_of_a_bolt_is_reported(tmp_path: Path) -> None:
    """The node of a pre-tension section belongs to no solid; its force is no force on the model."""
    bolt = "*NODE, NSET=pre\n900, 0., 0., 0.\n*PRE-TENSION SECTION, SURFACE=contact, NODE=pre\n*CLOAD\npre, 1, 1000.\n"
    model = cubes(tmp_path, bolt)
    plain = cubes(tmp_path, "")
    np.testing.assert_array_equal(model.node_forces, plain.node_forces)
    assert any("PRE-TENSION SECTION" in message for message in model.messages)


def test_sets_below_the_lines_that_use_them(tmp_path: Path) -> None:
    cards = "*NODE\n40, 5., 5., 30.\n*RIGID BODY, NSET=late, REFNODE=40\n*NSET, NSET=late\n13, 14, 15, 16\n"
    equations = cubes(tmp_path, cards).equations
    assert equations is not None
    assert list(equations.places) == [40]


def test_elements_without_displacements(tmp_path: Path) -> None:
    """Pipes with flow and heat elements are counted, as shells."""
    model = cubes(tmp_path, "*ELEMENT, TYPE=D\n60, 1, 2, 3\n*ELEMENT, TYPE=DC3D4\n61, 1, 2, 3, 5\n")
    assert any("50 % of the elements are solid" in doubt for doubt in model.doubts)


def test_a_network_of_flow_is_open_at_node_0(tmp_path: Path) -> None:
    """CalculiX: the node of an inlet or outlet is 0; elements of solids have no such node."""
    model = cubes(tmp_path, "*ELEMENT, TYPE=D\n60, 0, 2, 3\n61, 3, 5, 0\n")
    assert any("50 % of the elements are solid" in doubt for doubt in model.doubts)
    with rejects(ImportFileError):
        cubes(tmp_path, "*ELEMENT, TYPE=S3\n60, 0, 2, 3\n")


def test_temperatures_of_calculix_constrain_no_displacement(tmp_path: Path) -> None:
    """Their direction is 0, or 11."""
    plain = cubes(tmp_path, "")
    for direction in (0, 11):
        model = cubes(tmp_path, f"*BOUNDARY\n5, {direction}, {direction}, 100.\n")
        np.testing.assert_array_equal(model.fixed_unknowns, plain.fixed_unknowns)
        assert any("of temperatures" in message for message in model.messages)


@pytest.mark.parametrize(
    "cards",
    [
        "*TIE, NAME=t, CYCLIC SYMMETRY\nopposite, contact\n*CYCLIC SYMMETRY MODEL, N=12, TIE=t\n0.,0.,0.,0.,0.,1.\n",
        "*CYCLIC SYMMETRY MODEL, N=12, TIE=t\n0.,0.,0.,0.,0.,1.\n",
    ],
)
def test_sector_is_read_for_studies_of_disks_only(tmp_path: Path, cards: str) -> None:
    model = cubes(tmp_path, cards)
    assert model.equations is None
    assert any("one sector of a disk" in message for message in model.messages)
    with rejects(InputError):
        study_of_model(model, "cubes.inp", None)
