"""Real Fourier series of periodic signals: coefficients in the order mean, cos 1, sin 1, cos 2, sin 2, ...

``x(t) = c_0 + sum_k c_k cos(k tau) + s_k sin(k tau)``, ``tau = 2 pi f t``, sampled at ``tau_j = 2 pi j / n_samples``.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stickslip.core.validation import FloatArray


@lru_cache(maxsize=32)
def synthesis_matrix(harmonics: int, samples: int) -> FloatArray:
    """(samples, 2 * harmonics + 1) matrix that turns coefficients into samples of one period; cached, so read-only."""
    angle = 2.0 * np.pi * np.arange(samples)[:, None] / samples
    order = np.arange(1, harmonics + 1)[None, :]
    matrix = np.ones((samples, 2 * harmonics + 1))
    matrix[:, 1::2] = np.cos(order * angle)
    matrix[:, 2::2] = np.sin(order * angle)
    matrix.setflags(write=False)
    return matrix


def synthesis_row(harmonics: int, angle: float) -> FloatArray:
    """(2 * harmonics + 1,) row whose product with coefficients is the signal at an angle ``tau`` in rad."""
    order = np.arange(1, harmonics + 1)
    row = np.ones(2 * harmonics + 1)
    row[1::2], row[2::2] = np.cos(order * angle), np.sin(order * angle)
    return row


@lru_cache(maxsize=32)
def analysis_matrix(harmonics: int, samples: int) -> FloatArray:
    """(2 * harmonics + 1, samples) read-only matrix that turns samples into coefficients (Fourier projection).

    Exact for signals with harmonics up to ``samples - harmonics - 1``; higher ones alias. Needs
    ``samples >= 2 * harmonics + 1``.
    """
    matrix = synthesis_matrix(harmonics, samples).T * (2.0 / samples)
    matrix[0] *= 0.5
    matrix.setflags(write=False)
    return matrix


def with_rows(coefficients: FloatArray, rows: int) -> FloatArray:
    """A copy (rows, ...) of coefficients (count, ...): the first ones, or all and zeros of further harmonics."""
    result = np.zeros((rows, *coefficients.shape[1:]))
    count = min(rows, len(coefficients))
    result[:count] = coefficients[:count]
    return result
