"""The balance of one frequency: R(x) = x - r(w) + A(w) d(x), and its Newton system reduced to the moving pairs.

``x`` holds the Fourier coefficients of the relative displacements of all pairs, ``r`` those of the linear structure
with every contact stuck, ``d`` the deviation of the contact force from ``preload + k x``. A pair that sticks through
the whole period has ``d = 0``, and its normal row has ``d = 0`` until it opens; a pair that is open at rest
has no ``k``, and ``d = 0`` until it closes. So with ``D = dd/dx``

    (I + A D) dx = -R   <=>   (I + D A) dd = -D R,   dx = -R - A dd

needs only the rows of ``dd`` that are not zero: two tangential rows for each pair that moves, and the normal row where
the pair separates or was open at rest. Everything else follows by back substitution; nothing is approximated.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import LawPeriod
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.compliance import Compliance, ExternalForce
from stickslip.solve.harmonic.gain import SelfExcitation


@dataclass(frozen=True)
class Trial:
    """A trial solution with its forces and residual; coefficients (2H+1, m) with m = 3 * n_pairs rows t1, t2, n."""

    omega: float
    load: float
    relative: FloatArray
    deviation: FloatArray
    contact: LawPeriod
    amplitude: FloatArray  # (2H, n) modal amplitudes of the structure under the force and the deviation
    residual: FloatArray
    error: float  # norm of the residual relative to that of the relative displacement, see Balance.evaluate
    growth: float = 0.0  # 1/s, coefficient xi of the damping -xi M that sustains a nonlinear mode


def relative_norm(part: FloatArray, whole: FloatArray) -> float:
    """Norm of a part over that of the whole; the norm itself if the whole is zero."""
    size, scale = float(np.linalg.norm(part)), float(np.linalg.norm(whole))
    return size / scale if scale > 0.0 else size


@dataclass(frozen=True)
class ActiveRows:
    """Rows of the contact coefficients in the reduced Newton system."""

    pairs: NDArray[np.int64]  # pairs that move
    inputs: NDArray[np.int64]  # their 3 rows each, on which the force depends
    outputs: NDArray[np.int64]  # rows where the deviation is not zero
    output_position: NDArray[np.int64]  # position of each output among 3 * len(pairs) rows

    @classmethod
    def of(cls, contact: LawPeriod) -> ActiveRows:
        """The rows of the pairs whose force deviates from their springs, or can."""
        moving = np.flatnonzero(contact.moves.any(axis=1))
        inputs = (3 * moving[:, None] + np.arange(3)).ravel()
        position = np.flatnonzero(contact.moves[moving].ravel())
        return cls(moving, inputs, inputs[position], position)


class Balance:
    """One structure, one joint, one excitation: residuals and Newton systems at any frequency.

    Parameters
    ----------
    compliance:
        compliance of the stuck structure (m rows, n unknowns).
    pairs:
        contact pairs.
    force:
        the external force.
    samples:
        time samples per period for the contact laws.
    """

    def __init__(
        self,
        compliance: Compliance,
        pairs: ContactPairs,
        force: ExcitationForce,
        samples: int,
    ) -> None:
        self.compliance = compliance
        self.pairs = pairs
        self.force = force
        self.samples = samples
        self.harmonics = compliance.harmonics
        # Springs of the pairs at rest, (2H+1, m). Means that no force depends on have no spring: a released pair that
        # sticks has its slider at the mean.
        springs = pairs.resting_stiffness().reshape(-1, 3)
        undetermined = pairs.undetermined()
        self._free = np.flatnonzero(undetermined)  # rows whose mean no force depends on
        self._walking = np.flatnonzero(pairs.frictional())  # rows whose mean may be the way of many cycles
        self.springs = np.repeat(springs.reshape(1, -1), 2 * self.harmonics + 1, axis=0)
        self.springs[0] = (springs * ~undetermined).ravel()
        self._terms = [(power, compliance.external(array)) for power, array in force.terms]

    def excited(self, by: SelfExcitation) -> Balance:
        """The balance under a self-excitation."""
        changed = copy(self)
        changed.compliance = self.compliance.excited(by)
        return changed

    @property
    def rows(self) -> int:
        """Number m of rows of relative displacement."""
        return 3 * self.pairs.n_pairs

    def external_force(self, omega: float, load: float) -> ExternalForce:
        """``load`` times the external force at ``omega``."""
        (power, first), *others = self._terms
        external = first.times(load * omega**power)
        for power, term in others:
            external = external.plus(term.times(load * omega**power))
        return external

    def modal_force(self, trial: Trial) -> FloatArray:
        """(2H, n) the external force of a trial in the modes of the stuck structure."""
        return self.external_force(trial.omega, trial.load).modal

    def applied(self, trials: Sequence[Trial]) -> FloatArray:
        """(n_trials, 2H+1, n) N, the external force at each trial."""
        omega, load = (np.array([getattr(trial, name) for trial in trials]) for name in ("omega", "load"))
        parts = [(load * omega**power)[:, None, None] * array for power, array in self.force.terms]
        return np.asarray(sum(parts))

    def linear(self, omega: float, load: float = 1.0) -> FloatArray:
        """Relative displacement (2H+1, m) with every contact stuck, under ``load`` times the force."""
        still, external = np.zeros((2 * self.harmonics + 1, self.rows)), self.external_force(omega, load)
        return self.compliance.relative(self.compliance.amplitude(omega, external, still), still)

    def evaluate(self, relative: FloatArray, omega: float, load: float = 1.0) -> Trial:
        """Contact force, deviation and residual; means that no force depends on follow (:meth:`determined`)."""
        coefficients = np.ascontiguousarray(relative.T).reshape(self.pairs.n_pairs, 3, -1)
        contact = self.pairs.period(coefficients, self.samples)
        deviation = contact.force.reshape(self.rows, -1).T - self.springs * relative
        # Where a force is that of the springs the deviation is zero by definition, without round-off.
        np.copyto(deviation, 0.0, where=~contact.moves.ravel())
        external = self.external_force(omega, load)
        amplitude = self.compliance.amplitude(omega, external, deviation)
        answer = self.compliance.relative(amplitude, deviation)
        residual = relative - answer
        residual[0, self._free] = 0.0
        if self._free.size:
            relative = relative.copy()
            relative[0, self._free] = answer[0, self._free]
        # Means of bodies that walk, or fly off, are so large that the vibration has few digits: an error too.
        few_digits = float(np.finfo(float).eps) * relative_norm(relative[:1], relative[1:])
        wrong = relative_norm(residual, self.determined(relative))
        error = max(wrong, few_digits, self._closing_error(residual, contact))
        growth = self.compliance.gain.growth
        return Trial(omega, load, relative, deviation, contact, amplitude, residual, error, growth)

    def _closing_error(self, residual: FloatArray, contact: LawPeriod) -> float:
        """Residual times the springs that are not in the compliance, over the contact force.

        These are, for example, the springs of pairs with a gap that close: a residual that is small compared with the
        motion of an open pair can be a large force where it closes.
        """
        springs = self.pairs.hidden_springs(contact)
        if not springs.any():
            return 0.0
        hidden = np.flatnonzero(springs.any(axis=1))
        force = springs[hidden, :, None] * residual.T.reshape(self.pairs.n_pairs, 3, -1)[hidden]
        return relative_norm(force, contact.force)

    def determined(self, relative: FloatArray) -> FloatArray:
        """A copy (2H+1, m) without the mean tangential displacements of pairs with friction.

        The slider of a released pair starts at the mean of its motion, so its mean only follows from the forces. Where
        friction alone supports a body that walks, it is the way of many cycles. No norm and no constraint may contain
        it.
        """
        part = relative.copy()
        part[0, self._walking] = 0.0
        return part

    def displacement(self, trials: Sequence[Trial]) -> FloatArray:
        """All unknowns (n_trials, 2H+1, n)."""
        amplitude = np.array([trial.amplitude for trial in trials])
        deviation = np.array([trial.deviation for trial in trials])
        return self.compliance.displacement(amplitude, deviation)

    def amplitude_slope(self, trial: Trial) -> FloatArray:
        """Derivative (2H, n) of the modal amplitudes by ``omega`` at fixed deviation and load."""
        slope = self.compliance.gain.slope(trial.omega, trial.amplitude)
        if not self.force.is_constant:
            still = np.zeros((2 * self.harmonics + 1, self.rows))
            for power, term in self._terms:
                if power:
                    growth = term.times(trial.load * power * trial.omega ** (power - 1))
                    slope = slope + self.compliance.amplitude(trial.omega, growth, still)
        return slope

    def growth_amplitude(self, trial: Trial) -> FloatArray:
        """Derivative (2H, n) of the modal amplitudes by xi at fixed deviation and load."""
        return self.compliance.gain.growth_slope(trial.omega, trial.amplitude)

    def residual_slope(self, amplitude_slope: FloatArray) -> FloatArray:
        """Derivative (2H+1, m) of R at fixed x by a parameter, from that of the modal amplitudes (2H, n)."""
        still = np.zeros((2 * self.harmonics + 1, self.rows))
        return -self.compliance.relative(amplitude_slope, still)

    def frequency_slope(self, trial: Trial) -> FloatArray:
        """dR/dw (2H+1, m) at fixed x."""
        return self.residual_slope(self.amplitude_slope(trial))

    def load_amplitude(self, omega: float) -> FloatArray:
        """Derivative (2H, n) of the modal amplitudes by the load at fixed deviation."""
        return self.compliance.amplitude(
            omega, self.external_force(omega, 1.0), np.zeros((2 * self.harmonics + 1, self.rows))
        )

    def load_slope(self, trial: Trial) -> FloatArray:
        """dR/dload (2H+1, m) at fixed x: minus the linear response to the force."""
        return -self.linear(trial.omega)

    def deviation_tangent(self, active: ActiveRows, trial: Trial) -> FloatArray:
        """D (n_moving, 3, 2H+1, 3, 2H+1): derivative of the deviation of the moving pairs."""
        coefficients = np.ascontiguousarray(trial.relative.T).reshape(self.pairs.n_pairs, 3, -1)
        tangent = self.pairs.tangent(coefficients, self.samples, active.pairs, trial.contact)
        springs = self.springs.T.reshape(self.pairs.n_pairs, 3, -1)[active.pairs]
        width = 2 * self.harmonics + 1
        diagonal = np.einsum("paqaq->paq", tangent.reshape(-1, 3, width, 3, width))
        diagonal -= springs
        return tangent
