"""The matrices of a model file; tests of ties and of mass points compare their frequencies with CalculiX."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import stickslip as ss
from sentences import rejects
from tied_decks import two_blocks, write_deck

MODELS = Path(__file__).parents[2] / "data" / "models"


def model_of_two_blocks(folder: Path) -> ss.ImportedModel:
    """Two blocks of steel in the deck, the upper one with constrained nodes."""
    write_deck(folder / "deck.inp", two_blocks(), "")
    return ss.read_model(folder / "deck.inp", "m")


def test_materials_are_those_of_the_file_unless_others_are_given(tmp_path: Path) -> None:
    model = model_of_two_blocks(tmp_path)
    name = model.mesh.body_names[0]
    light = ss.Material(210e9, 0.3, 1.0)
    steel, other = model.assemble(), model.assemble({name: light})
    assert steel.materials == tuple(model.materials[body] for body in model.mesh.body_names)
    assert other.materials[0] == light
    assert other.mass.sum() < 0.6 * steel.mass.sum()
    np.testing.assert_array_equal(other.stiffness.data, steel.stiffness.data)


def test_a_body_without_material_is_rejected(tmp_path: Path) -> None:
    write_deck(tmp_path / "deck.inp", two_blocks(), "")
    text = (tmp_path / "deck.inp").read_text("utf-8").splitlines()
    start = text.index("*MATERIAL, NAME=steel")
    others = [line for line in text[:start] + text[start + 5 :] if not line.startswith("*SOLID SECTION")]
    (tmp_path / "deck.inp").write_text("\n".join(others), encoding="utf-8")
    with rejects(ss.InputError, "materials"):
        ss.read_model(tmp_path / "deck.inp", "m").assemble()


def test_a_material_for_another_body_is_rejected(tmp_path: Path) -> None:
    with rejects(ss.InputError, "materials"):
        model_of_two_blocks(tmp_path).assemble({"blade": ss.Material()})


def test_a_node_without_coordinates_is_at_the_origin_and_a_normal_is_ignored(tmp_path: Path) -> None:
    """As in CalculiX and Abaqus: omitted coordinates are 0; entries 5 to 7 are the normal of a shell."""
    text = (MODELS / "cubes.inp").read_text(encoding="utf-8")
    plain = ss.read_model(MODELS / "cubes.inp", "mm").mesh.points
    lines = text.splitlines()
    first = lines.index("*NODE, NSET=everything") + 1
    assert [float(word) for word in lines[first].split(",")] == [1.0, 0.0, 0.0, 0.0], "the file of the test has changed"
    lines[first], lines[first + 1] = "1", f"{lines[first + 1]}, 0., 0., 1."
    (tmp_path / "a.inp").write_text("\n".join(lines), encoding="utf-8")
    np.testing.assert_array_equal(ss.read_model(tmp_path / "a.inp", "mm").mesh.points, plain)
