"""The exponential law of pressure over the gap against closed forms: load, harmonics, energy, small motions, limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.special

import stickslip as ss
from law_makers import exponential
from sentences import rejects
from stickslip.contact.law.law import ContactCycle
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray

LOAD, STIFFNESS, SAMPLES = 20.0, 2e6, 256
LENGTH = LOAD / STIFFNESS  # 10 um
ANGLE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES


def law(tangential: float = 1e6, friction: float = 0.3) -> ss.ExponentialContact:
    """One pair."""
    return exponential([STIFFNESS], [tangential], [friction], [LOAD])


def pressed(coefficients: FloatArray) -> FloatArray:
    """Coefficients (7,) of the normal force under those of the closing."""
    motion = np.zeros((1, 3, 7))
    motion[0, 2] = coefficients
    return np.asarray(law().period(motion, SAMPLES).force[0, 2])


def work(cycle: ContactCycle, motion: FloatArray) -> FloatArray:
    """(3,) J of the force along t1, t2, n over a closed path (n, 1, 3): trapezoidal rule."""
    force = 0.5 * (cycle.force + np.roll(cycle.force, -1, axis=0))
    return np.asarray((force * (np.roll(motion, -1, axis=0) - motion)).sum(axis=(0, 1)))


@pytest.mark.parametrize("ratio", [1e-3, 0.5, 1.0, 3.0, 100.0])
def test_a_load_closes_the_gap_by_its_logarithm(ratio: float) -> None:
    """Static: n = lambda ln(N / N0), whatever the path; stiffness N / lambda."""
    one = law()
    end = np.array([[0.0, 0.0, LENGTH * np.log(ratio)]])
    between = one.step(-0.3 * end, one.memory_at_rest())
    for start in (one.memory_at_rest(), between.memory):
        step = one.step(end, start)
        assert LOAD + step.force[0, 2] == pytest.approx(ratio * LOAD, rel=1e-13)
        assert step.derivative[0, 2, 2] == pytest.approx(ratio * LOAD / LENGTH, rel=1e-13)


@pytest.mark.parametrize("size", [0.1, 1.0, 3.0])
def test_a_harmonic_closing_has_forces_of_bessel_functions(size: float) -> None:
    """``exp(z cos a) = I0(z) + 2 sum I_k(z) cos(k a)`` (Abramowitz and Stegun 9.6.34)."""
    force = pressed(LENGTH * size * np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    expected = LOAD * np.array([scipy.special.iv(0, size) - 1.0, *(2.0 * scipy.special.iv([1, 2, 3], size))])
    assert force[[0, 1, 3, 5]] == pytest.approx(expected, rel=1e-11)
    assert force[[2, 4, 6]] == pytest.approx(0.0, abs=1e-12 * expected.max())


def test_small_motions_are_those_of_the_spring_but_for_the_next_term_of_the_expansion() -> None:
    """``N - N0 = k n + k n^2 / (2 lambda)``: what remains after both is of third order, to round-off."""
    direction = np.array([0.2, 1.0, -0.3, 0.4, 0.1, 0.0, 0.2])
    angle = np.outer(np.arange(4), ANGLE)
    waves = np.array([np.ones(SAMPLES), *(wave(angle[h]) for h in (1, 2, 3) for wave in (np.cos, np.sin))])
    for size in (1e-2, 1e-4, 1e-6):
        motion = size * LENGTH * direction
        square = 0.5 * STIFFNESS / LENGTH * (motion @ waves) ** 2
        second = np.array([square.mean(), *(2.0 * (square * wave).mean() for wave in waves[1:])])
        rest = np.abs(pressed(motion) - STIFFNESS * motion - second).max() / LOAD
        assert rest < 2.0 * size**3 + 1e-15


def test_a_closed_cycle_along_n_costs_no_energy() -> None:
    motion = np.zeros((SAMPLES, 1, 3))
    motion[:, 0, 2] = LENGTH * (0.3 + np.cos(ANGLE) + 0.6 * np.sin(2.0 * ANGLE + 0.4) + 0.2 * np.cos(3.0 * ANGLE))
    cycle = law().cycle(motion)
    exchanged = np.abs(np.diff(motion[:, 0, 2])).sum() * cycle.force[:, 0, 2].max()
    assert abs(work(cycle, motion)).max() < 1e-3 * exchanged
    assert not cycle.dissipated_energy.any()


def loop(size: float, samples: int = 8192) -> FloatArray:
    """A closed path in the plane of t1 and n, out of phase by an eighth, so that it encloses an area."""
    angle = 2.0 * np.pi * np.arange(samples) / samples
    path = np.zeros((samples, 1, 3))
    path[:, 0, 0], path[:, 0, 2] = size * np.cos(angle), 0.8 * LENGTH * np.sin(angle + 0.25 * np.pi)
    return path


def test_a_pair_that_sticks_while_its_pressure_varies_neither_loses_nor_creates_energy() -> None:
    """Springs ``T = k_t N / N0 s`` without their part of N would do so: a path creates what its reverse loses."""
    path = loop(1e-7)
    cycle = law().cycle(path)
    assert cycle.state[0] == ss.ContactState.STUCK
    exchanged = 1e6 * 1e-7**2
    assert abs(work(cycle, path)[0]) < 1e-9 * exchanged
    assert abs(work(cycle, path).sum()) < 1e-5 * LOAD * LENGTH
    following = cycle.force * [1.0, 0.0, 0.0] * cycle.force[:, :, 2:] / LOAD
    created = [work(replace(cycle, force=following[::way]), path[::way])[0] for way in (1, -1)]
    assert created[0] == pytest.approx(-created[1], rel=1e-9)
    assert abs(created[0]) > 0.1 * exchanged


def test_all_lost_energy_is_work_of_friction() -> None:
    path = loop(2e-5)
    cycle = law().cycle(path)
    assert cycle.state[0] == ss.ContactState.STICK_SLIP
    assert cycle.dissipated_energy[0] > 0.0
    assert work(cycle, path).sum() == pytest.approx(cycle.dissipated_energy[0], rel=1e-5)


def test_a_pair_that_slides_has_the_momentary_friction_limit() -> None:
    path = loop(1e-3)
    cycle = law().cycle(path)
    limit = 0.3 * LOAD * np.exp(path[:, 0, 2] / LENGTH)
    slides = np.abs(np.gradient(path[:, 0, 0])) > 0.3 * np.abs(np.gradient(path[:, 0, 0])).max()
    assert np.abs(cycle.force[slides, 0, 0]) == pytest.approx(limit[slides], rel=1e-12)
    assert (np.abs(cycle.force[:, 0, 0]) <= limit * (1.0 + 1e-12)).all()


def test_a_pair_never_opens_but_counts_as_nearly_open_below_a_hundredth() -> None:
    for depth, state in ((4.0, ss.ContactState.STUCK), (5.0, ss.ContactState.SEPARATING)):
        motion = np.zeros((1, 3, 3))
        motion[0, 2, 1] = depth * LENGTH  # exp(-4) = 0.018, exp(-5) = 0.007
        one = law()
        assert one.period(motion, SAMPLES).state[0] == state
        path = np.zeros((SAMPLES, 1, 3))
        path[:, 0, 2] = depth * LENGTH * np.cos(ANGLE)
        cycle = one.cycle(path)
        assert cycle.state[0] == state
        assert (cycle.force[:, 0, 2] > 0.0).all()
        assert not cycle.dissipated_energy.any()
    assert one.states[ss.ContactState.SEPARATING] == "nearly open"


def test_another_state_at_rest_has_the_same_curve() -> None:
    one, moved = law(), np.array([[0.0, 0.0, 0.7 * LENGTH]])
    about = one.about(moved, None)
    assert about.length == pytest.approx(one.length, rel=1e-14)
    assert about.normal_load == pytest.approx(LOAD * np.exp(0.7), rel=1e-14)
    assert about.tangential_springs == pytest.approx(one.tangential_springs)


@pytest.mark.parametrize("load", [0.0, -1.0])
def test_a_pair_without_load_is_rejected(load: float) -> None:
    with rejects(ss.InputError, "normal_load"):
        exponential([1e6, 1e6], [1e6, 1e6], [0.3, 0.3], [5.0, load])


def test_a_static_state_with_open_pairs_is_rejected() -> None:
    one = law()
    lifted = np.array([[0.0, 0.0, -10.0 * float(one.length[0])]])
    with rejects(InputError, "pairs"):
        one.about(lifted, None)
