"""A frequency curve in pieces: where the branch is lost it begins again beyond, and time integration tells why.

Friction bodies that rattle have no motion with the period of the force at some frequencies, and near them corners and
folds that no step passes. The curve then goes on at the next frequency at which a solution exists.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic

from stickslip.solve.evidence import Evidence, Settling
from stickslip.solve.harmonic.curves import BalancePoint, BalancePointT
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.retreats import Crossing
from stickslip.solve.path.stepping import BranchPoint

# chosen: largest number of times that a curve begins again, and the distances beyond the place where it was lost at
# which a solution is looked for, as fractions of the range.
MOST_BREAKS = 6
DISTANCES = (1e-4, 1e-3, 4e-3, 0.016, 0.06, 0.2)
# chosen: the smallest distance at which an amplitude ramp is tried, which takes long.
LEAST_RAMP = 0.016
# chosen: a curve is complete if its pieces leave out no more than this fraction of the range.
LARGEST_GAP = 0.01


@dataclass(frozen=True)
class Break:
    """A place where a curve is interrupted: between its points ``after`` and ``after + 1``.

    found:
        rad/s, the first solution beyond.
    gap:
        (first, last) rad/s without points; None where the pieces overlap.
    reason:
        why the branch ended, a sentence.
    how:
        how the solution beyond was found.
    evidence:
        what a time integration from the last point shows there; None if the joint allows none.
    """

    after: int
    found: float
    gap: tuple[float, float] | None
    reason: str
    how: str
    evidence: Evidence | None

    def words(self) -> str:
        """A warning."""
        found = f"{self.found / (2.0 * math.pi):.3f}"
        words = f"The curve is interrupted. {self.reason} It goes on at {found} Hz, where a motion was found {self.how}"
        if self.gap is None:
            words += "; both parts cover the frequencies between, on different motions."
        else:
            low, high = (omega / (2.0 * math.pi) for omega in sorted(self.gap))
            words += f"; it has no points from {low:.3f} to {high:.3f} Hz, so peaks there are not known."
        return f"{words} {self.evidence.words()}" if self.evidence else words


class Pieces(Generic[BalancePointT]):
    """The points of all pieces in the order of the curve, and what is known of their ends.

    Parameters
    ----------
    part:
        follows the branch from a solution to a frequency in rad/s.
    window:
        (start, stop) in rad/s.
    settling:
        finds solutions away from the curve.
    """

    def __init__(
        self,
        part: Callable[[BalancePoint, float], Branch[BalancePointT]],
        window: tuple[float, float],
        settling: Settling,
    ) -> None:
        self._part, self._settling = part, settling
        self._window = window
        self._direction = math.copysign(1.0, window[1] - window[0])
        self.points: list[BranchPoint[BalancePointT]] = []
        self.breaks: list[Break] = []
        self.retreats: list[float] = []
        self.corners: list[float] = []
        self.crossings: list[Crossing] = []
        self.complete = False
        self.message = ""

    def follow(self, start: BalancePoint) -> Pieces[BalancePointT]:
        """Follow from a solution at the start of the window."""
        branch = self._part(start, self._window[1])
        self._append(branch)
        while branch.lost and len(self.breaks) < MOST_BREAKS:
            evidence = self._settling.evidence(self.points[-1].point, self._direction * self._width)
            here = self._furthest(self.points)
            found = self._beyond(here)
            if found is None:
                self.message = f"{branch.message} {evidence.words()}" if evidence else branch.message
                return self
            point, how = found
            onward, back = self._part(point, self._window[1]), self._part(point, here)
            first = self._furthest(back.points, -1.0)
            gap = (here, first) if (first - here) * self._direction > 0.0 and not back.complete else None
            after = len(self.points) - 1
            self.breaks.append(Break(after, point.trial.omega, gap, branch.message, how, evidence))
            self._append(back, reverse=True)
            self._append(onward)
            branch = onward
        left_out = sum(abs(each.gap[1] - each.gap[0]) for each in self.breaks if each.gap)
        self.complete = branch.complete and left_out <= LARGEST_GAP * self._width
        if branch.complete and not self.complete:
            self.message = (
                f"The curve reached the stop frequency, but has no points in {100.0 * left_out / self._width:.2g} % of "
                "the range: the warnings name the place."
            )
        return self

    @property
    def _width(self) -> float:
        return abs(self._window[1] - self._window[0])

    def _furthest(self, points: Sequence[BranchPoint[BalancePointT]], sign: float = 1.0) -> float:
        """The frequency farthest along the window, or with a ``sign`` of -1 least far."""
        return max((each.point.trial.omega for each in points), key=lambda omega: sign * self._direction * omega)

    def _beyond(self, here: float) -> tuple[BalancePoint, str] | None:
        """A solution beyond a frequency."""
        last = self.points[-1].point
        nearest = min((each.point for each in self.points), key=lambda point: abs(point.trial.omega - here))
        for distance in DISTANCES:
            omega = here + self._direction * distance * self._width
            if (self._window[1] - omega) * self._direction < 0.0:
                return None
            found = self._settling.solution((last, nearest), omega, ramp=distance >= LEAST_RAMP)
            if found is not None:
                return found
        return None

    def _append(self, branch: Branch[BalancePointT], reverse: bool = False) -> None:
        points = branch.points[:0:-1] if reverse else branch.points
        self.points += points
        self.retreats += branch.retreats
        self.corners += branch.corners
        self.crossings += branch.crossings
        self.message = branch.message
