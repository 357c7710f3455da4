"""Abaqus decks with parts and instances: the model is that of the flat deck, and what is wrong is told."""

from pathlib import Path

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.structure.elasticity import Material, assemble_bodies, natural_frequencies
from stickslip.structure.model_facts import body_volumes

MODELS = Path(__file__).parents[2] / "data" / "models"
DECK = MODELS / "cubes_of_parts.inp"
# The same two cubes without parts; the second one is turned by 90 degrees about z and lies on the first one.
FLAT = """\
*NODE
1, 0, 0, 0
2, 10, 0, 0
3, 10, 10, 0
4, 0, 10, 0
5, 0, 0, 10
6, 10, 0, 10
7, 10, 10, 10
8, 0, 10, 10
1001, 0, 0, 10
1002, 0, 10, 10
1003, -10, 10, 10
1004, -10, 0, 10
1005, 0, 0, 20
1006, 0, 10, 20
1007, -10, 10, 20
1008, -10, 0, 20
*ELEMENT, TYPE=C3D8I, ELSET=Cube-1
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8I, ELSET=Cube-2
1001, 1001, 1002, 1003, 1004, 1005, 1006, 1007, 1008
*NSET, NSET=Ends
1, 2, 1007, 1008
*NSET, NSET=held
1, 2, 3, 4
*SURFACE, NAME=Cube-1.Top
1, S2
*SURFACE, NAME=Cube-2.Top
1001, S2
*SURFACE, NAME=Skin
1001, S1
1, S4
1001, S4
*MATERIAL, NAME=steel
*ELASTIC
210000., 0.3
*DENSITY
7.85e-9
*SOLID SECTION, ELSET=Cube-1, MATERIAL=steel
*SOLID SECTION, ELSET=Cube-2, MATERIAL=steel
*BOUNDARY
held, 1, 3
1003, 1, 1
1004, 2, 2
*CLOAD
7, 3, -2.5
Ends, 1, 0.5
"""


@pytest.fixture
def flat(tmp_path: Path) -> ImportedModel:
    (tmp_path / "flat.inp").write_text(FLAT, encoding="utf-8")
    return read_model(tmp_path / "flat.inp", "mm")


def changed(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    """The deck of the data folder with replaced texts."""
    text = DECK.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, "the file of the test has changed"
        text = text.replace(old, new, 1)
    (tmp_path / "deck.inp").write_text(text, encoding="utf-8")
    return tmp_path / "deck.inp"


def frequencies(model: ImportedModel) -> FloatArray:
    materials = [model.materials[name] for name in model.mesh.body_names]
    structure = assemble_bodies(model.mesh, materials, fixed_unknowns=model.fixed_unknowns)
    return natural_frequencies(structure.stiffness, structure.mass, 12)[0]


def test_the_model_is_that_of_the_flat_deck(flat: ImportedModel) -> None:
    model = read_model(DECK, "mm")
    np.testing.assert_allclose(model.mesh.points, flat.mesh.points, rtol=0.0, atol=1e-15)
    np.testing.assert_array_equal(model.node_labels, flat.node_labels)
    np.testing.assert_array_equal(model.element_labels, flat.element_labels)
    np.testing.assert_array_equal(model.mesh.blocks[0].cells, flat.mesh.blocks[0].cells[:1])
    np.testing.assert_array_equal(model.mesh.body, flat.mesh.body)
    assert model.mesh.body_names == flat.mesh.body_names == ("Cube-1", "Cube-2")
    assert {name: vars(each) for name, each in model.materials.items()} == {
        name: vars(each) for name, each in flat.materials.items()
    }
    for name in flat.mesh.face_sets:
        for actual, wanted in zip(model.mesh.sides(name), flat.mesh.sides(name), strict=True):
            np.testing.assert_array_equal(actual, wanted)
    for name in ("Ends", "Cube-2.Top"):
        np.testing.assert_array_equal(model.mesh.node_set(name), flat.mesh.node_set(name))
    np.testing.assert_array_equal(model.mesh.node_set("_PickedSet4"), flat.mesh.node_set("held"))
    assert model.mesh.node_set("Cube-2.Set-1").tolist() == list(range(8, 16))
    np.testing.assert_array_equal(model.fixed_unknowns, flat.fixed_unknowns)
    np.testing.assert_array_equal(model.node_forces, flat.node_forces)
    np.testing.assert_allclose(body_volumes(model.mesh), body_volumes(flat.mesh), rtol=1e-12)
    np.testing.assert_allclose(frequencies(model)[4:], frequencies(flat)[4:], rtol=1e-9)  # after the rigid motions


def test_numbers_and_what_is_left_out_are_reported() -> None:
    messages = read_model(DECK, "mm").messages
    printed_sentence("\n".join(messages), "Cube-1", "Cube-2", "RP-1")


def test_numbers_that_do_not_collide_stay(tmp_path: Path) -> None:
    """Two parts numbered through, and a part without an instance."""
    deck = """\
*PART, NAME=a
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
*ELEMENT, TYPE=C3D4
1, 1, 2, 3, 4
*END PART
*PART, NAME=b
*NODE
11, 0, 0, 0
12, 1, 0, 0
13, 0, 1, 0
24, 0, 0, 1
*ELEMENT, TYPE=C3D4, ELSET=all
11, 11, 12, 13, 24
*NSET, NSET=even, GENERATE
2, 100, 2
*END PART
*PART, NAME=c
*END PART
*ASSEMBLY, NAME=x
*INSTANCE, NAME=A, PART=a
*END INSTANCE
*INSTANCE, NAME=B, PART=B
5.
*END INSTANCE
*END ASSEMBLY
"""
    (tmp_path / "deck.inp").write_text(deck, encoding="utf-8")
    model = read_model(tmp_path / "deck.inp", "m")
    assert model.node_labels.tolist() == [1, 2, 3, 4, 11, 12, 13, 24]
    assert model.node_labels[model.mesh.node_set("B.even")].tolist() == [12, 24]
    assert model.mesh.body_names == ("A", "B"), "a deck without sections has a body for each instance"
    np.testing.assert_allclose(model.mesh.points[4:] - model.mesh.points[:4], [[5.0, 0.0, 0.0]] * 4)
    printed_sentence("\n".join(model.messages), "'c'", "line 21")


def test_rotation_comes_after_translation_about_an_axis_through_space(tmp_path: Path) -> None:
    """A turn by 120 degrees about the diagonal through (1, 2, 3) sends x to y, y to z and z to x about that point."""
    motion = "5., 6., 7.\n1., 2., 3., 4., 5., 6., 120.\n"
    old = (
        "          0.,           0.,          10.\n"
        "          0.,           0.,          10.,           0.,           0.,          11.,          90.\n"
    )
    mesh = read_model(changed(tmp_path, (old, motion)), "mm").mesh
    x, y, z = (1e3 * mesh.points[:8] + np.array([5.0, 6.0, 7.0]) - np.array([1.0, 2.0, 3.0])).T
    np.testing.assert_allclose(1e3 * mesh.points[8:], np.stack([z + 1.0, x + 2.0, y + 3.0], axis=1), atol=1e-12)


def test_a_mesh_in_the_instance_itself_moves_with_it(tmp_path: Path) -> None:
    """Abaqus/CAE leaves the part of an independent instance empty and writes the mesh below its position."""
    text = DECK.read_text(encoding="utf-8")
    start, stop = text.index("*Node\n"), text.index("*End Part")
    mesh = text[start:stop]
    text = text.replace(mesh, "", 1).replace("*End Instance", f"{mesh}*End Instance", 2)
    (tmp_path / "deck.inp").write_text(text, encoding="utf-8")
    actual, wanted = read_model(tmp_path / "deck.inp", "mm"), read_model(DECK, "mm")
    np.testing.assert_array_equal(actual.mesh.points, wanted.mesh.points)
    assert actual.mesh.node_sets.keys() == wanted.mesh.node_sets.keys()
    assert actual.mesh.body_names == wanted.mesh.body_names
    np.testing.assert_array_equal(actual.node_forces, wanted.node_forces)


def test_a_part_in_an_included_file(tmp_path: Path) -> None:
    text = DECK.read_text(encoding="utf-8")
    start, stop = text.index("*Part, name=Cube"), text.index('*Part, name="Empty')
    (tmp_path / "cube.inp").write_text(text[start:stop], encoding="utf-8")
    (tmp_path / "deck.inp").write_text(text[:start] + "*INCLUDE, INPUT=cube.inp\n" + text[stop:], encoding="utf-8")
    actual = read_model(tmp_path / "deck.inp", "mm")
    np.testing.assert_array_equal(actual.mesh.points, read_model(DECK, "mm").mesh.points)
    (tmp_path / "cube.inp").write_text(text[start:stop].replace("10.,          10.,           0.", "x"), "utf-8")
    with rejects(ImportFileError):
        read_model(tmp_path / "deck.inp", "mm")


def test_two_sections_of_an_instance_are_two_bodies(tmp_path: Path) -> None:
    part = """\
*Node
 11, 20., 0., 0.
 12, 20., 10., 0.
 13, 20., 0., 10.
 14, 20., 10., 10.
*Element, type=C3D8I, elset=Tip
2, 2, 11, 12, 3, 6, 13, 14, 7
*Solid Section, elset=Tip, material=Brass
*End Part"""
    brass = '*Material, name=brass\n*Density\n8.5e-9,\n*Elastic\n105000., 0.34\n*Material, name="Tool steel"'
    model = read_model(changed(tmp_path, ("*End Part", part), ('*Material, name="Tool steel"', brass)), "mm")
    assert model.mesh.body_names == ("Cube-1.Set-1", "Cube-1.Tip", "Cube-2.Set-1", "Cube-2.Tip")
    assert vars(model.materials["Cube-2.Tip"]) == pytest.approx(vars(Material(105e9, 0.34, 8500.0)))
    assert model.materials["Cube-2.Set-1"].density == pytest.approx(7850.0)


def test_sets_and_surfaces_of_the_assembly_name_those_of_instances(tmp_path: Path) -> None:
    cards = """\
*Nset, nset=Both
Assembly.Cube-1.Set-1, Cube-2.8, Ends
*Nset, nset=Odd, instance=Cube-2, generate
1, 7, 2
*Nset, nset=Of elements, elset=_Skin_S1
*Elset, elset=Pair, instance=CUBE-2
Set-1
*Elset, elset=Pair
Cube-1.1
*Surface, type=ELEMENT, name=Caps
Pair, S2
Cube-1.Set-1, S1
*Surface, type=NODE, name=Corners
Cube-2.1,
Cube-1.Set-1,
*End Assembly"""
    mesh = read_model(changed(tmp_path, ("*End Assembly", cards)), "mm").mesh
    assert mesh.node_set("Both").tolist() == [*range(8), 14, 15]
    assert mesh.node_set("Odd").tolist() == [8, 10, 12, 14]
    assert mesh.node_set("Of elements").tolist() == list(range(8, 16))
    assert mesh.element_sets["Pair"].tolist() == [0, 1]
    assert mesh.node_set("Caps").tolist() == [*range(8), 12, 13, 14, 15]
    assert mesh.node_set("Corners").tolist() == [*range(9)]


def test_springs_between_instances_are_left_out(tmp_path: Path) -> None:
    spring = "*Element, type=SPRINGA, elset=Springs\n1, Cube-1.7, Assembly.Cube-2.1\n*End Assembly"
    model = read_model(changed(tmp_path, ("*End Assembly", spring)), "mm")
    printed_sentence("\n".join([*model.messages, *model.doubts]), "SPRINGA")
    np.testing.assert_array_equal(model.mesh.points, read_model(DECK, "mm").mesh.points)


def test_names_with_quotes_dots_and_other_capitals(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        ("name=Cube-2, part=Cube", 'name="cube 2.b", part="CUBE"'),
        ("instance=Cube-2\n 7", 'instance="Cube 2.B"\n 7'),
        ("instance=Cube-2", 'instance="Cube 2.B"'),
        ("instance=Cube-2", 'instance="Cube 2.B"'),
        ("Cube-2.3", '"CUBE 2.b".3'),
        ("Cube-2.4", "cube 2.B.4"),
        ("Ends, 1, 0.5", '"Cube 2.b"."set-1", 1, 0.5'),
    )
    model, before = read_model(path, "mm"), read_model(DECK, "mm")
    assert model.mesh.body_names == ("Cube-1", "cube 2.b")
    np.testing.assert_array_equal(model.fixed_unknowns, before.fixed_unknowns)
    np.testing.assert_array_equal(model.mesh.node_set("Ends"), before.mesh.node_set("Ends"))
    assert model.node_forces[8:].tolist() == [[0.5, 0.0, 0.0]] * 8


WRONG = {
    "library": (
        "name=Cube-1, part=Cube",
        "library=old, instance=Cube-1",
    ),
    "unknown part": ("part=Cube\n", "part=Cub\n"),
    "no part": ("name=Cube-1, part=Cube", "name=Cube-1"),
    "open part": ("*End Part\n", ""),
    "open instance": (
        "*End Instance\n",
        "",
    ),
    "open assembly": ("*End Assembly\n", ""),
    "no end": ("*End Part\n", "*End Part\n*End Part\n"),
    "wrong end": ("*End Part\n", "*End Instance\n"),
    "part twice": (
        'name="Empty part"\n',
        "name=CUBE\n",
    ),
    "instance twice": ("name=Cube-2,", "name=cube-1,"),
    "two assemblies": ("*Material", "*Assembly, name=b\n*Material"),
    "instance outside": (
        "*Assembly, name=Assembly\n",
        "",
    ),
    "system": ("*Node\n", "*System\n1.,2.,3.\n*Node\n"),
    "tie": ("*End Assembly", "*Tie, name=t\nSkin, Cube-1.Nowhere\n*End Assembly"),
    "no set": ("_PickedSet4, ENC", "Cube-1.Set-7, ENC"),
    "no instance": (
        "instance=Cube-1\n",
        "instance=Cube-3\n",
    ),
    "instance of a part": (
        "*Nset, nset=Set-1, generate",
        "*Nset, nset=Set-1, generate, instance=Cube-1",
    ),
    "node of the assembly": ("Cube-2.3, 1", "3, 1"),
    "node beyond": (
        "Cube-2.3, 1",
        "Cube-2.9, 1",
    ),
    "node between": (
        "      6,      ",
        "      9,      ",
    ),
    "inverted": (
        "1, 1, 2, 3, 4, 5, 6, 7, 8",
        "1, 5, 6, 7, 8, 1, 2, 3, 4",
    ),
    "force on a point": ("Cube-1.7, 3", "RP-1, 3"),
    "axis": (
        "           0.,          11.,",
        "0., 10.,",
    ),
    "rotation": ("          11.,          90.", "11., 90., 3."),
    "translation": (
        "Cube\n          0.,           0.,          10.\n",
        "Cube\n0., 0., up\n",
    ),
    "third line": (
        '*End Instance\n**\n*Instance, name="E',
        '1,2,3\n*End Instance\n*Instance, name="E',
    ),
    "empty": (
        "*Nset, nset=Set-1, generate\n 1,  8,",
        "*Nset, nset=Set-1, generate\n 9,  18,",
    ),
    "huge numbers": (
        "*Node\n",
        "*Node\n2147483000, 0, 0, 0\n",
    ),
    "section by number": ("*Solid Section, elset=Set-1", "*Solid Section, elset=1"),
}


@pytest.mark.parametrize(("old", "new"), WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_is_reported_with_file_and_line(tmp_path: Path, old: str, new: str) -> None:
    path = changed(tmp_path, (old, new))
    with rejects(ImportFileError):
        read_model(path, "mm")


@pytest.mark.parametrize(
    "end",
    [
        "*Part, name=P\n",
        "*Part, name=P\n*End Part\n",
        "*Assembly, name=A\n",
        "*Part, name=P\n*End Part\n*Assembly\n*Instance, name=I, part=p\n",
        "*Assembly, name=A\n*End Assembly\n",
    ],
)
def test_a_deck_that_ends_early(tmp_path: Path, end: str) -> None:
    (tmp_path / "deck.inp").write_text(end, encoding="utf-8")
    with rejects(ImportFileError):
        read_model(tmp_path / "deck.inp", "mm")
