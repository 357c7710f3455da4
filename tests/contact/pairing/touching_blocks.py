"""Two blocks whose touching faces have different meshes, a pin in a bore, and the patch test between blocks."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from solid_cells import CORNERS
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import IntArray
from stickslip.structure.elasticity import Material, assemble_bodies
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import side_rule, side_shape_functions

# Options of ``block``; a function from coordinates between 0 and 1 to m; points, kind, cells, lower and upper nodes.
Options = Mapping[str, Any]
Place = Callable[[FloatArray], FloatArray]
Body = tuple[FloatArray, str, IntArray, list[IntArray]]
PRESSURE = 1e8
STEEL = Material(200e9, 0.3, 7800.0)
# The six tetrahedra around the diagonal from corner 0 to corner 6 of a brick.
KUHN = np.array([[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]])
MIDDLES = {
    "tetra": ("tetra10", [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]]),
    "hexahedron": (
        "hexahedron20",
        [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]],
    ),
}


def grid(counts: Sequence[int], place: Place) -> tuple[FloatArray, IntArray, IntArray]:
    """Points, bricks and node numbers (i, j, k) of a block; ``place`` maps coordinates from 0 to 1 to m."""
    axes = [np.linspace(0.0, 1.0, count + 1) for count in counts]
    points = place(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    offset = ((CORNERS + 1) / 2).astype(int)
    corners = [number[i : counts[0] + i, j : counts[1] + j, k : counts[2] + k].ravel() for i, j, k in offset]
    return points.reshape(-1, 3), np.stack(corners, axis=1), number


def with_middles(points: FloatArray, kind: str, cells: IntArray) -> tuple[FloatArray, str, IntArray]:
    """The same cells with nodes in the middle of their edges."""
    quadratic, edges = MIDDLES[kind]
    ends, position = np.unique(np.sort(cells[:, edges], axis=2).reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(points) + position.reshape(len(cells), -1)
    return np.vstack([points, points[ends].mean(axis=1)]), quadratic, np.hstack([cells, middle])


def body(counts: Sequence[int], place: Place, kind: str = "hexahedron", quadratic: bool = False) -> Body:
    """Points, kind, cells, and a function that finds the nodes on ``place``'s side z = 0 or 1."""
    points, cells, number = grid(counts, place)
    if kind == "tetra":
        cells = cells[:, KUHN].reshape(-1, 4)
    sets = [number[:, :, 0].ravel(), number[:, :, -1].ravel()]
    if not quadratic:
        return points, kind, cells, sets
    ends = np.unique(np.sort(cells[:, MIDDLES[kind][1]], axis=2).reshape(-1, 2), axis=0)
    sets = [np.r_[nodes, len(points) + np.flatnonzero(np.isin(ends, nodes).all(axis=1))] for nodes in sets]
    return *with_middles(points, kind, cells), sets


def two_bodies(lower: Body, upper: Body) -> Mesh:
    """Mesh of two bodies; sets ``base``, ``top`` of the first and ``bottom``, ``load`` of the second one."""
    shift = len(lower[0])
    sets = {"base": lower[3][0], "top": lower[3][1], "bottom": shift + upper[3][0], "load": shift + upper[3][1]}
    cells = (lower[2], shift + upper[2])
    body = np.repeat([0, 1], [len(cells[0]), len(cells[1])])
    return Mesh(np.vstack([lower[0], upper[0]]), cells, body, sets, ("lower", "upper"))


def block(
    counts: Sequence[int],
    origin: Sequence[float],
    lengths: Sequence[float] = (1.0, 1.0, 0.5),
    distortion: float = 0.0,
    **options: Any,
) -> Body:
    """A block of bricks or tetrahedra; ``distortion``, in sizes of a brick, moves nodes along x and y."""

    def place(unit: FloatArray) -> FloatArray:
        unit = unit.copy()
        random = np.random.default_rng(sum(counts))
        for axis in (0, 1):
            move = distortion / counts[axis] * random.uniform(-1.0, 1.0, unit.shape[:3])
            unit[..., axis] += np.where((unit[..., axis] % 1.0) == 0.0, 0.0, move)
        return unit * lengths + origin

    return body(counts, place, **options)


def stacked(
    lower: Sequence[int] = (3, 2, 2),
    upper: Sequence[int] = (4, 3, 2),
    offset: Sequence[float] = (0.0, 0.0, 0.0),
    lower_options: Options | None = None,
    upper_options: Options | None = None,
) -> Mesh:
    """A block of 1 x 1 x 0.5 m on another one, moved by ``offset`` (m) from where they touch."""
    return two_bodies(
        block(lower, (0.0, 0.0, 0.0), **(lower_options or {})),
        block(upper, (offset[0], offset[1], 0.5 + offset[2]), **(upper_options or {})),
    )


def moved(mesh: Mesh, rotation: FloatArray, shift: FloatArray) -> Mesh:
    """The mesh turned and shifted."""
    return replace(mesh, points=mesh.points @ rotation.T + shift)


def tube(counts: Sequence[int], inner: float, outer: float, centre: tuple[float, float] = (0.0, 0.0)) -> Body:
    """A tube around z, 1 m long; set 0 is its bore and set 1 its outside. Counts around, along and across."""

    def place(unit: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * unit[..., 0]
        radius = inner + (outer - inner) * unit[..., 2]
        return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), unit[..., 1]], axis=-1)

    points, cells, number = grid(counts, place)
    # The seam: the last nodes around are the first ones.
    first = np.arange(len(points))
    first[number[-1].ravel()] = number[0].ravel()
    retained = np.setdiff1d(np.arange(len(points)), number[-1])
    renumber = np.zeros(len(points), dtype=int)
    renumber[retained] = np.arange(len(retained))
    cells = renumber[first[cells]]
    sets = [np.unique(renumber[first[number[:, :, at]]]) for at in (0, -1)]
    return points[retained], "hexahedron", cells, sets


def pin_in_bore(
    pin: tuple[int, int],
    bore: tuple[int, int],
    pin_radius: float = 0.5,
    bore_radius: float = 0.52,
    centre: tuple[float, float] = (0.0, 0.0),
) -> Mesh:
    """A tube as a pin (``top`` is its outside) in a bore (``bottom``), sides around and along: ``pin``, ``bore``."""
    return two_bodies(tube((*pin, 1), 0.3, pin_radius, centre), tube((*bore, 1), bore_radius, 0.8))


def uniform_pressure(mesh: Mesh, name: str) -> FloatArray:
    """(n_nodes, 3) N, the consistent nodal forces of ``PRESSURE`` on a face."""
    force = np.zeros((mesh.n_nodes, 3))
    for sides in mesh.sides(name):
        where, weight = side_rule(sides.shape[1])
        values, gradients = side_shape_functions(sides.shape[1], where)
        along = np.einsum("qka,mkx->amqx", gradients, mesh.points[sides])
        share = np.einsum("q,qk,mqx->mkx", weight, values, np.cross(along[0], along[1]))
        np.add.at(force, sides, -PRESSURE * share)
    return force


def press(
    mesh: Mesh, pairs: FacePairs, normal_per_area: float, tangential_per_area: float = 1e6
) -> tuple[FloatArray, float, FloatArray]:
    """Patch test: pressure on ``load``, ``base`` held along z, the planes x = 0 and y = 0 held across themselves.

    Returns the contact pressure of each pair over the applied one (n_pairs,), the largest error of the displacements
    over the largest displacement, and the contact forces of all nodes (n_nodes, 3) in N.
    """
    structure = assemble_bodies(mesh, [STEEL, STEEL], hexahedron="trilinear")
    operator = pairs.mesh_operator(mesh.n_nodes)
    springs = pairs.springs(normal_per_area, tangential_per_area)
    stiffness = structure.stiffness + operator.T @ scipy.sparse.diags(springs) @ operator
    held = np.isclose(mesh.points, 0.0, atol=1e-12)
    free = np.flatnonzero(~held.ravel())
    displacement = np.zeros(3 * mesh.n_nodes)
    load = uniform_pressure(mesh, "load").ravel()[free]
    displacement[free] = scipy.sparse.linalg.spsolve(stiffness[free][:, free].tocsc(), load)
    strain = PRESSURE / STEEL.young_modulus
    exact = mesh.points * strain * [0.3, 0.3, -1.0]
    exact[mesh.nodes_of_body(1), 2] -= PRESSURE / normal_per_area
    error = np.abs(displacement.reshape(-1, 3) - exact).max() / np.abs(exact).max()
    forces = springs * (operator @ displacement)
    return forces[2::3] / pairs.area / PRESSURE, error, (operator.T @ forces).reshape(-1, 3)
