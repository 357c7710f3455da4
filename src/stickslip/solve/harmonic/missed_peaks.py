"""A search for peaks that a finished frequency curve has stepped over, independent of the steps of the curve."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.curves import BalancePointT
from stickslip.solve.path.landmarks import Landmark
from stickslip.solve.path.newton import Newton
from stickslip.solve.path.problem import Plane

# In half-power widths: places of the search beside a natural frequency, and the distance at which a point of the curve
# is at such a place already.
PLACES, NEAR = (-0.5, 0.0, 0.5), 0.125
# A missed peak exceeds both points of the curve beside it by this factor, and this fraction of the highest point: lower
# ones are invisible in a plot.
HIGHER, VISIBLE = 1.01, 0.01
# Steps up to this number of half-power widths w hide no such peak. Over a step of one width the tangents of a resonance
# of height c turn by 180 degrees. The step turns by 45 degrees or less only if c is below 0.41 w over the range, in
# units of the motion; both ends have 0.7 c or more, so the peak is 0.12 w over the range above them. Steps are at most
# 0.08 of the range (ContinuationSettings): 1 %.
LONG = 1.0


@dataclass(frozen=True)
class MissedPeak:
    """A solution beside the curve: frequency in Hz, and its motion over the larger one of the points beside it."""

    frequency_hz: float
    factor: float


@dataclass(frozen=True)
class PeakCheck:
    """The extent of the search, and its result."""

    natural_frequencies: int
    narrowest_hz: float  # smallest half-power width
    solved: int  # places with a solution of their own; at the others the curve has points
    failed_hz: tuple[float, ...]  # places without a solution
    missed: tuple[MissedPeak, ...]

    def words(self, limits: tuple[str, ...] = ("stuck", "free", "tangent")) -> str:
        """One sentence; ``limits`` are the structures whose natural frequencies were checked."""
        if not self.natural_frequencies:
            listed = f"{', '.join(limits[:-1])} or {limits[-1]}"
            return f"no natural frequency of the {listed} structure in the range is excited"
        return (
            f"{self.natural_frequencies} natural frequencies ({', '.join(limits)}) checked, narrowest half-power "
            f"width {self.narrowest_hz:.2g} Hz; {self.solved} places between points solved again, "
            f"{len(self.failed_hz)} without a solution; {len(self.missed)} missed peaks"
        )

    def warnings(self) -> tuple[str, ...]:
        """A warning for missed peaks, and one for places where the search has no answer."""
        return self._missed_warning() + self._failed_warning()

    def _missed_warning(self) -> tuple[str, ...]:
        if not self.missed:
            return ()
        worst = highest_of(self.missed)
        places = in_hz(each.frequency_hz for each in self.missed)
        return (
            f"The curve stepped over narrow peaks near {places} Hz: at {worst.frequency_hz:.3f} Hz the motion is "
            f"{worst.factor:.3g} times that of the points beside it. Run this part of the range again with a smaller "
            "largest_step (ContinuationSettings), or as a range of its own.",
        )

    def _failed_warning(self) -> tuple[str, ...]:
        if not self.failed_hz:
            return ()
        places = in_hz(self.failed_hz)
        return (
            f"The search for narrow peaks has no answer near {places} Hz, between points of the curve beside a natural "
            "frequency: Newton does not converge there. Run this part of the range again as a range of its own.",
        )


def highest_of(missed: Iterable[MissedPeak]) -> MissedPeak:
    """The missed peak that is the most above the curve."""
    return max(missed, key=lambda each: each.factor)


def in_hz(frequencies_hz: Iterable[float]) -> str:
    """Places of a curve in words."""
    return ", ".join(f"{each:.3f}" for each in frequencies_hz)


def search_missed_peaks(
    newton: Newton[BalancePointT],
    points: Sequence[BalancePointT],
    landmarks: Sequence[Landmark],
    begin: Callable[[BalancePointT], None] = lambda point: None,
) -> PeakCheck:
    """Solve at and beside each natural frequency (rad/s) in the range where a curve has no point.

    Each time the curve passes such a place the solution starts from the interpolated motion of the points beside it.
    Where points have different numbers of harmonics, ``begin`` sets those of a point: a place has the larger number of
    both points.
    """
    omega = np.array([point.trial.omega for point in points])
    sizes = np.array([np.linalg.norm(point.measured) for point in points])
    inside = _distinct(each for each in landmarks if omega.min() < each.value < omega.max())
    solved, failed, missed = 0, [], []
    for landmark in inside:
        for place in PLACES:
            target = landmark.value + place * landmark.width
            crosses = (omega[:-1] - target) * (omega[1:] - target) < 0.0
            nearest = np.minimum(np.abs(omega[:-1] - target), np.abs(omega[1:] - target))
            is_long = np.abs(np.diff(omega)) > LONG * landmark.width
            for left in np.flatnonzero(crosses & is_long & (nearest > NEAR * landmark.width)):
                before, after = points[int(left)], points[int(left) + 1]
                begin(max(before, after, key=lambda each: len(each.trial.amplitude)))
                size = _size_at(newton, before, after, target)
                solved += 1
                beside = float(sizes[left : left + 2].max())
                if size is None:
                    failed.append(target)
                elif size > HIGHER * beside and size > VISIBLE * sizes.max():
                    missed.append(MissedPeak(_hz(target), size / beside))
    narrowest = min((each.width for each in inside), default=math.inf)
    return PeakCheck(len(inside), _hz(narrowest), solved, tuple(map(_hz, failed)), tuple(missed))


def _distinct(landmarks: Iterable[Landmark]) -> list[Landmark]:
    """One of those that are the same place for the search, the narrowest."""
    answer: list[Landmark] = []
    for each in sorted(landmarks, key=lambda landmark: landmark.width):
        if all(abs(each.value - other.value) > NEAR * other.width for other in answer):
            answer.append(each)
    return answer


def _size_at(newton: Newton[BalancePointT], before: BalancePointT, after: BalancePointT, omega: float) -> float | None:
    """Mass norm of the solution at a frequency between two points of a curve; None if there is none."""
    share = (omega - before.trial.omega) / (after.trial.omega - before.trial.omega)
    guess: FloatArray = before.unknowns + share * (after.unknowns - before.unknowns)
    correction = newton.correct(newton.problem.evaluate(guess, np.array([omega])), Plane.fixed(guess, omega))
    return float(np.linalg.norm(correction.point.measured)) if correction.converged else None


def _hz(omega: float) -> float:
    return omega / (2.0 * math.pi)
