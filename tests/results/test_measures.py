"""Peaks, half-power width, states and energy balance against closed forms."""

import dataclasses

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.results.measures import energy_imbalance, hertz, state_counts, summary, summary_table
from stickslip.results.peaks import Peak, half_power_width, peaks
from synthetic import synthetic_response, synthetic_study


def receptance(frequency: np.ndarray, natural: float, ratio: float) -> np.ndarray:
    """Amplitude of one linear oscillator over its static deflection."""
    r = frequency / natural
    return 1.0 / np.hypot(1 - r**2, 2 * ratio * r)


@pytest.mark.parametrize("shift", [0.0, 0.2, 0.5])
def test_peak_of_an_oscillator_from_a_few_points_in_its_width(shift: float) -> None:
    ratio, natural = 0.002, 480.0
    frequency = natural * (1 + ratio * (np.arange(-20, 21) + shift) * 0.5)
    peak = peaks(frequency, receptance(frequency, natural, ratio))[0]
    assert peak.bracketed
    assert peak.amplitude == pytest.approx(1 / (2 * ratio * np.sqrt(1 - ratio**2)), rel=1e-4)
    assert peak.frequency_hz == pytest.approx(natural * np.sqrt(1 - 2 * ratio**2), rel=1e-5)
    assert half_power_width(frequency, receptance(frequency, natural, ratio), peak) == pytest.approx(ratio, rel=0.03)


def test_half_power_width_of_an_oscillator_converges_to_its_damping_ratio() -> None:
    ratio, natural = 0.002, 480.0
    frequency = np.linspace(470.0, 490.0, 4001)
    amplitude = receptance(frequency, natural, ratio)
    assert half_power_width(frequency, amplitude, peaks(frequency, amplitude)[0]) == pytest.approx(ratio, rel=1e-4)


def test_peak_of_a_curve_that_folds_stays_on_its_own_branch() -> None:
    # A hardening backbone: the curve leans over and turns back in frequency; the top lies on the fold.
    turn = np.linspace(-1.2, 1.2, 61)
    amplitude = np.exp(-(turn**2))
    frequency = 100.0 + 3.0 * amplitude**2 + 0.3 * turn
    assert (np.diff(frequency) < 0).any()
    peak = peaks(frequency, amplitude)[0]
    assert peak.point == 30
    assert peak.amplitude == pytest.approx(1.0, abs=1e-6)
    assert peak.frequency_hz == pytest.approx(103.0, abs=0.02)


def test_peaks_come_highest_first_and_the_end_of_a_curve_is_not_bracketed() -> None:
    frequency = np.arange(7.0)
    actual = peaks(frequency, np.array([0.0, 2.0, 1.0, 1.0, 4.0, 3.0, 3.0]))
    assert [peak.point for peak in actual] == [4, 1]
    assert actual[0].amplitude >= 4.0
    rising = peaks(frequency, frequency)
    assert rising == [Peak(6, 6.0, 6.0, bracketed=False)]
    assert half_power_width(frequency, frequency, rising[0]) is None
    with rejects(InputError, "frequency_hz", "amplitude"):
        peaks([1.0, 2.0], [1.0])
    with rejects(InputError, "amplitude"):
        peaks([1.0, 2.0], [1.0, -1.0])


def test_half_power_needs_both_flanks() -> None:
    frequency = np.linspace(479.0, 490.0, 400)
    amplitude = receptance(frequency, 480.0, 0.004)
    assert half_power_width(frequency, amplitude, peaks(frequency, amplitude)[0]) is None


def test_state_counts_add_up() -> None:
    counts = state_counts(np.array([[0, 0, 1, 2], [2, 2, 2, 2]], dtype=np.int8))
    np.testing.assert_array_equal(counts, [[2, 1, 1], [0, 0, 4]])


def test_energy_balance_of_a_solved_case_and_of_a_spoiled_one() -> None:
    response = synthetic_response(columns=4, rows=3, n_points=20)
    assert np.abs(energy_imbalance(response)).max() < 1e-9
    spoiled = dataclasses.replace(response, input_energy=response.input_energy * 1.25)
    np.testing.assert_allclose(energy_imbalance(spoiled), -0.2, atol=1e-9)
    still = dataclasses.replace(response, input_energy=np.zeros(20))
    assert np.isinf(energy_imbalance(still)).all()


@pytest.mark.slow
def test_summary_of_a_damped_case() -> None:
    response, study = synthetic_response(), synthetic_study()
    result = summary(response, study.outputs[study.response_output])
    assert result.reduction_from_stuck is not None
    assert 0.0 < result.reduction_from_stuck < 1.0
    assert result.reduction_from_stuck == 1 - result.peak.amplitude / result.stuck_peak.amplitude
    assert result.stuck_peak.frequency_hz == pytest.approx(response.linear.stuck_frequency_hz[0], rel=1e-4)
    assert result.free_peak.frequency_hz == pytest.approx(418.0, rel=1e-3)
    assert result.shift_from_stuck_hz == pytest.approx(result.peak.frequency_hz - result.stuck_peak.frequency_hz)
    assert sum(result.state_counts) == 110
    assert result.friction_share == pytest.approx(result.friction_energy / result.input_energy, rel=1e-6)
    assert result.half_power_width is not None
    assert 0.001 < result.half_power_width < 0.02
    loss = result.friction_energy + result.viscous_energy
    kinetic = response.kinetic_energy[result.peak.point]
    assert result.equivalent_damping == pytest.approx(loss / (4 * np.pi * kinetic))
    # the viscous part alone is that of the damping matrix of the model, with 0.2 % in each stuck mode
    assert result.viscous_energy / (4 * np.pi * kinetic) == pytest.approx(0.002, rel=0.1)
    earlier = dataclasses.replace(response, kinetic_energy=np.zeros(1))
    assert summary(earlier, study.outputs[study.response_output]).equivalent_damping is None
    alike = (result.upward_peak, result.downward_peak, result.jumps, result.sweeps_differ)
    assert alike == (result.peak, result.peak, (), False)
    names = [name for name, _, _ in summary_table(result)]
    assert len(set(names)) == len(names) == 23
    assert abs(result.first_harmonic) + abs(result.mean) > 0.9 * result.peak.amplitude


def test_summary_without_a_linear_peak_in_range_reports_it() -> None:
    response, study = synthetic_response(), synthetic_study()
    low = response.linear.frequency_hz < 412.0
    linear = dataclasses.replace(
        response.linear,
        frequency_hz=response.linear.frequency_hz[low],
        stuck=response.linear.stuck[low],
        free=response.linear.free[low],
    )
    result = summary(dataclasses.replace(response, linear=linear), study.outputs[study.response_output])
    assert result.reduction_from_stuck is None
    assert result.shift_from_free_hz is None
    assert {name: value for name, value, _ in summary_table(result)}["Shift from the linear free peak"] == "-"


@pytest.mark.parametrize(
    ("value", "words"),
    [(452.343123, "452.34"), (-34.3249, "-34.32"), (-4.0543, "-4.05"), (0.812345, "0.8123"), (-0.001, "0.00")],
)
def test_frequencies_have_two_places_or_four_digits(value: float, words: str) -> None:
    assert hertz(value) == words


def test_work_of_normal_forces_that_is_round_off_is_zero() -> None:
    response = synthetic_response()
    output = synthetic_study().outputs[synthetic_study().response_output]

    def shown(fraction: float) -> str:
        work = np.full_like(
            response.normal_work, fraction * response.input_energy.max() / response.normal_work.shape[1]
        )
        rows = summary_table(summary(dataclasses.replace(response, normal_work=work), output))
        return next(value for name, value, _ in rows if name.startswith("Work of the normal forces"))

    assert shown(-1e-18) == "0"
    assert float(shown(-1e-3)) < 0.0
