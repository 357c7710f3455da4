"""Random structures of the torture set: one mass, chains, beams, plates, twins, and dampers that friction supports.

Each function takes a random generator and returns a :class:`Structure` in SI units with its contact pairs, still
without their constants. All draws are ratios of sizes that a machine part can have.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

import stickslip as ss

FloatArray = NDArray[np.float64]
Random = np.random.Generator

YOUNGS_MODULUS, POISSONS_RATIO, DENSITY = 2.05e11, 0.3, 7850.0  # steel: Pa, 1, kg/m3


@dataclass(frozen=True)
class Structure:
    """A structure with contact pairs of any constants.

    The joint adds its stiffness to ``stiffness``; ``stiffness_at_output`` in N/m is the size with which that of the
    joint is compared.
    """

    mass: FloatArray  # (n, n) kg
    stiffness: FloatArray  # (n, n) N/m
    operator: FloatArray  # (3 n_pairs, n): t1, t2, n of each pair, n > 0 closes
    force: FloatArray  # (n,) N, direction of the excitation
    output: FloatArray  # (n,)
    stiffness_at_output: float


def log_uniform(random: Random, low: float, high: float) -> float:
    """A number whose logarithm is uniform."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def static_stiffness(stiffness: FloatArray, row: FloatArray) -> float:
    """Force over displacement in N/m along a row, in a structure that is supported."""
    return float(1.0 / (row @ np.linalg.solve(stiffness, row)))


def unit(size: int, index: int) -> FloatArray:
    """(size,) a row of the identity."""
    row = np.zeros(size)
    row[index] = 1.0
    return row


def cross_matrix(arm: FloatArray) -> FloatArray:
    """(3, 3) matrix of ``v -> v x arm``: the displacement of a point at ``arm`` for a small rotation ``v``."""
    x, y, z = arm
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def principal_stiffness(random: Random, values: FloatArray, tilt: float) -> FloatArray:
    """(3, 3) N/m with given values along axes that are rotated by random angles up to ``tilt`` rad."""
    rotation = scipy.linalg.expm(cross_matrix(tilt * random.uniform(-1.0, 1.0, 3)))
    return np.asarray(rotation @ np.diag(values) @ rotation.T)


def single_mass(random: Random) -> Structure:
    """A point mass on three springs, with one pair against the ground."""
    mass, hertz = log_uniform(random, 0.05, 20.0), log_uniform(random, 15.0, 600.0)
    along = mass * (2.0 * np.pi * hertz) ** 2
    values = along * np.array([1.0, log_uniform(random, 0.3, 3.0), log_uniform(random, 0.5, 40.0)])
    stiffness = principal_stiffness(random, values, random.choice([0.0, 0.4]))
    force = np.array([1.0, random.choice([0.0, 0.6]), random.uniform(-0.5, 0.5)])
    output = unit(3, 0)
    return Structure(mass * np.eye(3), stiffness, np.eye(3), force, output, static_stiffness(stiffness, output))


def chain(random: Random, masses: tuple[int, int] = (3, 15)) -> Structure:
    """Equal masses in a row from a wall, each link a spring in three directions; 1 to 8 masses rub on the ground."""
    count = int(random.integers(masses[0], masses[1] + 1))
    mass, size = log_uniform(random, 0.05, 2.0), 3 * count
    # The lowest frequency of a chain with one free end is about pi / (2 count) times that of one link.
    link = mass * (2.0 * np.pi * log_uniform(random, 25.0, 400.0) * 2.0 * count / np.pi) ** 2
    values = link * np.array([1.0, log_uniform(random, 0.5, 2.0), log_uniform(random, 1.0, 10.0)])
    stiffness = np.zeros((size, size))
    for number in range(count):
        spring = principal_stiffness(random, values, 0.15)
        ends = np.hstack([np.eye(3), -np.eye(3)]) if number else np.eye(3)
        span = slice(3 * max(number - 1, 0), 3 * number + 3)
        stiffness[span, span] += ends.T @ spring @ ends
    n_pairs = int(random.integers(1, min(count, 8) + 1))
    rubbing = np.sort(random.permutation(count)[:n_pairs])
    operator = np.vstack([np.eye(3, size, 3 * number) for number in rubbing])
    output = unit(size, size - 3)
    force = output + random.uniform(-0.3, 0.3) * unit(size, size - 1)
    return Structure(mass * np.eye(size), stiffness, operator, force, output, static_stiffness(stiffness, output))


def chain_pair(random: Random) -> Structure:
    """Two nearly equal chains with a weak spring between their ends: each mode has a neighbour close to it."""
    one = chain(random, masses=(3, 8))
    size, detuning = len(one.mass), 10.0 ** random.uniform(-4.0, -1.5)
    stiffness = scipy.linalg.block_diag(one.stiffness, one.stiffness)
    ends = np.hstack([np.eye(3, size, size - 3), -np.eye(3, size, size - 3)])
    stiffness += 10.0 ** random.uniform(-4.0, -2.0) * one.stiffness_at_output * ends.T @ ends
    return Structure(
        scipy.linalg.block_diag(one.mass, (1.0 + detuning) * one.mass),
        stiffness,
        scipy.linalg.block_diag(one.operator, one.operator),
        np.concatenate([one.force, random.choice([0.0, 0.3, 1.0, -1.0]) * one.force]),
        np.concatenate([one.output, np.zeros(size)]),
        one.stiffness_at_output,
    )


@dataclass(frozen=True)
class Cantilever:
    """A slender steel beam along x, clamped at x = 0; unknowns of each other node: u, v, w, and rotations about x, y,
    z. Sizes along x, y, z in m.

    Element matrices of axial, torsional and bending motion: J. S. Przemieniecki, Theory of Matrix Structural Analysis
    (1968), without shear and rotary inertia of bending.
    """

    elements: int
    length: float
    width: float
    height: float

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 6 * self.elements

    @cached_property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """Mass and stiffness."""
        width, height, step = self.width, self.height, self.length / self.elements
        area, about_y, about_z = width * height, width * height**3 / 12.0, height * width**3 / 12.0
        thin, thick = sorted((width, height))
        shear_modulus = YOUNGS_MODULUS / (2.0 * (1.0 + POISSONS_RATIO))
        rod = np.array([[1.0, -1.0], [-1.0, 1.0]]) / step
        carried = step / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
        bending = (
            np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], dtype=float)
            * np.outer([1.0, step, 1.0, step], [1.0, step, 1.0, step])
            / step**3
        )
        inertia = (
            np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], dtype=float)
            * np.outer([1.0, step, 1.0, step], [1.0, step, 1.0, step])
            * (step / 420.0)
        )
        # A rotation about y lowers the far end along z, one about z raises it along y.
        downward = np.outer([1.0, -1.0, 1.0, -1.0], [1.0, -1.0, 1.0, -1.0])
        parts = (
            ((0, 6), YOUNGS_MODULUS * area * rod, DENSITY * area * carried),
            ((3, 9), shear_modulus * thick * thin**3 / 3.0 * rod, DENSITY * (about_y + about_z) * carried),
            ((1, 5, 7, 11), YOUNGS_MODULUS * about_z * bending, DENSITY * area * inertia),
            ((2, 4, 8, 10), YOUNGS_MODULUS * about_y * bending * downward, DENSITY * area * inertia * downward),
        )
        mass, stiffness = (np.zeros((self.size + 6, self.size + 6)) for _ in range(2))
        for element in range(self.elements):
            for unknowns, elastic, inertial in parts:
                rows = np.ix_(6 * element + np.array(unknowns), 6 * element + np.array(unknowns))
                stiffness[rows] += elastic
                mass[rows] += inertial
        return mass[6:, 6:], stiffness[6:, 6:]

    def point(self, node: int, arm: FloatArray) -> FloatArray:
        """(3, n) displacement of a point at ``arm`` from a node; node 1 is the first after the clamp."""
        rows = np.zeros((3, self.size))
        rows[:, 6 * node - 6 : 6 * node] = np.hstack([np.eye(3), cross_matrix(arm)])
        return rows

    def tip(self, direction: FloatArray) -> FloatArray:
        """(n,) displacement of the free end along a direction."""
        return np.asarray(direction @ self.point(self.elements, np.zeros(3)))


def beam(random: Random) -> Structure:
    """A cantilever whose lower face lies on 5 to 60 pairs, over the whole length or over its middle part."""
    length, elements = random.uniform(0.1, 0.4), int(random.integers(8, 15))
    body = Cantilever(elements, length, length * random.uniform(0.1, 0.25), length * random.uniform(0.03, 0.08))
    first, last = (1, elements) if random.random() < 0.5 else (1 + elements // 3, 4 * elements // 5)
    operator = []
    for node in random.integers(first, last + 1, int(random.integers(5, 61))):
        foot = body.point(int(node), np.array([0.0, random.uniform(-0.5, 0.5) * body.width, -0.5 * body.height]))
        operator += [foot[0], foot[1], -foot[2]]
    direction = random.normal(size=3) * np.array([0.05, 1.0, 1.0])
    output = body.tip(direction / np.linalg.norm(direction))
    mass, stiffness = body.matrices
    weakest = static_stiffness(stiffness, body.tip(np.array([0.0, 0.0, 1.0])))
    return Structure(mass, stiffness, np.array(operator), output, output, weakest)


def plate(random: Random) -> Structure:
    """A cantilever plate of solid elements that lies on 5 to 24 nodes, reduced to these, a corner and 6 to 15 modes."""
    counts = np.array([random.integers(5, 9), random.integers(3, 6), 2])
    sizes = np.array([random.uniform(0.1, 0.2), random.uniform(0.04, 0.1), random.uniform(0.003, 0.008)])
    index = np.stack(np.meshgrid(*(np.arange(count + 1) for count in counts), indexing="ij"), axis=-1)
    node = np.arange(index[..., 0].size).reshape(index.shape[:3])
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack(
        [node[x : x + counts[0], y : y + counts[1], z : z + counts[2]].ravel() for x, y, z in corners], axis=1
    )
    mesh = ss.Mesh(index.reshape(-1, 3) * sizes / counts, cells)
    solid = ss.assemble(mesh, ss.Material(), fixed_nodes=node[0].ravel())
    lower = node[1 : counts[0] // 2 + 2, :, 0].ravel()
    n_pairs = min(int(random.integers(5, 25)), lower.size)
    contacts = np.sort(random.permutation(lower)[:n_pairs])
    reduced = ss.craig_bampton(solid, [*contacts, node[-1, 0, 2]], int(random.integers(6, 16)))
    closing = np.diag([1.0, 1.0, -1.0])  # the plate closes downward
    operator = np.hstack([np.kron(np.eye(n_pairs), closing), np.zeros((3 * n_pairs, reduced.size - 3 * n_pairs))])
    output = unit(reduced.size, 3 * n_pairs + 2)
    force = output + random.uniform(-0.5, 0.5) * unit(reduced.size, 3 * n_pairs + 1)
    at_corner = static_stiffness(reduced.stiffness, output)
    return Structure(reduced.mass, reduced.stiffness, operator, force, output, at_corner)


def twins(random: Random) -> Structure:
    """Two nearly equal cantilevers side by side that touch each other in 1 to 8 points."""
    length, elements = random.uniform(0.1, 0.3), int(random.integers(5, 10))
    body = Cantilever(elements, length, 0.15 * length, length * random.uniform(0.03, 0.08))
    mass, stiffness = body.matrices
    detuning = 10.0 ** random.uniform(-7.0, -2.0)
    operator = []
    for node in random.integers(1, elements, int(random.integers(1, 9))):
        lift = random.uniform(-0.5, 0.5) * body.height
        near, far = (body.point(int(node), np.array([0.0, side * 0.5 * body.width, lift])) for side in (1.0, -1.0))
        between = np.hstack([near, -far])
        operator += [between[0], between[2], between[1]]
    none = np.zeros(body.size)
    upward, sideways = body.tip(np.array([0.0, 0.0, 1.0])), body.tip(np.array([0.0, 1.0, 0.0]))
    force = np.concatenate(
        [upward + random.uniform(-0.3, 0.3) * sideways, random.choice([0.0, 1.0, -1.0, 0.5]) * upward]
    )
    return Structure(
        scipy.linalg.block_diag(mass, (1.0 + detuning) * mass),
        scipy.linalg.block_diag(stiffness, stiffness),
        np.array(operator),
        force,
        np.concatenate([upward, none]),
        static_stiffness(stiffness, upward),
    )


def rigid_damper(random: Random) -> Structure:
    """Two cantilever blades, and a rigid wedge below their platforms that preload and friction alone support.

    The blades stand along x, outward in the rotor. The wedge between them has 3 to 7 pairs on each of its two roof
    faces; its inclined faces press outward and sideways against the platforms.
    """
    return _blades_and_wedges(random, 1)


def damper_row(random: Random) -> Structure:
    """Three blades in a row with a wedge between each two."""
    return _blades_and_wedges(random, 2)


def shaken_damper(random: Random) -> Structure:
    """Two blades and a wedge whose base moves across the blades with a constant acceleration, 1 m/s2."""
    structure = _blades_and_wedges(random, 1)
    across, axial = 1.0, random.uniform(-0.5, 0.5)
    nodes = (len(structure.mass) - 6) // 6
    rigid = np.concatenate([np.tile([0.0, across, axial, 0.0, 0.0, 0.0], nodes), [0.0, across, axial, 0.0, 0.0, 0.0]])
    return replace(structure, force=structure.mass @ rigid)


def _blades_and_wedges(random: Random, wedges: int) -> Structure:
    """``wedges`` rigid wedges, each between two of a row of nearly equal blades."""
    length, elements = random.uniform(0.1, 0.25), int(random.integers(4, 8))
    blade = Cantilever(elements, length, length * random.uniform(0.04, 0.1), 0.15 * length)
    mass, stiffness = blade.matrices
    detuning = 10.0 ** random.uniform(-4.0, -2.0)
    reach, roof = 0.05 * length, np.deg2rad(random.uniform(15.0, 60.0))  # half of the width of the wedge, slope
    wedge_mass = random.uniform(0.3, 2.0) * DENSITY * 2.0 * reach * reach * blade.height
    wedge = wedge_mass * np.array([1.0, 1.0, 1.0, *(0.67 * reach**2 * np.array([1.0, 1.0, 1.0]))])
    per_face, platform = int(random.integers(3, 8)), elements // 2
    first_of_wedges = (wedges + 1) * blade.size
    operator = []
    for number in range(wedges):
        for side in (-1.0, 1.0):  # the left blade, the right one
            normal, slope = (np.array(row) for row in ((np.cos(roof), side * np.sin(roof), 0.0),
                                                       (np.sin(roof), -side * np.cos(roof), 0.0)))  # fmt: skip
            axes = np.array([[0.0, 0.0, 1.0], slope, normal])
            of_blade = blade.size * (number + (side > 0))
            of_wedge = first_of_wedges + 6 * number
            for _ in range(per_face):
                along, across = random.uniform(-0.5, 0.5, 2)
                place = np.array([0.0, side * reach, 0.0]) + along * reach * slope + [0.0, 0.0, across * blade.height]
                arm = place - [0.0, side * (2.0 * reach + 0.5 * blade.width), 0.0]
                rows = np.zeros((3, first_of_wedges + 6 * wedges))
                rows[:, of_blade : of_blade + blade.size] = -blade.point(platform, arm)
                rows[:, of_wedge : of_wedge + 6] = np.hstack([np.eye(3), cross_matrix(place)])
                operator.append(axes @ rows)
    flap, edge = blade.tip(np.array([0.0, 1.0, 0.0])), blade.tip(np.array([0.0, 0.0, 1.0]))
    other = random.choice([0.0, 1.0, -1.0, 0.3])
    forces = [flap + random.uniform(-0.5, 0.5) * edge, *(other**number * flap for number in range(1, wedges + 1))]
    absent = np.zeros(6 * wedges)
    return Structure(
        scipy.linalg.block_diag(*((1.0 + number * detuning) * mass for number in range(wedges + 1)),
                                *(np.diag(wedge) for _ in range(wedges))),
        scipy.linalg.block_diag(*(stiffness for _ in range(wedges + 1)), np.zeros((6 * wedges, 6 * wedges))),
        np.vstack(operator),
        np.concatenate([*forces, absent]),
        np.concatenate([flap, np.zeros(wedges * blade.size), absent]),
        static_stiffness(stiffness, flap),
    )  # fmt: skip


STRUCTURES: dict[str, Callable[[Random], Structure]] = {
    "mass": single_mass,
    "chain": chain,
    "chain pair": chain_pair,
    "beam": beam,
    "plate": plate,
    "twins": twins,
    "damper": rigid_damper,
    "damper row": damper_row,
    "shaken damper": shaken_damper,
}
