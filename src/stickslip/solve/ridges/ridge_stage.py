"""The equations of a ridge of peaks at one value of its parameter, and the count of the work."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from threading import Event

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import Peak
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.neglected import more_harmonics, neglected
from stickslip.solve.harmonic.peak import BoundedCurve, CurvePeak, PeakSearch
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.harmonic.varying_harmonics import LADDER
from stickslip.solve.path.arc_length import Tangent
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane, Step
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.path.work import Work as PathWork
from stickslip.solve.ridges.ridge_slope import rise_of_peak
from stickslip.solve.setting_up import Balances, StageReport, prepare_balances
from stickslip.structure.superelement import Superelement, require_no_gyroscopic

# Measured on the two blades (700 unknowns n, 330 rows m of pairs): the modes of a structure, which take a time of n^3,
# last as long as 10 evaluations with their share of a Newton step, which take n m.
PREPARATION = 10.0 * 330.0 / 700.0**2
# chosen: stuck modes from which those with all pairs closed are combined. 80 of the 700 of the two blades give the
# first two frequencies at most 0.15 % too high.
COMBINED_MODES = 80
# chosen: a peak with more harmonics may be this far off, relative, or so many times its estimated error; else it is
# another peak.
SAME_PEAK, SAME_PEAK_ERRORS = 0.05, 1.5
Problem = tuple[Superelement, ContactPairs, Excitation]


@dataclass(frozen=True)
class RidgeOptions:
    """Options that all values of the parameter share; see :func:`peak_ridge`.

    Peaks are followed in ``frequency_hz``, over which whole curves are too, with steps of at most ``curve_step`` and
    the tolerance ``curve_tolerance``, None for that of ``newton``. Peaks are searched from their points, with the
    latter.
    """

    frequency_hz: tuple[float, float]
    harmonics: int = 5
    samples: int = 256
    update: Update = "tractrix"
    newton: NewtonSettings = field(default_factory=NewtonSettings)
    curve_step: float = ContinuationSettings.largest_step
    curve_tolerance: float | None = None


@dataclass(frozen=True)
class StuckMode:
    """A mode of the stuck structure: its number from 0, circular frequency in rad/s, mass matrix (n, n), and mass times
    its mass-normalised shape (n,)."""

    number: int
    omega: float
    mass: FloatArray
    weighted: FloatArray

    def is_comparable(self, other: StuckMode) -> bool:
        """Whether the shapes have the same coordinates."""
        return self.mass is other.mass or np.array_equal(self.mass, other.mass)


@dataclass(frozen=True)
class RidgeStage:
    """The equations at one value of the parameter, with the number of harmonics of its ``options``.

    ``last`` is the factor that searches at other values share; ``work`` counts evaluations, ``listen`` iterations.
    ``changed`` gives the input for a parameter that is larger by ``STEP`` (:mod:`ridge_slope`), relative; None where
    that takes too long.
    """

    balances: Balances
    output: FloatArray
    options: RidgeOptions
    last: LastFactor
    listen: Callable[[int, float], None]
    work: Work
    changed: Callable[[], Problem] | None = None
    _stuck_peaks: dict[int, Peak | None] = field(default_factory=dict)
    _others: dict[int, RidgeStage] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        problem: Problem,
        output: FloatArray,
        options: RidgeOptions,
        modal_damping_ratio: float | None,
        report: StageReport,
        earlier: RidgeStage | None = None,
        changed: Callable[[], Problem] | None = None,
    ) -> RidgeStage:
        """The equations of a structure, joint and excitation, with the modes of an ``earlier`` stage where they are the
        same. Raises InputError."""
        balances = prepare_balances(
            *problem, 2.0 * math.pi * max(options.frequency_hz), options.harmonics, options.samples,
            modal_damping_ratio, options.update, lambda words: None,
            None if earlier is None else earlier.balances.stuck,
        )  # fmt: skip
        require_no_gyroscopic(balances.superelement, "a ridge of peaks")
        last = LastFactor() if earlier is None else earlier.last
        return cls(balances, output, options, last, report.iteration, Work(), changed)

    def counted(self, work: Work) -> RidgeStage:
        """The same equations, whose work is counted."""
        return replace(self, work=work, _others={})

    def apart(self, work: Work) -> RidgeStage:
        """The same equations for another thread, with a last factor and a count of ``work`` of their own."""
        return replace(self.counted(work), last=self.last.copy())

    @property
    def harmonics(self) -> int:
        """The number of harmonics."""
        return self.options.harmonics

    def with_harmonics(self, harmonics: int) -> RidgeStage:
        """The same equations with another number of harmonics."""
        if harmonics == self.harmonics:
            return self
        if harmonics not in self._others:
            self._others[harmonics] = replace(self, options=replace(self.options, harmonics=harmonics), _others={})
        return self._others[harmonics]

    @property
    def window(self) -> tuple[float, float]:
        """Hz, rising."""
        return min(self.options.frequency_hz), max(self.options.frequency_hz)

    def window_around(
        self, factor: float, modes: frozenset[int] | None, others_hz: Sequence[float] = ()
    ) -> tuple[float, float]:
        """The part of the window with all linear peaks, the stuck ones of ``modes``, those with all pairs closed, and
        other peaks, and the factor beyond; Hz, rising."""
        low, high = self.window
        linear = (*self.free_peaks, *self.stuck_peaks(modes))
        found = [*others_hz, *(each.frequency_hz for each in linear if each.bracketed)]
        found += [each for each in self._all_closed_hz(modes) if low < each < high]
        return max(low, min(found, default=low) / factor), min(high, max(found, default=high) * factor)

    def _all_closed_hz(self, modes: frozenset[int] | None) -> list[float]:
        """Upper bounds of the natural frequencies of some stuck modes with pairs that are open at rest closed, which a
        vibration may do; empty if none is open. By Rayleigh and Ritz."""
        pairs, stuck = self.balances.pairs, self.balances.stuck
        added = pairs.stuck_stiffness() - pairs.resting_stiffness()
        if not added.any():
            return []
        shapes = stuck.contact_modes[:, :COMBINED_MODES]
        stiffness = np.diag(stuck.circular_frequency[:COMBINED_MODES] ** 2) + shapes.T @ (added[:, None] * shapes)
        bounds_hz = np.sqrt(np.linalg.eigvalsh(stiffness)) / (2.0 * math.pi)
        chosen = self.modes_between(self.window) if modes is None else modes
        return [float(bounds_hz[each]) for each in chosen if each < bounds_hz.size]

    @cached_property
    def curve(self) -> BoundedCurve:
        """The frequency curve."""
        low, high = self.window
        limits = 2.0 * math.pi * low, 2.0 * math.pi * high
        curve = BoundedCurve(self.balances.with_harmonics(self.harmonics), self.last, limits)
        curve.on_evaluation = self.work.evaluate
        return curve

    @cached_property
    def solver(self) -> Newton[BalancePoint]:
        """Newton's method for peaks of the frequency curve."""
        return self._newton(self.options.newton)

    def _newton(self, settings: NewtonSettings, limit: PathWork | None = None) -> Newton[BalancePoint]:
        """Newton's method, whose iterations count; ``limit`` is reached with that of the work on all ridges."""

        def count(number: int, error: float) -> None:
            if limit is not None and self.work.is_used_up:
                limit.limit_words = (
                    f"the work on all ridges reached its limit of {self.work.most:.0f} evaluations of the balance."
                )
            self.listen(number, error)

        return Newton(self.curve, settings, count)

    def corrected(self, point: BalancePoint) -> BalancePoint | None:
        """A point of a whole curve with the tolerance of peaks, None if Newton's method does not converge."""
        correction = self.solver.correct(point, Plane.fixed(point.unknowns, point.trial.omega))
        return correction.point if correction.converged else None

    @cached_property
    def search(self) -> PeakSearch:
        """The search of peaks of the output."""

        def mean_row(trial: Trial) -> FloatArray:
            return self.balances.mean_row(trial, self.output)

        search = PeakSearch(self.curve, self.solver, self.output, mean_row, self.last)
        search.on_point = self.work.see_point
        return search

    @property
    def stuck_omega(self) -> FloatArray:
        """(n,) rad/s, frequencies of the stuck modes."""
        return self.balances.stuck.circular_frequency

    def stuck_peaks(self, modes: frozenset[int] | None = None) -> list[Peak]:
        """The linear peaks with stuck contacts, highest first; those closest to some ``modes`` (from 0), None for all.

        If the highest amplitude is at an end of the window, this is a peak that is not bracketed.
        """
        if modes is None:
            return self._closed_peaks
        natural_hz = self.balances.closed.natural_hz
        return [each for each in self._closed_peaks if int(np.abs(natural_hz - each.frequency_hz).argmin()) in modes]

    @cached_property
    def _closed_peaks(self) -> list[Peak]:
        """All linear peaks with stuck contacts, highest first."""
        return self.balances.closed.peaks(self.window, self.balances.force, self.output)

    def stuck_mode(self, number: int) -> StuckMode:
        """A mode of the stuck structure."""
        mass, stuck = self.balances.superelement.mass, self.balances.stuck
        return StuckMode(number, float(stuck.circular_frequency[number]), mass, mass @ stuck.modes[:, number])

    def same_mode(self, earlier: StuckMode) -> StuckMode:
        """The mode whose shape is most like that of another stage, or the one with the same number in other
        coordinates: the order of modes changes where their frequencies cross."""
        same = self.stuck_mode(earlier.number)
        if not same.is_comparable(earlier):
            return same
        return self.stuck_mode(int(np.abs(earlier.weighted @ self.balances.stuck.modes).argmax()))

    def stuck_peak(self, mode: int) -> Peak | None:
        """The linear peak of a stuck mode (number from 0), None without one in the window."""
        if mode not in self._stuck_peaks:
            found = [each for each in self.stuck_peaks(frozenset({mode})) if each.bracketed]
            self._stuck_peaks[mode] = found[0] if found else None
        return self._stuck_peaks[mode]

    def linear_point(self, frequency_hz: float) -> BalancePoint:
        """The motion with all pairs stuck, a point of the frequency curve if no pair slips in it."""
        omega = 2.0 * math.pi * frequency_hz
        return self.curve.at(self.search.balance.linear(omega), omega)

    def is_solution(self, point: BalancePoint) -> bool:
        """Whether a point satisfies the balance to the tolerance of Newton's method."""
        return point.error <= self.solver.settings.tolerance

    def modes_between(self, window: tuple[float, float]) -> frozenset[int]:
        """Numbers from 0 of the stuck modes in a frequency range, Hz."""
        natural_hz = self.balances.closed.natural_hz
        return frozenset(np.flatnonzero((natural_hz >= min(window)) & (natural_hz <= max(window))).tolist())

    @cached_property
    def free_peaks(self) -> list[Peak]:
        """The linear peaks without contacts, highest first."""
        return self.balances.free.peaks(self.window, self.balances.force, self.output)

    def amplitude(self, points: Sequence[BalancePoint]) -> FloatArray:
        """(n_points,) amplitude of the output at points of the curve."""
        return np.array([self.search.amplitude(point.trial) for point in points])

    def estimated_error(self, peak: CurvePeak) -> float:
        """The relative error of a peak by neglected harmonics (:mod:`stickslip.solve.harmonic.neglected`)."""
        balance, point, step = self.search.balance, peak.probe.point, peak.probe.tangent
        more = more_harmonics(balance.harmonics, balance.samples, self.balances.damped_harmonics)
        along = Tangent(step.unknowns, self.curve.measured_change(point, step), step.parameters)
        fine = self.balances.with_harmonics(more)
        return neglected(point.trial, balance, fine, along, self.last).error

    def rise(self, peak: CurvePeak) -> float:
        """Derivative of the logarithm of a peak of these equations by that of the parameter; not a number where it is
        not known (:func:`stickslip.solve.ridges.ridge_slope.rise_of_peak`)."""
        return math.nan if self.changed is None else rise_of_peak(peak, self.search, self.balances, self.changed())

    def refined(self, peak: CurvePeak, accuracy: float, most: int) -> tuple[CurvePeak, dict[int, float]]:
        """A peak with more harmonics, at ``most`` so many, until its estimated error is below the ``accuracy``.

        Also the estimated errors by the number of harmonics. The peak stays as it is where one with more harmonics is
        not found.
        """
        stage, errors = self, {self.harmonics: self.estimated_error(peak)}
        while errors[stage.harmonics] > accuracy and (more := more_than(stage.harmonics)) <= most:
            allowed, probe = max(SAME_PEAK, SAME_PEAK_ERRORS * errors[stage.harmonics]), peak.probe
            stage = self.with_harmonics(more)
            unknowns, across = with_rows(probe.point.unknowns, 2 * more + 1), resized_step(probe.tangent, more)
            found = stage.search.from_estimate(unknowns, float(probe.point.parameters[0]), across, peak.curvature)
            if isinstance(found, str) or abs(math.log(found.amplitude / peak.amplitude)) > allowed:
                break
            peak, errors[more] = found, stage.estimated_error(found)
        return peak, errors

    def whole_curve(self, window: tuple[float, float] | None = None) -> Branch[BalancePoint]:
        """The frequency curve over a part of its window, Hz, or over all of it; before pairs move its points need no
        iteration. It ends where the work on all ridges does. Raises ConvergenceError without a first point."""
        settings, known = ContinuationSettings(largest_step=self.options.curve_step), self.curve.stuck
        balances, (start, stop) = self.balances, (2.0 * math.pi * f for f in window or self.window)
        resonances = Resonances(balances.closed, balances.free, balances.stuck, balances.force)
        newton = self.options.newton
        limit = PathWork()
        solver = self._newton(replace(newton, tolerance=self.options.curve_tolerance or newton.tolerance), limit)

        def walk(point: BalancePoint, end: float = start) -> Branch[BalancePoint]:
            return Branch(solver, point, end, settings, landmarks=resonances, known=known, work=limit)

        point, _ = first_point(solver, self.curve, start, balances.with_harmonics, walk)
        branch = walk(point, stop)
        branch.follow()
        return branch


def more_than(harmonics: int) -> int:
    """The next number of harmonics."""
    return next((each for each in LADDER if each > harmonics), harmonics + 2)


def resized_step(step: Step, harmonics: int) -> Step:
    """The same step among unknowns with another number of harmonics."""
    rows = 2 * harmonics + 1
    return Step(with_rows(step.unknowns, rows), step.parameters, with_rows(step.detail, rows))


# The equations at a value, with what they share with those of an earlier one.
StageMaker = Callable[[float, RidgeStage | None], RidgeStage]


class WorkStoppedError(Exception):
    """A task beside this one ended by an error."""


class Work:
    """Evaluations of the balance so far, with the preparation of the equations counted too, at most so many, and
    points of all searches, also of those without a result. Estimates of errors do not count."""

    def __init__(self, most: float = math.inf, stopped: Event | None = None) -> None:
        self.most, self.done, self.points = most, 0.0, 0
        self._stopped = stopped or Event()

    def rest(self) -> Work:
        """A count of its own for a task beside others, which may do all the work that is left."""
        return Work(self.most - self.done, self._stopped)

    def stop(self) -> None:
        """End this work and that of the tasks beside it."""
        self._stopped.set()

    def add(self, other: Work) -> None:
        """Count the work of such a task."""
        self.done += other.done
        self.points += other.points

    def evaluate(self) -> None:
        """Count an evaluation."""
        if self._stopped.is_set():
            raise WorkStoppedError
        self.done += 1.0

    def see_point(self) -> None:
        """Count a point of a search."""
        self.points += 1

    def prepare(self, stage: RidgeStage, earlier: RidgeStage | None) -> None:
        """Count the preparation of the equations at a value; those with the modes of an earlier stage cost little."""
        if earlier is None or earlier.balances.stuck.modes is not stage.balances.stuck.modes:
            self.done += PREPARATION * stage.output.size**2 / (3 * stage.balances.pairs.n_pairs)

    @property
    def is_used_up(self) -> bool:
        """Whether no further point is allowed."""
        return self.done >= self.most
