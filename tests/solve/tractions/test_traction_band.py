"""The band of residual tractions: closed form, derivatives, brute force over random tractions, and the bench blade."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import benchmark_module
from sentences import printed_sentence, rejects
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.harmonic.traction_sensitivity import Quantity, TractionSensitivity
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import Balances, prepare_balances
from stickslip.solve.tractions import traction_band
from stickslip.solve.tractions.extreme_tractions import with_residual_traction
from stickslip.solve.tractions.traction_band import friction_limit

STIFFNESS, LIMIT = 1.0e6, 100.0  # N/m of the structure, N of friction
BLADE = benchmark_module("blade_problem").load_blade_problem(10)
AROUND_PEAK_HZ = (672.0, 702.0)


def oscillator(**options: Any) -> ss.ForcedResponse:
    """One mass that moves along t1 with one pair under a constant normal load; the force makes it slip at the peak."""
    structure = ss.Superelement(np.eye(1), np.array([[STIFFNESS]]), np.array([[50.0]]))
    operator = np.array([[1.0], [0.0], [0.0]])
    pairs = ss.ContactPairs(operator, 1e6, 2e6, 0.2, LIMIT / 0.2)
    return ss.forced_response(
        structure, pairs, np.array([150.0]), frequency_hz=(150.0, 320.0), harmonics=3, samples=64, **options
    )


def blade_pairs(traction: np.ndarray | None = None) -> ss.ContactPairs:
    return ss.ContactPairs(
        BLADE.contact_operator(), BLADE.normal_stiffness, BLADE.tangential_stiffness, BLADE.friction_coefficient,
        BLADE.preload, traction,
    )  # fmt: skip


def blade_curve(traction: np.ndarray | None = None, **options: Any) -> ss.ForcedResponse:
    structure = ss.Superelement(BLADE.mass, BLADE.stiffness, BLADE.damping)
    return ss.forced_response(
        structure, blade_pairs(traction), force_cos=BLADE.force_cos, force_sin=BLADE.force_sin,
        frequency_hz=AROUND_PEAK_HZ, harmonics=3, samples=128, **options,
    )  # fmt: skip


@cache
def blade_with_band() -> ss.ForcedResponse:
    return blade_curve(traction_band=BLADE.output)


@pytest.mark.slow
def test_the_release_of_a_traction_moves_one_slipping_pair_by_its_static_displacement() -> None:
    """Under a constant normal load slip only releases T0: the vibration is the same, the mean is T0 / k."""
    band = oscillator(traction_band=[1.0]).traction_band
    assert band is not None
    without = float(oscillator().amplitude([1.0]).max())
    low, high = band.peak_range([1.0])
    assert low == pytest.approx(without, rel=1e-3)
    assert high == pytest.approx(without + LIMIT / STIFFNESS, rel=1e-3)
    assert np.abs(band.traction[:, 0, 0]).max() == pytest.approx(LIMIT)
    assert not band.traction[:, 0, 1].any()
    vibration = band.peak_range([1.0], harmonic=1)
    assert vibration[1] == pytest.approx(vibration[0], rel=1e-6)


@pytest.mark.slow
def test_a_stuck_pair_at_its_limit_releases_the_variation_of_its_traction() -> None:
    """With mean m and amplitude X it sticks if ``T0 - k m + kt X <= mu N``: ``m = kt X / k`` at ``T0 = mu N``."""
    structure = ss.Superelement(np.eye(1), np.array([[STIFFNESS]]), np.array([[20.0]]))
    pairs = ss.ContactPairs(np.array([[1.0], [0.0], [0.0]]), 1e6, 2e6, 0.2, 1400.0)
    response = ss.forced_response(
        structure, pairs, np.array([4.0]), frequency_hz=(250.0, 300.0), samples=64, traction_band=[1.0]
    )
    band = response.traction_band
    assert band is not None
    assert not (response.contact_state != ss.ContactState.STUCK).any()
    amplitude = float(response.amplitude([1.0]).max())
    low, high = band.peak_range([1.0])
    assert low == pytest.approx(amplitude, rel=1e-3)
    assert high == pytest.approx(amplitude * (1.0 + 2e6 / STIFFNESS), rel=1e-3)
    vibration = band.peak_range([1.0], harmonic=1)
    assert vibration[1] == pytest.approx(vibration[0], rel=1e-3)


def prepared_blade() -> Balances:
    structure = ss.Superelement(BLADE.mass, BLADE.stiffness, BLADE.damping)
    force = ss.Excitation.force(BLADE.force_cos, BLADE.force_sin)
    still = blade_pairs(np.zeros((10, 2)))
    highest = 2 * np.pi * AROUND_PEAK_HZ[1]
    return prepare_balances(structure, still, force, highest, 3, 128, None, "tractrix", lambda words: None)


@pytest.mark.slow
def test_derivatives_by_tractions_are_those_of_differences() -> None:
    """At a fixed place along the curve, solved again with tractions of 0.002 N more and less: 1e-5."""
    balances = prepared_blade()
    curve = FrequencyCurve(balances.with_harmonics(3))
    newton = Newton(curve, NewtonSettings())
    start, _ = first_point(newton, curve, 2 * np.pi * 680.0)
    branch = Branch(newton, start, 2 * np.pi * 690.0, ContinuationSettings())
    points = [each.point for each in branch.follow()]
    middle = int(np.argmax([np.linalg.norm(point.measured) for point in points]))
    point, along = points[middle], points[middle + 1].unknowns - points[middle - 1].unknowns
    weights = curve.balance.determined(along)
    plane = Plane(weights / np.linalg.norm(weights), 0.0, point.unknowns, 0.0)

    def quantities(traction: np.ndarray) -> list[Quantity]:
        pairs = with_residual_traction(balances.pairs, traction)
        balance = replace(balances, pairs=pairs).exact(3, 128)
        other = FrequencyCurve(balance)
        solver = Newton(other, NewtonSettings(tolerance=1e-12))
        correction = solver.correct(other.evaluate(point.unknowns, point.parameters), plane)
        assert correction.converged
        sensitivity = TractionSensitivity(balance, correction.point, along)
        return [sensitivity.frequency(), *sensitivity.extremes(BLADE.output, BLADE.output)]

    exact = quantities(np.zeros((10, 2)))
    for pair, axis in ((0, 0), (3, 1), (5, 0)):
        step = np.zeros((10, 2))
        step[pair, axis] = 0.002
        for quantity, more, less in zip(exact, quantities(step), quantities(-step), strict=True):
            scale = np.abs(quantity.by_traction).max()
            assert abs((more.value - less.value) / 0.004 - quantity.by_traction[pair, axis]) < 1e-5 * scale


@pytest.mark.long
def test_the_band_of_the_bench_blade_contains_what_random_tractions_gave() -> None:
    """18 random tractions gave peaks (first harmonic) of 189.6 to 204.7 µm, jumps up at 684.2 to 686.9 Hz, and 109 to
    191 µm at 684.8 Hz."""
    band = blade_with_band().traction_band
    assert band is not None
    assert band.complete.all()
    low, high = band.peak_range(BLADE.output, harmonic=1)
    assert low < 189.6e-6
    assert high > 204.7e-6
    jumps = band.jump_range_hz("up", BLADE.output)
    assert jumps is not None
    assert jumps[0] < 684.2
    assert jumps[1] > 686.9
    at = band.amplitude_range(BLADE.output, 684.8, harmonic=1)
    assert at is not None
    assert at[0] < 109e-6
    assert at[1] > 191e-6


@pytest.mark.long
def test_random_admissible_tractions_stay_inside_the_band_of_the_bench_blade() -> None:
    band = blade_with_band().traction_band
    assert band is not None
    limit, random = friction_limit(blade_pairs()), np.random.default_rng(7)
    ranges = {harmonic: band.peak_range(BLADE.output, harmonic) for harmonic in (None, 1)}
    for number in range(6):
        angle = random.uniform(0.0, 2 * np.pi, 10)
        size = limit * (1.0 if number % 2 else np.sqrt(random.uniform(0.0, 1.0, 10)))
        curve = blade_curve(0.999 * size[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))
        assert curve.converged
        for harmonic, (low, high) in ranges.items():
            amplitude = (
                curve.amplitude(BLADE.output) if harmonic is None else curve.harmonic_amplitude(BLADE.output, harmonic)
            )
            assert low < amplitude.max() < high


@pytest.mark.slow
def test_a_band_survives_its_file(tmp_path: Path) -> None:
    response = blade_with_band()
    response.save(tmp_path / "results.nc")
    again = ss.ForcedResponse.load(tmp_path / "results.nc")
    assert again == response
    assert again.traction_band == response.traction_band
    words = repr(again.traction_band)
    assert words.startswith("TractionBand(4 curves from ")
    assert again.traction_band is not None
    assert again.traction_band.raised_peaks is not None
    assert again.traction_band.raised_peaks.size == 4
    assert "peak raised" in words
    assert "NOT" not in words


@pytest.mark.slow
def test_a_band_whose_curves_end_early_says_so() -> None:
    with pytest.warns(ss.NotConvergedWarning):
        response = oscillator(traction_band=[1.0], continuation=ss.ContinuationSettings(max_points=6))
    band = response.traction_band
    assert band is not None
    assert not band.complete.any()
    assert "NOT complete" in repr(band)
    printed_sentence("\n".join(response.warnings))


@pytest.mark.parametrize("row", [[0.0], [1.0, 1.0], [float("nan")]])
def test_a_wrong_output_of_a_band_is_rejected(row: list[float]) -> None:
    with rejects(ss.InputError, "traction_band"):
        oscillator(traction_band=row)


def test_a_band_requires_pairs_with_friction() -> None:
    structure = ss.Superelement(np.eye(1), np.array([[STIFFNESS]]), np.array([[5.0]]))
    stop = ss.ElasticStop(np.array([1e6]), np.array([1e-6]))
    pairs = ss.ContactPairs.with_laws(np.array([[0.0], [0.0], [1.0]]), [stop])
    with rejects(ss.InputError, "traction_band"):
        ss.forced_response(structure, pairs, np.array([4.0]), frequency_hz=(100.0, 200.0), traction_band=[1.0])


@pytest.mark.long
def test_an_optimisation_ends_at_its_limit_of_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """The band of tractions to first order remains, with a message; without the limit there is none."""
    monkeypatch.setattr(traction_band, "LEAST_WORK", 30)
    monkeypatch.setattr(traction_band, "MOST_ITERATIONS", 0)
    response = oscillator(traction_band=np.ones(1))
    assert response.traction_band is not None
    (sentence,) = [each for each in response.warnings if "limit:" in each]
    printed_sentence(sentence)
    monkeypatch.undo()
    assert not [each for each in oscillator(traction_band=np.ones(1)).warnings if "limit:" in each]
