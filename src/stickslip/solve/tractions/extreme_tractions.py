"""Extreme peaks over the residual tractions of the pairs: local optimisation with adjoint gradients, from given starts.

The tractions T0 are admissible, ``|T0| <= mu N`` at each pair: a disc. The amplitude of a peak is the larger of two
extremes of the output over the period, with derivatives by all tractions from one transposed solution each
(``traction_sensitivity.py``). In tractions y over their limits, a step of length L from y leads to

    highest:  P(y + L g)                                                          P: projection on the discs
    lowest:   argmin over z of  max(a1 + g1 . (z - y), a2 + g2 . (z - y)) + |z - y|^2 / (2 L)

The second problem has a dual with one unknown, the weight of the first extreme: ``z = P(y - L (w g1 + (1 - w) g2))``.
A step that gains too little of what it promises is shortened (projected gradient and prox-linear method: A. S. Lewis
and S. J. Wright, Math. Program. 158, 2016). Nothing of this excludes a higher or lower peak elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.optimize

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.peak import BoundedCurve, CurvePeak, PeakSearch
from stickslip.solve.harmonic.traction_sensitivity import Quantity, TractionSensitivity
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.setting_up import Balances

# chosen: relative rise that is left to a parabola at a peak: a hundredth of what a step gains at least.
LAST_RISE = 1e-6
# chosen: the search ends where no tractions promise this fraction more, to first order, where STEPS steps together gain
# less than a tenth of it, where steps of SHORTEST no longer gain, or after so many steps.
WORTHWHILE, STEPS, SHORTEST, MOST_STEPS = 2e-4, 3, 1e-3, 30
# chosen: a step counts if it gains this fraction of what it promises, and the next is longer if it gains GOOD.
ENOUGH, GOOD, LONGER, SHORTER = 0.1, 0.5, 2.0, 0.3
# Accuracy of the weight of the dual problem, with a reserve.
WEIGHT_ACCURACY = 1e-4
# chosen: a way that Newton's method does not take at once is halved so many times; a step is shortened anyway.
HALVINGS, HALVINGS_OF_STEPS = 2, 1
# chosen: most iterations of Newton's method in one search of a peak, five times the usual number: where all pairs of a
# large joint bounce, an iteration takes seconds, and a search that does not arrive soon does not arrive.
MOST_ITERATIONS = 60
# chosen: a search for an extreme ends where so many of its steps lost the peak; later steps have at most this fraction
# of the length of the last one that did.
MOST_LOST, BELOW_LOST = 5, 0.9


def with_residual_traction(pairs: ContactPairs, traction: FloatArray) -> ContactPairs:
    """The pairs with a traction at rest (n_pairs, 2) N, retained by those with Coulomb friction."""
    laws = [
        law.with_traction(traction[members]) if isinstance(law, FrictionLaw) else law
        for law, members in zip(pairs.laws, pairs.members, strict=True)
    ]
    return ContactPairs.with_laws(pairs.operator, laws, pairs.members)


class _TooMuchWorkError(Exception):
    """A search took more iterations than it may."""


@dataclass(frozen=True)
class TractionPeak:
    """A peak with a residual traction (n_pairs, 2) N, and both extremes of the output there."""

    traction: FloatArray
    peak: CurvePeak
    extremes: tuple[Quantity, Quantity]

    @property
    def amplitude(self) -> float:
        """The larger of the extremes."""
        return max(each.value for each in self.extremes)


class PeakOverTractions:
    """One peak as a function of the residual tractions.

    Parameters
    ----------
    balances:
        with pairs that retain tractions.
    output:
        (n,) row.
    window:
        (low, high) of the frequency in rad/s.
    """

    def __init__(
        self,
        balances: Balances,
        harmonics: int,
        output: FloatArray,
        window: tuple[float, float],
        newton: NewtonSettings,
        on_iteration: Callable[[int, float], None] | None = None,
    ) -> None:
        self._balances, self._output, self._window = balances, output, (min(window), max(window))
        self._near, self._exact = (
            each(harmonics, balances.samples) for each in (balances.with_harmonics, balances.exact)
        )
        self._newton, self._listen, self._last = newton, on_iteration, LastFactor()
        self._left = 0

    def near(self, traction: FloatArray, point: BalancePoint) -> TractionPeak | None:
        """The peak near a point of the curve with this traction; None where the search fails."""
        return self._found(traction, lambda search: search.from_point(point))

    def moved(self, start: TractionPeak, traction: FloatArray, halvings: int = HALVINGS) -> TractionPeak | None:
        """The peak that a peak becomes with another traction; None where it gets lost on the way."""
        probe = start.peak.probe
        after = self._found(
            traction,
            lambda search: search.from_estimate(
                probe.point.unknowns, probe.point.trial.omega, probe.tangent, start.peak.curvature
            ),
        )
        if after is not None or not halvings:
            return after
        middle = self.moved(start, 0.5 * (start.traction + traction), halvings - 1)
        return None if middle is None else self.moved(middle, traction, halvings - 1)

    def _search(self, traction: FloatArray) -> PeakSearch:
        curve = BoundedCurve(self._with_traction(self._near, traction), self._last, self._window)
        return PeakSearch(
            curve, Newton(curve, self._newton, self._count), self._output,
            lambda trial: self._balances.mean_row(trial, self._output), self._last, LAST_RISE,
        )  # fmt: skip

    def _count(self, number: int, error: float) -> None:
        """Report an iteration; raises _TooMuchWorkError after too many of one search."""
        if self._listen is not None:
            self._listen(number, error)
        self._left -= 1
        if self._left < 0:
            raise _TooMuchWorkError

    @staticmethod
    def _with_traction(balance: Balance, traction: FloatArray) -> Balance:
        return Balance(
            balance.compliance, with_residual_traction(balance.pairs, traction), balance.force, balance.samples
        )

    def _found(self, traction: FloatArray, searched: Callable[[PeakSearch], CurvePeak | str]) -> TractionPeak | None:
        self._left = MOST_ITERATIONS
        try:
            peak = searched(self._search(traction))
        except _TooMuchWorkError:
            return None
        if isinstance(peak, str):
            return None
        point, along = peak.probe.point, peak.probe.tangent.unknowns
        sensitivity = TractionSensitivity(self._with_traction(self._exact, traction), point, along)
        of_mean = self._balances.mean_row(point.trial, self._output)
        first, second = sensitivity.extremes(self._output, of_mean)
        if not all(np.isfinite(each.derivative).all() for each in (first, second)):
            return None
        still = np.zeros_like(traction)
        return TractionPeak(traction, peak, (replace(first, released=still), replace(second, released=still)))


# (extremes, traction, limit, length of the step) -> traction ahead, and the amplitude that it promises to first order.
Selection = Callable[[Sequence[Quantity], FloatArray, FloatArray, float], tuple[FloatArray, float]]


def highest(
    extremes: Sequence[Quantity], traction: FloatArray, limit: FloatArray, length: float = math.inf
) -> tuple[FloatArray, float]:
    """A step that raises the larger of the extremes; with an infinite length the extreme tractions to first order."""
    choices = []
    for each in extremes:
        there = _ahead(traction, limit[:, None] * each.by_traction, limit, length)
        choices.append((there, each.value + float(np.vdot(each.by_traction, there - traction))))
    return max(choices, key=lambda choice: choice[1])


def lowest(
    extremes: Sequence[Quantity], traction: FloatArray, limit: FloatArray, length: float = math.inf
) -> tuple[FloatArray, float]:
    """A step that lowers the larger of the extremes, by the dual problem of one weight."""
    first, second = extremes
    y = _over(traction, limit)

    def ahead(weight: float) -> FloatArray:
        mixed = weight * first.by_traction + (1.0 - weight) * second.by_traction
        return _ahead(traction, -limit[:, None] * mixed, limit, length)

    def values(there: FloatArray) -> list[float]:
        return [each.value + float(np.vdot(each.by_traction, there - traction)) for each in extremes]

    def negative_dual(weight: float) -> float:
        there = ahead(weight)
        one, other = values(there)
        return -(weight * one + (1.0 - weight) * other + float(((_over(there, limit) - y) ** 2).sum()) / (2.0 * length))

    weight = float(scipy.optimize.minimize_scalar(negative_dual, bounds=(0.0, 1.0), method="bounded").x)
    # Tractions jump where the mixed derivative of a pair vanishes: the solution is between those of both sides.
    before, after = (ahead(min(1.0, max(0.0, weight + side * WEIGHT_ACCURACY))) for side in (-1.0, 1.0))
    (one, other), (one_after, other_after) = values(before), values(after)
    bend = (one - other) - (one_after - other_after)
    crossing = min(1.0, max(0.0, (one - other) / bend)) if bend else 0.0
    fractions = (0.0, crossing, 1.0)
    choices = [before + fraction * (after - before) for fraction in fractions]
    return min(((there, max(values(there))) for there in choices), key=lambda choice: choice[1])


def local_extreme(
    peaks: PeakOverTractions,
    start: TractionPeak,
    select: Selection,
    limit: FloatArray,
    is_used_up: Callable[[], bool] = lambda: False,
) -> TractionPeak:
    """The peak that no small change of the tractions raises (or lowers) further, from a start.

    It is the best one so far if ``is_used_up`` says that no more work is allowed.
    """
    best = start
    largest = max(float(np.hypot(*(limit[:, None] * each.derivative).T).max()) for each in best.extremes)
    if largest == 0.0:
        return best  # no pair slips: small changes of tractions have no effect
    full = 2.0 / largest  # the most sensitive pair crosses its disc
    length = full
    reached, lost, longest = [best.amplitude], 0, math.inf
    for _ in range(MOST_STEPS):
        if is_used_up():
            break
        promised = select(best.extremes, best.traction, limit, math.inf)[1]
        if abs(promised - best.amplitude) <= WORTHWHILE * best.amplitude:
            break
        traction, promised = select(best.extremes, best.traction, limit, length)
        gain = promised - best.amplitude
        after = peaks.moved(best, traction, HALVINGS_OF_STEPS)
        gained = 0.0 if after is None else (after.amplitude - best.amplitude) / gain if gain else 0.0
        if after is not None and gained >= ENOUGH:
            best = after
            length = min(longest, length * (LONGER if gained >= GOOD else 1.0))
        elif (after is None and lost == MOST_LOST) or length <= SHORTEST * full:
            break
        else:
            if after is None:
                lost, longest = lost + 1, BELOW_LOST * length
            length *= SHORTER
            continue
        reached.append(best.amplitude)
        if len(reached) > STEPS and abs(reached[-1] - reached[-1 - STEPS]) <= 0.1 * WORTHWHILE * best.amplitude:
            break
    return best


def _over(traction: FloatArray, limit: FloatArray) -> FloatArray:
    """(n_pairs, 2) tractions over their limits; zero without one."""
    return np.divide(traction, limit[:, None], out=np.zeros_like(traction), where=limit[:, None] > 0.0)


def _ahead(traction: FloatArray, direction: FloatArray, limit: FloatArray, length: float) -> FloatArray:
    """The admissible traction a step ahead: ``limit * P(traction / limit + length * direction)``.

    With an infinite length the limit along the direction of each pair, and zero where that is zero.
    """
    ahead = direction if math.isinf(length) else _over(traction, limit) + length * direction
    size = np.hypot(ahead[:, 0], ahead[:, 1])
    longest = size if math.isinf(length) else np.maximum(size, 1.0)
    unit = np.divide(ahead, longest[:, None], out=np.zeros_like(ahead), where=longest[:, None] > 0.0)
    return np.asarray(limit[:, None] * unit)
