"""The compliance against direct inverses of the dynamic stiffness, and what happens when a body floats."""

from __future__ import annotations

import numpy as np
import pytest

from helpers import Blade
from stickslip.errors import InputError
from stickslip.interface.contact_pairs import ContactPairs
from stickslip.solve.compliance import MEAN_RESTRAINT, DirectCompliance, ModalCompliance, stuck_structure, to_complex
from stickslip.solve.damping import stuck_stiffness_matrix
from stickslip.structure.superelement import Superelement

HARMONICS = 3


def coupled_damping(blade: Blade) -> Superelement:
    """The blade with a dashpot on one unknown: its modes do not diagonalise that."""
    damping = blade.superelement.damping.copy()
    damping[3, 3] += 5.0
    return Superelement(blade.superelement.mass, blade.superelement.stiffness, damping)


def random_load(blade: Blade) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(1)
    size = 2 * HARMONICS + 1
    return generator.normal(size=(size, blade.superelement.size)), generator.normal(size=(size, 3 * blade.n_pairs))


@pytest.mark.parametrize(("coupled", "kind"), [(False, ModalCompliance), (True, DirectCompliance)])
def test_displacement_equals_direct_solve(blade: Blade, coupled: bool, kind: type) -> None:
    superelement = coupled_damping(blade) if coupled else blade.superelement
    omega = 2 * np.pi * 650.0
    stuck = stuck_structure(superelement, blade.pairs, HARMONICS, 1.0, None)
    assert isinstance(stuck.compliance, kind)
    force, deviation = random_load(blade)
    displacement = stuck.compliance.displacement(omega, force, deviation)
    load = force - deviation @ blade.operator
    stiffness = stuck_stiffness_matrix(superelement, blade.pairs)
    for h in range(1, HARMONICS + 1):
        x = h * omega
        matrix = stiffness - x**2 * superelement.mass + 1j * x * superelement.damping
        expected = np.linalg.solve(matrix, to_complex(load)[h - 1])
        found = to_complex(displacement)[h - 1]
        assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
    springs = blade.pairs.stuck_stiffness().reshape(-1, 3) * [0, 0, 1]
    mean = superelement.stiffness + blade.operator.T @ (springs.reshape(-1, 1) * blade.operator)
    assert np.allclose(mean @ displacement[0], load[0], atol=1e-8 * np.abs(load[0]).max())


@pytest.mark.parametrize("coupled", [False, True])
def test_frequency_slope_against_differences(blade: Blade, coupled: bool) -> None:
    superelement = coupled_damping(blade) if coupled else blade.superelement
    omega, step = 2 * np.pi * 700.0, 1e-2
    compliance = stuck_structure(superelement, blade.pairs, HARMONICS, 1.0, None).compliance
    force, deviation = random_load(blade)
    slope = compliance.displacement_slope(omega, force, deviation)
    above, below = (compliance.displacement(omega + sign * step, force, deviation) for sign in (1, -1))
    difference = (above - below) / (2 * step)
    assert np.abs(slope - difference).max() < 1e-6 * np.abs(slope).max()


@pytest.mark.parametrize("order", [1, 2, 3])
def test_block_equals_the_inverse(blade: Blade, order: int) -> None:
    omega = 2 * np.pi * 690.0
    superelement = blade.superelement
    compliance = stuck_structure(superelement, blade.pairs, HARMONICS, 1.0, None).compliance
    rows, columns = np.array([0, 4, 8, 29]), np.array([1, 2, 3])
    block = compliance.block(omega, order, rows, columns)
    x = order * omega
    matrix = stuck_stiffness_matrix(superelement, blade.pairs) - x**2 * superelement.mass
    matrix = matrix + 1j * x * superelement.damping
    exact = blade.operator @ np.linalg.solve(matrix, blade.operator.T)
    assert np.abs(block - exact[np.ix_(rows, columns)]).max() < 1e-8 * np.abs(exact).max()


def floating_block() -> tuple[Superelement, ContactPairs]:
    """A block that only friction holds along t1 and t2: the mean position is free there."""
    return (
        Superelement(np.eye(3), np.zeros((3, 3))),
        ContactPairs(np.eye(3), 1e6, 8e5, 0.3, 10.0),
    )


def test_free_mean_position_gets_the_restraint() -> None:
    superelement, pairs = floating_block()
    compliance = stuck_structure(superelement, pairs, 1, 100.0, 0.01).compliance
    assert compliance.mean_restraint == MEAN_RESTRAINT
    mean = compliance.mean_block(np.arange(3), np.arange(3))
    assert mean[0, 0] == pytest.approx(1.0 / (MEAN_RESTRAINT * 8e5))
    assert mean[2, 2] == pytest.approx(1e-6)


def test_body_without_any_contact_is_refused() -> None:
    superelement = Superelement(np.eye(4), np.zeros((4, 4)))
    pairs = ContactPairs(np.eye(3, 4), 1e6, 8e5, 0.3, 10.0)
    with pytest.raises(InputError, match="can move freely"):
        stuck_structure(superelement, pairs, 1, 100.0, 0.01)


def test_two_kinds_of_damping_are_refused(blade: Blade) -> None:
    with pytest.raises(InputError, match="not both"):
        stuck_structure(blade.superelement, blade.pairs, 1, 100.0, 0.01)


def test_operator_of_another_size_is_refused(blade: Blade) -> None:
    pairs = ContactPairs(np.eye(3, 5), 1e6, 8e5, 0.3, 10.0)
    with pytest.raises(InputError, match="operator has 5 columns, but the superelement has 38"):
        stuck_structure(blade.superelement, pairs, 1, 100.0, None)
