"""Step control along a branch: settings, lengths to try, and the events that a listener receives."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Generic

from stickslip.solve.path.arc_length import Tangent
from stickslip.solve.path.problem import Linearised, PointT
from stickslip.solve.path.work import Work

# chosen: a curve ends if so many iterations of Newton's method cover less than this part of the plot. Most complete
# curves of the torture set (benchmarks/torture.py) need fewer than 100, but some that are complete need over 500.
STALL_ITERATIONS, STALL_LENGTH = 1500, 0.01
# chosen: allowed iterations of a whole curve for each allowed point; complete curves need two to three.
ITERATIONS_PER_POINT = 4
# chosen: a branch ends if this fraction of its allowed iterations falls into one slice, the part STALL_LENGTH of the
# range of its parameter: it folds there without end. Of the torture set that are damper 8 (7,390 iterations in a slice)
# and stiff 2 (8,192); complete curves have up to 3,600.
MOST_IN_SLICE = 0.5
# chosen: the shorter limit on the step after a retreat applies for this number of its lengths.
SLOW_STEPS = 16


@dataclass(frozen=True)
class ContinuationSettings:
    """Step control; steps are fractions of the window (or of the largest response), angles between successive tangents.

    largest_step, smallest_step, first_step:
        allowed lengths of a step.
    wanted_angle_deg, largest_angle_deg:
        the step follows the curvature towards the wanted angle; a step that turns by more than the largest is repeated
        with half its length.
    wanted_iterations:
        the step grows while Newton needs fewer.
    max_points:
        largest number of points of the branch.
    """

    largest_step: float = 0.08
    smallest_step: float = 1e-6
    first_step: float = 0.01
    wanted_angle_deg: float = 15.0
    largest_angle_deg: float = 45.0
    wanted_iterations: int = 4
    max_points: int = 2000

    def next_step(self, step: float, iterations: int, angle_deg: float) -> float:
        """The length after a step that took some iterations and turned by an angle."""
        by_angle = self.wanted_angle_deg / max(angle_deg, 1e-3)
        by_iterations = (self.wanted_iterations + 1.0) / (iterations + 1.0)
        factor = min(2.0, max(0.4, min(by_angle, by_iterations)))
        return min(self.largest_step, max(self.smallest_step, step * factor))


@dataclass(frozen=True)
class BranchPoint(Generic[PointT]):
    """A converged point, the Newton iterations that it took, and the unit tangent of the branch there.

    Only a point at an end of a branch may have no tangent.
    """

    point: PointT
    iterations: int
    tangent: Tangent | None = None


@dataclass(frozen=True)
class Revision(Generic[PointT]):
    """A point in place of a new one of the branch, on the same plane; ``system`` are its equations if it moved."""

    point: PointT
    system: Linearised | None = None


@dataclass(frozen=True)
class Accepted(Generic[PointT]):
    """Event: a new point of the branch; ``count`` is now its number of points."""

    point: PointT
    count: int


@dataclass(frozen=True)
class Retreat:
    """Event: the last steps came back to the branch, and its points after the first ``count`` were removed."""

    parameter: float
    count: int


@dataclass(frozen=True)
class Corner:
    """Event: a corner that turns back over less than one step was passed by a longer step."""

    parameter: float


class Pace:
    """The present limit on the step: shorter for a while after a retreat."""

    def __init__(self, largest_step: float) -> None:
        self._largest = self.limit = largest_step
        self._slow_length = 0.0

    def slow_down(self, limit: float) -> None:
        """Steps of at most ``limit`` for the length of ``SLOW_STEPS`` of them."""
        self.limit, self._slow_length = limit, SLOW_STEPS * limit

    def relax(self) -> None:
        """Steps of any length again."""
        self.limit = self._largest

    def advance(self, length: float) -> None:
        """Count a step of ``length``."""
        self._slow_length -= length
        if self._slow_length <= 0.0:
            self.relax()


class Effort:
    """The iterations of Newton's method along a branch, failed attempts included, and whether they still pay.

    ``work`` is that of the whole curve of which the branch is a part. An iteration of the branch takes as long as
    ``cost`` usual ones.
    """

    def __init__(self, settings: ContinuationSettings, work: Work | None = None, cost: float = 1.0) -> None:
        self._cost = cost
        self._allowed = ITERATIONS_PER_POINT * settings.max_points
        self._work = work or Work()
        self._length = 0.0  # covered since the last count began
        self.recent = self.total = 0.0
        self._by_slice: defaultdict[int, float] = defaultdict(float)  # iterations of all visits
        self._placed = self._here = 0.0  # total at the last step, and iterations in its slice

    def spend(self, iterations: int) -> None:
        """Count the iterations of an attempt."""
        self.recent += self._cost * iterations
        self.total += self._cost * iterations

    def cover(self, length: float, position: float) -> None:
        """Count an accepted step to a position, a fraction of the range of the parameter.

        Every ``STALL_LENGTH`` the count of recent iterations begins again; that of a slice never does.
        """
        part = math.floor(position / STALL_LENGTH)
        self._by_slice[part] += self.total - self._placed
        self._placed, self._here = self.total, self._by_slice[part]
        self._length += length
        if self._length >= STALL_LENGTH:
            self.renew()

    def renew(self) -> None:
        """Begin the count of recent iterations again."""
        self._length, self.recent = 0.0, 0.0

    @property
    def stall(self) -> str:
        """Why the branch should end, in words; "" while it advances."""
        advice = "Start from the other end (swap start and stop), lower the force, or use fewer harmonics."
        if self.recent > STALL_ITERATIONS:
            return (
                f"{self.recent:.0f} iterations of Newton's method covered only {100 * self._length:.1g} % of the plot. "
                f"{advice}"
            )
        if self._here > MOST_IN_SLICE * self._allowed:
            return (
                f"{self._here:.0f} iterations of Newton's method remained within {100 * STALL_LENGTH:g} % of the "
                f"range, where the curve folds again and again. Narrow the range or raise max_points to "
                "follow it further."
            )
        if self.total > self._allowed:
            return f"{self.total:.0f} iterations of Newton's method were not enough. {advice}"
        return self._work.limit_words


def lengths_to_try(step: float, settings: ContinuationSettings) -> Iterator[float]:
    """The lengths of successive attempts: the wanted one and its halves, then longer ones that pass a corner."""
    length = step
    while length >= settings.smallest_step:
        yield length
        length *= 0.5
    length = 2.0 * step
    while length <= settings.first_step:
        yield length
        length *= 2.0


def growing_lengths(first: float, last: float) -> Iterator[float]:
    """Lengths from ``first`` to ``last``, each four times the one before."""
    length = first
    while length <= last:
        yield length
        length *= 4.0
