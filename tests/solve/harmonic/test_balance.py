"""The reduced Newton system is exact: its step solves the linearised full balance, whatever moves."""

from __future__ import annotations

import weakref

import numpy as np
import pytest

from helpers import Blade
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.fourier import with_rows
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic import reduced
from stickslip.solve.harmonic.balance import ActiveRows, Balance, Trial
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.factors import Factor, LastFactor, iterated
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem, Row
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import NO_PARAMETERS, Plane
from stickslip.structure.superelement import Superelement

HARMONICS, SAMPLES = 3, 128
HIGHEST_OMEGA = 2 * np.pi * 1100.0


def balance_of(blade: Blade, load: float = 1.0, harmonics: int = HARMONICS) -> Balance:
    force = np.zeros((2 * harmonics + 1, blade.superelement.size))
    force[1], force[2] = load * blade.force_cos, load * blade.force_sin
    stuck = stuck_structure(blade.superelement, blade.pairs, HIGHEST_OMEGA, None)
    return Balance(stuck.compliance(harmonics), blade.pairs, ExcitationForce(((0, force),)), SAMPLES)


def moving_trial(blade: Blade, share: float) -> tuple[Balance, Trial]:
    """A trial away from the solution: a share of the linear stuck response near its resonance."""
    balance = balance_of(blade)
    omega = 2 * np.pi * 690.0
    generator = np.random.default_rng(3)
    relative = share * balance.linear(omega)
    relative += 0.02 * np.abs(relative).max() * generator.normal(size=relative.shape)
    return balance, balance.evaluate(relative, omega)


@pytest.mark.parametrize("share", [0.05, 0.2, 0.6])
@pytest.mark.parametrize("way", ["factor", "iteration", "iteration that fails"])
def test_step_solves_the_full_linearised_balance(
    blade: Blade, share: float, way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if way != "factor":
        monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    if way == "iteration that fails":
        monkeypatch.setattr(reduced.BorderedSystem, "_iterated", lambda system, right, tolerance: None)
    balance, trial = moving_trial(blade, share)
    generator = np.random.default_rng(5)
    weights = generator.normal(size=trial.relative.shape)
    scale = trial.omega
    plane = Plane(weights / np.abs(trial.relative).max(), 1.0 / scale, trial.relative, scale)
    curve = FrequencyCurve(balance)
    system = curve.linearised(curve.at(trial.relative, scale), plane)
    solved = system.solve(trial.residual, NO_PARAMETERS, -0.3, 1e-9)
    step, change = solved.unknowns, float(solved.parameters[0])
    # Directional derivative of the full residual along the step, by central differences.
    small = 1e-6
    forward, backward = (
        balance.evaluate(trial.relative + sign * small * step, scale + sign * small * change).residual
        for sign in (1.0, -1.0)
    )
    derivative = (forward - backward) / (2 * small)
    assert np.linalg.norm(derivative + trial.residual) < 2e-5 * np.linalg.norm(trial.residual)
    assert (plane.weights * step).sum() + plane.parameter_weight * change == pytest.approx(0.3, rel=1e-9)


def test_a_factor_helps_with_the_next_systems(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the plain iteration fails, one system of a curve is factored, and not one in each step."""
    exact = {}
    for share in (0.6, 0.61, 0.9):
        balance, trial = moving_trial(blade, share)
        system = NewtonSystem(balance, trial)
        slope = balance.frequency_slope(trial)
        exact[share] = BorderedSystem(system, [slope], [Row(np.ones(1))]).solve(trial.residual, np.zeros(1), 1e-9)
    monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    monkeypatch.setattr(reduced, "MAX_ITERATIONS", 1)
    monkeypatch.setattr(reduced, "TRIAL_ITERATIONS", 1)
    factored = [0]

    class Counted(Factor):
        def __init__(self, matrix: np.ndarray) -> None:
            factored[0] += 1
            super().__init__(matrix)

    monkeypatch.setattr(reduced, "Factor", Counted)
    last = LastFactor()
    # The last trial has other moving pairs, so other rows.
    for share, factors in ((0.6, 1), (0.61, 1), (0.9, 1)):
        balance, trial = moving_trial(blade, share)
        system = NewtonSystem(balance, trial)
        bordered = BorderedSystem(system, [balance.frequency_slope(trial)], [Row(np.ones(1))], last)
        step = bordered.solve(trial.residual, np.zeros(1), 1e-9)
        assert factored[0] == factors, share
        assert np.linalg.norm(step.unknowns - exact[share].unknowns) < 1e-6 * np.linalg.norm(exact[share].unknowns)
    monkeypatch.setattr(reduced, "PRECONDITIONED_ITERATIONS", 1)
    bordered = BorderedSystem(system, [balance.frequency_slope(trial)], [Row(np.ones(1))], LastFactor())
    bordered.solve(trial.residual, np.zeros(1), 1e-9)
    assert factored[0] == 2  # without a factor


def test_a_curve_has_one_large_factor_at_a_time(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    """Systems of steps that wait for another attempt have none, and still solve."""
    monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    monkeypatch.setattr(reduced, "MAX_ITERATIONS", 1)
    monkeypatch.setattr(reduced, "TRIAL_ITERATIONS", 1)
    alive: weakref.WeakSet[Factor] = weakref.WeakSet()
    before: list[int] = []

    class Known(Factor):
        def __init__(self, matrix: np.ndarray) -> None:
            before.append(len(alive))
            super().__init__(matrix)
            alive.add(self)

    monkeypatch.setattr(reduced, "Factor", Known)
    last, systems, steps = LastFactor(), [], []
    for share in (0.6, 0.9):
        balance, trial = moving_trial(blade, share)
        slope = balance.frequency_slope(trial)
        systems.append((BorderedSystem(NewtonSystem(balance, trial), [slope], [Row(np.ones(1))], last), trial))
        monkeypatch.setattr(reduced, "PRECONDITIONED_ITERATIONS", 1)
        steps.append(systems[-1][0].solve(trial.residual, np.zeros(1), 1e-9).unknowns)
    assert before == [0, 0]  # each is released before the next matrix takes as much memory
    assert len(alive) == 1
    monkeypatch.setattr(reduced, "PRECONDITIONED_ITERATIONS", 60)
    system, trial = systems[0]
    again = system.solve(trial.residual, np.zeros(1), 1e-9).unknowns
    assert np.linalg.norm(again - steps[0]) < 1e-6 * np.linalg.norm(steps[0])


def test_a_factor_helps_with_systems_of_more_harmonics(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows in common have the same number, so that the factor of few harmonics and the border fit more of them."""
    few, trial = moving_trial(blade, 0.6)
    more = balance_of(blade, harmonics=5)
    wide = more.evaluate(with_rows(trial.relative, 11), trial.omega)

    def bordered(balance: Balance, trial: Trial, last: LastFactor | None) -> BorderedSystem:
        slope = balance.frequency_slope(trial)
        return BorderedSystem(NewtonSystem(balance, trial), [slope], [Row(np.ones(1), relative=slope)], last)

    exact = bordered(more, wide, None).solve(wide.residual, np.ones(1), 1e-9)
    monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    monkeypatch.setattr(reduced, "MAX_ITERATIONS", 1)
    monkeypatch.setattr(reduced, "TRIAL_ITERATIONS", 1)
    last = LastFactor()
    bordered(few, trial, last).solve(trial.residual, np.ones(1), 1e-9)
    monkeypatch.setattr(reduced, "Factor", lambda matrix: pytest.fail("a second factor"))
    step = bordered(more, wide, last).solve(wide.residual, np.ones(1), 1e-9)
    assert np.linalg.norm(step.unknowns - exact.unknowns) < 1e-6 * np.linalg.norm(exact.unknowns)


@pytest.mark.parametrize(("coefficients", "count"), [(1, 3), (4, 2), (6, 1)])
def test_blocks_are_those_of_the_whole_matrix(
    blade: Blade, coefficients: int, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = NewtonSystem(*moving_trial(blade, 0.6))
    outputs = system.active.outputs.size
    monkeypatch.setattr(reduced, "BLOCK_ROWS", coefficients * outputs)
    whole, blocks = system.matrix(), system.blocks()
    assert [each.start for each in blocks[1:]] == [each.stop for each in blocks[:-1]]
    assert (blocks[0].start, blocks[-1].stop) == (0, 2 * HARMONICS + 1)
    assert len(blocks) == count
    for each in blocks:
        inside = slice(each.start * outputs, each.stop * outputs)
        np.testing.assert_allclose(system.matrix(columns=each), whole[inside, inside], rtol=0, atol=1e-12)


def test_blocks_precondition_what_the_iteration_alone_does_not_solve(
    blade: Blade, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The iteration without an inverse, which here would converge, is made to fail."""
    balance, trial = moving_trial(blade, 0.9)
    slope = balance.frequency_slope(trial)

    def solved(last: LastFactor | None = None) -> np.ndarray:
        row = Row(np.ones(1), relative=slope)
        system = BorderedSystem(NewtonSystem(balance, trial), [slope], [row], last)
        return np.asarray(system.solve(trial.residual, np.ones(1), 1e-9).unknowns)

    exact = solved()
    monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    monkeypatch.setattr(reduced, "BLOCK_ROWS", 1)
    monkeypatch.setattr(reduced, "iterated", lambda *given: iterated(*given) if len(given) == 5 else None)
    monkeypatch.setattr(BorderedSystem, "_whole_factor", lambda system: pytest.fail("the whole matrix"))
    last = LastFactor()
    assert np.linalg.norm(solved(last) - exact) < 1e-6 * np.linalg.norm(exact)
    monkeypatch.setattr(reduced, "BlockFactor", lambda blocks: pytest.fail("a second factor"))
    assert np.linalg.norm(solved(last) - exact) < 1e-6 * np.linalg.norm(exact)


def test_a_matrix_that_is_too_large_to_be_factored_gives_no_step(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    balance, trial = moving_trial(blade, 0.6)
    for name, value in (("DIRECT_SIZE", -1), ("MAX_ITERATIONS", 1), ("MOST_ROWS", 10)):
        monkeypatch.setattr(reduced, name, value)
    system = BorderedSystem(NewtonSystem(balance, trial), [balance.frequency_slope(trial)], [Row(np.ones(1))])
    assert not np.isfinite(system.solve(trial.residual, np.zeros(1), 1e-9).unknowns).any()


def test_active_rows_contain_only_moving_pairs(blade: Blade) -> None:
    _, trial = moving_trial(blade, 0.6)
    active = ActiveRows.of(trial.contact)
    moving = np.flatnonzero(trial.contact.moves.any(axis=1))
    separating = int((trial.contact.state == 2).sum())
    assert moving.size > 0
    assert active.outputs.size == 2 * moving.size + separating
    still = np.setdiff1d(np.arange(blade.n_pairs), moving)
    assert not trial.deviation.reshape(-1, blade.n_pairs, 3)[:, still].any()


def test_newton_converges_quadratically_near_the_solution(blade: Blade) -> None:
    balance = balance_of(blade, 0.5)
    omega = 2 * np.pi * 700.0
    guess = balance.linear(omega, 0.5)
    errors = []
    curve = FrequencyCurve(balance)
    point = curve.at(guess, omega)
    for _ in range(14):
        errors.append(point.error)
        if point.error < 1e-11:
            break
        newton = Newton(curve, NewtonSettings(1e-12, 1))
        point = newton.correct(point, Plane.fixed(point.unknowns, omega)).point
    assert errors[-1] < 1e-11
    last = [e for e in errors if e < 1e-2]
    assert len(last) <= 4, f"errors {errors}"


def test_stuck_trial_is_the_linear_response(blade: Blade) -> None:
    balance = balance_of(blade, 1e-3)
    omega = 2 * np.pi * 690.0
    trial = balance.evaluate(balance.linear(omega), omega)
    assert not trial.contact.moves.any()
    assert trial.error == 0.0


@pytest.mark.filterwarnings("error")
def test_a_loose_body_with_all_pairs_open_ends_newton_without_a_number() -> None:
    """Nothing holds its mean position then: the Newton matrix is singular, and the correction says that it failed."""
    pairs = ContactPairs(np.eye(3), 1e6, 8e5, 0.3, 10.0)
    stuck = stuck_structure(Superelement(np.eye(3), np.zeros((3, 3))), pairs, 100.0, 0.01)
    force = np.zeros((3, 3))
    force[1, 2] = 1.0
    balance = Balance(stuck.compliance(1), pairs, ExcitationForce(((0, force),)), 64)
    away = np.zeros((3, 3))
    away[0, 2] = -1.0
    curve = FrequencyCurve(balance)
    start = curve.at(away, 50.0)
    assert (start.trial.contact.state == 2).all()
    correction = Newton(curve, NewtonSettings()).correct(start, Plane.fixed(away, 50.0))
    assert not correction.converged


def test_mean_tangential_displacements_follow(blade: Blade) -> None:
    """No force depends on them, so a trial takes those of its forces and has no residual there."""
    balance, trial = moving_trial(blade, 0.4)
    shifted = trial.relative.copy()
    shifted[0].reshape(-1, 3)[:, :2] += 1.0
    again = balance.evaluate(shifted, trial.omega)
    # The force comes from K (s - mean s): the shift is gone up to the round-off of its size.
    assert np.abs(again.relative - trial.relative).max() < 1e-9 * np.abs(trial.relative).max()
    assert again.error == pytest.approx(trial.error, rel=1e-6)
    assert not again.residual[0].reshape(-1, 3)[:, :2].any()


def test_steps_that_do_not_pay_are_solved_more_sharply() -> None:
    newton = Newton.__new__(Newton)
    newton.settings = NewtonSettings(1e-9)
    assert newton._step_tolerance(1e-2, 1.0) == 1e-3
    assert newton._step_tolerance(1e-2, 1e-3) == 1e-6
    assert newton._step_tolerance(1e-6, 1.0) == pytest.approx(1e-4)
    assert newton._step_tolerance(1e-2, 1e-9) == 1e-8
