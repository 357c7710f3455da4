"""Solutions away from a curve, and what a time integration shows where a curve is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.fourier import analysis_matrix, with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.start import amplitude_ramp, at_frequency
from stickslip.solve.path.newton import Newton
from stickslip.solve.setting_up import Balances
from stickslip.solve.transient.integrate import (
    TransientResponse,
    check_integration,
    integrate_to_steady_state,
    start_of_motion,
)
from stickslip.structure.superelement import Superelement

# chosen: periods of a time integration for evidence and of one that looks for a solution; steps of each, and for each
# harmonic.
PERIODS, SEARCH_PERIODS, STEPS, STEPS_PER_HARMONIC = 300, 100, 256, 32
# chosen: relative change at which a motion has settled, and the longest motion, in periods of the force, to look for.
SETTLED, LONGEST = 1e-3, 8
# chosen: distance of the time integration from the last point of the curve, over the range.
BESIDE = 1e-4


@dataclass(frozen=True)
class Evidence:
    """What a time integration from the last point of a curve, or from rest, shows.

    frequency_hz, periods:
        Hz, and number of periods of the force that were integrated.
    change:
        of the last period from the one before, relative.
    difference:
        distance of the last period from the motion at the last point of the curve, relative; None from rest.
    repeats_after:
        smallest number of periods after which the motion repeats; None if none up to LONGEST does.
    """

    frequency_hz: float
    periods: int
    change: float
    difference: float | None
    repeats_after: int | None

    def words(self) -> str:
        """One sentence."""
        start = "rest" if self.difference is None else "the last point"
        begin = f"A time integration from {start}, at {self.frequency_hz:.3f} Hz,"
        if self.repeats_after == 1:
            away = "" if self.difference is None else f", {100.0 * self.difference:.2g} % away from that point"
            return (
                f"{begin} settles within {self.periods} periods on a motion with the period of the force{away}: more "
                "harmonics and samples may find it."
            )
        if self.repeats_after:
            return f"{begin} ends in a motion that repeats only after {self.repeats_after} periods of the force."
        return (
            f"{begin} does not settle: after {self.periods} periods the last one differs from the one before by "
            f"{100.0 * self.change:.2g} %, and no motion of up to {LONGEST} periods repeats."
        )


class Settling:
    """Solutions at a frequency by several ways; ``newton`` solves ``curve``."""

    def __init__(
        self,
        newton: Newton[BalancePoint],
        curve: FrequencyCurve,
        balances: Balances,
        report: Callable[[str], None],
    ) -> None:
        self._newton, self._curve, self._balances, self._report = newton, curve, balances, report
        self._structure = Superelement(
            balances.superelement.mass, balances.superelement.stiffness, balances.stuck.damping
        )

    def solution(self, near: Sequence[BalancePoint], omega: float, ramp: bool) -> tuple[BalancePoint, str] | None:
        """A solution at a frequency, and how it was found.

        From points ``near``, from the linear stuck response, from a time integration that starts at the first point or
        at rest, and by an amplitude ramp if wanted.
        """
        rows = 2 * self._curve.balance.harmonics + 1
        guesses = [(with_rows(point.unknowns, rows), "from the last point") for point in near]
        for guess, how in (*guesses, (self._curve.balance.linear(omega), "from the linear stuck response")):
            point = self._solved(guess, omega)
            if point is not None:
                return point, how
        for start in (*near[:1], None):
            motion = self._integrated(start, omega, SEARCH_PERIODS)
            if motion is None:
                continue
            point = self._solved(self._unknowns(motion), omega)
            if point is not None:
                return point, "by a time integration"
        if ramp:
            point, _ = amplitude_ramp(self._newton, self._curve, omega)
            if point is not None:
                return point, "by an amplitude ramp"
        return None

    def _solved(self, guess: FloatArray, omega: float) -> BalancePoint | None:
        """The solution near a guess; None without one, or if its error is only as small as round-off allows."""
        point = at_frequency(self._newton, self._curve, guess, omega).point
        return point if point.error <= self._newton.settings.tolerance else None

    def evidence(self, point: BalancePoint, change: float) -> Evidence | None:
        """What happens close to a point of the curve; None if the joint allows no time integration."""
        return self._evidence(point, point.trial.omega + BESIDE * change)

    def evidence_from_rest(self, omega: float) -> Evidence | None:
        """What happens at a frequency from rest; None if the joint allows no time integration."""
        return self._evidence(None, omega)

    def _evidence(self, point: BalancePoint | None, omega: float) -> Evidence | None:
        motion = self._integrated(point, omega, PERIODS)
        if motion is None:
            return None
        difference = None
        if point is not None:
            rows = 2 * self._curve.balance.harmonics + 1
            found, known = self._unknowns(motion)[1:], with_rows(point.unknowns, rows)[1:]
            difference = float(np.linalg.norm(found - known) / np.linalg.norm(known))
        change = float(motion.period_change[-1])
        return Evidence(omega / (2.0 * np.pi), motion.period_change.size, change, difference, repeats_after(motion))

    def _integrated(self, start: BalancePoint | None, omega: float, periods: int) -> TransientResponse | None:
        """The motion at a frequency after some periods, from a point of a curve or from rest."""
        balances = self._balances
        try:
            check_integration(self._structure, balances.pairs)
        except InputError:
            return None
        self._report(f"time integration at {omega / (2.0 * np.pi):.3f} Hz")
        force = balances.force.coefficients(omega)
        state = {} if start is None else self._state(start.trial)
        try:
            return integrate_to_steady_state(
                self._structure,
                balances.pairs,
                force[1::2].T,
                force[2::2].T,
                omega / (2.0 * np.pi),
                steps_per_period=max(STEPS, STEPS_PER_HARMONIC * self._curve.balance.harmonics),
                max_periods=periods,
                tolerance=1e-2 * SETTLED,
                initial_displacement=state.get("initial_displacement"),
                initial_velocity=state.get("initial_velocity"),
                initial_slider=state.get("initial_slider"),
                initial_cycle=state.get("initial_cycle"),
            )
        except ConvergenceError:
            return None

    def _state(self, trial: Trial) -> dict[str, FloatArray]:
        """Time 0 of a solution."""
        balance = self._balances.with_harmonics(len(trial.relative) // 2)
        motion, walk = self._balances.motion([trial], balance.displacement([trial]))
        way = np.zeros(motion.shape[2]) if walk is None else walk[0]
        return start_of_motion(balance.pairs, motion[0].T, way, trial.omega / (2.0 * np.pi), balance.samples)

    def _unknowns(self, motion: TransientResponse) -> FloatArray:
        """(2H+1, m) the last period as unknowns of the balance; if a body walks their mean is that of many cycles."""
        pairs, steps = self._balances.pairs, len(motion.displacement)
        walk = np.diff(motion.period_starts[-2:], axis=0).sum(axis=0)
        straight = motion.displacement - walk * np.arange(steps)[:, None] / steps
        unknowns = analysis_matrix(self._curve.balance.harmonics, steps) @ straight @ pairs.operator.T
        unknowns[0] += np.where(pairs.walking(), pairs.way(walk), 0.0).ravel()
        return np.asarray(unknowns)


def repeats_after(motion: TransientResponse) -> int | None:
    """The smallest number of periods after which a motion repeats, but for a constant way; None if it does not."""
    if motion.converged:
        return 1
    starts, period = motion.period_starts, motion.displacement
    size = float(np.linalg.norm(period - period.mean(axis=0), axis=1).max())
    for number in range(1, LONGEST + 1):
        if len(starts) <= 3 * number:
            return None
        steps = np.diff(starts[-3 * number - 1 :: number], axis=0)
        if np.linalg.norm(np.diff(steps, axis=0), axis=1).max() <= SETTLED * size:
            return number
    return None
