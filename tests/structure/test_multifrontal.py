"""The elimination by fronts: the Schur complement and the projected mass are those of dense matrices."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse
from scipy.linalg.blas import dsyr2k, dsyrk
from threadpoolctl import threadpool_limits

from sentences import rejects
from stickslip.core.errors import InputError, SingularMatrixError
from stickslip.core.validation import FloatArray
from stickslip.structure import dissection, front_reduction, multifrontal
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.dissection import nested_dissection
from stickslip.structure.elasticity import Material, Structure, assemble
from stickslip.structure.mesh import Mesh
from stickslip.structure.multifrontal import condensed
from stickslip.structure.recovery import partition
from stickslip.structure.triangular import TriangularFactor

BOUNDARY = np.array([40, 20, 31, 22, 35])


@pytest.fixture
def small_fronts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many small fronts, of which those with more than 20 later unknowns are divided into blocks of 8 columns."""
    monkeypatch.setattr(dissection, "LARGEST_LEAF", 3)
    monkeypatch.setattr(multifrontal, "LARGE_FRONT", 20)
    monkeypatch.setattr(multifrontal, "COLUMNS", 8)
    monkeypatch.setattr(multifrontal, "WIDEST_PANEL", 7)


def of_block(block: Structure, threads: int = 1) -> tuple[TriangularFactor, list[FloatArray]]:
    boundary, interior = partition(block, BOUNDARY)
    return condensed((block.stiffness, block.mass), block.node, block.mesh.points, boundary, interior, 2, threads)


def test_condensed_matrices_are_projections_by_the_constraint_modes(held_block: Structure, small_fronts: None) -> None:
    boundary, interior = partition(held_block, BOUNDARY)
    stiffness = held_block.stiffness.toarray()
    basis = np.zeros((len(stiffness), len(boundary)))
    basis[boundary] = np.eye(len(boundary))
    basis[interior] = -np.linalg.solve(stiffness[np.ix_(interior, interior)], stiffness[np.ix_(interior, boundary)])
    factor, (reduced_stiffness, reduced_mass) = of_block(held_block)
    assert len(factor.firsts) > 5
    for matrix, actual in ((stiffness, reduced_stiffness), (held_block.mass.toarray(), reduced_mass)):
        expected = basis.T @ matrix @ basis
        assert not actual[:, len(boundary) :].any()  # the columns beside
        np.testing.assert_array_equal(actual, actual.T)
        error = np.abs(actual[: len(boundary), : len(boundary)] - expected).max()
        assert error <= 1e-13 * np.abs(matrix).max()


@pytest.mark.parametrize("columns", [None, 1, 4])
def test_the_factor_solves_the_interior(held_block: Structure, small_fronts: None, columns: int | None) -> None:
    _, interior = partition(held_block, BOUNDARY)
    inner = held_block.stiffness[interior][:, interior]
    exact = np.random.default_rng(1).standard_normal(len(interior) if columns is None else (len(interior), columns))
    right = inner @ exact
    given = right.copy()
    np.testing.assert_allclose(of_block(held_block)[0].solve(right), exact, atol=1e-9)
    np.testing.assert_array_equal(right, given)


@pytest.mark.slow
def test_the_digits_do_not_depend_on_the_threads(held_block: Structure, small_fronts: None) -> None:
    for one, two in zip(of_block(held_block)[1], of_block(held_block, threads=2)[1], strict=True):
        np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize(("columns", "rows"), [(301, 2001), (825, 1100)])
def test_symmetric_products_of_the_library_have_the_same_digits_in_threads(columns: int, rows: int) -> None:
    """Large fronts leave these products to the library, whatever its number of threads."""
    random = np.random.default_rng(2)
    left, right = random.standard_normal((2, rows, columns))
    answers = []
    for threads in (1, 2, 3):
        with threadpool_limits(limits=threads):
            single = dsyrk(-1.0, left.T, 1.0, np.zeros((rows, rows)).T, trans=1, lower=0)
            both = dsyr2k(-1.0, left.T, right.T, 1.0, np.zeros((rows, rows)).T, trans=1, lower=0)
        answers.append((single, both))
    for others in answers[1:]:
        for one, other in zip(answers[0], others, strict=True):
            np.testing.assert_array_equal(one, other)


def test_the_factor_is_in_memory_once(make_block: Callable[..., Mesh], held_block: Structure) -> None:
    """A large mesh has little memory beside its factor: panels are not copied from where elimination writes them."""
    of_block(held_block)  # compiled functions take memory too
    block = assemble(make_block((30, 8, 8), (3.0, 0.8, 0.8)), Material(), fixed_nodes=range(81))
    boundary, interior = partition(block, np.array([block.mesh.n_nodes - 1]))
    tracemalloc.start()
    try:
        factor, _ = condensed((block.stiffness,), block.node, block.mesh.points, boundary, interior)
        held, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert factor.values.nbytes > 0.95 * held
    assert peak < 1.7 * held


def test_a_stiffness_that_is_not_positive_definite_is_singular(held_block: Structure) -> None:
    boundary, interior = partition(held_block, BOUNDARY)
    shifted = (held_block.stiffness - 0.3 * scipy.sparse.diags(held_block.stiffness.diagonal())).tocsr()
    with pytest.raises(SingularMatrixError):
        condensed((shifted,), held_block.node, held_block.mesh.points, boundary, interior)


def test_each_node_is_eliminated_once_and_separators_are_small(make_block: Callable[..., Mesh]) -> None:
    mesh = make_block((20, 5, 5), (4.0, 1.0, 1.0))
    cells = mesh.blocks[0].cells
    of_cell = scipy.sparse.csr_matrix(
        (np.ones(cells.size, np.int32), (np.repeat(np.arange(len(cells)), cells.shape[1]), cells.ravel()))
    )
    fronts = nested_dissection((of_cell.T @ of_cell).tocsr(), mesh.points)
    np.testing.assert_array_equal(np.sort(np.concatenate(fronts)), np.arange(mesh.n_nodes))
    assert max(map(len, fronts)) <= dissection.LARGEST_LEAF
    assert len(fronts[-1]) == 36  # a layer across the longest axis


def test_craig_bampton_of_a_large_boundary_gives_the_same_superelement(
    held_block: Structure, small_fronts: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = craig_bampton(held_block, BOUNDARY, 6)
    monkeypatch.setattr(front_reduction, "LARGE_BOUNDARY", 1)
    fronts = craig_bampton(held_block, BOUNDARY, 6)
    assert fronts.recovery._factor._solve.__self__.__class__ is TriangularFactor
    signs = np.sign((usual.recovery.modes * fronts.recovery.modes).sum(axis=0))
    change = np.diag(np.append(np.ones(3 * len(BOUNDARY)), signs))
    for name in ("mass", "stiffness"):
        expected = getattr(usual, name)
        error = np.abs(change @ getattr(fronts, name) @ change - expected).max()
        assert error <= 1e-9 * np.abs(expected).max(), name
    motion = np.random.default_rng(2).standard_normal(usual.size)
    np.testing.assert_allclose(fronts.recovery @ motion, usual.recovery @ (change @ motion), rtol=1e-7, atol=1e-9)


def test_a_body_without_support_is_named(make_block: Callable[..., Mesh], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(front_reduction, "LARGE_BOUNDARY", 1)
    block = assemble(make_block((2, 2, 2), (1.0, 1.0, 1.0)), Material(), fixed_nodes=[])
    with rejects(InputError):
        craig_bampton(block, [0], 2)
    with rejects(InputError, "n_modes"):
        craig_bampton(block, [0, 2, 6, 8], 1000)
