"""Mass points and springs of decks: frequencies of CalculiX, the same in Nastran, and what is reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from own_cases import EXAMPLE, mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.model.kinds.cyclic import _require_no_equations
from stickslip.model.kinds.mesh import MeshSetup
from stickslip.model.model import set_up
from stickslip.structure.body_load import centrifugal_load, translation_inertia
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from tied_decks import frequencies_of_calculix, two_blocks, write_deck

MODELS = Path(__file__).parents[2] / "data" / "models"
# kg and N/m, of the order of the block's own: masses and springs to the ground at two corners, a spring between blocks.
# CalculiX requires the decimal points.
MASSES = """*ELEMENT, TYPE=MASS, ELSET=heavy
9001, {top}
9002, {other}
*MASS, ELSET=heavy
0.02
"""
SPRINGS = """*ELEMENT, TYPE=SPRING1, ELSET=ground
9003, {top}
9004, {other}
*SPRING, ELSET=ground
1
3.e7
*ELEMENT, TYPE=SPRING2, ELSET=between
9005, {below}, {other}
*SPRING, ELSET=between
3, 2
5.e7
"""


def frequencies(model: ImportedModel, count: int = 10) -> np.ndarray:
    structure = model.assemble()
    return natural_frequencies(structure.stiffness, structure.mass, count)[0]


@pytest.mark.slow
def test_frequencies_of_calculix(tmp_path: Path) -> None:
    mesh = two_blocks(2e-3)
    first, last = mesh.node_sets["top"][[0, -1]]
    nodes = {"top": first + 1, "other": last + 1, "below": mesh.node_sets["lower"][0] + 1}
    write_deck(tmp_path / "a.inp", mesh, (MASSES + SPRINGS).format(**nodes) + "*BOUNDARY\nupper, 1, 3\n")
    model = read_model(tmp_path / "a.inp", "m")
    computed = frequencies(model)
    np.testing.assert_allclose(computed, frequencies_of_calculix(tmp_path / "a.inp"), rtol=1e-5)
    solids = assemble_bodies(model.mesh, [*model.materials.values()], fixed_unknowns=model.fixed_unknowns)
    without = natural_frequencies(solids.stiffness, solids.mass, 10)[0]
    assert (np.abs(computed / without - 1.0) > 1e-2).sum() >= 3


def nastran(tmp_path: Path, cards: str) -> ImportedModel:
    text = (MODELS / "cubes.bdf").read_text(encoding="utf-8").replace("ENDDATA", f"{cards}\nENDDATA")
    (tmp_path / "cubes.bdf").write_text(text, encoding="utf-8")
    return read_model(tmp_path / "cubes.bdf", "mm")


def test_nastran(tmp_path: Path) -> None:
    """Grid 16 is node 15; t and N/mm are 1000 kg and 1000 N/m."""
    masses = "CONM2,50,16,,2.-6\nCONM2,51,16,,1.-6,,1."
    springs = "CELAS2,60,5.,16,2\nCELAS1,61,7,,,15,1\nPELAS,7,3.\nCELAS2,62,2.,5,3,9,3"
    model = nastran(tmp_path, f"{masses}\n{springs}")
    points = model.attachments
    assert points is not None
    np.testing.assert_allclose(points.masses[[14, 15]], [0.0, 3e-3])
    np.testing.assert_array_equal(points.springs, [[3 * 15 + 1, -1], [3 * 14, -1], [3 * 4 + 2, 3 * 8 + 2]])
    np.testing.assert_allclose(points.stiffnesses, [5e3, 3e3, 2e3])
    np.testing.assert_array_equal(points.grounded, [42, 46])
    printed_sentence("\n".join(model.messages), "CONM2")


def test_points_without_effect(tmp_path: Path) -> None:
    """Grid 99 belongs to no solid; component 5 is a rotation."""
    model = nastran(tmp_path, "GRID,99,,0.,0.,50.\nCONM2,50,99,,2.-6\nCELAS2,60,5.,99,2\nCELAS2,61,5.,16,5")
    assert model.attachments is None
    printed_sentence("\n".join([*model.messages, *model.doubts]), "no solid")


@pytest.mark.parametrize(
    "cards", ["CONM2,50,16,,-2.-6", "CELAS2,60,-5.,16,2", "CELAS1,60,7,16,2", "CELAS2,60,5.", "CONM2,50,77,,2."]
)
def test_nastran_errors(tmp_path: Path, cards: str) -> None:
    with rejects(ImportFileError):
        nastran(tmp_path, cards)


SPRING = "*ELEMENT, TYPE=SPRING1, ELSET=s\n90, 16\n*SPRING, ELSET=s"


@pytest.mark.parametrize(
    "cards",
    [
        f"{SPRING}, NONLINEAR\n1\n5.\n",
        f"{SPRING}\n1\n",
        f"{SPRING}\n1\nstiff\n",
        "*ELEMENT, TYPE=MASS, ELSET=m\n90, 16\n*MASS, ELSET=m, TYPE=ANISOTROPIC\n1., 2., 3.\n",
        "*ELEMENT, TYPE=MASS, ELSET=m\n90, 16\n*MASS, ELSET=m\n",
        "*ELEMENT, TYPE=SPRING2, ELSET=s\n90, 16, 15\n*SPRING, ELSET=s\n1\n5.\n",
    ],
)
def test_abaqus_errors(tmp_path: Path, cards: str) -> None:
    text = (MODELS / "cubes.inp").read_text(encoding="utf-8")
    (tmp_path / "cubes.inp").write_text(text.replace("*MATERIAL", f"{cards}*MATERIAL"), encoding="utf-8")
    with rejects(ImportFileError):
        read_model(tmp_path / "cubes.inp", "mm")


def test_mass_points_of_a_study(tmp_path: Path) -> None:
    """The study's matrices, its centrifugal load m r w^2 and its inertia under a motion of the support."""
    deck = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    data = mesh_case().as_mapping(only_explicit=True)
    setups = []
    for name, cards in (("plain", ""), ("heavy", "*ELEMENT, TYPE=MASS, ELSET=m\n9001, 117\n*MASS, ELSET=m\n3e-6\n")):
        (tmp_path / f"{name}.inp").write_text(deck + cards, encoding="utf-8")
        data["structure"]["file"] = str(tmp_path / f"{name}.inp")
        setups.append(set_up(Case.from_mapping(data)))
    plain, heavy = setups
    assert isinstance(plain, MeshSetup)
    assert isinstance(heavy, MeshSetup)
    added = (heavy.at_rest().mass - plain.at_rest().mass).tocoo()
    entries = np.abs(added.data) > 1e-9
    np.testing.assert_array_equal(added.row[entries], added.col[entries])
    np.testing.assert_allclose(added.data[entries], [3e-3] * 3, rtol=1e-6)
    assert dict(heavy.sizes())["mass points"] == "1 nodes, 0.003 kg"
    points = heavy.attachments
    assert points is not None
    node = int(np.flatnonzero(points.masses)[0])
    mesh, materials = heavy.mesh, heavy.materials
    inertia = translation_inertia(mesh, materials, points.masses) - translation_inertia(mesh, materials)
    np.testing.assert_allclose(inertia[3 * node : 3 * node + 3], 3e-3 * np.eye(3), rtol=1e-6)
    arguments = np.array([0.0, 1.0, 0.0]), np.zeros(3)
    load = centrifugal_load(mesh, materials, *arguments, points.masses) - centrifugal_load(mesh, materials, *arguments)
    x, _, z = mesh.points[node]
    np.testing.assert_allclose(load[3 * node : 3 * node + 3], 3e-3 * np.array([x, 0.0, z]), rtol=1e-6, atol=1e-12)


def test_a_sector_has_no_mass_points(tmp_path: Path) -> None:
    """Its matrices would lack them."""
    model = nastran(tmp_path, "CONM2,50,16,,2.-6")
    with rejects(InputError, "structure.file"):
        _require_no_equations(model)
