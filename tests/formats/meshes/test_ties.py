"""Ties of decks: frequencies against CalculiX, Nastran entries against Abaqus cards, and what messages report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assembly_deck import assembly_deck
from model_writers import VTK_TO_NASTRAN
from sentences import printed_sentence
from stickslip.formats.meshes.read import read_model
from stickslip.structure.constraints import Constraints, eliminate
from stickslip.structure.mesh import Mesh
from stickslip.structure.tied_parts import supported_groups
from tied_decks import frequencies_of, frequencies_of_calculix, two_blocks, write_deck

MESH = two_blocks()
INNER = [int(node) + 1 for node in np.flatnonzero(np.isclose(MESH.points[:, 2], 15e-3))[:2]]
TOP = [int(node) + 1 for node in MESH.node_sets["top"]]
REFERENCE = "9001, 0.03, 0.005, 0.07\n9002, 0., 0., 0."
TIE = "*TIE, NAME=t, POSITION TOLERANCE=1e-4\nsupper, slower\n"
COUPLING = f"{TIE}*COUPLING, REF NODE=9001, SURFACE=stop, CONSTRAINT NAME=c\n"
NODE_SURFACE = "*SURFACE, NAME=nupper, TYPE=NODE\nupper\n*TIE, NAME=t, POSITION TOLERANCE=1e-4\nnupper, slower\n"
# Each kind of constraint in a model of two blocks of C3D20, the upper one tied to the lower one.
KINDS = {
    "tie": TIE,
    "tie of the finer mesh": "*TIE, NAME=t, POSITION TOLERANCE=1e-4\nslower, supper\n",
    "tie of nodes": NODE_SURFACE,
    "equations": TIE + f"*EQUATION\n3\n{TOP[0]},1,1.,{TOP[5]},2,-0.5,{TOP[8]},3,2.\n2\n{TOP[12]},3,1.,{TOP[3]},3,1.\n",
    "rigid body": TIE + "*RIGID BODY, NSET=top, REF NODE=9001, ROT NODE=9002\n*BOUNDARY\n9001,1,1\n9002,3,3\n",
    "kinematic coupling": COUPLING + "*KINEMATIC\n1,3\n*BOUNDARY\n9001,1,2\n",
    "kinematic coupling along x": COUPLING + "*KINEMATIC\n1,1\n*BOUNDARY\n9001,4,6\n",
    "cylindrical directions": TIE + "*TRANSFORM, NSET=top, TYPE=C\n0.01,0.008,0.,0.01,0.008,1.\n*BOUNDARY\ntop,2,2\n",
    "turned directions": TIE
    + "*TRANSFORM, NSET=top, TYPE=R\n1.,0.4,0.,-0.4,1.,0.1\n*BOUNDARY\ntop,1,1\n"
    + f"*EQUATION\n2\n{TOP[0]},3,1.,{TOP[3]},2,1.\n",
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_frequencies_are_those_of_calculix(tmp_path: Path, kind: str) -> None:
    """Ten frequencies to the seven digits that CalculiX prints."""
    path = tmp_path / "deck.inp"
    write_deck(path, MESH, KINDS[kind], more_nodes=REFERENCE)
    np.testing.assert_allclose(frequencies_of(path), frequencies_of_calculix(path), rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("cards", "count"), [(TIE, 0), (KINDS["rigid body"].partition("*BOUNDARY")[0], 0)])
def test_a_free_body_has_six_frequencies_of_zero(tmp_path: Path, cards: str, count: int) -> None:
    path = tmp_path / "deck.inp"
    write_deck(path, MESH, cards, clamped="", more_nodes=REFERENCE)
    found = frequencies_of(path, 8)
    assert found[5] < 1e-4 * found[6]
    assert found[6] > 1e3


def constraints(path: Path) -> tuple[Mesh, Constraints]:
    """The mesh of a file, and its equations without fixed displacements."""
    model = read_model(path, "m")
    assert model.equations is not None
    return model.mesh, eliminate(model.equations)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "residual"),
    [
        (f"PLANE, {TOP[0]}, {TOP[3]}, {TOP[8]}, {TOP[9]}, {TOP[10]}", "plane"),
        (f"STRAIGHT, {TOP[0]}, {TOP[1]}, {TOP[2]}", "line"),
        (f"BEAM, {TOP[0]}, {TOP[11]}", "distance"),
        (f"LINK, {TOP[0]}, {TOP[11]}", "distance"),
    ],
)
def test_nonlinear_constraints_are_those_of_small_motions(tmp_path: Path, line: str, residual: str) -> None:
    """The condition on the moved nodes is of second order in a small motion that satisfies the equations."""
    path = tmp_path / "deck.inp"
    write_deck(path, MESH, f"*MPC\n{line}\n")
    mesh, tied = constraints(path)
    nodes = np.array([int(word) for word in line.split(",")[1:]]) - 1
    motion = tied.transformation @ np.random.default_rng(1).normal(size=len(tied.free_unknowns))

    def condition(size: float) -> float:
        places = mesh.points[nodes] + size * motion.reshape(-1, 3)[nodes]
        if residual == "distance":
            return float(np.linalg.norm(places[0] - places[1]) - np.linalg.norm(np.subtract(*mesh.points[nodes])))
        singular = np.linalg.svd(places[1:] - places[0], compute_uv=False)
        return float(singular[2 if residual == "plane" else 1])

    assert abs(condition(1e-6)) < 1e-3 * 1e-6
    assert abs(condition(1e-6)) < 0.05 * max(abs(condition(1e-5)), 1e-12)


def test_the_reference_node_of_a_distributing_coupling_follows_a_rigid_motion(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    write_deck(path, MESH, COUPLING + "*DISTRIBUTING\n1,6\n", more_nodes=REFERENCE)
    mesh, tied = constraints(path)
    spin, place = np.array([0.3, -0.2, 0.5]), np.array([0.03, 0.005, 0.07])
    motion = np.cross(spin, mesh.points).ravel()
    rows = [tied.further[9001, axis] for axis in range(6)]
    np.testing.assert_allclose(tied.reference[rows] @ motion, [*np.cross(spin, place), *spin], atol=1e-12)


def write_nastran(path: Path, cards: str, case: str = "SPC = 1\nMPC = 1") -> None:
    """The two blocks, coupled node by node where they touch, with further entries."""
    lines = ["SOL 103", "CEND", case, "BEGIN BULK"]
    lines += [f"GRID,{n + 1},,{x:.9g},{y:.9g},{z:.9g}" for n, (x, y, z) in enumerate(MESH.points)]
    for cell, nodes in enumerate(np.asarray(MESH.cells)[:, VTK_TO_NASTRAN["hexahedron20"]] + 1):
        words = [str(cell + 1), str(MESH.body[cell] + 1), *map(str, nodes)]
        lines += [",".join(["CHEXA" if at == 0 else "+", *words[at : at + 8]]) for at in range(0, len(words), 8)]
    lines += ["PSOLID,1,1", "PSOLID,2,1", "MAT1,1,2.1+11,,0.3,7850."]
    lines += [f"SPC1,1,123,{node + 1}" for node in MESH.node_sets["bottom"]]
    path.write_text("\n".join([*lines, cards.strip(), "ENDDATA", ""]), encoding="utf-8")


def grids(name: str) -> str:
    """Fields with the grids of a set, on continuation lines of eight."""
    labels = [str(int(node) + 1) for node in MESH.node_sets[name]]
    return "\n".join(",".join(["+", *labels[at : at + 8]]) for at in range(0, len(labels), 8))


REFERENCE_GRID = "GRID,9001,,0.03,0.005,0.07"
NEAR, FAR = TOP[0], int(MESH.node_sets["lower"][0]) + 1
EQUAL = {
    "RBE2": (
        f"RBE2,1,9001,123456,,,,,\n{grids('top')}\n{REFERENCE_GRID}\nSPC1,1,12,9001",
        "*COUPLING, REF NODE=9001, SURFACE=stop, CONSTRAINT NAME=c\n*KINEMATIC\n1,6\n*BOUNDARY\n9001,1,2\n",
    ),
    "RBE2 along x": (
        f"RBE2,1,9001,1,,,,,\n{grids('top')}\n{REFERENCE_GRID}\nSPC1,1,456,9001",
        "*COUPLING, REF NODE=9001, SURFACE=stop, CONSTRAINT NAME=c\n*KINEMATIC\n1,1\n*BOUNDARY\n9001,4,6\n",
    ),
    "MPC": (
        f"MPC,1,{NEAR},1,2.,{FAR},3,-1.,,+\n+,,{TOP[5]},2,0.5\nMPC,2,{TOP[7]},1,1.,{FAR},1,-1.",
        f"*EQUATION\n3\n{NEAR},1,2.,{FAR},3,-1.,{TOP[5]},2,0.5\n",
    ),
    "RROD": (f"RROD,1,{NEAR},{FAR}", f"*MPC\nLINK,{NEAR},{FAR}\n"),
    "RBAR": (
        f"{REFERENCE_GRID}\nRBAR,1,9001,{NEAR},123456\nRBAR,2,{FAR},9001,,123456",
        f"*KINEMATIC COUPLING, REF NODE=9001\n{NEAR},1,3\n{FAR},1,3\n",
    ),
    "SPC with a value": (f"SPC,1,{NEAR},1,0.5", f"*BOUNDARY\n{NEAR},1,1,0.5\n"),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", EQUAL)
def test_nastran_entries_are_the_cards_of_abaqus(tmp_path: Path, kind: str) -> None:
    nastran, abaqus = EQUAL[kind]
    bulk, deck = tmp_path / "deck.bdf", tmp_path / "deck.inp"
    sides = "\n".join(
        f"MPC,3,{up + 1},{axis},1.,{down + 1},{axis},-1." for up, down in touching() for axis in (1, 2, 3)
    )
    write_nastran(bulk, f"{nastran}\nMPCADD,4,1,3\nMPC,1,{INNER[0]},1,1.,{INNER[1]},1,-1.\n{sides}", "SPC = 1\nMPC = 4")
    rows = "".join(f"2\n{up + 1},{axis},1.,{down + 1},{axis},-1.\n" for up, down in touching() for axis in (1, 2, 3))
    first = f"*EQUATION\n2\n{INNER[0]},1,1.,{INNER[1]},1,-1.\n"
    write_deck(deck, MESH, f"{first}*EQUATION\n{rows}{abaqus}", more_nodes=REFERENCE)
    np.testing.assert_allclose(frequencies_of(bulk), frequencies_of(deck), rtol=1e-6)


def touching() -> list[tuple[int, int]]:
    """Pairs of nodes of both blocks at one position."""
    return [
        (int(up), int(down))
        for up in MESH.node_sets["upper"]
        for down in MESH.node_sets["lower"]
        if np.allclose(MESH.points[up], MESH.points[down], atol=1e-9)
    ]


def test_an_interpolation_element_distributes_a_force(tmp_path: Path) -> None:
    """RBE3: the force at its reference grid has its resultant, and in the mean of two weights is divided like them."""
    path = tmp_path / "deck.bdf"
    nodes = [TOP[0], TOP[1], TOP[3], TOP[4]]
    words = f"RBE3,1,,9001,123456,1.,123,{nodes[0]},{nodes[1]},+\n+,{nodes[2]},3.,123,{nodes[3]}\n{REFERENCE_GRID}"
    write_nastran(path, words, "SPC = 1")
    mesh, tied = constraints(path)
    force = tied.reference[[tied.further[9001, 2]]].toarray()[0].reshape(-1, 3)
    np.testing.assert_allclose(force.sum(axis=0), [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(np.cross(mesh.points - [0.03, 0.005, 0.07], force).sum(axis=0), 0.0, atol=1e-12)
    assert set(np.flatnonzero(np.abs(force).sum(axis=1)) + 1) == set(nodes)


def test_messages_report_ties_values_and_solids(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    spring = f"*ELEMENT, TYPE=SPRINGA, ELSET=sp\n900, {TOP[0]}, {TOP[1]}\n"
    write_deck(
        two := path, two_blocks(0.2e-3), f"*TIE, NAME=t\nsupper, slower\n{spring}*BOUNDARY\n{TOP[2]}, 1, 1, 0.5\n"
    )
    model = read_model(two, "m")
    words = "\n".join([*model.messages, *model.doubts])
    printed_sentence(words, f"{MESH.node_sets['upper'].size} nodes of 'supper'", "0.2 mm", "20 of 21", "1 SPRINGA")


def test_a_rigid_coupling_holds_no_rigid_motion(tmp_path: Path) -> None:
    """Equations that all rigid motions satisfy leave round-off, which counts as no constraint: the plate at the
    reference point keeps its six motions, and its node set names the reference node."""
    path = tmp_path / "deck.inp"
    path.write_text(assembly_deck(), encoding="utf-8")
    model = read_model(path, "mm")
    assert model.equations is not None
    assert dict(model.reference_sets) == {"Load point": 3001}
    assert not [words for words in model.messages if "Load point" in words]
    tied = eliminate(model.equations, model.fixed_unknowns)
    assert [group.free for group in supported_groups(model.mesh, model.fixed_unknowns, tied)] == [0, 6]
    printed_sentence(next(words for words in model.messages if "*DSLOAD" in words))
