"""Stability by folds: a curve under a constant force turns in frequency exactly where a multiplier is 1."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.stability.disturbances import ComplexArray

# A real multiplier this close to 1 does not decide by itself. A pair that has just begun to slip moves it by as much,
# but only for disturbances smaller than the slip: on the benchmark blade with half its preload from 1.044 to 0.995 and
# back within two points between the folds, where time integration leaves the motion after a disturbance of 1 %.
NEAR_FOLD = 0.01
# chosen: the same for this multiple of the distance from 1 of the multiplier at a fold beside the point. Beyond the
# second number the fold says nothing about other points: it is a wrinkle of the curve, or the solution has far too few
# harmonics (0.37 on beam 2 of the torture set with 3, where time integration leaves points with multipliers of 1.5).
FOLD_MARGIN, LARGEST_FOLD_ERROR = 1.2, 0.1


@dataclass(frozen=True)
class Fold:
    """A turning point of a curve.

    Attributes
    ----------
    position:
        number of the point before it, plus the fraction of the way to the next one.
    omega:
        the extremal rad/s there.
    error:
        distance of the multiplier from 1 there. It has an error by the harmonics that the solution neglects and a
        disturbance contains: on the benchmark blade with 110 contacts 0.09 with 3 harmonics and 0.01 with 5.
    """

    position: float
    omega: float
    error: float


def folds_of(omega: FloatArray, values: Sequence[ComplexArray]) -> list[Fold]:
    """The folds of a curve with these frequencies (n,) and the multipliers of each point."""
    change = np.diff(omega)
    folds = []
    for point in (np.flatnonzero(change[1:] * change[:-1] < 0.0) + 1).tolist():
        around = slice(point - 1, point + 2)
        position, value = _vertex(omega[around])
        folds.append(Fold(point + position, value, _distance_from_one(values[around])))
    return folds


def sided_counts(
    counts: Sequence[int], possible: Sequence[range], near_one: Sequence[bool], folds: Sequence[Fold]
) -> list[int]:
    """Numbers of real multipliers above 1, where those of doubtful points follow from their side of the folds.

    A point is doubtful if several numbers are ``possible``. It has the possible number nearest to that of the nearest
    sure point between the same folds; without one, as between the folds of a small wrinkle, to that of the nearest
    point not ``near_one``; without one to 0 before the first fold, which changes at each.
    """
    side = np.searchsorted([fold.position for fold in folds], np.arange(len(counts)))
    doubtful = [len(each) > 1 for each in possible]
    answer = list(counts)
    for point in np.flatnonzero(doubtful).tolist():
        beside = np.flatnonzero(side == side[point]).tolist()
        sure = [each for each in beside if not doubtful[each]] or [each for each in beside if not near_one[each]]
        number = counts[min(sure, key=lambda each: abs(each - point))] if sure else int(side[point]) % 2
        answer[point] = min(max(number, possible[point][0]), possible[point][-1])
    return answer


def beside_folds_without_change(positive: Sequence[int], stable: BoolArray, folds: Sequence[Fold]) -> BoolArray:
    """(n,) stable points beside folds at which the numbers of real multipliers above 1 do not change.

    One of both sides must have another number, if the curve turns there. Where a stuck pair comes to a second limit no
    multiplier tells which: it jumps past 1 as soon as the pair slips, and the number changes some points later, or
    never in the points of a wrinkle. So it is the side that ends at another such fold or at a change without a fold,
    the shorter one if both or neither do.
    """
    last = len(positive) - 1
    changes = {fold.position: 0 for fold in folds}
    free = []  # changes that belong to no fold
    for point in range(last):
        if positive[point] != positive[point + 1]:
            fold = fold_at(point, folds)
            if fold is None:
                free.append(point + 0.5)
            else:
                changes[fold.position] += 1
    turns = [position for position, count in changes.items() if count % 2 == 0]
    ends, unexplained = sorted([-1.0, *changes, *free, last + 1.0]), {*turns, *free}
    answer = np.zeros(len(positive), dtype=bool)
    for turn in turns:
        place = ends.index(turn)
        before, after = ends[place - 1], ends[place + 1]
        sides = [(before, turn, before in unexplained), (turn, after, after in unexplained)]
        chosen = [side for side in sides if side[2]] or sides
        start, stop, _ = min(chosen, key=lambda side: side[1] - side[0])
        answer[max(0, math.ceil(start)) : math.floor(stop) + 1] = True
    return np.asarray(answer & stable)


def fold_at(point: int, folds: Sequence[Fold]) -> Fold | None:
    """The nearest fold to which a change between a point and the next one belongs; None if there is none."""
    near = [fold for fold in folds if point - 1 <= fold.position <= point + 2]
    return min(near, key=lambda fold: abs(fold.position - point - 0.5), default=None)


def doubtful_range(point: int, folds: Sequence[Fold]) -> float:
    """Distance from 1 up to which a real multiplier of a point does not decide."""
    before = [fold.error for fold in folds if fold.position < point][-1:]
    after = [fold.error for fold in folds if fold.position >= point][:1]
    return max([NEAR_FOLD, *(FOLD_MARGIN * error for error in before + after if error <= LARGEST_FOLD_ERROR)])


def _distance_from_one(values: Sequence[ComplexArray]) -> float:
    """Smallest distance of a multiplier from 1 at neighbouring points; 0 if it passes 1 between them."""
    nearest = [each[np.abs(each - 1.0).argmin()] for each in values]
    sizes = [float(np.copysign(abs(each - 1.0), each.real - 1.0)) for each in nearest]
    return 0.0 if min(sizes) < 0.0 < max(sizes) else min(map(abs, sizes))


def _vertex(values: FloatArray) -> tuple[float, float]:
    """Position, from the middle, and value of the extremum of the parabola through three values."""
    before, here, after = map(float, values)
    bend, slope = before - 2.0 * here + after, after - before
    return -0.5 * slope / bend, here - slope**2 / (8.0 * bend)
