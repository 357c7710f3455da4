"""A maximum of an output along a frequency curve, with the stationarity of the amplitude as a further equation.

Along the curve ``R(x, w) = 0`` the phase lag ``s`` of the motion is the coordinate: it turns by 180 degrees through a
resonance, also where the curve folds. The tangent ``t = (x', w')`` per radian of lag solves a bordered system,

    [R_x  R_w] t = 0,    lag(t) = 1,

and the condition of a maximum is ``g' = grad(log amplitude) . t = 0`` with ``g'' < 0``. The amplitude is the largest
absolute value over the period; at fixed instant its gradient is that of the output (envelope theorem). Of a linear
resonance ``g = log(cos(s)) + constant``, so ``g'' = -1`` at its peak. ``g''`` is the difference of slopes between
points of the curve: sampled forces change slope when a sample changes its state, and only a difference over many such
events contains the shift of the instants of slip (docs/theory_ridge.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.optimize

from stickslip.core.fourier import synthesis_row
from stickslip.core.validation import FloatArray
from stickslip.results.periodic_amplitude import periodic_maximum
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.compliance import ExternalForce
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve, amplitude_row
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem
from stickslip.solve.path.newton import Newton
from stickslip.solve.path.problem import Plane, Step

# chosen: relative rise of the amplitude from the last point to the peak that a parabola supplies. Half of it is wrong
# at most where sampling blurs the curvature: 0.01 %.
LAST_RISE = 2e-4
# chosen: largest step along the curve in rad of lag, and the largest way of a search: beyond it is another peak.
LARGEST_STEP, LONGEST_WAY = 0.4, 1.2
# A linear resonance has the slope tan(lag): beyond this one the point is more than 70 degrees from its peak.
STEEPEST = 3.0
# A curvature from points closer than the first distance of BRACKET is blurred by samples: at most that of a linear
# resonance is sure. A search that believed -10 there ended 0.2 % below the peak.
LINEAR = -1.0
# chosen: range of curvatures that a step assumes; differences between points close together are blurred by sampling.
FLATTEST, SHARPEST = -0.3, -10.0
# chosen: iterations may leave the frequency range by this factor.
MARGIN = 1.1
# chosen: fractions of a step, until Newton's method converges.
SHORTENED = (1.0, 0.4, 0.15)
# chosen: most points of one search; a smooth peak needs two or three.
MOST_PROBES = 14
# chosen: most steps of one search that Newton's method does not make; those that find a peak after more take longer
# than a search from a closer estimate.
MOST_FAILURES = 5
# chosen: a trial in a bracket stays away from its ends by this fraction.
INSIDE = 0.1
# chosen: digits of a tangent.
TANGENT_TOLERANCE = 1e-6
# Relative accuracy of an exact peak, near round-off: derivatives of a peak are wrong by the first power of it.
PLACE = 1e-13
# chosen: distances in rad of lag at which the slope may have the sign of its side; the first one is a tenth of the
# width of a resonance, so that the curvature is not that of single samples.
BRACKET = (0.1, 0.2, 0.4)
# Largest slope at an exact peak, over the width. The force is sampled, so the slope jumps by about 2 / samples where a
# sample begins to slip; chosen: ten times the jump with 1024 samples. A change of contact has a slope above 0.1.
FLAT = 0.02
ANOTHER_PEAK = "the peak becomes another one"


class _NoPointError(Exception):
    """No point of the curve was found where one is required."""


@dataclass(frozen=True)
class Probe:
    """A point of the curve: amplitude of the output, slope ``g'`` of its logarithm by the lag, and the tangent."""

    point: BalancePoint
    amplitude: float
    slope: float
    tangent: Step
    iterations: int
    lag: float = 0.0  # rad, from the first point of the search


@dataclass(frozen=True)
class CurvePeak:
    """A maximum of the amplitude along a frequency curve.

    ``probe`` is its last computed point, ``curvature`` is g'' there; ``is_corner``: slopes of both signs meet, so that
    the curve has a corner at the peak. ``iterations`` are those of Newton's method in the whole search.
    """

    probe: Probe
    amplitude: float
    omega: float
    curvature: float
    is_corner: bool
    iterations: int

    @property
    def harmonics(self) -> int:
        """The number of harmonics."""
        return len(self.probe.point.trial.amplitude) // 2


class BoundedCurve(FrequencyCurve):
    """A frequency curve on which iterations that leave a ``window`` (rad/s, rising) by far stop, before they reach
    frequencies that cost much and mean nothing. ``on_evaluation`` hears of each evaluation."""

    def __init__(self, balance: Balance, last: LastFactor, window: tuple[float, float]) -> None:
        super().__init__(balance, last=last)
        self.window = window
        self.on_evaluation: Callable[[], None] = lambda: None

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> BalancePoint:
        self.on_evaluation()
        omega = float(parameters[0])
        if self.window[0] / MARGIN <= omega <= self.window[1] * MARGIN:
            return super().evaluate(unknowns, parameters)
        inside = min(max(omega, self.window[0]), self.window[1]) if math.isfinite(omega) else self.window[0]
        return replace(super().evaluate(unknowns, np.array([inside])), parameters=parameters, error=math.inf)


class PeakSearch:
    """Searches maxima of one output along one frequency curve.

    ``mean_row`` gives the row of the output for the mean of a trial, without the way of a body that walks; searches at
    other values may share the ``last`` factor. A parabola supplies at most ``last_rise`` of the amplitude, unless
    :meth:`exact` refines the peak; slopes are as accurate as the ``tangent_tolerance``.
    """

    def __init__(
        self,
        curve: BoundedCurve,
        newton: Newton[BalancePoint],
        output: FloatArray,
        mean_row: Callable[[Trial], FloatArray],
        last: LastFactor,
        last_rise: float = LAST_RISE,
        tangent_tolerance: float = TANGENT_TOLERANCE,
    ) -> None:
        self.curve = curve
        self._newton = newton
        self._modes = curve.balance.compliance.output_modes(output)
        self._mean_row = mean_row
        self.last_factor = last
        self._last_rise, self._tangent_tolerance = last_rise, tangent_tolerance
        self.on_point: Callable[[], None] = lambda: None

    @property
    def balance(self) -> Balance:
        """The balance of the curve."""
        return self.curve.balance

    def from_estimate(
        self, unknowns: FloatArray, omega: float, across: Step, curvature: float, highest: float = math.inf
    ) -> CurvePeak | str:
        """The peak near an estimate; Newton's method begins in the plane across a tangent. Or why there is none.

        A search that comes above the ``highest`` amplitude is at another peak, and stops.
        """
        probe = self._corrected(self.curve.at(unknowns, omega), across)
        if probe is None:
            return "Newton's method did not converge from the estimate"
        return self._search(probe, curvature, highest)

    def from_point(self, point: BalancePoint) -> CurvePeak | str:
        """The peak near a point of the curve, or why there is none."""
        return self._search(self._probe(point, 0), -1.0)

    def exact(self, peak: CurvePeak) -> CurvePeak | str:
        """The peak where the slope is zero to round-off, from a search; its curvature is that over ``BRACKET``.

        The points are those in the planes across one tangent. A corner whose slopes are small, of a sampled force,
        counts as a peak.
        """
        base = peak.probe
        found = {0.0: base}

        def at(length: float) -> Probe:
            """The point in the plane at a distance, in rad of lag, from the nearest one."""
            if length not in found:
                nearest = min(found, key=lambda each: abs(each - length))
                probe = self._stepped(found[nearest], length - nearest, base.tangent, length)
                if probe is None or not math.isfinite(probe.slope):
                    raise _NoPointError
                found[length] = probe
            return found[length]

        try:
            ends = [
                next((length for length in BRACKET if sign * at(sign * length).slope < 0.0), None)
                for sign in (1.0, -1.0)
            ]
            if ends[0] is None or ends[1] is None:
                return "the amplitude does not rise on one side of the peak and fall on the other"
            high, low = ends[0], -ends[1]
            place = float(scipy.optimize.brentq(lambda length: at(length).slope, low, high, xtol=PLACE * (high - low)))
            probe, curvature = at(place), (at(high).slope - at(low).slope) / (high - low)
        except _NoPointError:
            return "Newton's method did not converge close to the peak"
        if abs(probe.slope) > FLAT * math.sqrt(-curvature):
            return "the curve has a corner at its peak: the contact changes its state there"
        iterations = peak.iterations + sum(each.iterations for each in found.values())
        return CurvePeak(probe, probe.amplitude, float(probe.point.parameters[0]), curvature, False, iterations)

    def _corrected(self, guess: BalancePoint, across: Step) -> Probe | None:
        """Newton's method in the plane through a guess, across a tangent."""
        normal = self.curve.determined(across.unknowns)
        size = float(np.linalg.norm(normal))
        omega = float(guess.parameters[0])
        if size > 0.0:
            plane = Plane(normal / size**2, 0.0, guess.unknowns, omega)
        else:  # the relative motion does not change along the curve: the frequency remains
            plane = Plane.fixed(guess.unknowns, omega)
        with np.errstate(over="ignore", invalid="ignore"):  # of an iteration that diverges
            correction = self._newton.correct(guess, plane)
        return self._probe(correction.point, correction.iterations) if correction.converged else None

    def _probe(self, point: BalancePoint, iterations: int) -> Probe:
        """Amplitude, slope and tangent at a point of the curve."""
        self.on_point()
        trial = point.trial
        system, _, by_omega = self._linearised(trial)
        tangent = system.solve(np.zeros_like(trial.residual), np.ones(1), self._tangent_tolerance)
        if not np.isfinite(tangent.parameters).all():
            return Probe(point, math.nan, math.nan, tangent, iterations)
        change = self.balance.compliance.amplitude(trial.omega, None, tangent.detail)
        change += float(tangent.parameters[0]) * by_omega
        amplitude, slope = self._amplitude_and_slope(trial, change, tangent.detail)
        return Probe(point, amplitude, slope, tangent, iterations)

    def rise(self, probe: Probe, force: FloatArray, contact_force: FloatArray) -> float:
        """Rise of the logarithm of the amplitude with a change of the equations, per unit of the change, at fixed lag.

        At fixed motion, the modal force (2H, n) grows by ``force``, the contact force (2H+1, m) by ``contact_force``.
        At a peak the amplitude has no slope along the curve, so this is the rise of the peak (envelope theorem). Not a
        number where the equations are singular.
        """
        balance, trial = self.balance, probe.point.trial
        system, lag, by_omega = self._linearised(trial)
        answer = balance.compliance.amplitude(trial.omega, ExternalForce(force), contact_force)
        residual = -balance.compliance.relative(answer, contact_force)
        turned = np.array([-float(np.vdot(lag, answer))])
        step = system.solve(residual, turned, self._tangent_tolerance)
        if not np.isfinite(step.parameters).all():
            return math.nan
        change = answer + balance.compliance.amplitude(trial.omega, None, step.detail)
        change += float(step.parameters[0]) * by_omega
        return self._amplitude_and_slope(trial, change, step.detail + contact_force)[1]

    def _linearised(self, trial: Trial) -> tuple[BorderedSystem, FloatArray, FloatArray]:
        """The equations with a prescribed change of the lag, the weights (2H, n) of the lag, and the derivative (2H, n)
        of the modal amplitudes by the frequency."""
        by_omega, lag = self.balance.amplitude_slope(trial), _lag_weights(trial.amplitude)
        rows = [amplitude_row(self.balance, trial, lag, [by_omega])]
        system = NewtonSystem(self.balance, trial)
        return (
            BorderedSystem(system, [self.balance.residual_slope(by_omega)], rows, self.last_factor),
            lag,
            by_omega,
        )

    def _amplitude_and_slope(self, trial: Trial, change: FloatArray, deviation: FloatArray) -> tuple[float, float]:
        """The amplitude of the output, and the change of its logarithm with those of modal amplitudes and deviation."""
        signal = self._coefficients(trial, trial.amplitude, trial.deviation)
        moved = self._coefficients(trial, change, deviation)
        (amplitude,), (angle,) = periodic_maximum(signal[None])
        at = synthesis_row(self.balance.harmonics, float(angle))
        return float(amplitude), float(at @ moved) / float(at @ signal) if amplitude > 0.0 else math.nan

    def amplitude(self, trial: Trial) -> float:
        """0-to-peak amplitude of the output."""
        return float(periodic_maximum(self._coefficients(trial, trial.amplitude, trial.deviation)[None])[0][0])

    def _coefficients(self, trial: Trial, amplitude: FloatArray, deviation: FloatArray) -> FloatArray:
        """(2H+1,) coefficients of the output for modal amplitudes (2H, n) and deviations, or for their changes."""
        mean = 0.0
        if deviation[0].any():
            mean = float(self.balance.compliance.mean_transposed(self._mean_row(trial)) @ deviation[0])
        return np.append(mean, amplitude @ self._modes)

    def _search(self, probe: Probe, curvature: float, highest: float = math.inf) -> CurvePeak | str:
        """Climb along the curve to the maximum, and enclose it."""
        rising: Probe | None = None  # the best point before the maximum, with slope above zero
        falling: Probe | None = None
        iterations, sure, failures = probe.iterations, max(curvature, LINEAR), 0
        if abs(probe.slope) > STEEPEST:
            return "the estimate is far from a maximum"
        for count in range(1, MOST_PROBES + 1):
            if not (math.isfinite(probe.slope) and probe.amplitude > 0.0):
                return "the tangent of the frequency curve is not determined"
            if probe.amplitude > highest:
                return ANOTHER_PEAK
            if probe.slope >= 0.0:
                rising = probe
            else:
                falling = probe
            if sure < 0.0 and probe.slope**2 <= 2.0 * self._last_rise * -sure:
                return self._inside(_peak_of(probe, curvature, False, iterations))
            if rising is not None and falling is not None:
                if _rise_of_corner(rising, falling) <= self._last_rise:
                    best = max(rising, falling, key=lambda each: each.amplitude)
                    return self._inside(_peak_of(best, curvature, True, iterations))
                step = _inside_bracket(rising, falling, count % 2 == 0) - probe.lag
            else:
                wanted = probe.slope / -min(FLATTEST, max(SHARPEST, curvature))
                step = math.copysign(min(abs(wanted), LARGEST_STEP), probe.slope)
            if abs(probe.lag + step) > LONGEST_WAY:
                return "the amplitude has no maximum near the estimate"
            after, failed = self._moved(probe, step, MOST_FAILURES - failures)
            if after is None:
                return "Newton's method did not converge on the way to the maximum"
            failures += failed
            iterations += after.iterations
            curvature = (after.slope - probe.slope) / (after.lag - probe.lag)
            sure = curvature if abs(after.lag - probe.lag) >= BRACKET[0] else max(curvature, LINEAR)
            probe = after
        return "the search for the maximum did not converge"

    def _inside(self, peak: CurvePeak) -> CurvePeak | str:
        """The peak if it is in the window."""
        low, high = self.curve.window
        if low <= peak.omega <= high:
            return peak
        return f"the peak leaves the frequency range, at {peak.omega / (2.0 * math.pi):.2f} Hz"

    def _moved(self, probe: Probe, step: float, most_failures: int) -> tuple[Probe | None, int]:
        """The point near a lag, from a tangent, and the number of failures before it; Newton's method may turn the
        motion farther than planned."""
        for failures, fraction in enumerate(SHORTENED[: most_failures + 1]):
            length = fraction * step
            after = self._stepped(probe, length, probe.tangent, probe.lag + length)
            if after is not None:
                return replace(after, lag=probe.lag + _turned(probe, after)), failures
        return None, len(SHORTENED)

    def _stepped(self, probe: Probe, length: float, tangent: Step, lag: float) -> Probe | None:
        """The point a step along a tangent ahead, in the plane across it; ``lag`` is its coordinate."""
        guess = self.curve.at(
            probe.point.unknowns + length * tangent.unknowns,
            float(probe.point.parameters[0] + length * tangent.parameters[0]),
        )
        after = self._corrected(guess, tangent)
        return None if after is None else replace(after, lag=lag)


def _lag_weights(amplitude: FloatArray) -> FloatArray:
    """(2H, n) derivative of the phase lag by the modal amplitudes: the shift in time that fits a change best, as an
    angle of the first harmonic."""
    turned = delayed(amplitude)
    size = float((turned**2).sum())
    return turned / size if size > 0.0 else turned


def delayed(amplitude: FloatArray) -> FloatArray:
    """(2H, n) derivative of coefficients (2H, n) by a shift in time, as an angle of the first harmonic."""
    order = np.repeat(np.arange(1, len(amplitude) // 2 + 1), 2)[:, None]
    turned = np.empty_like(amplitude)
    turned[0::2], turned[1::2] = -amplitude[1::2], amplitude[0::2]
    return turned * order


def _turned(before: Probe, after: Probe) -> float:
    """The lag between two points of the curve, rad, by the mean of the weights at both."""
    first, second = before.point.trial.amplitude, after.point.trial.amplitude
    return 0.5 * float(np.vdot(_lag_weights(first) + _lag_weights(second), second - first))


def _peak_of(probe: Probe, curvature: float, is_corner: bool, iterations: int) -> CurvePeak:
    """The maximum of the parabola at the last point; a corner is that point."""
    ahead = 0.0 if is_corner else -probe.slope / curvature
    omega = float(probe.point.parameters[0] + ahead * probe.tangent.parameters[0])
    amplitude = probe.amplitude * math.exp(0.5 * ahead * probe.slope)
    return CurvePeak(probe, amplitude, omega, curvature, is_corner, iterations)


def _corner(rising: Probe, falling: Probe) -> float:
    """The lag, from the rising end of a bracket, at which the tangents of its ends intersect."""
    width = falling.lag - rising.lag
    drop = math.log(falling.amplitude / rising.amplitude)
    return (drop - falling.slope * width) / (rising.slope - falling.slope)


def _rise_of_corner(rising: Probe, falling: Probe) -> float:
    """Rise of the logarithm from the higher end of a bracket to the intersection of its tangents: a concave curve does
    not rise more."""
    ends = math.log(rising.amplitude), math.log(falling.amplitude)
    return ends[0] + rising.slope * _corner(rising, falling) - max(ends)


def _inside_bracket(rising: Probe, falling: Probe, is_corner: bool) -> float:
    """A lag in a bracket: where the slope, linear between its ends, is zero; or at the corner of the tangents."""
    width = falling.lag - rising.lag
    ahead = _corner(rising, falling) if is_corner else width * rising.slope / (rising.slope - falling.slope)
    return rising.lag + min((1.0 - INSIDE) * width, max(INSIDE * width, ahead))
