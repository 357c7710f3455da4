"""The result of many curves that were computed together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray


@dataclass(frozen=True)
class BatchCurve:
    """One curve of a batch: the output along the frequency.

    Attributes
    ----------
    frequency_hz:
        (n_points,) Hz, in the order of the curve, which may fold.
    amplitude:
        (n_points,) m, 0-to-peak amplitude of the output over the period, mean included.
    coefficients:
        (n_points, 2H+1) m, Fourier coefficients of the output: mean, cos 1, sin 1, ...
    contact_state:
        (n_points, n_pairs) codes of :class:`ContactState`.
    residual:
        (n_points,) residual of the balance over the relative displacements; of a curve that was solved ``alone`` that
        of its :class:`ForcedResponse`.
    peak_amplitude, peak_frequency_hz:
        m and Hz at the highest point of the curve; NaN without points.
    converged:
        True if the curve reaches the stop frequency.
    message:
        how the curve ended.
    alone:
        the reason why :func:`forced_response` solved the curve, empty if the batch did.
    """

    frequency_hz: FloatArray
    amplitude: FloatArray
    coefficients: FloatArray
    contact_state: NDArray[np.int8]
    residual: FloatArray
    peak_amplitude: float
    peak_frequency_hz: float
    converged: bool
    message: str
    alone: str = ""

    __repr__ = short_repr


@dataclass(frozen=True)
class BatchResponse:
    """The curves of :func:`batch_response`, in the order of their inputs.

    Attributes
    ----------
    curves:
        one for each input.
    harmonics, samples:
        of all curves.
    """

    curves: tuple[BatchCurve, ...]
    harmonics: int
    samples: int

    def __repr__(self) -> str:
        alone = sum(bool(curve.alone) for curve in self.curves)
        ended = int((~self.converged).sum())
        return f"BatchResponse({len(self.curves)} curves, {alone} solved alone, {ended} not complete)"

    @property
    def peak_amplitude(self) -> FloatArray:
        """(n_curves,) m."""
        return np.array([curve.peak_amplitude for curve in self.curves])

    @property
    def peak_frequency_hz(self) -> FloatArray:
        """(n_curves,) Hz."""
        return np.array([curve.peak_frequency_hz for curve in self.curves])

    @property
    def converged(self) -> NDArray[np.bool_]:
        """(n_curves,) True for complete curves."""
        return np.array([curve.converged for curve in self.curves], dtype=bool)
