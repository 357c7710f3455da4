"""Fractal dimension D and fractal roughness G from measured heights, by their structure function.

S(tau) = G^(2(D-2)) sum_n ln gamma lambda_n^(2(3-D)) [1 - J0(2 pi tau / lambda_n)] + c,   c: noise, or missing waves is
fitted to the structure function of detrended lines, with the loss by the detrending included. Lags of one profile are
correlated, so weights and intervals come from simulated surfaces. Derivation and checks: docs/theory_roughness_fit.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from math import exp, log

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from stickslip.contact.stiffness.asperities import LOG_LARGEST_NUMBER
from stickslip.contact.stiffness.detrended_lines import LineModel, measured_structure, wavelengths, without_trend
from stickslip.contact.stiffness.measured_lines import (
    Interval,
    MeasuredLines,
    line_sets,
    longest_wave_of,
    scale_range_of,
)
from stickslip.contact.stiffness.random_lines import LineSet, Spectrum, simulate
from stickslip.contact.stiffness.roughness_warnings import Evidence, warnings_of
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array, whole_number

LAGS_PER_DECADE = 8  # chosen: neighbouring lags are correlated, so more add little
FEWEST_LAGS = 5  # chosen: two more than the three parameters of the fit
MODEL_ERROR = 0.02  # relative, of S: ripple of separate waves, few directions
SIMULATIONS = 200  # surfaces for weights and intervals; theory page, section 3
WIDENING = 1.3  # surfaces like the fitted one can scatter less than those like the true one; theory page, section 4
HURST_RANGE = (0.02, 0.98)  # of H = 3 - D: the ends 0 and 1 themselves have no fractal surface
CONSTANT_RANGE = (-3.0, 3.0)  # of ln[1 + c / S at the shortest lag]


@dataclass(frozen=True)
class RoughnessFit:
    """D and G of a measured surface with their intervals, and further statistics of the measurement.

    Attributes
    ----------
    fractal_dimension, fractal_roughness:
        D of the surface, 2 < D < 3, and G in m.
    fractal_dimension_interval, fractal_roughness_interval:
        (low, high) of 95 %; the second in m.
    scale_range:
        (shortest, longest) lag of the fit, m.
    lag, structure_function, fitted:
        (n_lags,) m; m2 of detrended lines; m2 of the fit. For a map, the lags along x and then those along y.
    points_along_x:
        number of lags along x.
    noise_height:
        rms of uncorrelated heights, m; 0 unless the constant c of the fit is significantly above 0.
    rms_height:
        Sq in m about the mean lines.
    rms_slope, slope_scale:
        Sdq at the scale ``slope_scale`` in m: the slope of a line times sqrt(2), as on an isotropic surface.
    fit_probability:
        fraction of simulated surfaces of this D and G that fit worse.
    usable:
        False if D is at an end of its range: no surface of this law fits.
    warnings:
        messages, for example on a range too short for a power law.
    """

    fractal_dimension: float
    fractal_roughness: float
    fractal_dimension_interval: Interval
    fractal_roughness_interval: Interval
    scale_range: Interval
    lag: FloatArray
    structure_function: FloatArray
    fitted: FloatArray
    points_along_x: int
    noise_height: float
    rms_height: float
    rms_slope: float
    slope_scale: float
    fit_probability: float
    usable: bool
    warnings: tuple[str, ...]

    __repr__ = short_repr


def fit_roughness(
    heights: ArrayLike,
    spacing: float | Sequence[float],
    *,
    scales: Interval | None = None,
    longest_wave: float | None = None,
    seed: int = 0,
) -> RoughnessFit:
    """D, G and their 95 % intervals from a line (n,) or a map (n_y, n_x) of heights in m.

    ``spacing``
        distance of neighbouring points in m; for a map one number or (along y, along x).
    ``scales``
        shortest and longest lag in m; by default two spacings and a tenth of the line.
    ``longest_wave``
        in m, where the surface or a high-pass filter of the instrument ends; by default unbounded.
    ``seed``
        of the simulated surfaces; the same seed gives the same intervals.

    The mean straight line of every line is removed, and the fit accounts for the loss. Method:
    docs/theory_roughness_fit.md. Raises InputError for heights
    that are not finite, not a line or map, all on straight lines, or too few, and for values out of range.
    """
    parts = line_sets(finite_array("heights", heights), spacing)
    whole_number("seed", seed, 0)
    wave_end = longest_wave_of(longest_wave, parts)
    low, high = scale_range_of(scales, parts)
    rng = np.random.default_rng(seed)
    fitted = _Fitted.to(_Problem.build(parts, low, high, wave_end), rng)
    raised = False
    while scales is None:  # waves that the instrument does not resolve must be below the range
        shortest = fitted.problem.spectrum(fitted.best).shortest
        if shortest <= 2.0 * low or shortest > 0.3 * high:
            break
        low, raised = shortest, True
        fitted = _Fitted.to(_Problem.build(parts, low, high, wave_end), rng)
    return _evaluate_fit(fitted, rng, raised)


def _lags(place: LineSet, low: float, high: float) -> NDArray[np.intp]:
    """Lags in spacings, evenly spread over the logarithm, up to half the line."""
    first = max(round(low / place.spacing), 1)
    last = min(round(high / place.spacing), place.points // 2)
    if last <= first:
        return np.array([], dtype=np.intp)
    count = max(int(LAGS_PER_DECADE * np.log10(last / first)) + 1, 2)
    return np.unique(np.round(np.geomspace(first, last, count))).astype(np.intp)


@dataclass(frozen=True)
class _Problem:
    """Measured ln S of all directions, and the model of it: parameters H, ln G^(2(D-2)) and ln[1 + c / S_0]."""

    parts: tuple[MeasuredLines, ...]
    lags: tuple[NDArray[np.intp], ...]
    models: tuple[LineModel, ...]
    measured: FloatArray  # ln S at the lags of all parts
    flat: FloatArray  # factor of the constant c at each lag

    @classmethod
    def build(cls, parts: tuple[MeasuredLines, ...], low: float, high: float, longest_wave: float) -> _Problem:
        """Raises InputError if the range contains too few lags."""
        usable = [(part, lags) for part in parts if (lags := _lags(part.place, low, high)).size >= FEWEST_LAGS]
        if not usable:
            raise InputError(
                f"the scales from {low:.3g} m to {high:.3g} m contain fewer than {FEWEST_LAGS} lags of the "
                "measurement. Widen the range, or measure a longer line or with a smaller spacing."
            )
        waves = wavelengths(longest_wave, min(part.place.spacing for part, _ in usable))
        models = tuple(LineModel.build(part.place.points, part.place.spacing, waves, lags) for part, lags in usable)
        measured = np.concatenate([measured_structure(part.lines, lags) for part, lags in usable])
        flat = np.concatenate([model.flat for model in models])
        if not np.all(measured > 0):
            raise InputError(
                "the heights are equal at some lags, so S is 0 there. The resolution of the instrument is too coarse."
            )
        return cls(
            tuple(part for part, _ in usable),
            tuple(lags for _, lags in usable),
            models,
            np.log(measured),
            flat / flat[0],
        )

    @property
    def lag(self) -> FloatArray:
        """Lags in m."""
        return np.concatenate([part.place.spacing * lags for part, lags in zip(self.parts, self.lags, strict=True)])

    def shape(self, hurst: float) -> FloatArray:
        """S / G^(2(D-2)) without constant."""
        return np.concatenate([model.structure(hurst) for model in self.models])

    def log_structure(self, parameters: FloatArray) -> FloatArray:
        """ln S at the lags."""
        hurst, log_factor, bend = parameters
        shape = self.shape(hurst)
        return np.asarray(log_factor + np.log(shape + shape[0] * np.expm1(bend) * self.flat))

    def constant(self, parameters: FloatArray) -> float:
        """c in m2."""
        hurst, log_factor, bend = parameters
        first = self.models[0].flat[0]
        return float(exp(log_factor) * self.shape(hurst)[0] * np.expm1(bend) / first)

    def spectrum(self, parameters: FloatArray) -> Spectrum:
        """The spectrum of a surface with these parameters."""
        return Spectrum.of(self.models[0].waves, float(parameters[0]), exp(parameters[1]), self.constant(parameters))

    def first_guess(self) -> FloatArray:
        """Ordinary least squares on ln S, with slightly larger weights of short lags, which scatter less."""
        hurst = 0.5
        start = np.array([hurst, self.measured[0] - log(self.shape(hurst)[0]), 0.0])
        return self.fit(self.measured, np.diag((self.lag / self.lag[0]) ** -0.25), start)[0]

    def fit(self, measured: FloatArray, whitening: FloatArray, start: FloatArray) -> tuple[FloatArray, float]:
        """Least squares of ``whitening`` @ (measured - model): parameters and the sum of squares."""
        lower = [HURST_RANGE[0], -np.inf, CONSTANT_RANGE[0]]
        upper = [HURST_RANGE[1], np.inf, CONSTANT_RANGE[1]]
        inside = np.clip(start, np.array(lower) + 1e-6, np.array(upper) - 1e-6)
        solution = least_squares(
            lambda trial: whitening @ (measured - self.log_structure(trial)),
            inside,
            bounds=(lower, upper),
            x_scale=[0.1, 1.0, 0.5],
        )
        return np.asarray(solution.x), float(2.0 * solution.cost)

    def simulated(self, parameters: FloatArray, rng: np.random.Generator) -> FloatArray:
        """ln S of simulated surfaces (SIMULATIONS, n_lags), evaluated like the measured one."""
        surfaces = simulate(tuple(part.place for part in self.parts), self.spectrum(parameters), rng)
        rows = [
            np.concatenate(
                [measured_structure(without_trend(lines), lags) for lines, lags in zip(surface, self.lags, strict=True)]
            )
            for surface in islice(surfaces, SIMULATIONS)
        ]
        return np.asarray(np.log(np.array(rows)))


@dataclass(frozen=True)
class _Fitted:
    """The best parameters, with weights and shift from surfaces like the first guess."""

    problem: _Problem
    shift: FloatArray  # ln of a mean over few long waves lies below ln of its expectation
    whitening: FloatArray
    best: FloatArray
    misfit: float

    @classmethod
    def to(cls, problem: _Problem, rng: np.random.Generator) -> _Fitted:
        """Generalised least squares."""
        guess = problem.first_guess()
        trial = problem.simulated(guess, rng)
        shift = trial.mean(axis=0) - problem.log_structure(guess)
        covariance = np.cov(trial.T) + MODEL_ERROR**2 * np.eye(problem.measured.size)
        whitening = np.linalg.inv(np.linalg.cholesky(covariance))
        return cls(problem, shift, whitening, *problem.fit(problem.measured - shift, whitening, guess))


def _evaluate_fit(fitted: _Fitted, rng: np.random.Generator, raised: bool) -> RoughnessFit:
    """Intervals and statistics from the scatter of the fit over surfaces like the best one."""
    problem, best, misfit, shift = fitted.problem, fitted.best, fitted.misfit, fitted.shift
    again = problem.simulated(best, rng)
    outcomes = [problem.fit(row - shift, fitted.whitening, best) for row in again]
    scatter = np.array([parameters for parameters, _ in outcomes])
    dimensions, log_roughness = 3.0 - scatter[:, 0], _log_roughness(scatter)
    constants = np.array([problem.constant(row) for row in scatter])
    dimension, roughness = 3.0 - float(best[0]), float(_roughness(_log_roughness(best[None]))[0])
    low, high = _interval(dimension, dimensions)
    interval = (max(low, 2.0), min(high, 3.0))
    roughness_interval = _interval(float(_log_roughness(best[None])[0]), log_roughness)
    smallest, largest = (float(end) for end in _roughness(np.array(roughness_interval)))
    probability = float(np.mean([value >= misfit for _, value in outcomes]))
    constant = problem.constant(best)
    noisy = constant > 0.0 and float(np.quantile(constants, 0.025)) > 0.0
    usable = bool(HURST_RANGE[0] + 1e-3 < best[0] < HURST_RANGE[1] - 1e-3)
    lag, structure = problem.lag, np.exp(problem.measured)
    evidence = Evidence(
        dimension=dimension,
        dimension_interval=interval,
        roughness=roughness,
        usable=usable,
        scale_range=(float(lag.min()), float(lag.max())),
        points=max(part.place.points for part in problem.parts),
        trend_fraction=max(part.trend_fraction for part in problem.parts),
        noise_fraction=constant / structure[0] if noisy else 0.0,
        noise_height=(0.5 * constant) ** 0.5 if noisy else 0.0,
        raised=raised,
        probability=probability,
        direction_deviation=_direction_deviation(problem, again),
    )
    slope_scale, slope = _slope(problem)
    return RoughnessFit(
        fractal_dimension=dimension,
        fractal_roughness=roughness,
        fractal_dimension_interval=interval,
        fractal_roughness_interval=(smallest, largest),
        scale_range=evidence.scale_range,
        lag=lag,
        structure_function=structure,
        fitted=np.exp(problem.log_structure(best) + shift),
        points_along_x=sum(
            lags.size for part, lags in zip(problem.parts, problem.lags, strict=True) if part.place.along_x
        ),
        noise_height=evidence.noise_height,
        rms_height=float(np.sqrt(np.mean([np.mean(part.lines**2) for part in problem.parts]))),
        rms_slope=slope,
        slope_scale=slope_scale,
        fit_probability=probability,
        usable=usable,
        warnings=warnings_of(evidence),
    )


def _interval(best: float, scatter: FloatArray) -> Interval:
    """95 % of ``scatter`` about ``best``, widened."""
    low, high = (float(end) for end in np.quantile(scatter, [0.025, 0.975]))
    return best - WIDENING * max(best - low, 0.0), best + WIDENING * max(high - best, 0.0)


def _log_roughness(parameters: FloatArray) -> FloatArray:
    """ln G from ln G^(2(D-2)) and H = 3 - D, for parameters (n, 3)."""
    return np.asarray(parameters[:, 1] / (2.0 * (1.0 - parameters[:, 0])))


def _roughness(log_roughness: FloatArray) -> FloatArray:
    """G in m, bounded by the range of floating-point numbers where D is at its limit."""
    return np.asarray(np.exp(np.clip(log_roughness, -LOG_LARGEST_NUMBER, LOG_LARGEST_NUMBER)))


def _slope(problem: _Problem) -> tuple[float, float]:
    """Scale in m and Sdq at it: slope over the shortest lag, of both directions or sqrt(2) times that of one."""
    squares, scales, start = [], [], 0
    structure, lag = np.exp(problem.measured), problem.lag
    for lags in problem.lags:
        squares.append(structure[start] / lag[start] ** 2)
        scales.append(lag[start])
        start += lags.size
    return float(max(scales)), float(np.sqrt(2.0 * np.mean(squares)))


def _direction_deviation(problem: _Problem, simulated: FloatArray) -> float:
    """Mean ln S along x less that along y, in standard deviations of isotropic surfaces; 0 for one direction."""
    if len(problem.parts) == 1:
        return 0.0
    split = problem.lags[0].size
    shift = simulated[:, :split].mean(axis=1) - simulated[:, split:].mean(axis=1)
    difference = problem.measured[:split].mean() - problem.measured[split:].mean()
    return float((difference - shift.mean()) / shift.std())
