"""The iteration for linear systems: its solutions, its ends, and when a stored factor is given up."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic import factors
from stickslip.solve.harmonic.factors import BlockFactor, LastFactor, iterated
from stickslip.solve.harmonic.gmres import gmres

SIZE = 60


@pytest.fixture(name="system")
def random_system() -> tuple[FloatArray, FloatArray]:
    random = np.random.default_rng(3)
    return np.eye(SIZE) + 0.08 * random.standard_normal((SIZE, SIZE)), random.standard_normal(SIZE)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-12])
def test_the_residual_is_below_the_tolerance(system: tuple[FloatArray, FloatArray], tolerance: float) -> None:
    matrix, right = system
    answer = gmres(lambda vector: matrix @ vector, right, tolerance, SIZE)
    assert answer is not None
    assert np.linalg.norm(right - matrix @ answer) <= 1.01 * tolerance * np.linalg.norm(right)


def test_no_more_products_than_the_space_has_directions(system: tuple[FloatArray, FloatArray]) -> None:
    """Three different eigenvalues need three products, and none for a check at the end."""
    _, right = system
    diagonal, products = np.repeat([1.0, 2.0, 5.0], SIZE // 3), []

    def apply(vector: FloatArray) -> FloatArray:
        products.append(1)
        return np.asarray(diagonal * vector)

    answer = gmres(apply, right, 1e-12, SIZE)
    assert answer is not None
    np.testing.assert_allclose(answer, right / diagonal, rtol=1e-10)
    assert len(products) == 3


def test_a_product_that_returns_its_argument_is_not_changed(system: tuple[FloatArray, FloatArray]) -> None:
    _, right = system
    answer = gmres(lambda vector: vector, right, 1e-10, SIZE)
    assert answer is not None
    np.testing.assert_allclose(answer, right, rtol=1e-14)


def test_badly_conditioned_columns_stay_orthogonal() -> None:
    """Hilbert's matrix, condition number 1e13: one projection alone would lose all digits of the basis."""
    size = 10
    matrix = 1.0 / (1.0 + np.arange(size)[:, None] + np.arange(size))
    right = matrix @ np.ones(size)
    answer = gmres(lambda vector: matrix @ vector, right, 1e-12, size)
    assert answer is not None
    assert np.linalg.norm(right - matrix @ answer) <= 2e-12 * np.linalg.norm(right)


def test_without_an_answer(system: tuple[FloatArray, FloatArray]) -> None:
    matrix, right = system
    assert gmres(lambda vector: matrix @ vector, right, 1e-12, 5) is None
    assert gmres(lambda vector: np.full(SIZE, np.nan), right, 1e-3, SIZE) is None
    assert gmres(lambda vector: np.zeros(SIZE), right, 1e-3, SIZE) is None
    assert gmres(lambda vector: matrix @ vector, np.full(SIZE, np.inf), 1e-3, SIZE) is None
    nothing = gmres(lambda vector: matrix @ vector, np.zeros(SIZE), 1e-3, SIZE)
    assert nothing is not None
    assert not nothing.any()


def test_an_inverse_shortens_the_iteration(system: tuple[FloatArray, FloatArray]) -> None:
    matrix, right = system
    inverse = np.linalg.inv(matrix)
    assert iterated(lambda vector: matrix @ vector, right, 1e-10, 3) is None
    answer = iterated(lambda vector: matrix @ vector, right, 1e-10, 3, lambda vector: inverse @ vector)
    assert answer is not None
    np.testing.assert_allclose(matrix @ answer, right, atol=1e-8)


def uses_until_doubt(last: LastFactor) -> int:
    return next(number for number in range(100) if last.is_doubtful())


def test_a_factor_that_is_needed_is_doubted_less_and_less_often() -> None:
    last = LastFactor()
    assert not last.is_doubtful()  # nothing is stored
    last.store(BlockFactor([]), np.arange(3))
    waits = []
    for _ in range(8):
        waits.append(uses_until_doubt(last))
        last.was_needed()
    assert waits == [0, 1, 3, 7, 15, 31, 31, 31]
    assert waits[-1] == factors.MOST_WAITS - 1


def test_a_trial_that_fails_keeps_the_factor() -> None:
    last = LastFactor()
    last.store(BlockFactor([]), np.arange(3))
    assert last.tried_without(lambda: None) is None
    assert last.inverse(np.arange(3)) is not None
    assert last.tried_without(lambda: np.ones(3)) is None  # not doubtful: one more use before the next trial


def test_a_factor_that_is_not_needed_is_released() -> None:
    last = LastFactor()
    last.store(BlockFactor([]), np.arange(3))
    assert last.tried_without(lambda: np.ones(3)) is not None
    assert last.inverse(np.arange(3)) is None
    assert not last.is_doubtful()
    last.store(BlockFactor([]), np.arange(3))  # the next one was hard again: wait longer
    assert uses_until_doubt(last) == 1
