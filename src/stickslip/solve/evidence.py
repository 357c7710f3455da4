"""Solutions away from a curve, and what a time integration shows where a curve is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.fourier import with_rows
from stickslip.core.resolution import SAMPLES_PER_HARMONIC
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.start import amplitude_ramp, at_frequency
from stickslip.solve.path.newton import Newton
from stickslip.solve.setting_up import CurveBalances
from stickslip.solve.transient.integrate import (
    TransientResponse,
    check_integration,
    start_of_motion,
)

# chosen: periods of a time integration for evidence and of one that looks for a solution; steps of each, and for each
# harmonic.
PERIODS, SEARCH_PERIODS, STEPS, STEPS_PER_HARMONIC = 300, 100, 256, 32
# chosen: relative change at which a motion has settled, and the longest motion, in periods of the force, to look for.
SETTLED, LONGEST = 1e-3, 8
# Number of periods whose starts are compared: three of the longest motion.
HORIZON = 3 * LONGEST
# chosen: distance of the time integration from the last point of the curve, over the range.
BESIDE = 1e-4
# chosen: a settled motion is also looked for with so many times the harmonics, if the equations have no more rows than
# this; a solution farther from it than this fraction is another motion.
MORE_HARMONICS, MOST_ROWS, SAME = (1, 2, 4, 8), 12_000, 0.05
# Iterations of Newton's method that take as long as a period of a time integration: 1.3 in dampers of the torture set,
# 12 in a small stiff problem.
PERIOD_WORK = 2.0


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
    tried, given_by:
        largest number of harmonics with which a settled motion was looked for, None without a search; the number that
        gives it, None if none does.
    motion:
        the settled motion with this number of harmonics.
    """

    frequency_hz: float
    periods: int
    change: float
    difference: float | None
    repeats_after: int | None
    tried: int | None = None
    given_by: int | None = None
    motion: BalancePoint | None = field(default=None, repr=False, compare=False)

    def words(self, varies: bool = False) -> str:
        """One or two sentences; ``varies`` if the curve already chooses its harmonics by an accuracy."""
        start = "rest" if self.difference is None else "the last point"
        begin = f"A time integration from {start}, at {self.frequency_hz:.3f} Hz,"
        if self.repeats_after == 1:
            away = "" if self.difference is None else f", {100.0 * self.difference:.2g} % away from that point"
            settles = f"{begin} settles within {self.periods} periods on a motion with the period of the force{away}"
            if self.tried is None:
                return f"{settles}: more harmonics and samples may find it."
            if self.given_by is None:
                return f"{settles}. No number of harmonics up to {self.tried} gives it: more do not help here."
            if varies:
                return f"{settles}. {self.given_by} harmonics give it."
            return (
                f"{settles}. {self.given_by} harmonics give it: run again with harmonics = {self.given_by}, or with an "
                "accuracy."
            )
        if self.repeats_after:
            return f"{begin} ends in a motion that repeats only after {self.repeats_after} periods of the force."
        return (
            f"{begin} has not settled: after {self.periods} periods the last one differs from the one before by "
            f"{100.0 * self.change:.2g} %, and no motion of up to {LONGEST} periods repeats."
        )


class Settling:
    """Solutions at a frequency by several ways, until the limit of the ``work`` on the curve; ``newton`` solves it."""

    def __init__(
        self,
        newton: Newton[BalancePoint],
        curve: FrequencyCurve,
        balances: CurveBalances,
        report: Callable[[str], None],
    ) -> None:
        self._newton, self._curve, self._balances, self._report = newton, curve, balances, report
        self._harmonics = curve.balance.harmonics
        self._in_time = balances.in_time()
        self.work = curve.work

    def solution(self, near: Sequence[BalancePoint], omega: float, ramp: bool) -> tuple[BalancePoint, str] | None:
        """A solution at a frequency, and how it was found.

        From points ``near``, from the linear stuck response, from a time integration that starts at the first point or
        at rest, and by an amplitude ramp if wanted. None also at the limit of the work.
        """
        rows = 2 * self._harmonics + 1
        guesses = [(with_rows(point.unknowns, rows), "from the last point") for point in near]
        for guess, how in (*guesses, (self._curve.balance.linear(omega), "from the linear stuck response")):
            point = self._solved(guess, omega)
            if point is not None:
                return point, how
        for start in (*near[:1], None):
            if self.work.limit_words:
                return None
            motion = self._integrated(start, omega, SEARCH_PERIODS)
            if motion is None or self._in_time is None:
                continue
            point = self._solved(self._in_time.unknowns(motion, self._harmonics), omega)
            if point is not None:
                return point, "by a time integration"
        if ramp and not self.work.limit_words:
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
        if motion is None or self._in_time is None:
            return None
        difference = None
        if point is not None:
            found = self._in_time.unknowns(motion, self._harmonics)[1:]
            known = with_rows(point.unknowns, 2 * self._harmonics + 1)[1:]
            difference = float(np.linalg.norm(found - known) / np.linalg.norm(known))
        change = float(motion.period_change[-1])
        repeats = 1 if motion.converged else self._repeats_after(motion)
        tried, given = self._with_harmonics(motion, omega) if repeats == 1 else (None, None)
        given_by = None if given is None else len(given.measured) // 2
        periods = motion.period_change.size
        return Evidence(omega / (2.0 * np.pi), periods, change, difference, repeats, tried, given_by, given)

    def _with_harmonics(self, motion: TransientResponse, omega: float) -> tuple[int | None, BalancePoint | None]:
        """Most harmonics with which a settled motion was looked for, and the solution with the fewest that give it."""
        balances, tried = self._balances, None
        assert self._in_time is not None  # it gave the motion
        for multiple in MORE_HARMONICS:
            harmonics = multiple * self._harmonics
            rows = 3 * balances.pairs.n_pairs * (2 * harmonics + 1)
            if SAMPLES_PER_HARMONIC * harmonics > balances.samples or rows > MOST_ROWS:
                break
            tried, guess = harmonics, self._in_time.unknowns(motion, harmonics)
            curve = FrequencyCurve(balances.with_harmonics(harmonics))
            newton = Newton(curve, self._newton.settings, self._newton.on_iteration)
            point = at_frequency(newton, curve, guess, omega).point
            away = float(np.linalg.norm(point.unknowns[1:] - guess[1:]))
            if point.error <= newton.settings.tolerance and away <= SAME * float(np.linalg.norm(guess[1:])):
                return tried, point
        return tried, None

    def _repeats_after(self, motion: TransientResponse) -> int | None:
        """See :func:`repeats_after`; the position of a body that may walk does not count."""
        assert self._in_time is not None  # it gave the motion
        starts, period = (self._in_time.without_walk(each) for each in (motion.period_starts, motion.displacement))
        return repeats_after(starts, float(np.linalg.norm(period - period.mean(axis=0), axis=1).max()))

    def _integrated(self, start: BalancePoint | None, omega: float, periods: int) -> TransientResponse | None:
        """The motion at a frequency after some periods, from a point of a curve or from rest."""
        if self._in_time is None:
            return None
        try:
            check_integration(self._in_time.structure, self._balances.pairs)
        except InputError:
            return None
        self._report(f"time integration at {omega / (2.0 * np.pi):.3f} Hz")
        state = {} if start is None else self._state(start.trial)
        steps = max(STEPS, STEPS_PER_HARMONIC * self._harmonics)
        motion = self._in_time.after(state, omega, steps, periods, 1e-2 * SETTLED)
        self.work.integrate(PERIOD_WORK * (periods if motion is None else motion.period_change.size))
        return motion

    def _state(self, trial: Trial) -> dict[str, FloatArray]:
        """Time 0 of a solution."""
        balance = self._balances.with_harmonics(len(trial.relative) // 2)
        motion, walk = self._balances.motion([trial], balance.displacement([trial]))
        way = np.zeros(motion.shape[2]) if walk is None else walk[0]
        return start_of_motion(balance.pairs, motion[0].T, way, trial.omega / (2.0 * np.pi), balance.samples)


def repeats_after(starts: FloatArray, size: float) -> int | None:
    """The smallest number of periods after which a motion of a ``size`` repeats; None if none up to LONGEST does.

    ``starts`` (n_periods, n) are displacements at the starts of periods. Over HORIZON of them they must agree to
    SETTLED of the size: in a slow decay or beat two that follow each other do too.
    """
    last = starts[::-1][: HORIZON + 1]
    for number in range(1, LONGEST + 1):
        same = last[::number]
        if len(same) <= HORIZON // LONGEST:
            return None
        if np.linalg.norm(same - same[0], axis=1).max() <= SETTLED * size:
            return number
    return None
