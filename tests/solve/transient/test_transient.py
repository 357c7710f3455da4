"""Time integration: the step law, the scheme against exact solutions, and the blade against the harmonic balance."""

from __future__ import annotations

import numpy as np
import pytest

from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.transient.integrate import TransientResponse, integrate_to_steady_state, start_from_response
from stickslip.solve.transient.kernel import OPEN, SLIPPING, STUCK, step_law
from stickslip.structure.superelement import Superelement

K_TANGENTIAL, K_NORMAL, FRICTION = 2.0, 3.0, 0.4


def run_step_law(step: FloatArray, traction: FloatArray, normal_force: float) -> tuple[FloatArray, FloatArray, int]:
    force, tangent = np.empty(3), np.empty((3, 3))
    kind = step_law(step, traction, normal_force, K_TANGENTIAL, K_NORMAL, FRICTION, force, tangent)
    return force, tangent, kind


def random_step(rng: np.random.Generator) -> tuple[FloatArray, FloatArray, float]:
    """A step of any size from any admissible state, half of them on the friction limit."""
    normal_force = rng.uniform(-1.0, 3.0)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    size = FRICTION * max(normal_force, 0.0) * (1.0 if rng.random() < 0.5 else rng.random())
    traction = size * np.array([np.cos(angle), np.sin(angle)])
    return rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.5), traction, normal_force


def radial_return(step: FloatArray, traction: FloatArray, normal_force: float, n_substeps: int) -> FloatArray:
    """First-order reference: the textbook return to the cone in many small steps."""
    traction, normal = traction.copy(), normal_force
    for _ in range(n_substeps):
        normal += K_NORMAL * step[2] / n_substeps
        traction += K_TANGENTIAL * step[:2] / n_substeps
        limit = FRICTION * max(normal, 0.0)
        size = np.hypot(*traction)
        if size > limit:
            traction *= limit / size
    return traction


@pytest.mark.slow
def test_step_law_is_the_limit_of_radial_return_in_many_substeps() -> None:
    rng = np.random.default_rng(1)
    for _ in range(60):
        step, traction, normal_force = random_step(rng)
        force, _, _ = run_step_law(step, traction, normal_force)
        coarse, fine = (radial_return(step, traction, normal_force, n) for n in (1000, 2000))
        np.testing.assert_allclose(force[:2], 2.0 * fine - coarse, atol=3e-5)


@pytest.mark.slow
def test_step_law_tangent_equals_central_differences() -> None:
    rng = np.random.default_rng(2)
    seen = set()
    for _ in range(4000):
        step, traction, normal_force = random_step(rng)
        _, tangent, kind = run_step_law(step, traction, normal_force)
        differences, kinds = np.empty((3, 3)), {kind}
        for axis in range(3):
            up, down = step.copy(), step.copy()
            up[axis] += 1e-6
            down[axis] -= 1e-6
            (force_up, _, kind_up), (force_down, _, kind_down) = (
                run_step_law(moved, traction, normal_force) for moved in (up, down)
            )
            kinds |= {kind_up, kind_down}
            differences[:, axis] = (force_up - force_down) / 2e-6
        if len(kinds) == 1:  # not on a switch, where the law has a corner
            seen.add((kind, normal_force > 0.0))
            np.testing.assert_allclose(tangent, differences, atol=1e-6 * max(1.0, np.abs(tangent).max()))
    assert seen == {(kind, closed) for kind in (STUCK, SLIPPING, OPEN) for closed in (True, False)}


@pytest.mark.slow
def test_step_law_stays_in_the_cone_and_does_not_depend_on_the_axes() -> None:
    rng = np.random.default_rng(3)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    for _ in range(500):
        step, traction, normal_force = random_step(rng)
        force, _, _ = run_step_law(step, traction, normal_force)
        assert np.hypot(force[0], force[1]) <= FRICTION * force[2] * (1.0 + 1e-12)
        turned, _, _ = run_step_law(np.append(turn @ step[:2], step[2]), turn @ traction, normal_force)
        np.testing.assert_allclose(turned[:2], turn @ force[:2], atol=1e-12)


def test_step_law_slips_radially_when_only_the_normal_force_falls() -> None:
    force, tangent, kind = run_step_law(np.array([0.0, 0.0, -0.2]), np.array([0.24, 0.32]), 1.0)
    assert kind == SLIPPING
    np.testing.assert_allclose(force, [0.6 * 0.16, 0.8 * 0.16, 0.4], rtol=1e-14)
    np.testing.assert_allclose(tangent[:, 2], [0.6 * FRICTION * K_NORMAL, 0.8 * FRICTION * K_NORMAL, K_NORMAL])


def spring_pair(friction: float, preload: float) -> ContactPairs:
    return ContactPairs(np.eye(3), K_NORMAL, K_TANGENTIAL, friction, preload)


MASS, DAMPING, STIFFNESS = 1.0, 0.3, 5.0
POINT_MASS = Superelement(MASS * np.eye(3), STIFFNESS * np.eye(3), DAMPING * np.eye(3))


def observed_order(errors: list[float], steps: list[int]) -> float:
    return -float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


@pytest.mark.slow
def test_stuck_pair_follows_the_exact_linear_response_with_second_order() -> None:
    frequency_hz, steps = 0.3, [50, 100, 200, 400]
    omega = 2.0 * np.pi * frequency_hz
    springs = np.array([K_TANGENTIAL, K_TANGENTIAL, K_NORMAL])
    force_cos, force_sin = np.array([1.0, 0.5, 0.2]), np.array([0.0, 0.3, -0.4])
    exact = (force_cos - 1j * force_sin) / (STIFFNESS + springs - MASS * omega**2 + 1j * omega * DAMPING)
    errors = []
    for n_steps in steps:
        response = integrate_to_steady_state(
            POINT_MASS, spring_pair(1e3, 10.0), force_cos, force_sin, frequency_hz, n_steps, 300, tolerance=1e-10
        )
        assert response.converged
        wave = np.exp(1j * omega * response.time)
        errors.append(float(np.abs(response.displacement - (wave[:, None] * exact).real).max()))
    assert errors[-1] < 1e-3 * np.abs(exact).max()
    assert observed_order(errors, steps) == pytest.approx(2.0, abs=0.05)
    assert response.amplitude([0.0, 1.0, 0.0]) == pytest.approx(abs(exact[1]), rel=1e-3)


def manufactured_error(motion: FloatArray, traction: FloatArray, pairs: ContactPairs) -> float:
    """Largest error of the steady state under the force that makes ``motion`` (n_steps, 3), one harmonic, exact.

    Angular frequency 1, so that the acceleration is ``-motion``; ``traction`` (n_steps, 3) is the closed form of
    T1, T2, N - N0. The force is given to the integrator by all the harmonics that the samples hold.
    """
    n_steps = motion.shape[0]
    velocity = np.roll(motion, -n_steps // 4, axis=0)  # of a single harmonic: a quarter period ahead
    load = -MASS * motion + DAMPING * velocity + STIFFNESS * motion + traction
    coefficients = np.fft.rfft(load, axis=0) * 2.0 / n_steps
    coefficients[-1] *= 0.5
    response = integrate_to_steady_state(
        POINT_MASS,
        pairs,
        coefficients[1:].real.T,
        -coefficients[1:].imag.T,
        1.0 / (2.0 * np.pi),
        n_steps,
        max_periods=400,
        tolerance=1e-9,
    )
    assert response.converged
    return float(np.abs(response.displacement - motion).max() / np.abs(motion).max())


@pytest.mark.slow
def test_jenkins_oscillator_reproduces_its_closed_form_with_second_order() -> None:
    amplitude, limit, steps = 1.1, 0.8, [100, 200, 400, 800]
    pairs = ContactPairs(np.eye(3), K_NORMAL, 3.0, FRICTION, limit / FRICTION)
    errors = []
    for n_steps in steps:
        angle = 2.0 * np.pi * np.arange(n_steps) / n_steps
        motion = np.column_stack([amplitude * np.cos(angle), np.zeros(n_steps), np.zeros(n_steps)])
        falling = np.maximum(limit - 3.0 * amplitude * (1.0 - np.cos(angle)), -limit)
        rising = np.minimum(-limit + 3.0 * amplitude * (1.0 + np.cos(angle)), limit)
        traction = np.zeros((n_steps, 3))
        traction[:, 0] = np.where(angle < np.pi, falling, rising)
        errors.append(manufactured_error(motion, traction, pairs))
    assert errors[-1] < 2e-5
    assert observed_order(errors, steps) == pytest.approx(2.0, abs=0.2)


@pytest.mark.slow
def test_circular_slip_reproduces_its_closed_form_with_second_order() -> None:
    amplitude, limit, steps = 1.1, 0.8, [60, 120, 240, 480]
    pairs = ContactPairs(np.eye(3), K_NORMAL, 3.0, FRICTION, limit / FRICTION)
    in_phase = limit / (3.0 * amplitude)
    errors = []
    for n_steps in steps:
        angle = 2.0 * np.pi * np.arange(n_steps) / n_steps
        ahead = angle + np.arccos(in_phase)
        motion = amplitude * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n_steps)])
        traction = limit * np.column_stack([np.cos(ahead), np.sin(ahead), np.zeros(n_steps)])
        errors.append(manufactured_error(motion, traction, pairs))
    assert errors[-1] < 1e-4
    assert observed_order(errors, steps) == pytest.approx(2.0, abs=0.1)


def test_a_stuck_pair_keeps_its_slider_as_a_mean_traction() -> None:
    slider = np.array([[0.2, -0.1]])
    response = integrate_to_steady_state(
        POINT_MASS, spring_pair(1e3, 10.0), np.ones(3), np.zeros(3), 0.3, 100, 300, 1e-10, initial_slider=slider
    )
    expected = K_TANGENTIAL * slider[0] / (STIFFNESS + K_TANGENTIAL)
    np.testing.assert_allclose(response.displacement.mean(axis=0), [*expected, 0.0], atol=1e-8)


def test_a_short_run_says_that_it_has_no_steady_state() -> None:
    response = integrate_to_steady_state(POINT_MASS, spring_pair(0.3, 1.0), np.ones(3), np.zeros(3), 0.3, 100, 3)
    assert not response.converged
    assert response.period_change.shape == (3,)
    printed_sentence(response.message)


@pytest.fixture(scope="module")
def balance(blade: Blade) -> ForcedResponse:
    return blade.response(
        frequency_hz=(665.0, 710.0),
        harmonics=9,
        samples=512,
    )


def integrate_blade(blade: Blade, balance: ForcedResponse, point: int, n_steps: int) -> TransientResponse:
    response = integrate_to_steady_state(
        blade.superelement,
        blade.pairs,
        blade.force_cos,
        blade.force_sin,
        balance.frequency_hz[point],
        n_steps,
        tolerance=1e-6,
        **start_from_response(balance, point),
    )
    assert response.converged, response.message
    return response


@pytest.mark.long
@pytest.mark.parametrize("frequency_hz", [672.0, 686.8, 700.0])
def test_blade_amplitude_equals_nine_harmonics_within_0_3_percent(
    frequency_hz: float, blade: Blade, balance: ForcedResponse
) -> None:
    point = int(np.abs(balance.frequency_hz - frequency_hz).argmin())
    response = integrate_blade(blade, balance, point, 1000)
    assert response.amplitude(blade.tip) == pytest.approx(balance.amplitude(blade.tip)[point], rel=3e-3)


@pytest.mark.slow
def test_residual_tractions_agree_with_a_march_from_rest(blade: Blade) -> None:
    """Some pairs slip from 60 % of their limit on, the others keep their traction, which moves the mean."""
    rest = 0.6 * blade.pairs.friction_coefficient * blade.pairs.preload
    angle = np.linspace(0.0, 2.0, blade.n_pairs)
    traction = rest[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    constants = (blade.pairs.normal_stiffness, blade.pairs.tangential_stiffness, blade.pairs.friction_coefficient)
    retained = ContactPairs(blade.operator, *constants, blade.pairs.preload, traction)
    cosine, sine = blade.force_cos, blade.force_sin
    curve = forced_response(
        blade.superelement, retained, cosine, sine, frequency_hz=(685.0, 686.0), harmonics=9, samples=512
    )
    assert curve.converged
    released = forced_response(
        blade.superelement, blade.pairs, cosine, sine, frequency_hz=(685.0, 685.001), harmonics=9, samples=512
    )
    start = start_from_response(curve, 0)
    march = integrate_to_steady_state(
        blade.superelement, retained, cosine, sine, curve.frequency_hz[0], 1000, tolerance=1e-6, **start
    )
    assert march.converged, march.message
    assert {0, 1} <= set(curve.contact_state[0].tolist())
    assert march.amplitude(blade.tip) == pytest.approx(curve.amplitude(blade.tip)[0], rel=3e-3)
    mean = curve.displacement[0, :, 0] @ blade.tip
    assert (march.displacement @ blade.tip).mean() == pytest.approx(mean, rel=2e-2)
    assert abs(mean - released.displacement[0, :, 0] @ blade.tip) > 0.1 * abs(mean)


@pytest.mark.long
def test_blade_error_falls_with_the_step_and_energy_balances(blade: Blade, balance: ForcedResponse) -> None:
    point = int(np.abs(balance.frequency_hz - 686.8).argmin())
    harmonics = slice(0, 12)
    spectra = {}
    for n_steps in (250, 500, 1000, 4000):
        response = integrate_blade(blade, balance, point, n_steps)
        spectra[n_steps] = (np.fft.rfft(response.displacement @ blade.tip) / n_steps)[harmonics]
    errors = [float(np.linalg.norm(spectra[n] - spectra[4000])) for n in (250, 500, 1000)]
    # Lift-off, touchdown and stick-slip corners fall between the samples: between first and second order.
    assert errors[-1] < 2e-3 * np.linalg.norm(spectra[4000])
    assert 1.2 < observed_order(errors, [250, 500, 1000]) < 2.2

    angle = 2.0 * np.pi * np.arange(4000) / 4000
    load = np.outer(np.cos(angle), blade.force_cos) + np.outer(np.sin(angle), blade.force_sin)
    assert blade.superelement.damping is not None
    step = 1.0 / (balance.frequency_hz[point] * 4000)
    input_energy = step * np.sum(load * response.velocity)
    viscous_energy = step * np.sum(response.velocity * (response.velocity @ blade.superelement.damping))
    relative = response.displacement[:, :30].reshape(4000, 10, 3)[:, :, :2]
    traction = response.contact_force[:, :, :2]
    friction_energy = np.sum(0.5 * (traction + np.roll(traction, -1, 0)) * (np.roll(relative, -1, 0) - relative))
    assert friction_energy > 0.3 * input_energy
    assert friction_energy + viscous_energy == pytest.approx(input_energy, rel=1e-4)


@pytest.mark.parametrize(
    ("change", "keys"),
    [
        ({"frequency_hz": 0.0}, ("frequency_hz",)),
        ({"steps_per_period": 5}, ("steps_per_period",)),
        ({"max_periods": 0}, ("max_periods",)),
        ({"tolerance": -1.0}, ("tolerance",)),
        ({"spectral_radius": 1.5}, ("spectral_radius",)),
        ({"force_cos": np.ones(4)}, ("force_cos",)),
        ({"force_sin": np.array([1.0, np.nan, 0.0])}, ("force_sin",)),
        ({"initial_displacement": np.zeros(2)}, ("initial_displacement",)),
        ({"initial_slider": np.zeros((2, 2))}, ("initial_slider",)),
        ({"pairs": ContactPairs(np.eye(3, 4), 1.0, 1.0, 0.3, 1.0)}, ("operator",)),
        ({"pairs": ContactPairs(np.eye(3), 1.0, np.array([[1.0, 2.0]]), 0.3, 1.0)}, ("tangential_stiffness",)),
        ({"superelement": Superelement(np.diag([1.0, 1.0, 0.0]), np.eye(3))}, ()),
    ],
)
def test_bad_input_gets_a_sentence(change: dict[str, object], keys: tuple[str, ...]) -> None:
    arguments: dict[str, object] = {
        "superelement": POINT_MASS,
        "pairs": spring_pair(0.3, 1.0),
        "force_cos": np.ones(3),
        "force_sin": np.zeros(3),
        "frequency_hz": 0.3,
    }
    with rejects(InputError, *keys):
        integrate_to_steady_state(**(arguments | change))  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_point_beyond_the_curve_gets_a_sentence(balance: ForcedResponse) -> None:
    with rejects(InputError, "point"):
        start_from_response(balance, balance.frequency_hz.size)


def test_the_position_of_a_body_far_away_does_not_hide_that_a_motion_has_not_settled() -> None:
    """Damper 102 of the torture set ends 208 m from its place, and its time integration seemed to settle at once."""
    structure = Superelement(np.eye(4), np.diag([0.0, 0.0, 0.0, 1e6]), np.diag([0.0, 0.0, 0.0, 1.0]))
    pairs = ContactPairs(np.eye(4)[:3], 1e6, 1e6, 0.3, -1.0)  # with a gap: no force at rest
    far = np.array([0.0, 0.0, -1e3, 0.0])  # open
    force = np.array([0.0, 0.0, 0.0, 1.0])
    motion = integrate_to_steady_state(
        structure, pairs, force, 0.0 * force, 150.0, steps_per_period=64, max_periods=20, tolerance=1e-5,
        initial_displacement=far,
    )  # fmt: skip
    assert not motion.converged
    assert motion.period_change[-1] > 0.1
