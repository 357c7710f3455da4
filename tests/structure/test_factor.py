import sys
from collections.abc import Callable
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.sparse

from helpers import absent_tool
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError, InputError, MissingPackageError, SingularMatrixError
from stickslip.structure import factor as factor_module
from stickslip.structure.elasticity import Material, assemble
from stickslip.structure.factor import MANY_COLUMNS, PARDISO_SIZE, best_backend, factor_forecast, factorize
from stickslip.structure.mesh import Mesh


@pytest.fixture(scope="module")
def stiffness(make_block: Callable[..., Mesh]) -> Any:
    return assemble(make_block((3, 2, 2), (1.0, 1.0, 1.0)), Material(), fixed_nodes=np.arange(9)).stiffness


@pytest.mark.parametrize("columns", [None, 1, 5, 150])
def test_solves_one_and_many_right_hand_sides_in_blocks(stiffness: Any, columns: int | None) -> None:
    shape = stiffness.shape[0] if columns is None else (stiffness.shape[0], columns)
    solution = np.random.default_rng(0).standard_normal(shape)
    factor = factorize(stiffness)
    assert factor.residual < 1e-14
    np.testing.assert_allclose(factor.solve(stiffness @ solution, block=64), solution, atol=1e-11)


def test_sparse_right_hand_sides(stiffness: Any) -> None:
    columns = scipy.sparse.csr_matrix(np.eye(stiffness.shape[0])[:, :7])
    np.testing.assert_allclose(stiffness @ factorize(stiffness).solve(columns, block=3), columns.toarray(), atol=1e-12)


def test_a_free_body_is_singular_and_reported_so(make_block: Callable[..., Mesh]) -> None:
    with rejects(SingularMatrixError):
        factorize(assemble(make_block((2, 2, 2), (1.0, 1.0, 1.0)), Material()).stiffness)


def test_a_zero_row_is_singular() -> None:
    with rejects(SingularMatrixError):
        factorize(scipy.sparse.diags([1.0, 0.0, 2.0]))


@pytest.mark.parametrize("shape", [(2, 3), (0, 0)])
def test_a_matrix_that_is_not_square_is_rejected(shape: tuple[int, int]) -> None:
    with rejects(InputError):
        factorize(scipy.sparse.csr_matrix(shape))


def test_a_factor_with_a_large_residual_is_rejected(stiffness: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    sound = factor_module._superlu

    def wrong(matrix: Any) -> SimpleNamespace:
        return SimpleNamespace(solve=lambda right: sound(matrix).solve(right) * (1.0 + 1e-6))

    monkeypatch.setattr(factor_module, "_superlu", wrong)
    with rejects(ConvergenceError):
        factorize(stiffness)


def test_an_unknown_backend_is_rejected(stiffness: Any) -> None:
    wrong: Any = "cholmod"
    with rejects(InputError, "backend"):
        factorize(stiffness, backend=wrong)


def test_missing_pardiso_names_the_extra(stiffness: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pypardiso", None)
    with rejects(MissingPackageError):
        factorize(stiffness, backend="pardiso")


@pytest.mark.long
def test_pardiso_where_it_is_installed(stiffness: Any) -> None:
    if find_spec("pypardiso") is None:
        absent_tool("pypardiso", 'pip install "stickslip[pardiso]".')
    solution = np.random.default_rng(0).standard_normal((stiffness.shape[0], 5))
    factor = factorize(stiffness, backend="pardiso")
    np.testing.assert_allclose(factor.solve(stiffness @ solution, block=2), solution, atol=1e-11)


def test_a_large_factor_with_superlu_says_how_long_it_may_take() -> None:
    assert factor_forecast(10_000, "superlu") == "factor of 10000 unknowns"
    assert factor_forecast(200_000, "pardiso") == "factor of 200000 unknowns"
    sentence = factor_forecast(100_000, "superlu")
    printed_sentence(sentence, "stickslip[pardiso]")


def test_the_best_backend_needs_its_package_and_a_size_where_it_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    assert best_backend(PARDISO_SIZE - 1) == "superlu"
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert best_backend(10**6) == "superlu"
    monkeypatch.setattr("importlib.util.find_spec", lambda name: object())
    assert best_backend(10**6) == "pardiso"
    assert best_backend(10**6, columns=MANY_COLUMNS) == "superlu"


def test_blocks_in_threads_give_the_same_columns_and_report_their_progress(stiffness: Any) -> None:
    right = np.random.default_rng(0).normal(size=(stiffness.shape[0], 50))
    received: list[float] = []
    one = factorize(stiffness).solve(right, block=8)
    out = np.empty_like(right)
    two = factorize(stiffness, threads=3).solve(right, block=8, out=out, progress=received.append)
    assert two is out
    np.testing.assert_array_equal(one, two)
    assert sorted(received) == pytest.approx(np.arange(1, 8) / 7)
