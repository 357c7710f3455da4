"""The balance with the softest modes of a joint: what it keeps exactly, and the bound of what it neglects."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers import Blade
from stickslip.core.validation import FloatArray
from stickslip.solve import output_maxima, setting_up
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic import harmonic_modes, reduced, soft_structure
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.kept_modes import KeptCompliance
from stickslip.solve.harmonic.soft_structure import SoftStructure
from stickslip.solve.output_maxima import OutputMaxima, cubic_between
from stickslip.solve.path.arc_length import Metric, chord_between
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import BranchPoint
from stickslip.solve.path.work import Work
from stickslip.solve.setting_up import Balances, prepare_balances

RNG = np.random.default_rng(8)
HARMONICS = 3
LOAD = 30.0  # times the force of the blade: pairs slip and separate far from its resonance


def prepared(blade: Blade, few_modes: bool) -> Balances:
    force = Excitation.force(blade.force_cos, blade.force_sin)
    highest = 2.0 * np.pi * max(blade.window_hz)
    undamped = replace(blade.superelement, damping=None)
    return prepare_balances(
        undamped, blade.pairs, force, highest, HARMONICS, 128, None, "tractrix", lambda _: None, few_modes=few_modes
    )


@pytest.fixture
def balances(blade: Blade) -> Balances:
    return prepared(blade, few_modes=False)


def few_of(balances: Balances, blade: Blade, monkeypatch: pytest.MonkeyPatch, count: int) -> Balances:
    """The balances with ``count`` modes and added shapes."""
    frequency = balances.stuck.circular_frequency
    monkeypatch.setattr(soft_structure, "LARGE_ROWS", 1)
    monkeypatch.setattr(soft_structure, "MOST_KEPT", 2.0)
    multiple = float(frequency[count - 1] * 1.0001 / balances.stuck.highest_omega)
    monkeypatch.setattr(soft_structure, "KEPT_RANGE", multiple)
    few = prepared(blade, few_modes=True)
    assert isinstance(few.stuck, SoftStructure)
    assert not isinstance(balances.stuck, SoftStructure)
    return few


def with_range(
    balances: Balances, blade: Blade, monkeypatch: pytest.MonkeyPatch, count: int
) -> tuple[Balance, Balance, float]:
    """The balance with all modes, that with ``count`` kept ones, and the frequency of the first other one."""
    few = few_of(balances, blade, monkeypatch, count)
    whole, kept = (each.with_harmonics(HARMONICS) for each in (balances, few))
    assert isinstance(kept.compliance, KeptCompliance)
    assert not isinstance(whole.compliance, KeptCompliance)
    return whole, kept, float(balances.stuck.circular_frequency[count])


def random_deviation(balance: Balance) -> FloatArray:
    return RNG.standard_normal((2 * HARMONICS + 1, balance.rows))


def test_the_response_to_the_force_keeps_the_first_order_of_inertia(
    balances: Balances, blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, kept, first_other = with_range(balances, blade, monkeypatch, 6)
    errors = []
    for share in (0.1, 0.2):
        omega = share * first_other / HARMONICS
        exact, found = whole.linear(omega), kept.linear(omega)
        errors.append(float(np.linalg.norm(found - exact) / np.linalg.norm(exact)))
    assert errors[1] < 1e-3
    assert errors[0] < errors[1] / 10.0 or errors[0] < 1e-11  # the fourth power: 16


@pytest.mark.long
@pytest.mark.parametrize("large", [False, True])
def test_solutions_satisfy_the_balance_with_all_modes(
    balances: Balances, blade: Blade, monkeypatch: pytest.MonkeyPatch, large: bool
) -> None:
    """In slip and separation too, to the share of inertia in the other modes."""
    if large:
        for module in (harmonic_modes, reduced):
            monkeypatch.setattr(module, "LARGE_ROWS", 1)
        monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    errors, first_mode = [], float(balances.stuck.circular_frequency[0])
    for count in (14, 24):
        whole, kept, first_other = with_range(balances, blade, monkeypatch, count)
        curve = FrequencyCurve(kept, LOAD)
        for share in (0.43, 0.71):
            start = curve.at(kept.linear(share * first_mode, LOAD), share * first_mode)
            plane = Plane.fixed(start.unknowns, share * first_mode)
            correction = Newton(curve, NewtonSettings()).correct(start, plane)
            assert correction.converged
            trial = correction.point.trial
            assert trial.contact.moves.any()
            exact = whole.evaluate(trial.relative, trial.omega, LOAD)
            errors.append(exact.error / (HARMONICS * trial.omega / first_other) ** 2)
            assert exact.error < 1e-2
    assert max(errors) < 1.0, errors


@pytest.mark.slow
def test_outputs_at_a_contact_between_two_points_have_the_part_of_the_other_modes(
    balances: Balances, blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No amplitude contains their part of the deviation, up to 28 % of a change here; 3 % remain."""
    few = few_of(balances, blade, monkeypatch, 6)
    whole, kept = (each.with_harmonics(HARMONICS) for each in (balances, few))
    outputs, first_mode = balances.pairs.operator, float(balances.stuck.circular_frequency[0])
    record: list[FloatArray] = []

    def recorded(signals: FloatArray) -> FloatArray:
        record.append(signals)
        return np.zeros((len(signals), len(outputs)))

    monkeypatch.setattr(output_maxima, "_amplitudes", recorded)
    for balance, own in ((whole, balances), (kept, few)):
        newton = Newton(FrequencyCurve(balance, LOAD), NewtonSettings())
        points = []
        for share in (0.70, 0.71, 0.73):
            start = newton.problem.evaluate(balance.linear(share * first_mode, LOAD), np.array([share * first_mode]))
            correction = newton.correct(start, Plane.fixed(start.unknowns, share * first_mode))
            assert correction.converged
            points.append(correction.point)
        metric = Metric(1.0, 1.0)
        before, after = (BranchPoint(points[at], 0, metric.unit(chord_between(points[0], points[1]))) for at in (0, 2))
        maxima = OutputMaxima(newton, own, outputs, first_mode, Work())
        first, last = (maxima._sampled([each])[0] for each in (before, after))
        maxima._highest = np.ones(len(outputs))
        cubic = cubic_between(before, after, metric)
        assert cubic is not None
        assert maxima._highest_place(first, last, cubic) is None
        changes = np.abs(last.coefficients - first.coefficients).max(axis=0)
    inner, of_kept = record
    assert (np.abs(of_kept - inner).max(axis=(0, 1)) / changes).max() < 0.05


def test_many_shapes_of_unknowns_without_pairs_count(
    balances: Balances, blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each unknown on which no pair depends adds two shapes: 14 modes and 20 shapes are more than half of 38."""
    few_of(balances, blade, monkeypatch, 14)
    monkeypatch.setattr(soft_structure, "MOST_KEPT", 0.5)
    assert not isinstance(prepared(blade, few_modes=True).stuck, SoftStructure)
    monkeypatch.setattr(soft_structure, "MOST_KEPT", 0.95)
    assert isinstance(prepared(blade, few_modes=True).stuck, SoftStructure)


@pytest.mark.long
@pytest.mark.parametrize("closed", [1.0, -0.01])  # every third pair is pressed together, or has a gap and closes
def test_a_curve_is_that_of_all_modes(blade: Blade, monkeypatch: pytest.MonkeyPatch, closed: float) -> None:
    """Points, added points, energies, outputs (one of them a slip), and verdicts; kept modes are used."""
    preload = blade.pairs.laws[0].normal_load.copy()
    preload[::3] *= closed
    structure, force = replace(blade.superelement, damping=None), (3.0 * blade.force_cos, 3.0 * blade.force_sin)
    outputs = np.vstack([np.eye(structure.size)[0], np.eye(structure.size)[-1]])
    responses, used = [], []

    def observed(*arguments: Any) -> SoftStructure | None:
        used.append(soft_structure.soft_structure(*arguments))
        return used[-1]

    monkeypatch.setattr(setting_up, "soft_structure", observed)
    monkeypatch.setattr(soft_structure, "MOST_KEPT", 2.0)
    monkeypatch.setattr(soft_structure, "KEPT_RANGE", 30.0)
    for rows in (10**9, 1):
        for module in (soft_structure, harmonic_modes, reduced):
            monkeypatch.setattr(module, "LARGE_ROWS", rows)
        responses.append(
            forced_response(
                structure,
                blade.pairs_with(preload),
                *force,
                frequency_hz=blade.window_hz,
                harmonics=3,
                samples=128,
                modal_damping_ratio=0.003,
                outputs=outputs,
                threads=1,
            )
        )
    whole, kept = responses
    assert len(used) == 1  # a joint of few rows has all modes
    assert used[0] is not None
    assert used[0].modes.shape[1] < structure.size
    assert kept.n_points == whole.n_points
    for name in ("maxima_between_points", "search_for_missed_peaks"):
        assert kept.settings[name] == whole.settings[name]
    assert kept.residual.max() < 1e-6
    for name in ("input_energy", "viscous_energy", "kinetic_energy", "dissipated_energy"):
        expected, actual = getattr(whole, name), getattr(kept, name)
        assert actual.max() == pytest.approx(expected.max(), rel=1e-5)
    spent = kept.viscous_energy + kept.dissipated_energy.sum(axis=1)
    np.testing.assert_allclose(kept.input_energy, spent, rtol=0.0, atol=1e-6 * kept.input_energy.max())
    for output in outputs:
        assert kept.amplitude(output).max() == pytest.approx(whole.amplitude(output).max(), rel=1e-5)
    assert kept.stable is not None
    np.testing.assert_array_equal(kept.stable, whole.stable)
