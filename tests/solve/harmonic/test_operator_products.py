"""Products with the operator of the pairs: sparse and dense operators agree with the plain products."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.solve.harmonic.operator_products import SPARSE, times, with_springs


@pytest.mark.slow
@pytest.mark.parametrize("fraction", [0.5 * SPARSE, 0.5])
def test_products_agree_with_those_of_the_whole_operator(fraction: float) -> None:
    rng = np.random.default_rng(0)
    operator = rng.standard_normal((60, 80)) * (rng.random((60, 80)) < fraction)
    springs, matrix = rng.uniform(1.0, 2.0, 60), rng.standard_normal((80, 7))
    assert times(operator, matrix) == pytest.approx(operator @ matrix, rel=1e-12, abs=1e-12)
    expected = operator.T @ np.diag(springs) @ operator
    assert with_springs(operator, springs) == pytest.approx(expected, rel=1e-12, abs=1e-12)
