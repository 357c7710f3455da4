"""Plane sections of the damper: wedge, plate and cylinder."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.model.kinds.damper_shapes import Cylinder, Plate, Roof
from stickslip.model.kinds.plane_sections import Section, contact_slope, quads, ruled
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry

BoolArray = NDArray[np.bool_]
# chosen: corners of the square in the middle of a cylinder, as a fraction of its radius.
CORE = 0.55


def damper_section(geometry: BladePairGeometry, elements: BladePairElements) -> Section:
    """Section of the damper, with the sets left, right (contact), left_middle, right_middle and bottom.

    Raises InputError for a cylinder that does not fit, or whose contact lines have no elements on both sides.
    """
    if isinstance(geometry.damper, Cylinder):
        geometry.require_cylinder_fits()
        elements.require_lines()
        return _cylinder_section(geometry.damper, geometry.roof, elements)
    if isinstance(geometry.damper, Plate):
        return _plate_section(geometry, geometry.damper.thickness, elements)
    return _wedge_section(geometry, elements)


def _wedge_section(geometry: BladePairGeometry, elements: BladePairElements) -> Section:
    """Rows across the width, vertical flanks below, contact faces as left and right ends."""
    left, right = (_damper_side(side, elements) for side in (geometry, geometry.right))
    grid_points = np.swapaxes(ruled(left, right * [-1.0, 1.0], elements.damper_columns), 0, 1)
    grid = np.arange(grid_points[..., 0].size).reshape(grid_points.shape[:2])
    faces = grid[elements.damper_flank_rows :]
    middle = slice(elements.contact_columns // 2, elements.contact_columns // 2 + 1)
    return Section(
        points=grid_points.reshape(-1, 2),
        quads=quads(grid),
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
    slope = contact_slope(geometry, elements.contact_columns)
    bottom = slope[0] - [0.0, geometry.damper_flank_height]
    return np.vstack([ruled(bottom[None], slope[:1], elements.damper_flank_rows)[:-1, 0], slope])


def _plate_section(geometry: BladePairGeometry, thickness: float, elements: BladePairElements) -> Section:
    """Rows of one thickness; columns below the left contact face, below the gap, and below the right contact face."""
    slope, columns = contact_slope(geometry, elements.contact_columns), elements.contact_columns
    half = 0.5 * geometry.platform_gap
    middle = np.column_stack(
        [np.linspace(-half, half, elements.damper_columns + 1), np.full(elements.damper_columns + 1, slope[0, 1])]
    )
    top = np.vstack([slope, middle[1:-1], slope[::-1] * [-1.0, 1.0]])
    grid_points = ruled(top - [0.0, thickness], top, elements.damper_flank_rows)
    grid = np.arange(grid_points[..., 0].size).reshape(grid_points.shape[:2])
    left, right = grid[-1, : columns + 1], grid[-1, -columns - 1 :][::-1]
    at = slice(columns // 2, columns // 2 + 1)
    return Section(
        points=grid_points.reshape(-1, 2),
        quads=quads(grid),
        sets={"bottom": grid[0], "left": left, "right": right, "left_middle": left[at], "right_middle": right[at]},
    )


def _cylinder_section(shape: Cylinder, roof: Roof, elements: BladePairElements) -> Section:
    """A square of ``damper_columns`` on a side in the middle, and ``damper_flank_rows`` rings around it.

    Two corners of the square look to the contact lines. The polygon has the area of the circle: its nodes but those of
    the lines are slightly outside.
    """
    count, rings = elements.damper_columns, elements.damper_flank_rows
    corners = _corner_angles(roof)
    angles = np.concatenate(
        [
            np.linspace(start, stop, count, endpoint=False)
            for start, stop in zip(corners, np.append(corners[1:], corners[0] + 2.0 * np.pi), strict=True)
        ]
    )
    on_lines = np.zeros(4 * count, dtype=bool)
    on_lines[[0, count]] = True
    circle = np.where(on_lines, 1.0, _radius_of_others(angles, on_lines))[:, None] * _unit(angles)
    square = CORE * _unit(corners)
    core = ruled(  # rows from the bottom, columns from the left
        ruled(square[2:3], square[3:4], count)[:, 0], ruled(square[1:2], square[0:1], count)[:, 0], count
    )
    numbers = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    around = np.concatenate([numbers[-1, :0:-1], numbers[:0:-1, 0], numbers[0, :-1], numbers[:-1, -1]])
    outwards = ruled(core.reshape(-1, 2)[around], circle, rings)[1:]
    layers = np.vstack([around, numbers.size + np.arange(4 * count * rings).reshape(rings, 4 * count)])
    closed = np.column_stack([layers, layers[:, 0]])
    ring = np.stack([closed[:-1, :-1], closed[1:, :-1], closed[1:, 1:], closed[:-1, 1:]], axis=-1).reshape(-1, 4)
    outer = layers[-1]
    lowest = outer[2 * count + count // 2 : 2 * count + (count + 1) // 2 + 1]
    left, right = outer[count : count + 1], outer[:1]
    unscaled = np.vstack([core.reshape(-1, 2), outwards.reshape(-1, 2)])
    return Section(
        points=shape.centre(roof) + shape.radius * unscaled,
        quads=np.vstack([quads(numbers), ring]),
        sets={"bottom": lowest, "left": left, "right": right, "left_middle": left, "right_middle": right},
    )


def _corner_angles(roof: Roof) -> FloatArray:
    """(4,) rad from the x-axis: the right and the left contact line, and two corners symmetric about the lowest point,
    whose arc is a third of the rest."""
    left, right = roof.angles
    third = (2.0 * np.pi - left - right) / 3.0
    return np.array([0.5 * np.pi - right, 0.5 * np.pi + left, 1.5 * np.pi - 0.5 * third, 1.5 * np.pi + 0.5 * third])


def _unit(angles: FloatArray) -> FloatArray:
    """(n, 2) directions x, z."""
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _radius_of_others(angles: FloatArray, on_lines: BoolArray) -> float:
    """Radius s of the nodes beside the contact lines, where these have 1, for an area of pi: a s^2 + b s + c = pi."""
    sine = 0.5 * np.sin(np.diff(np.append(angles, angles[0] + 2.0 * np.pi)))
    ends = on_lines.astype(int) + np.roll(on_lines, -1)
    a, b, c = (float(sine[ends == number].sum()) for number in range(3))
    return float((-b + np.sqrt(b * b - 4.0 * a * (c - np.pi))) / (2.0 * a))
