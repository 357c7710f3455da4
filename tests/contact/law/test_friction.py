"""The friction law over a period: closed forms with their convergence slopes, the steps, shakedown, bad input."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from friction_cases import make_pairs, random_case, sampled
from numpy.typing import ArrayLike

from sentences import rejects
from stickslip.contact.law.closed_forms import (
    FrictionLoop,
    circular_force,
    in_phase_loop,
    jenkins_loop,
    quadrature_loop,
)
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_energy import step_dissipation
from stickslip.contact.law.coulomb_harmonics import Update, contact_cycle, harmonic_force, harmonic_tangent
from stickslip.contact.law.coulomb_kernel import SLIP, STICK, advance, inverse_mean_limit
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray

SPRING, FRICTION, AMPLITUDE = 3.0, 0.4, 1.1
COUNTS = [64, 128, 256, 512, 1024]

# name: (closed form, preload, normal motion)
LOOPS: dict[str, tuple[FrictionLoop, float, Callable[[FloatArray], FloatArray]]] = {
    "jenkins": (jenkins_loop(SPRING, FRICTION, 2.0, AMPLITUDE), 2.0, lambda t: 0.0 * t),
    "in phase": (in_phase_loop(SPRING, FRICTION, 2.0, 1.1, AMPLITUDE), 2.0, lambda t: 1.1 * np.cos(t)),
    "quadrature": (quadrature_loop(SPRING, FRICTION, 2.0, 1.1, AMPLITUDE), 2.0, lambda t: 1.1 * np.sin(t)),
    "separation": (in_phase_loop(SPRING, FRICTION, 1.0, 2.5, AMPLITUDE), 1.0, lambda t: 2.5 * np.cos(t)),
}


def loop_errors(name: str, samples: int) -> FloatArray:
    """Largest error over eight sub-sample phases of F0, a1, b1 (by |b1|), W (relative) and the signal (by mu N0)."""
    loop, preload, normal = LOOPS[name]
    worst = np.zeros(5)
    for phase in np.arange(8) / 8.0:
        t = 2.0 * np.pi * (np.arange(samples) + phase) / samples
        motion = np.stack([AMPLITUDE * np.cos(t), 0.0 * t, normal(t)], axis=-1)[:, None]
        cycle = contact_cycle(motion, make_pairs(1, preload=preload))
        force = cycle.force[:, 0, 0]
        actual = np.array([force.mean(), 2.0 * np.mean(force * np.cos(t)), 2.0 * np.mean(force * np.sin(t))])
        scale = abs(loop.coefficients[2])
        errors = [
            *(np.abs(actual - loop.coefficients) / scale),
            abs(cycle.dissipated_energy[0] / loop.dissipated_energy - 1.0),
            np.abs(force - loop.force(t)).max() / (FRICTION * preload),
        ]
        worst = np.maximum(worst, errors)
    return worst


def slope(errors: ArrayLike) -> float:
    return float(-np.polyfit(np.log(COUNTS), np.log(errors), 1)[0])


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_closed_loops_and_their_convergence(name: str) -> None:
    """Second order in energy and signal; the coefficients follow the scatter of kinks between samples, about 1.7-2."""
    table = np.array([loop_errors(name, samples) for samples in COUNTS])
    at_256 = table[COUNTS.index(256)]
    assert at_256[:3].max() < 3.5e-4
    assert at_256[3] < 1.2e-4
    assert at_256[4] < 5e-4
    assert 1.95 < slope(table[:, 3]) < 2.05
    assert 1.95 < slope(table[:, 4]) < 2.05
    for column in (1, 2):
        assert 1.6 < slope(table[:, column]) < 2.3


@pytest.mark.parametrize(("update", "order", "at_256"), [("tractrix", 2.0, 9e-4), ("radial", 1.0, 5e-2)])
def test_circular_path(update: Update, order: float, at_256: float) -> None:
    """The tractrix pays: same marches, second order instead of first, 57 times closer in the radial part at 256."""
    exact = circular_force(SPRING, FRICTION, 2.0, AMPLITUDE)
    errors = []
    for samples in COUNTS:
        t = 2.0 * np.pi * np.arange(samples) / samples
        motion = np.stack([AMPLITUDE * np.cos(t), AMPLITUDE * np.sin(t), 0.0 * t], axis=-1)[:, None]
        cycle = contact_cycle(motion, make_pairs(1), update)
        force = cycle.force[:, 0]
        radial = np.mean(force[:, 0] * np.cos(t) + force[:, 1] * np.sin(t))
        tangential = np.mean(force[:, 1] * np.cos(t) - force[:, 0] * np.sin(t))
        energy = cycle.dissipated_energy[0]
        errors.append(
            [radial / exact.radial - 1, tangential / exact.tangential - 1, energy / exact.dissipated_energy - 1]
        )
        assert cycle.closure[0] <= 1e-12
    table = np.abs(errors)
    assert table[COUNTS.index(256), 0] < at_256
    for column in range(3):
        assert order - 0.1 < slope(table[:, column]) < order + 0.1


def radial_return_in_steps(force: FloatArray, move: FloatArray, first: float, last: float, steps: int) -> FloatArray:
    """The law by its definition, k = 1: backward Euler with many small radial returns, limit linear in the step.

    Returns T1, T2 and the dissipated energy, limit times slip summed up.
    """
    energy, before = 0.0, max(first, 0.0)
    for step in range(1, steps + 1):
        limit = max(first + (last - first) * step / steps, 0.0)
        trial = force + move / steps if before > 0.0 or first >= 0.0 else np.zeros(2)
        size = np.hypot(*trial)
        force = trial if size <= limit else trial * (limit / size)
        energy += 0.5 * (before + limit) * (size - limit) if size > limit and before > 0.0 else 0.0
        before = limit
    return np.array([*force, energy])


STEPS: dict[str, tuple[list[float], list[float], float, float]] = {
    "stick then turn": ([0.3, 0.2], [0.5, 1.4], 1.0, 1.1),
    "on the limit, forward": ([0.6, 0.8], [1.0, 0.1], 1.0, 0.7),
    "on the limit, back across the disc": ([0.6, 0.8], [-2.0, -2.5], 1.0, 1.2),
    "nearly opposite, shrinking limit": ([0.999, 0.0447], [-0.5, 0.0], 1.0001, 0.3),
    "no motion, shrinking limit": ([0.6, 0.8], [0.0, 0.0], 1.0, 0.4),
    "tiny motion, shrinking limit": ([0.6, 0.8], [1e-12, -1e-12], 1.0, 0.4),
    "long way": ([0.6, -0.8], [0.0, 30.0], 1.0, 1.5),
    "growing limit catches up": ([1.0, 0.0], [0.3, 0.4], 1.0, 1.6),
    "touchdown": ([0.0, 0.0], [1.0, -2.5], -0.5, 1.5),
    "touchdown that sticks": ([0.0, 0.0], [0.2, -0.3], -0.5, 1.5),
    "lift-off": ([0.3, 0.4], [1.0, 0.5], 0.5, -0.5),
}


def tractrix_step(force: FloatArray, move: FloatArray, first: float, last: float, tractrix: bool = True) -> FloatArray:
    """T1, T2 and energy of one step of the code, k = 1."""
    t1, t2, code = advance(*force, *move, first, last, 1.0, 1.0, tractrix)
    slips = code != STICK and max(first, last) > 0.0
    energy = step_dissipation(*force, *move, first, last, t1, t2, 1.0, 1.0, tractrix) if slips else 0.0
    return np.array([t1, t2, energy])


@pytest.mark.slow
@pytest.mark.parametrize("name", STEPS)
def test_one_tractrix_step_against_small_radial_steps(name: str) -> None:
    force, move, first, last = STEPS[name]
    coarse, fine = (radial_return_in_steps(np.array(force), np.array(move), first, last, n) for n in (4000, 8000))
    actual = tractrix_step(np.array(force), np.array(move), first, last)
    np.testing.assert_allclose(actual[:2], (2.0 * fine - coarse)[:2], atol=2e-5)
    # The three-point rule of the energy is exact unless T turns far within one step.
    assert actual[2] == pytest.approx(2.0 * fine[2] - coarse[2], rel=2e-2, abs=1e-5)


@pytest.mark.parametrize("name", ["touchdown", "touchdown that sticks"])
def test_touchdown_energy_is_exact(name: str) -> None:
    """From zero force the slider runs straight: half the limit times the closed part of the motion less the stretch."""
    force, move, first, last = STEPS[name]
    length = math.hypot(*move) * last / (last - first)
    exact = 0.5 * last * max(length - last, 0.0)
    for tractrix in (True, False):
        assert tractrix_step(np.array(force), np.array(move), first, last, tractrix)[2] == pytest.approx(
            exact, rel=1e-12
        )


@pytest.mark.slow
def test_random_tractrix_steps_against_small_radial_steps() -> None:
    rng = np.random.default_rng(4)
    for _ in range(40):
        first, last = rng.uniform(0.1, 2.0, 2)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        force = first * rng.choice([1.0, rng.uniform(0.0, 1.0)]) * np.array([np.cos(angle), np.sin(angle)])
        move = rng.normal(size=2) * 10.0 ** rng.uniform(-1.0, 1.0)
        coarse, fine = (radial_return_in_steps(force, move, first, last, n) for n in (1000, 2000))
        actual = tractrix_step(force, move, first, last)
        np.testing.assert_allclose(actual[:2], (2.0 * fine - coarse)[:2], atol=1e-4 * (1.0 + np.hypot(*move)))


def test_tractrix_extremes_stay_on_the_limit() -> None:
    """Opposite to the motion, vanishing limits, and decays that underflow give finite forces on the limit."""
    for force, move, first, last in [
        ([-1.0, 0.0], [1e-3, 0.0], 1.0, 0.1),
        ([1.0, 0.0], [1e9, 1.0], 1.0, 1.0),
        ([1e-200, 0.0], [1.0, 1.0], 1e-200, 1e-3),
        ([1.0, 0.0], [0.1, 0.2], 1.0, 1e-200),
    ]:
        t1, t2, code = advance(*force, *move, first, last, 1.0, 1.0, True)
        assert code == SLIP
        assert np.hypot(t1, t2) == pytest.approx(last, rel=1e-12)


@pytest.mark.slow
def test_inverse_mean_limit_is_smooth_through_equal_limits() -> None:
    for first, last in [(1.0, 1.0), (1.0, 1.0 + 1e-9), (1.0, 1.0201), (1.0, 1.0203), (2.0, 0.3), (1e-6, 1.0)]:
        value, by_first, by_last = inverse_mean_limit(first, last)
        nodes, weights = np.polynomial.legendre.leggauss(400)
        x = 0.5 * (nodes + 1.0)
        if first > 1e-3:
            assert value == pytest.approx(np.sum(0.5 * weights / (first + x * (last - first))), rel=1e-13)
        step = 1e-5 * first
        difference = inverse_mean_limit(first + step, last)[0] - inverse_mean_limit(first - step, last)[0]
        assert by_first == pytest.approx(difference / (2 * step), rel=1e-8)
        step = 1e-5 * last
        difference = inverse_mean_limit(first, last + step)[0] - inverse_mean_limit(first, last - step)[0]
        assert by_last == pytest.approx(difference / (2 * step), rel=1e-8)


def test_one_sided_slip_shakes_down() -> None:
    """Range below 2 mu N, but off centre: the slider moves once, until the force just touches the limit."""
    t = 2.0 * np.pi * np.arange(256) / 256
    path = 0.2 * (np.cos(t) + 0.6 * np.cos(2.0 * t))
    motion = np.stack([path + 5.0, 0.0 * t, 0.0 * t], axis=-1)[:, None]
    cycle = contact_cycle(motion, make_pairs(1))
    expected = SPRING * (path - path.max()) + 0.8
    np.testing.assert_allclose(cycle.force[:, 0, 0], expected, atol=1e-13)
    assert (cycle.state[0], cycle.dissipated_energy[0]) == (STICK, 0.0)
    assert cycle.closure[0] <= 1e-13
    assert np.ptp(cycle.slider[:, 0, 0]) < 1e-13


def test_released_pair_that_sticks_has_no_mean_force() -> None:
    t = 2.0 * np.pi * np.arange(64) / 64
    motion = np.stack([0.1 * np.cos(t) + 7.0, 0.1 * np.sin(t) - 3.0, 0.2 * np.cos(t)], axis=-1)[:, None]
    cycle = contact_cycle(motion, make_pairs(1))
    np.testing.assert_allclose(cycle.force[:, 0, 0], 0.3 * np.cos(t), atol=1e-13)
    np.testing.assert_allclose(cycle.slider[:, 0], np.broadcast_to([7.0, -3.0], (64, 2)), atol=1e-13)
    assert (cycle.state[0], cycle.dissipated_energy[0], cycle.closure[0]) == (STICK, 0.0, 0.0)


def test_touchdown_starts_where_the_gap_closes() -> None:
    """A pair that closes between two samples loads its spring only over the closed part of that step."""
    t = 2.0 * np.pi * np.arange(64) / 64
    motion = np.stack([0.01 * np.sin(t), 0.0 * t, 2.0 * np.cos(t)], axis=-1)[:, None]
    cycle = contact_cycle(motion, make_pairs(1, preload=0.13))
    load = 0.13 + 2.0 * np.cos(t)
    j = int(np.flatnonzero((load[1:] > 0.0) & (load[:-1] <= 0.0))[0]) + 1
    share = load[j] / (load[j] - load[j - 1])
    expected = SPRING * share * (motion[j, 0, 0] - motion[j - 1, 0, 0])
    assert cycle.force[j, 0, 0] == pytest.approx(expected, rel=1e-12)
    assert cycle.state[0] == 2


def test_unequal_stiffness_slips_along_the_force() -> None:
    """Associated flow: where the pair slips, the slider moves along T, |T| = mu N, for either update name."""
    t = 2.0 * np.pi * np.arange(200) / 200
    motion = np.stack([1.1 * np.cos(t), 0.7 * np.sin(t + 0.4), 0.8 * np.cos(t)], axis=-1)[:, None]
    pairs = make_pairs(1, tangential_stiffness=np.array([[3.0, 0.8]]))
    cycle = contact_cycle(motion, pairs)
    force, moved = cycle.force[:, 0, :2], cycle.slider[:, 0] - np.roll(cycle.slider[:, 0], 1, axis=0)
    slips = np.hypot(*moved.T) > 1e-9
    assert 50 < slips.sum() < 200
    cross = force[:, 0] * moved[:, 1] - force[:, 1] * moved[:, 0]
    # 1/C of the motion where the period closes, beside the slip of one step.
    assert np.abs(cross[slips] / np.hypot(*moved[slips].T)).max() < 1e-6
    assert np.all(np.sum(force * moved, axis=1)[slips] > 0.0)
    np.testing.assert_allclose(np.hypot(*force[slips].T), 0.4 * cycle.force[slips, 0, 2], rtol=1e-12)
    np.testing.assert_array_equal(contact_cycle(motion, pairs, "radial").force, cycle.force)


def test_unequal_stiffness_tends_to_radial_return() -> None:
    t = 2.0 * np.pi * np.arange(128) / 128
    motion = np.stack([1.1 * np.cos(t), 0.7 * np.sin(t + 0.4), 0.8 * np.cos(t)], axis=-1)[:, None]
    nearly = contact_cycle(motion, make_pairs(1, tangential_stiffness=np.array([[3.0, 3.0 * (1.0 + 1e-9)]])))
    equal = contact_cycle(motion, make_pairs(1), "radial")
    np.testing.assert_allclose(nearly.force, equal.force, atol=1e-8)


def test_pair_that_does_not_deviate_is_exactly_its_springs() -> None:
    x, pairs = random_case(2, 300)
    actual = harmonic_force(x, pairs, 64)
    stuck = ~actual.deviates
    assert 10 < stuck.sum() < 200
    expected = pairs.resting_stiffness().reshape(-1, 3)[:, :, None] * x
    expected[:, :2, 0] = 0.0
    np.testing.assert_array_equal(actual.force[stuck], expected[stuck])
    assert np.all(actual.state[stuck & pairs.closed_at_rest] == 0)
    open_at_rest = stuck & ~pairs.closed_at_rest
    assert open_at_rest.any()
    assert np.all(actual.state[open_at_rest] == 2)
    assert np.all(actual.deviates[(actual.state > 0) & pairs.closed_at_rest])


def test_residual_traction_is_carried_along_until_slip_forgets_it() -> None:
    motion = np.zeros((1, 3, 3))
    motion[0, 0, 1] = 0.1
    still = ContactPairs(np.zeros((3, 1)), 1.0, 3.0, 0.4, 2.0, [[0.3, -0.2]])
    assert not harmonic_force(motion, still, 64).deviates[0]
    cycle = contact_cycle(sampled(motion, 64), still)
    np.testing.assert_allclose(cycle.force[:, 0, 0], 0.3 + 3.0 * sampled(motion, 64)[:, 0, 0], atol=1e-14)
    np.testing.assert_allclose(cycle.force[:, 0, 1], -0.2, atol=1e-14)
    # Motion far beyond the limit: the loop is that of a released pair, whatever was there before.
    motion[0, 0, 1] = 2.0
    released = ContactPairs(np.zeros((3, 1)), 1.0, 3.0, 0.4, 2.0)
    one_way = ContactPairs(np.zeros((3, 1)), 1.0, 3.0, 0.4, 2.0, [[0.3, 0.0]])
    np.testing.assert_allclose(
        contact_cycle(sampled(motion, 64), one_way).force,
        contact_cycle(sampled(motion, 64), released).force,
        atol=1e-12,
    )


def test_residual_traction_shakes_down_to_the_limit() -> None:
    """T0 + k X cos t passes the limit on one side only: slip moves the loop until it touches, and no farther."""
    spring, limit, rest, amplitude = 3.0, 0.8, 0.6, 0.15
    pairs = ContactPairs(np.zeros((3, 1)), 1.0, spring, 0.4, 2.0, [[rest, 0.0]])
    motion = np.zeros((1, 3, 3))
    motion[0, 0, 1] = amplitude
    cycle = contact_cycle(sampled(motion, 64), pairs)
    signal = sampled(motion, 64)[:, 0, 0]
    np.testing.assert_allclose(cycle.force[:, 0, 0], limit + spring * (signal - amplitude), atol=1e-13)
    assert cycle.state[0] == 0
    assert cycle.dissipated_energy[0] == 0.0


def test_bad_input_gets_a_sentence() -> None:
    pairs = make_pairs(2)
    good = np.zeros((16, 2, 3))
    with rejects(InputError, "displacement"):
        contact_cycle(np.zeros((16, 3, 3)), pairs)
    with rejects(InputError, "displacement"):
        contact_cycle(good[:7], pairs)
    bad = good.copy()
    bad[3, 1, 2] = np.nan
    with rejects(InputError, "displacement"):
        contact_cycle(bad, pairs)
    with rejects(InputError, "update"):
        contact_cycle(good, pairs, "exact")  # type: ignore[arg-type]
    with rejects(InputError, "coefficients"):
        harmonic_force(np.zeros((2, 3, 6)), pairs, 64)
    with rejects(InputError, "samples"):
        harmonic_force(np.zeros((2, 3, 11)), pairs, 10)
    with rejects(InputError, "update"):
        harmonic_tangent(np.zeros((2, 3, 7)), pairs, 64, [0], "exact")  # type: ignore[arg-type]
