"""Landmarks: values of the parameter where a curve may have a narrow peak, which a long step would cross unseen.

On both sides of a narrow peak a curve is flat and its tangents agree, so neither the angle of a step nor the iterations
of Newton's method reveal the peak. A step that would cross a landmark ends on it instead; there the angles see a peak.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from stickslip.solve.path.problem import Point

# chosen: a step crosses a peak unseen only if it is longer than this fraction of its width, and a point within this
# fraction of the width is on it: a peak of half-power width b has 97 % of its height at b/8.
OF_WIDTH, ON_IT = 0.5, 0.125
# chosen: so many widths beside a landmark the motion there measures the steps; friction moves a peak and widens it.
REACH = 10.0
# chosen: floor of the local scale of the motion, over the largest motion so far: lower peaks are invisible in a plot.
VISIBLE = 0.01

PointT_contra = TypeVar("PointT_contra", bound=Point, contravariant=True)


@dataclass(frozen=True)
class Landmark:
    """A value of the parameter, and the width of a peak there (between the points of half the power)."""

    value: float
    width: float


class LandmarkSource(Protocol[PointT_contra]):
    """Knows the landmarks of a problem."""

    def of(self, point: PointT_contra) -> Sequence[Landmark]:
        """All landmarks as seen from a point of the curve, in any order."""


def first_crossed(landmarks: Sequence[Landmark], start: float, change: float) -> Landmark | None:
    """The first narrow landmark that a step from ``start`` by ``change`` of the parameter crosses."""
    crossed = [
        each
        for each in landmarks
        if ON_IT * each.width < (each.value - start) * (1.0 if change > 0.0 else -1.0) <= abs(change)
        and abs(change) > OF_WIDTH * each.width
    ]
    return min(crossed, key=lambda each: abs(each.value - start), default=None)


def is_long_near(landmarks: Sequence[Landmark], start: float, end: float) -> bool:
    """Whether a step comes within ``REACH`` widths of a landmark, and is long compared with its width."""
    low, high = min(start, end), max(start, end)
    return any(
        high - low > OF_WIDTH * each.width and low - REACH * each.width <= each.value <= high + REACH * each.width
        for each in landmarks
    )
