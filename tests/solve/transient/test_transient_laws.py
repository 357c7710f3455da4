"""Time integration of any laws: against the harmonic balance, the compiled march, and an exact motion."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from law_makers import coulomb, cubic, exponential, iwan, jenkins, stop
from sentences import rejects
from stickslip.solve.transient.integrate import TransientResponse

STRUCTURE = ss.Superelement(np.eye(3), 4e5 * np.eye(3), 60.0 * np.eye(3))
# Law, axis along which it is excited, force in N: all of them far from linear at 112 Hz.
LAWS: dict[str, tuple[ss.ContactLaw, int, float]] = {
    "cubic": (cubic(1e5, 1e15), 0, 8.0),
    "elastic-stop": (stop(4e5, 1e-5, 5e4), 2, 8.0),
    "jenkins": (jenkins(2e5, 3.0, 1e6), 0, 8.0),
    "iwan": (iwan(2e5, 5.0, -0.5, 0.1, 5e5), 0, 6.0),
    "exponential": (exponential([2e5], [1e5], [0.3], [5.0]), 2, 5.0),
}
LAST = 5


def harmonics_of(signal: np.ndarray) -> np.ndarray:
    """Mean and complex amplitudes c - i s of harmonics 1 to LAST of a sampled period."""
    spectrum = 2.0 * np.fft.rfft(signal)[: LAST + 1] / signal.size
    spectrum[0] *= 0.5
    return np.asarray(spectrum)


def both(
    pairs: ss.ContactPairs, force: np.ndarray, harmonics: int, steps: int = 200, tolerance: float = 1e-6
) -> tuple[ss.ForcedResponse, TransientResponse]:
    """The first point of a curve, and the steady state in time that begins there."""
    curve = ss.forced_response(STRUCTURE, pairs, force, frequency_hz=(112.0, 112.5), harmonics=harmonics, samples=2048)
    start = ss.start_from_response(curve, 0)
    march = ss.integrate_to_steady_state(
        STRUCTURE,
        pairs,
        force,
        np.zeros(3),
        curve.frequency_hz[0],
        steps,
        100,
        tolerance,
        start["initial_displacement"],
        start["initial_velocity"],
        initial_cycle=start["initial_cycle"],
    )
    assert march.converged, march.message
    return curve, march


def distance(curve: ss.ForcedResponse, march: TransientResponse, row: np.ndarray) -> float:
    """Largest difference of the first harmonics, as a share of the first one."""
    in_time, in_balance = harmonics_of(march.displacement @ row), harmonics_of(curve.signal(row, 0, 4096))
    return float(np.abs(in_time - in_balance).max() / np.abs(in_time[1]))


@pytest.mark.long
@pytest.mark.parametrize("name", LAWS)
def test_harmonic_balance_and_time_integration_agree(name: str) -> None:
    """Amplitude and phase of the mean and five harmonics, largest displacement, energy of a period."""
    law, axis, size = LAWS[name]
    row = np.eye(3)[axis]
    curve, march = both(ss.ContactPairs.with_laws(np.eye(3), [law]), size * row, harmonics=9)
    assert distance(curve, march, row) < 1e-3
    assert march.amplitude(row) == pytest.approx(curve.amplitude(row)[0], rel=1e-3)
    linear = abs(size / (4e5 + law.resting_springs()[0, axis] - (2 * np.pi * 112.0) ** 2 + 60j * 2 * np.pi * 112.0))
    assert abs(harmonics_of(march.displacement @ row)[1]) != pytest.approx(linear, rel=0.05)  # the law matters
    exchanged = np.abs(march.contact_force[:, 0, axis]).max() * march.amplitude(row)
    assert march.dissipated_energy[0] == pytest.approx(curve.dissipated_energy[0, 0], rel=1e-3, abs=1e-4 * exchanged)
    assert (march.dissipated_energy[0] > 0.1 * exchanged) == (name in ("jenkins", "iwan"))


@pytest.mark.long
def test_more_harmonics_come_closer_to_the_motion_in_time() -> None:
    """A cubic spring: each pair of harmonics takes the balance ten times closer, down to the error of the step."""
    law, axis, size = LAWS["cubic"]
    row = np.eye(3)[axis]
    pairs = ss.ContactPairs.with_laws(np.eye(3), [law])
    _, march = both(pairs, size * row, 9, steps=400)
    peak = march.amplitude(row)
    curves = [
        ss.forced_response(STRUCTURE, pairs, size * row, frequency_hz=(112.0, 112.5), harmonics=h) for h in (1, 3, 5)
    ]
    errors = [abs(curve.amplitude(row)[0] / peak - 1.0) for curve in curves]
    assert errors[0] > 10.0 * errors[1] > 100.0 * errors[2]
    assert errors[2] < 1e-4


@pytest.mark.long
def test_the_error_falls_with_the_square_of_the_step() -> None:
    law, axis, size = LAWS["cubic"]
    row = np.eye(3)[axis]
    pairs = ss.ContactPairs.with_laws(np.eye(3), [law])
    errors = [distance(*both(pairs, size * row, 15, steps, 1e-8), row) for steps in (50, 100, 200)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.2)


@pytest.mark.slow
def test_the_steps_of_the_law_equal_the_compiled_march_of_coulomb_pairs() -> None:
    """Two programs of Coulomb's law: a joint beside a spring without stiffness is not compiled."""
    friction = coulomb([1e6, 8e5], [2e5, 3e5], [0.3, 0.4], [6.0, 4.0], [0.0, 0.0])
    operator = np.vstack([np.eye(3), np.eye(3)[:, [1, 2, 0]], np.eye(3)])
    nothing = cubic(0.0, 0.0)
    alone = ss.ContactPairs.with_laws(operator[:6], [friction])
    beside = ss.ContactPairs.with_laws(operator, [friction, nothing])
    force, sine = np.array([8.0, 3.0, 5.0]), np.array([0.0, 4.0, -6.0])
    compiled, stepped = (
        ss.integrate_to_steady_state(STRUCTURE, pairs, force, sine, 112.0, 100, 3) for pairs in (alone, beside)
    )
    assert stepped.displacement == pytest.approx(compiled.displacement, abs=1e-8 * np.abs(compiled.displacement).max())
    assert stepped.contact_force[:, :2] == pytest.approx(
        compiled.contact_force, abs=1e-7 * np.abs(compiled.contact_force).max()
    )
    assert stepped.dissipated_energy[:2] == pytest.approx(compiled.dissipated_energy, rel=1e-6)
    assert not stepped.dissipated_energy[2]


@pytest.mark.long
def test_a_mixed_joint_balances_its_energy_and_agrees_with_the_balance() -> None:
    laws: list[ss.ContactLaw] = [
        coulomb([3e5], [1e5], [0.3], [8.0], [0.0]),
        exponential([3e5], [1e5], [0.3], [8.0]),
        *(LAWS[name][0] for name in ("cubic", "jenkins", "iwan")),
    ]
    pairs = ss.ContactPairs.with_laws(np.vstack([np.eye(3)] * 5), laws)
    force = np.array([12.0, 5.0, 9.0])
    curve, march = both(pairs, force, harmonics=9)
    for row in np.eye(3):
        assert distance(curve, march, row) < 2e-3
    assert march.dissipated_energy == pytest.approx(curve.dissipated_energy[0], rel=2e-3, abs=1e-8)
    time_step, angle = march.time[1], 2 * np.pi * np.arange(march.time.size) / march.time.size
    values = time_step * (np.cos(angle)[:, None] * force * march.velocity).sum()
    lost = time_step * 60.0 * (march.velocity**2).sum() + march.dissipated_energy.sum()
    assert lost == pytest.approx(values, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["jenkins", pytest.param("iwan", marks=pytest.mark.long)])
def test_a_residual_traction_is_the_same_in_both(name: str) -> None:
    """A joint that a static load has sheared: what it keeps of it moves the mean of the vibration."""
    law, _, _ = LAWS[name]
    pairs, load = ss.ContactPairs.with_laws(np.eye(3), [law]), np.array([4.0, 0.0, 0.0])
    retained = ss.static_preload(STRUCTURE, pairs, load).about(pairs, keep_traction=True)
    row = np.eye(3)[0]
    curve, march = both(retained, 0.25 * row, harmonics=7)
    assert distance(curve, march, row) < 1e-3
    assert march.contact_force[:, 0, 0].mean() > 1.0
    assert march.contact_force[:, 0, 0].mean() == pytest.approx(curve.pair_cycle(0).force[:, 0, 0].mean(), rel=1e-3)


def test_a_start_that_the_laws_do_not_take_gets_a_sentence() -> None:
    elements = ss.ContactPairs.with_laws(np.eye(3), [LAWS["jenkins"][0]])
    pressed = ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 5.0)
    arguments = (np.ones(3), np.zeros(3), 100.0, 50, 2)
    with rejects(ss.InputError, "initial_slider"):
        ss.integrate_to_steady_state(STRUCTURE, elements, *arguments, initial_slider=np.zeros((1, 2)))
    for wrong in (np.zeros((8, 2, 3)), np.zeros((0, 1, 3)), np.zeros(())):
        with rejects(ss.InputError, "initial_cycle"):
            ss.integrate_to_steady_state(STRUCTURE, elements, *arguments, initial_cycle=wrong)
    with rejects(ss.InputError, "initial_cycle"):
        ss.integrate_to_steady_state(STRUCTURE, pressed, *arguments, initial_cycle=np.zeros((8, 1, 3)))
