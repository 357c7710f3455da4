"""A search for periodic motions that are not on a computed curve, from random states and from changes of contact."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import InputError
from stickslip.core.fourier import with_rows
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray, whole_number
from stickslip.results.other_solutions import OtherSolutions
from stickslip.results.response import ForcedResponse
from stickslip.results.sweeps_of_curve import Flags, stable_between_folds
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import as_excitation
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.known_curve import KnownCurve
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import Balances, StageReport, prepare_balances
from stickslip.solve.stability.curve import reason_without
from stickslip.solve.transient.integrate import check_integration
from stickslip.structure.superelement import Superelement

# chosen: random states move in the stuck modes up to this multiple of the highest frequency, with a mass norm between
# these multiples of that of the largest motion on the curve.
NEAR_MODES, SMALLEST_START, LARGEST_START = 3.0, 0.1, 10.0
# chosen: random motions for each random state. Newton's method from them costs far less than time integration, finds
# unstable motions too, and finds motions that attract few states: of 200 random motions 28 to 58 led to the subharmonic
# motion of Duffing's oscillator (tests), of 36 random states with the same damping none or a few.
MOTIONS = 8
# chosen: a start is integrated so many periods, or until a period changes by less than this; Newton's method follows.
PERIODS, SETTLED = 60, 1e-4
# chosen: steps of a period, and of a period of the highest harmonic; the motion is a first guess only.
STEPS, STEPS_PER_HARMONIC = 64, 16
# A solution is a new one if it is farther than this fraction of its size from every curve, and a point of a followed
# curve is on the computed one within the smaller fraction.
DIFFERENT, SAME = 1e-2, 1e-3


def search_other_solutions(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation | ArrayLike,
    response: ForcedResponse,
    *,
    starts: int = 24,
    seed: int = 0,
    modal_damping_ratio: float | None = None,
    newton: NewtonSettings | None = None,
    continuation: ContinuationSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
) -> ForcedResponse:
    """Search for periodic motions off a computed curve: isolated curves, and motions that branch off.

    Starts are random states at frequencies spread over the range, from which time integration runs until the motion
    repeats; several random motions at each of these frequencies; and, where contact changes its state between two
    points of the curve, the piece beyond continued backward. Newton's method makes a solution of each. One that differs
    from all solutions of the curve at its frequency is followed in both directions, through folds, to the ends of the
    range or around a closed curve.

    A search that finds nothing proves nothing. It cannot find motions whose period is a multiple of that of the
    excitation, and hardly those that attract few states. The same seed gives the same search.

    Parameters
    ----------
    superelement, pairs, excitation, modal_damping_ratio:
        those of the response; the excitation may be an array of ``force_cos``, (n,) or (n, n_harmonics).
    response:
        a curve of :func:`forced_response`, whose harmonics, samples and update this takes; not those of a piece that
        has more of them (a warning gives its range).
    starts, seed:
        number of frequencies with a random state each, 0 or above, and seed of their random numbers.
    newton, continuation, threads, progress:
        as in :func:`forced_response`.

    Returns
    -------
    ForcedResponse
        the response with ``other_solutions``.

    Raises
    ------
    InputError
        for inputs that cannot be used, or do not belong to the response; for a joint that time integration does not
        take (:func:`integrate_to_steady_state`).
    """
    whole_number("starts", starts, 0)
    whole_number("seed", seed, 0)
    check_integration(superelement, pairs)
    force = as_excitation(excitation, None, None)
    if response.displacement.shape[1] != superelement.size or response.pairs.n_pairs != pairs.n_pairs:
        raise InputError(
            f"the response has {response.n_unknowns} unknowns and {response.pairs.n_pairs} pairs, but superelement and "
            f"pairs have {superelement.size} and {pairs.n_pairs}: give those with which it was computed.",
            arguments=["response"],
        )
    if np.ptp(response.load_factor) > 0.0:
        raise InputError(
            "the response is one at prescribed amplitude or phase; the search is for curves under a constant "
            "excitation, of forced_response.",
            arguments=["response"],
        )
    report, count, resolution = StageReport(progress), thread_count(threads), response.resolution_at()
    with solver_threads(count):
        balances = prepare_balances(
            superelement, pairs, force, 2.0 * np.pi * float(response.frequency_hz.max()), resolution.harmonics,
            resolution.samples, modal_damping_ratio, cast("Update", response.settings["update"]), report.stage,
        )  # fmt: skip
        search = _Search(balances, response, newton or NewtonSettings(), continuation or ContinuationSettings(), report)
        others = search.run(starts, seed)
    return replace(response, other_solutions=others, warnings=response.warnings + _lacking(response))


def _lacking(response: ForcedResponse) -> tuple[str, ...]:
    """A warning where the curve has more harmonics than the search."""
    own = response.resolution_at().harmonics
    more = np.zeros(0) if response.point_harmonics is None else response.frequency_hz[response.point_harmonics > own]
    if not more.size:
        return ()
    return (
        f"The search for other solutions has harmonics up to {own}. From {more.min():.3f} to {more.max():.3f} Hz the "
        "curve has more, because its motion requires them: there the search can miss motions, and one that it finds "
        f"can be that of the curve, or one of the equations with harmonics up to {own} only.",
    )


@dataclass(frozen=True)
class _Followed:
    """A further curve."""

    points: list[BalancePoint]
    closed: bool
    complete: bool


class _Search:
    """The search beside one curve."""

    def __init__(
        self,
        balances: Balances,
        response: ForcedResponse,
        newton: NewtonSettings,
        continuation: ContinuationSettings,
        report: StageReport,
    ) -> None:
        self._balances, self._continuation, self._report = balances, continuation, report
        self._balance, self._in_time = balances.with_harmonics(response.resolution_at().harmonics), balances.in_time()
        self._curve = FrequencyCurve(self._balance)
        self._newton = Newton(self._curve, newton, report.iteration)
        self._resonances = Resonances(balances.closed, balances.free, balances.stuck, balances.force)
        omega = 2.0 * np.pi * response.frequency_hz
        relative = (balances.pairs.operator @ response.displacement).transpose(0, 2, 1)
        relative[:, 0] += [response.pair_way(point).ravel() for point in range(omega.size)]
        rows = 2 * self._balance.harmonics + 1
        self._points = [
            self._curve.at(with_rows(each, rows), float(at)) for each, at in zip(relative, omega, strict=True)
        ]
        self._range = float(omega.min()), float(omega.max())
        self._followed: list[_Followed] = []
        self._known = [self._as_known(self._points)]  # the computed curve, then those that were followed
        # The force has so many periods in one of the solution; a motion one of them later is the same.
        excited = np.flatnonzero(self._balance.force.coefficients(self._range[1]).any(axis=1))
        self._parts = math.gcd(*((row + 1) // 2 for row in excited.tolist())) or 1

    def run(self, starts: int, seed: int) -> OtherSolutions:
        """Search from all starts."""
        changes = lost = 0
        for guess in self._beyond_changes():
            changes += 1
            self._consider(self._solved(guess.unknowns, guess.trial.omega))
        random = np.random.default_rng(seed)
        low, high = self._range
        for number in range(starts):
            self._report.stage(f"search for other solutions, start {number + 1} of {starts}", number / starts)
            omega = low + (high - low) * (number + float(random.uniform())) / starts
            for _ in range(MOTIONS):
                self._consider(self._near_motion(self._random_state(random), omega))
            solution = self._from_state(self._random_state(random), omega)
            lost += solution is None
            self._consider(solution)
        return self._result(starts, seed, lost, changes)

    def _solved(self, unknowns: FloatArray, omega: float) -> BalancePoint | None:
        """The solution at a frequency near a guess, None if Newton's method has none."""
        correction = self._newton.correct(self._curve.at(unknowns, omega), Plane.fixed(unknowns, omega))
        return correction.point if correction.converged else None

    def _beyond_changes(self) -> Iterator[BalancePoint]:
        """Where contact changes its state between two points: each piece continued beyond the change."""
        for place in range(1, len(self._points) - 2):
            before, after = self._points[place], self._points[place + 1]
            if np.array_equal(before.trial.contact.state, after.trial.contact.state):
                continue
            for near, far in ((before, self._points[place - 1]), (after, self._points[place + 2])):
                chord = near.unknowns - far.unknowns
                omega = 2.0 * near.trial.omega - far.trial.omega
                if self._range[0] <= omega <= self._range[1]:
                    yield self._curve.at(near.unknowns + chord, omega)

    def _random_state(self, random: np.random.Generator) -> FloatArray:
        """(2, n) displacement, and velocity over the circular frequency, in the near modes."""
        stuck = self._balances.stuck
        near = max(1, int(np.searchsorted(stuck.circular_frequency, NEAR_MODES * stuck.highest_omega)))
        largest = max(float(np.linalg.norm(point.measured)) for point in self._points)
        exponent = random.uniform(np.log(SMALLEST_START), np.log(LARGEST_START))
        state = random.normal(size=(2, near))
        state *= largest * np.exp(exponent) / np.linalg.norm(state)
        return np.asarray(state @ stuck.modes[:, :near].T)

    def _near_motion(self, state: FloatArray, omega: float) -> BalancePoint | None:
        """The solution near the harmonic motion through a state."""
        guess = np.zeros((2 * self._balance.harmonics + 1, self._balance.rows))
        guess[1:3] = state @ self._balances.pairs.operator.T
        return self._solved(guess, omega)

    def _from_state(self, state: FloatArray, omega: float) -> BalancePoint | None:
        """The periodic motion to which a state leads; None without one."""
        steps = max(STEPS, STEPS_PER_HARMONIC * self._balance.harmonics)
        start = {"initial_displacement": state[0], "initial_velocity": omega * state[1]}
        motion = self._in_time.after(start, omega, steps, PERIODS, SETTLED)
        if motion is None:
            return None
        return self._solved(self._in_time.unknowns(motion, self._balance.harmonics), omega)

    def _consider(self, solution: BalancePoint | None) -> None:
        """Follow a solution that is on no curve so far."""
        if solution is None or self._is_on_a_curve(solution):
            return
        followed = self._off_the_curve(self._follow(solution))
        if followed is not None:
            self._followed.append(followed)
            self._known.append(self._as_known(followed.points))

    def _as_known(self, points: Sequence[BalancePoint]) -> KnownCurve:
        return KnownCurve(self._newton, points, self._range[1] - self._range[0])

    def _is_on_a_curve(self, solution: BalancePoint) -> bool:
        later = [solution, *(self._later(solution, part) for part in range(1, self._parts))]
        return any(curve.passes(each, DIFFERENT) for curve in self._known for each in later)

    def _later(self, solution: BalancePoint, part: int) -> BalancePoint:
        """The same motion ``part`` periods of the force later."""
        harmonics = self._balance.harmonics
        angle = 2.0 * np.pi * part / self._parts * np.arange(1, harmonics + 1)[:, None]
        cosine, sine = solution.unknowns[1::2], solution.unknowns[2::2]
        unknowns = solution.unknowns.copy()
        unknowns[1::2] = np.cos(angle) * cosine + np.sin(angle) * sine
        unknowns[2::2] = np.cos(angle) * sine - np.sin(angle) * cosine
        return self._curve.at(unknowns, solution.trial.omega)

    def _follow(self, start: BalancePoint) -> _Followed:
        """The curve through a solution: around it, or to the ends of the range on both sides."""
        parts = []
        for end in reversed(self._range):
            branch = Branch(
                self._newton, start, end, self._continuation, landmarks=self._resonances, within=self._range
            )
            points = [each.point for each in branch.follow()]
            if branch.closed:
                return _Followed(points, closed=True, complete=True)
            parts.append((points, branch.complete))
        (up, up_ends), (down, down_ends) = parts
        return _Followed([*reversed(down[1:]), *up], closed=False, complete=up_ends and down_ends)

    def _off_the_curve(self, followed: _Followed) -> _Followed | None:
        """The longest part of a followed curve that is not on the computed one, which it may join; None without one."""
        off = [not self._known[0].passes(point, SAME) for point in followed.points]
        if all(off) or not any(off):
            return followed if all(off) else None
        edges = np.flatnonzero(np.diff(np.concatenate([[False], off, [False]]).astype(np.int8))).reshape(-1, 2)
        first, last = max(edges.tolist(), key=lambda edge: edge[1] - edge[0])
        return replace(followed, points=followed.points[max(first - 1, 0) : last + 1], closed=False)

    def _verdicts(self, curves: Sequence[_Followed]) -> tuple[Flags, Flags | None]:
        """Of all points of the curves: whether they are stable, and whether that is doubtful; folds have no doubts."""
        none: list[Flags] = [np.zeros(0, dtype=bool)]
        if reason_without(self._balance.pairs) or self._balances.no_stability:
            omegas = [[point.trial.omega for point in each.points] for each in curves]
            return np.concatenate(none + [stable_between_folds(each) for each in omegas]), None
        trials = [[point.trial for point in each.points] for each in curves]
        parts = [self._balances.stability(each, self._balance.pairs) for each in trials]
        stable, doubtful = none + [part.stable for part in parts], none + [part.doubtful for part in parts]
        return np.concatenate(stable), np.concatenate(doubtful)

    def _result(self, starts: int, seed: int, lost: int, changes: int) -> OtherSolutions:
        self._report.stage("stability of other solutions", 1.0)
        curves, size = self._followed, self._balances.superelement.size
        trials = [[point.trial for point in each.points] for each in curves]
        displacement = [self._balances.motion(each, self._balance.displacement(each))[0] for each in trials]
        width = 2 * self._balance.harmonics + 1
        stable, doubtful = self._verdicts(curves)
        return OtherSolutions(
            tuple(_name(each, number) for number, each in enumerate(curves, start=1)),
            np.array([each.complete for each in curves], dtype=bool),
            np.repeat(np.arange(len(curves)), [len(each.points) for each in curves]),
            np.array([point.trial.omega for each in curves for point in each.points]) / (2.0 * np.pi),
            np.concatenate([np.zeros((0, width, size)), *displacement]).transpose(0, 2, 1),
            np.array([each.closed for each in curves], dtype=bool),
            stable,
            starts,
            MOTIONS * starts,
            seed,
            lost,
            changes,
            doubtful,
        )


def _name(followed: _Followed, number: int) -> str:
    return f"{'closed' if followed.closed else 'open'} curve {number}"
