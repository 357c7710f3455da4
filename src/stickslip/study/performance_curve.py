"""The performance curve of two blades: peak amplitude and frequency against centrifugal force over excitation force.

Each point is the highest peak under the excitation force of the study. With the centrifugal force of the damper the
normal load changes, and with it the contact stiffness if that follows from the roughness: this is the damper of the
study with another mass or at another speed, not only another preload at constant stiffness.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeGuard

import numpy as np

from stickslip.case.case import Case, TwoBladeCase
from stickslip.case.key_ranges import CaseFamily
from stickslip.case.two_blade_sections import ROTATING
from stickslip.core.errors import RoughnessError, StickslipError
from stickslip.core.fourier import with_rows
from stickslip.core.progress import Progress
from stickslip.core.threads import solver_threads
from stickslip.model.model import ReducedModel, load_joint
from stickslip.results.checked_peak import DOUBTFUL, CheckedPeak
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.peaks import Peak, peaks
from stickslip.results.response import ForcedResponse
from stickslip.solve.ridges.peak_samples import PeakSamples
from stickslip.solve.ridges.ridge_check import checked_minimum
from stickslip.solve.ridges.ridge_coverage import RiseBelow
from stickslip.solve.ridges.ridge_map import LEAST_FRACTION, RidgeMap
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage, Work
from stickslip.solve.ridges.ridge_walk import Pace
from stickslip.solve.setting_up import StageReport
from stickslip.study.ridge import CaseStages, ridge_options

KEY = "preload.centrifugal_force"
NAME = "centrifugal force over excitation force"
# chosen: centrifugal force over excitation force from before the optimum of most dampers to where they are stuck. The
# lower end moves on to the least ratio, until the peak rises below its minimum; a lighter damper bounces, and takes
# long: below 60 N the rough casting takes eight times the time of its frequency curve, all above 1.8 times the minimum.
LOWEST_RATIO, HIGHEST_RATIO = 0.2, 30.0
LEAST_RATIO = 0.02
# chosen: peaks move with the force, so the range of frequencies is that of the study and a fifth more on both sides.
WIDER = 1.2
# chosen: the lowest possible force is determined to this factor.
LOWEST_FORCE_TO = 1.05
# A picture: coarser steps than those of a ridge, and it ends where a bouncing damper would need tiny ones.
PACE = Pace(
    first_step=0.05,
    smallest_step=0.004,
    largest_step=0.8,
    wanted_error=0.04,
    estimate_every=0.3,
    interpolation_error=7e-4,  # the demand is 0.1 %; beside corners estimates are up to half too low
)
# chosen: most harmonics of a point, in studies with an accuracy better than that of doubtful points (1 %). Others have
# those of the peak of the study: with 5 instead of 3 the curve of the default study takes five times as long, and the
# points that differ are in gross slip and drawn as doubtful. With 7, points there are not better (they require 11), and
# a ridge that falls into parts costs as much as all others.
MOST_HARMONICS = 5
# chosen: relative error of the balance. That of the amplitude is below 1e-5, and it takes a third less iterations than
# the tolerance of [solver]; with 1e-5 more searches fail than that saves.
TOLERANCE = 1e-6
# chosen: that of whole curves, whose peaks are then searched: their points have a third less iterations.
CURVE_TOLERANCE = 1e-4
# chosen: points that are found at all take five iterations at most; a search that needs more begins again closer.
MOST_ITERATIONS = 6
# chosen: work of the curve, in evaluations of the balance, over that of the frequency curve of the study, and of it
# that of further points, which make the line between the others more accurate.
MOST_CURVES, REFINING = 8.0, 1.5
# chosen: the same of the check at the minimum, and of the whole curves that follow there, with their peaks.
CHECKING = 2.0
# chosen: with a solved preload, the factor between forces, and how often the intervals beside the lowest peak are
# divided.
SAMPLED_BY, DIVISIONS = 1.8, 2
# chosen: longest step of a whole curve, of which only the neighbourhood of its peaks is used.
CURVE_STEP = 0.14
# chosen: whole curves go beyond all linear peaks and ridges by this factor.
AROUND = 1.03


def has_performance_curve(case: Case) -> bool:
    """Whether a run computes the curve: of two blades whose loads follow from a centrifugal force."""
    return _wants_performance_curve(case) and not why_no_performance_curve(case)


def why_no_performance_curve(case: Case) -> str:
    """Why a run of two blades that should have the curve has none; "" if it has one, or should not."""
    if not _wants_performance_curve(case):
        return ""
    if case.reduction.pairs != "all":
        return (
            f'reduction.pairs is "{case.reduction.pairs}", and under another load other pairs move. Set pairs = "all".'
        )
    if case.preload.damper_force is None:
        return "preload.values gives the load of each pair, not a centrifugal force. Set preload.centrifugal_force."
    return ""


def _wants_performance_curve(case: Case) -> TypeGuard[TwoBladeCase]:
    """Whether a case is one of two blades that does not omit the curve."""
    return isinstance(case, TwoBladeCase) and case.analysis.performance_curve


def with_performance_curve(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int
) -> ForcedResponse:
    """The response with its performance curve, if the case has one; a warning where it could not be computed."""
    if not _wants_performance_curve(case):
        return response
    why = why_no_performance_curve(case)
    if not why and not response.converged:  # a peak of the study may be missing, and its work is no measure
        why = "the frequency curve of the study is not complete."
    if not why:
        try:
            with solver_threads(threads):
                curve = performance_curve(case, model, response, progress, threads)
            return replace(response, performance_curve=curve)
        except StickslipError as error:
            why = str(error)
    return replace(response, warnings=(*response.warnings, f"The performance curve was not computed: {why}"))


def performance_curve(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int
) -> PeakRidge:
    """The highest peaks over the centrifugal force over the excitation force.

    With a prescribed preload the high peaks of the response are followed, and those of the stuck structure under the
    largest centrifugal force, of the modes that are in the frequency range of the study under its own force. With a
    solved one, whole frequency curves at some forces have them. Raises InputError, ConvergenceError.
    """
    damper = _Damper.of(case, model, response, progress, threads)
    curve = (_sampled if case.preload.method == "solved" else _followed)(damper)
    settings = {
        **curve.settings,
        "harmonics": damper.options.harmonics,
        "excitation_force_n": damper.excitation,
        "centrifugal_force_n": damper.force,
    }
    warnings = (*curve.warnings, *_beginning(float(curve.start), damper.lowest, damper.least))
    return replace(curve.over(damper.excitation, NAME, ""), settings=settings, warnings=warnings)


def with_given_force(case: Case) -> TwoBladeCase:
    """A case with a performance curve, its centrifugal force given as such, also if it follows from the mass of the
    damper."""
    assert isinstance(case, TwoBladeCase)
    force = case.preload.damper_force
    assert force is not None  # see has_performance_curve
    if case.preload.centrifugal_force is None:
        case = case.replace({KEY: f"{force!r} N", **{f"preload.{key}": None for key in ROTATING}})
    return case


@dataclass(frozen=True)
class _Damper:
    """The damper of a study under other centrifugal forces.

    Forces in N: ``force`` is that of the study, ``bounds`` are those of the curve, ``least`` is the least one wanted
    and ``lowest`` the least possible one. ``one_curve`` is the work of the frequency curve of the study, whose high
    peaks are ``tops``.
    """

    response: ForcedResponse
    tops: list[Peak]
    output_name: str
    force: float
    excitation: float
    bounds: tuple[float, float]
    least: float
    lowest: float
    options: RidgeOptions
    pace: Pace
    stages: CaseStages
    report: StageReport

    @classmethod
    def of(cls, case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int) -> _Damper:
        """The damper of a case with a performance curve."""
        case = with_given_force(case)
        force = case.preload.centrifugal_force
        assert force is not None
        excitation = case.excitation.amplitude
        least, low, high = (ratio * excitation for ratio in (LEAST_RATIO, LOWEST_RATIO, HIGHEST_RATIO))
        family = CaseFamily.of(case, KEY)
        lowest = _last_possible(family, model, min(least, force), force)
        bounds = max(lowest, min(low, force)), _last_possible(family, model, max(high, force), force)
        report = StageReport(lambda fraction, detail: progress.update("Performance curve", fraction, detail))
        tops = _high_peaks(model, response)
        options = ridge_options(case, TOLERANCE, _harmonics_of(tops, response))
        window = min(options.frequency_hz), max(options.frequency_hz)
        accuracy = case.solver.accuracy or DOUBTFUL
        options = replace(
            options,
            frequency_hz=(window[0] / WIDER, window[1] * WIDER),
            newton=replace(options.newton, max_iterations=MOST_ITERATIONS),
            curve_tolerance=CURVE_TOLERANCE,
            curve_step=max(options.curve_step, min((case.solver.accuracy or 1.0) ** 0.5, CURVE_STEP)),
        )
        is_coarse = case.solver.accuracy is None or accuracy > DOUBTFUL
        pace = replace(
            PACE,
            accuracy=min(accuracy, DOUBTFUL),
            most_harmonics=options.harmonics if is_coarse else max(MOST_HARMONICS, options.harmonics),
        )
        stages = CaseStages(family, model, report, threads, options)
        name = next(iter(model.outputs))
        return cls(
            response, tops, name, force, excitation, bounds, min(least, force), lowest, options, pace, stages, report
        )

    @property
    def one_curve(self) -> float:
        """The work of the frequency curve of the study."""
        return float(self.response.iterations.sum() + self.response.n_points)

    def modes_of(self, own: RidgeStage) -> frozenset[int]:
        """The stuck modes in the frequency range of the study, of the equations under its own force."""
        low, high = self.options.frequency_hz
        return own.modes_between((low * WIDER, high / WIDER))


def _followed(damper: _Damper) -> PeakRidge:
    """The ridges over the centrifugal force, with a check of the lowest minimum with slip."""
    force, one_curve = damper.force, damper.one_curve
    own = damper.stages(force, None)
    work = Work((MOST_CURVES - REFINING) * one_curve)
    ridges = RidgeMap(
        damper.stages, damper.bounds, damper.report, damper.pace, _in_newton, work, damper.modes_of(own), AROUND, own
    )
    _follow_response(ridges, damper)
    ridges.verified.add(force)  # by the curve of the study
    ridges.add_stuck(damper.bounds[1])
    ridges.enclose_minimum(damper.lowest)
    ridges.check_ends()

    def refine() -> None:
        work.most = work.done + REFINING * one_curve
        ridges.refine()
        work.most = work.done + CHECKING * one_curve

    work.most = work.done + CHECKING * one_curve
    check = checked_minimum(ridges, damper.pace.accuracy, refine)
    curve = _with_check(ridges.result(KEY, "N", damper.output_name), check)
    start = float(curve.start)
    if not np.isclose(curve.parameter.min(), start):  # the message says from where the peak is known
        return curve
    return replace(curve, warnings=(*curve.warnings, *_open_below(ridges.rise_below(), start, damper.lowest)))


def _sampled(damper: _Damper) -> PeakRidge:
    """The highest peaks at single forces: that of the study, others around it by one factor, and beside the lowest."""
    low, high = damper.bounds
    own = damper.stages(damper.force, None)
    work = Work(MOST_CURVES * damper.one_curve)
    samples = PeakSamples(
        damper.stages, damper.report, damper.pace, _in_newton, work, damper.modes_of(own), AROUND, own
    )
    samples.add(_sampled_forces(damper.force, low, high))
    for _ in range(DIVISIONS):
        samples.divide_lowest()
    return samples.result(damper.bounds, KEY, "N", damper.output_name)


def _sampled_forces(force: float, low: float, high: float) -> list[float]:
    """Forces from ``high`` to ``low``, with ``force``, each some ``SAMPLED_BY`` times the next one."""
    parts: list[float] = []
    for start, stop in ((high, force), (force, low)):
        count = math.ceil(math.log(start / stop) / math.log(SAMPLED_BY)) if start > stop else 0
        parts += np.geomspace(start, stop, count, endpoint=False).tolist() if count else []
    return [*parts, low]


def _in_newton(value: float) -> str:
    """A force in words."""
    return f"{value:.4g} N"


def _with_check(curve: PeakRidge, check: CheckedPeak | str | None) -> PeakRidge:
    """The curve with the check of its lowest minimum with slip; a warning where that failed."""
    if isinstance(check, str):
        return replace(curve, warnings=(*curve.warnings, f"The lowest minimum with slip was not checked: {check}"))
    return curve if check is None else replace(curve, checked=(check,))


def _beginning(start: float, lowest: float, wanted: float) -> tuple[str, ...]:
    """A sentence on a curve that ends at the lowest possible force, above the one wanted."""
    if lowest == wanted or start > lowest * LOWEST_FORCE_TO:
        return ()
    return (
        f"Below {lowest:.3g} N all contact spots of the rough faces are plastic. There the fractal law jumps or has no "
        "stiffness, so the curve begins there.",
    )


def _open_below(rise: RiseBelow, start: float, lowest: float) -> tuple[str, ...]:
    """A sentence on a curve that ends above the lowest possible force before its peak has risen far."""
    if start <= lowest or rise.is_certain:
        return ()
    free = f", and without contact it is {rise.free:.2f} times that value" if rise.free else ""
    return (
        f"The curve begins at {start:.3g} N. There the highest peak is {rise.at_end:.2f} times its lowest value with "
        f"slip{free}. Lighter dampers bounce, so a lower minimum below {start:.3g} N is not excluded. A ridge over "
        f"{KEY} from {lowest:.4g} N shows the peaks there.",
    )


def _last_possible(family: CaseFamily, model: ReducedModel, wanted: float, force: float) -> float:
    """The centrifugal force next to ``wanted`` up to which, from ``force`` of the case on, the joint has a stiffness
    that does not jump: the fractal law does where all spots become plastic."""
    branch = load_joint(family.at(force), model.joint.layout).faces_with_least_stiffness

    def is_possible(value: float) -> bool:
        try:
            joint = load_joint(family.at(value), model.joint.layout)
        except RoughnessError:
            return False
        return joint.faces_with_least_stiffness == branch

    if is_possible(wanted):
        return wanted
    while max(force / wanted, wanted / force) > LOWEST_FORCE_TO:
        middle = math.sqrt(wanted * force)
        wanted, force = (wanted, middle) if is_possible(middle) else (middle, force)
    return force


def _high_peaks(model: ReducedModel, response: ForcedResponse) -> list[Peak]:
    """The peaks of the first output that are followed."""
    found = peaks(response.frequency_hz, response.amplitude(next(iter(model.outputs.values()))), response.part)
    return [each for each in found if each.bracketed and each.amplitude >= LEAST_FRACTION * found[0].amplitude]


def _harmonics_of(found: list[Peak], response: ForcedResponse) -> int:
    """The most harmonics that the peaks have, or all points of the response."""
    return response.harmonics_at([each.point for each in found]) if found else response.harmonics


def _follow_response(ridges: RidgeMap, damper: _Damper) -> None:
    """Follow the high peaks of the response of the case."""
    response, rows = damper.response, 2 * damper.options.harmonics + 1
    for top in damper.tops:
        unknowns = response.pair_coefficients(top.point).reshape(3 * response.pairs.n_pairs, -1).T
        omega = 2.0 * np.pi * float(response.frequency_hz[top.point])
        ridges.add_from(damper.force, with_rows(unknowns, rows), omega)
