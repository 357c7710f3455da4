"""Warnings on D and G from a measurement, with numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

NEAR_LIMIT = 0.05  # of D to 2 or 3, as in fractal.py
FEW_POINTS = 500  # on a line; chosen: below it the intervals of D are wide
LARGE_TREND = 0.8  # chosen: fraction of the height variance
LARGE_NOISE = 0.1  # chosen: fraction of S at the shortest lag
UNLIKELY = 0.01  # chosen: fraction of simulated surfaces that fit worse, the 1 % level of a test
DIRECTIONS_DIFFER = 3.0  # standard deviations


@dataclass(frozen=True)
class Evidence:
    """The results of the fit on which warnings depend; lengths in m."""

    dimension: float
    dimension_interval: tuple[float, float]
    roughness: float
    usable: bool
    scale_range: tuple[float, float]
    points: int
    trend_fraction: float
    noise_fraction: float
    noise_height: float
    raised: bool
    probability: float
    direction_deviation: float


def warnings_of(fit: Evidence) -> tuple[str, ...]:
    """The warnings, most severe first."""
    return tuple(_warnings_of(fit))


def _warnings_of(fit: Evidence) -> Iterator[str]:
    low, high = fit.scale_range
    if not fit.usable:
        limit = 2 if fit.dimension < 2.5 else 3
        like = "smoother than any fractal surface" if limit == 2 else "like noise"
        yield (
            f"D out of 2..3: the best fit is at the limit {limit}, so the heights are {like} over these scales; D and "
            "G are not usable. Choose other scales or check the filter of the instrument."
        )
    if fit.probability < UNLIKELY:
        yield (
            f"Not fractal over the range: only {100 * fit.probability:.1f} % of simulated surfaces with this D and G "
            "fit worse. Look at the plot and choose the scales over which it is straight."
        )
    if abs(fit.direction_deviation) > DIRECTIONS_DIFFER:
        more = "x" if fit.direction_deviation > 0 else "y"
        yield (
            f"Not isotropic: the heights change more along {more} than along the other direction, by "
            f"{abs(fit.direction_deviation):.0f} standard deviations of an isotropic surface; D and G are a mean."
        )
    if high < 10.0 * low:
        yield (
            f"Range below a decade: the fit uses scales from {low:.3g} m to {high:.3g} m only, which is too "
            "little to distinguish a power law from another curve."
        )
    if fit.points < FEW_POINTS:
        yield f"Too few points: {fit.points} on a line; {FEW_POINTS} or more make the intervals narrower."
    if fit.noise_fraction > LARGE_NOISE:
        yield (
            f"Noise: a constant makes up {100 * fit.noise_fraction:.0f} % of S at the shortest lag, like uncorrelated "
            f"heights of {fit.noise_height:.3g} m rms. The fit excludes it; it cannot be distinguished from waves "
            "shorter than the range."
        )
    if fit.raised:
        yield (
            f"Short waves are missing (stylus tip, spot or filter): the fit starts at {low:.3g} m, and D and G are not "
            "valid for shorter scales."
        )
    if fit.trend_fraction > LARGE_TREND:
        yield (
            f"Trend removed: the mean line of the heights contained {100 * fit.trend_fraction:.0f} % of their "
            "variance. Form or tilt requires no action; if it is long waves, measure a longer line."
        )
    lowest, highest = fit.dimension_interval
    if fit.usable and min(lowest - 2.0, 3.0 - highest) < NEAR_LIMIT:
        yield (
            f"D is poorly determined: its interval, {lowest:.2f} to {highest:.2f}, reaches the limit of 2 or 3, so the "
            "interval of G is of little use. Use more scales, or the mean of several lines."
        )
    if fit.usable and min(fit.dimension - 2.0, 3.0 - fit.dimension) < NEAR_LIMIT:
        yield f"D = {fit.dimension:.3f} is near its limit, where G and the contact law are ill-determined."
    if fit.usable and fit.roughness >= low:
        yield (
            f"G = {fit.roughness:.3g} m is not below the shortest scale of the fit, {low:.3g} m: waves of that length "
            "are steeper than 1, and the contact law is not valid for them."
        )
