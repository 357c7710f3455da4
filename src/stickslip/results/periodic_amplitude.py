"""The largest absolute value of a periodic signal from its Fourier coefficients, and its instant."""

from __future__ import annotations

import numpy as np

from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray


def periodic_amplitude(coefficients: FloatArray) -> FloatArray:
    """(m,) largest absolute value over the period of each row of Fourier coefficients (m, 2 * harmonics + 1)."""
    return periodic_maximum(coefficients)[0]


def periodic_maximum(coefficients: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(m,) largest absolute value over the period of each row (m, 2 * harmonics + 1), and (m,) its angle ``w t`` in
    rad.

    Each local maximum on a grid of 32 samples per highest harmonic is refined by a parabola; Newton steps on ``x'(tau)
    = 0`` then refine the best of them, so the result is exact to round-off where that maximum is smooth.
    """
    harmonics = (coefficients.shape[1] - 1) // 2
    if harmonics == 0:
        return np.abs(coefficients[:, 0]), np.zeros(len(coefficients))
    samples = 32 * harmonics
    values = np.abs(coefficients @ synthesis_matrix(harmonics, samples).T)
    before, after = np.roll(values, 1, axis=1), np.roll(values, -1, axis=1)
    bend = 2.0 * values - before - after
    peaks = (values >= before) & (values >= after) & (bend > 0)
    offset = np.divide(0.5 * (after - before), bend, out=np.zeros_like(values), where=peaks)
    height = np.where(peaks, values + 0.25 * (after - before) * offset, values)
    best = height.argmax(axis=1)
    rows = np.arange(len(values))
    step = 2.0 * np.pi / samples
    angle = (best + offset[rows, best]) * step
    order = np.arange(1, harmonics + 1)
    cosine, sine = coefficients[:, 1::2], coefficients[:, 2::2]
    for _ in range(4):
        c, s = np.cos(np.outer(angle, order)), np.sin(np.outer(angle, order))
        slope = ((sine * c - cosine * s) * order).sum(axis=1)
        curvature = -((cosine * c + sine * s) * order**2).sum(axis=1)
        move = np.divide(-slope, curvature, out=np.zeros_like(slope), where=curvature != 0)
        angle = angle + np.clip(move, -step, step)
    c, s = np.cos(np.outer(angle, order)), np.sin(np.outer(angle, order))
    polished = np.abs(coefficients[:, 0] + (cosine * c + sine * s).sum(axis=1))
    sampled = values[rows, best]
    is_polished = polished >= sampled
    return np.where(is_polished, polished, sampled), np.where(is_polished, angle, best * step)
