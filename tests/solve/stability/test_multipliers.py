"""Floquet multipliers: exact for linear structures; oscillators of textbooks; what has no multiplier."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from castings import casting_case
from helpers import Blade, benchmark_module
from periods import marched
from sentences import printed_sentence
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.results.response_data import NO_STABILITY
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.stability import disturbances
from stickslip.solve.stability.march import Period
from stickslip.solve.stability.model import stability_model

MASS = np.diag([1.0, 0.6, 1.4])
STIFFNESS = np.array([[3.0, -1.0, 0.0], [-1.0, 2.5, -1.0], [0.0, -1.0, 2.0]])
UNEVEN_DAMPING = np.array([[0.02, -0.01, 0.0], [-0.01, 0.05, 0.01], [0.0, 0.01, 0.03]])
SPRINGS = np.array([1.2, 0.9, 1.5])  # t1, t2, n


def chain_pairs() -> ss.ContactPairs:
    """One pair on the chain, pressed so hard that nothing moves under a small force."""
    return ss.ContactPairs(np.eye(3), SPRINGS[2], SPRINGS[None, :2], 0.5, normal_load=1e3)


def exact_multipliers(stiffness: np.ndarray, damping: np.ndarray, period: float) -> np.ndarray:
    """``exp(lambda T)`` from the state matrix."""
    solved = np.linalg.solve(MASS, np.hstack([-stiffness, -damping]))
    state = np.vstack([np.hstack([np.zeros((3, 3)), np.eye(3)]), solved])
    return np.exp(period * np.linalg.eigvals(state))


def farthest(expected: np.ndarray, actual: np.ndarray) -> float:
    """The largest distance of an expected number from the nearest actual one."""
    return float(np.abs(expected[:, None] - actual).min(axis=1).max())


def steps_of_one_pair(sticks: bool, samples: int = 128) -> LinearSteps:
    """A pair that sticks through the period with a state for its slider, or one that is open through it."""
    keep, by_end = np.zeros((samples, 1, 2, 2)), np.zeros((samples, 1, 2, 3))
    if sticks:
        keep[:] = np.eye(2)
        by_end[:, :, (0, 1), (0, 1)] = SPRINGS[:2]
    return LinearSteps(keep, by_end, -by_end, np.full((samples, 1), SPRINGS[2] * sticks))


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.02 * STIFFNESS, UNEVEN_DAMPING])
def test_a_structure_that_sticks_has_the_multipliers_of_its_modes(damping: np.ndarray) -> None:
    structure = ss.Superelement(MASS, STIFFNESS, damping)
    response = ss.forced_response(structure, chain_pairs(), np.array([1e-3, 0.0, 0.0]), frequency_hz=(0.2, 0.4))
    assert response.multipliers is not None
    for point in (0, -1):
        exact = exact_multipliers(STIFFNESS + np.diag(SPRINGS), damping, 1.0 / response.frequency_hz[point])
        largest = exact[np.argsort(-np.abs(exact))][:4]
        assert farthest(largest, response.multipliers[point]) < 1e-9
        # The slider of a pair that never slips would add a multiplier of 1.
        assert np.abs(response.multipliers[point] - 1.0).min() > 0.01
    assert response.stable is not None
    assert response.stable.all()


@pytest.mark.parametrize("damping", [0.02 * STIFFNESS, UNEVEN_DAMPING])
def test_the_march_itself_is_exact_for_a_linear_structure(damping: np.ndarray) -> None:
    omega = 1.5
    stuck = stuck_structure(ss.Superelement(MASS, STIFFNESS, damping), chain_pairs(), omega, None)
    model = stability_model(stuck, 3, np.ones((1, 3), dtype=bool), np.zeros((1, 3)))
    for sticks, tolerance in ((True, 1e-9), (False, 1e-3)):
        period = Period(model, steps_of_one_pair(sticks), np.array([0]), omega)
        values = np.linalg.eigvals(marched(period, np.eye(period.size)))
        stiffness = STIFFNESS + np.diag(SPRINGS) * sticks
        assert farthest(exact_multipliers(stiffness, damping, 2.0 * np.pi / omega), values) < tolerance


def test_the_error_of_the_march_falls_with_the_square_of_the_step() -> None:
    omega = 1.5
    stuck = stuck_structure(ss.Superelement(MASS, STIFFNESS, UNEVEN_DAMPING), chain_pairs(), omega, None)
    model = stability_model(stuck, 3, np.ones((1, 3), dtype=bool), np.zeros((1, 3)))
    exact, errors = exact_multipliers(STIFFNESS, UNEVEN_DAMPING, 2.0 * np.pi / omega), []
    for samples in (64, 128):
        period = Period(model, steps_of_one_pair(False, samples), np.array([0]), omega)
        errors.append(farthest(exact, np.linalg.eigvals(marched(period, np.eye(period.size)))))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def opened_by_a_light_damper(samples: int) -> float:
    """The largest multiplier of a damper that lifts off for 30 % of each period; when it sticks, its motion relative to
    the structure is 25 times as fast as the excitation."""
    stiffness = 0.05 * 25.0**2
    structure = ss.Superelement(np.diag([1.0, 0.05]), np.diag([1.2, 0.2]))
    operator = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, -1.0]])
    pairs = ss.ContactPairs(operator, stiffness, stiffness, 0.3, normal_load=1.0)
    stuck = stuck_structure(structure, pairs, 1.0, 0.001)
    model = stability_model(stuck, 3, np.ones((1, 3), dtype=bool), np.zeros((1, 3)))
    assert model.modes == 1  # the other coordinate is fast, and modal damping does not reach it
    share = np.arange(samples) / samples
    normal = np.where((share > 0.2) & (share < 0.5), 0.0, stiffness)[:, None]
    by_end = np.zeros((samples, 1, 2, 3))
    by_end[:, :, (0, 1), (0, 1)] = stiffness
    steps = LinearSteps(np.zeros((samples, 1, 2, 2)), by_end, np.zeros((samples, 1, 2, 3)), normal)
    period = Period(model, steps, np.array([0]), 1.0)
    return float(np.abs(np.linalg.eigvals(marched(period, np.eye(period.size)))).max())


def test_fast_coordinates_without_damping_feign_no_loss_of_stability() -> None:
    """Their phase at each contact event decides their size, and no model predicts it. Without the damping the largest
    multiplier here is 1.48 with 256 samples, 1.00 with 512 and 1.34 with 1024."""
    sizes = [opened_by_a_light_damper(samples) for samples in (256, 512, 1024)]
    assert max(sizes) < 0.95
    assert max(sizes) - min(sizes) < 0.01


@pytest.fixture(scope="module")
def duffing() -> ss.ForcedResponse:
    """``x'' + 0.05 x' + x + 0.4 x^3 = 0.25 cos(w t)``."""
    law = ss.CubicSpring(np.array([[1.0, 0.0, 0.0]]), np.array([[0.4, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(np.array([[1.0], [0.0], [0.0]]), [law])
    structure = ss.Superelement(np.eye(1), np.zeros((1, 1)), 0.05 * np.eye(1))
    window = (0.8 / (2.0 * np.pi), 2.6 / (2.0 * np.pi))
    return ss.forced_response(structure, pairs, np.array([0.25]), frequency_hz=window, harmonics=5, samples=64)


@pytest.mark.slow
def test_duffing_is_unstable_exactly_between_its_folds(duffing: ss.ForcedResponse) -> None:
    change = np.diff(duffing.frequency_hz)
    upper, lower = (int(point) + 1 for point in np.flatnonzero(change[1:] * change[:-1] < 0.0))
    assert duffing.stable is not None
    assert duffing.stable[:upper].all()
    assert not duffing.stable[upper + 1 : lower].any()
    assert duffing.stable[lower + 1 :].all()
    assert [each.kind for each in duffing.bifurcations] == ["fold", "fold"]


def test_duffing_folds_where_the_textbook_says(duffing: ss.ForcedResponse) -> None:
    """First approximation, Nayfeh and Mook 1979, sec. 4.1: its two frequencies of each amplitude, extremal at folds."""
    square = np.linspace(0.05, 12.0, 200001)
    # ((1 - w^2 + 3/4 k3 A^2)^2 + c^2 w^2) A^2 = F^2 is quadratic in w^2.
    backbone = 1.0 + 0.75 * 0.4 * square
    half = backbone - 0.5 * 0.05**2
    root = half**2 - backbone**2 + 0.25**2 / square
    upper = np.sqrt(half + np.sqrt(np.maximum(root, 0.0)))[root > 0.0]
    lower = upper.argmin()
    peak = square[root > 0.0][-1]
    top = math.sqrt(1.0 + 0.75 * 0.4 * peak - 0.5 * 0.05**2)
    hertz = [each.frequency_hz for each in duffing.bifurcations]
    assert 2.0 * np.pi * hertz[0] == pytest.approx(top, rel=0.02)
    assert 2.0 * np.pi * hertz[1] == pytest.approx(upper[lower], rel=0.02)


def test_the_product_of_the_multipliers_of_duffing_is_that_of_liouville(duffing: ss.ForcedResponse) -> None:
    assert duffing.multipliers is not None
    product = duffing.multipliers[:, 0] * duffing.multipliers[:, 1]
    np.testing.assert_allclose(product, np.exp(-0.05 / duffing.frequency_hz), rtol=2e-3)


def steady_periods(omega: float, periods: int = 120, steps: int = 200) -> float:
    """Difference of the last two periods of ``x'' + 0.1 x' + x + 4 max(x - 0.05, 0) = cos(w t)`` by Runge and Kutta,
    over the largest displacement."""
    step = 2.0 * math.pi / omega / steps

    def slope(t: float, x: float, v: float) -> tuple[float, float]:
        return v, math.cos(omega * t) - 0.1 * v - x - 4.0 * max(x - 0.05, 0.0)

    x, v, path = 0.3, 0.0, []
    for index in range(periods * steps):
        t = index * step
        a1, b1 = slope(t, x, v)
        a2, b2 = slope(t + 0.5 * step, x + 0.5 * step * a1, v + 0.5 * step * b1)
        a3, b3 = slope(t + 0.5 * step, x + 0.5 * step * a2, v + 0.5 * step * b2)
        a4, b4 = slope(t + step, x + step * a3, v + step * b3)
        x, v = x + step * (a1 + 2 * a2 + 2 * a3 + a4) / 6.0, v + step * (b1 + 2 * b2 + 2 * b3 + b4) / 6.0
        path.append(x)
    last, before = np.array(path[-steps:]), np.array(path[-2 * steps : -steps])
    return float(np.abs(last - before).max() / np.abs(last).max())


@pytest.mark.slow
def test_impacts_double_the_period_around_twice_the_bilinear_frequency() -> None:
    """Shaw and Holmes 1983: an oscillator with a stop loses its period near 2 w_b = 4 w1 w2 / (w1 + w2)."""
    law = ss.ElasticStop(np.array([4.0]), np.array([0.05]))
    pairs = ss.ContactPairs.with_laws(np.array([[0.0], [0.0], [1.0]]), [law])
    structure = ss.Superelement(np.eye(1), np.eye(1), 0.1 * np.eye(1))
    window = (1.8 / (2.0 * np.pi), 4.0 / (2.0 * np.pi))
    response = ss.forced_response(structure, pairs, np.array([1.0]), frequency_hz=window, harmonics=15)
    assert [each.kind for each in response.bifurcations] == ["period doubling", "period doubling"]
    first, last = (2.0 * np.pi * each.frequency_hz for each in response.bifurcations)
    bilinear = 2.0 * math.sqrt(5.0) / (1.0 + math.sqrt(5.0))
    assert first < 2.0 * bilinear < last
    for omega, doubled in ((0.96 * first, False), (1.04 * first, True), (0.96 * last, True), (1.04 * last, False)):
        assert (steady_periods(omega) > 0.05) == doubled, omega
    assert response.multipliers is not None
    assert response.stable is not None
    assert (response.multipliers[~response.stable][:, 0].real < -1.0).all()


@pytest.mark.slow
def test_a_body_on_friction_alone_has_no_multiplier_of_its_drift() -> None:
    operator = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
    omega = 2.0 * np.pi * 100.0
    pairs = ss.ContactPairs(operator, 9.0 * omega**2, 4.0 * omega**2, 0.3, normal_load=100.0)
    structure = ss.Superelement(np.eye(2), np.zeros((2, 2)), 0.5 * np.eye(2))
    response = ss.forced_response(structure, pairs, np.array([60.0, 0.0]), frequency_hz=(90.0, 110.0))
    assert response.moving_pairs.all()
    assert response.multipliers is not None
    assert np.abs(response.multipliers - 1.0).min() > 1e-3
    assert response.stability_message == "All points are stable."


@pytest.mark.long
def test_a_slider_that_touches_its_limit_does_not_follow_a_motion_that_rotates() -> None:
    """Light 1 of the torture set: with the touching slider as one that slips, 8 of these points had multipliers of
    size 1.05, a torus. In time the motion of such a point stays as it is."""
    problem = benchmark_module("torture_problems").make("light", 1)
    response = problem.solve(window_hz=(70.12, 70.08))
    assert response.stability_message == "All points are stable."
    assert response.bifurcations == ()
    touches = (response.contact_state == ss.ContactState.STUCK).all(axis=1) & (
        response.dissipated_energy.sum(axis=1) > 0.0
    )
    point = int(np.flatnonzero(touches)[0])
    start: dict[str, Any] = dict(ss.start_from_response(response, point))
    motion = ss.integrate_to_steady_state(
        problem.superelement(), problem.pairs(), problem.force_cos, problem.force_sin,
        float(response.frequency_hz[point]), steps_per_period=240, max_periods=100, tolerance=1e-12, **start,
    )  # fmt: skip
    changes = motion.period_change[1:]  # the first entry compares with rest
    assert changes.max() < 1.5 * changes[:2].max()  # 1.05^100 is 130


@pytest.mark.slow
def test_a_law_without_steps_gives_a_reason_and_no_verdict() -> None:
    law = ss.IwanJoint(np.array([[100.0, 100.0]]), np.array([[1.0, 1.0]]), np.array([-0.5]), np.array([0.1]))
    pairs = ss.ContactPairs.with_laws(np.array([[1.0], [0.0], [0.0]]), [law])
    structure = ss.Superelement(np.eye(1), 10.0 * np.eye(1), np.eye(1))
    response = ss.forced_response(structure, pairs, np.array([0.1]), frequency_hz=(0.5, 1.0), harmonics=1, samples=32)
    assert response.stable is None
    assert response.multipliers is None
    printed_sentence(response.stability_message, "iwan")


@pytest.mark.slow
def test_stability_is_stored_and_older_files_are_read_without_it(duffing: ss.ForcedResponse, tmp_path: Path) -> None:
    duffing.save(tmp_path / "new.nc")
    again = ss.ForcedResponse.load(tmp_path / "new.nc")
    assert again == duffing
    assert again.bifurcations == duffing.bifurcations
    import h5py

    with h5py.File(tmp_path / "new.nc", "a") as file:
        for name in (
            "stable", "doubtful", "multipliers_real", "multipliers_imaginary", "bifurcations", "stability_message"
        ):  # fmt: skip
            del file[name]
    older = ss.ForcedResponse.load(tmp_path / "new.nc")
    assert older.stable is None
    assert older.doubtful is None
    assert older.multipliers is None
    assert older.bifurcations == ()
    assert older.stability_message == NO_STABILITY


@pytest.mark.long
def test_the_blade_is_unstable_exactly_between_its_folds(blade: Blade) -> None:
    """Pairs that have shaken down and touch their limit follow the disturbance; without them a point seems stable."""
    response = blade.response(frequency_hz=blade.window_hz, harmonics=5, samples=256)
    assert [each.kind for each in response.bifurcations] == ["fold", "fold"]
    assert [each.frequency_hz for each in response.bifurcations] == pytest.approx([686.144, 683.756], abs=0.02)
    upper, lower = (each.position for each in response.bifurcations)
    place = np.arange(response.n_points)
    between = (place > upper + 0.5) & (place < lower - 0.5)
    assert response.stable is not None
    assert response.multipliers is not None
    assert not response.stable[between].any()
    assert response.stable[(place < upper - 0.5) | (place > lower + 0.5)].all()
    assert 1.003 < np.abs(response.multipliers[between, 0]).max() < 1.061


@pytest.mark.long
def test_the_iteration_gives_the_largest_of_all_eigenvalues(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    """Small directions of a block must not enter the basis twice: spurious multipliers of 2 came from that."""
    options = {"frequency_hz": (682.0, 690.0), "harmonics": 3, "samples": 128}
    every = blade.response(**options).multipliers
    monkeypatch.setattr(disturbances, "DENSE_SIZE", 0)
    largest = blade.response(**options).multipliers
    assert every is not None
    assert largest is not None
    np.testing.assert_allclose(np.abs(largest[:, 0]), np.abs(every[:, 0]), atol=3e-3)


@pytest.mark.long
def test_the_two_blade_case_loses_stability_at_its_folds_alone() -> None:
    """Fast coordinates without damping gave false tori beside its peak, with 44 pairs that slip and 66 that separate.
    Time integration stays near the points outside of the folds and leaves those between them."""
    case = casting_case().replace({"solver.frequency_start": "450 Hz", "solver.frequency_stop": "458 Hz"})
    response = ss.solve_case(case, threads=1).response
    assert [each.kind for each in response.bifurcations] == ["fold", "fold"]
    assert [each.frequency_hz for each in response.bifurcations] == pytest.approx([455.16, 452.25], abs=0.05)
    upper, lower = (each.position for each in response.bifurcations)
    place = np.arange(response.n_points)
    assert response.stable is not None
    assert np.array_equal(response.stable, (place < upper) | (place > lower))
    unstable = int((~response.stable).sum())
    # Beside the folds, three points have the verdict of their side against their own multipliers.
    assert response.stability_message.startswith(
        f"{unstable} of {response.n_points} points are unstable. 3 have no sure verdict"
    )
