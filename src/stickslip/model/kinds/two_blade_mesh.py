"""Two blades with an under-platform damper between their platforms: parametric geometry and mesh.

The section lies in the x-z plane (x across the gap, z from the clamped base to the tips) and is extruded along y. The
left blade stands at x < 0, the right blade is its mirror image, the damper sits below the gap. The default dimensions
come from no drawing: seven of them were fitted to the first ten natural frequencies of such a pair with tied contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, real_number, require_allowed, whole_number
from stickslip.structure.mesh import IntArray, Mesh


@dataclass(frozen=True)
class BladePairGeometry:
    """Dimensions in metres and the platform angle in degrees.

    blade_length, width, airfoil_thickness:
        base to tip (z), chord (y), and thickness of the airfoil (x).
    damper_length:
        along y, centred; at most ``width``.
    contact_face_width, platform_angle_deg, right_platform_angle_deg:
        width of a contact face along its slope, and the slope against the x-axis; None for a right blade that mirrors
        the left one. If the angles differ, the underside of the right platform has another height (``right``).
    underside_height_at_shank, inner_overhang:
        height of the flat platform underside, and its length from the shank to the contact face.
    platform_edge_thickness, platform_gap:
        thickness of the platform at its free edge; gap between the platforms, which is the damper's top width too.
    shank_thickness_at_platform, shank_thickness_at_base:
        linear taper; the outer face of the shank is flush with the airfoil.
    damper_flank_height:
        height of the damper's vertical flanks below its contact faces.
    excitation_height:
        height of N1 and N2 above the base, on the outer shank face at mid-chord; moved to the nearest node.

    Raises
    ------
    InputError
        for a dimension that is not a positive number, an angle outside 0 to 90 degrees, or parts that do not fit.
    """

    blade_length: float = 145.0e-3
    width: float = 28.0e-3
    airfoil_thickness: float = 7.0e-3
    damper_length: float = 28.0e-3
    contact_face_width: float = 6.5e-3
    platform_angle_deg: float = 30.0
    underside_height_at_shank: float = 36.7e-3
    inner_overhang: float = 11.7e-3
    platform_edge_thickness: float = 5.7e-3
    platform_gap: float = 1.0e-3
    shank_thickness_at_platform: float = 13.9e-3
    shank_thickness_at_base: float = 9.3e-3
    damper_flank_height: float = 2.5e-3
    excitation_height: float = 3.67e-3
    right_platform_angle_deg: float | None = None

    def __post_init__(self) -> None:
        for item in fields(self):
            if getattr(self, item.name) is None:
                continue
            value = real_number(item.name, getattr(self, item.name))
            if item.name.endswith("platform_angle_deg"):
                require_allowed(item.name, value, 0.0 < value < 90.0, "between 0 and 90 degrees")
            else:
                require_allowed(item.name, value, value > 0.0, "above 0 m (28 mm is 0.028)")
        self._require_fit()
        _ = self.right  # its parts must fit, too

    @property
    def right(self) -> BladePairGeometry:
        """The mirrored right side with its own platform angle; the upper ends of both contact faces, and with them both
        platform tops, have the same height, so that its underside is higher or lower. Raises InputError."""
        if self.right_platform_angle_deg is None:
            return self
        own_rise = self.contact_face_width * math.sin(math.radians(self.right_platform_angle_deg))
        return replace(
            self,
            platform_angle_deg=self.right_platform_angle_deg,
            right_platform_angle_deg=None,
            underside_height_at_shank=self.underside_height_at_shank + self.slope_rise - own_rise,
        )

    def _require_fit(self) -> None:
        """Raise InputError where the parts would overlap or turn inside out."""
        if self.damper_length > self.width and not self.damper_spans_width:
            raise InputError(
                f"damper_length is {1e3 * self.damper_length:.6g} mm; it must be at most {1e3 * self.width:.6g} mm, "
                "the width of the blades; a longer damper does not fit under the platforms.",
                ("damper_length", "width"),
            )
        self._below(
            "damper_flank_height",
            self.damper_flank_height,
            self.underside_height_at_shank,
            "underside_height_at_shank, or the damper reaches the base and does not fit",
            ("damper_flank_height", "underside_height_at_shank"),
        )
        self._below(
            "airfoil_thickness",
            self.airfoil_thickness,
            self.shank_thickness_at_platform + self.inner_overhang,
            "shank_thickness_at_platform + inner_overhang, or the airfoil covers the whole platform",
            ("airfoil_thickness", "shank_thickness_at_platform", "inner_overhang"),
        )
        self._below(
            "shank_thickness_at_base",
            self.shank_thickness_at_base + self._damper_bottom_taper,
            self.shank_thickness_at_platform + self.inner_overhang,
            "shank_thickness_at_platform + inner_overhang at the height of the damper's bottom, or the damper does "
            "not fit between the shanks",
            ("shank_thickness_at_base", "shank_thickness_at_platform", "inner_overhang"),
        )
        self._below(
            "platform_top_height (underside_height_at_shank + slope + platform_edge_thickness)",
            self.platform_top_height,
            self.blade_length,
            "blade_length, or no airfoil is left",
            (
                "underside_height_at_shank",
                "contact_face_width",
                "platform_angle_deg",
                "platform_edge_thickness",
                "blade_length",
            ),
        )
        self._below(
            "excitation_height",
            self.excitation_height,
            self.underside_height_at_shank,
            "underside_height_at_shank, because N1 and N2 are on the shank",
            ("excitation_height", "underside_height_at_shank"),
        )

    @property
    def _damper_bottom_taper(self) -> float:
        """Change of the shank's thickness from the base to the height of the damper's bottom, m."""
        share = 1.0 - self.damper_flank_height / self.underside_height_at_shank
        return share * (self.shank_thickness_at_platform - self.shank_thickness_at_base)

    @staticmethod
    def _below(name: str, value: float, limit: float, reason: str, keys: tuple[str, ...]) -> None:
        if not value < limit:
            raise InputError(f"{name} is {1e3 * value:.6g} mm; it must be below {1e3 * limit:.6g} mm: {reason}.", keys)

    @property
    def damper_spans_width(self) -> bool:
        """Whether damper and blades end at the same y (to round-off, so that no sliver of a brick is left)."""
        return math.isclose(self.damper_length, self.width, rel_tol=1e-9)

    @property
    def slope_run(self) -> float:
        """Extent of a contact face along x, m."""
        return self.contact_face_width * math.cos(math.radians(self.platform_angle_deg))

    @property
    def slope_rise(self) -> float:
        """Extent of a contact face along z, m."""
        return self.contact_face_width * math.sin(math.radians(self.platform_angle_deg))

    @property
    def platform_top_height(self) -> float:
        """Height of the flat platform top, m."""
        return self.underside_height_at_shank + self.slope_rise + self.platform_edge_thickness

    @property
    def damper_half_width(self) -> float:
        """Half of the damper's bottom width, m."""
        return 0.5 * self.platform_gap + self.slope_run

    @property
    def outer_face(self) -> float:
        """Distance of the blades' outer faces from the plane of symmetry x = 0, m."""
        return self.damper_half_width + self.inner_overhang + self.shank_thickness_at_platform


MOST_ELEMENTS = 2_000_000  # six million unknowns; their factor alone takes more than 100 GB


@dataclass(frozen=True)
class BladePairElements:
    """Numbers of elements. Columns count along x, rows along z, ``chordwise`` along the damper's length (y).

    ``beyond_damper`` elements cover each end of the blades when the damper is shorter than their width. The damper
    has as many rows on its slopes as the platform has ``contact_columns``, so that the contact nodes coincide.

    Raises InputError for a count that is not a positive whole number.
    """

    shank_columns: int = 3
    shank_rows: int = 10
    platform_rows: int = 4
    airfoil_rows: int = 30
    inner_columns: int = 2
    contact_columns: int = 4
    chordwise: int = 10
    beyond_damper: int = 1
    damper_columns: int = 4
    damper_flank_rows: int = 2

    def __post_init__(self) -> None:
        for item in fields(self):
            whole_number(item.name, getattr(self, item.name), 1)
        if self.most_elements > MOST_ELEMENTS:
            raise InputError(
                f"the counts of [mesh] make up to {self.most_elements} elements, but at most {MOST_ELEMENTS} are "
                "allowed, because usual machines have no memory for more. Use smaller counts."
            )

    @property
    def most_elements(self) -> int:
        """Number of elements where the damper is shorter than the blades; else those beyond it are not there."""
        rows = self.shank_rows + self.platform_rows + self.airfoil_rows
        blade = self.shank_columns * rows + (self.inner_columns + self.contact_columns) * self.platform_rows
        damper = self.damper_columns * (self.damper_flank_rows + self.contact_columns)
        return 2 * (self.chordwise + 2 * self.beyond_damper) * blade + self.chordwise * damper


@dataclass(frozen=True)
class _Section:
    """Plane section of one body: points (n, 2) x and z, quadrilaterals (m, 4), and named node rows."""

    points: FloatArray
    quads: IntArray
    sets: dict[str, IntArray]


def blade_pair_mesh(geometry: BladePairGeometry | None = None, elements: BladePairElements | None = None) -> Mesh:
    """Mesh of the two blades (bodies 0 left, 1 right) and the damper (body 2); the defaults give 3360 bricks.

    Node sets: ``fixed`` (base of both blades), ``left_face``, ``right_face`` (platform sides of the contact),
    ``damper_left_face``, ``damper_right_face``, ``excitation_left`` (N1), ``excitation_right`` (N2): the node of the
    outer shank face nearest to mid-chord and ``excitation_height``, never on the base; ``response`` (A): outer edge
    of the left tip at mid-chord; ``damper_left_mid``, ``damper_right_mid``: the node nearest to the middle of each
    damper face; ``damper_front_edge``, ``damper_back_edge``: the two ends of its flat bottom. Face nodes run along y
    in the outer loop and up the slope in the inner loop.

    Raises InputError (from the geometry, the counts, or a cell that turns out inverted).
    """
    geometry = geometry or BladePairGeometry()
    elements = elements or BladePairElements()
    damper_levels = 0.5 * geometry.damper_length * np.linspace(-1.0, 1.0, elements.chordwise + 1)
    blade_levels, first_level = _blade_levels(geometry, elements, damper_levels)
    left = _blade_section(geometry, elements)
    right = _mirrored(_blade_section(geometry.right, elements))
    damper = _damper_section(geometry, elements)

    parts = [(left, blade_levels), (right, blade_levels), (damper, damper_levels)]
    starts = np.concatenate([[0], np.cumsum([len(section.points) * len(levels) for section, levels in parts])])
    contact = slice(first_level, first_level + len(damper_levels))
    middle_blade = [int(np.abs(blade_levels).argmin())]
    middle_damper = [int(np.abs(damper_levels).argmin())]

    def nodes(part: int, name: str, levels: slice | list[int] = slice(None)) -> IntArray:
        section, all_levels = parts[part]
        layers = np.arange(len(all_levels))[levels]
        return np.asarray(
            starts[part] + (layers[:, None] * len(section.points) + section.sets[name]).ravel(), dtype=np.int64
        )

    node_sets = {
        "fixed": np.concatenate([nodes(0, "base"), nodes(1, "base")]),
        "left_face": nodes(0, "contact", contact),
        "right_face": nodes(1, "contact", contact),
        "damper_left_face": nodes(2, "left"),
        "damper_right_face": nodes(2, "right"),
        "excitation_left": nodes(0, "excitation", middle_blade),
        "excitation_right": nodes(1, "excitation", middle_blade),
        "response": nodes(0, "tip", middle_blade),
        "damper_front_edge": nodes(2, "bottom", [0]),
        "damper_back_edge": nodes(2, "bottom", [len(damper_levels) - 1]),
        "damper_left_mid": nodes(2, "left_middle", middle_damper),
        "damper_right_mid": nodes(2, "right_middle", middle_damper),
    }
    extruded = [_extrude(section, levels) for section, levels in parts]
    return Mesh(
        points=np.vstack([points for points, _ in extruded]),
        cells=np.vstack([start + cells for start, (_, cells) in zip(starts[:-1], extruded, strict=True)]),
        body=np.repeat(np.arange(3), [len(cells) for _, cells in extruded]),
        node_sets=node_sets,
    )


def _blade_levels(
    geometry: BladePairGeometry, elements: BladePairElements, damper_levels: FloatArray
) -> tuple[FloatArray, int]:
    """The y levels of the blades, and the position of the damper's first level among them."""
    if geometry.damper_spans_width:
        return damper_levels, 0
    beyond = np.linspace(0.5 * geometry.damper_length, 0.5 * geometry.width, elements.beyond_damper + 1)[1:]
    return np.concatenate([-beyond[::-1], damper_levels, beyond]), elements.beyond_damper


def _ruled(lower: FloatArray, upper: FloatArray, rows: int) -> FloatArray:
    """(rows + 1, k, 2) points on straight lines from ``lower`` (k, 2) to ``upper`` (k, 2)."""
    share = np.linspace(0.0, 1.0, rows + 1)[:, None, None]
    return (1.0 - share) * lower + share * upper


def _quads(grid: IntArray) -> IntArray:
    """(m, 4) quadrilaterals, counter-clockwise with x to the right and z up, of a grid of node numbers."""
    corners = [grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def _slope(geometry: BladePairGeometry, columns: int) -> FloatArray:
    """(columns + 1, 2) points x, z of the left contact face, from its low end to the gap."""
    low = np.array([-geometry.damper_half_width, geometry.underside_height_at_shank])
    high = np.array([-0.5 * geometry.platform_gap, geometry.underside_height_at_shank + geometry.slope_rise])
    share = np.linspace(0.0, 1.0, columns + 1)[:, None]
    return np.asarray((1.0 - share) * low + share * high)


def _blade_section(geometry: BladePairGeometry, elements: BladePairElements) -> _Section:
    """Section of the left blade: shank, platform and airfoil in columns that share their outer face."""
    columns = elements.shank_columns
    outer, inner = -geometry.outer_face, -geometry.damper_half_width
    base, underside, top = 0.0, geometry.underside_height_at_shank, geometry.platform_top_height

    def line(start: float, stop: float, count: int, height: float) -> FloatArray:
        return np.column_stack([np.linspace(start, stop, count + 1), np.full(count + 1, height)])

    shank_top = line(outer, outer + geometry.shank_thickness_at_platform, columns, underside)
    airfoil_bottom = line(outer, outer + geometry.airfoil_thickness, columns, top)
    slope = _slope(geometry, elements.contact_columns)
    lower = np.vstack([shank_top, line(shank_top[-1, 0], inner, elements.inner_columns, underside)[1:], slope[1:]])
    upper_slope = np.column_stack([slope[:, 0], np.full(len(slope), top)])
    upper = np.vstack(
        [airfoil_bottom, line(airfoil_bottom[-1, 0], inner, elements.inner_columns, top)[1:], upper_slope[1:]]
    )
    shank = _ruled(
        line(outer, outer + geometry.shank_thickness_at_base, columns, base), shank_top, elements.shank_rows
    )[:-1]
    platform = _ruled(lower, upper, elements.platform_rows)
    tip = np.column_stack([airfoil_bottom[:, 0], np.full(columns + 1, geometry.blade_length)])
    airfoil = _ruled(airfoil_bottom, tip, elements.airfoil_rows)[1:]

    points = np.vstack([block.reshape(-1, 2) for block in (shank, platform, airfoil)])
    numbers = np.split(np.arange(len(points)), np.cumsum([shank[..., 0].size, platform[..., 0].size]))
    shank_grid, platform_grid, airfoil_grid = (
        part.reshape(block.shape[:2]) for part, block in zip(numbers, (shank, platform, airfoil), strict=True)
    )
    column_grid = np.vstack([shank_grid, platform_grid[:, : columns + 1], airfoil_grid])
    outer_shank = column_grid[1 : elements.shank_rows + 1, 0]
    nearest = np.abs(points[outer_shank, 1] - geometry.excitation_height).argmin()
    return _Section(
        points=points,
        quads=np.vstack([_quads(column_grid), _quads(platform_grid[:, columns:])]),
        sets={
            "base": column_grid[0],
            "contact": platform_grid[0, columns + elements.inner_columns :],
            "excitation": outer_shank[nearest : nearest + 1],
            "tip": column_grid[-1, :1],
        },
    )


def _mirrored(section: _Section) -> _Section:
    """The section mirrored about x = 0, its quadrilaterals turned so that they stay counter-clockwise."""
    return _Section(section.points * [-1.0, 1.0], section.quads[:, [1, 0, 3, 2]], section.sets)


def _damper_section(geometry: BladePairGeometry, elements: BladePairElements) -> _Section:
    """Section of the damper: rows across its width, vertical flanks below, contact faces as left and right ends."""
    left, right = (_damper_side(side, elements) for side in (geometry, geometry.right))
    grid_points = np.swapaxes(_ruled(left, right * [-1.0, 1.0], elements.damper_columns), 0, 1)
    grid = np.arange(grid_points[..., 0].size).reshape(grid_points.shape[:2])
    faces = grid[elements.damper_flank_rows :]
    middle = slice(elements.contact_columns // 2, elements.contact_columns // 2 + 1)
    return _Section(
        points=grid_points.reshape(-1, 2),
        quads=_quads(grid),
        sets={
            "bottom": grid[0],
            "left": faces[:, 0],
            "right": faces[:, -1],
            "left_middle": faces[middle, 0],
            "right_middle": faces[middle, -1],
        },
    )


def _damper_side(geometry: BladePairGeometry, elements: BladePairElements) -> FloatArray:
    """(n, 2) points of the left end of the damper: its vertical flank and its contact face."""
    slope = _slope(geometry, elements.contact_columns)
    bottom = slope[0] - [0.0, geometry.damper_flank_height]
    return np.vstack([_ruled(bottom[None], slope[:1], elements.damper_flank_rows)[:-1, 0], slope])


def _extrude(section: _Section, levels: FloatArray) -> tuple[FloatArray, IntArray]:
    """Points (n, 3) and hexahedra (m, 8) of a section extruded along y; x, z and -y are the cells' local axes."""
    n_section = len(section.points)
    points = np.empty((len(levels), n_section, 3))
    points[..., [0, 2]] = section.points
    points[..., 1] = levels[:, None]
    layers = n_section * np.arange(len(levels) - 1)[:, None, None]
    cells = np.concatenate([section.quads + layers + n_section, section.quads + layers], axis=2)
    return points.reshape(-1, 3), cells.reshape(-1, 8)
