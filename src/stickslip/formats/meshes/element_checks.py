"""Checks of the elements of a model file: numbering, repeated elements, inverted and folded shapes."""

from __future__ import annotations

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.raw_model import RawBlock, RawModel
from stickslip.structure.cell_kinds import CELL_KINDS, IntArray
from stickslip.structure.shapes import mass_rule, shape_functions, stiffness_rule

_CELLS_AT_ONCE = 5000  # chosen to bound the memory
_SHOWN = 5  # chosen: elements in a message


def require_sound_elements(raw: RawModel, points: FloatArray, blocks: list[tuple[RawBlock, IntArray]]) -> None:
    """Raise ImportFileError for labels or elements that occur twice, and for flat, inverted or folded elements.

    ``points`` (n, 3) m; ``blocks`` are each block with its cells in numbers of these points.
    """
    _require_distinct_labels(raw)
    for block, cells in blocks:
        _require_distinct_nodes(raw, block, cells)
        _require_upright(raw, points, block, cells)
    for size in {cells.shape[1] for _, cells in blocks}:
        _require_distinct_elements(raw, [each for each in blocks if each[1].shape[1] == size])


def _require_distinct_labels(raw: RawModel) -> None:
    labels = np.concatenate([block.labels for block in raw.blocks])
    lines = np.concatenate([block.lines for block in raw.blocks])
    order = np.argsort(labels, kind="stable")
    twice = np.flatnonzero(np.diff(labels[order]) == 0)
    if twice.size:
        first, second = order[twice[0]], order[twice[0] + 1]
        where = f" (first in {raw.where(int(lines[first]))})" if lines[first] else ""
        raw.fail(f"element {raw.shown(labels[first])} is defined twice{where}.", int(lines[second]))


def _require_distinct_nodes(raw: RawModel, block: RawBlock, cells: IntArray) -> None:
    ordered = np.sort(cells, axis=1)
    bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    if bad.size:
        raw.fail(
            f"element {raw.shown(block.labels[bad[0]])} ({block.kind}) has a node more than once "
            f"({bad.size} elements do). Collapsed elements are not allowed: use tetrahedra or wedges instead.",
            int(block.lines[bad[0]]),
        )


def _require_distinct_elements(raw: RawModel, blocks: list[tuple[RawBlock, IntArray]]) -> None:
    cells = np.sort(np.concatenate([cells for _, cells in blocks]), axis=1)
    labels = np.concatenate([block.labels for block, _ in blocks])
    lines = np.concatenate([block.lines for block, _ in blocks])
    _, first, position = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[position.ravel()] != np.arange(len(cells)))
    if again.size:
        raw.fail(
            f"element {raw.shown(labels[again[0]])} has the same nodes as element "
            f"{raw.shown(labels[first[position.ravel()[again[0]]]])} "
            f"({again.size} elements are such duplicates). Remove one of the two.",
            int(lines[again[0]]),
        )


def _require_upright(raw: RawModel, points: FloatArray, block: RawBlock, cells: IntArray) -> None:
    kind = CELL_KINDS[block.kind]
    rules = [stiffness_rule(kind.n_nodes)[0], mass_rule(kind.n_nodes)[0]] if kind.is_quadratic else []
    gradients = shape_functions(kind.n_nodes, np.vstack(rules))[1] if rules else np.empty((0, kind.n_nodes, 3))
    for start in range(0, len(cells), _CELLS_AT_ONCE):
        part = points[cells[start : start + _CELLS_AT_ONCE]]
        corner = kind.corner_jacobians(part)
        largest = np.abs(corner).max(axis=1)
        # relative to the size of the element, so that flat ones are detected in any unit
        size = np.ptp(part, axis=1).max(axis=1) ** 3
        _fail_for(raw, block, start, corner.min(axis=1) <= 1e-9 * np.minimum(largest, size), corner.max(axis=1), "")
        inner = np.linalg.det(np.einsum("qka,mkb->mqab", gradients, part)) if len(gradients) else corner
        words = " between its corners, because of its midside nodes"
        _fail_for(raw, block, start, inner.min(axis=1) <= 0.0, inner.max(axis=1), words)


def _fail_for(raw: RawModel, block: RawBlock, start: int, wrong: np.ndarray, largest: FloatArray, where: str) -> None:
    bad = np.flatnonzero(wrong)
    if not bad.size:
        return
    labels = block.labels[start + bad]
    how = "inverted" if largest[bad[0]] < 0.0 else "flat or folded"
    raw.fail(
        f"element {raw.shown(labels[0])} ({block.kind}) is {how}: its Jacobian is not above 0{where}. "
        f"{bad.size} elements of the first {start + len(wrong)} of this block have this defect: "
        f"{', '.join(raw.shown(label) for label in labels[:_SHOWN])}{' ...' if bad.size > _SHOWN else ''}. "
        "Check the order of their nodes.",
        int(block.lines[start + bad[0]]),
    )
