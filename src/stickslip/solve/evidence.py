"""Solutions away from a curve, and what a time integration shows where a curve is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.start import amplitude_ramp, at_frequency
from stickslip.solve.motion_in_time import MotionInTime
from stickslip.solve.path.newton import Newton
from stickslip.solve.setting_up import CurveBalances
from stickslip.solve.settled_motion import NOT_SOUGHT, SAME, SettledMotion, enough_samples, settled_motion
from stickslip.solve.transient.integrate import (
    TransientResponse,
    check_integration,
    coulomb_alone,
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
# chosen: where a curve ends, a motion that settles is integrated again with so many times the steps: the contact of
# rattling bodies is shorter than a usual step.
FINER = 4
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
    steps_change:
        distance of the settled motion from that with 1 / FINER of the steps, relative; None without the comparison.
    harmonics:
        those of the curve.
    settled:
        whether the harmonic balance gives the motion, if it settled.
    """

    frequency_hz: float
    periods: int
    change: float
    difference: float | None
    repeats_after: int | None
    steps_change: float | None = None
    harmonics: int = 0
    settled: SettledMotion = NOT_SOUGHT

    @property
    def motion(self) -> BalancePoint | None:
        """The settled motion as a solution of the harmonic balance, if any number of harmonics gives it with samples
        that the curve can take."""
        return self.settled.motion

    def words(self, varies: bool = False) -> str:
        """One or two sentences; ``varies`` if the curve already chooses its harmonics by an accuracy."""
        start = "rest" if self.difference is None else "the last point"
        begin = f"A time integration from {start}, at {self.frequency_hz:.3f} Hz,"
        if self.repeats_after == 1:
            return self._settled_words(begin, varies)
        if self.repeats_after:
            return f"{begin} ends in a motion that repeats only after {self.repeats_after} periods of the force."
        return (
            f"{begin} has not settled: after {self.periods} periods the last one differs from the one before by "
            f"{100.0 * self.change:.2g} %, and no motion of up to {LONGEST} periods repeats."
        )

    def _settled_words(self, begin: str, varies: bool) -> str:
        """Where and how the motion settles, and whether more harmonics help."""
        found = self.settled
        away = "" if self.difference is None else f", {100.0 * self.difference:.2g} % away from that point"
        words = f"{begin} settles within {self.periods} periods on a motion with the period of the force{away}"
        if self.steps_change is not None:
            words += f" (with 1/{FINER} of the time steps: {100.0 * self.steps_change:.2g} % away from it)"
        if found.tried is None:
            return f"{words}: more harmonics and samples may find it."
        if found.neglected is not None:
            words += f". {100.0 * found.neglected:.2g} % of its vibration is in harmonics above {self.harmonics}"
        if found.given_by is None:
            return f"{words}. No number of harmonics up to {found.tried} gives it to {100.0 * SAME:.0f} %."
        if found.given_by == self.harmonics:
            return f"{words}. The harmonics of the curve reproduce it to {100.0 * found.away:.2g} %; more do not help."
        words += f". {found.given_by} harmonics with {found.samples} samples give it to {100.0 * found.away:.2g} %"
        if varies:
            return f"{words}."
        return (
            f"{words}: run again with harmonics = {found.given_by} and samples = {found.samples}, or with an accuracy."
        )


class Settling:
    """Solutions at a frequency by several ways, until the limit of the ``work`` on the curve; ``newton`` solves it.

    With ``any_samples`` the curve can take motions with other samples than its own.
    """

    def __init__(
        self,
        newton: Newton[BalancePoint],
        curve: FrequencyCurve,
        balances: CurveBalances,
        report: Callable[[str], None],
        any_samples: bool = False,
    ) -> None:
        self._newton, self._curve, self._balances, self._report = newton, curve, balances, report
        self._harmonics = curve.balance.harmonics
        self._any_samples = any_samples
        self.work = curve.work

    @cached_property
    def _in_time(self) -> MotionInTime | None:
        """The motion in time, whose matrices few curves require."""
        return self._balances.in_time()

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

    def evidence(self, point: BalancePoint, change: float, thorough: bool = False) -> Evidence | None:
        """What happens close to a point of the curve; None if the joint allows no time integration.

        ``thorough`` is for the end of a curve: with shorter time steps too, if all pairs follow Coulomb's law, and a
        longer search with more harmonics.
        """
        return self._evidence(point, point.trial.omega + BESIDE * change, thorough)

    def evidence_from_rest(self, omega: float, thorough: bool = False) -> Evidence | None:
        """What happens at a frequency from rest; None if the joint allows no time integration."""
        return self._evidence(None, omega, thorough)

    def _evidence(self, point: BalancePoint | None, omega: float, thorough: bool) -> Evidence | None:
        motion = self._integrated(point, omega, PERIODS)
        if motion is None or self._in_time is None:
            return None
        repeats, steps_change = self._repeats(motion), None
        if thorough and repeats == 1 and coulomb_alone(self._balances.pairs):  # other laws march much slower
            finer = self._integrated(point, omega, PERIODS, FINER)
            if finer is not None:
                steps_change = self._distance(finer, motion)
                motion, repeats = finer, self._repeats(finer)
        difference = None
        if point is not None:
            found = self._in_time.unknowns(motion, self._harmonics)[1:]
            known = with_rows(point.unknowns, 2 * self._harmonics + 1)[1:]
            difference = float(np.linalg.norm(found - known) / np.linalg.norm(known))
        settled = self._with_harmonics(motion, omega, thorough) if repeats == 1 else NOT_SOUGHT
        return Evidence(
            omega / (2.0 * np.pi),
            motion.period_change.size,
            float(motion.period_change[-1]),
            difference,
            repeats,
            steps_change,
            self._harmonics,
            settled,
        )

    def _repeats(self, motion: TransientResponse) -> int | None:
        """The number of periods after which a motion repeats, None if none up to LONGEST does."""
        return 1 if motion.converged else self._repeats_after(motion)

    def _distance(self, motion: TransientResponse, other: TransientResponse) -> float:
        """Between two motions, over the first one, in the harmonics that the steps of both resolve."""
        assert self._in_time is not None  # it gave the motions
        most = min(_most_harmonics(each) for each in (motion, other))
        first, second = (self._in_time.unknowns(each, most)[1:] for each in (motion, other))
        return float(np.linalg.norm(second - first) / max(float(np.linalg.norm(first)), 1e-300))

    def _with_harmonics(self, motion: TransientResponse, omega: float, thorough: bool) -> SettledMotion:
        """Whether the harmonic balance gives a settled motion."""
        in_time = self._in_time
        assert in_time is not None  # it gave the motion
        return settled_motion(
            self._newton,
            self._balances,
            self._harmonics,
            omega,
            lambda harmonics: in_time.unknowns(motion, harmonics),
            _most_harmonics(motion),
            thorough,
            self._any_samples,
        )

    def _repeats_after(self, motion: TransientResponse) -> int | None:
        """See :func:`repeats_after`; the position of a body that may walk does not count."""
        assert self._in_time is not None  # it gave the motion
        starts, period = (self._in_time.without_walk(each) for each in (motion.period_starts, motion.displacement))
        return repeats_after(starts, float(np.linalg.norm(period - period.mean(axis=0), axis=1).max()))

    def _integrated(
        self, start: BalancePoint | None, omega: float, periods: int, finer: int = 1
    ) -> TransientResponse | None:
        """The motion at a frequency after some periods, from a point of a curve or from rest, with ``finer`` times the
        steps."""
        if self._in_time is None:
            return None
        try:
            check_integration(self._in_time.structure, self._balances.pairs)
        except InputError:
            return None
        self._report(f"time integration at {omega / (2.0 * np.pi):.3f} Hz")
        state = {} if start is None else self._state(start.trial)
        steps = finer * max(STEPS, STEPS_PER_HARMONIC * self._harmonics)
        motion = self._in_time.after(state, omega, steps, periods, 1e-2 * SETTLED)
        self.work.integrate(finer * PERIOD_WORK * (periods if motion is None else motion.period_change.size))
        return motion

    def _state(self, trial: Trial) -> dict[str, FloatArray]:
        """Time 0 of a solution."""
        harmonics, samples = len(trial.relative) // 2, self._balances.samples
        if self._any_samples and harmonics > self._harmonics:
            samples = enough_samples(harmonics, samples)
        balance = self._balances.with_harmonics(harmonics, samples)
        motion, walk = self._balances.motion([trial], balance.displacement([trial]))
        way = np.zeros(motion.shape[2]) if walk is None else walk[0]
        return start_of_motion(balance.pairs, motion[0].T, way, trial.omega / (2.0 * np.pi), balance.samples)


def _most_harmonics(motion: TransientResponse) -> int:
    """The harmonics that the steps of a motion resolve."""
    return (len(motion.displacement) - 1) // 2


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
