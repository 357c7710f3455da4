"""The mesh of two blades with an under-platform damper between their platforms."""

from __future__ import annotations

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.model.kinds.damper_sections import damper_section
from stickslip.model.kinds.damper_shapes import Cylinder
from stickslip.model.kinds.plane_sections import Section, blade_section, extrude, mirrored
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.structure.mesh import IntArray, Mesh

_EDGES = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]])
_LONGEST_TO_SHORTEST = 1e4  # chosen: the eigenvalues of thinner bricks do not converge


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
    left, right, damper = sections(geometry, elements)

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
    extruded = [extrude(section, levels) for section, levels in parts]
    points = np.vstack([points for points, _ in extruded])
    cells = np.vstack([start + cells for start, (_, cells) in zip(starts[:-1], extruded, strict=True)])
    _require_solvable(points[cells])
    return Mesh(
        points=points,
        cells=cells,
        body=np.repeat(np.arange(3), [len(cells) for _, cells in extruded]),
        node_sets=node_sets,
    )


def sections(geometry: BladePairGeometry, elements: BladePairElements) -> tuple[Section, Section, Section]:
    """Sections of the left blade, the right blade and the damper. Raises InputError for a damper that does not fit."""
    damper = damper_section(geometry, elements)
    shape = geometry.damper
    lines = shape.positions(geometry.roof) if isinstance(shape, Cylinder) else (None, None)
    left, right = (
        blade_section(of, elements, line) for of, line in zip((geometry, geometry.right), lines, strict=True)
    )
    return left, mirrored(right), damper


def _require_solvable(corners: FloatArray) -> None:
    """Raise InputError for an element (m, 8, 3) that is so thin that round-off hides its bending."""
    edges = np.linalg.norm(corners[:, _EDGES[:, 0]] - corners[:, _EDGES[:, 1]], axis=2)
    short, long = edges.min(axis=1), edges.max(axis=1)
    worst = int((short / long).argmin())
    if long[worst] > _LONGEST_TO_SHORTEST * short[worst]:
        raise InputError(
            f"an element of the mesh has edges of {1e3 * short[worst]:.3g} and {1e3 * long[worst]:.3g} mm. Their ratio "
            f"may be at most {_LONGEST_TO_SHORTEST:g}: increase the smallest dimension of [geometry], or change the "
            "counts of [mesh]."
        )


def _blade_levels(
    geometry: BladePairGeometry, elements: BladePairElements, damper_levels: FloatArray
) -> tuple[FloatArray, int]:
    """The y levels of the blades, and the position of the damper's first level among them."""
    if geometry.damper_spans_width:
        return damper_levels, 0
    beyond = np.linspace(0.5 * geometry.damper_length, 0.5 * geometry.width, elements.beyond_damper + 1)[1:]
    return np.concatenate([-beyond[::-1], damper_levels, beyond]), elements.beyond_damper
