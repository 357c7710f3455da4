"""ForcedResponse: amplitudes, signals, pair cycles, equality and refusals."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.fourier import synthesis_matrix
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.results.response import ForcedResponse
from synthetic import N_UNKNOWNS, synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def response() -> ForcedResponse:
    return synthetic_response(columns=4, rows=3, n_points=20)


def test_amplitude_of_one_harmonic_with_mean_is_mean_plus_radius() -> None:
    coefficients = np.array([[0.5, 3.0, 4.0, 0.0, 0.0], [-0.5, 3.0, 4.0, 0.0, 0.0], [0.0, 0.0, 0.0, -0.6, 0.8]])
    np.testing.assert_allclose(periodic_amplitude(coefficients), [5.5, 5.5, 1.0], rtol=1e-14)


@pytest.mark.slow
def test_amplitude_equals_a_very_fine_search() -> None:
    coefficients = np.random.default_rng(3).normal(size=(200, 11))
    matrix = synthesis_matrix(5, 200_000)
    fine = [np.abs(matrix @ row).max() for row in coefficients]  # one at a time: all motions would be 320 MB
    np.testing.assert_allclose(periodic_amplitude(coefficients), fine, rtol=1e-8)


def test_amplitude_without_motion_or_without_harmonics() -> None:
    np.testing.assert_array_equal(periodic_amplitude(np.array([[0.0, 0.0, 0.0], [-2.0, 0.0, 0.0]])), [0.0, 2.0])
    np.testing.assert_array_equal(periodic_amplitude(np.array([[-3.0]])), [3.0])


def test_harmonic_amplitude_and_signal_agree_with_the_coefficients(response: ForcedResponse) -> None:
    row = np.eye(N_UNKNOWNS)[0]
    coefficients = response.displacement[:, 0]
    np.testing.assert_allclose(response.harmonic_amplitude(row, 2), np.hypot(coefficients[:, 3], coefficients[:, 4]))
    np.testing.assert_allclose(response.harmonic_amplitude(row, 0), np.abs(coefficients[:, 0]))
    times = 2 * np.pi * np.arange(48) / 48
    expected = coefficients[7, 0] + sum(
        coefficients[7, 2 * k - 1] * np.cos(k * times) + coefficients[7, 2 * k] * np.sin(k * times) for k in (1, 2, 3)
    )
    np.testing.assert_allclose(response.signal(row, 7, 48), expected, atol=1e-18)
    assert response.amplitude(row)[7] >= np.abs(expected).max() * (1 - 1e-14)


def test_pair_displacement_is_operator_times_displacement(response: ForcedResponse) -> None:
    motion = response.pair_displacement(4, 32)
    u = response.displacement[4] @ synthesis_matrix(response.harmonics, 32).T
    np.testing.assert_allclose(motion.reshape(32, -1), (response.pairs.operator @ u).T, atol=1e-20)


def test_pair_cycle_reproduces_stored_states_and_energies(response: ForcedResponse) -> None:
    point = int(response.dissipated_energy.sum(axis=1).argmax())
    cycle = response.pair_cycle(point)
    assert response.dissipated_energy[point].sum() > 0
    np.testing.assert_array_equal(cycle.state, response.contact_state[point])
    # The stored energy comes from the harmonics of the force, that of the cycle from its samples.
    np.testing.assert_allclose(cycle.dissipated_energy.sum(), response.dissipated_energy[point].sum(), rtol=0.02)


def test_another_analysis_has_the_resolution_of_the_curve_or_of_its_points_if_they_have_more(
    response: ForcedResponse,
) -> None:
    own = response.harmonics, response.samples
    assert response.resolution_at() == response.resolution_at([3]) == own
    numbers = np.full(response.n_points, response.harmonics)
    numbers[:5] = 1
    asked = response.settings | {"harmonics": 1, "samples": 16}
    lent = dataclasses.replace(response, point_harmonics=numbers, settings=asked)
    assert lent.resolution_at() == lent.resolution_at([0, 4]) == (1, 16)
    assert lent.resolution_at([4, 5]) == own
    accurate = dataclasses.replace(lent, estimated_error=np.zeros(response.n_points))
    assert accurate.resolution_at([0]) == own


def test_equality_looks_at_every_entry(response: ForcedResponse) -> None:
    same = dataclasses.replace(response, displacement=response.displacement.copy())
    assert same == response
    changed = response.displacement.copy()
    changed[3, 2, 1] += 1e-15
    assert dataclasses.replace(response, displacement=changed) != response
    assert dataclasses.replace(response, settings={**response.settings, "samples": 65}) != response
    assert response != "text"
    assert synthetic_study(4, 3) == dataclasses.replace(synthetic_study(4, 3))
    assert synthetic_study(4, 3) != synthetic_study(11, 5)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"residual": np.zeros(3)}, "residual"),
        ({"displacement": np.zeros((20, N_UNKNOWNS, 5))}, "displacement"),
        ({"input_energy": np.full(20, np.nan)}, "input_energy"),
        ({"contact_state": np.full((20, 24), 3)}, "contact_state"),
        ({"frequency_hz": np.empty(0)}, "frequency_hz"),
    ],
)
def test_wrong_arrays_are_rejected(response: ForcedResponse, change: dict[str, Any], key: str) -> None:
    with rejects(InputError, key):
        dataclasses.replace(response, **change)


def test_wrong_questions_are_rejected(response: ForcedResponse) -> None:
    with rejects(InputError, "output"):
        response.amplitude(np.ones(3))
    with rejects(InputError, "harmonic"):
        response.harmonic_amplitude(np.ones(N_UNKNOWNS), 4)
    with rejects(InputError, "point"):
        response.signal(np.ones(N_UNKNOWNS), 20, 16)
    with rejects(InputError, "limit"):
        response.linear_amplitude(np.ones(N_UNKNOWNS), "tied")


def test_the_curve_is_drawn_in_hz_and_um_zero_to_peak(response: ForcedResponse) -> None:
    row = np.eye(N_UNKNOWNS)[0]
    (axes,) = response.plot(row, "tip $x$").axes
    lines = {line.get_label(): line for line in axes.lines}
    np.testing.assert_array_equal(lines["with friction"].get_xdata(), response.frequency_hz)
    np.testing.assert_allclose(
        np.asarray(lines["with friction"].get_ydata()), 1e6 * response.amplitude(row), rtol=1e-14
    )
    without_contact = np.asarray(lines["linear, no contact"].get_ydata())
    np.testing.assert_allclose(without_contact, 1e6 * response.linear_amplitude(row, "free"))
    assert "linear, all stuck" in lines
    assert axes.get_xlabel() == "Excitation frequency, Hz"
    assert axes.get_ylabel() == "Amplitude, 0-to-peak, µm\ntip $x$"
    assert response.plot(row).axes[0].get_ylabel() == "Amplitude, 0-to-peak, µm"
    with rejects(InputError, "output"):
        response.plot(np.ones(3))


def test_one_line_shows_what_a_result_is(response: ForcedResponse) -> None:
    top = response.input_energy.argmax()
    assert repr(response) == (
        f"ForcedResponse(20 points from 411.11 to 429.96 Hz, 24 pairs; peak at {response.frequency_hz[top]:.2f} Hz, "
        f"with an input of {response.input_energy[top]:.3g} J per cycle and {response.moving_pairs[top]} moving pairs; "
        "converged)"
    )
    assert "NOT converged" in repr(dataclasses.replace(response, converged=False))
    assert repr(response.linear).startswith("LinearCurves(601 points from 405.00 to 439.32 Hz; first natural frequency")
    assert repr(synthetic_study(4, 3)) == (
        'StudyRecord("Two blades with an under-platform damper (synthetic)": 8 outputs, 24 pairs on Left face, '
        "Right face)"
    )
