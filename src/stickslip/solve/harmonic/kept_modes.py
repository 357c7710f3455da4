"""The balance of a large joint with its softest modes, and the static compliance of all others.

A joint of 990 pairs has 3015 modes; the exact residual multiplies twice with all of them, 72 MB each time, and once
with the compliance of the mean. Nearly all of these modes deform the surroundings of single pairs and are thousands of
times faster than the excitation. So only those up to KEPT_RANGE times its highest frequency keep their inertia,

    A_h(w) = C G_h(w) C^T + A_s,    A_s = sum over the other modes of c_j c_j^T / w_j^2,

with the contact rows c_j of the modes. The inertia that is neglected is at most ``(h w / w_j)^2`` of ``A_s``: below
1e-6 h^2 of it, and ``k A_s`` is about 0.01 there. What remains of it is measured in each point of a curve: its
displacements contain all modes, and the residual of the equation of motion shows the difference at the springs of pairs
that are closed at rest. At pairs that are open there the bound alone holds.

The response to the external force has no such error: in the space of the other modes, ``w_j^-2 f_j``, ``w_j^-4 f_j``
and the same of each unknown on which no pair depends (outputs) span a few more kept shapes (Rayleigh-Ritz), so that the
static response and the first order of the inertia are exact (residual attachment modes: Craig and Kurdila, Fundamentals
of Structural Dynamics, ch. 17).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.compliance import Compliance, StuckStructure
from stickslip.solve.harmonic.gain import DiagonalGain
from stickslip.solve.harmonic.harmonic_modes import LARGE_ROWS, SharedModes
from stickslip.solve.harmonic.large_newton import MeanDifference
from stickslip.solve.harmonic.row_products import row_products

# chosen: modes up to this multiple of the highest excitation keep their inertia (440 pairs: 139 of 1365, and 90 added
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
    rest:
        (m, m) m/N, ``A_s``; in single precision if the modes are those of a
        :class:`stickslip.solve.harmonic.soft_structure.SoftStructure`.
    same_mean:
        whether the mean has the compliance of the harmonics at rest: then it is ``A_0(0)``.
    """

    shapes: FloatArray
    contact: FloatArray
    circular_frequency: FloatArray
    damping: FloatArray
    rest: NDArray[Any]
    same_mean: bool


def kept_modes(stuck: StuckStructure, force: ExcitationForce) -> KeptModes | None:
    """The kept modes of a joint under a force; None where all modes serve as well or are required.

    These are: a joint of few rows, one with many soft modes or with many unknowns on which no pair depends, and damping
    or Coriolis forces that couple the modes.
    """
    frequency, modes, contact = stuck.circular_frequency, stuck.modes, stuck.contact_modes
    count = int(np.searchsorted(frequency, KEPT_RANGE * stuck.highest_omega, side="right"))
    if len(contact) < LARGE_ROWS or stuck.modal_damping.ndim != 1 or count > MOST_KEPT * frequency.size:
        return None
    if stuck.modal_damping[count:].any():
        return None
    far_squares, far_modes, far_contact = frequency[count:] ** 2, modes[:, count:], contact[:, count:]
    alone = np.flatnonzero(~stuck.pairs.operator.any(axis=0))
    loads = np.vstack([far_modes[alone], *(array[1:] @ far_modes for _, array in force.terms)])
    most_added = min(2 * int(loads.any(axis=1).sum()), far_squares.size)
    if count + most_added > MOST_KEPT * frequency.size:
        return None
    turn, added = _ritz(far_squares, loads)
    added_contact = far_contact @ turn
    rest = (far_contact / far_squares) @ far_contact.T - (added_contact / added**2) @ added_contact.T
    return KeptModes(
        np.hstack([modes[:, :count], far_modes @ turn]),
        np.ascontiguousarray(np.hstack([contact[:, :count], added_contact])),
        np.append(frequency[:count], added),
        np.append(stuck.modal_damping[:count], np.zeros(added.size)),
        np.ascontiguousarray(0.5 * (rest + rest.T)),
        stuck.mean_restraint == 0.0 and not stuck.pairs.undetermined().any(),
    )


def _ritz(squares: FloatArray, loads: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Orthonormal shapes (r, q) and frequencies (q,) that contain the static responses to ``loads`` (l, r) and to
    their inertia, of a structure with the stiffness ``diag(squares)`` and unit mass."""
    scale = squares[0]
    series = [loads * (scale / squares) ** power for power in (1, 2)]
    vectors = np.vstack([each[(each**2).sum(axis=1) > 0.0] for each in series])
    if not len(vectors):
        return np.zeros((squares.size, 0)), np.zeros(0)
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    basis = scipy.linalg.orth(vectors.T, rcond=SAME_SHAPE)
    values, turn = scipy.linalg.eigh((basis.T * squares) @ basis)
    return np.asarray(basis @ turn), np.sqrt(values)


class KeptCompliance(Compliance):
    """The compliance of :class:`KeptModes`; amplitudes are (2H, p)."""

    def __init__(self, stuck: StuckStructure, kept: KeptModes, harmonics: int) -> None:
        gain = DiagonalGain(kept.circular_frequency, kept.damping, harmonics, kept.circular_frequency.size)
        near = gain.near_modes
        of_mean = MeanDifference(kept.contact / kept.circular_frequency**2, kept.contact) if kept.same_mean else None
        modes = SharedModes(
            kept.shapes, kept.contact, kept.circular_frequency, near, lambda: stuck.mean_shapes, kept.rest, of_mean
        )
        super().__init__(stuck, modes, gain)
        self._kept = kept

    def relative(self, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """``B u`` (2H+1, m) of amplitudes (2H, p) and a deviation (2H+1, m)."""
        kept = self._kept
        answer = np.empty((amplitude.shape[0] + 1, len(kept.contact)))
        np.matmul(amplitude, kept.contact.T, out=answer[1:])
        if not deviation.any():
            answer[0] = 0.0
        else:
            # Not from the modes: the frequency of a soft one has the round-off of the fastest, and a body that walks
            # multiplies it (440 pairs: 1e-8 of the residual, 2e-7 of the vibration).
            answer[0] = -self.mean_relative(deviation[0])
            answer[1:] -= self._of_rest(deviation[1:])
        return answer

    def _of_rest(self, deviation: FloatArray) -> FloatArray:
        """``A_s d`` (c, m) of rows (c, m), of which few may differ from zero."""
        columns = np.flatnonzero(deviation.any(axis=0))
        if 4 * columns.size < deviation.shape[1]:
            return np.asarray(deviation[:, columns] @ self._kept.rest[columns])
        return row_products(self._kept.rest, deviation)


class KeptBalance(Balance):
    """A balance with kept modes, whose displacements contain all modes.

    Parameters
    ----------
    whole:
        the balance with all modes.
    compliance:
        that of the kept modes.
    """

    def __init__(self, whole: Balance, compliance: KeptCompliance) -> None:
        super().__init__(compliance, whole.pairs, whole.force, whole.samples)
        self._whole = whole

    def displacement(self, trials: Sequence[Trial]) -> FloatArray:
        """All unknowns (n_trials, 2H+1, n) of all modes under the forces of the trials."""
        return self._whole.displacement([self._with_all_modes(trial) for trial in trials])

    def _with_all_modes(self, trial: Trial) -> Trial:
        whole = self._whole
        external = whole.external_force(trial.omega, trial.load)
        amplitude = whole.compliance.amplitude(trial.omega, external, trial.deviation)
        return replace(trial, amplitude=amplitude)
