"""Values at a point of a frequency curve whose derivatives are of interest: amplitude, frequency, friction energy.

Each value is a function of the relative displacements x, the deviation d of the contact force and the circular
frequency w; the balance (``balance.py``) joins the three.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.optimize

from stickslip.core.fourier import synthesis_matrix, synthesis_row
from stickslip.core.validation import FloatArray
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.harmonic.balance import Balance, Trial

# Samples of the period for the instant of the largest displacement, which is then refined.
INSTANTS = 512


@dataclass(frozen=True)
class PointValue:
    """A value of a point with its derivatives.

    Attributes
    ----------
    value:
        the value.
    by_relative, by_deviation:
        (2H+1, m) by x at fixed d, and by d at fixed x.
    by_omega:
        by the circular frequency, at fixed x and d.
    by_force:
        (2H+1, m) by the contact force at fixed x, where the force changes by its constants.
    by_coefficients:
        (2H+1,) by the Fourier coefficients of the output, (0,) if the value does not depend on the output.
    """

    value: float
    by_relative: FloatArray
    by_deviation: FloatArray
    by_omega: float
    by_force: FloatArray
    by_coefficients: FloatArray


def output_amplitude(balance: Balance, trial: Trial, output: FloatArray) -> PointValue:
    """The 0-to-peak amplitude of ``output @ u``, mean included: the largest absolute value over the period."""
    coefficients = balance.displacement([trial])[0] @ output
    weights = _weights_of_largest(coefficients)
    compliance = balance.compliance
    modal = weights[1:, None] * compliance.output_modes(output)
    by_deviation = compliance.amplitude_transposed(trial.omega, modal)
    by_deviation[0] = weights[0] * compliance.mean_transposed(output)
    by_omega = float((modal * balance.amplitude_slope(trial)).sum())
    still = np.zeros_like(by_deviation)
    return PointValue(float(weights @ coefficients), still, by_deviation, by_omega, still, weights)


def _weights_of_largest(coefficients: FloatArray) -> FloatArray:
    """(2H+1,) weights whose sum with the coefficients is the largest absolute value of the signal.

    They are also its derivative, because the signal is stationary at this instant.
    """
    return max((weights_of_extreme(coefficients, sign) for sign in (1.0, -1.0)), key=lambda each: each @ coefficients)


def weights_of_extreme(coefficients: FloatArray, sign: float) -> FloatArray:
    """The same for the largest value of ``sign`` times the signal."""
    harmonics = len(coefficients) // 2
    order = np.arange(1, harmonics + 1)
    signal = sign * (synthesis_matrix(harmonics, INSTANTS) @ coefficients)
    step = 2.0 * np.pi / INSTANTS
    angle = step * int(signal.argmax())

    def slope(at: float) -> float:
        row = np.zeros(2 * harmonics + 1)
        row[1::2], row[2::2] = -order * np.sin(order * at), order * np.cos(order * at)
        return float(sign * row @ coefficients)

    ends = angle - step, angle + step
    if slope(ends[0]) > 0.0 > slope(ends[1]):
        angle = float(scipy.optimize.brentq(slope, *ends, xtol=1e-15))
    return sign * synthesis_row(harmonics, angle)


def frequency(trial: Trial) -> PointValue:
    """The frequency in Hz."""
    still = np.zeros_like(trial.relative)
    by_omega = 1.0 / (2.0 * np.pi)
    return PointValue(by_omega * trial.omega, still, still, by_omega, still, np.empty(0))


def friction_energy(trial: Trial) -> PointValue:
    """J per cycle that friction dissipates: ``pi sum_h h (s_h f_ch - c_h f_sh)`` over t1 and t2 of all pairs.

    Springs do no work in a period, so the deviation replaces the force f in it.
    """
    count = len(trial.relative) // 2
    factor = np.pi * np.arange(1, count + 1)[:, None]
    tangential = np.tile([1.0, 1.0, 0.0], trial.relative.shape[1] // 3)

    def turned(coefficients: FloatArray) -> FloatArray:
        """Rows cos: ``pi h`` times the sine; rows sin: minus the cosine."""
        answer = np.zeros_like(coefficients)
        answer[1::2] = factor * coefficients[2::2] * tangential
        answer[2::2] = -factor * coefficients[1::2] * tangential
        return answer

    by_deviation = turned(trial.relative)
    value = float((by_deviation * trial.deviation).sum())
    return PointValue(value, -turned(trial.deviation), by_deviation, 0.0, by_deviation, np.empty(0))


def amplitude_of(balance: Balance, trial: Trial, output: FloatArray) -> float:
    """The amplitude alone."""
    return float(periodic_amplitude((balance.displacement([trial])[0] @ output)[None])[0])
