"""Measures of a periodic stress: von Mises and principal stresses over the cycle, alternating and mean stress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array

# Samples of a period for each harmonic. The square of the von Mises stress is a trigonometric polynomial of degree 2H,
# whose maximum is at most 1 / cos(2 H pi / samples) of the largest sample (H. Ehlich, K. Zeller, Math. Z. 86 (1964)
# 41-44): before the refinement, a von Mises stress is at most 0.25 % too low.
SAMPLES_OF_HARMONIC = 48
MOST_SAMPLES = 2048
# The same for pairs of instants: at most 3 % too low before the refinement.
PAIR_SAMPLES_OF_HARMONIC = 14
MOST_PAIR_SAMPLES = 224
_ROWS_AT_ONCE = 200  # chosen to bound the memory
_SEARCHED_AT_ONCE = 50  # chosen: rows with the highest bounds, of which one usually has the largest stress
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_GOLDEN_STEPS = 24  # shrinks the interval between two samples by 1e-5; the error of a maximum is the square of that

# Ways in which two instants move together, (searches, 2).
_SEARCHES = np.array(4 * [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])

Instants = FloatArray  # (p,) phase of each row in rad


@dataclass(frozen=True, eq=False)
class StressCycle:
    """Measures (p,) in Pa of each of p points over one period.

    largest_von_mises, smallest_von_mises:
        over the cycle. Their difference is no measure of fatigue, because von Mises stress has no sign.
    largest_first_principal, smallest_first_principal, largest_third_principal, smallest_third_principal:
        of the largest and of the smallest principal stress, tension positive.
    alternating:
        half of the largest von Mises stress of the difference of the stress tensors at any two instants.
    mean:
        von Mises stress of the mean of the tensors at these two instants.
    """

    largest_von_mises: FloatArray
    smallest_von_mises: FloatArray
    largest_first_principal: FloatArray
    smallest_first_principal: FloatArray
    largest_third_principal: FloatArray
    smallest_third_principal: FloatArray
    alternating: FloatArray
    mean: FloatArray

    __repr__ = short_repr


def stress_cycle(coefficients: FloatArray) -> StressCycle:
    """Measures of the stress ``s(t) = c_0 + sum_k c_k cos(k w t) + s_k sin(k w t)`` over one period.

    Parameters
    ----------
    coefficients:
        (p, 6, 2H+1) Pa, components xx, yy, zz, xy, yz, zx, coefficients mean, cos 1, sin 1, ...; the mean contains the
        static stress.

    The instants of the extremes are refined between samples by a golden-section search, so that they are exact to
    round-off where the largest sample is next to the true extreme.

    The alternating stress is that of ASME Boiler and Pressure Vessel Code VIII-2, 5.5.3.2, equivalent stress range of
    the tensors of two instants: it does not depend on the axes and is right for stresses with different phases.

    Raises InputError for another shape.
    """
    array = finite_array("coefficients", coefficients)
    if array.ndim != 3 or array.shape[1] != 6 or array.shape[2] % 2 == 0:
        raise InputError(
            "coefficients must have shape (p, 6, 2H+1), components xx, yy, zz, xy, yz, zx and coefficients mean, "
            f"cos 1, sin 1, ..., but the shape is {array.shape}.",
            arguments=["coefficients"],
        )
    parts = [_cycle(array[start : start + _ROWS_AT_ONCE]) for start in range(0, len(array), _ROWS_AT_ONCE)]
    columns = zip(*parts, strict=True) if parts else ((np.empty(0),) for _ in range(8))
    return StressCycle(*(np.concatenate(column) for column in columns))


def largest_over_cycle(coefficients: FloatArray) -> tuple[float, float]:
    """The largest von Mises stress and the largest alternating stress in Pa of all rows of :func:`stress_cycle`.

    Only rows whose bound is above the largest value found so far are computed: no von Mises stress of a period exceeds
    that of the mean plus those of the amplitudes of all harmonics, and no alternating stress exceeds these amplitudes.

    ``coefficients`` (p, 6, 2H+1) with p > 0. Raises InputError for another shape.
    """
    size = von_mises(np.swapaxes(coefficients, 1, 2))
    vibration = np.hypot(size[:, 1::2], size[:, 2::2]).sum(axis=1)

    def largest(bound: FloatArray, of_cycle: Callable[[StressCycle], FloatArray]) -> float:
        order, found = np.argsort(-bound), 0.0
        for start in range(0, len(order), _SEARCHED_AT_ONCE):
            rows = order[start : start + _SEARCHED_AT_ONCE]
            if start and bound[rows[0]] <= found:
                break
            found = max(found, float(of_cycle(stress_cycle(coefficients[rows])).max()))
        return found

    return (
        largest(size[:, 0] + vibration, lambda cycle: cycle.largest_von_mises),
        largest(vibration, lambda cycle: cycle.alternating),
    )


def von_mises(stress: FloatArray) -> FloatArray:
    """(...) von Mises stress of tensors (..., 6) xx, yy, zz, xy, yz, zx."""
    return np.asarray(np.linalg.norm(_deviator(stress), axis=-1))


def _deviator(stress: FloatArray) -> FloatArray:
    """(..., 6) whose Euclidean length is the von Mises stress of tensors (..., 6)."""
    xx, yy, zz = stress[..., 0], stress[..., 1], stress[..., 2]
    normal = np.sqrt(0.5) * np.stack([xx - yy, yy - zz, zz - xx], axis=-1)
    return np.concatenate([normal, np.sqrt(3.0) * stress[..., 3:]], axis=-1)


def principal_stresses(stress: FloatArray) -> FloatArray:
    """(..., 3) principal stresses of tensors (..., 6), the largest first.

    The trigonometric solution of the characteristic equation, which is exact to about 1e-8 of the largest stress where
    two of them are nearly equal.
    """
    mean = stress[..., :3].mean(axis=-1)
    normal, shear = stress[..., :3] - mean[..., None], stress[..., 3:]
    size = np.sqrt(((normal**2).sum(axis=-1) + 2.0 * (shear**2).sum(axis=-1)) / 6.0)
    scale = np.where(size > 0.0, size, 1.0)[..., None]
    (a, b, c), (d, e, f) = np.moveaxis(normal / scale, -1, 0), np.moveaxis(shear / scale, -1, 0)
    determinant = a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f)
    angle = np.arccos(np.clip(0.5 * determinant, -1.0, 1.0)) / 3.0
    turned = angle[..., None] + 2.0 * np.pi / 3.0 * np.array([0.0, -1.0, 1.0])
    return np.asarray(mean[..., None] + 2.0 * size[..., None] * np.cos(turned))


def _cycle(coefficients: FloatArray) -> tuple[FloatArray, ...]:
    """The measures of :class:`StressCycle` of some rows."""
    harmonics = max(1, coefficients.shape[2] // 2)
    count = min(SAMPLES_OF_HARMONIC * harmonics, MOST_SAMPLES)
    series = _padded(coefficients, harmonics)
    samples = np.einsum("pic,tc->pti", series, synthesis_matrix(harmonics, count), optimize=True)
    phase, width = 2.0 * np.pi * np.arange(count) / count, 2.0 * np.pi / count

    def extreme(of_stress: Callable[[FloatArray], FloatArray], sampled: FloatArray, sign: float) -> FloatArray:
        start = phase[(sign * sampled).argmax(axis=1)]
        return sign * _refined(lambda at: sign * of_stress(_at(series, at)), start, width)[1]

    equivalent, principal = von_mises(samples), principal_stresses(samples)
    first = [extreme(lambda s: principal_stresses(s)[..., 0], principal[..., 0], sign) for sign in (1.0, -1.0)]
    third = [extreme(lambda s: principal_stresses(s)[..., 2], principal[..., 2], sign) for sign in (1.0, -1.0)]
    von_mises_extremes = [extreme(von_mises, equivalent, sign) for sign in (1.0, -1.0)]
    return (*von_mises_extremes, *first, *third, *_range(series, harmonics))


def _padded(coefficients: FloatArray, harmonics: int) -> FloatArray:
    """Coefficients with ``harmonics`` harmonics, also of a constant stress."""
    missing = 2 * harmonics + 1 - coefficients.shape[2]
    return np.pad(coefficients, ((0, 0), (0, 0), (0, missing))) if missing else coefficients


def _range(series: FloatArray, harmonics: int) -> tuple[FloatArray, FloatArray]:
    """(p,) half of the largest von Mises stress of a difference of two instants, and that of their mean."""
    count = min(PAIR_SAMPLES_OF_HARMONIC * harmonics, MOST_PAIR_SAMPLES)
    samples = _deviator(np.einsum("pic,tc->pti", series, synthesis_matrix(harmonics, count), optimize=True))
    square = (samples**2).sum(axis=2)
    distance = square[:, :, None] + square[:, None, :] - 2.0 * samples @ samples.swapaxes(1, 2)
    first, second = np.unravel_index(distance.reshape(len(series), -1).argmax(axis=1), distance.shape[1:])
    width = 2.0 * np.pi / count
    ends = np.stack([width * first, width * second])

    def moved(shift: Instants, ways: FloatArray) -> FloatArray:
        return von_mises(_at(series, ends[0] + ways[0] * shift) - _at(series, ends[1] + ways[1] * shift))

    # Both instants together, then one at a time: each search increases the range or leaves it as it is.
    still = np.zeros(len(series))
    for ways in _SEARCHES:
        shift, _ = _refined(partial(moved, ways=ways), still, width)
        ends = ends + ways[:, None] * shift
    one, two = (_at(series, at) for at in ends)
    return 0.5 * von_mises(one - two), von_mises(0.5 * (one + two))


def _at(series: FloatArray, phase: Instants) -> FloatArray:
    """(p, 6) stress of each row at its own phase."""
    angle = phase[:, None] * np.arange(1, series.shape[2] // 2 + 1)
    weights = np.ones((len(phase), series.shape[2]))
    weights[:, 1::2], weights[:, 2::2] = np.cos(angle), np.sin(angle)
    return np.asarray((series @ weights[:, :, None])[..., 0])


def _refined(function: Callable[[Instants], FloatArray], start: Instants, width: float) -> tuple[Instants, FloatArray]:
    """Phase and value (p,) of the maximum within ``width`` rad of ``start``; never below the value at ``start``."""
    low, high = start - width, start + width
    inner, outer = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_inner, at_outer = function(inner), function(outer)
    for _ in range(_GOLDEN_STEPS):
        below = at_inner >= at_outer
        low, high = np.where(below, low, inner), np.where(below, outer, high)
        moved = np.where(below, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        value = function(moved)
        inner, at_inner, outer, at_outer = (
            np.where(below, moved, outer),
            np.where(below, value, at_outer),
            np.where(below, inner, moved),
            np.where(below, at_inner, value),
        )
    middle, at_start = 0.5 * (low + high), function(start)
    value = function(middle)
    better = value > at_start
    return np.where(better, middle, start), np.where(better, value, at_start)
