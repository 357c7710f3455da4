"""Sectors of disks for tests, and the full rings that they are a part of: small matrices, and meshes of bricks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.structure.cyclic_sector import CyclicSector, Direction
from stickslip.structure.mesh import Mesh
from stickslip.structure.superelement import Superelement

# Nodes of the small sector: disk, blade and platform, and the disk of the next sector, each with three displacements.
DISK, BLADE, PLATFORM, NEXT_DISK = range(4)
OWN = 9
# Of the disk of :func:`tied_blade`.
TIED_SECTORS, TIED_HEIGHT = 5, 0.02


def node(number: int) -> slice:
    """The unknowns of a node of the small sector."""
    return slice(3 * number, 3 * number + 3)


@dataclass(frozen=True)
class SmallDisk:
    """A disk of small sectors whose springs couple all directions, with a pair inside each sector (platform to disk)
    and one across its boundary (platform to the blade of the next sector)."""

    sectors: int
    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray | None
    operator: np.ndarray
    force_cos: np.ndarray
    force_sin: np.ndarray
    gyroscopic: np.ndarray | None = None

    @classmethod
    def of(cls, sectors: int, damped: bool = True, whirls: bool = False) -> SmallDisk:
        """The disk; without a damping matrix unless it is ``damped``, and with Coriolis forces if it ``whirls``."""
        random = np.random.default_rng(3)

        def spring(size: float) -> np.ndarray:
            factor = random.standard_normal((3, 3))
            return size * (np.eye(3) + 0.1 * factor @ factor.T)

        stiffness = np.zeros((12, 12))
        stiffness[node(DISK), node(DISK)] += spring(4e5)
        ends = (DISK, BLADE, 2e5), (BLADE, PLATFORM, 3e5), (DISK, NEXT_DISK, 1.5e5), (BLADE, NEXT_DISK, 3e4)
        for first, second, size in ends:
            one = spring(size)
            for i, j, sign in ((first, first, 1), (second, second, 1), (first, second, -1), (second, first, -1)):
                stiffness[node(i), node(j)] += sign * one
        mass = np.diag(np.repeat([1.0, 0.6, 0.3, 0.0], 3))
        damping = 5.0 * mass + 2e-6 * stiffness
        damping[node(PLATFORM), node(PLATFORM)] += np.diag([3.0, 1.0, 2.0])  # so that it couples the modes
        axes = [np.linalg.qr(random.standard_normal((3, 3)))[0] for _ in range(2)]
        operator = np.zeros((6, 2 * OWN))
        operator[:3, node(PLATFORM)], operator[:3, node(DISK)] = axes[0], -axes[0]
        operator[3:, node(PLATFORM)], operator[3:, OWN + 3 : OWN + 6] = axes[1], -axes[1]
        force = np.zeros((2, OWN, 2))
        force[:, node(BLADE), 0] = [[20.0, 5.0, -8.0], [3.0, 12.0, 5.0]]
        force[:, :, 1] = random.standard_normal((2, OWN))
        whirl = random.standard_normal((12, 12))
        whirl[node(NEXT_DISK)] *= 0.5  # the next sector has its own part of the forces on its disk
        gyroscopic = 30.0 * (whirl - whirl.T) if whirls else None
        return cls(sectors, mass, stiffness, damping if damped else None, operator, force[0], force[1], gyroscopic)

    @property
    def sector(self) -> CyclicSector:
        """One sector for all nodal diameters."""
        return CyclicSector.of_matrices(
            self.mass, self.stiffness, self.damping, self.gyroscopic,
            left=np.arange(3), right=np.arange(9, 12), sectors=self.sectors,
        )  # fmt: skip

    @property
    def pairs(self) -> ContactPairs:
        """The pairs of one sector, with the unknowns of the next one."""
        return self._pairs_with(self.operator, 1)

    def _pairs_with(self, operator: np.ndarray, copies: int) -> ContactPairs:
        return ContactPairs(
            operator,
            normal_stiffness=np.tile([2e5, 1.5e5], copies),
            tangential_stiffness=np.tile([1.2e5, 1e5], copies),
            friction_coefficient=0.4,
            normal_load=np.tile([14.0, 9.0], copies),
        )

    def _of_ring(self, matrix: np.ndarray) -> np.ndarray:
        ring = np.zeros((OWN * self.sectors, OWN * self.sectors))
        for sector in range(self.sectors):
            unknowns = np.append(OWN * sector + np.arange(OWN), OWN * ((sector + 1) % self.sectors) + np.arange(3))
            ring[np.ix_(unknowns, unknowns)] += matrix
        return ring

    @property
    def ring(self) -> Superelement:
        """All sectors, each with its own unknowns."""
        damping, gyroscopic = (
            None if matrix is None else self._of_ring(matrix) for matrix in (self.damping, self.gyroscopic)
        )
        return Superelement(self._of_ring(self.mass), self._of_ring(self.stiffness), damping, gyroscopic=gyroscopic)

    @property
    def ring_pairs(self) -> ContactPairs:
        """The pairs of all sectors."""
        operator = np.zeros((6 * self.sectors, OWN * self.sectors))
        for sector in range(self.sectors):
            following = (sector + 1) % self.sectors
            rows = slice(6 * sector, 6 * sector + 6)
            operator[rows, OWN * sector : OWN * sector + OWN] += self.operator[:, :OWN]
            operator[rows, OWN * following : OWN * following + OWN] += self.operator[:, OWN:]
        return self._pairs_with(operator, self.sectors)

    def ring_force(self, engine_order: int, direction: Direction) -> tuple[np.ndarray, np.ndarray]:
        """Cosine and sine parts (n, 2) of the force on all sectors: sector s has it ``s k / N`` of a period later."""
        cosine, sine = [], []
        sign = 1 if direction == "forward" else -1
        for sector in range(self.sectors):
            angle = sign * 2.0 * np.pi * engine_order * sector / self.sectors * np.array([1, 2])
            cosine.append(self.force_cos * np.cos(angle) - self.force_sin * np.sin(angle))
            sine.append(self.force_cos * np.sin(angle) + self.force_sin * np.cos(angle))
        return np.vstack(cosine), np.vstack(sine)


def annulus(
    sectors: int, radii: tuple[float, float], thickness: float, counts: tuple[int, int, int], of: int | None = None
) -> Mesh:
    """A plate with a hole about the z axis in bricks: one of ``sectors`` sectors, or ``of`` of them (all: a ring).

    ``counts`` are the bricks along the radius, round a sector and through the thickness. Node sets: inner, left and
    right (not of a ring).
    """
    radial, around, through = counts
    spread = around * (of or 1)
    closed = of == sectors
    angle = np.arange(spread + (not closed)) * 2.0 * np.pi / (sectors * around)
    radius = np.geomspace(*radii, radial + 1)  # finer at the bore, where plates bend most
    height = np.linspace(0.0, thickness, through + 1)
    r, a, z = np.meshgrid(radius, angle, height, indexing="ij")
    points = np.stack([r * np.cos(a), r * np.sin(a), z], axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(r.shape)
    ahead = np.roll(number, -1, axis=1)[:, :spread]
    here = number[:, :spread]
    cells = np.stack(
        [
            corner[i : radial + i, :, k : through + k]
            for k in (0, 1)
            for corner, i in ((here, 0), (here, 1), (ahead, 1), (ahead, 0))
        ],
        axis=-1,
    ).reshape(-1, 8)
    sets = {"inner": number[0].ravel()}
    if not closed:
        sets |= {"left": number[:, 0].ravel(), "right": number[:, -1].ravel()}
    return Mesh(points, cells, node_sets=sets)


def tied_blade(part: float, around: int) -> Mesh:
    """A disk sector, and a blade on a ``part`` of its rim with ``around`` bricks, in other elements than the disk."""
    angle_of_sector = 2.0 * np.pi / TIED_SECTORS
    disk = annulus(TIED_SECTORS, (0.05, 0.15), TIED_HEIGHT, (3, 4, 1), of=1)
    blade = annulus(TIED_SECTORS, (0.15, 0.25), TIED_HEIGHT, (3, around, 2), of=1)
    radius = np.hypot(blade.points[:, 0], blade.points[:, 1])
    angle = (np.arctan2(blade.points[:, 1], blade.points[:, 0]) - 0.5 * angle_of_sector) * part + 0.5 * angle_of_sector
    height = 0.1 * TIED_HEIGHT + 0.8 * blade.points[:, 2]
    moved = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
    points, first = np.vstack([disk.points, moved]), disk.n_nodes
    sets = {
        "bore": disk.node_sets["inner"],
        "rim": np.flatnonzero(np.hypot(*disk.points[:, :2].T) > 0.1499),
        "foot": first + blade.node_sets["inner"],
        "tip": first + np.flatnonzero(radius > 0.2499),
    }
    angles = np.arctan2(points[:, 1], points[:, 0])
    sets |= {
        "left": np.flatnonzero(np.abs(angles) < 1e-9),
        "right": np.flatnonzero(np.abs(angles - angle_of_sector) < 1e-9),
    }
    body = np.repeat([0, 1], [disk.n_cells, blade.n_cells])
    return Mesh(
        points, np.vstack([np.asarray(disk.cells), first + np.asarray(blade.cells)]), body, sets, ("disk", "blade")
    )
