"""Nested dissection of a mesh: an order of elimination that leaves small separators, from the positions of its nodes.

A set of nodes is divided at the median of a coordinate; the nodes of one part that are neighbours of the other part are
the separator, which is eliminated after both (A. George, Nested dissection of a regular finite element mesh, SIAM J.
Numer. Anal. 10 (1973) 345-363). The axis is that with the smallest separator.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray

# chosen: a set of so few nodes is not divided; its matrix is dense.
LARGEST_LEAF = 50


def nested_dissection(neighbours: Any, position: FloatArray) -> list[IntArray]:
    """Sets of nodes in their order of elimination; together they are all nodes, each once.

    Parameters
    ----------
    neighbours:
        csr (k, k), symmetric; entry (i, j) is not zero where nodes i and j share an equation.
    position:
        (k, 3) m.
    """
    fronts: list[IntArray] = []
    _divide(neighbours, position, np.arange(len(position)), fronts)
    return fronts


def _divide(neighbours: Any, position: FloatArray, nodes: IntArray, fronts: list[IntArray]) -> None:
    """Append the sets of ``nodes``, those of both parts before the separator; ``neighbours`` are those of ``nodes``."""
    best: tuple[IntArray, IntArray, IntArray] | None = None
    if len(nodes) > LARGEST_LEAF:
        for axis in range(3):
            parts = _parts(neighbours, position[nodes, axis])
            if parts is not None and (best is None or len(parts[2]) < len(best[2])):
                best = parts
    if best is None:
        fronts.append(nodes)
        return
    for part in best[:2]:
        _divide(neighbours[part][:, part], position, nodes[part], fronts)
    if len(best[2]):
        fronts.append(nodes[best[2]])


def _parts(neighbours: Any, coordinate: FloatArray) -> tuple[IntArray, IntArray, IntArray] | None:
    """Both parts without the separator, and the separator; None where all nodes would be in one part."""
    left = coordinate < np.median(coordinate)
    if not left.any():
        left = coordinate <= coordinate.min()
    beside_left = ~left & (neighbours @ left.astype(np.int32) > 0)
    beside_right = left & (neighbours @ (~left).astype(np.int32) > 0)
    separator = beside_left if beside_left.sum() <= beside_right.sum() else beside_right
    parts = np.flatnonzero(left & ~separator), np.flatnonzero(~left & ~separator), np.flatnonzero(separator)
    return parts if len(parts[0]) and len(parts[1]) else None
