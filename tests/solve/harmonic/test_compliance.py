"""The compliance against direct inverses of the dynamic stiffness, and what happens when a body floats."""

from __future__ import annotations

import numpy as np
import pytest

from helpers import Blade
from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.solve.harmonic.compliance import NEAR_RANGE, stuck_structure
from stickslip.solve.harmonic.damping import stuck_stiffness_matrix
from stickslip.solve.harmonic.gain import CoupledGain, DiagonalGain, to_complex
from stickslip.solve.harmonic.support import MEAN_RESTRAINT
from stickslip.structure.superelement import Superelement

HARMONICS = 3


def coupled_damping(blade: Blade, dashpot: float = 5.0) -> Superelement:
    """The blade with a dashpot (N s/m) on one unknown: its modes do not diagonalise that."""
    assert blade.superelement.damping is not None
    damping = blade.superelement.damping.copy()
    damping[3, 3] += dashpot
    return Superelement(blade.superelement.mass, blade.superelement.stiffness, damping)


def random_load(blade: Blade) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(1)
    size = 2 * HARMONICS + 1
    force = generator.normal(size=(size, blade.superelement.size))
    force[0] = 0.0  # constant forces are part of the state at rest
    return force, generator.normal(size=(size, 3 * blade.n_pairs))


def dynamic_stiffness(superelement: Superelement, blade: Blade, x: float) -> np.ndarray:
    """``Kbar - x^2 M + i x C`` of the stuck structure."""
    matrix = stuck_stiffness_matrix(superelement, blade.pairs) - x**2 * superelement.mass
    assert superelement.damping is not None
    return np.asarray(matrix + 1j * x * superelement.damping)


@pytest.mark.parametrize(("dashpot", "kind"), [(0.0, DiagonalGain), (5.0, CoupledGain), (3e4, CoupledGain)])
def test_displacement_equals_direct_solve(blade: Blade, dashpot: float, kind: type) -> None:
    """The strongest dashpot stops the iteration over the coupling, so the whole system is factored."""
    superelement = coupled_damping(blade, dashpot) if dashpot else blade.superelement
    omega = 2 * np.pi * 650.0
    compliance = stuck_structure(superelement, blade.pairs, 0.02 * omega, None).compliance(HARMONICS, NEAR_RANGE)
    assert isinstance(compliance.gain, kind)
    assert 0 < compliance.gain.near_modes < superelement.size
    force, deviation = random_load(blade)
    external = compliance.external(force)
    amplitude = compliance.amplitude(omega, external, deviation)
    displacement = compliance.displacement(amplitude, deviation)
    load = force - deviation @ blade.operator
    for h in range(1, HARMONICS + 1):
        expected = np.linalg.solve(dynamic_stiffness(superelement, blade, h * omega), to_complex(load[1:])[h - 1])
        actual = to_complex(displacement[1:])[h - 1]
        assert np.abs(actual - expected).max() < 1e-9 * np.abs(expected).max()
    springs = blade.pairs.stuck_stiffness().reshape(-1, 3) * [0, 0, 1]
    mean = superelement.stiffness + blade.operator.T @ (springs.reshape(-1, 1) * blade.operator)
    assert np.allclose(mean @ displacement[0], load[0], atol=1e-8 * np.abs(load[0]).max())
    relative = compliance.relative(amplitude, deviation)
    assert np.abs(relative - displacement @ blade.operator.T).max() < 1e-10 * np.abs(relative).max()


@pytest.mark.parametrize("coupled", [False, True])
def test_frequency_slope_against_differences(blade: Blade, coupled: bool) -> None:
    superelement = coupled_damping(blade) if coupled else blade.superelement
    omega, step = 2 * np.pi * 700.0, 1e-2
    compliance = stuck_structure(superelement, blade.pairs, omega, None).compliance(HARMONICS)
    force, deviation = random_load(blade)
    external = compliance.external(force)
    slope = compliance.gain.slope(omega, compliance.amplitude(omega, external, deviation))
    above, below = (compliance.amplitude(omega + sign * step, external, deviation) for sign in (1, -1))
    difference = (above - below) / (2 * step)
    assert np.abs(slope - difference).max() < 1e-6 * np.abs(slope).max()


@pytest.mark.parametrize("coupled", [False, True])
def test_viscous_form_is_that_of_the_matrix(blade: Blade, coupled: bool) -> None:
    superelement = coupled_damping(blade) if coupled else blade.superelement
    stuck = stuck_structure(superelement, blade.pairs, 4000.0, None)
    amplitude = np.random.default_rng(2).normal(size=(2 * HARMONICS, superelement.size))
    motion = amplitude @ stuck.modes.T
    assert superelement.damping is not None
    expected = np.einsum("hi,ij,hj->h", motion, superelement.damping, motion)
    assert np.allclose(stuck.compliance(HARMONICS).gain.viscous_form(amplitude), expected, rtol=1e-7)


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize(("highest", "error"), [(1e9, 1e-8), (4000.0, 1e-3)])
def test_newton_compliance_approaches_the_inverse(blade: Blade, coupled: bool, highest: float, error: float) -> None:
    """Exact with all modes near; with far modes as springs the error is their share times (x / w)^2."""
    omega = 2 * np.pi * 690.0
    superelement = coupled_damping(blade, 0.5) if coupled else blade.superelement
    compliance = stuck_structure(superelement, blade.pairs, highest, None).compliance(HARMONICS)
    columns = np.array([1, 2, 3, 17])
    newton = compliance.newton(omega, columns)
    generator = np.random.default_rng(4)
    deviation = generator.normal(size=(2 * HARMONICS + 1, columns.size))
    weights = generator.normal(size=(2 * HARMONICS + 1, 3 * blade.n_pairs))
    applied = newton.apply(deviation)
    rows = np.array([0, 4, 8, 29])
    for h in range(1, HARMONICS + 1):
        exact = blade.operator @ np.linalg.solve(dynamic_stiffness(superelement, blade, h * omega), blade.operator.T)
        assert np.abs(newton.block(h, rows) - exact[np.ix_(rows, columns)]).max() < error * np.abs(exact).max()
        expected = exact[:, columns] @ to_complex(deviation[1:])[h - 1]
        assert np.abs(to_complex(applied[1:])[h - 1] - expected).max() < error * np.abs(expected).max()
    full = np.zeros_like(weights)
    full[:, columns] = deviation
    still = compliance.relative(compliance.amplitude(omega, None, full), full)
    assert np.allclose(applied[0], -still[0], rtol=1e-9, atol=1e-12 * np.abs(still[0]).max())
    transposed = newton.apply_transposed(weights)
    assert (transposed * deviation).sum() == pytest.approx((weights * applied).sum(), rel=1e-9)


def floating_block() -> tuple[Superelement, ContactPairs]:
    """A block that only friction holds along t1 and t2: the mean position is free there."""
    return (
        Superelement(np.eye(3), np.zeros((3, 3))),
        ContactPairs(np.eye(3), 1e6, 8e5, 0.3, 10.0),
    )


def test_free_mean_position_gets_the_restraint() -> None:
    superelement, pairs = floating_block()
    stuck = stuck_structure(superelement, pairs, 100.0, 0.01)
    assert stuck.mean_restraint == MEAN_RESTRAINT
    compliance = stuck.compliance(1)
    np.testing.assert_allclose(compliance.restraint_force(np.array([1.0, 2.0, 3.0])), [[0.8, 1.6]])
    mean = compliance.newton(100.0, np.arange(3)).mean
    assert mean[0, 0] == pytest.approx(1.0 / (MEAN_RESTRAINT * 8e5))
    assert mean[2, 2] == pytest.approx(1e-6)


def test_body_without_any_contact_is_rejected() -> None:
    superelement = Superelement(np.eye(4), np.zeros((4, 4)))
    pairs = ContactPairs(np.eye(3, 4), 1e6, 8e5, 0.3, 10.0)
    with rejects(InputError):
        stuck_structure(superelement, pairs, 100.0, 0.01)


def test_two_kinds_of_damping_are_rejected(blade: Blade) -> None:
    with rejects(InputError, "modal_damping_ratio"):
        stuck_structure(blade.superelement, blade.pairs, 100.0, 0.01)


def test_operator_of_another_size_is_rejected(blade: Blade) -> None:
    pairs = ContactPairs(np.eye(3, 5), 1e6, 8e5, 0.3, 10.0)
    with rejects(InputError, "operator"):
        stuck_structure(blade.superelement, pairs, 100.0, None)


def test_a_body_that_only_gaps_could_support_is_rejected() -> None:
    superelement = Superelement(np.eye(3), np.zeros((3, 3)))
    pairs = ContactPairs(np.eye(3), 1e6, 8e5, 0.3, -10.0)
    with rejects(InputError, "preload"):
        stuck_structure(superelement, pairs, 100.0, 0.01)


def test_gaps_are_fine_where_other_pairs_support_the_body(blade: Blade) -> None:
    preload = blade.pairs.preload.copy()
    preload[::2] = -1.0
    assert stuck_structure(blade.superelement, blade.pairs_with(preload), 4000.0, None).mean_restraint == 0.0


@pytest.mark.parametrize("dashpot", [0.0, 5.0])
def test_the_newton_matrix_of_a_small_structure_contains_its_fastest_modes(blade: Blade, dashpot: float) -> None:
    """Contact thousands of times stiffer than the structure uses all digits of the compliance where it opens."""
    superelement = coupled_damping(blade, dashpot) if dashpot else blade.superelement
    omega = 2 * np.pi * 650.0
    compliance = stuck_structure(superelement, blade.pairs, 0.02 * omega, None).compliance(HARMONICS)
    rows = np.arange(3 * blade.n_pairs)
    newton = compliance.newton(omega, rows)
    for h in range(1, HARMONICS + 1):
        receptance = np.linalg.inv(dynamic_stiffness(superelement, blade, h * omega))
        expected = blade.operator @ receptance @ blade.operator.T
        assert np.abs(newton.block(h, rows) - expected).max() < 1e-9 * np.abs(expected).max()
