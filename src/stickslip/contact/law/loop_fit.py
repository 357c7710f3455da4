"""Tangential stiffness, friction limit and backlash of measured hysteresis loops, by least squares.

The model is a spring with play in series with a slider: with the relative displacement x and the slider s,

    e = x - s,   T = k_t sign(e) max(|e| - g / 2, 0),   |T| <= F,

so the slider follows x at the distance r = F / k_t + g / 2 (play operator). With g = 0 it is a Jenkins element. A cycle
of amplitude X dissipates 4 F (X - r), or nothing if X is below r.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from stickslip.contact.law.measured_loops import FORCE_PERCENTILES, Loops
from stickslip.core.compiled import njit
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, positive_number

Interval = tuple[float, float]

# Two-sided 95 % of a normal distribution: a loop has hundreds of samples.
NORMAL_95 = 1.96
# chi-square with one degree of freedom, 99 %: a backlash of zero is reported as one in 1 % of measurements.
BACKLASH_SIGNIFICANCE = 6.63
# chosen: starts of the search, as fractions of the amplitude: distance of elastic motion, and backlash.
ELASTIC_STARTS = (0.01, 0.03, 0.1, 0.3)
BACKLASH_STARTS = (0.0, 0.1, 0.3, 0.8)
# chosen: fewer samples of the elastic part of a cycle do not determine its slope.
FEWEST_ELASTIC = 6
# chosen: above this misfit the loops have another shape than the model.
LARGEST_MISFIT = 0.2


@dataclass(frozen=True)
class LoopFit:
    """Constants of a spring with play and a slider, with 95 % intervals (:func:`fit_loops`).

    Attributes
    ----------
    tangential_stiffness, friction_limit, backlash:
        N/m, N, m; the backlash is the complete free travel, 0 if the loops do not show one.
    tangential_stiffness_interval, friction_limit_interval, backlash_interval:
        (low, high) of 95 %, from the scatter about the model and its correlation along the loop. They do not contain
        errors of the sensors, such as a wrong scale.
    normal_load, friction_coefficient, friction_coefficient_interval:
        N, and the friction limit over it; None without a normal load.
    force_offset:
        N, mean force that the model does not explain; subtracted from all forces.
    misfit, misfit_without_backlash:
        rms of the force that the model, and the Jenkins element, do not explain, over the rms of the force.
    displacement, force, fitted:
        (n,) m, N, N of the complete cycles, without the offset.
    cycle_amplitude, cycle_energy, fitted_energy:
        (n_cycles,) m, 0-to-peak; J in each cycle, measured and of the model.
    samples_per_independent:
        number of neighbouring samples whose scatter counts as one.
    warnings:
        messages.
    """

    tangential_stiffness: float
    friction_limit: float
    backlash: float
    tangential_stiffness_interval: Interval
    friction_limit_interval: Interval
    backlash_interval: Interval
    force_offset: float
    misfit: float
    misfit_without_backlash: float
    displacement: FloatArray = field(repr=False)
    force: FloatArray = field(repr=False)
    fitted: FloatArray = field(repr=False)
    cycle_amplitude: FloatArray = field(repr=False)
    cycle_energy: FloatArray = field(repr=False)
    fitted_energy: FloatArray = field(repr=False)
    samples_per_independent: float
    normal_load: float | None = None
    warnings: tuple[str, ...] = ()

    __repr__ = short_repr

    @property
    def friction_coefficient(self) -> float | None:
        """Friction limit over normal load."""
        return None if self.normal_load is None else self.friction_limit / self.normal_load

    @property
    def friction_coefficient_interval(self) -> Interval | None:
        """95 %; the normal load counts as exact."""
        if self.normal_load is None:
            return None
        low, high = self.friction_limit_interval
        return low / self.normal_load, high / self.normal_load

    def energy_per_cycle(self, amplitude: float, normal_load: float | None = None) -> float:
        """J that a cycle of an amplitude (m, 0-to-peak) dissipates: ``4 F (X - F / k_t - g / 2)``, at least 0.

        With ``normal_load`` (N), F is the friction coefficient times it: stiffness and backlash do not change. Raises
        InputError if the fit has no normal load.
        """
        reach = positive_number("amplitude", amplitude, "m")
        limit = self.friction_limit
        if normal_load is not None:
            load = positive_number("normal_load", normal_load, "N")
            if self.normal_load is None:
                raise InputError(
                    "the fit has no normal load, so its friction coefficient is unknown. Give normal_load to "
                    "fit_loops.",
                    arguments=["normal_load"],
                )
            limit *= load / self.normal_load
        return 4.0 * limit * max(0.0, reach - limit / self.tangential_stiffness - 0.5 * self.backlash)


def fit_loops(displacement: ArrayLike, force: ArrayLike, *, normal_load: float | None = None) -> LoopFit:
    """Fit a Jenkins element, with backlash where the loops show one, to measured hysteresis loops.

    Parameters
    ----------
    displacement, force:
        (n,) m and N in the order of time: relative displacement, and the force along it that moves the joint. At least
        one cycle, each with 20 samples or more; amplitudes may differ.
    normal_load:
        N, constant during the measurement, for the friction coefficient.

    Returns
    -------
    LoopFit
        constants with 95 % intervals. The displacement counts as exact.

    Raises
    ------
    InputError
        for arrays of unequal length or with an entry that is not finite, no closed cycle, too few samples, a force
        that gives energy to the motion, or loops without sliding.
    """
    loops = Loops.of(displacement, force)
    load = None if normal_load is None else positive_number("normal_load", normal_load, "N")
    jenkins, played = (_Search(loops, backlash).run() for backlash in (False, True))
    independent = loops.force.size / played.correlation_length
    gain = independent * (jenkins.squares - played.squares) / max(played.squares, np.finfo(float).tiny)
    chosen = played if gain > BACKLASH_SIGNIFICANCE else jenkins
    low = chosen.constants - NORMAL_95 * chosen.deviation
    high = chosen.constants + NORMAL_95 * chosen.deviation
    scale = math.sqrt(float(np.mean((loops.force - loops.force.mean()) ** 2)))
    result = LoopFit(
        tangential_stiffness=chosen.stiffness,
        friction_limit=chosen.limit,
        backlash=chosen.backlash,
        tangential_stiffness_interval=(math.exp(low[0]), math.exp(high[0])),
        friction_limit_interval=(math.exp(low[1]), math.exp(high[1])),
        backlash_interval=(max(0.0, float(low[3])), float(high[3])),
        force_offset=chosen.offset,
        misfit=math.sqrt(chosen.squares / loops.force.size) / scale,
        misfit_without_backlash=math.sqrt(jenkins.squares / loops.force.size) / scale,
        displacement=loops.displacement,
        force=loops.force - chosen.offset,
        fitted=loops.force - chosen.offset - chosen.residual,
        cycle_amplitude=loops.amplitudes(),
        cycle_energy=loops.energies(loops.force),
        fitted_energy=loops.energies(loops.force - chosen.residual),
        samples_per_independent=chosen.correlation_length,
        normal_load=load,
    )
    return replace(result, warnings=_warnings(loops, result))


@dataclass(frozen=True)
class _Solution:
    """Least squares of one model: ln k_t, ln F, offset (N), backlash (m) with standard deviations, residual (n,) N."""

    constants: FloatArray
    deviation: FloatArray
    residual: FloatArray
    correlation_length: float

    @property
    def stiffness(self) -> float:
        return math.exp(self.constants[0])

    @property
    def limit(self) -> float:
        return math.exp(self.constants[1])

    @property
    def offset(self) -> float:
        return float(self.constants[2])

    @property
    def backlash(self) -> float:
        return float(self.constants[3])

    @property
    def squares(self) -> float:
        return float(self.residual @ self.residual)


@dataclass(frozen=True)
class _Search:
    """Least squares of the loops, with a backlash or with none."""

    loops: Loops
    with_backlash: bool

    def run(self) -> _Solution:
        """The best of the starts, refined."""
        force, reach = self.loops.force, 0.5 * float(np.ptp(self.loops.displacement))
        level, middle = 0.5 * float(np.ptp(np.percentile(force, FORCE_PERCENTILES))), float(np.median(force))
        plays = BACKLASH_STARTS if self.with_backlash else (0.0,)
        starts = [
            np.array([math.log(level / (part * reach)), math.log(level), 0.0, play])
            for part in ELASTIC_STARTS
            for play in plays
        ]
        # Offset and backlash as fractions of force and amplitude: all unknowns then have sizes near one.
        unit = np.array([1.0, 1.0, level, reach])
        base = np.array([0.0, 0.0, middle, 0.0])
        free = slice(0, 4 if self.with_backlash else 3)

        def residual(unknowns: FloatArray) -> FloatArray:
            values = np.zeros(4)
            values[free] = unknowns
            return self._residual(base + unit * values) / level

        best = min(starts, key=lambda start: float(np.sum(residual(start[free]) ** 2)))
        least = np.full(4, -np.inf)
        least[3] = 0.0
        solution = least_squares(residual, best[free], bounds=(least[free], np.inf), diff_step=1e-5, jac="3-point")
        values, deviation = np.zeros(4), np.zeros(4)
        values[free] = solution.x
        length = correlation_length(solution.fun)
        variance = length * float(solution.fun @ solution.fun) / max(1, solution.fun.size - solution.x.size)
        deviation[free] = np.sqrt(variance * np.diag(np.linalg.pinv(solution.jac.T @ solution.jac)))
        constants = base + unit * values
        return _Solution(constants, unit * deviation, self._residual(constants), length)

    def _residual(self, constants: FloatArray) -> FloatArray:
        """(n,) N, force minus model."""
        stiffness, limit, offset, backlash = math.exp(constants[0]), math.exp(constants[1]), *constants[2:]
        model = loop_force(self.loops.settled, stiffness, limit, backlash)
        return np.asarray(self.loops.force - offset - model[self.loops.kept])


@njit(cache=True)
def loop_force(displacement: FloatArray, stiffness: float, limit: float, backlash: float) -> FloatArray:
    """(n,) N of the model along a path (n,) m, with the slider at the first displacement."""
    force = np.empty_like(displacement)
    slider = displacement[0]
    half = 0.5 * backlash
    reach = limit / stiffness + half
    for i in range(displacement.size):
        slider = min(max(slider, displacement[i] - reach), displacement[i] + reach)
        stretch = displacement[i] - slider
        force[i] = stiffness * (stretch - min(max(stretch, -half), half))
    return force


def correlation_length(residual: FloatArray) -> float:
    """Samples that count as one: 1 + 2 sum of the autocorrelation to its first value below zero; 1 for white noise.

    The variance of a mean of n correlated values is that of n / length independent ones.
    """
    spread = residual - residual.mean()
    spectrum = np.abs(np.fft.rfft(spread, 2 * spread.size)) ** 2
    covariance = np.fft.irfft(spectrum)[: spread.size]
    if covariance[0] <= 0.0:
        return 1.0
    correlation = covariance / covariance[0]
    negative = np.flatnonzero(correlation <= 0.0)
    end = int(negative[0]) if negative.size else correlation.size
    return float(1.0 + 2.0 * correlation[1:end].sum())


def _warnings(loops: Loops, fit: LoopFit) -> tuple[str, ...]:
    """Messages on constants that the measurement hardly determines, and on a shape that the model does not have."""
    sentences = []
    elastic = np.abs(np.abs(fit.fitted) - 0.5 * fit.friction_limit) < 0.499 * fit.friction_limit
    each = elastic.sum() / loops.count
    if each < FEWEST_ELASTIC:
        sentences.append(
            f"The elastic part of a cycle has {each:.1f} samples on average, so the tangential stiffness is uncertain. "
            "Sample faster, or move more slowly at the reversals."
        )
    if fit.misfit > LARGEST_MISFIT:
        sentences.append(
            f"The model does not explain {100.0 * fit.misfit:.0f} % (rms) of the force. The loops have another shape, "
            "for example because the friction changes along the path. The intervals are those of the best fit."
        )
    return tuple(sentences)
