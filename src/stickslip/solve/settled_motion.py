"""Whether the harmonic balance gives a motion to which a time integration settled, and with how many harmonics."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from stickslip.core.resolution import SAMPLES_PER_HARMONIC
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.start import at_frequency
from stickslip.solve.path.newton import Newton
from stickslip.solve.setting_up import CurveBalances

# chosen: the motion is looked for with so many times the harmonics, if the equations have no more rows than this; a
# solution farther from it than this fraction is another motion.
MORE_HARMONICS, MOST_ROWS, SAME = (1, 2, 4, 8), 12_000, 0.05
# chosen: a thorough search continues to these multiples, with so many samples for each harmonic, and iterates longer,
# if the equations have no more rows than this. Contact that opens and is a thousand times stiffer than the structure
# (stiff 0 of the torture set) requires 25 iterations, and 48 harmonics for 6 %, 96 for 1.6 %.
MANY_HARMONICS, SAMPLES_OF_MANY, MANY_ITERATIONS, MANY_ROWS = (16, 32), 8, 40, 3_000


@dataclass(frozen=True)
class SettledMotion:
    """What a search for a settled motion found.

    tried:
        largest number of harmonics that was tried; None without any.
    given_by, samples, away:
        number of harmonics and samples with which the harmonic balance gives it, None if no number does; relative
        distance of that solution.
    neglected:
        fraction of the vibration of the pairs in harmonics above those of the curve.
    motion:
        the solution, if the curve can take its samples.
    """

    tried: int | None = None
    given_by: int | None = None
    samples: int | None = None
    away: float = 0.0
    neglected: float | None = None
    motion: BalancePoint | None = field(default=None, repr=False, compare=False)


NOT_SOUGHT = SettledMotion()


def settled_motion(
    newton: Newton[BalancePoint],
    balances: CurveBalances,
    harmonics: int,
    omega: float,
    unknowns: Callable[[int], FloatArray],
    most: int,
    thorough: bool,
    any_samples: bool = False,
) -> SettledMotion:
    """Look for a motion at ``omega`` rad/s that has the coefficients ``unknowns(H)`` with any H up to ``most``.

    ``harmonics`` are those of the curve, of which ``newton`` has the settings. With samples of its own a ``thorough``
    search also tries numbers that the samples of the curve do not resolve; the curve can take their solutions only with
    ``any_samples``.
    """
    tried, whole = None, unknowns(most)
    neglected = _norm(whole[2 * harmonics + 1 :]) / max(_norm(whole[1:]), 1e-300)
    usual = newton.settings
    longer = replace(usual, max_iterations=max(MANY_ITERATIONS, usual.max_iterations))
    for number, samples, is_longer in _numbers(balances, harmonics, most, thorough):
        tried, guess = number, unknowns(number)
        curve = FrequencyCurve(balances.with_harmonics(number, samples))
        solver = Newton(curve, longer if is_longer else usual, newton.on_iteration)
        point = at_frequency(solver, curve, guess, omega).point
        away = _norm(point.unknowns[1:] - guess[1:]) / max(_norm(guess[1:]), 1e-300)
        if point.error <= usual.tolerance and away <= SAME:
            usable = point if any_samples or samples == balances.samples else None
            return SettledMotion(tried, number, samples, away, neglected, usable)
    return SettledMotion(tried, neglected=neglected)


def enough_samples(harmonics: int, samples: int) -> int:
    """The samples of a curve if they resolve a number of harmonics, or those of a solution with so many."""
    return samples if SAMPLES_PER_HARMONIC * harmonics <= samples else SAMPLES_OF_MANY * harmonics


def _numbers(balances: CurveBalances, harmonics: int, most: int, thorough: bool) -> Iterator[tuple[int, int, bool]]:
    """Numbers of harmonics to try, their samples, and whether Newton's method may take longer."""
    for multiple in (*MORE_HARMONICS, *MANY_HARMONICS):
        number, samples = multiple * harmonics, balances.samples
        rows = 3 * balances.pairs.n_pairs * (2 * number + 1)
        is_longer = thorough and rows <= MANY_ROWS
        if is_longer:
            samples = enough_samples(number, samples)
        if SAMPLES_PER_HARMONIC * number > samples or rows > MOST_ROWS or number > most:
            return
        if is_longer or multiple in MORE_HARMONICS:
            yield number, samples, is_longer


def _norm(coefficients: FloatArray) -> float:
    return float(np.linalg.norm(coefficients))
