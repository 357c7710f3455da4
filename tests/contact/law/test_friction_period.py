"""The state of a pair after many cycles, and the integrals of its force with the events between samples."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from friction_cases import make_pairs, near_shakedown, random_case, sampled
from test_friction import AMPLITUDE, COUNTS, LOOPS, slope

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import Update, contact_cycle, harmonic_force, harmonic_tangent
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.core.validation import FloatArray


@pytest.mark.slow
@pytest.mark.parametrize("update", ["tractrix", "radial"])
def test_every_pair_closes_its_period(update: Update) -> None:
    """To 1/C of what the cycles have moved the force at the start, in the norm of K^-1; also pairs that only just reach
    the limit, where plain cycles creep for thousands of periods."""
    for x, pairs in (random_case(11, 1500), near_shakedown(5, 1500, 64)):
        actual = harmonic_force(x, pairs, 64, update)
        path = pairs.tangential_springs * (sampled(x, 64)[0, :, :2] - x[:, :2, 0])
        limit = pairs.friction_coefficient[:, None] * (pairs.preload[:, None] + sampled(x, 64)[:, :, 2].T)
        moved = np.hypot(*(actual.period_start[:, :2] - path).T) / np.maximum(limit.max(axis=1), 1e-300)
        norms = np.sqrt(pairs.tangential_springs.max(axis=1) / pairs.tangential_springs.min(axis=1))
        assert np.all(actual.closure <= 1.001 * norms * moved / CYCLES + 1e-12)
        assert set(actual.state) >= {0, 1}
        assert np.count_nonzero((actual.state == 0) & actual.deviates) > 10


def nearest_feasible_start(path: FloatArray, limit: FloatArray) -> FloatArray:
    """The shift c (2,) nearest to zero with |path - c| <= limit at all samples, by Dykstra's projections on discs."""
    centres, radii = [complex(*place) for place in path], limit.tolist()  # numbers of Python: quicker one by one
    shift, parts = 0j, [0j] * len(radii)
    for _ in range(3000):
        for j, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
            trial = shift + parts[j]
            away = abs(trial - centre)
            shift = trial if away <= radius else centre + (trial - centre) * (radius / away)
            parts[j] = trial - shift
    return np.array([shift.real, shift.imag])


@pytest.mark.long
def test_shaken_down_pairs_carry_the_nearest_feasible_traction() -> None:
    """Equal stiffness: the slider moves by the least that lets the pair stick, found here by another method."""
    x, pairs = near_shakedown(7, 300, 64)
    once = harmonic_force(x, pairs, 64)
    cycle = contact_cycle(sampled(x, 64), pairs)
    chosen = np.flatnonzero((cycle.state == 0) & once.deviates & (np.arange(300) < 150))
    assert chosen.size > 8
    for pair in chosen:
        motion = sampled(x[[pair]], 64)[:, 0]
        spring = pairs.tangential_springs[pair]
        limit = pairs.friction_coefficient[pair] * (pairs.preload[pair] + motion[:, 2])
        expected = nearest_feasible_start(spring * (motion[:, :2] - x[pair, :2, 0]), limit)
        actual = spring * (cycle.slider[0, pair] - x[pair, :2, 0])
        assert np.abs(actual - expected).max() < 1e-5 * limit.max()


def test_the_state_moves_continuously_where_a_pair_begins_to_slip_to_both_sides() -> None:
    """A pair with a traction across its motion: where it shakes down, the traction it can keep shrinks to zero like a
    square root as the motion grows; plain cycles end somewhere on the way, and drop it at once where slip goes on."""
    limit, spring, across = 0.8, 3.0, 0.5
    pairs = ContactPairs(np.zeros((3, 1)), 1.0, spring, 0.4, 2.0, [[0.0, across]])

    def kept(amplitude: float) -> float:
        motion = np.zeros((1, 3, 3))
        motion[0, 0, 1] = amplitude / spring
        return float(contact_cycle(sampled(motion, 64), pairs).force[0, 0, 1])

    for amplitude in (0.6, 0.7, 0.79):
        assert kept(amplitude) == pytest.approx(min(across, np.sqrt(limit**2 - amplitude**2)), abs=1e-5)
    # Beyond the limit slip takes the rest: it falls from the rounded tip of the root without a jump.
    tip = [kept(limit * (1.0 + excess)) for excess in (-1e-4, 0.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2)]
    assert tip[0] < 0.015
    assert all(0.0 < after <= before for before, after in pairwise(tip))
    assert max(tip[1:5]) - min(tip[1:5]) < 2e-5
    assert tip[-1] < 2e-5


def loop_coefficients(name: str, samples: int, phase: float) -> tuple[FloatArray, FloatArray]:
    """Mean, cosine and sine of a closed loop with the samples shifted by a fraction of their distance: with the events
    between the samples, and as plain sums."""
    _, preload, normal = LOOPS[name]
    shift = 2.0 * np.pi * phase / samples
    x = np.zeros((1, 3, 3))
    x[0, 0, 1:] = AMPLITUDE * np.cos(shift), -AMPLITUDE * np.sin(shift)
    x[0, 2, 1:] = normal(np.array([shift, shift + np.pi / 2]))
    pairs = make_pairs(1, preload=preload)
    both = harmonic_force(x, pairs, samples).force[0, 0], sum_of_samples(x, pairs, samples)[0, 0]
    turned = [(each[1] + 1j * each[2]) * np.exp(1j * shift) for each in both]
    first, second = (np.array([each[0], turn.real, turn.imag]) for each, turn in zip(both, turned, strict=True))
    return first, second


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_coefficients_of_closed_loops_are_of_second_order(name: str) -> None:
    exact = LOOPS[name][0].coefficients
    errors = [
        max(np.abs(loop_coefficients(name, samples, phase)[0] - exact).max() for phase in np.arange(8) / 8.0)
        / abs(exact[2])
        for samples in COUNTS
    ]
    assert errors[COUNTS.index(256)] < 1.3e-4
    assert 1.9 < slope(errors) < 2.1


# Where, as a fraction of their distance, two samples beside a reversal are equally far from it.
REVERSALS = {"jenkins": [0.5], "in phase": [0.5], "quadrature": [0.15, 0.85], "separation": [0.5]}


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_no_corner_where_an_onset_or_a_gap_passes_a_sample(name: str) -> None:
    """While the samples move past the events, a plain sum has a corner at each. With their instants only reversals have
    one, where another sample becomes the last that slips."""
    phases = np.linspace(0.0, 1.0, 201)
    both = np.array([loop_coefficients(name, 64, phase) for phase in phases])
    # Second differences: of a smooth function (2 pi / 200)^2 of its range, at a corner 2 pi / 200 of it.
    bends = np.abs(np.diff(both, 2, axis=0)).max(axis=2) / np.ptp(both, axis=0).max(axis=1)
    away = np.min([np.abs(phases[1:-1] - place) for place in REVERSALS[name]], axis=0) > 0.008
    corrected, plain = bends[away].max(axis=0)
    assert corrected < 2e-3
    assert plain > 2e-3 or name == "jenkins"  # whose onsets are beside a reversal with these numbers


def lift_off_at_a_sample(across: float) -> tuple[FloatArray, ContactPairs]:
    """A pair that sticks until it lifts off exactly at sample 23 of 64; ``across`` m moves it in a second direction."""
    x = np.zeros((1, 3, 3))
    x[0, 0, 1:], x[0, 1, 2], x[0, 2, 1:] = (0.1, 0.03), across, (3.0, 0.7)
    angle = 2.0 * np.pi * 23 / 64
    preload = -3.0 * np.cos(angle) - 0.7 * np.sin(angle)
    return x, make_pairs(1, friction_coefficient=4.0, preload=preload)


def bisect(condition: Callable[[float], bool], yes: float, no: float) -> float:
    """Where a condition that holds at ``yes`` ceases to hold on the way to ``no``."""
    assert condition(yes)
    assert not condition(no)
    for _ in range(60):
        middle = 0.5 * (yes + no)
        yes, no = (middle, no) if condition(middle) else (yes, middle)
    return no


def closed_by(x: FloatArray, closing: float) -> FloatArray:
    """``x`` with the mean closing ``closing`` m: lift-off comes later."""
    moved = x.copy()
    moved[0, 2, 0] = closing
    return moved


@pytest.mark.parametrize("update", ["tractrix", "radial"])
def test_the_force_is_continuous_where_lift_off_of_a_pair_that_sticks_passes_a_sample(update: Update) -> None:
    """In the step to lift-off the falling limit meets the force, so the pair slips before it opens."""
    x, pairs = lift_off_at_a_sample(0.07)

    def force(closing: float) -> FloatArray:
        return harmonic_force(closed_by(x, closing), pairs, 64, update).force[0, :2]

    jump = np.abs(force(1e-9) - force(-1e-9)).max()
    assert np.abs(force(0.0)).max() > 0.01
    assert jump < 1e-7  # without the slip 3e-3
    # And the derivative is that of the force, beside the sample and in the middle of the step.
    for closing in (-1e-3, -0.1):
        tangent = harmonic_tangent(closed_by(x, closing), pairs, 64, [0], update)[0, :2, :, 2, 0]
        differences = (force(closing + 1e-6) - force(closing - 1e-6)) / 2e-6
        assert tangent == pytest.approx(differences, abs=1e-5 * np.abs(differences).max())


def test_no_corner_where_lift_off_or_the_slip_before_it_passes_a_sample() -> None:
    """In one direction; a motion that turns keeps a corner: slip turns the traction, and the correction does not."""
    x, pairs = lift_off_at_a_sample(0.0)

    def jump(closing: float) -> float:
        before, after = (harmonic_tangent(closed_by(x, closing + d), pairs, 64, [0]) for d in (-1e-9, 1e-9))
        return float(np.abs(after - before)[0, :2].max())

    def slips_before(closing: float) -> bool:
        """Whether the pair is on its limit at sample 22, and lifts off in the step after it."""
        force = contact_cycle(sampled(closed_by(x, closing), 64), pairs).force[22, 0]
        return float(np.hypot(*force[:2])) > (1.0 - 1e-9) * 4.0 * float(force[2]) > 0.0

    onset = bisect(slips_before, -0.273, -0.1)
    assert jump(0.0) < 1e-7  # 0.06 without the slip before lift-off, 1.5e-4 with its correction at its onset
    assert jump(onset) < 1e-7  # 2.6e-3, 2.2e-4


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_harmonic_force_tends_to_the_integral_of_the_force(seed: int) -> None:
    x, pairs = random_case(seed, 200)
    updates: tuple[Update, ...] = ("tractrix", "radial")
    for update in updates:
        actual = harmonic_force(x, pairs, 96, update)
        np.testing.assert_array_equal(actual.state, contact_cycle(sampled(x, 96), pairs, update).state)
    dense = sum_of_samples(x, pairs, 96 * 32)
    scale = np.abs(dense).max(axis=(1, 2)) + 1e-300
    coarse, fine = (
        np.abs(harmonic_force(x, pairs, n, "tractrix").force - dense).max(axis=(1, 2)) / scale for n in (96, 384)
    )
    chosen = coarse > 1e-5
    assert chosen.sum() > 10
    assert np.median(coarse[chosen]) < 3e-3
    assert np.median(fine[chosen] / coarse[chosen]) < 0.1


def sum_of_samples(x: FloatArray, pairs: ContactPairs, samples: int, update: Update = "tractrix") -> FloatArray:
    """The Fourier coefficients of the force as sums of its samples."""
    signal = contact_cycle(sampled(x, samples), pairs, update).force.copy()
    signal[:, :, 2] -= np.maximum(pairs.preload, 0.0)  # a gap has no load at rest
    spectrum = np.fft.rfft(signal, axis=0)[:4] / samples
    answer = np.zeros_like(x)
    answer[:, :, 0] = spectrum[0].real
    spectrum = spectrum[: x.shape[2] // 2 + 1]
    answer[:, :, 1::2] = 2.0 * spectrum[1:].real.transpose(1, 2, 0)
    answer[:, :, 2::2] = -2.0 * spectrum[1:].imag.transpose(1, 2, 0)
    return answer
