"""The points of a branch, and those of them to which the last step may have come back.

A curve of solutions does not intersect itself. But friction with residual tractions has closed curves of other
solutions close beside it, and corners finer than a step: a step that is a little too long can end on such a loop, which
has no end, or reverse and follow its own branch back to the start.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic

import numpy as np

from stickslip.solve.path.problem import PointT

# A chord passes an earlier point of the same curve within this fraction of its length: an arc that turns by 45 degrees
# rises by 0.1 of its chord.
NEAR = 0.2
# The last points are neighbours of any new one.
NEIGHBOURS = 3


class Visited(Generic[PointT]):
    """The points of a branch in their order, with a fast search for those near the last chord."""

    def __init__(self) -> None:
        self.points: list[PointT] = []
        self._sizes: list[float] = []
        self._parameters: list[float] = []

    def add(self, point: PointT) -> None:
        """Append a point."""
        self.points.append(point)
        self._sizes.append(float(np.linalg.norm(point.measured)))
        self._parameters.append(float(point.parameters[0]))

    def truncate(self, count: int) -> None:
        """Remove all but the first ``count`` points."""
        del self.points[count:], self._sizes[count:], self._parameters[count:]

    def near_last_chord(self, motion_scale: float, parameter_scale: float) -> Iterator[tuple[int, float]]:
        """Earlier points that the last chord passes, the oldest first: their index, and the fraction of the chord
        there.

        Distances are measured in ``(measured / motion_scale, parameter / parameter_scale)``. Being near is no proof:
        different curves may be close to each other.
        """
        last = len(self.points) - 1
        if last < NEIGHBOURS + 1:
            return
        before, after = self.points[-2], self.points[-1]
        chord = (after.measured - before.measured) / motion_scale
        rise = float(after.parameters[0] - before.parameters[0]) / parameter_scale
        square = float((chord**2).sum()) + rise**2
        reach = (1.0 + NEAR) * square**0.5
        lifts = (np.array(self._parameters[: last - NEIGHBOURS]) - self._parameters[last - 1]) / parameter_scale
        sizes = np.array(self._sizes[: last - NEIGHBOURS]) - self._sizes[last - 1]
        for index in np.flatnonzero((np.abs(lifts) <= reach) & (np.abs(sizes) <= reach * motion_scale)).tolist():
            earlier, lift = self.points[index], float(lifts[index])
            gap = (earlier.measured - before.measured) / motion_scale
            share = (float((gap * chord).sum()) + lift * rise) / square
            away = float(((gap - share * chord) ** 2).sum()) + (lift - share * rise) ** 2
            if 0.0 <= share <= 1.0 and away <= NEAR**2 * square:
                yield index, share
