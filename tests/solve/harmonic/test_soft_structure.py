"""A large joint in its soft modes: the same structure, limits and curve as with the full spectrum."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers import Blade
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve import setting_up
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic import harmonic_modes, large_newton, reduced, soft_structure
from stickslip.solve.harmonic.kept_modes import KeptCompliance
from stickslip.solve.harmonic.large_newton import LargeNewtonCompliance, MeanDifference
from stickslip.solve.harmonic.soft_structure import SoftStructure
from stickslip.solve.setting_up import Balances, prepare_balances

HARMONICS = 3
RATIO = 1e-3
RNG = np.random.default_rng(4)


def balances_of(blade: Blade, few_modes: bool, ratio: float | None = RATIO, retained: bool = False) -> Balances:
    force = Excitation.force(blade.force_cos, blade.force_sin)
    highest = 2.0 * np.pi * max(blade.window_hz)
    structure = replace(blade.superelement, damping=None)
    pairs = blade.pairs.retaining() if retained else blade.pairs
    return prepare_balances(
        structure, pairs, force, highest, HARMONICS, 128, ratio, "tractrix", lambda _: None, few_modes=few_modes
    )


RANGE = 30.0  # of soft modes in these tests, over the highest excitation


def small_limits(monkeypatch: pytest.MonkeyPatch, of_first: float, large: bool = True) -> None:
    """Soft modes of small joints too, up to a multiple of the highest excitation."""
    for module in (soft_structure, harmonic_modes, reduced) if large else (soft_structure,):
        monkeypatch.setattr(module, "LARGE_ROWS", 1)
    monkeypatch.setattr(soft_structure, "MOST_KEPT", 10.0)
    monkeypatch.setattr(soft_structure, "KEPT_RANGE", of_first)


def soft_and_full(
    blade: Blade, monkeypatch: pytest.MonkeyPatch, multiple: float = RANGE, retained: bool = False
) -> tuple[Balances, Balances]:
    full = balances_of(blade, few_modes=False, retained=retained)
    small_limits(monkeypatch, multiple)
    soft = balances_of(blade, few_modes=True, retained=retained)
    assert isinstance(soft.stuck, SoftStructure)
    assert not isinstance(full.stuck, SoftStructure)
    return soft, full


def relative_error(found: FloatArray, expected: FloatArray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("retained", [False, True])
def test_soft_modes_and_static_compliance_are_those_of_the_full_spectrum(
    blade: Blade, monkeypatch: pytest.MonkeyPatch, retained: bool
) -> None:
    soft, full = soft_and_full(blade, monkeypatch, retained=retained)
    stuck = soft.stuck
    assert isinstance(stuck, SoftStructure)
    assert stuck.has_same_mean == retained
    limit = RANGE * stuck.highest_omega
    count = int((full.stuck.circular_frequency <= limit).sum())
    assert 2 < count < stuck.circular_frequency.size < full.stuck.circular_frequency.size
    np.testing.assert_allclose(stuck.circular_frequency[:count], full.stuck.circular_frequency[:count], rtol=1e-9)
    assert (stuck.circular_frequency[count:] > limit).all()  # added shapes are no soft modes
    overlap = np.abs(stuck.modes.T @ stuck.mass @ stuck.modes)
    np.testing.assert_allclose(overlap, np.eye(len(overlap)), atol=1e-9)
    np.testing.assert_array_equal(stuck.modal_damping[count:], 0.0)
    np.testing.assert_allclose(stuck.damping, full.stuck.damping, atol=1e-9 * np.abs(full.stuck.damping).max())
    rows, exact = (each.contact_modes / each.circular_frequency for each in (stuck, full.stuck))
    assert relative_error(stuck.rest + rows @ rows.T, exact @ exact.T) < 1e-7


@pytest.mark.parametrize("retained", [False, True])
@pytest.mark.parametrize("few", [False, True])
def test_only_the_inertia_of_far_modes_is_neglected(
    blade: Blade, monkeypatch: pytest.MonkeyPatch, retained: bool, few: bool
) -> None:
    """For deviations on all rows or on few, with the mean of the harmonics or another one."""
    soft, full = soft_and_full(blade, monkeypatch, retained=retained)
    omega = soft.stuck.highest_omega
    first_other = RANGE * omega
    balances = [each.with_harmonics(HARMONICS) for each in (soft, full)]
    assert isinstance(balances[0].compliance, KeptCompliance)
    deviation = RNG.standard_normal((2 * HARMONICS + 1, balances[0].rows))
    if few:
        deviation[:, 6:] = 0.0
    answers, motions = [], []
    for balance in balances:
        external = balance.external_force(omega, 1.0)
        amplitude = balance.compliance.amplitude(omega, external, deviation)
        answers.append(balance.compliance.relative(amplitude, deviation))
        motions.append(balance.compliance.displacement(amplitude, deviation))
    assert relative_error(answers[0][0], answers[1][0]) < 1e-7
    assert relative_error(balances[0].compliance.mean_relative(deviation[0]), -answers[1][0]) < 1e-7
    far = full.stuck.contact_modes[:, full.stuck.circular_frequency > first_other]
    static = np.linalg.norm(far / full.stuck.circular_frequency[full.stuck.circular_frequency > first_other], 2) ** 2
    for order in range(1, HARMONICS + 1):
        rows, ratio = slice(2 * order - 1, 2 * order + 1), (order * omega / first_other) ** 2
        allowed = 1.01 * ratio / (1.0 - ratio) * static * float(np.linalg.norm(deviation[rows]))
        round_off = 1e-7 * float(np.linalg.norm(answers[1]))
        assert np.linalg.norm(answers[0][rows] - answers[1][rows]) <= allowed + round_off
    # the displacements contain what the modes lack: their relative displacements are those of the balance
    np.testing.assert_allclose(
        motions[0] @ soft.pairs.operator.T, answers[0], rtol=0, atol=1e-7 * np.abs(answers[0]).max()
    )
    assert relative_error(motions[0], motions[1]) < (HARMONICS * omega / first_other) ** 2


@pytest.mark.parametrize("many", [0.0, 1.0])  # products of all rows, or sums of those of the columns
@pytest.mark.parametrize("retained", [False, True])
def test_newtons_matrix_has_the_compliance_of_the_full_spectrum(
    blade: Blade, monkeypatch: pytest.MonkeyPatch, retained: bool, many: float
) -> None:
    """The mean exactly, vibrations but for the inertia of the far modes. A mean of the kept modes has their arrays."""
    soft, full = soft_and_full(blade, monkeypatch, retained=retained)
    monkeypatch.setattr(large_newton, "MANY_COLUMNS", many)
    columns, rows, omega = np.arange(3, 14), np.array([0, 4, 9]), soft.stuck.highest_omega
    few: Any = soft.with_harmonics(HARMONICS).compliance.newton(omega, columns)
    assert isinstance(few, LargeNewtonCompliance)
    if retained:
        assert isinstance(few.mean_part, MeanDifference)
        assert few.mean_part.shapes is few.left
    exact: Any = full.exact(HARMONICS, 128).compliance.newton(omega, columns)
    deviation = RNG.standard_normal((2 * HARMONICS + 1, columns.size))
    weights = RNG.standard_normal((2 * HARMONICS + 1, 3 * blade.pairs.n_pairs))
    for found, expected in (
        (few.apply(deviation), exact.apply(deviation)),
        (few.apply_at(deviation, rows), exact.apply(deviation)[:, rows]),
        (few.apply_transposed(weights), exact.apply_transposed(weights)),
    ):
        assert relative_error(found[0], expected[0]) < 1e-6
        assert relative_error(found[1:], expected[1:]) < 2.0 * (HARMONICS / RANGE) ** 2


def test_the_structure_without_contact_has_its_soft_modes_and_its_response(
    blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(soft_structure, "FREE_RANGE", 30.0)
    soft, full = soft_and_full(blade, monkeypatch)
    limit = 30.0 * soft.stuck.highest_omega / (2.0 * np.pi)
    count = int((full.free.natural_hz <= limit).sum())
    assert count < soft.free.natural_hz.size < full.free.natural_hz.size
    scale = float(full.free.natural_hz[count - 1])
    np.testing.assert_allclose(soft.free.natural_hz[:count], full.free.natural_hz[:count], rtol=1e-8, atol=1e-9 * scale)
    np.testing.assert_array_equal(soft.free.rigid[:count], full.free.rigid[:count])
    omega = 2.0 * np.pi * np.linspace(*blade.window_hz, 7)
    for limits in ((soft.free, full.free), (soft.closed, full.closed)):
        responses = [each.response_to(omega, soft.force) for each in limits]
        assert relative_error(*responses) < 1e-5
        around = (1.0, 10.0 * max(blade.window_hz))
        assert limits[0].damping_ratio(around) == pytest.approx(limits[1].damping_ratio(around), rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("large", [False, True])
def test_the_curve_is_that_of_the_full_spectrum(blade: Blade, monkeypatch: pytest.MonkeyPatch, large: bool) -> None:
    """With checks too: multipliers require all modes, which are then computed."""
    structure, used = replace(blade.superelement, damping=None), []
    original = soft_structure.soft_structure

    def noted(*args: object) -> SoftStructure | None:
        used.append(original(*args))  # type: ignore[arg-type]
        return used[-1]

    def curve(checks: bool) -> tuple[FloatArray, FloatArray, float]:
        response = forced_response(
            structure, blade.pairs, Excitation.force(blade.force_cos, blade.force_sin), frequency_hz=blade.window_hz,
            harmonics=HARMONICS, samples=128, modal_damping_ratio=RATIO, checks=checks, outputs=blade.tip,
        )  # fmt: skip
        assert response.converged
        assert (response.stable is not None) == checks
        return response.frequency_hz, response.amplitude(blade.tip), float(response.residual.max())

    hertz, expected, _ = curve(checks=False)
    small_limits(monkeypatch, 200.0, large)
    monkeypatch.setattr(setting_up, "soft_structure", noted)
    found_hertz, found, residual = curve(checks=True)
    assert used[0] is not None
    peak, found_peak = int(expected.argmax()), int(found.argmax())
    assert found[found_peak] == pytest.approx(expected[peak], rel=1e-3)
    assert found_hertz[found_peak] == pytest.approx(hertz[peak], rel=1e-3)
    assert residual < 1e-4


@pytest.mark.slow
def test_beyond_a_number_of_unknowns_a_sentence_says_what_is_left_out(
    blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The curve has its other checks; a band is rejected before the curve."""
    small_limits(monkeypatch, 200.0, True)
    monkeypatch.setattr(setting_up, "MOST_UNKNOWNS", blade.superelement.size - 1)
    structure, force = replace(blade.superelement, damping=None), Excitation.force(blade.force_cos, blade.force_sin)
    options: dict[str, Any] = {"frequency_hz": blade.window_hz, "harmonics": HARMONICS, "modal_damping_ratio": RATIO}
    response = forced_response(structure, blade.pairs, force, samples=128, **options)
    assert response.converged
    assert response.stable is None
    assert response.stability_message.startswith("Stability was not computed: multipliers require all modes")
    assert response.settings["search_for_missed_peaks"]
    with rejects(InputError, "traction_band"):
        forced_response(structure, blade.pairs, force, samples=128, traction_band=blade.tip, **options)


def test_damping_matrices_small_joints_and_many_soft_modes_have_all_modes(
    blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not isinstance(balances_of(blade, few_modes=True).stuck, SoftStructure)
    small_limits(monkeypatch, 1e9)
    monkeypatch.setattr(soft_structure, "MOST_KEPT", 0.5)
    assert not isinstance(balances_of(blade, few_modes=True).stuck, SoftStructure)
    small_limits(monkeypatch, 30.0)
    size, pairs = blade.superelement.size, blade.pairs
    damped = replace(blade.superelement, damping=np.eye(size))
    assert soft_structure.soft_static(damped, pairs) is None
    soft = balances_of(blade, few_modes=True)
    assert isinstance(soft.stuck, SoftStructure)
    assert not isinstance(soft.of_structure().stuck, SoftStructure)


def test_a_stiffness_with_a_negative_eigenvalue_is_rejected(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    """The springs of the contact may hide it in the stuck structure."""
    small_limits(monkeypatch, 30.0)
    force = Excitation.force(blade.force_cos, blade.force_sin).on(blade.superelement, HARMONICS)
    wrong = replace(
        blade.superelement, damping=None, stiffness=blade.superelement.stiffness - 1e9 * blade.superelement.mass
    )
    with rejects(InputError):
        soft_structure.soft_free_limit(wrong, force, 2.0 * np.pi * max(blade.window_hz), 1000)
