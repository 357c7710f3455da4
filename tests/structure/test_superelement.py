"""Which modes are bodies that move freely: by the stiffness that they feel, not by a frequency. Rayleigh damping."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

from helpers import Blade
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.structure.superelement import moves_freely, rayleigh_damping_matrix


def chain(n: int, stiffness: float, mass: float, held: bool) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of ``n`` masses in a row, the first one held by a spring or not."""
    matrix = stiffness * (np.diag(np.full(n, 2.0)) - np.diag(np.ones(n - 1), 1) - np.diag(np.ones(n - 1), -1))
    matrix[-1, -1] = stiffness
    if not held:
        matrix[0, 0] = stiffness
    return matrix, mass * np.eye(n)


def test_a_soft_structure_is_elastic() -> None:
    """0.2 Hz were below the limit of 1 Hz."""
    stiffness, mass = chain(10, 40.0, 1.0, held=True)
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    assert np.sqrt(squares[0]) / (2.0 * np.pi) == pytest.approx(0.15, abs=0.05)
    assert not moves_freely(stiffness, modes).any()


@pytest.mark.parametrize("kind", ["dense", "sparse"])
@pytest.mark.parametrize(("soft", "heavy"), [(1e9, 1.0), (40.0, 1.0), (1e-3, 1e3)])
def test_a_free_body_beside_stiff_ones(kind: str, soft: float, heavy: float) -> None:
    held, light = chain(8, 1e9, 1.0, held=True), chain(6, soft, heavy, held=False)
    stiffness, mass = (scipy.linalg.block_diag(*pair) for pair in zip(held, light, strict=True))
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    matrix = scipy.sparse.csr_array(stiffness) if kind == "sparse" else stiffness
    free = moves_freely(matrix, modes)
    assert free.sum() == 1
    assert free[0] or soft < 1.0  # the order of values below round-off is any
    assert squares[free].max() <= 1e-12 * squares.max()


@pytest.mark.parametrize("free_masses", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("links", [3, 6])
def test_every_mass_without_a_spring_moves_freely(free_masses: int, links: int) -> None:
    """Their modes contain round-off in the elastic unknowns, whose energy is no smaller part of itself."""
    size = links + free_masses
    stiffness = np.zeros((size, size))
    for first in range(links):
        second = (first + 1) % links
        stiffness[[first, second], [first, second]] += 1e5
        stiffness[[first, second], [second, first]] -= 1e5
        stiffness[first, first] += 2e5
    order = np.random.default_rng(0).permutation(size)
    stiffness, mass = stiffness[np.ix_(order, order)], np.diag(np.repeat([0.7, 0.3], [links, free_masses])[order])
    _, modes = scipy.linalg.eigh(stiffness, mass)
    assert np.flatnonzero(moves_freely(stiffness, modes)).tolist() == list(range(free_masses))


def test_rayleigh_leaves_the_joint_out(blade: Blade) -> None:
    """The dashpots of beta K act within the structure; contact springs have none."""
    damping = rayleigh_damping_matrix(blade.superelement, 3.0, 1e-7)
    assert np.allclose(damping, 3.0 * blade.superelement.mass + 1e-7 * blade.superelement.stiffness)


def test_negative_rayleigh_factor_is_rejected(blade: Blade) -> None:
    with rejects(InputError, "mass_factor", "stiffness_factor"):
        rayleigh_damping_matrix(blade.superelement, -1.0, 0.0)


def test_rayleigh_damping_is_beside_that_of_the_structure(blade: Blade) -> None:
    undamped = replace(blade.superelement, damping=None)
    given = replace(undamped, damping=np.eye(undamped.size))
    for own, structure in ((0.0, undamped), (np.eye(undamped.size), given)):
        damping = structure.with_rayleigh_damping(3.0, 1e-7).damping
        assert damping is not None
        np.testing.assert_array_equal(damping, 3.0 * undamped.mass + 1e-7 * undamped.stiffness + own)


def test_a_superelement_is_no_sector(blade: Blade) -> None:
    assert blade.superelement.require_structure() is blade.superelement
    with rejects(InputError, "superelement"):
        blade.superelement.require_sector()
