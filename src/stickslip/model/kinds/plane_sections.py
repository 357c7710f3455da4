"""Plane sections of quadrilaterals: the blade, its mirror image, and their extrusion to bricks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.structure.mesh import IntArray


@dataclass(frozen=True)
class Section:
    """Plane section of one body: points (n, 2) x and z, quadrilaterals (m, 4), and named node rows."""

    points: FloatArray
    quads: IntArray
    sets: dict[str, IntArray]


def ruled(lower: FloatArray, upper: FloatArray, rows: int) -> FloatArray:
    """(rows + 1, k, 2) points on straight lines from ``lower`` (k, 2) to ``upper`` (k, 2)."""
    share = np.linspace(0.0, 1.0, rows + 1)[:, None, None]
    return (1.0 - share) * lower + share * upper


def quads(grid: IntArray) -> IntArray:
    """(m, 4) quadrilaterals, counter-clockwise with x to the right and z up, of a grid of node numbers."""
    corners = [grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def columns_below(columns: int, line: float) -> int:
    """Number of the ``columns`` of a contact face below a contact line at the fraction ``line`` of its width."""
    return min(max(round(line * columns), 1), columns - 1)


def contact_slope(geometry: BladePairGeometry, columns: int, line: float | None = None) -> FloatArray:
    """(columns + 1, 2) points x, z of the left contact face, from its low end to the gap.

    ``line`` is the fraction of its width up to a contact line, where a point is then.
    """
    low = np.array([-geometry.damper_half_width, geometry.underside_height_at_shank])
    high = np.array([-0.5 * geometry.platform_gap, geometry.underside_height_at_shank + geometry.slope_rise])
    if line is None:
        share = np.linspace(0.0, 1.0, columns + 1)[:, None]
    else:
        below = columns_below(columns, line)
        parts = np.linspace(0.0, line, below + 1), np.linspace(line, 1.0, columns - below + 1)[1:]
        share = np.concatenate(parts)[:, None]
    return np.asarray((1.0 - share) * low + share * high)


def blade_section(geometry: BladePairGeometry, elements: BladePairElements, line: float | None = None) -> Section:
    """Section of the left blade: shank, platform and airfoil in columns that share their outer face.

    ``line`` is the fraction of the contact face's width up to a contact line; the set "contact" is then its node.
    """
    columns = elements.shank_columns
    outer, inner = -geometry.outer_face, -geometry.damper_half_width
    base, underside, top = 0.0, geometry.underside_height_at_shank, geometry.platform_top_height

    def row(start: float, stop: float, count: int, height: float) -> FloatArray:
        return np.column_stack([np.linspace(start, stop, count + 1), np.full(count + 1, height)])

    shank_top = row(outer, outer + geometry.shank_thickness_at_platform, columns, underside)
    airfoil_bottom = row(outer, outer + geometry.airfoil_thickness, columns, top)
    slope = contact_slope(geometry, elements.contact_columns, line)
    lower = np.vstack([shank_top, row(shank_top[-1, 0], inner, elements.inner_columns, underside)[1:], slope[1:]])
    upper_slope = np.column_stack([slope[:, 0], np.full(len(slope), top)])
    upper = np.vstack(
        [airfoil_bottom, row(airfoil_bottom[-1, 0], inner, elements.inner_columns, top)[1:], upper_slope[1:]]
    )
    shank = ruled(row(outer, outer + geometry.shank_thickness_at_base, columns, base), shank_top, elements.shank_rows)[
        :-1
    ]
    platform = ruled(lower, upper, elements.platform_rows)
    tip = np.column_stack([airfoil_bottom[:, 0], np.full(columns + 1, geometry.blade_length)])
    airfoil = ruled(airfoil_bottom, tip, elements.airfoil_rows)[1:]

    points = np.vstack([block.reshape(-1, 2) for block in (shank, platform, airfoil)])
    numbers = np.split(np.arange(len(points)), np.cumsum([shank[..., 0].size, platform[..., 0].size]))
    shank_grid, platform_grid, airfoil_grid = (
        part.reshape(block.shape[:2]) for part, block in zip(numbers, (shank, platform, airfoil), strict=True)
    )
    column_grid = np.vstack([shank_grid, platform_grid[:, : columns + 1], airfoil_grid])
    outer_shank = column_grid[1 : elements.shank_rows + 1, 0]
    nearest = np.abs(points[outer_shank, 1] - geometry.excitation_height).argmin()
    contact = platform_grid[0, columns + elements.inner_columns :]
    if line is not None:
        at = columns_below(elements.contact_columns, line)
        contact = contact[at : at + 1]
    return Section(
        points=points,
        quads=np.vstack([quads(column_grid), quads(platform_grid[:, columns:])]),
        sets={
            "base": column_grid[0],
            "contact": contact,
            "excitation": outer_shank[nearest : nearest + 1],
            "tip": column_grid[-1, :1],
        },
    )


def sides_at(section: Section, node: int) -> tuple[float, float]:
    """Mean length in m of the sides that meet at a node on the boundary: along the boundary, and into the body."""
    around = section.quads[(section.quads == node).any(axis=1)]
    position = np.argmax(around == node, axis=1)
    rows = np.arange(len(around))
    ends = np.concatenate([around[rows, (position + step) % 4] for step in (1, 3)])
    others, count = np.unique(ends, return_counts=True)
    length = np.linalg.norm(section.points[others] - section.points[node], axis=1)
    return float(length[count == 1].mean()), float(length[count == 2].mean())


def mirrored(section: Section) -> Section:
    """The section mirrored about x = 0, its quadrilaterals turned so that they stay counter-clockwise."""
    return Section(section.points * [-1.0, 1.0], section.quads[:, [1, 0, 3, 2]], section.sets)


def extrude(section: Section, levels: FloatArray) -> tuple[FloatArray, IntArray]:
    """Points (n, 3) and hexahedra (m, 8) of a section extruded along y; x, z and -y are the cells' local axes."""
    n_section = len(section.points)
    points = np.empty((len(levels), n_section, 3))
    points[..., [0, 2]] = section.points
    points[..., 1] = levels[:, None]
    layers = n_section * np.arange(len(levels) - 1)[:, None, None]
    cells = np.concatenate([section.quads + layers + n_section, section.quads + layers], axis=2)
    return points.reshape(-1, 3), cells.reshape(-1, 8)
