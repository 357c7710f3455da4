"""Mass points and springs of decks: frequencies of CalculiX, the same in Nastran, and what is reported."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from own_cases import EXAMPLE, mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.model.kinds.mesh import MeshSetup
from stickslip.model.kinds.sector_ties import require_no_attachments
from stickslip.model.model import set_up
from stickslip.structure.body_load import centrifugal_load, translation_inertia
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from stickslip.structure.model_facts import body_volumes
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


@pytest.mark.slow
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
    np.testing.assert_array_equal(points.supports(np.array([3]), None)[0], [3, 42, 46])
    printed_sentence("\n".join(model.messages), "moments of inertia")


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


@pytest.mark.slow
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
        require_no_attachments(model)


# kg, m, kg m2 of a body whose centre of gravity is at an offset from the reference node of a coupling
MASS, PLACE, ARM = 0.2, np.array([0.004, 0.006, 0.03]), np.array([0.002, -0.003, 0.005])
INERTIA = np.array([[4e-6, 1e-6, -5e-7], [1e-6, 3e-6, 2e-7], [-5e-7, 2e-7, 5e-6]])
GRID = "GRID,99,,4.,6.,30."  # in mm, t, N/mm and N mm: CONM2 has the integrals of x y, the tensor their negative
BODY = "CONM2,50,99,,2.-4,2.,-3.,5.\n+,4.-3,-1.-3,3.-3,5.-4,-2.-4,5.-3"
COUPLINGS = {
    "rigid": "RBE2,70,99,123456,13,14,15,16",
    "distributing": "RBE3,70,,99,123456,1.,123,13,14\n+,15,16",
}


def rigid_motions(points: np.ndarray) -> np.ndarray:
    """(3 n, 6): translations along and rotations about x, y, z through the origin."""
    x, y, z = points.T
    o, one = np.zeros(len(points)), np.ones(len(points))
    return (
        np.array([[one, o, o, o, z, -y], [o, one, o, -z, o, x], [o, o, one, y, -x, o]])
        .transpose(2, 0, 1)
        .reshape(-1, 6)
    )


@pytest.mark.slow
def test_frequencies_of_calculix_with_a_mass_at_a_reference_node(tmp_path: Path) -> None:
    """A coupling moves a mass and the end of a spring."""
    cards = (
        "*COUPLING, REF NODE=9001, SURFACE=stop, CONSTRAINT NAME=c\n*KINEMATIC\n1,3\n"
        "*ELEMENT, TYPE=MASS, ELSET=m\n9901, 9001\n*MASS, ELSET=m\n0.05\n"
        "*ELEMENT, TYPE=SPRING1, ELSET=g\n9902, 9001\n*SPRING, ELSET=g\n1\n3.e7\n*BOUNDARY\nupper, 1, 3\n"
    )
    write_deck(tmp_path / "a.inp", two_blocks(2e-3), cards, more_nodes="9001, 0.012, 0.02, 0.06")
    model = read_model(tmp_path / "a.inp", "m")
    np.testing.assert_allclose(frequencies(model), frequencies_of_calculix(tmp_path / "a.inp"), rtol=1e-5)
    printed_sentence("\n".join([*model.messages, *model.doubts]))


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_a_mass_at_a_reference_node_has_the_inertia_of_its_body(tmp_path: Path, coupling: str) -> None:
    """Closed form: in rigid motions of the solids it moves with its coupling, so its mass matrix is that of a body."""
    matrices = []
    for name, cards in (("plain", ""), ("heavy", f"{BODY}\nCELAS2,60,3.,99,1\nCELAS2,61,7.,99,5")):
        (tmp_path / name).mkdir()
        model = nastran(tmp_path / name, f"{GRID}\n{COUPLINGS[coupling]}\n{cards}")
        structure = replace(model, fixed_unknowns=np.empty(0, dtype=np.int64)).assemble()
        motion = rigid_motions(model.mesh.points)[structure.free_unknowns]
        matrices.append([motion.T @ matrix @ motion for matrix in (structure.mass, structure.stiffness)])
    mass, stiffness = np.array(matrices[1]) - np.array(matrices[0])
    centre = rigid_motions((PLACE + ARM)[None])
    expected = MASS * centre.T @ centre
    expected[3:, 3:] += INERTIA
    np.testing.assert_allclose(mass, expected, rtol=1e-9, atol=1e-9 * MASS)
    place = rigid_motions(PLACE[None])
    expected = 3e3 * np.outer(place[0], place[0])
    expected[4, 4] += 7e-3
    np.testing.assert_allclose(stiffness, expected, rtol=1e-6, atol=1e-6)


def study_with_a_mass(folder: Path, **sections: object) -> MeshSetup:
    """The beam with 3 g on a reference node that follows its tip."""
    deck = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    cards = (
        "*NODE\n9001, 100., 0., 30.\n*COUPLING, REF NODE=9001, SURFACE=tip, CONSTRAINT NAME=c\n*DISTRIBUTING\n"
        "*ELEMENT, TYPE=MASS, ELSET=m\n9901, 9001\n"
    )
    (folder / "a.inp").write_text(f"{deck}{cards}*MASS, ELSET=m\n3e-6\n", encoding="utf-8")
    data: dict[str, Any] = mesh_case().as_mapping(only_explicit=True) | sections
    data["structure"]["file"] = str(folder / "a.inp")
    data["forces"]["push"] |= {"set": "beam_top"}
    data["responses"]["tip"] |= {"set": "beam_top"}
    setup = set_up(Case.from_mapping(data))
    assert isinstance(setup, MeshSetup)
    return setup


@pytest.mark.slow
def test_inertia_of_a_mass_at_a_reference_node(tmp_path: Path) -> None:
    """Under a motion of the support, and so under gravity, the resultant is that of the whole mass."""
    setup = study_with_a_mass(tmp_path, base_motion={"direction": [1, 0, 0], "amplitude": "1 m/s^2"})
    volumes = zip(setup.materials, body_volumes(setup.mesh), strict=True)
    solids = sum(material.density * volume for material, volume in volumes)
    inertia = setup.layout.base_inertia
    assert inertia is not None
    np.testing.assert_allclose(inertia.reshape(-1, 3, 3).sum(axis=0), (solids + 3e-3) * np.eye(3), atol=1e-12)
    assert dict(setup.sizes())["mass points at reference nodes"] == "1 nodes, 0.003 kg"


def test_a_mass_at_a_reference_node_does_not_rotate(tmp_path: Path) -> None:
    with rejects(InputError, "rotation"):
        study_with_a_mass(tmp_path, rotation={"speed": "3000 rpm", "axis": [0, 1, 0]})


def test_a_mass_that_nothing_moves(tmp_path: Path) -> None:
    """A coupling along x leaves its reference node free along y and z."""
    model = nastran(tmp_path, f"{GRID}\nRBE2,70,99,1,13,14,15,16\n{BODY}")
    with rejects(InputError):
        model.assemble()


@pytest.mark.parametrize("body", ["CONM2,50,99,7,2.-4,2.", "CONM2,50,99,,2.-4\n+,4.-3,9.-3,3.-3"])
def test_errors_of_a_mass_at_a_reference_node(tmp_path: Path, body: str) -> None:
    """Axes of a coordinate system; moments of inertia of no body."""
    with rejects(ImportFileError):
        nastran(tmp_path, f"{GRID}\n{COUPLINGS['rigid']}\n{body}")


def test_moments_of_inertia_of_abaqus(tmp_path: Path) -> None:
    """In t mm2; products are rejected."""
    cards = (
        "*NODE\n99, 4., 6., 30.\n*COUPLING, REF NODE=99, SURFACE=contact, CONSTRAINT NAME=c\n*KINEMATIC\n"
        "*ELEMENT, TYPE=ROTARYI, ELSET=r\n90, 99\n*ROTARY INERTIA, ELSET=r\n4.e-3, 3.e-3, 5.e-3{products}\n"
    )
    text = (MODELS / "cubes.inp").read_text(encoding="utf-8")
    path = tmp_path / "cubes.inp"
    path.write_text(text.replace("*MATERIAL", f"{cards.format(products='')}*MATERIAL"), encoding="utf-8")
    points = read_model(path, "mm").attachments
    assert points is not None
    assert points.further == ((99, 3), (99, 4), (99, 5))
    np.testing.assert_allclose(points.further_mass, np.diag([4e-6, 3e-6, 5e-6]), rtol=1e-12)
    path.write_text(text.replace("*MATERIAL", f"{cards.format(products=', 1.e-3')}*MATERIAL"), encoding="utf-8")
    with rejects(ImportFileError):
        read_model(path, "mm")
