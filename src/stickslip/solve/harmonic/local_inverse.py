"""The Newton matrix with the compliance within groups of neighbouring pairs alone, inverted group by group.

Where contact is as stiff as the material around a pair, ``k A`` has no small eigenvalues, and no compliance of low rank
is near A. But what remains without the modes that move bodies as wholes is local: it decays with the distance of two
pairs. With a compliance that has only the blocks of groups of pairs, such as the pairs of each sector of a disk,
``I + D A`` has these blocks too.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import ActiveRows
from stickslip.solve.harmonic.factors import Factor
from stickslip.solve.harmonic.harmonic_modes import LocalCompliance

# chosen: a block with all coefficients has at most so many rows; else each harmonic has a block of its own (24 sectors,
# 800 rows each: half the time for the factors, and hardly more iterations).
LARGEST_BLOCK = 300


class LocalEquations(Protocol):
    """The Newton equations ``I + D A``, see :class:`stickslip.solve.harmonic.reduced.NewtonSystem`."""

    active: ActiveRows
    columns: int
    tangent: FloatArray


class LocalInverse:
    """The inverse of ``I + D A`` with a :class:`LocalCompliance`."""

    def __init__(self, system: LocalEquations, compliance: LocalCompliance) -> None:
        self._columns = system.columns
        self._parts = list(_blocks(system, compliance))

    def solve(self, right: FloatArray) -> FloatArray:
        """The solution (size, ...) for right-hand sides (size, ...), whose rows are coefficient by coefficient."""
        given = right.reshape(self._columns, len(right) // self._columns, *right.shape[1:])
        answer = given.copy()
        for columns, outputs, factor in self._parts:
            part = given[columns, outputs]
            answer[columns, outputs] = factor.solve(
                part.reshape(part.shape[0] * part.shape[1], *right.shape[1:])
            ).reshape(part.shape)
        return answer.reshape(right.shape)


def _blocks(system: LocalEquations, compliance: LocalCompliance) -> Iterator[tuple[slice, slice, Factor]]:
    """The blocks of the groups that move: coefficients, unknowns of each, and the factor."""
    active, width, rows = system.active, system.columns, len(compliance.far)
    tangent = system.tangent.reshape(-1, 3, width, 3, width)
    group = active.outputs // rows
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    for first, last in zip(starts, np.append(starts[1:], group.size), strict=True):
        outputs = slice(int(first), int(last))
        pairs = slice(*np.searchsorted(3 * active.pairs // rows, [group[first], group[first] + 1]))
        inputs = active.inputs[3 * pairs.start : 3 * pairs.stop] % rows
        place = np.ix_(inputs, active.outputs[outputs] % rows)
        mean, far = compliance.mean[place], compliance.far[place]
        position = active.output_position[outputs] - 3 * pairs.start
        count = last - first
        whole = width * count <= LARGEST_BLOCK
        for columns in [slice(0, width)] if whole else [slice(0, 1), *(slice(c, c + 2) for c in range(1, width, 2))]:
            yield columns, outputs, Factor(_block(tangent[pairs], mean, far, columns, position))


def _block(tangent: FloatArray, mean: FloatArray, far: FloatArray, columns: slice, position: FloatArray) -> FloatArray:
    """``I + D A`` of the coefficients ``columns`` of a group, from D (n_pairs, 3, 2H+1, 3, 2H+1)."""
    n_pairs, count, number = len(tangent), mean.shape[1], columns.stop - columns.start
    matrix = np.empty((number, count, number, count))
    for place, column in enumerate(range(columns.start, columns.stop)):
        part = tangent[:, :, columns, :, column].reshape(n_pairs, 3 * number, 3)
        product = part @ (far if column else mean).reshape(n_pairs, 3, count)
        matrix[:, :, place] = product.reshape(3 * n_pairs, number, count)[position].transpose(1, 0, 2)
    square = matrix.reshape(number * count, number * count)
    square[np.diag_indices_from(square)] += 1.0
    return square
