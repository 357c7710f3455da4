"""The Newton systems of many curves, each reduced to its moving pairs: steps, and directions of the curves.

As in :mod:`stickslip.solve.harmonic.reduced`: the unknowns are the changes ``dd`` of the deviation on the rows where it
can change, and the change of the frequency. The last row is the plane of the continuation. Curves with the same number
of rows are solved together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.batch.equations import StackedBalance, StackedTrial, Structures, norm, product
from stickslip.solve.batch.gains import Gain
from stickslip.solve.batch.kernel import fill_systems
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray


@dataclass(frozen=True)
class Planes:
    """The planes of S curves: ``weights . (x - x_a) + weight (w - w_a) = 0``.

    ``weights`` (S, m, W) 1/m, ``weight`` (S,) s/rad, ``anchor_product`` (S,) the product of ``weights`` with ``x_a``,
    ``anchor_omega`` (S,).
    """

    weights: FloatArray
    weight: FloatArray
    anchor_product: FloatArray
    anchor_omega: FloatArray

    def defect(self, relative: FloatArray, omega: FloatArray) -> FloatArray:
        """(S,) left sides at relative displacements (S, m, W) and frequencies (S,)."""
        return product(self.weights, relative) - self.anchor_product + self.weight * (omega - self.anchor_omega)

    def take(self, chosen: IndexArray) -> Planes:
        """Those of some curves."""
        return Planes(self.weights[chosen], self.weight[chosen], self.anchor_product[chosen], self.anchor_omega[chosen])

    def put(self, chosen: IndexArray, others: Planes) -> None:
        """Replace those of some curves."""
        self.weights[chosen], self.weight[chosen] = others.weights, others.weight
        self.anchor_product[chosen], self.anchor_omega[chosen] = others.anchor_product, others.anchor_omega

    @classmethod
    def fixed(cls, weight: FloatArray, omega: FloatArray, shape: tuple[int, ...]) -> Planes:
        """Planes at given frequencies (S,), oriented by a weight (S,); x has the ``shape`` (S, m, W)."""
        return cls(np.zeros(shape), weight, np.zeros(shape[0]), omega)


@dataclass(frozen=True)
class Changes:
    """Changes of S curves: relative displacements (S, m, W), modal amplitudes (S, n, H), frequency (S,) rad/s."""

    relative: FloatArray
    amplitude: ComplexArray
    omega: FloatArray


class _Rows:
    """The rows of S curves on which the deviation can change, from the rows that move (S, m).

    ``counts`` (S,) is their number, ``outputs`` (S, K) their positions among the m rows, in order; ``part`` and
    ``direction`` as in :func:`fill_systems`. ``inputs`` (S, k) are the moving pairs among all of the S curves, and
    ``pairs`` (S, k) among those of each. What a curve lacks is 0.
    """

    def __init__(self, moves: BoolArray) -> None:
        moving = moves[:, 0::3] | moves[:, 2::3]  # along t1 and t2 a pair moves, or not, together
        self.moving = moving
        self.counts = np.count_nonzero(moves, axis=1)
        self.pair_counts = np.count_nonzero(moving, axis=1)
        self.outputs = _positions(moves, self.counts)
        self.pairs = _positions(moving, self.pair_counts)
        first = np.cumsum(self.pair_counts) - self.pair_counts
        within = np.arange(self.pairs.shape[1])
        self.inputs = np.where(within < self.pair_counts[:, None], first[:, None] + within, 0)
        ranks = np.cumsum(moving, axis=1) - 1
        self.part = np.take_along_axis(ranks, self.outputs // 3, axis=1)
        self.direction = self.outputs % 3

    def groups(self) -> Iterator[tuple[IndexArray, int]]:
        """The curves that are solved together, and the number of rows of their systems."""
        for width in np.unique(self.counts):
            yield np.flatnonzero(self.counts == width), int(width)


def _positions(mask: BoolArray, counts: IndexArray) -> IndexArray:
    """(S, k) the positions of the true entries of each row of a mask, and zeros."""
    answer = np.zeros((len(mask), int(counts.max(initial=0))), dtype=np.int64)
    rows, columns = np.nonzero(mask)
    first = np.cumsum(counts) - counts
    answer[rows, np.arange(rows.size) - first[rows]] = columns
    return answer


def steps_and_directions(
    balance: StackedBalance, trial: StackedTrial, chosen: IndexArray, planes: Planes
) -> tuple[Changes, Changes]:
    """The Newton step of S ``chosen`` curves to their planes, and the direction of each curve.

    A direction has the component 1 across its plane. Numbers are not finite where a system is singular.
    """
    own, gain, omega = balance.structures.take(chosen), trial.gain.take(chosen), trial.omega[chosen]
    residual, shape = trial.residual[chosen], trial.residual[chosen].shape
    by_omega = gain.slope(trial.amplitude[chosen])
    growth = own.external_slope(omega)
    if growth is not None:
        by_omega = by_omega + gain.answer(growth)
    slope = -own.vibration(by_omega)  # dR/dw
    lines = -own.vibration(gain.transposed(own.modal(planes.weights)))  # -A^T weights
    lines[:, :, 0] = -own.mean_under(planes.weights)
    corner = planes.weight - product(planes.weights, slope)
    values = product(planes.weights, residual) - planes.defect(trial.relative[chosen], omega)
    rows = _Rows(trial.moves[chosen])
    tangents = _deviation_tangents(balance, trial, chosen, rows.moving)
    given = np.stack([residual, slope], axis=-1)
    deviations, by_frequency = np.zeros((2, *shape)), np.empty((2, len(chosen)))
    for group, width in rows.groups():
        parts = _Group(own, gain, tangents, rows, group, width)
        solution = parts.solve(given[group], lines[group], corner[group], values[group])
        by_frequency[:, group] = solution[:, -1].T
        inner = solution[:, :-1].reshape(len(group), shape[2], width, 2)
        deviations[:, group[:, None], rows.outputs[group, :width]] = inner.transpose(3, 0, 2, 1)

    def completed(which: int, left: FloatArray | float) -> Changes:
        """All changes: ``dx = -R - R_w dw - A dd``, with the residual R that is ``left``."""
        change = by_frequency[which]
        amplitude = change[:, None, None] * by_omega - gain.answer(own.modal(deviations[which]))
        return Changes(own.relative(amplitude, deviations[which]) - left, amplitude, change)

    return completed(0, residual), completed(1, 0.0)


def _deviation_tangents(
    balance: StackedBalance, trial: StackedTrial, chosen: IndexArray, moving: BoolArray
) -> FloatArray:
    """(T, 3, W, 3, W) N/m derivatives of the deviations of the ``moving`` pairs (S, P) of the chosen curves."""
    width, pairs = trial.relative.shape[2], balance.pairs
    select = (chosen[:, None] * pairs + np.arange(pairs))[moving]
    if not select.size:
        return np.empty((0, 3, width, 3, width))
    coefficients = trial.relative.reshape(-1, 3, width)
    tangents = balance.law.tangent(coefficients, balance.samples, select, trial.contact)
    diagonal = np.einsum("paqaq->paq", tangents)
    diagonal -= balance.springs.reshape(-1, 3, width)[select]
    return tangents


class _Group:
    """The systems of some curves with the same number of rows."""

    def __init__(
        self, own: Structures, gain: Gain, tangents: FloatArray, rows: _Rows, group: IndexArray, width: int
    ) -> None:
        """``width`` is the number of rows of each system."""
        pairs = rows.pairs[group, : int(rows.pair_counts[group].max())]
        self._inputs = (3 * pairs[:, :, None] + np.arange(3)).reshape(len(group), -1)
        self._outputs = rows.outputs[group, :width]
        self._tangents, self._rows, self._group = tangents, rows, group
        shapes, mean = own.shapes[group], own.mean[group]
        at_inputs, at_outputs = (
            np.take_along_axis(shapes, each[:, :, None], axis=1) for each in (self._inputs, self._outputs)
        )
        self._blocks = gain.take(group).between(at_inputs, at_outputs)
        curves = np.arange(len(group))[:, None, None]
        self._mean = mean[curves, self._inputs[:, :, None], self._outputs[:, None, :]]

    def solve(self, given: FloatArray, lines: FloatArray, corner: FloatArray, values: FloatArray) -> FloatArray:
        """(G, W K + 1, 2) step and direction, for residual and slope (G, m, W, 2), lines (G, m, W), corners and
        values (G,) of the planes. Border rows and columns are scaled to unit length."""
        (count, width), columns = self._outputs.shape, given.shape[2]
        size, group = width * columns, self._group
        matrix, right = np.zeros((count, size + 1, size + 1)), np.zeros((count, size + 1, 2))
        if width:
            at_inputs = np.take_along_axis(given, self._inputs[:, :, None, None], axis=1)
            fill_systems(
                self._tangents, self._rows.inputs[group], self._rows.part[group, :width],
                self._rows.direction[group, :width], self._mean, self._blocks, at_inputs, matrix, right,
            )  # fmt: skip
        column = right[:, :size, 1].copy()
        line = np.take_along_axis(lines, self._outputs[:, :, None], axis=1)
        line = line.transpose(0, 2, 1).reshape(count, size)
        scale = _inverse(norm(column))
        corner = corner * scale
        length = _inverse(np.hypot(norm(line), corner))
        matrix[:, :size, size], matrix[:, size, :size] = column * scale[:, None], line * length[:, None]
        matrix[:, size, size] = corner * length
        np.negative(right[:, :size, 0], out=right[:, :size, 0])
        right[:, :size, 1] = 0.0
        right[:, size, 0], right[:, size, 1] = values * length, length
        solution = solutions(matrix, right)
        solution[:, size] *= scale[:, None]
        return solution


def solutions(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solutions (G, N, k) of systems (G, N, N); not finite where one is singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    except np.linalg.LinAlgError:
        if len(matrix) == 1:
            return np.full_like(right, np.nan)
        return np.concatenate([solutions(matrix[i : i + 1], right[i : i + 1]) for i in range(len(matrix))])


def _inverse(length: FloatArray) -> FloatArray:
    """1 / length, and 1 where the length is zero."""
    return 1.0 / np.where(length > 0.0, length, 1.0)
