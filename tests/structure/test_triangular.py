from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse
from scipy.sparse.linalg import splu

from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Material, assemble
from stickslip.structure.factor import factorize
from stickslip.structure.mesh import Mesh
from stickslip.structure.triangular import COLUMNS, TriangularFactor


@pytest.fixture(scope="module")
def stiffness(make_block: Callable[..., Mesh]) -> scipy.sparse.csr_matrix:
    return assemble(make_block((4, 3, 3), (1.0, 1.0, 1.0)), Material(), fixed_nodes=np.arange(9)).stiffness


@pytest.mark.parametrize("columns", [None, 1, COLUMNS - 1, COLUMNS, 2 * COLUMNS + 3])
def test_solves_what_superlu_solves(stiffness: scipy.sparse.csr_matrix, columns: int | None) -> None:
    size = stiffness.shape[0]
    right: FloatArray = np.random.default_rng(1).standard_normal(size if columns is None else (size, columns))
    given = right.copy()
    factor = factorize(stiffness)
    answer = factor.for_many_columns().solve(right)
    expected = factor.solve(right)
    assert factor.for_many_columns() is not factor
    np.testing.assert_allclose(answer, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_array_equal(right, given)


def test_rows_that_are_zero_in_a_block_are_passed_over_without_a_difference(stiffness: scipy.sparse.csr_matrix) -> None:
    right = np.zeros((stiffness.shape[0], 5))
    right[-7:, :3] = np.random.default_rng(2).standard_normal((7, 3))
    answer = factorize(stiffness).for_many_columns().solve(right)
    np.testing.assert_allclose(stiffness @ answer, right, atol=1e-12)


def test_an_indefinite_matrix(stiffness: scipy.sparse.csr_matrix) -> None:
    shifted = stiffness - 0.3 * scipy.sparse.diags(stiffness.diagonal())
    assert np.linalg.eigvalsh(shifted.toarray())[0] < 0.0
    right = np.random.default_rng(3).standard_normal((stiffness.shape[0], 4))
    answer = factorize(shifted).for_many_columns().solve(right)
    np.testing.assert_allclose(shifted @ answer, right, atol=1e-10)


def test_a_factor_that_is_not_symmetric_has_no_such_form() -> None:
    lopsided = scipy.sparse.csc_matrix([[4.0, 1.0, 0.0], [0.5, 3.0, 1.0], [0.0, 0.2, 5.0]])
    factor = splu(lopsided, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    np.testing.assert_array_equal(factor.perm_r, factor.perm_c)  # the factors alone tell
    assert TriangularFactor.of_superlu(factor) is None
    exchanged = splu(scipy.sparse.csc_matrix([[0.0, 2.0], [2.0, 1.0]]), permc_spec="NATURAL")
    assert TriangularFactor.of_superlu(exchanged) is None


def test_complex_factors_keep_their_form(stiffness: scipy.sparse.csr_matrix) -> None:
    factor = factorize(stiffness.astype(complex))
    assert factor.for_many_columns() is factor
