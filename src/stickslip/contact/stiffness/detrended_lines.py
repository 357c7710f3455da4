"""Structure function of lines without their mean straight line: measured, and expected for a fractal surface.

Removing a trend reduces S at long lags. The loss is a linear function of the structure function S itself, so the
expected value after removal is exact for every wave: with the covariance C = -S/2 (the trend removes the constant by
which it differs from the true one), E = P C P, P = 1 - Q Q^T, Q an orthonormal basis of the straight lines. See
docs/theory_roughness_fit.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log

import numpy as np
from numpy.typing import NDArray
from scipy.special import j0

from stickslip.core.validation import FloatArray

RATIO = 1.5  # of successive wavelengths of the model; it cancels out of G, see the theory page


def straight_lines(points: int) -> FloatArray:
    """Orthonormal basis (2, points) of the straight lines over equally spaced points."""
    ramp = np.arange(points) - 0.5 * (points - 1)
    return np.stack([np.full(points, points**-0.5), ramp / np.linalg.norm(ramp)])


def without_trend(lines: FloatArray) -> FloatArray:
    """``lines`` (n, points) without the least-squares straight line of each."""
    basis = straight_lines(lines.shape[1])
    return np.asarray(lines - (lines @ basis.T) @ basis)


def measured_structure(lines: FloatArray, lags: NDArray[np.intp]) -> FloatArray:
    """Mean over all pairs of points of [z(i + lag) - z(i)]^2 for ``lines`` (n, points); (n_lags,)."""
    return np.array([np.mean((lines[:, lag:] - lines[:, :-lag]) ** 2) for lag in lags])


def expected_structure(structure: FloatArray, lags: NDArray[np.intp]) -> FloatArray:
    """Mean of ``measured_structure`` for one detrended line.

    ``structure``: S of the surface with its trend at the lags 0, 1 ... points - 1; (n_lags,).
    """
    points, basis = structure.size, straight_lines(structure.size)
    covariance = -0.5 * structure
    circulant = np.fft.rfft(np.concatenate([covariance, [0.0], covariance[:0:-1]]))
    product = np.fft.irfft(circulant * np.fft.rfft(basis, 2 * points), 2 * points)[:, :points]  # Q^T C
    side = -product + 0.5 * (basis @ product.T) @ basis  # P C P = C + Q side + (Q side)^T
    result = structure[lags].copy()
    for place, lag in enumerate(lags):
        steps = (basis[:, lag:] - basis[:, :-lag]) * (side[:, lag:] - side[:, :-lag])
        result[place] += 2.0 * steps.sum(axis=0).mean()
    return result


def wavelengths(longest: float, spacing: float) -> FloatArray:
    """Wavelengths of the model in m: ``longest``, longest/gamma ... down to ``spacing``."""
    return np.asarray(longest / RATIO ** np.arange(floor(log(longest / spacing) / log(RATIO)) + 1))


def wave_weights(waves: FloatArray, hurst: float) -> tuple[FloatArray, float]:
    """Weights ln gamma lambda^(2H) of ``waves`` in S / G^(2(D-2)), and the sum of those of all shorter waves."""
    weights = log(RATIO) * waves ** (2.0 * hurst)
    shorter = log(RATIO) * (waves[-1] / RATIO) ** (2.0 * hurst) / (1.0 - RATIO ** (-2.0 * hurst))
    return weights, shorter


@dataclass(frozen=True)
class LineModel:
    """Expected structure function of detrended lines, wave by wave."""

    waves: FloatArray  # wavelengths in m, longest first
    each: FloatArray  # (n_waves, n_lags): of one wave of weight 1, mean over its directions
    flat: FloatArray  # (n_lags,): of independent random heights, S = 1 at every lag

    @classmethod
    def build(cls, points: int, spacing: float, waves: FloatArray, lags: NDArray[np.intp]) -> LineModel:
        """The model for lines of ``points`` at ``spacing`` (m); waves from all sides: 1 - J0(2 pi tau / lambda)."""
        distance = spacing * np.arange(points)
        each = np.array([expected_structure(1.0 - j0(2.0 * np.pi * distance / wave), lags) for wave in waves])
        return cls(waves, each, expected_structure((distance > 0).astype(float), lags))

    def structure(self, hurst: float) -> FloatArray:
        """Expected S / G^(2(D-2)) in m^(2H) at the lags, H = 3 - D; waves below the spacing act as independent random
        heights."""
        weights, shorter = wave_weights(self.waves, hurst)
        return np.asarray(weights @ self.each + shorter * self.flat)
