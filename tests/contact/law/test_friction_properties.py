"""What must hold for every motion: limits, signs, symmetries and units of the friction law."""

from __future__ import annotations

import numpy as np
import pytest
from friction_cases import make_pairs, random_case, sampled
from hypothesis import given, settings
from hypothesis import strategies as st

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update, contact_cycle, harmonic_force
from stickslip.core.validation import FloatArray

SAMPLES = 48
quick = settings(max_examples=40, deadline=None, derandomize=True)
seeds = st.integers(0, 10**6)
updates = st.sampled_from(["tractrix", "radial"])


def isotropic_case(seed: int) -> tuple[FloatArray, ContactPairs]:
    """The first half of a random case, which has equal stiffness along t1 and t2."""
    x, pairs = random_case(seed, 24)
    half = slice(0, 12)
    return x[half], make_pairs(
        12, 1.0, pairs.tangential_springs[half, 0], pairs.friction_coefficient[half], pairs.preload[half]
    )


def limit_scale(x: FloatArray, pairs: ContactPairs) -> FloatArray:
    """Largest mu N of each pair in the period, or 1 where it never closes."""
    load = pairs.preload + pairs.normal_stiffness * sampled(x, SAMPLES)[:, :, 2]
    scale: FloatArray = (pairs.friction_coefficient * load).max(axis=0)
    return np.where(scale > 0.0, scale, 1.0)


@pytest.mark.slow
@quick
@given(seed=seeds, update=updates)
def test_force_stays_within_the_limit_and_vanishes_when_open(seed: int, update: Update) -> None:
    x, pairs = random_case(seed, 24)
    motion = sampled(x, SAMPLES)
    cycle = contact_cycle(motion, pairs, update)
    tangential = np.hypot(cycle.force[:, :, 0], cycle.force[:, :, 1])
    assert np.all(tangential <= pairs.friction_coefficient * cycle.force[:, :, 2] * (1.0 + 1e-12))
    load = pairs.preload + pairs.normal_stiffness * motion[:, :, 2]
    np.testing.assert_array_equal(cycle.force[:, :, 2], np.maximum(load, 0.0))
    is_open = load <= 0.0
    assert np.all(cycle.force[is_open] == 0.0)
    np.testing.assert_array_equal(cycle.slider[is_open], motion[is_open][:, :2])
    np.testing.assert_array_equal(cycle.state == 2, is_open.any(axis=0))


@pytest.mark.slow
@quick
@given(seed=seeds, update=updates)
def test_dissipation_is_never_negative_and_near_the_work(seed: int, update: Update) -> None:
    """Not negative, 0 exactly where stuck, and with 16 times the samples equal to the work of the force."""
    x, pairs = random_case(seed, 24)
    cycle = contact_cycle(sampled(x, SAMPLES), pairs, update)
    assert np.all(cycle.dissipated_energy >= 0.0)
    assert np.all(cycle.dissipated_energy[cycle.state == 0] == 0.0)
    fine = sampled(x, 16 * SAMPLES)
    cycle = contact_cycle(fine, pairs, update)
    before = np.roll(np.arange(len(fine)), 1)
    force, tangential = cycle.force[:, :, :2], fine[:, :, :2]
    work = 0.5 * np.sum((force + force[before]) * (tangential - tangential[before]), axis=(0, 2))
    size = limit_scale(x, pairs) * np.abs(np.diff(tangential, axis=0)).sum(axis=(0, 2))
    assert np.all(np.abs(work - cycle.dissipated_energy) <= (2e-4 if update == "tractrix" else 2e-2) * size)


@pytest.mark.slow
@quick
@given(seed=seeds, update=updates, angle=st.floats(0.0, 2.0 * np.pi))
def test_rotation_of_the_tangential_axes(seed: int, update: Update, angle: float) -> None:
    x, pairs = isotropic_case(seed)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    plain = harmonic_force(x, pairs, SAMPLES, update).force
    turned = harmonic_force(np.einsum("ab,ibq->iaq", turn, x), pairs, SAMPLES, update).force
    error = np.abs(turned - np.einsum("ab,ibq->iaq", turn, plain)).max(axis=(1, 2))
    assert np.all(error <= 1e-7 * (limit_scale(x, pairs) + np.abs(plain).max(axis=(1, 2))))


@pytest.mark.slow
@quick
@given(seed=seeds, update=updates, shift=st.integers(1, SAMPLES - 1))
def test_time_shift(seed: int, update: Update, shift: int) -> None:
    """Pairs that slip or open in the converged period do not know where the period started."""
    x, pairs = random_case(seed, 24)
    motion = sampled(x, SAMPLES)
    plain = contact_cycle(motion, pairs, update)
    moved = contact_cycle(np.roll(motion, shift, axis=0), pairs, update)
    forgets = plain.state > 0
    np.testing.assert_array_equal(moved.state[forgets], plain.state[forgets])
    error = np.abs(moved.force - np.roll(plain.force, shift, axis=0)).max(axis=(0, 2))
    assert np.all(error[forgets] <= 1e-7 * limit_scale(x, pairs)[forgets])


@pytest.mark.slow
@quick
@given(seed=seeds, update=updates, offset=st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0)))
def test_constant_tangential_shift_changes_nothing(seed: int, update: Update, offset: tuple[float, float]) -> None:
    x, pairs = random_case(seed, 24)
    moved = x.copy()
    moved[:, :2, 0] += offset
    first, second = harmonic_force(x, pairs, SAMPLES, update), harmonic_force(moved, pairs, SAMPLES, update)
    np.testing.assert_array_equal(first.force, second.force)
    np.testing.assert_array_equal(first.state, second.state)


@pytest.mark.slow
@quick
@given(seed=seeds, update=updates, length=st.floats(-8.0, 2.0), force=st.floats(-3.0, 6.0))
def test_units(seed: int, update: Update, length: float, force: float) -> None:
    """Lengths times a, forces times b: stiffness b / a, preload b, force b, energy a b."""
    x, pairs = random_case(seed, 24)
    a, b = 10.0**length, 10.0**force
    scaled = make_pairs(24, b / a, pairs.tangential_stiffness * (b / a), pairs.friction_coefficient, pairs.preload * b)
    first, second = (
        contact_cycle(sampled(x, SAMPLES), pairs, update),
        contact_cycle(sampled(a * x, SAMPLES), scaled, update),
    )
    np.testing.assert_array_equal(first.state, second.state)
    error = np.abs(second.force[:, :, :2] / b - first.force[:, :, :2]).max(axis=(0, 2))
    assert np.all(error <= 1e-7 * limit_scale(x, pairs))
    size = limit_scale(x, pairs) * np.abs(np.diff(sampled(x, SAMPLES), axis=0)).sum(axis=(0, 2))
    assert np.all(np.abs(second.dissipated_energy / (a * b) - first.dissipated_energy) <= 1e-7 * size)
