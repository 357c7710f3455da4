"""Gradients of a peak: one call from a computed response to derivatives by all parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.fourier import with_rows
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray, finite_array, whole_number
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.peaks import Peak, peaks
from stickslip.results.response import ForcedResponse
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import as_excitation
from stickslip.solve.gradients.adjoint import Adjoint
from stickslip.solve.gradients.equation_change import ChangedEquation
from stickslip.solve.gradients.parameters import Parameter, parameters_of
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curve_at_peak import TANGENT_TOLERANCE, CurveAtPeak, CurvePlace
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.peak import BoundedCurve, CurvePeak, PeakSearch
from stickslip.solve.harmonic.peak_values import frequency, friction_energy
from stickslip.solve.harmonic.walk import walking_points
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Step
from stickslip.solve.setting_up import Balances, StageReport, prepare_balances
from stickslip.solve.solver_input import SolverInput
from stickslip.structure.superelement import Superelement, require_no_gyroscopic

# Distance of the places on the curve, over the width of the peak. Differences of fourth order have a relative error of
# 1e-5 with it, and the small jumps of the slope by samples hardly enter.
SPACING = 0.05
# chosen: at a peak the contact force has at least so many samples, because its derivatives jump where a sample begins
# to slip; with 128 samples the slope of the amplitude jumps by 3 % of amplitude over width, with 2048 by 0.1 %.
LEAST_SAMPLES = 2048
# Tolerance of points at a peak: derivatives amplify their error by the sharpness of the peak.
TOLERANCE = 1e-11
# chosen: a peak is searched within this factor of the frequency of the highest point.
WITHIN = 1.5
# A friction energy below this fraction of the kinetic energy is round-off of pairs that stick.
ROUND_OFF = 1e-12
# chosen: a message reports an estimated error above this fraction of a derivative by which a change of the parameter by
# REPORTED_CHANGE changes the peak by more than NOTABLE_EFFECT.
LARGEST_ERROR, REPORTED_CHANGE, NOTABLE_EFFECT = 0.05, 0.1, 1e-3


@dataclass(frozen=True)
class RefinedPeak:
    """Places on the curve at equal distances around a peak, which is in the middle."""

    places: tuple[CurvePlace, ...]
    spacing: float

    @classmethod
    def of(
        cls, balance: Balance, output: FloatArray, around: Sequence[BalancePoint], spacing: float = SPACING
    ) -> RefinedPeak:
        """The peak near the middle of three points. Raises ConvergenceError."""
        newton = NewtonSettings(tolerance=TOLERANCE)
        curve = CurveAtPeak(balance, output, _exact_peak(balance, output, around, newton), newton)
        distance = spacing * curve.width
        places = tuple(curve.at(step * distance) if step else curve.top for step in range(-2, 3))
        peak = cls(places, distance)
        if not peak.along([place.slope for place in places]) < 0.0:
            raise ConvergenceError("the amplitude has no maximum of second order at the peak.")
        return peak

    @property
    def top(self) -> CurvePlace:
        """The peak."""
        return self.places[len(self.places) // 2]

    def corners(self) -> Iterator[str]:
        """A sentence if pairs change their state close to the peak."""
        states = np.array([place.point.trial.contact.state for place in self.places])
        changing = int((states != states[0]).any(axis=0).sum())
        if changing:
            hertz = [place.point.trial.omega / (2.0 * np.pi) for place in self.places]
            yield (
                f"{changing} of {states.shape[1]} pairs change between sticking, slipping and separating close to the "
                f"peak, between {min(hertz):.3f} and {max(hertz):.3f} Hz: the curve can have a corner beside the peak, "
                "and derivatives can differ on its two sides. Compute the peak again with a changed value before you "
                "use them for a larger change."
            )

    def along(self, values: Sequence[float] | FloatArray) -> FloatArray:
        """Derivative along the curve of values (5, ...) at the places, by central differences of fourth order."""
        before2, before, _, after, after2 = values
        return np.asarray((8.0 * (after - before) - (after2 - before2)) / (12.0 * self.spacing))

    def along_outer(self, values: Sequence[float] | FloatArray) -> FloatArray:
        """The same by the outer two places alone, of second order, as a check."""
        return np.asarray((values[4] - values[0]) / (4.0 * self.spacing))


def _exact_peak(
    balance: Balance, output: FloatArray, around: Sequence[BalancePoint], newton: NewtonSettings
) -> CurvePeak:
    """The peak near the middle of three points of a curve, or near the curve. Raises ConvergenceError."""
    before, middle, after = around
    omega, last = middle.trial.omega, LastFactor()
    curve = BoundedCurve(balance, last, (omega / WITHIN, omega * WITHIN))
    search = PeakSearch(
        curve, Newton(curve, newton), output, lambda trial: output, last, tangent_tolerance=TANGENT_TOLERANCE
    )
    across = Step(after.unknowns - before.unknowns, after.parameters - before.parameters, middle.trial.deviation)
    solution = search.from_estimate(middle.unknowns, omega, across, -1.0)
    if not isinstance(solution, str):
        solution = search.exact(solution)
    if isinstance(solution, str):
        raise ConvergenceError(
            f"the peak near {curve.named(omega)} has no derivative, because {solution}. If the points of the curve are "
            "far apart there, use a smaller largest_step; more samples may resolve a corner."
        )
    return solution


@dataclass(frozen=True)
class _Derivatives:
    """Derivatives of amplitude, frequency and energy (3,) with an estimate of their errors (3,)."""

    value: FloatArray
    error: FloatArray


class PeakSensitivity:
    """Derivatives of amplitude, frequency and friction energy of a refined peak."""

    def __init__(self, balances: Balances, base: SolverInput, peak: RefinedPeak) -> None:
        top, output = peak.top, base.output
        self.peak, trial = peak, top.point.trial
        self._others = frequency(trial), friction_energy(trial)
        adjoints = [Adjoint.of(place, place.amplitude, balances, output) for place in peak.places]
        adjoints += [Adjoint.of(top, value, balances, output) for value in self._others]
        self._changed = ChangedEquation(balances, base, adjoints)
        slopes = [place.slope for place in peak.places]
        self._bends = float(peak.along(slopes)), float(peak.along_outer(slopes))
        hertz, energy = (value.value for value in self._others)
        moving = 0.5 * trial.omega**2 * float((trial.amplitude**2).sum())
        self.values = np.array([top.amplitude.value, hertz, energy if energy > ROUND_OFF * moving else 0.0])

    def derivative(self, parameter: Parameter) -> _Derivatives:
        """The derivatives by a parameter, with its step to both sides. Raises InputError where the model rejects it."""
        at, step = parameter.value, parameter.step
        below, middle, above = (parameter.change(each) for each in (at - step, at, at + step))
        sides = [
            self._of_peak(self._changed.derivative(*pair, step)) for pair in ((below, middle), (middle, above))
        ]  # fmt: skip
        value = 0.5 * (sides[0].value + sides[1].value)
        return _Derivatives(value, sides[0].error + _error_of_step(*(side.value for side in sides)))

    def _of_peak(self, at_places: FloatArray) -> _Derivatives:
        """From derivatives (7,) at fixed places: the amplitude at all five, frequency and energy at the peak.

        The amplitude is stationary along the curve, so a change of the place does not change it; where the slope jumps
        across zero by a sample, the rest of the slope enters. The place of the peak, where ``a'(s, p) = 0``, moves by
        ``-(da'/dp) / a''``.
        """
        peak, top = self.peak, self.peak.top
        amplitude = at_places[:5]
        moves = -peak.along(amplitude) / self._bends[0], -peak.along_outer(amplitude) / self._bends[1]
        along = np.array([top.slope, *(top.along(value) for value in self._others)])
        fixed = np.array([amplitude[2], *at_places[5:]])
        error = np.abs(along * (moves[0] - moves[1]))
        error[0] = abs(top.slope * moves[0])
        return _Derivatives(fixed + along * float(moves[0]), error)


def peak_gradients(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation | ArrayLike,
    response: ForcedResponse,
    output: ArrayLike,
    *,
    peak: int = 0,
    parameters: Sequence[Parameter] | None = None,
    modal_damping_ratio: float | None = None,
    samples: int | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
) -> PeakGradients:
    """Derivatives of a peak of a computed response by parameters of the model.

    The peak is refined to the point of the curve where the amplitude is stationary, also at a fold. One transposed
    solution of the equations there gives the derivatives of the amplitude by all parameters; one more each those of
    frequency and energy at fixed place, and four at neighbouring places how the peak moves. A parameter requires no
    further solution: only the change of the equation of motion at the motion of the peak. Theory, limits and errors:
    docs/theory_gradients.md.

    Parameters
    ----------
    superelement, pairs, excitation, modal_damping_ratio:
        those of the response; the excitation may be an array of ``force_cos``, (n,) or (n, n_harmonics).
    response:
        a curve of :func:`forced_response`, whose harmonics (those at the peak, where a piece of it has more) and update
        this uses.
    output:
        (n,) row, whose peak is differentiated.
    peak:
        0 for the highest peak of the output, 1 for the next, ...
    parameters:
        by default the size of each excitation, the constants of the joint, each for all pairs of a law together, and
        the damping (:func:`parameters_of`).
    samples:
        samples of the period at the peak; by default those of the response, at least 2048.
    threads, progress:
        as in :func:`forced_response`.

    Returns
    -------
    PeakGradients
        NaN, and a message, for a parameter without a derivative.

    Raises
    ------
    InputError
        for inputs that cannot be used, or do not belong to the response. ConvergenceError if the peak cannot be
        refined: a corner of the curve, an end of it, or points that are too far apart.
    """
    row = finite_array("output", output)
    force = as_excitation(excitation, None, None)
    _require_own(superelement, pairs, response, row)
    top = _chosen_peak(response, row, peak)
    resolution = response.resolution_at(range(top.point - 1, top.point + 2))
    count = max(LEAST_SAMPLES, resolution.samples) if samples is None else whole_number("samples", samples, 1)
    report, cores = StageReport(progress), thread_count(threads)
    base = SolverInput(superelement, pairs, force, row, modal_damping_ratio)
    chosen = parameters_of(base) if parameters is None else tuple(parameters)
    with solver_threads(cores):
        balances = prepare_balances(
            superelement, pairs, force, 2.0 * np.pi * float(response.frequency_hz.max()), resolution.harmonics, count,
            modal_damping_ratio, cast("Update", response.settings["update"]), report.stage,
        )  # fmt: skip
        require_no_gyroscopic(superelement, "the gradient of a peak")
        report.stage("refinement of the peak", 0.1)
        balance = balances.exact(resolution.harmonics, count)
        refined = RefinedPeak.of(balance, row, _around(balance, response, top))
        _require_no_walk(balances, refined)
        report.stage("adjoint solutions at the peak", 0.3)
        sensitivity = PeakSensitivity(balances, base, refined)
        return _result(sensitivity, chosen, report)


def _error_of_step(before: FloatArray, after: FloatArray) -> FloatArray:
    """Estimated error of the mean of the derivatives to both sides.

    The terms of a smooth function fall as a geometric series with the step: their difference is of first order, the
    error of the mean of second. At a corner the difference is of the size of the derivative, and so is the estimate.
    """
    half, mean = 0.5 * np.abs(after - before), 0.5 * np.abs(after + before)
    return np.where(half < mean, half**2 / np.where(mean > 0.0, mean, 1.0), half)


def _require_own(superelement: Superelement, pairs: ContactPairs, response: ForcedResponse, output: FloatArray) -> None:
    """Raise InputError for a response of another model, one with a control, or an output of another length."""
    # A sector of a disk has a size, but no mass matrix: it raises its own error.
    if response.n_unknowns != len(superelement.mass) or response.pairs.n_pairs != pairs.n_pairs:
        raise InputError(
            f"the response has {response.n_unknowns} unknowns and {response.pairs.n_pairs} pairs, but superelement and "
            f"pairs have {superelement.size} and {pairs.n_pairs}: give those with which it was computed.",
            arguments=["response"],
        )
    if np.ptp(response.load_factor) > 0.0:
        raise InputError(
            "the response is one at prescribed amplitude or phase; gradients are for peaks under a constant "
            "excitation, of forced_response.",
            arguments=["response"],
        )
    if output.shape != (superelement.size,) or not output.any():
        raise InputError(
            f"output must have shape ({superelement.size},) with an entry that is not zero.", arguments=["output"]
        )


def _chosen_peak(response: ForcedResponse, output: FloatArray, number: int) -> Peak:
    """The peak with this number. Raises InputError if there is none, ConvergenceError for an end of the curve."""
    tops = peaks(response.frequency_hz, response.amplitude(output), response.part)
    if whole_number("peak", number, 0) >= len(tops):
        raise InputError(
            f"peak is {number}, but the curve has {len(tops)} peaks of this output, numbered from 0.",
            arguments=["peak"],
        )
    if not tops[number].bracketed:
        raise ConvergenceError(
            f"the highest point of the curve, at {tops[number].frequency_hz:.2f} Hz, is at an end of it and no peak. "
            "Extend the frequency range."
        )
    return tops[number]


def _around(balance: Balance, response: ForcedResponse, peak: Peak) -> list[BalancePoint]:
    """The computed points around a peak."""
    curve, points = FrequencyCurve(balance), []
    for point in range(peak.point - 1, peak.point + 2):
        relative = with_rows((balance.pairs.operator @ response.displacement[point]).T, 2 * balance.harmonics + 1)
        relative[0] += response.pair_way(point).ravel()
        points.append(curve.at(relative, 2.0 * np.pi * float(response.frequency_hz[point])))
    return points


def _require_no_walk(balances: Balances, peak: RefinedPeak) -> None:
    if walking_points(balances.pairs, [peak.top.point.trial])[0].size:
        raise ConvergenceError(
            "a body that only friction supports slides on in each cycle at the peak: its position is arbitrary, and so "
            "are derivatives by it. Constrain the body along its free direction."
        )


def _result(sensitivity: PeakSensitivity, parameters: Sequence[Parameter], report: StageReport) -> PeakGradients:
    """The derivatives by all parameters that have one."""
    differentiated, derived, messages = [], [], []
    for number, parameter in enumerate(parameters):
        report.stage(f"gradient by {parameter.name}", 0.4 + 0.6 * number / len(parameters))
        try:
            derivatives = sensitivity.derivative(parameter)
        except InputError as error:
            messages.append(f"{parameter.name} has no derivative: {error}")
            continue
        differentiated.append(parameter)
        derived.append(derivatives)
    without = [each.name for each, its in zip(differentiated, derived, strict=True) if not its.value.any()]
    if without:
        messages.append(
            f"Small changes have no effect: {', '.join(without)}. A position at the nearest node of a mesh has none as "
            "long as this node is the same one."
        )
    by = np.array([each.value for each in derived]).reshape(-1, 3).T
    errors = np.array([each.error for each in derived]).reshape(-1, 3).T
    messages += [*_doubts(differentiated, derived, sensitivity.values), *sensitivity.peak.corners()]
    return PeakGradients(
        names=tuple(each.name for each in differentiated),
        units=tuple(each.unit for each in differentiated),
        value=np.array([each.value for each in differentiated]),
        **dict(zip(("amplitude", "frequency_hz", "friction_energy"), sensitivity.values, strict=True)),
        **dict(zip(("by_amplitude", "by_frequency_hz", "by_friction_energy"), by, strict=True)),
        **dict(zip(("error_amplitude", "error_frequency_hz", "error_friction_energy"), errors, strict=True)),
        messages=tuple(messages),
    )


def _doubts(parameters: Sequence[Parameter], derived: Sequence[_Derivatives], values: FloatArray) -> Iterator[str]:
    """A sentence on all derivatives that matter and have a large estimated error."""
    uncertain = []
    for place, name in enumerate(("amplitude", "frequency", "friction energy")):
        by = [
            f"{parameter.name} ({100.0 * each.error[place] / abs(each.value[place]):.0f} %)"
            for parameter, each in zip(parameters, derived, strict=True)
            if abs(REPORTED_CHANGE * parameter.value * each.value[place]) > NOTABLE_EFFECT * values[place] > 0.0
            and each.error[place] > LARGEST_ERROR * abs(each.value[place])
        ]
        if by:
            uncertain.append(f"of the peak {name} by {', '.join(by)}")
    if uncertain:
        yield (
            f"Derivatives that are uncertain, and by about how much: {'; '.join(uncertain)}. The contact changes its "
            "state close to the peak, or large effects cancel. Compute the peak again with a changed value before you "
            "use them."
        )
