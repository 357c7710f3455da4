"""Products with the operator of the pairs: sparse and dense operators agree with the plain products."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.operator_products import (
    SPARSE,
    add_springs,
    as_rows,
    at_unknowns,
    both_sides,
    own_products,
    row_squares,
    times,
    with_springs,
)


@pytest.mark.slow
@pytest.mark.parametrize("fraction", [0.5 * SPARSE, 0.5])
def test_products_agree_with_those_of_the_whole_operator(fraction: float) -> None:
    rng = np.random.default_rng(0)
    operator = rng.standard_normal((60, 80)) * (rng.random((60, 80)) < fraction)
    springs, matrix = rng.uniform(1.0, 2.0, 60), rng.standard_normal((80, 7))
    assert times(operator, matrix) == pytest.approx(operator @ matrix, rel=1e-12, abs=1e-12)
    expected = operator.T @ np.diag(springs) @ operator
    assert with_springs(operator, springs) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    square = rng.standard_normal((80, 80))
    given = square.copy()
    assert add_springs(given, operator, springs) is given
    assert given == pytest.approx(square + expected, rel=1e-12, abs=1e-12)
    force = rng.standard_normal((2, 3, 60))
    assert at_unknowns(force, operator) == pytest.approx(force @ operator, rel=1e-12, abs=1e-12)
    require_products_of_a_square_matrix(operator, square + square.T)


def test_an_operator_that_selects_unknowns_takes_their_rows_and_columns() -> None:
    rng = np.random.default_rng(1)
    operator = np.zeros((30, 80))
    operator[np.arange(30), rng.permutation(80)[:30]] = rng.choice([-1.0, 2.0], 30)
    matrix = rng.standard_normal((80, 80))
    require_products_of_a_square_matrix(operator, matrix + matrix.T)


def require_products_of_a_square_matrix(operator: FloatArray, matrix: FloatArray) -> None:
    expected = operator @ matrix @ operator.T
    assert both_sides(operator, matrix) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    squares = (operator**2).sum(axis=1)
    assert row_squares(operator) == pytest.approx(squares, rel=1e-12)
    assert row_squares(as_rows(operator)) == pytest.approx(squares, rel=1e-12)
    assert own_products(operator, matrix) == pytest.approx(np.diag(expected), rel=1e-12, abs=1e-12)
