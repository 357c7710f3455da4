"""Shared by the tests of static contact against CalculiX: its deck, its results, and our solution on the same mesh."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from calculix import our_structure
from helpers import absent_tool
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.pairing.pairing import FacePairs, pair_faces
from stickslip.core.validation import FloatArray
from stickslip.formats.calculix_deck import write_calculix_deck
from stickslip.model.kinds.two_blade_geometry import BladePairElements
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.solve.static.ramp_to_rest import static_preload
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh
from stickslip.structure.superelement import Superelement

SIDES = ("left", "right")
EDGES = ("damper_front_edge", "damper_back_edge")
TANGENTIAL_FRACTION = 0.8  # tangential over normal stiffness per area, and stick slope of CalculiX
SURFACE, NODE = "SURFACE TO SURFACE", "NODE TO SURFACE"
# Sides of an 8-node brick, S1 to S6 of CalculiX.
BRICK_SIDES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


@dataclass(frozen=True)
class PressedBlades:
    """The two blades with a force F_N at the two ends of the damper's bottom."""

    mesh: Mesh
    pairs: FacePairs
    superelement: Superelement
    edge_forces: tuple[tuple[int, float], ...]  # node, N along z
    load: np.ndarray  # (n,) N

    @classmethod
    def build(cls, elements: BladePairElements | None, force: float) -> PressedBlades:
        """Mesh, pairs and reduced structure; its static answer to forces on faces and edges is exact."""
        mesh = blade_pair_mesh(elements=elements)
        pairs = FacePairs.concatenate([pair_faces(mesh, f"damper_{side}_face", f"{side}_face") for side in SIDES])
        edges = [mesh.node_set(name) for name in EDGES]
        boundary = np.unique(np.concatenate([pairs.nodes, *edges]))
        superelement = craig_bampton(our_structure(mesh, "incompatible"), boundary, n_modes=1)
        forces = [part for edge in edges for part in line_load(mesh, edge, 0.5 * force)]
        load = sum(value * superelement.selector(node, (0.0, 0.0, 1.0)) for node, value in forces)
        return cls(mesh, pairs, superelement, tuple(forces), np.asarray(load))

    @property
    def face_areas(self) -> np.ndarray:
        """m2 of the left and the right face."""
        return np.bincount(self.pairs.face, weights=self.pairs.area)


@dataclass(frozen=True)
class FaceContact:
    """Contact of both faces in either program."""

    normal: np.ndarray  # (2,) N
    shear: np.ndarray  # (2,) N, size of the resultant
    closed_area: np.ndarray | None  # (2,) m2; None where the program does not print it
    pressure: np.ndarray  # (n_pairs,) Pa at the nodes
    closure: np.ndarray  # (n_pairs,) m from the displacements of the nodes, below zero open
    seconds: float


def line_load(mesh: Mesh, nodes: np.ndarray, force: float) -> list[tuple[int, float]]:
    """A uniform load along an edge in x, in N at its nodes."""
    nodes = nodes[np.argsort(mesh.points[nodes, 0])]
    length = np.diff(mesh.points[nodes, 0])
    share = np.zeros(nodes.size)
    share[:-1] += 0.5 * length
    share[1:] += 0.5 * length
    return list(zip(nodes.tolist(), (force * share / share.sum()).tolist(), strict=True))


def our_contact(model: PressedBlades, stiffness: float, friction: float, gap: FloatArray | float = 0.0) -> FaceContact:
    """Our solution with ``stiffness`` in N/m3 and ``gap`` in m of each pair; friction 0 is the frictionless state."""
    start = time.perf_counter()
    normal_stiffness = stiffness * model.pairs.area
    operator = model.pairs.operator(model.superelement)
    pairs = ContactPairs(
        operator, normal_stiffness, TANGENTIAL_FRACTION * normal_stiffness, friction or 0.3, -normal_stiffness * gap
    )
    state = static_preload(model.superelement, pairs, model.load, friction=friction > 0.0)
    seconds = time.perf_counter() - start
    n_faces, face, area = len(SIDES), model.pairs.face, model.pairs.area
    normal = np.bincount(face, weights=state.normal_force, minlength=n_faces)
    shear = [np.linalg.norm(state.traction[face == number].sum(axis=0)) for number in range(n_faces)]
    closed = np.bincount(face, weights=np.where(state.normal_force > 0.0, area, 0.0), minlength=n_faces)
    closure = (operator @ state.displacement)[2::3] - gap
    return FaceContact(normal, np.array(shear), closed, state.normal_force / area, closure, seconds)


def calculix_contact(
    folder: Path,
    model: PressedBlades,
    stiffness: float,
    friction: float,
    kind: str = SURFACE,
    gap: ArrayLike = 0.0,
) -> FaceContact:
    """The solution of CalculiX; ``gap`` in m of each pair moves the damper's nodes into the damper."""
    program = shutil.which("ccx")
    if program is None:
        absent_tool("ccx", "CalculiX is not on the path (apt-get install calculix-ccx).")
    points = model.mesh.points.copy()
    points[model.pairs.first_node] -= np.broadcast_to(gap, model.pairs.area.shape)[:, None] * model.pairs.normal
    deck = write_calculix_deck(folder / "contact.inp", replace(model.mesh, points=points), Material())
    head = deck.read_text(encoding="ascii").partition("*STEP")[0]
    lines = _contact_lines(model, stiffness, friction, kind)
    deck.write_text(head + "\n".join(lines) + "\n", encoding="ascii")
    start = time.perf_counter()
    done = subprocess.run(
        [program, "-i", "contact"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    seconds = time.perf_counter() - start
    assert done.returncode == 0, f"CalculiX ended with {done.returncode}: {done.stdout[-800:]}{done.stderr[-400:]}"
    printed = (folder / "contact.dat").read_text()
    normal, shear = _face_forces(model, printed)
    area = closed_areas(printed) if kind == SURFACE else None
    fields = node_fields(folder / "contact.frd", ("CPRESS", "D1", "D2", "D3"), model.mesh.n_nodes)
    moved = fields[:, 1:][model.pairs.first_node] - fields[:, 1:][model.pairs.second_node]
    closure = np.einsum("px,px->p", moved, model.pairs.normal) - gap
    # Nodes that are not listed have no contact element: with node to surface, those that moved over the edge.
    pressure = np.nan_to_num(fields[model.pairs.first_node, 0])
    return FaceContact(normal, shear, area, pressure, closure, seconds)


def _contact_lines(model: PressedBlades, stiffness: float, friction: float, kind: str) -> list[str]:
    lines = []
    fixed = model.mesh.node_set("fixed")
    for side, sign in zip(SIDES, (-1.0, 1.0), strict=True):
        base = fixed[sign * model.mesh.points[fixed, 0] > 0.0] + 1
        lines += [f"*NSET, NSET=base_{side}", *(f"{node}," for node in base)]
        for body in ("", "damper_"):
            lines += [f"*SURFACE, NAME=surface_{body}{side}, TYPE=ELEMENT"]
            lines += _surface_lines(model.mesh, model.mesh.node_set(f"{body}{side}_face"))
    lines += [
        "*SURFACE INTERACTION, NAME=joint",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{stiffness!r}, 1.",
    ]
    if friction > 0.0:
        lines += ["*FRICTION", f"{friction!r}, {TANGENTIAL_FRACTION * stiffness!r}"]
    for side in SIDES:
        lines += [f"*CONTACT PAIR, INTERACTION=joint, TYPE={kind}", f"surface_damper_{side}, surface_{side}"]
    lines += ["*STEP, INC=1000", "*STATIC", "0.25, 1., 1e-5, 0.25"]
    # The load is symmetric about y = 0, so this holds nothing; without friction the damper could move along y.
    damper = np.unique(model.mesh.cells[model.mesh.body == 2])
    middle = damper[np.abs(model.mesh.points[damper, 1]).argmin()]
    assert abs(model.mesh.points[middle, 1]) < 1e-12
    lines += ["*BOUNDARY", f"{middle + 1}, 2, 2", "*CLOAD"]
    lines += [f"{node + 1}, 3, {value!r}" for node, value in model.edge_forces]
    lines += ["*NODE FILE, FREQUENCY=1000", "U", "*CONTACT FILE, FREQUENCY=1000", "CDIS, CSTR"]
    for side in SIDES:
        lines += [f"*NODE PRINT, NSET=base_{side}, TOTALS=ONLY, FREQUENCY=1000", "RF"]
        if kind == SURFACE:  # it crashes CalculiX 2.20 with node to surface
            lines += [f"*CONTACT PRINT, SLAVE=surface_damper_{side}, MASTER=surface_{side}, FREQUENCY=1000", "CF"]
    return [*lines, "*END STEP"]


def _surface_lines(mesh: Mesh, nodes: np.ndarray) -> list[str]:
    inside = np.zeros(mesh.n_nodes, dtype=bool)
    inside[nodes] = True
    (bricks,) = mesh.blocks
    return [
        f"{cell + 1}, S{number}"
        for number, corners in enumerate(BRICK_SIDES, start=1)
        for cell in np.flatnonzero(inside[bricks.cells[:, corners]].all(axis=1))
    ]


def _face_forces(model: PressedBlades, printed: str) -> tuple[np.ndarray, np.ndarray]:
    """Normal force (pressing is positive) and shear force of each face: what the bases of the blades hold."""
    normal, shear = [], []
    for number, side in enumerate(SIDES):
        row = re.findall(rf"total force \(fx,fy,fz\) for set BASE_{side.upper()} .*?\n\s*\n([^\n]+)", printed)[-1]
        reaction = np.array([float(word) for word in row.split()])
        direction = model.pairs.normal[model.pairs.face == number][0]
        normal.append(-reaction @ direction)
        shear.append(np.linalg.norm(reaction - (reaction @ direction) * direction))
    return np.array(normal), np.array(shear)


def closed_areas(printed: str) -> np.ndarray:
    """m2 of each face that is in contact, from the last statistics in a .dat file."""
    actual = re.findall(
        r"statistics for slave set SURFACE_DAMPER_(\w+),.*?shear force \(size\)\s+(\S+)", printed, re.DOTALL
    )
    area = {name.lower(): float(word) for name, word in actual}
    return np.array([area[side] for side in SIDES])


def node_fields(path: Path, names: Sequence[str], n_nodes: int) -> np.ndarray:
    """(n_nodes, n_names) components such as CPRESS or D1, each from the last block of a .frd file that has it."""
    values = np.full((n_nodes, len(names)), np.nan)
    for block in re.split(r"^ -4  ", path.read_text(), flags=re.MULTILINE)[1:]:
        listed = re.findall(r"^ -5  (\w+)", block, re.MULTILINE)
        columns = [(at, 13 + 12 * listed.index(name)) for at, name in enumerate(names) if name in listed]
        for line in block.splitlines():
            if line.startswith(" -1"):
                for at, column in columns:
                    values[int(line[3:13]) - 1, at] = float(line[column : column + 12])
    return values


def differs_beyond_one_row(pairs: FacePairs, first: np.ndarray, second: np.ndarray) -> bool:
    """Whether two patterns of closed nodes (n_pairs,) differ by more than one row of nodes on a grid of nodes.

    A node that differs must have a neighbour that in the first pattern is what the node is in the second.
    """
    place = np.stack([np.unique(np.round(along, 9), return_inverse=True)[1] for along in pairs.face_position.T], axis=1)
    near = (np.abs(place[:, None] - place[None]).max(axis=2) <= 1) & (pairs.face[:, None] == pairs.face)
    excused = (near & (first[None, :] == second[:, None])).any(axis=1)
    return bool(((first != second) & ~excused).any())
