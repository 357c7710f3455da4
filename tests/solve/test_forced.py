"""The whole forced response: against a closed form, the bench problem, energy balance, and bad input."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.contact.law.closed_forms import jenkins_loop
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.core.errors import ConvergenceError, InputError, NotConvergedWarning
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic.checks import normal_work_warnings
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.structure.superelement import Superelement


@pytest.fixture(scope="module")
def bench(blade: Blade) -> ForcedResponse:
    return blade.response(
        frequency_hz=blade.window_hz,
        harmonics=3,
        samples=128,
    )


@pytest.mark.slow
def test_a_curve_without_checks_has_the_same_points(blade: Blade, bench: ForcedResponse) -> None:
    plain = blade.response(frequency_hz=blade.window_hz, harmonics=3, samples=128, checks=False)
    assert np.array_equal(plain.displacement, bench.displacement)
    assert np.array_equal(plain.frequency_hz, bench.frequency_hz)
    assert bench.multipliers is not None
    assert plain.multipliers is None
    assert plain.stable is None
    printed_sentence(plain.stability_message)
    assert "search_for_missed_peaks" in bench.settings
    assert "search_for_missed_peaks" not in plain.settings


@pytest.mark.slow
def test_one_harmonic_oscillator_with_a_jenkins_element() -> None:
    """(k - m w^2) X + a1(X), -c w X + b1(X) has the length F: one scalar equation for X, solved apart."""
    mass, stiffness, damping, spring, limit, force = 1.0, 1e4, 0.4, 5e3, 6.0, 5.0
    superelement = Superelement(np.array([[mass]]), np.array([[stiffness]]), np.array([[damping]]))
    pairs = ContactPairs(np.array([[1.0], [0.0], [0.0]]), 1.0, spring, 0.3, limit / 0.3)
    response = forced_response(superelement, pairs, [force], frequency_hz=(14.0, 22.0), harmonics=1, samples=4096)
    assert response.converged
    assert (response.contact_state == 1).any()
    for frequency, actual in zip(response.frequency_hz, response.harmonic_amplitude([1.0], 1), strict=True):
        omega = 2 * np.pi * frequency

        def surplus(amplitude: float, omega: float = omega) -> float:
            cosine, sine = (0.0, 0.0)
            if spring * amplitude > limit:
                _, cosine, sine = jenkins_loop(spring, 0.3, limit / 0.3, amplitude).coefficients
            else:
                cosine = spring * amplitude
            dynamic = (stiffness - mass * omega**2) * amplitude + cosine
            return float(np.hypot(dynamic, -damping * omega * amplitude + sine) - force)

        expected = brentq(surplus, 1e-9, 1.0, xtol=1e-16)
        assert actual == pytest.approx(expected, rel=1e-5)


@pytest.mark.slow
def test_bench_peak(bench: ForcedResponse, blade: Blade) -> None:
    amplitude = bench.harmonic_amplitude(blade.tip, 1)
    top = int(amplitude.argmax())
    # Another program, first harmonic, two cycles of the law instead of a converged period: 198.44 um, 686.8 Hz.
    assert amplitude[top] == pytest.approx(198.44e-6, rel=1e-3)
    assert bench.frequency_hz[top] == pytest.approx(686.8, abs=1.0)
    assert (bench.contact_state[top] == 2).sum() == 2
    assert (bench.contact_state[top] > 0).sum() == 9


@pytest.mark.slow
def test_every_point_is_a_solution(bench: ForcedResponse) -> None:
    assert bench.converged
    assert bench.frequency_hz.size >= 60
    assert bench.residual.max() < 1e-8
    assert bench.closure.max() < 2.0 / CYCLES
    assert bench.displacement.shape == (bench.frequency_hz.size, 38, 7)


def test_energy_balance_at_every_point(bench: ForcedResponse) -> None:
    taken_out = bench.dissipated_energy.sum(axis=1) + bench.viscous_energy
    assert np.abs(taken_out / bench.input_energy - 1.0).max() < 1e-6
    assert (np.abs(bench.dissipated_energy[bench.contact_state == 0]) < 1e-12).all()
    top = int(bench.dissipated_energy.sum(axis=1).argmax())
    cycle = bench.pair_cycle(top)
    assert cycle.dissipated_energy.sum() == pytest.approx(bench.friction_energy[top].sum(), rel=1e-3)
    assert np.abs(bench.normal_work.sum(axis=1) / bench.input_energy).max() < 1e-2


@pytest.mark.long
def test_impact_of_a_few_samples_is_no_friction() -> None:
    """A stiff stop behind a gap: what the coarsely sampled normal force gives or takes is told, and not as friction."""
    superelement = Superelement(np.eye(3), np.diag([2e6, 2.5e6, 1e6]), np.diag([20.0, 20.0, 10.0]))
    pairs = ContactPairs(np.eye(3), 2e8, 1e8, 0.3, -2e8 * 2e-5)
    largest = []
    for samples in (64, 128, 512):
        response = forced_response(
            superelement, pairs, [1.0, 0.0, 2.0], frequency_hz=(150.0, 200.0), harmonics=3, samples=samples
        )
        work, friction = response.normal_work.sum(axis=1), response.friction_energy
        top = int(friction.sum(axis=1).argmax())
        assert friction.min() >= -1e-12 * friction.max()
        assert response.pair_cycle(top).dissipated_energy.sum() == pytest.approx(
            friction[top].sum(),
            rel=(96.0 / samples) ** 2,
        )
        np.testing.assert_allclose(
            friction.sum(axis=1) + work + response.viscous_energy, response.input_energy, rtol=1e-6
        )
        largest.append(float(np.abs(work / response.input_energy).max()))
        omega = 2.0 * np.pi * response.frequency_hz
        reported = normal_work_warnings(omega, work, response.input_energy, np.full(omega.size, samples))
        assert bool(reported) == (largest[-1] > 1e-2)
        assert set(reported) <= set(response.warnings)
        if reported:
            printed_sentence("\n".join(reported), numbers=False)
    assert largest[0] > 0.1
    assert 0.05 > largest[1] > 20.0 * largest[2]


def test_linear_limits(bench: ForcedResponse, blade: Blade) -> None:
    assert bench.linear.stuck_frequency_hz[0] == pytest.approx(blade.stuck_hz, rel=1e-9)
    assert bench.linear.free_frequency_hz[0] == pytest.approx(blade.free_hz, rel=1e-9)
    # Far from the resonance nothing slips and the curve is the linear stuck one.
    stuck = bench.linear_amplitude(blade.tip, "stuck")
    assert bench.amplitude(blade.tip)[-1] == pytest.approx(stuck[-1], rel=1e-9)


@pytest.mark.slow
def test_downward_sweep_finds_the_same_peak(bench: ForcedResponse, blade: Blade) -> None:
    start, stop = blade.window_hz
    down = blade.response(
        frequency_hz=(stop, start),
        harmonics=3,
        samples=128,
    )
    assert down.converged
    assert down.frequency_hz[0] == pytest.approx(stop)
    assert down.frequency_hz[-1] == pytest.approx(start)
    peaks = [r.harmonic_amplitude(blade.tip, 1).max() for r in (bench, down)]
    assert peaks[0] == pytest.approx(peaks[1], rel=2e-4)


def test_the_branch_is_followed_through_folds(bench: ForcedResponse) -> None:
    """Separation softens the joint: the curve leans to the left and turns back in frequency."""
    assert (np.diff(bench.frequency_hz) < 0).sum() >= 3
    assert bench.frequency_hz[-1] == pytest.approx(bench.settings["frequency_stop_hz"])


@pytest.mark.slow
def test_force_in_two_harmonics_superposes_while_stuck(blade: Blade) -> None:
    """With a tiny force nothing slips, so each harmonic answers on its own."""
    size = blade.superelement.size
    force = np.zeros((size, 2))
    force[:, 0], force[:, 1] = 1e-3 * blade.force_cos, 2e-3 * blade.force_sin
    both = forced_response(blade.superelement, blade.pairs, force, frequency_hz=(600.0, 610.0), harmonics=2)
    single = forced_response(
        blade.superelement, blade.pairs, 1e-3 * blade.force_cos, frequency_hz=(600.0, 610.0), harmonics=1
    )
    assert both.harmonic_amplitude(blade.tip, 1)[-1] == pytest.approx(single.harmonic_amplitude(blade.tip, 1)[-1])
    matrix = blade.superelement.stiffness + blade.operator.T @ (blade.pairs.stuck_stiffness()[:, None] * blade.operator)
    x = 2 * 2 * np.pi * 610.0
    assert blade.superelement.damping is not None
    dynamic = matrix - x**2 * blade.superelement.mass + 1j * x * blade.superelement.damping
    expected = abs(blade.tip @ np.linalg.solve(dynamic, force[:, 1]))
    assert both.harmonic_amplitude(blade.tip, 2)[-1] == pytest.approx(expected, rel=1e-8)


@pytest.mark.slow
def test_too_few_harmonics_and_samples_are_reported(blade: Blade) -> None:
    coarse = blade.response(
        frequency_hz=(690.0, 735.0),
        harmonics=3,
        samples=16,
    )
    printed_sentence("\n".join(coarse.warnings))


@pytest.mark.slow
def test_one_harmonic_is_not_enough_and_is_reported(blade: Blade) -> None:
    single = forced_response(
        blade.superelement, blade.pairs, blade.force_cos, frequency_hz=(680.0, 735.0), harmonics=1, samples=128
    )
    printed_sentence("\n".join(single.warnings))


@pytest.mark.slow
def test_an_excited_harmonic_is_not_mistaken_for_the_tail(blade: Blade) -> None:
    force = np.zeros((blade.superelement.size, 2))
    force[:, 1] = 1e-3 * blade.force_cos
    second = forced_response(blade.superelement, blade.pairs, force, frequency_hz=(300.0, 305.0), harmonics=3)
    assert second.warnings == ()
    assert float(second.settings["energy_share_of_last_harmonics"]) < 1e-9


def two_bodies(contact_stiffness: float, damping: float | None) -> tuple[Superelement, ContactPairs]:
    """Two masses on springs, joined by one pair along t1."""
    stiffness = np.diag([1e6, 1.2e6, 1e6, 1.2e6, 1e6, 1.2e6])
    matrix = None if damping is None else damping * np.sqrt(stiffness)
    operator = np.kron(np.eye(3), [[1.0, -1.0]])
    pairs = ContactPairs(operator, contact_stiffness, contact_stiffness, 0.3, 1.0)
    return Superelement(np.eye(6), stiffness, matrix), pairs


@pytest.mark.long
def test_no_viscous_damping_is_solved_and_reported() -> None:
    superelement, pairs = two_bodies(1e6, None)
    window = 140.0, 190.0
    with rejects(InputError, "modal_damping_ratio"):  # no friction holds 5 N at the resonance
        forced_response(superelement, pairs, [5.0, 0, 0, 0, 0, 0], frequency_hz=window, harmonics=3)
    response = forced_response(superelement, pairs, [0.3, 0, 0, 0, 0, 0], frequency_hz=window, harmonics=3)
    assert response.converged, response.message
    # how many verdicts are doubtful beside an undamped resonance depends on the last digits
    printed_sentence("\n".join(response.warnings), numbers=False)
    assert np.isfinite(response.linear.stuck).all()


@pytest.mark.long
def test_a_joint_too_stiff_for_the_arithmetic_is_reported() -> None:
    superelement, pairs = two_bodies(1e9, 0.01)
    response = forced_response(superelement, pairs, [50.0, 0, 0, 0, 0, 0], frequency_hz=(150.0, 175.0), harmonics=3)
    assert (response.contact_state > 0).any()
    printed_sentence("\n".join(response.warnings), numbers=False)  # the residual is round-off
    superelement, pairs = two_bodies(1e12, 0.01)
    with rejects(ConvergenceError):  # its points converge, but their equation of motion has no digits
        forced_response(
            superelement,
            pairs,
            [50.0, 0, 0, 0, 0, 0],
            frequency_hz=(150.0, 175.0),
            harmonics=3,
            raise_on_failure=True,
        )


@pytest.mark.slow
def test_a_residual_that_the_tolerance_allows_is_no_sign_of_stiff_contact(blade: Blade) -> None:
    newton = NewtonSettings(tolerance=1e-4)
    response = blade.response(frequency_hz=blade.window_hz, harmonics=3, samples=128, checks=False, newton=newton)
    assert 1e-6 < response.residual.max() < 1e-4
    assert not any("satisfied only to" in each for each in response.warnings)


@pytest.mark.slow
def test_a_gap_is_open_at_rest_and_closes_at_its_width() -> None:
    """Without contact nothing moves the mean; contact begins where the motion reaches preload / stiffness."""
    superelement = Superelement(np.eye(1), np.array([[1e6]]), np.array([[40.0]]))
    pairs = ContactPairs(np.array([[0.0], [0.0], [1.0]]), 1e6, 1e6, 0.3, -10.0)
    gap = 10.0 / 1e6
    light, heavy = (
        forced_response(superelement, pairs, [force], frequency_hz=(100.0, 155.0), harmonics=7, samples=512)
        for force in (0.3, 1.0)
    )
    assert np.abs(light.displacement[:, 0, 0]).max() < 1e-15
    assert light.amplitude([1.0]).max() < gap
    stuck_free = light.linear_amplitude([1.0], "free").max()
    assert stuck_free < gap
    touching = heavy.amplitude([1.0]) > gap
    assert touching.any()
    # Where it touches, the wall pushes back: the mean moves away from it.
    assert heavy.displacement[touching, 0, 0].min() < 0
    assert np.abs(heavy.displacement[~touching, 0, 0]).max() < 1e-15


@pytest.mark.long
def test_an_unfinished_branch_keeps_its_points_and_says_why(blade: Blade) -> None:
    call = partial(
        forced_response,
        blade.superelement,
        blade.pairs,
        blade.force_cos,
        frequency_hz=blade.window_hz,
        harmonics=1,
        samples=64,
        continuation=ContinuationSettings(max_points=5),
    )
    with pytest.warns(NotConvergedWarning) as caught:
        unfinished = call()
    assert caught[0].filename == __file__  # the line of the caller
    printed_sentence(str(caught[0].message))
    assert not unfinished.converged
    assert unfinished.frequency_hz.size == 5
    printed_sentence(unfinished.message)
    with rejects(ConvergenceError):
        call(raise_on_failure=True)


@pytest.mark.long
def test_no_first_point_raises_with_every_attempt(blade: Blade) -> None:
    with rejects(ConvergenceError):
        forced_response(
            blade.superelement,
            blade.pairs,
            blade.force_cos,
            frequency_hz=(690.0, 700.0),
            harmonics=3,
            samples=64,
            newton=NewtonSettings(tolerance=1e-9, max_iterations=0),
            continuation=ContinuationSettings(max_points=100),
        )


def test_progress_is_reported(blade: Blade) -> None:
    received: list[float] = []
    words: list[str] = []

    def listen(fraction: float, detail: str) -> None:
        received.append(fraction)
        words.append(detail)

    forced_response(
        blade.superelement,
        blade.pairs,
        1e-3 * blade.force_cos,
        frequency_hz=(600.0, 610.0),
        harmonics=1,
        progress=listen,
    )
    assert received == sorted(received)
    assert received[-1] == 1.0
    assert received.count(1.0) == 1, "the curve is not the end: checks and linear limits follow"
    assert words[:3] == [
        f"modes of the stuck structure, {blade.superelement.size} unknowns",
        f"compliance of {blade.n_pairs} pairs",
        "first point",
    ]
    assert words[-4:-1] == ["energies and checks of the curve", "stability of the points", "linear limits"]


@pytest.mark.slow
def test_iterations_of_newton_are_reported_at_the_start_and_along_the_curve(blade: Blade) -> None:
    words: list[str] = []
    blade.response(
        frequency_hz=(684.0, 686.0), harmonics=1, samples=64, progress=lambda fraction, detail: words.append(detail)
    )
    assert any(re.fullmatch(r"first point; iteration 1, relative residual \d\.\de[-+]\d\d", each) for each in words)
    assert any(re.match(r"[\d.]+ Hz, point \d+, \d+ pairs moving; iteration 1, ", each) for each in words)


BAD: dict[str, tuple[Any, ...]] = {
    "zero width": ({"frequency_hz": (600.0, 600.0)}, "frequency_hz"),
    "negative frequency": ({"frequency_hz": (-1.0, 600.0)}, "frequency_hz"),
    "one frequency": ({"frequency_hz": (1.0,)}, "frequency_hz"),
    "few samples": ({"samples": 10, "harmonics": 5}, "samples"),
    "no harmonics": ({"harmonics": 0}, "harmonics"),
    "update": ({"update": "magic"}, "update"),
    "damping": ({"modal_damping_ratio": -0.1}, "modal_damping_ratio"),
    "threads": ({"threads": 0}, "threads"),
    "force shape": ({"force_cos": np.ones(3)}, "excitation"),
    "force harmonics": ({"force_cos": np.ones((38, 4)), "harmonics": 3}, "excitation"),
    "no force": ({"force_cos": np.zeros(38)}, "excitation"),
    "nan force": ({"force_cos": np.full(38, np.nan)}, "force_cos"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_gets_a_sentence(blade: Blade, case: str) -> None:
    changes, *keys = BAD[case]
    arguments = {"force_cos": blade.force_cos, "frequency_hz": (600.0, 610.0), **changes}
    with rejects(InputError, *keys):
        forced_response(blade.superelement, blade.pairs, **arguments)


@pytest.mark.slow
def test_a_window_inside_the_resonance_finds_a_start(bench: ForcedResponse, blade: Blade) -> None:
    """Newton does not converge from the linear response there, so the start falls back and says so."""
    inside = blade.response(
        frequency_hz=(688.0, 700.0),
        harmonics=9,
        samples=256,
    )
    assert inside.converged, inside.message
    printed_sentence(inside.message)
    assert inside.residual.max() < 1e-8
    nearest = int(np.abs(bench.frequency_hz - 700.0).argmin())
    whole = bench.harmonic_amplitude(blade.tip, 1)[nearest]
    assert inside.harmonic_amplitude(blade.tip, 1)[-1] == pytest.approx(whole, rel=0.02)
