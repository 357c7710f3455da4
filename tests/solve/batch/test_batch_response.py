"""Curves of a batch against ordinary curves of the same inputs, and the curves that leave it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from batch_inputs import WINDOW_HZ, row_of_masses
from law_makers import cubic
from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.results.batch import BatchCurve, BatchResponse
from stickslip.results.response import ForcedResponse
from stickslip.solve.batch import batch_response as batch_of_curves
from stickslip.solve.batch import curve_results, following
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.setting_up import prepare_balances
from stickslip.solve.solver_input import SolverInput

HARMONICS, SAMPLES = 3, 256
COUPLED = 2.0 * np.array([[4.0, 1.0, 0.0], [1.0, 5.0, 2.0], [0.0, 2.0, 6.0]])
OPTIONS: dict[str, Any] = {"harmonics": HARMONICS, "samples": SAMPLES}


def batch(*inputs: SolverInput, window_hz: tuple[float, float] = WINDOW_HZ, **options: Any) -> BatchResponse:
    return batch_of_curves.batch_response(inputs, frequency_hz=window_hz, **OPTIONS | options)


def ordinary(given: SolverInput, window_hz: tuple[float, float] = WINDOW_HZ, **options: Any) -> ForcedResponse:
    return forced_response(
        given.superelement, given.pairs, given.excitation, frequency_hz=window_hz, checks=False,
        modal_damping_ratio=given.modal_damping_ratio, **OPTIONS | options,
    )  # fmt: skip


def nearest_solutions(given: SolverInput, response: ForcedResponse, curve: BatchCurve) -> list[tuple[int, np.ndarray]]:
    """Points of the curve away from folds, and the outputs there that Newton's method has from the nearest ordinary
    point at the same frequency."""
    omega = 2.0 * np.pi * response.frequency_hz
    balance = prepare_balances(
        given.superelement, given.pairs, given.excitation, omega.max(), HARMONICS, SAMPLES,
        given.modal_damping_ratio, "tractrix", lambda words: None,
    ).with_harmonics(HARMONICS)  # fmt: skip
    problem = FrequencyCurve(balance)
    newton = Newton(problem, NewtonSettings(tolerance=1e-11))
    outputs, width = response.coefficients(given.output), np.ptp(response.frequency_hz)
    solutions = []
    for point in range(0, len(curve.frequency_hz), 5):
        away = np.linalg.norm(outputs - curve.coefficients[point], axis=1) / curve.amplitude.max()
        near = int(np.hypot(away, (response.frequency_hz - curve.frequency_hz[point]) / width).argmin())
        turns = np.diff(response.frequency_hz[max(near - 3, 0) : near + 4])
        if turns.min() < 0.0 < turns.max():
            continue
        guess = np.einsum("mn,nw->wm", balance.pairs.operator, response.displacement[near])
        at = 2.0 * np.pi * float(curve.frequency_hz[point])
        correction = newton.correct(problem.at(guess, at), Plane.fixed(guess, at))
        assert correction.converged
        solutions.append((point, balance.displacement([correction.point.trial])[0] @ given.output))
    return solutions


# Other masses, stiffness, damping and forces, a gap, unbalance, damping that couples the modes, tractions at rest.
DIFFERENT = {
    "slip": row_of_masses(),
    "more slip": row_of_masses(force=40.0, preload=20.0),
    "other structure": row_of_masses(mass=1.2, stiffness=1.3e6, damping_ratio=0.01),
    "gap": row_of_masses(preload=-1.0, force=20.0),
    "unbalance": row_of_masses(excitation=Excitation.unbalance([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.5e-5)),
    "coupled": row_of_masses(damping=COUPLED, damping_ratio=None),
    "kept": row_of_masses(residual_traction=np.array([[6.0, -8.0]])),
}


@pytest.fixture(scope="module")
def different() -> dict[str, BatchCurve]:
    return dict(zip(DIFFERENT, batch(*DIFFERENT.values()).curves, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", DIFFERENT)
def test_each_curve_is_that_of_its_own_structure(name: str, different: dict[str, BatchCurve]) -> None:
    given, curve = DIFFERENT[name], different[name]
    assert curve.converged
    assert not curve.alone
    assert curve.frequency_hz[[0, -1]] == pytest.approx(WINDOW_HZ, rel=1e-14)
    assert (curve.residual < 1e-7).all()
    response = ordinary(given, outputs=given.output)
    solutions = nearest_solutions(given, response, curve)
    assert len(solutions) > 8
    for point, output in solutions:
        assert np.abs(curve.coefficients[point] - output).max() < 1e-8 * np.abs(output).max()
    assert curve.peak_amplitude == pytest.approx(response.amplitude(given.output).max(), rel=2e-3)


@pytest.mark.slow
def test_the_curves_fold_and_have_all_states(different: dict[str, BatchCurve]) -> None:
    states = np.concatenate([curve.contact_state.ravel() for curve in different.values()])
    assert set(states) == set(ContactState)
    assert np.diff(different["gap"].frequency_hz).min() < 0.0  # it hardens where it closes


@pytest.mark.slow
def test_three_pairs_of_a_row() -> None:
    inputs = [row_of_masses(3, force=force, preload=30.0) for force in (10.0, 20.0)]
    for given, curve in zip(inputs, batch(*inputs).curves, strict=True):
        for point, output in nearest_solutions(given, ordinary(given), curve):
            assert np.abs(curve.coefficients[point] - output).max() < 1e-8 * np.abs(output).max()


@pytest.mark.slow
def test_a_peak_is_exact() -> None:
    """Against the highest of 400 solutions around it. The ripple of 512 samples is below 1e-5."""
    given = row_of_masses()
    curve = batch(given, samples=512).curves[0]
    beside = (curve.peak_frequency_hz - 0.8, curve.peak_frequency_hz + 0.8)
    steps = ContinuationSettings(largest_step=0.01, first_step=0.01)
    response = ordinary(given, beside, samples=512, continuation=steps)
    assert response.n_points > 90
    assert curve.peak_amplitude == pytest.approx(response.amplitude(given.output).max(), rel=1e-4)
    assert curve.amplitude.max() == curve.peak_amplitude


@pytest.mark.slow
def test_a_curve_does_not_depend_on_its_neighbours() -> None:
    inputs = [
        row_of_masses(force=force, preload=preload) for force, preload in ((10.0, 60.0), (25.0, 30.0), (5.0, 90.0))
    ]
    together = batch(*inputs).curves
    for given, curve in zip(inputs, together, strict=True):
        (alone,) = batch(given).curves
        for name in ("frequency_hz", "amplitude", "residual"):
            np.testing.assert_allclose(getattr(alone, name), getattr(curve, name), rtol=1e-10, atol=1e-10)
        np.testing.assert_array_equal(alone.contact_state, curve.contact_state)


@pytest.mark.slow
def test_no_step_crosses_a_sharp_resonance() -> None:
    """Stuck pairs with a damping ratio of 1e-5: a linear resonance of 4 mHz, of height F / (2 zeta k)."""
    given = row_of_masses(force=1e-3, preload=60.0, damping_ratio=1e-5)
    curve = batch(given).curves[0]
    assert not curve.contact_state.any()
    assert curve.peak_amplitude == pytest.approx(1e-3 / (2e-5 * 1.5e6), rel=1e-4)
    assert curve.peak_frequency_hz == pytest.approx(np.sqrt(1.5e6) / (2.0 * np.pi), rel=1e-6)


@pytest.mark.slow
def test_a_curve_that_the_batch_loses_is_solved_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    given = row_of_masses()
    monkeypatch.setattr(following, "MOST_POINTS", 20)
    result = batch(given)
    (curve,) = result.curves
    assert "20 points were not enough" in curve.alone
    assert curve.converged
    response = ordinary(given, outputs=given.output)
    np.testing.assert_allclose(curve.amplitude, response.amplitude(given.output), rtol=1e-12)
    np.testing.assert_array_equal(curve.residual, response.residual)
    assert curve.peak_amplitude == pytest.approx(curve.amplitude.max(), rel=2e-3)
    assert repr(result) == "BatchResponse(1 curves, 1 solved alone, 0 not complete)"


@pytest.mark.slow
def test_a_curve_without_a_first_point_has_no_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*given: Any, **options: Any) -> ForcedResponse:
        raise ConvergenceError("no solution at the first frequency")

    monkeypatch.setattr(following, "MOST_POINTS", 20)
    monkeypatch.setattr(curve_results, "unreported_response", fail)
    (curve,) = batch(row_of_masses()).curves
    assert not curve.converged
    assert curve.frequency_hz.size == 0
    assert np.isnan(curve.peak_amplitude)
    assert "no solution" in curve.message


@pytest.mark.slow
def test_a_body_that_slides_on_is_solved_alone() -> None:
    """Friction alone supports the mass along t1; its mean is that of many cycles, which is no position."""
    given = row_of_masses(damping_ratio=0.01)
    floating = replace(given, superelement=replace(given.superelement, stiffness=np.diag([0.0, 2e6, 4e6])))
    (curve,) = batch(floating, window_hz=(60.0, 200.0), samples=64).curves
    assert "slides on from cycle to cycle" in curve.alone
    response = ordinary(floating, (60.0, 200.0), samples=64)
    assert curve.peak_amplitude == pytest.approx(response.amplitude(given.output).max(), rel=1e-12)


@pytest.mark.slow
def test_a_sweep_downward_has_the_same_peak() -> None:
    given = row_of_masses(3, force=20.0, preload=30.0)
    upward, downward = (batch(given, window_hz=window).curves[0] for window in (WINDOW_HZ, WINDOW_HZ[::-1]))
    assert downward.frequency_hz[[0, -1]] == pytest.approx(WINDOW_HZ[::-1], rel=1e-14)
    assert downward.peak_amplitude == pytest.approx(upward.peak_amplitude, rel=1e-4)


@pytest.mark.slow
def test_damping_that_couples_many_modes_is_solved_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch_of_curves, "MOST_COUPLED_MODES", 2)
    coupled, diagonal = batch(row_of_masses(damping=COUPLED, damping_ratio=None), row_of_masses()).curves
    assert "Damping couples" in coupled.alone
    assert not diagonal.alone


def elastic(given: SolverInput) -> SolverInput:
    return replace(given, pairs=ContactPairs.with_laws(np.eye(3), [cubic(np.full((1, 3), 1e6), np.ones((1, 3)))]))


def whirling(given: SolverInput) -> SolverInput:
    turn = np.zeros((3, 3))
    turn[0, 1], turn[1, 0] = 1.0, -1.0
    return replace(given, superelement=replace(given.superelement, gyroscopic=turn))


@pytest.mark.parametrize(
    "change",
    [
        lambda given: row_of_masses(2),
        elastic,
        whirling,
        lambda given: replace(given, output=np.ones(2)),
        lambda given: replace(given, structure=object()),
    ],
    ids=["sizes", "law", "gyroscopic", "output", "structure"],
)
def test_inputs_that_a_batch_cannot_contain(change: Callable[[SolverInput], SolverInput]) -> None:
    given = row_of_masses()
    with rejects(InputError, "inputs"):
        batch(given, change(given))


def test_an_empty_batch() -> None:
    with rejects(InputError, "inputs"):
        batch()
