"""Constraints and forces along directions that nodes have of their own, in basic x, y, z."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.raw_model import RawConstraint, RawLoad
from stickslip.formats.meshes.raw_ties import RawEquation, basic_terms

PARALLEL = 1e-9  # largest deviation from x, y, z of directions that count as equal to them


def spanned_axes(rows: FloatArray) -> tuple[int, ...] | None:
    """Which of x, y, z (0, 1, 2) span the same as orthogonal unit vectors (k, 3); None if none do."""
    projector = rows.T @ rows
    whole = np.round(projector)
    if not np.abs(projector - whole).max(initial=0.0) <= PARALLEL:
        return None
    return tuple(np.flatnonzero(np.diag(whole)).tolist())


def basic_constraints(
    constraints: Iterable[RawConstraint], frames: Mapping[int, FloatArray]
) -> tuple[list[RawConstraint], list[RawEquation]]:
    """Constraints in x, y, z, and equations where the constrained directions span no x, y, z.

    ``frames`` are the directions 1, 2, 3 (3, 3) of nodes by label, as rows. All constraints of a node are combined.
    """
    plain: list[RawConstraint] = []
    directions: dict[int, set[int]] = {}
    lines: dict[int, int] = {}
    for entry in constraints:
        turned = np.array([label in frames for label in entry.nodes.tolist()], dtype=bool)
        for label in entry.nodes[turned].tolist():
            directions.setdefault(label, set()).update(entry.directions)
            lines.setdefault(label, entry.line)
        if not turned.all():
            plain.append(replace(entry, nodes=entry.nodes[~turned]))
    equations = []
    for label, chosen in directions.items():
        for first in (0, 3):
            mine = sorted(each for each in chosen if first <= each < first + 3)
            axes = spanned_axes(frames[label][[each - first for each in mine]])
            if axes is not None:
                if axes:
                    where = tuple(first + axis for axis in axes)
                    plain.append(RawConstraint(np.array([label], dtype=np.int64), where, lines[label]))
                continue
            equations += [
                RawEquation("the constraint", tuple(basic_terms(frames, label, each, 1.0)), lines[label], is_free=True)
                for each in mine
            ]
    return plain, equations


def basic_loads(loads: Iterable[RawLoad], frames: Mapping[int, FloatArray]) -> list[RawLoad]:
    """Forces in x, y, z."""
    answer = []
    for load in loads:
        turned = np.array([label in frames for label in load.nodes.tolist()], dtype=bool)
        if not turned.all():
            answer.append(replace(load, nodes=load.nodes[~turned]))
        for label in load.nodes[turned].tolist():
            row = frames[label][load.direction]
            answer += [
                RawLoad(np.array([label], dtype=np.int64), axis, float(share) * load.value, load.line)
                for axis, share in enumerate(row)
                if share != 0.0
            ]
    return answer
