"""No corner where slip begins: beside a sample, and where a pair on its limit dips below it before it slips on."""

from __future__ import annotations

import numpy as np
import pytest
from friction_cases import make_pairs, sampled

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_events import onset_before_lift_off, onset_of_slip
from stickslip.contact.law.coulomb_harmonics import contact_cycle, harmonic_tangent
from stickslip.core.validation import FloatArray

SAMPLES = 64
BESIDE = 1e-7
LIMITS = (0.8, 0.7)  # at the start and the end of a step


def onsets(motion: FloatArray, pairs: ContactPairs) -> tuple[int, ...]:
    """The samples of one pair after which it begins to slip: it sticks up to them, and slips at the next ones."""
    cycle = contact_cycle(sampled(motion, SAMPLES), pairs)
    traction, normal = cycle.force[:, 0, :2], cycle.force[:, 0, 2]
    slips = np.hypot(traction[:, 0], traction[:, 1]) > (1.0 - 1e-12) * pairs.friction_coefficient[0] * normal
    return tuple(int(j) for j in np.flatnonzero(~slips & np.roll(slips, -1)))


def beside_change(low: float, high: float, pairs: ContactPairs, line: tuple[FloatArray, FloatArray]) -> list[float]:
    """Two places of a line of motions on both sides of the one where the samples of the onsets change.

    An onset within 1e-9 of a step behind a sample counts as slip that continues, so they are farther apart.
    """
    before = onsets(line[0] + low * line[1], pairs)
    while high - low > 1e-11:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if onsets(line[0] + middle * line[1], pairs) == before else (low, middle)
    return [low - BESIDE, high + BESIDE]


def test_the_derivative_does_not_jump_where_an_onset_passes_a_sample() -> None:
    """Slip in two directions under a varying load; the motion grows, so that slip begins earlier.

    The springs are equal: the step of unequal ones is of first order where T turns, and its corner remains.
    """
    motion = np.zeros((1, 3, 7))
    motion[0, 0, :5] = 0.0, 0.9, 0.1, 0.05, 0.02
    motion[0, 1, :5] = 0.0, 0.05, 0.2, 0.0, 0.05
    motion[0, 2, :3] = 0.1, 0.3, 0.2
    pairs = make_pairs(1, tangential_stiffness=2.0)
    line = motion, motion * np.array([1.0, 1.0, 0.0])[:, None]
    factors = np.linspace(0.0, 0.4, 81)
    seen = [onsets(motion + factor * line[1], pairs) for factor in factors]
    steps = [step for step in range(80) if len(seen[step]) == len(seen[step + 1]) and seen[step] != seen[step + 1]]
    assert len(steps) >= 4
    for step in steps:
        ends = beside_change(factors[step], factors[step + 1], pairs, line)
        before, after = (harmonic_tangent(motion + end * line[1], pairs, SAMPLES, [0]) for end in ends)
        assert np.abs(after - before).max() < 1e-4 * np.abs(before).max()


@pytest.mark.parametrize("ratios", [(1.0, 1.0), (1.0, 0.6)])
def test_a_dip_below_the_limit_vanishes_with_its_square(ratios: tuple[float, float]) -> None:
    """T is on the limit; the motion along it falls behind the limit by e, the motion across soon brings T back."""
    first, last = LIMITS
    corrections = []
    for e in (1e-4, 1e-5):
        theta, along, across = onset_of_slip(first, 0.0, last - first - e, 0.4, first, last, *ratios, 0.6, 0.3)
        assert theta == pytest.approx(2.0 * first * e / (0.4**2 - (2.0 * (last - first) - e) * e), rel=1e-2)
        corrections.append(np.hypot(along, across))
    assert corrections[0] == pytest.approx(100.0 * corrections[1], rel=1e-2)


def test_a_dip_before_lift_off_vanishes_with_its_square() -> None:
    """The limit falls to zero at a fraction of 2/3 of the step, and to -0.4 at its end."""
    corrections = [
        np.hypot(*onset_before_lift_off(0.8, 0.0, -1.2 - e, 0.5, 0.8, -0.4, 1.0, 1.0)[1:]) for e in (1e-4, 1e-5)
    ]
    assert corrections[1] > 0.0
    assert corrections[0] == pytest.approx(100.0 * corrections[1], rel=1e-2)


def test_on_a_straight_line_the_correction_is_that_of_the_trapezoidal_rule() -> None:
    """``theta (T_0 + d - T_1) / 2``: exact for a force that is linear before and after the onset."""
    first, last = LIMITS
    theta, along, across = onset_of_slip(0.3, 0.0, 1.0, 0.0, first, last, 1.0, 1.0, last, 0.0)
    assert theta == pytest.approx((first - 0.3) / (1.0 - last + first))
    assert along == pytest.approx(0.5 * theta * (0.3 + 1.0 - last))
    assert across == 0.0
