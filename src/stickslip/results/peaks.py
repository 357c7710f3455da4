"""Peaks of an amplitude curve and their widths.

All functions follow the curve in its own order (the index), because a curve that folds has several amplitudes at one
frequency and must not be sorted by it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array


@dataclass(frozen=True)
class Peak:
    """A maximum of an amplitude curve.

    ``point`` is the computed point nearest to it; ``bracketed`` is False if the largest amplitude is at an end of the
    curve, so that the true peak may be higher.
    """

    point: int
    frequency_hz: float
    amplitude: float
    bracketed: bool


def caution(bracketed: bool, complete: bool) -> str:
    """Words beside a peak that may not be the highest one, "" beside others.

    bracketed:
        as in :class:`Peak`.
    complete:
        whether the curve covers the whole range.
    """
    if not bracketed:
        return "highest computed, at an end of the curve"
    return "" if complete else "highest of the computed part of the curve"


def peaks(frequency_hz: ArrayLike, amplitude: ArrayLike, part: ArrayLike | None = None) -> list[Peak]:
    """Local maxima along the curve, highest first, and its highest point if that is an end of a part, not bracketed.

    Around each maximum ``1 / amplitude^2`` and the frequency are taken as parabolas through three neighbouring points,
    over the frequency, or over the index where the curve folds. ``1 / amplitude^2`` of a lightly damped linear
    resonance is a parabola in the frequency, so its peak is almost exact.

    Parameters
    ----------
    frequency_hz, amplitude:
        (n_points,) along the curve. Amplitudes must not be negative.
    part:
        (n_points,) number of the uninterrupted part of each point; None for a curve of one part.

    Raises
    ------
    InputError
        for arrays of different or zero length, or a negative amplitude.
    """
    frequency, height = checked_curve(frequency_hz, amplitude)
    number = np.zeros(height.size) if part is None else np.asarray(part)
    is_end = np.diff(number, prepend=np.nan, append=np.nan) != 0.0  # of a step; not a number differs from all
    is_end = is_end[:-1] | is_end[1:]
    is_top = (height[1:-1] >= height[:-2]) & (height[1:-1] > height[2:])
    inside = np.flatnonzero(is_top & ~is_end[1:-1]) + 1
    interpolated = [_interpolated_peak(frequency, height, int(i)) for i in inside]
    top = int(height.argmax())
    if is_end[top]:
        interpolated.append(Peak(top, float(frequency[top]), float(height[top]), bracketed=False))
    return sorted(interpolated, key=lambda peak: -peak.amplitude)


def checked_curve(frequency_hz: ArrayLike, amplitude: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Frequencies and amplitudes along a curve, (n_points,) each; raises InputError for what cannot be a curve."""
    frequency, height = finite_array("frequency_hz", frequency_hz), finite_array("amplitude", amplitude)
    if frequency.ndim != 1 or frequency.shape != height.shape or not frequency.size:
        raise InputError(
            f"frequency_hz and amplitude must be two lists of one length, but their shapes are {frequency.shape} and "
            f"{height.shape}.",
            arguments=["frequency_hz", "amplitude"],
        )
    if height.min() < 0:
        raise InputError(
            "amplitude must not be negative: a 0-to-peak amplitude is the largest absolute value.",
            arguments=["amplitude"],
        )
    return frequency, height


def _interpolated_peak(frequency: FloatArray, height: FloatArray, i: int) -> Peak:
    f, a = frequency[i - 1 : i + 2], height[i - 1 : i + 2]
    if a.min() <= 0.0:
        return Peak(i, float(frequency[i]), float(height[i]), bracketed=True)
    # The frequency is the best abscissa where its two steps are similar. Around a fold it slows and turns back; the
    # index then replaces the length of the continuation's steps, which change little from one to the next.
    first, second = np.diff(f)
    alike = first * second > 0 and max(abs(first), abs(second)) < 3.0 * min(abs(first), abs(second))
    steps = np.abs(np.diff(f)) if alike else np.ones(2)
    length = np.concatenate([[-steps[0]], [0.0], [steps[1]]])
    inverse = (a[1] / a) ** 2
    parabola = np.polyfit(length, inverse, 2)
    bend, slope = parabola[:2]
    place = float(np.clip(-0.5 * slope / bend, length[0], length[2])) if bend > 0 else 0.0
    smallest = float(np.polyval(parabola, place))
    nearest = i + int(np.abs(length - place).argmin()) - 1
    peak_frequency = float(np.polyval(np.polyfit(length, f, 2), place))
    # A parabola through a sharp corner could pass zero; the result is then the computed maximum.
    amplitude = float(a[1] / np.sqrt(smallest)) if smallest > 0.25 else float(a[1])
    return Peak(nearest, peak_frequency, amplitude, bracketed=True)


def half_power_width(
    frequency_hz: ArrayLike, amplitude: ArrayLike, peak: Peak, part: ArrayLike | None = None
) -> float | None:
    """Width of a peak over twice its frequency, ``(f_2 - f_1) / (2 f_peak)``, from the half-power band of the curve.

    ``f_1`` and ``f_2`` are the first points on either side of the peak, walking along the curve, where the amplitude is
    ``peak.amplitude / sqrt(2)`` (linear between points). For a linear single resonance this is the damping ratio. With
    friction the curve is not a resonance curve, and this is a width only; the damping follows from the energies
    (:func:`stickslip.results.measures.equivalent_damping`). None if the curve ends before it has fallen that far, or
    the peak is not bracketed. ``part`` as in :func:`peaks`.
    """
    frequency, height = finite_array("frequency_hz", frequency_hz), finite_array("amplitude", amplitude)
    if not peak.bracketed or peak.amplitude <= 0.0:
        return None
    level, point = peak.amplitude / np.sqrt(2.0), peak.point
    if part is not None:
        here = np.flatnonzero(np.asarray(part) == np.asarray(part)[point])
        frequency, height, point = frequency[here], height[here], point - int(here[0])
    lower = _crossing(frequency[point::-1], height[point::-1], level)
    upper = _crossing(frequency[point:], height[point:], level)
    if lower is None or upper is None:
        return None
    return abs(upper - lower) / (2.0 * peak.frequency_hz)


def _crossing(frequency: FloatArray, height: FloatArray, level: float) -> float | None:
    below = np.flatnonzero(height <= level)
    if not below.size or below[0] == 0:
        return None
    i = int(below[0])
    share = (height[i - 1] - level) / (height[i - 1] - height[i])
    return float(frequency[i - 1] + share * (frequency[i] - frequency[i - 1]))


def window_around(frequency_hz: FloatArray, others: list[Peak]) -> tuple[float, float]:
    """Frequency range to show, Hz: a computed curve and those of other ``peaks`` that are bracketed, with a margin."""
    shown = [float(frequency_hz.min()), float(frequency_hz.max())]
    shown += [peak.frequency_hz for peak in others if peak.bracketed]
    margin = 0.04 * (max(shown) - min(shown))
    return min(shown) - margin, max(shown) + margin
