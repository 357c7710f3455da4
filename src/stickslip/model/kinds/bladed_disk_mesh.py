"""Mesh of one sector of the parametric bladed disk: disk, blade with platforms, and the damper towards the next sector.

The disk rotates about z. The blade of this sector stands along x; its neighbours are rotated by 2 pi / N about z. The
wedge damper is symmetric about the plane between this sector and the next one. Platforms and damper have common
positions of nodes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray, Mesh

BODIES = ("blade and disk", "damper")
LEFT, RIGHT = "left boundary", "right boundary"
BLADE = "blade"  # the nodes beyond its root
# Numbers of elements; chosen: natural frequencies of the lowest families change by less than 3 % with twice as many.
DISK_ROWS, SIDE_COLUMNS, BLADE_COLUMNS = 6, 3, 2
SHANK_ROWS, PLATFORM_ROWS, AIRFOIL_ROWS = 3, 2, 10
OVERHANG_COLUMNS, FLANK_ROWS = 2, 1


@dataclass(frozen=True)
class BladedDisk:
    """Dimensions in m, angles in rad, numbers of elements of the contact faces along z and along the slope.

    ``platform_height`` is from the rim to the underside of the platform at the shank, ``platform_angle`` between the
    contact face and the tangential direction. Raises InputError for parts that do not fit.
    """

    sectors: int
    bore_radius: float
    rim_radius: float
    web_thickness: float
    width: float
    blade_length: float
    airfoil_thickness: float
    shank_thickness: float
    platform_height: float
    platform_thickness: float
    platform_gap: float
    contact_face_width: float
    platform_angle: float
    damper_flank_height: float
    contact_columns: int
    contact_rows: int

    def __post_init__(self) -> None:
        room = self.platform_radius * math.tan(self.half_angle)
        widest = 2.0 * (room - self.face_extent[0] - 0.5 * self.platform_gap)
        damper = self.face_extent[1] + self.damper_flank_height
        platform = self.platform_height + 2.0 * self.platform_thickness
        rules = (
            ("rim_radius", self.bore_radius, True, "bore_radius"),
            (
                "shank_thickness",
                widest,
                False,
                f"because half of it, contact_face_width and half of platform_gap share {_mm(room)} of a platform",
            ),
            ("platform_height", damper, True, "the height of the damper, which is above the rim"),
            ("blade_length", platform, True, "platform_height and twice platform_thickness"),
        )
        for key, limit, is_lower, words in rules:
            value = getattr(self, key)
            if not (value > limit if is_lower else value < limit):
                side = "above" if is_lower else "below"
                raise InputError(f"{key} is {_mm(value)}. It must be {side} {_mm(limit)}, {words}.", (key,))

    @property
    def half_angle(self) -> float:
        """Half of the angle of a sector, rad."""
        return math.pi / self.sectors

    @property
    def platform_radius(self) -> float:
        """m, of the underside of the platform at the shank."""
        return self.rim_radius + self.platform_height

    @property
    def face_extent(self) -> tuple[float, float]:
        """m, of a contact face along the tangential direction and along the radius."""
        return (
            self.contact_face_width * math.cos(self.platform_angle),
            self.contact_face_width * math.sin(self.platform_angle),
        )

    def mesh(self) -> Mesh:
        """The mesh, with the sets of the boundaries, the bore, the contact faces and the tip."""
        section = _Section(self)
        grids = {"disk": section.disk(), "blade": section.blade(), "damper": section.damper()}
        grids |= {"right platform": section.platform(), "left platform": section.platform()[::-1] * (1.0, -1.0)}
        return _extruded(grids, self)


def _mm(value: float) -> str:
    return f"{1e3 * value:.4g} mm"


@dataclass(frozen=True)
class _Section:
    """Grids (a, b, 2) of points x, y in the section across the axis."""

    disk_of: BladedDisk

    def _columns(self) -> FloatArray:
        """Angles of the columns of the disk; those in the middle carry the blade."""
        own = self.disk_of
        edge = math.asin(0.5 * own.shank_thickness / own.rim_radius)
        side = np.linspace(edge, own.half_angle, SIDE_COLUMNS + 1)[1:]
        return np.concatenate([-side[::-1], np.linspace(-edge, edge, BLADE_COLUMNS + 1), side])

    def disk(self) -> FloatArray:
        """Rows from bore to rim, columns from left to right."""
        radius = np.linspace(self.disk_of.bore_radius, self.disk_of.rim_radius, DISK_ROWS + 1)[:, None]
        angle = self._columns()
        return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)

    def blade(self) -> FloatArray:
        """Rows from rim to tip, columns from left to right; the first row is that of the disk."""
        own = self.disk_of
        foot = self.disk()[-1, SIDE_COLUMNS : SIDE_COLUMNS + BLADE_COLUMNS + 1]
        low, high = own.platform_radius, own.platform_radius + own.platform_thickness
        height = np.concatenate(
            [
                np.linspace(own.rim_radius, low, SHANK_ROWS + 1)[1:],
                np.linspace(low, high, PLATFORM_ROWS + 1)[1:],
                np.linspace(high, own.rim_radius + own.blade_length, AIRFOIL_ROWS + 1)[1:],
            ]
        )
        thickness = np.where(
            np.arange(height.size) < SHANK_ROWS + PLATFORM_ROWS, own.shank_thickness, own.airfoil_thickness
        )
        across = np.linspace(-0.5, 0.5, BLADE_COLUMNS + 1)
        rows = np.stack(np.broadcast_arrays(height[:, None], thickness[:, None] * across), axis=-1)
        return np.concatenate([foot[None], rows])

    def _face(self) -> FloatArray:
        """(rows + 1, 2) points of the contact face of the right platform, from its lower end to the gap.

        Height along the plane between the sectors, and distance from it towards this sector.
        """
        own = self.disk_of
        across, up = own.face_extent
        part = np.linspace(0.0, 1.0, own.contact_rows + 1)
        lower = self._lower_end()
        return np.stack([lower + part * up, 0.5 * own.platform_gap + (1.0 - part) * across], axis=-1)

    def _lower_end(self) -> float:
        """m, height of the lower end of the face: the underside at the shank continues to it at one radius."""
        own = self.disk_of
        return math.sqrt(own.platform_radius**2 - (0.5 * own.platform_gap + own.face_extent[0]) ** 2)

    def _between(self, height: FloatArray, distance: FloatArray) -> FloatArray:
        """Points at a height along the plane between this sector and the next one, ``distance`` towards this sector."""
        cosine, sine = math.cos(self.disk_of.half_angle), math.sin(self.disk_of.half_angle)
        return np.stack([height * cosine + distance * sine, height * sine - distance * cosine], axis=-1)

    def platform(self) -> FloatArray:
        """The right platform: rows from underside to top, columns from the shank to the gap."""
        own = self.disk_of
        face = self._face()
        contact = self._between(face[:, 0], face[:, 1])
        shank = np.array([own.platform_radius, 0.5 * own.shank_thickness])
        part = np.linspace(0.0, 1.0, OVERHANG_COLUMNS + 1)[:-1, None]
        under = np.concatenate([(1.0 - part) * shank + part * contact[0], contact])
        length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(under, axis=0), axis=1)))
        edge = self._between(face[-1:, 0] + own.platform_thickness, face[-1:, 1])
        top = (
            shank
            + (own.platform_thickness, 0.0)
            + (length / length[-1])[:, None] * (edge - shank - (own.platform_thickness, 0.0))
        )
        rows = np.linspace(0.0, 1.0, PLATFORM_ROWS + 1)[:, None, None]
        return np.asarray((1.0 - rows) * under + rows * top)

    def damper(self) -> FloatArray:
        """The wedge: rows from its bottom to its roof, columns from this sector to the next one."""
        face = self._face()
        height = np.append(face[:, 0], face[::-1, 0])
        distance = np.append(face[:, 1], -face[::-1, 1])
        bottom = face[0, 0] - self.disk_of.damper_flank_height
        rows = np.linspace(0.0, 1.0, FLANK_ROWS + 2)[:, None]
        return self._between(
            (1.0 - rows) * bottom + rows * height, np.broadcast_to(distance, (FLANK_ROWS + 2, distance.size))
        )


def _extruded(grids: Mapping[str, FloatArray], own: BladedDisk) -> Mesh:
    """The grids of the section along z, with common nodes where grids of one body have a position in common."""
    layers = np.linspace(-0.5, 0.5, own.contact_columns + 1)
    points: list[FloatArray] = []
    numbers: dict[str, IntArray] = {}
    bodies: dict[str, int] = {name: int(name == "damper") for name in grids}
    count = 0
    for name, grid in grids.items():
        depth = np.full(grid.shape[0], own.width)
        if name == "disk":
            depth[:-2] = own.web_thickness
        solid = np.concatenate(
            [
                np.broadcast_to(grid[:, :, None], (*grid.shape[:2], layers.size, 2)),
                np.broadcast_to((depth[:, None, None] * layers)[..., None], (*grid.shape[:2], layers.size, 1)),
            ],
            axis=-1,
        )
        numbers[name] = count + np.arange(solid[..., 0].size).reshape(solid.shape[:3])
        points.append(solid.reshape(-1, 3))
        count += solid[..., 0].size
    number, merged = _merged(
        np.concatenate(points), np.repeat([bodies[name] for name in grids], [len(p) for p in points])
    )
    numbers = {name: number[each] for name, each in numbers.items()}
    cells = {name: _bricks(each, merged) for name, each in numbers.items()}
    disk, blade, damper = numbers["disk"], numbers["blade"], numbers["damper"]
    right, left = numbers["right platform"], numbers["left platform"]
    first = damper.shape[1] // 2
    tip = blade[-1, BLADE_COLUMNS // 2, layers.size // 2]
    faces = {
        "damper here": damper[-1, :first], "damper ahead": damper[-1, first:],
        "platform right": right[0, OVERHANG_COLUMNS:], "platform left": left[-1, OVERHANG_COLUMNS:],
    }  # fmt: skip
    every = np.concatenate(list(cells.values()))
    beyond_root = np.setdiff1d(np.concatenate([each.ravel() for each in (blade, right, left)]), blade[0])
    return Mesh(
        merged,
        every,
        np.repeat([bodies[name] for name in cells], [len(each) for each in cells.values()]),
        {
            "bore": np.unique(disk[0]), LEFT: np.unique(disk[:, 0]), RIGHT: np.unique(disk[:, -1]),
            "tip": np.array([tip]), BLADE: beyond_root, "damper middle": np.array([damper[0, first, layers.size // 2]]),
        },
        BODIES,
        {name: (_sides(every, np.unique(nodes)),) for name, nodes in faces.items()},
    )  # fmt: skip


def _merged(points: FloatArray, body: IntArray) -> tuple[IntArray, FloatArray]:
    """Number of each point among those that differ in position or body, and these points."""
    keys = np.column_stack([np.round(points * 1e9).astype(np.int64), body])
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return number.ravel(), points[first]


def _bricks(grid: IntArray, points: FloatArray) -> IntArray:
    """(m, 8) bricks of a grid (a, b, c) of nodes, with positive volume."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    a, b, c = (size - 1 for size in grid.shape)
    cells = np.stack([grid[i : i + a, j : j + b, k : k + c].ravel() for i, j, k in corners], axis=1)
    edges = [points[cells[:, corner]] - points[cells[:, 0]] for corner in (1, 3, 4)]
    inverted = np.einsum("ij,ij->i", np.cross(edges[0], edges[1]), edges[2]) < 0.0
    return np.where(inverted[:, None], cells[:, [4, 5, 6, 7, 0, 1, 2, 3]], cells)


def _sides(cells: IntArray, nodes: IntArray) -> IntArray:
    """(k, 4) sides of bricks whose nodes are all in ``nodes``, seen from outside counter-clockwise."""
    sides = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
    every = cells[:, sides].reshape(-1, 4)
    return np.asarray(every[np.isin(every, nodes).all(axis=1)])
