"""The balance of a large joint with its softest modes, and the static compliance of all others.

A joint of 990 pairs has 3015 modes. Nearly all of them deform the surroundings of single pairs and are thousands of
times faster than the excitation. So only those up to KEPT_RANGE times its highest frequency keep their inertia,

    A_h(w) = C G_h(w) C^T + A_s,    A_s = sum over the other modes of c_j c_j^T / w_j^2,

with the contact rows c_j of the modes. The inertia that is neglected is at most ``(h w / w_j)^2`` of ``A_s``: below
1e-6 h^2 of it, and ``k A_s`` is about 0.01 there. What remains of it is measured in each point of a curve: its
displacements have no such limit but the static response of the other modes in double precision, and the residual of the
equation of motion contains their inertia and the rounding of ``A_s``.

The response to the external force has no such error: in the space of the other modes, ``w_j^-2 f_j``, ``w_j^-4 f_j``
and the same of each unknown on which no pair depends (outputs) span a few more kept shapes (Rayleigh-Ritz), so that the
static response and the first order of the inertia are exact (residual attachment modes: Craig and Kurdila, Fundamentals
of Structural Dynamics, ch. 17). :mod:`stickslip.solve.harmonic.soft_structure` computes all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.compliance import Compliance, StuckStructure
from stickslip.solve.harmonic.gain import DiagonalGain
from stickslip.solve.harmonic.harmonic_modes import IndexArray, NewtonOperator, SharedModes
from stickslip.solve.harmonic.large_newton import MANY_COLUMNS, MeanDifference
from stickslip.solve.harmonic.operator_products import at_unknowns
from stickslip.solve.harmonic.row_products import row_products, sums_of_rows
from stickslip.solve.harmonic.support import StaticFactor

# chosen: modes up to this multiple of the highest excitation keep their inertia (440 pairs: 139 of 1365, and 100 added
# shapes). It must exceed damping.DAMPED_RANGE, since the other modes have no damping here.
KEPT_RANGE = 1000.0
# chosen: with more modes than this share of all, the product with them costs as much as that with all.
MOST_KEPT = 0.3
# chosen: a shape with less of its length outside of the others is the same one, by round-off.
SAME_SHAPE = 1e-10


@dataclass(frozen=True)
class KeptModes:
    """Mass-normalised shapes, their contact rows and frequencies, and the static compliance of what is left.

    Attributes
    ----------
    shapes, contact, circular_frequency, damping:
        (n, p), (m, p), (p,) rad/s and (p,).
    static:
        the factor of the stuck stiffness.
    rest:
        (m, m) m/N, ``A_s`` in single precision.
    same_mean:
        whether the mean has the compliance of the harmonics at rest: then it is ``A_0(0)``.
    """

    shapes: FloatArray
    contact: FloatArray
    circular_frequency: FloatArray
    damping: FloatArray
    static: StaticFactor
    rest: NDArray[Any]
    same_mean: bool

    @cached_property
    def flexibility(self) -> FloatArray:
        """(p,) 1/w^2 of the shapes: ``C diag(1/w^2) C^T`` is their static compliance."""
        return np.asarray(1.0 / self.circular_frequency**2)


class KeptCompliance(Compliance):
    """The compliance of :class:`KeptModes`; amplitudes are (2H, p)."""

    def __init__(self, stuck: StuckStructure, kept: KeptModes, harmonics: int) -> None:
        gain = DiagonalGain(kept.circular_frequency, kept.damping, harmonics, kept.circular_frequency.size)
        near = gain.near_modes
        of_mean = MeanDifference(kept.contact, kept.flexibility) if kept.same_mean else None
        modes = SharedModes(
            kept.shapes, kept.contact, kept.circular_frequency, near, lambda: stuck.mean_shapes, kept.rest, of_mean
        )
        super().__init__(stuck, modes, gain)
        self._kept = kept

    def relative(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """``B u`` (2H+1, m) of amplitudes (2H, p) and a deviation (2H+1, m)."""
        kept, moves = self._kept, deviation.any()
        of_shapes = np.vstack([np.zeros(amplitude.shape[1]), amplitude])
        if moves and kept.same_mean:
            of_shapes[0] = -kept.flexibility * (deviation[0] @ kept.contact)
        answer = row_products(kept.contact, of_shapes)
        if moves and kept.same_mean:
            answer -= self._of_rest(deviation)
        elif moves:
            answer[0] = -self.mean_relative(deviation[0])
            answer[1:] -= self._of_rest(deviation[1:])
        return answer

    def mean_relative(self, force: FloatArray) -> FloatArray:
        """(m,) mean relative displacements under mean forces (m,) on the pairs."""
        kept = self._kept
        if not kept.same_mean:
            return super().mean_relative(force)
        of_shapes = kept.contact @ (kept.flexibility * (force @ kept.contact))
        return np.asarray(self._of_rest(force[None])[0] + of_shapes)

    def displacement(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """All unknowns (..., 2H+1, n): the kept shapes, and the static response of all others."""
        kept, force = self._kept, deviation[..., 1:, :]
        answer = super().displacement(amplitude, deviation)
        unknowns = at_unknowns(force, self._operator)
        static = kept.static.solve(unknowns.reshape(-1, unknowns.shape[-1]).T).T
        answer[..., 1:, :] -= static.reshape(unknowns.shape)
        answer[..., 1:, :] += (kept.flexibility * (force @ kept.contact)) @ kept.shapes.T
        return answer

    def newton(self, omega: float, columns: IndexArray) -> NewtonOperator:
        """A for the Newton matrix at ``omega``, for deviations on ``columns``."""
        # of the mean, a large matrix without one of its own requires the number of rows alone
        mean = self._kept.rest if self._shared.has_mean else self._mean_contact
        return self._modes.newton(mean, columns, self.gain.near(omega))

    def _of_rest(self, deviation: FloatArray) -> FloatArray:
        """``A_s d`` (c, m) of rows (c, m), of which few may differ from zero."""
        columns = np.flatnonzero(deviation.any(axis=0))
        if columns.size < MANY_COLUMNS * deviation.shape[1]:
            return sums_of_rows(self._kept.rest, deviation[:, columns], columns)  # it is symmetric
        return row_products(self._kept.rest, deviation)
