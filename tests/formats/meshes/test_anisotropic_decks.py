"""Anisotropic materials of decks: frequencies of CalculiX, and the same body in Abaqus, Nastran and a study."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.formats.meshes.read import read_model
from stickslip.structure.anisotropy import orthotropic_matrix, rotated_matrix
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from tied_decks import block, frequencies_of_calculix, write_deck

MODELS = Path(__file__).parents[2] / "data" / "models"
LAMINATE = ([160e9, 11e9, 9e9], [0.3, 0.25, 0.4], [6e9, 5e9, 3e9])
# Abaqus: axis 1 and a point in the plane 1, 2, then a turn of 25 degrees about axis 1.
ORIENTATION = "*ORIENTATION, NAME=Fibre, SYSTEM=RECTANGULAR\n1., 1., 0.2, -1., 1.2, 0.4\n1, 25.\n"
ENGINEERING = "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n160e9, 11e9, 9e9, 0.3, 0.25, 0.4, 6e9, 5e9,\n3e9\n"


def fibre_axes() -> np.ndarray:
    first = np.array([1.0, 1.0, 0.2])
    third = np.cross(first, [-1.0, 1.2, 0.4])
    first, third = first / np.linalg.norm(first), third / np.linalg.norm(third)
    second = np.cross(third, first)
    c, s = np.cos(np.radians(25.0)), np.sin(np.radians(25.0))
    return np.vstack([first, c * second + s * third, c * third - s * second])


def orthotropic_card(factor: float = 1.0) -> str:
    """Without the end of its last line; the shear modulus G12 does not depend on the factor."""
    d = factor * orthotropic_matrix(*LAMINATE)  # order xx, yy, zz, xy, yz, zx
    d[3, 3] /= factor
    values = [d[0, 0], d[0, 1], d[1, 1], d[0, 2], d[1, 2], d[2, 2], d[3, 3], d[5, 5], d[4, 4]]
    return "*ELASTIC, TYPE=ORTHO\n" + ", ".join(f"{value:.12e}" for value in values[:8]) + f",\n{values[8]:.12e}"


def anisotropic_card() -> str:
    d = rotated_matrix(orthotropic_matrix(*LAMINATE), fibre_axes())[np.ix_([0, 1, 2, 3, 5, 4], [0, 1, 2, 3, 5, 4])]
    words = [f"{d[row, column]:.12e}" for column in range(6) for row in range(column + 1)]
    return "*ELASTIC, TYPE=ANISO\n" + ",\n".join(", ".join(words[at : at + 8]) for at in (0, 8, 16)) + "\n"


def write_block(path: Path, material: str, oriented: bool = True) -> None:
    """A clamped block of 20-node bricks of one anisotropic material."""
    mesh = block((2, 2, 4), (0, 0, 0), (20e-3, 16e-3, 40e-3)).quadratic()
    sets = {"bottom": np.flatnonzero(mesh.points[:, 2] == 0.0)}
    sets |= dict.fromkeys(("lower", "upper", "top"), np.flatnonzero(mesh.points[:, 2] == 40e-3))
    write_deck(path, type(mesh)(mesh.points, mesh.bricks(), mesh.body, sets, ("a",)), "")
    text = path.read_text(encoding="utf-8").replace("*ELASTIC\n210e9, 0.3\n", material).replace("7850.", "1600.")
    section = "*SOLID SECTION, ELSET=a, MATERIAL=steel"
    oriented_section = f"{ORIENTATION}{section}, ORIENTATION=FIBRE"
    path.write_text(text.replace(section, oriented_section if oriented else section), encoding="utf-8")


def frequencies(path: Path, temperature: float | None = None) -> np.ndarray:
    model = read_model(path, "m", temperature=temperature)
    materials = [model.materials[name] for name in model.mesh.body_names]
    structure = assemble_bodies(model.mesh, materials, fixed_unknowns=model.fixed_unknowns)
    return natural_frequencies(structure.stiffness, structure.mass, 8)[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("card", "oriented"),
    [(ENGINEERING, True), (orthotropic_card() + "\n", True), (anisotropic_card(), True), (anisotropic_card(), False)],
    ids=["engineering", "orthotropic", "anisotropic turned", "anisotropic"],
)
def test_frequencies_of_calculix(tmp_path: Path, card: str, oriented: bool) -> None:
    write_block(tmp_path / "block.inp", card, oriented)
    np.testing.assert_allclose(
        frequencies(tmp_path / "block.inp"), frequencies_of_calculix(tmp_path / "block.inp", 8), rtol=1e-5
    )


@pytest.mark.slow
def test_temperature_of_calculix(tmp_path: Path) -> None:
    """Constants between two rows of the table, with the temperature as an initial condition of CalculiX."""
    cooler, hotter = (orthotropic_card(factor) + f", {place}\n" for factor, place in ((1.0, 20.0), (0.7, 620.0)))
    write_block(tmp_path / "block.inp", cooler + hotter.partition("\n")[2])
    path = tmp_path / "block.inp"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("*STEP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 470.\n*STEP"), encoding="utf-8")
    at_470, cold = frequencies(path, 470.0), frequencies(path)
    np.testing.assert_allclose(at_470, frequencies_of_calculix(path, 8), rtol=1e-5)
    assert (at_470 < 0.95 * cold).all()
    np.testing.assert_allclose(frequencies(path, -50.0), cold, rtol=1e-12)
    printed_sentence("\n".join(read_model(path, "m").messages), "--temperature")


@pytest.mark.slow
def test_export_to_calculix(tmp_path: Path) -> None:
    """An anisotropic body in the deck that stickslip writes."""
    write_block(tmp_path / "block.inp", ENGINEERING)
    model = read_model(tmp_path / "block.inp", "m")
    (material,) = model.materials.values()
    fixed = model.mesh.node_set("bottom")
    write_calculix_deck(tmp_path / "again.inp", model.mesh, material, fixed_nodes=fixed, count=8)
    computed = frequencies_of_calculix(tmp_path / "again.inp", 8)
    np.testing.assert_allclose(computed, frequencies(tmp_path / "block.inp"), rtol=1e-5)


def nastran(tmp_path: Path, material: str, system: str = "5") -> np.ndarray:
    """Elastic matrix of the lower cube of a deck, Pa, with the axes of the fibres as system 5."""
    axes = fibre_axes()
    values = [f"{value:.12f}" for value in (*axes[2], *axes[0])]
    text = (MODELS / "cubes.bdf").read_text(encoding="utf-8").replace("PSOLID,1,7", f"PSOLID,1,9,{system}")
    card = f"CORD2R,5,0,0.,0.,0.,{','.join(values[:3])},+\n+,{','.join(values[3:])}"
    card += "\nCORD2C,6,0,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0."
    (tmp_path / "cubes.bdf").write_text(text.replace("ENDDATA", f"{card}\n{material}\nENDDATA"), encoding="utf-8")
    return read_model(tmp_path / "cubes.bdf", "mm").materials["lower"].elastic_matrix()


MAT11 = "MAT11,9,160000.,11000.,9000.,.3,.25,.4,6000.,+\n+,5000.,3000.,1.6e-9"


def mat9() -> str:
    values = [f"{1e-6 * value:.15g}" for value in orthotropic_matrix(*LAMINATE)[np.triu_indices(6)]] + ["1.6e-9"]
    words = ["MAT9", "9", *values]
    rows = [words[:9], *(["+", *words[at : at + 8]] for at in range(9, len(words), 8))]
    return ",+\n".join(",".join(row) for row in rows)


@pytest.mark.parametrize("card", [MAT11, mat9()], ids=["MAT11", "MAT9"])
def test_nastran(tmp_path: Path, card: str) -> None:
    wanted = rotated_matrix(orthotropic_matrix(*LAMINATE), fibre_axes())
    np.testing.assert_allclose(nastran(tmp_path, card), wanted, rtol=1e-9, atol=1e2)
    np.testing.assert_allclose(nastran(tmp_path, card, ""), orthotropic_matrix(*LAMINATE), rtol=1e-9, atol=1e2)


@pytest.mark.parametrize(("card", "system"), [(MAT11, "-1"), (MAT11, "6"), (MAT11.replace(".3,.25", "30.,.25"), "5")])
def test_nastran_errors(tmp_path: Path, card: str, system: str) -> None:
    with rejects(ImportFileError):
        nastran(tmp_path, card, system)


def abaqus(tmp_path: Path, old: str, new: str, name: str = "cubes.inp") -> np.ndarray:
    text = (MODELS / name).read_text(encoding="utf-8")
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new), encoding="utf-8")
    material = next(iter(read_model(tmp_path / name, "mm").materials.values()))
    return material.elastic_matrix()


def test_axes_turn_with_an_instance(tmp_path: Path) -> None:
    """The orientation of a part is in its own axes; the second instance turns by 90 degrees about z."""
    name = "cubes_of_parts.inp"
    lines = (MODELS / name).read_text(encoding="utf-8").splitlines()
    section = next(at for at, line in enumerate(lines) if line.lower().startswith("*solid section"))
    orientation = ["*Orientation, name=Ori-1", "1., 0., 0., 0., 1., 0."]
    lines[section : section + 1] = [*orientation, f"{lines[section]}, orientation=ori-1"]
    elastic = next(at for at, line in enumerate(lines) if line.lower().startswith("*elastic"))
    in_mpa = ENGINEERING.replace("e9", "e3").splitlines()[1:]
    lines[elastic : elastic + 2] = ["*Elastic, type=ENGINEERING CONSTANTS", *in_mpa]
    (tmp_path / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    first, second = (each.elastic_matrix() for each in read_model(tmp_path / name, "mm").materials.values())
    wanted = orthotropic_matrix(*LAMINATE)
    np.testing.assert_allclose(first, wanted, rtol=1e-9, atol=1.0)
    turned = wanted[np.ix_([1, 0, 2, 3, 5, 4], [1, 0, 2, 3, 5, 4])]
    np.testing.assert_allclose(second, turned, rtol=1e-9, atol=1.0)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("210000.0, 0.3", "210000.0, 0.3, 100.\n190000.0, 0.3, 20."),
        ("*ELASTIC\n", "*ELASTIC, DEPENDENCIES=1\n"),
        ("*ELASTIC\n", "*ELASTIC, TYPE=SHEAR\n"),
        ("*ELASTIC\n210000.0, 0.3\n", "*ELASTIC, TYPE=ORTHO\n1., 2., 1., 2., 2., 1., 1., 1.,\n1.\n"),
    ],
)
def test_abaqus_errors(tmp_path: Path, old: str, new: str) -> None:
    with rejects(ImportFileError):
        abaqus(tmp_path, old, new)


ORIENTATIONS = {
    "missing": "*ORIENTATION, NAME=b\n1., 0., 0., 0., 1., 0.\n",
    "cylindrical": "*ORIENTATION, NAME=a, SYSTEM=CYLINDRICAL\n0., 0., 0., 0., 0., 1.\n",
    "one line": "*ORIENTATION, NAME=a\n1., 0., 0., 2., 0., 0.\n",
    "axis 4": "*ORIENTATION, NAME=a\n1., 0., 0., 0., 1., 0.\n4, 10.\n",
    "three numbers": "*ORIENTATION, NAME=a\n1., 0., 0.\n",
}


@pytest.mark.parametrize("name", ORIENTATIONS)
def test_orientations(tmp_path: Path, name: str) -> None:
    """Wrong axes are an error of an anisotropic material; of an isotropic one they have no effect."""
    text = (MODELS / "cubes.inp").read_text(encoding="utf-8")
    text = text.replace("MATERIAL=Steel\n", "MATERIAL=Steel, ORIENTATION=a\n") + ORIENTATIONS[name]
    (tmp_path / "cubes.inp").write_text(text, encoding="utf-8")
    assert read_model(tmp_path / "cubes.inp", "mm").materials["lower"].elastic is None
    elastic = ENGINEERING.replace("e9", "e3")
    (tmp_path / "cubes.inp").write_text(text.replace("*ELASTIC\n210000.0, 0.3\n", elastic), encoding="utf-8")
    with rejects(ImportFileError):
        read_model(tmp_path / "cubes.inp", "mm")
