"""The periodic motion of a joint that wears: at a fixed frequency, or at the highest peak of an output."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.energy import work_per_cycle
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.problem import Plane
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage
from stickslip.solve.setting_up import StageReport
from stickslip.solve.wear.worn_joint import WornJoint

# chosen: another peak of the whole curve that is higher by this fraction takes over. The search of a peak has an error
# of 0.01 %, points of a curve beside a corner less than 0.1 %.
HIGHER = 1e-3


@dataclass(frozen=True)
class WornState:
    """The joint with some depths of wear, and its periodic motion."""

    stage: RidgeStage
    pairs: ContactPairs
    point: BalancePoint
    amplitude: float
    omega: float
    energy: FloatArray  # (n_pairs,) J per cycle
    peak: CurvePeak | None = None

    @classmethod
    def at_point(cls, stage: RidgeStage, pairs: ContactPairs, point: BalancePoint) -> WornState:
        """The motion of a point of the frequency curve."""
        amplitude = float(stage.amplitude([point])[0])
        return cls(stage, pairs, point, amplitude, float(point.parameters[0]), _friction_energy(point))

    @classmethod
    def at_peak(cls, stage: RidgeStage, pairs: ContactPairs, peak: CurvePeak) -> WornState:
        """The motion at a peak."""
        point = peak.probe.point
        return cls(stage, pairs, point, peak.amplitude, peak.omega, _friction_energy(point), peak)

    @property
    def frequency_hz(self) -> float:
        """Frequency of the motion in Hz."""
        return self.omega / (2.0 * math.pi)


def _friction_energy(point: BalancePoint) -> FloatArray:
    """(n_pairs,) J per cycle; the work of a stuck pair is zero but for rounding."""
    work = work_per_cycle(point.trial).reshape(-1, 3)[:, :2].sum(axis=1)
    slips = point.trial.contact.state != ContactState.STUCK
    return np.where(slips, np.maximum(work, 0.0), 0.0)


class WornVibration:
    """Motions of a joint with any depths of wear, each from the ``last`` state that was accepted."""

    def __init__(
        self,
        joint: WornJoint,
        excitation: Excitation,
        output: FloatArray,
        options: RidgeOptions,
        frequency_hz: float | None,
        modal_damping_ratio: float | None,
        report: StageReport,
    ) -> None:
        self._joint = joint
        self._excitation = excitation
        self._output = output
        self._options = options
        self._omega = None if frequency_hz is None else 2.0 * math.pi * frequency_hz
        self._ratio = modal_damping_ratio
        self._report = report
        self.last: WornState | None = None
        self.motions = self.curves = self.unrefined = 0

    def state_after(self, depth: FloatArray) -> WornState:
        """The joint and its motion with worn depths (n_pairs,) m. Raises ConvergenceError."""
        self.motions += 1
        pairs = self._joint.pairs_after(depth)
        problem = self._joint.superelement, pairs, self._excitation
        earlier = None if self.last is None else self.last.stage
        stage = RidgeStage.of(problem, self._output, self._options, self._ratio, self._report, earlier)
        return self._near_last_peak(stage, pairs) if self._omega is None else self._at_frequency(stage, pairs)

    def _at_frequency(self, stage: RidgeStage, pairs: ContactPairs) -> WornState:
        """The motion at the frequency of operation, from the last one."""
        assert self._omega is not None
        if self.last is not None:
            guess = self.last.point.unknowns
            correction = stage.solver.correct(stage.curve.at(guess, self._omega), Plane.fixed(guess, self._omega))
            if correction.converged:
                return WornState.at_point(stage, pairs, correction.point)
        point, _ = first_point(stage.solver, stage.curve, self._omega, stage.balances.with_harmonics)
        return WornState.at_point(stage, pairs, point)

    def _near_last_peak(self, stage: RidgeStage, pairs: ContactPairs) -> WornState:
        """The motion at the peak close to the last one, or else at the highest of the whole curve."""
        if self.last is not None and self.last.peak is not None:
            last = self.last.peak
            peak = stage.search.from_estimate(self.last.point.unknowns, last.omega, last.probe.tangent, last.curvature)
            if not isinstance(peak, str):
                return WornState.at_peak(stage, pairs, peak)
        return self._highest(stage, pairs)

    def _highest(self, stage: RidgeStage, pairs: ContactPairs) -> WornState:
        """The motion at the highest peak of the whole curve, or at its highest point where no peak is found next to
        it. Raises ConvergenceError."""
        self.curves += 1
        branch = stage.whole_curve()
        if not branch.complete:
            raise ConvergenceError(f"the frequency curve of the worn joint is not complete. {branch.message}")
        points = [each.point for each in branch.points]
        amplitude = stage.amplitude(points)
        top = int(amplitude.argmax())
        if top in (0, len(points) - 1):
            raise ConvergenceError(
                "the largest amplitude of the worn joint is at an end of the frequency range. Widen the range."
            )
        for place in (top, top - 1, top + 1):
            peak = stage.search.from_point(points[place])
            if not isinstance(peak, str) and peak.amplitude >= (1.0 - HIGHER) * amplitude[top]:
                return WornState.at_peak(stage, pairs, peak)
        self.unrefined += 1
        return WornState.at_point(stage, pairs, points[top])

    def accept(self, state: WornState) -> WornState:
        """The state from which the wear continues: the given one, or that at a higher peak of the whole curve.

        Raises ConvergenceError.
        """
        if self._omega is None and self.last is not None:
            highest = self._highest(state.stage, state.pairs)
            if highest.amplitude > (1.0 + HIGHER) * state.amplitude:
                state = highest
        self.last = state
        return state
