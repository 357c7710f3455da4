"""Points of a curve with more harmonics, by which a verdict on stability is confirmed or becomes doubtful.

Multipliers are those of small disturbances of the computed motion, with all harmonics of the disturbance. If the motion
lacks harmonics, contact opens and slips at other instants than in the structure. Then a multiplier can be far from its
value although the motion of the structure is accurate: on twins 0 of the torture set, 3 harmonics neglect 0.2 % of it,
but pairs are closed for 46 % of the period instead of 35 %, and a multiplier is 1.57 that does not exist with 7.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.fourier import with_rows
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.neglected import UNKNOWN, chord_of, more_harmonics, neglected

# The number of a point and its motion, with any number of harmonics, to the motion with more of them.
Correction = Callable[[int, Trial], Trial | None]

# chosen: so many points of a curve are corrected, and one of each part with one verdict; then those between a confirmed
# point and another one. All points of the bench blades would take up to 2.4 times the time of their curve.
FIRST_POINTS = 8


def correction_of(
    trials: Sequence[Trial], balance_of: Callable[[int, int], Balance], samples: int, damped_harmonics: int | None
) -> Correction:
    """The function that corrects a motion with more harmonics (:func:`neglected`), to None where that has no result.

    ``balance_of`` gives the balance for a number of harmonics and samples, ``damped_harmonics`` those whose resonances
    have damping (:func:`more_harmonics`). The points are in the order of a curve.
    """
    known, last, end = cache(balance_of), LastFactor(), len(trials) - 1

    def corrected(point: int, trial: Trial) -> Trial | None:
        harmonics = len(trial.relative) // 2
        more = more_harmonics(harmonics, 2 * samples, damped_harmonics)
        if more == harmonics:
            return None
        fine = known(more, samples if samples > 2 * more else 2 * samples)
        along = chord_of(trials[max(point - 1, 0)], trials[min(point + 1, end)])
        own = known(harmonics, samples if samples > 2 * harmonics else 2 * samples)
        estimate = neglected(trial, own, fine, along, last)
        if estimate.step is None or estimate.error >= UNKNOWN:
            return None
        relative = with_rows(trial.relative, 2 * more + 1) + estimate.step.unknowns
        return fine.evaluate(relative, trial.omega + float(estimate.step.parameters[0]), trial.load)

    return corrected


def unconfirmed_points(
    stable: BoolArray, moves: BoolArray, confirms: Callable[[Sequence[int]], Sequence[bool]]
) -> BoolArray:
    """Which points are not confirmed, from checks of some of them.

    Points without motion of a pair (``moves``) have no error. The others have the answer of the nearest checked one
    with the same verdict and no other verdict between; where neighbours differ, points between them are checked until
    none is left.

    Parameters
    ----------
    stable, moves:
        (n,) the verdicts, and whether pairs move.
    confirms:
        whether the verdicts of points are confirmed.
    """
    checked: dict[int, bool] = {}
    parts = np.cumsum(np.append(False, (stable[1:] != stable[:-1]) | (moves[1:] != moves[:-1])))
    wanted = _first_points(parts, moves)
    while wanted:
        checked |= dict(zip(wanted, confirms(wanted), strict=True))
        wanted = [
            (before + after) // 2
            for before, after in pairwise(sorted(checked))
            if parts[before] == parts[after] and checked[before] != checked[after] and after - before > 1
        ]
    answer = np.zeros(stable.size, dtype=bool)
    for point in np.flatnonzero(moves).tolist():
        beside = [each for each in checked if parts[each] == parts[point]]
        answer[point] = not checked[min(beside, key=lambda each: abs(each - point))]
    return answer


def _first_points(parts: np.ndarray, moves: BoolArray) -> list[int]:
    """FIRST_POINTS spread over the points where pairs move, and the middle one of each part of the curve."""
    moving = np.flatnonzero(moves)
    if not moving.size:
        return []
    spread = moving[np.linspace(0, moving.size - 1, min(FIRST_POINTS, moving.size)).round().astype(int)]
    middle = [int(np.flatnonzero(parts == part)[np.sum(parts == part) // 2]) for part in np.unique(parts[moving])]
    return sorted({*spread.tolist(), *middle})
