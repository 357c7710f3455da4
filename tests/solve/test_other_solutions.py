"""The search for other solutions: the subharmonic motion of Duffing's oscillator, and problems without any."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import benchmark_module
from sentences import printed_sentence, rejects

# m = k = 1, f = x + CUBIC x^3, force FORCE cos(3 w t): the motion with the frequency w is isolated from the curve.
CUBIC, FORCE, DAMPING = 0.05, 12.0, 0.04
OUTPUT = [1.0]
BLADE = benchmark_module("blade_problem")


def duffing(force: float, damping: float = DAMPING) -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation]:
    structure = ss.Superelement(np.eye(1), 0.5 * np.eye(1), damping * np.eye(1))
    spring = ss.CubicSpring(np.array([[0.5, 0.0, 0.0]]), np.array([[CUBIC, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(np.array([[1.0], [0.0], [0.0]]), [spring])
    return structure, pairs, ss.Excitation.force(np.array([[0.0, 0.0, force]]))


def searched(
    force: float, window: tuple[float, float], damping: float = DAMPING, **options: Any
) -> tuple[ss.ForcedResponse, ss.OtherSolutions]:
    """The curve over w from ``window`` in rad/s, and the search beside it."""
    problem = duffing(force, damping)
    frequency_hz = (window[0] / (2 * np.pi), window[1] / (2 * np.pi))
    response = ss.forced_response(*problem, frequency_hz=frequency_hz, harmonics=3, samples=64)
    result = ss.search_other_solutions(*problem, response, **options)
    assert result.other_solutions is not None
    return result, result.other_solutions


def subharmonic(omega: float, damping: float = DAMPING) -> float:
    """Amplitude of the larger subharmonic motion of order 1/3 under ``FORCE cos(3 w t)``, NaN where there is none.

    A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations (1979), sec. 4.1.4, first order:
    ``9 mu^2 + (s - 9 a L^2 - 9 a A^2 / 8)^2 = 81 a^2 L^2 A^2 / 16``, ``L = F / (2 (1 - (3 w)^2))``, ``s = 3 w - 3``.
    """
    forced = FORCE / (2.0 * (1.0 - (3.0 * omega) ** 2))
    detuning, mu = 3.0 * omega - 3.0, 0.5 * damping
    p = 8.0 * detuning / (9.0 * CUBIC) - 6.0 * forced**2
    q = 64.0 / (81.0 * CUBIC**2) * (9.0 * mu**2 + (detuning - 9.0 * CUBIC * forced**2) ** 2)
    return float(np.sqrt(p + np.sqrt(p**2 - q))) if p > 0.0 and p**2 >= q else float("nan")


@pytest.mark.long
def test_the_subharmonic_motion_is_found_and_followed_and_is_that_of_the_textbook() -> None:
    response, other = searched(FORCE, (1.02, 2.5), starts=4, seed=0)
    assert response.harmonic_amplitude(OUTPUT, 1).max() < 1e-9, "the curve itself has the period of the force"
    assert other.n_curves == 1
    curve = other.curves(OUTPUT, 1)[0]
    assert curve.complete
    assert curve.amplitude.min() > 0.5
    omega = 2 * np.pi * curve.frequency_hz
    begin = next(at for at in np.arange(1.02, 1.2, 1e-4) if np.isfinite(subharmonic(at)))
    assert omega.min() == pytest.approx(begin, rel=3e-3)
    # larger and smaller motion: the larger one is stable, the smaller one is not
    at = 1.1
    passes = np.flatnonzero((omega[:-1] - at) * (omega[1:] - at) < 0.0)
    assert passes.size == 2
    heights = {float(curve.amplitude[place]): bool(curve.stable[place : place + 2].all()) for place in passes}
    assert heights[max(heights)]
    assert not heights[min(heights)]
    assert max(heights) == pytest.approx(subharmonic(at), rel=0.1)


@pytest.mark.long
def test_a_closed_curve_is_isolated() -> None:
    _, other = searched(FORCE, (1.02, 2.8), damping=0.09, starts=4, seed=0)
    assert other.names == ("closed curve 1",)
    assert other.closed.all()
    assert other.complete.all()
    omega = 2 * np.pi * other.frequency_hz
    exists = [at for at in np.arange(1.02, 2.8, 1e-3) if np.isfinite(subharmonic(at, 0.09))]
    assert omega.min() == pytest.approx(exists[0], rel=0.02)
    assert omega.max() < exists[-1] < 2.8  # the first order is for frequencies near the resonance


@pytest.mark.long
def test_unsymmetric_motions_of_a_symmetric_structure_are_found() -> None:
    """Two equal oscillators that stiffen, with a weak spring between them, under equal forces."""
    coupling = 0.02
    stiffness = np.array([[0.5 + coupling, -coupling], [-coupling, 0.5 + coupling]])
    structure = ss.Superelement(np.eye(2), stiffness, 0.05 * np.eye(2))
    spring = ss.CubicSpring(np.tile([[0.5, 0.0, 0.0]], (2, 1)), np.tile([[CUBIC, 0.0, 0.0]], (2, 1)))
    operator = np.zeros((6, 2))
    operator[0, 0] = operator[3, 1] = 1.0
    pairs, force = ss.ContactPairs.with_laws(operator, [spring]), np.array([0.3, 0.3])
    window = (0.8 / (2 * np.pi), 1.8 / (2 * np.pi))
    response = ss.forced_response(structure, pairs, force, frequency_hz=window, harmonics=3, samples=64)
    both = [response.harmonic_amplitude(row, 1) for row in np.eye(2)]
    np.testing.assert_allclose(both[0], both[1], rtol=1e-9)
    other = ss.search_other_solutions(structure, pairs, force, response, starts=3).other_solutions
    assert other is not None
    assert other.n_curves >= 1
    first, second = (other.curves(row, 1)[0] for row in np.eye(2))
    assert np.abs(first.amplitude - second.amplitude).max() > 0.3 * first.amplitude.max()
    assert first.stable.any()


@pytest.mark.long
def test_the_same_seed_gives_the_same_search_and_a_file_keeps_it(tmp_path: Path) -> None:
    first, again = (searched(FORCE, (1.02, 1.3), starts=2, seed=2)[0] for _ in range(2))
    assert again.other_solutions == first.other_solutions
    first.save(tmp_path / "results.nc")
    assert ss.ForcedResponse.load(tmp_path / "results.nc") == first


@pytest.mark.long
def test_verdicts_that_more_harmonics_do_not_confirm_are_doubtful(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sure = searched(FORCE, (1.02, 1.3), starts=2, seed=2)[1]
    assert sure.doubtful_points is not None
    assert sure.doubtful_points.shape == sure.stable_points.shape
    monkeypatch.setattr("stickslip.solve.stability.curve._confirmed", lambda *_: set())
    response, other = searched(FORCE, (1.02, 1.3), starts=2, seed=2)
    assert other.doubtful_points is not None
    assert other.doubtful_points.all()
    assert other != sure
    response.save(tmp_path / "results.nc")
    assert ss.ForcedResponse.load(tmp_path / "results.nc").other_solutions == other


@pytest.mark.long
def test_a_search_that_finds_nothing_says_that_this_proves_nothing(tmp_path: Path) -> None:
    response, other = searched(0.5, (1.02, 2.5), starts=3, seed=0)
    assert other.n_curves == 0
    assert other.curves(OUTPUT) == ()
    printed_sentence(other.words())
    response.save(tmp_path / "results.nc")
    assert ss.ForcedResponse.load(tmp_path / "results.nc").other_solutions == other


def friction() -> tuple[ss.Superelement, ss.ContactPairs, np.ndarray]:
    """Two masses on one Coulomb pair; the pair slips around the peak."""
    structure = ss.Superelement(np.eye(2), np.array([[3e5, -1e5], [-1e5, 3e5]]), 6.0 * np.eye(2))
    operator = np.array([[1.0, -1.0], [0.0, 0.0], [0.0, 0.0]])
    return structure, ss.ContactPairs(operator, 1e5, 2e5, 0.3, 20.0), np.array([10.0, 0.0])


@pytest.mark.long
def test_one_pair_that_slips_has_no_other_solutions() -> None:
    structure, pairs, force = friction()
    curve = ss.forced_response(structure, pairs, force, frequency_hz=(60.0, 140.0), harmonics=3, samples=64)
    assert (curve.contact_state == ss.ContactState.STICK_SLIP).any()
    other = ss.search_other_solutions(structure, pairs, force, curve, starts=4).other_solutions
    assert other is not None
    assert other.n_curves == 0
    assert other.changes > 0
    assert other.without_solution == 0


@pytest.mark.slow
def test_a_search_rejects_what_it_cannot_use() -> None:
    structure, pairs, force = friction()
    curve = ss.forced_response(structure, pairs, force, frequency_hz=(60.0, 70.0), harmonics=1, samples=32)
    with rejects(ss.InputError, "starts"):
        ss.search_other_solutions(structure, pairs, force, curve, starts=-1)
    with rejects(ss.InputError, "seed"):
        ss.search_other_solutions(structure, pairs, force, curve, seed=1.5)  # type: ignore[arg-type]
    one = ss.Superelement(np.eye(1), np.eye(1))
    other = ss.ContactPairs(np.array([[1.0], [0.0], [0.0]]), 1e5, 2e5, 0.3, 20.0)
    with rejects(ss.InputError, "response"):
        ss.search_other_solutions(one, other, np.array([1.0]), curve)
    unequal = ss.ContactPairs(pairs.operator, 1e5, np.array([[2e5, 1e5]]), 0.3, 20.0)
    with rejects(ss.InputError, "tangential_stiffness"):
        ss.search_other_solutions(structure, unequal, force, curve)


@pytest.mark.long
def test_solutions_beyond_the_points_at_a_fold_are_on_the_curve() -> None:
    """The bench blade folds at 683.58 Hz, between two points: Newton's method leads to solutions between them."""
    blade = BLADE.load_blade_problem(10)
    structure = ss.Superelement(blade.mass, blade.stiffness, blade.damping)
    pairs = ss.ContactPairs(
        blade.contact_operator(), blade.normal_stiffness, blade.tangential_stiffness, blade.friction_coefficient,
        blade.preload,
    )  # fmt: skip
    force = ss.Excitation.force(blade.force_cos, blade.force_sin)
    curve = ss.forced_response(structure, pairs, force, frequency_hz=blade.window_hz, harmonics=3, samples=128)
    other = ss.search_other_solutions(structure, pairs, force, curve, starts=6).other_solutions
    assert other is not None
    assert other.changes > 20
    assert other.n_curves == 0
