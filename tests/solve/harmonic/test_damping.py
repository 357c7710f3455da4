"""Modal damping matrices, and the modal basis."""

from __future__ import annotations

import numpy as np
import pytest

from helpers import Blade
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.solve.harmonic.damping import (
    DAMPED_RANGE,
    _uncoupled,
    changed_basis,
    damping_root,
    diagonal_modal_damping,
    modal_basis,
    modal_damping,
    modal_damping_matrix,
    stuck_stiffness_matrix,
)


def test_modal_basis_normalises_by_mass(blade: Blade) -> None:
    stiffness = stuck_stiffness_matrix(blade.superelement, blade.pairs)
    frequency, modes = modal_basis(blade.superelement.mass, stiffness)
    assert np.allclose(modes.T @ blade.superelement.mass @ modes, np.eye(frequency.size), atol=1e-9)
    assert frequency[0] / (2 * np.pi) == pytest.approx(blade.stuck_hz, rel=1e-9)


def test_modes_of_other_springs_follow_from_known_ones(blade: Blade) -> None:
    """Springs from a tenth to ten times as stiff."""
    mass, operator = blade.superelement.mass, blade.pairs.operator
    frequency, modes = modal_basis(mass, stuck_stiffness_matrix(blade.superelement, blade.pairs))
    change = np.linspace(-0.9, 9.0, len(operator)) * blade.pairs.resting_stiffness()
    stiffness = stuck_stiffness_matrix(blade.superelement, blade.pairs) + operator.T @ (change[:, None] * operator)
    expected, _ = modal_basis(mass, stiffness)
    found, shapes = changed_basis(frequency, modes, operator @ modes, change)
    np.testing.assert_allclose(found, expected, rtol=1e-7)
    np.testing.assert_allclose(shapes.T @ mass @ shapes, np.eye(found.size), atol=1e-9)
    np.testing.assert_allclose(shapes.T @ stiffness @ shapes, np.diag(found**2), atol=1e-9 * float(found[-1]) ** 2)


def test_modes_that_springs_do_not_couple_are_those_of_the_whole_problem() -> None:
    """Two equal chains of three masses with springs to the ground, in symmetric and antisymmetric modes."""
    chain = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.5]])
    stiffness = np.kron(np.eye(2), chain) + np.kron([[0.0, 1.0], [1.0, 0.0]], np.diag([-0.2, 0.0, 0.0]))
    frequency, modes = modal_basis(np.eye(6), stiffness)
    for springs, blocks in (([1.0, 0.5, 0.3, 1.0, 0.5, 0.3], 2), ([1.0, 0.5, 0.3, 0.9, 0.2, 0.3], 1)):
        known = np.diag(frequency**2) + modes.T @ (np.array(springs)[:, None] * modes)
        assert len(_uncoupled(known)) == blocks
        found, shapes = changed_basis(frequency, modes, modes, np.array(springs))
        whole = stiffness + np.diag(springs)
        np.testing.assert_allclose(found**2, np.linalg.eigvalsh(whole), rtol=1e-9)
        np.testing.assert_allclose(shapes.T @ whole @ shapes, np.diag(found**2), atol=1e-9)


def test_bench_damping_is_two_per_mille_on_the_stuck_modes(blade: Blade) -> None:
    stiffness = stuck_stiffness_matrix(blade.superelement, blade.pairs)
    frequency, modes = modal_basis(blade.superelement.mass, stiffness)
    assert blade.superelement.damping is not None
    rebuilt = modal_damping_matrix(blade.superelement.mass, modes, modal_damping(frequency, 0.002, frequency.max()))
    assert np.abs(rebuilt - blade.superelement.damping).max() < 1e-6 * np.abs(rebuilt).max()


def test_the_root_of_modal_damping_has_the_damped_modes_alone(blade: Blade) -> None:
    mass = blade.superelement.mass
    frequency, modes = modal_basis(mass, stuck_stiffness_matrix(blade.superelement, blade.pairs))
    modal = modal_damping(frequency, 0.002, 1.001 * float(frequency[5]) / DAMPED_RANGE)
    damped = np.count_nonzero(modal)
    assert 6 <= damped < frequency.size
    root = damping_root(mass, modes, modal)
    assert root.shape == (frequency.size, damped)
    expected = mass @ modes @ np.diag(modal) @ modes.T @ mass
    np.testing.assert_allclose(root @ root.T, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    assert damping_root(mass, modes, np.zeros_like(modal)).shape == (frequency.size, 0)


def test_modes_far_above_the_excitation_are_not_damped(blade: Blade) -> None:
    frequency = np.array([100.0, 1999.0, 2001.0])
    assert modal_damping(frequency, 0.01, 100.0) == pytest.approx([2.0, 39.98, 0.0])


def test_stiffness_proportional_to_the_stuck_matrix_is_diagonal_and_a_dashpot_is_not(blade: Blade) -> None:
    stiffness = stuck_stiffness_matrix(blade.superelement, blade.pairs)
    frequency, modes = modal_basis(blade.superelement.mass, stiffness)
    rayleigh = 3.0 * blade.superelement.mass + 1e-7 * stiffness
    diagonal = diagonal_modal_damping(rayleigh, modes)
    assert diagonal is not None
    assert np.allclose(diagonal, 3.0 + 1e-7 * frequency**2, rtol=1e-8)
    rayleigh[3, 3] += 1.0
    assert diagonal_modal_damping(rayleigh, modes) is None


def test_indefinite_matrices_are_rejected() -> None:
    with rejects(InputError):
        modal_basis(np.diag([1.0, 0.0]), np.eye(2))
    with rejects(InputError):
        modal_basis(np.eye(2), np.diag([1.0, -1.0]))
