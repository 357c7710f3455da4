"""The preconditioner of large joints: an exact inverse, and few iterations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers import Blade
from stickslip.core.threads import solver_threads
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic import harmonic_modes, large_newton, local_inverse, low_rank, reduced
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.factors import iterated
from stickslip.solve.harmonic.harmonic_modes import LocalCompliance, NewtonCompliance
from stickslip.solve.harmonic.large_newton import LargeNewtonCompliance, MeanDifference, mean_difference
from stickslip.solve.harmonic.low_rank import OUTPUTS_AT_ONCE, LowRankInverse
from stickslip.solve.harmonic.reduced import NewtonSystem
from stickslip.solve.harmonic.row_products import COLUMNS_AT_ONCE, ROWS_AT_ONCE, VECTORS, row_products, sums_of_rows
from stickslip.solve.setting_up import prepare_balances

RNG = np.random.default_rng(4)


@pytest.fixture
def balance(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> Balance:
    """With modes that are springs in Newton's matrix, as those of a large structure."""
    monkeypatch.setattr("stickslip.solve.harmonic.compliance.FEW_MODES", 0)
    force = Excitation.force(blade.force_cos, blade.force_sin)
    highest = 2.0 * np.pi * max(blade.window_hz)
    return prepare_balances(
        blade.superelement, blade.pairs, force, highest, 3, 128, None, "tractrix", lambda _: None
    ).with_harmonics(3)


def system_of(balance: Balance) -> NewtonSystem:
    """The equations at a motion with slip and separation."""
    springs = balance.pairs.resting_stiffness()
    relative = RNG.standard_normal((7, balance.rows)) * balance.pairs.laws[0].normal_load.max() / springs.max()
    return NewtonSystem(balance, balance.evaluate(relative, 2.0 * np.pi * 100.0))


def borders(system: NewtonSystem) -> tuple[FloatArray, FloatArray, FloatArray]:
    columns, lines = RNG.standard_normal((2, 2, system.size)) / np.sqrt(system.size)
    return columns, lines, RNG.standard_normal((2, 2))


def bordered_inverse(
    system: NewtonSystem, columns: FloatArray, lines: FloatArray, corner: FloatArray
) -> tuple[LowRankInverse, FloatArray]:
    """The inverse with borders, and the solution that it must find."""
    inverse = system.low_rank_inverse(columns, lines, corner)
    assert inverse is not None
    return inverse, RNG.standard_normal(system.size + 2)


@pytest.mark.parametrize("share", [4, OUTPUTS_AT_ONCE])
def test_the_inverse_is_exact_for_the_compliance_of_low_rank(
    balance: Balance, monkeypatch: pytest.MonkeyPatch, share: int
) -> None:
    monkeypatch.setattr(reduced, "LARGE_ROWS", 1)
    monkeypatch.setattr(low_rank, "OUTPUTS_AT_ONCE", share)
    system = system_of(balance)
    assert system.active.outputs.size > 0
    columns, lines, corner = borders(system)
    inverse, exact = bordered_inverse(system, columns, lines, corner)
    compliance = inverse._compliance
    inner, border = exact[: system.size], exact[system.size :]
    moved = compliance.relative(compliance.amplitude(inner.reshape(system.columns, -1)))
    assert np.abs(moved).max() > 0.0
    top = inner + system.change_of_inputs(moved) + border @ columns
    right = np.append(top, lines @ inner + corner @ border)
    found = inverse.solve(right)
    np.testing.assert_allclose(found, exact, atol=1e-7)
    with solver_threads(3):  # the same digits
        for _ in range(5):
            np.testing.assert_array_equal(bordered_inverse(system, columns, lines, corner)[0].solve(right), found)


@pytest.mark.parametrize("rows_at_most", [1200, 1])  # one block a group, and one for each harmonic
def test_a_local_compliance_is_inverted_in_its_groups(
    balance: Balance, monkeypatch: pytest.MonkeyPatch, rows_at_most: int
) -> None:
    monkeypatch.setattr(local_inverse, "LARGEST_BLOCK", rows_at_most)
    monkeypatch.setattr(reduced, "LARGE_ROWS", 1)
    system, group = system_of(balance), 3 * (balance.pairs.n_pairs // 2)
    parts = RNG.standard_normal((2, group, group)) / balance.springs.max() / group
    local = LocalCompliance(*parts)
    whole = np.zeros((2, balance.rows, balance.rows))
    for start in range(0, balance.rows, group):
        here = slice(start, start + group)
        whole[:, here, here] = parts[:, : min(group, balance.rows - start), : min(group, balance.rows - start)]
    low_rank = system._balance.compliance.low_rank

    def with_local(*arguments: Any) -> Any:
        found = low_rank(*arguments)
        assert found is not None
        return replace(found, local=local)

    monkeypatch.setattr(balance.compliance, "low_rank", with_local)
    columns, lines, corner = borders(system)
    inverse, exact = bordered_inverse(system, columns, lines, corner)
    compliance = inverse._compliance
    inner, border = exact[: system.size], exact[system.size :]
    force = system.scatter(inner)
    blocks = [slice(0, 7)] if rows_at_most > 1 else [slice(0, 1), slice(1, 3), slice(3, 5), slice(5, 7)]
    top = inner.reshape(7, -1).copy()
    for block in blocks:  # what the local part of a block moves counts in this block alone
        moved = np.zeros((7, balance.rows))
        for coefficient in range(block.start, block.stop):
            moved[coefficient] = whole[min(coefficient, 1)] @ force[coefficient]
        top[block] += system.deviation_change(moved).reshape(7, -1)[block]
    of_shapes = np.zeros((7, balance.rows))
    of_shapes[:, system.active.inputs] = compliance.relative(compliance.amplitude(inner.reshape(7, -1)))
    right = top.ravel() + system.deviation_change(of_shapes)
    whole_right = np.append(right + border @ columns, lines @ inner + corner @ border)
    np.testing.assert_allclose(inverse.solve(whole_right), exact, atol=1e-6)
    none = np.empty((0, system.size))
    without = system.low_rank_inverse(none, none, np.empty((0, 0)))
    assert without is not None
    np.testing.assert_allclose(without.solve(right), inner, atol=1e-6)


def test_a_large_joint_takes_fewer_iterations(balance: Balance, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reduced, "LARGE_ROWS", 1)
    system = system_of(balance)
    none = np.empty((0, system.size))
    inverse = system.low_rank_inverse(none, none, np.empty((0, 0)))
    assert inverse is not None
    right, count = RNG.standard_normal(system.size), []

    def apply(vector: FloatArray) -> FloatArray:
        count.append(1)
        return system.apply(vector)

    plain = iterated(apply, right, 1e-8, 200)
    without, count[:] = len(count), []
    answer = iterated(apply, right, 1e-8, 200, inverse.solve)
    assert plain is not None
    assert answer is not None
    np.testing.assert_allclose(answer, plain, atol=1e-6 * np.abs(plain).max())
    assert 2 * len(count) <= without, (len(count), without)


def test_joints_of_few_rows_have_no_such_inverse(balance: Balance) -> None:
    system = system_of(balance)
    none = np.empty((0, system.size))
    assert system.low_rank_inverse(none, none, np.empty((0, 0))) is None
    assert isinstance(system.compliance, NewtonCompliance)


@pytest.mark.parametrize("count", [1, VECTORS - 1, VECTORS, 2 * VECTORS + 3])
def test_products_in_both_precisions(count: int) -> None:
    matrix, vectors = RNG.standard_normal((300, 70)), RNG.standard_normal((count, 70))
    np.testing.assert_allclose(row_products(matrix, vectors), vectors @ matrix.T, atol=1e-13)
    single = matrix.astype(np.float32)
    np.testing.assert_allclose(row_products(single, vectors), vectors @ single.astype(float).T, atol=1e-13)


@pytest.mark.parametrize("rows", [1, 2, 3, ROWS_AT_ONCE, 2 * ROWS_AT_ONCE, 2 * ROWS_AT_ONCE + 1, 5 * ROWS_AT_ONCE - 1])
def test_products_have_the_same_digits_in_threads(rows: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In shares that four does not divide too, whose last row stands for the missing ones; no share writes rows of
    another one."""
    monkeypatch.setattr("stickslip.solve.harmonic.row_products.NUMBERS_AT_ONCE", 1)
    matrix, vectors = RNG.standard_normal((rows, 70)), RNG.standard_normal((VECTORS + 1, 70))
    alone = row_products(matrix, vectors)
    np.testing.assert_allclose(alone, vectors @ matrix.T, atol=1e-13)
    with solver_threads(3):
        for _ in range(20):
            np.testing.assert_array_equal(row_products(matrix, vectors), alone)


@pytest.mark.parametrize("chosen", [1, 2 * 40 + 1, 2 * 512 + 3])
@pytest.mark.parametrize("count", [1, VECTORS, VECTORS + 2])
def test_products_with_some_rows(chosen: int, count: int) -> None:
    """Dot products with them and sums of them, in any order, with the same digits in threads."""
    size = 2 * COLUMNS_AT_ONCE + 7
    matrix, rows = RNG.standard_normal((size, size)).astype(np.float32), RNG.permutation(size)[:chosen]
    vectors, weights = RNG.standard_normal((count, size)), RNG.standard_normal((count, chosen))
    dots, sums = row_products(matrix, vectors, rows), sums_of_rows(matrix, weights, rows)
    double = matrix[rows].astype(float)
    np.testing.assert_allclose(dots, vectors @ double.T, atol=1e-11)
    np.testing.assert_allclose(sums, weights @ double, atol=1e-11)
    with solver_threads(3):
        for _ in range(5):
            np.testing.assert_array_equal(row_products(matrix, vectors, rows), dots)
            np.testing.assert_array_equal(sums_of_rows(matrix, weights, rows), sums)


def test_a_sum_of_no_rows_is_zero() -> None:
    none = np.empty(0, dtype=np.int64)
    assert not sums_of_rows(np.ones((5, 9)), np.empty((2, 0)), none).any()
    assert row_products(np.ones((5, 9)), np.ones((2, 9)), none).shape == (2, 0)


@pytest.mark.parametrize("many", [0.0, 1.0])  # products of all rows, or sums of those of the columns
def test_single_precision_is_the_same_compliance(
    balance: Balance, monkeypatch: pytest.MonkeyPatch, many: float
) -> None:
    monkeypatch.setattr(large_newton, "MANY_COLUMNS", many)
    outputs, omega = np.arange(3, 11), 2.0 * np.pi * 100.0

    double: Any = balance.compliance.newton(omega, outputs)
    monkeypatch.setattr(harmonic_modes, "LARGE_ROWS", 1)
    single: Any = balance.compliance.newton(omega, outputs)
    assert isinstance(single, LargeNewtonCompliance)
    assert single.far.dtype == np.float32
    # of the mean only the part of the far modes is rounded: it may be very soft
    assert isinstance(single.mean_part, MeanDifference)
    far = np.abs(single.far).max()
    np.testing.assert_allclose(single.mean, double.mean, atol=1e-3 * far)
    deviation, weights = RNG.standard_normal((7, 8)), RNG.standard_normal((7, balance.rows))
    rows = np.arange(5)
    for actual, expected in (
        (single.apply(deviation), double.apply(deviation)),
        (single.apply_at(deviation, rows), double.apply(deviation)[:, rows]),
        (single.apply_transposed(weights), double.apply_transposed(weights)),
        (single.block(2, rows), double.block(2, rows)),
        (single.mean, double.mean),
    ):
        np.testing.assert_allclose(actual, expected, atol=1e-5 * np.abs(expected).max())


def test_a_mean_that_differs_in_many_shapes_keeps_its_matrix(balance: Balance, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harmonic_modes, "LARGE_ROWS", 1)
    monkeypatch.setattr(large_newton, "DIFFERENCE_SHAPES", 2)
    outputs, deviation = np.arange(3, 11), RNG.standard_normal((7, 8))
    whole: Any = balance.compliance.newton(2.0 * np.pi * 100.0, outputs)
    assert not isinstance(whole.mean_part, MeanDifference)
    mean = balance.compliance._mean_contact
    np.testing.assert_allclose(whole.mean, mean[outputs], atol=1e-12 * mean.max())
    of_mean = deviation[0] @ whole.mean
    for many in (0.0, 1.0):
        monkeypatch.setattr(large_newton, "MANY_COLUMNS", many)
        np.testing.assert_allclose(whole.apply(deviation)[0], of_mean, atol=1e-13 * np.abs(of_mean).max())
    weights = RNG.standard_normal((7, balance.rows))
    np.testing.assert_allclose(whole.apply_transposed(weights)[0], whole.mean @ weights[0], atol=1e-12 * mean.max())


def test_the_difference_of_two_compliances_is_their_soft_shapes() -> None:
    shapes, far = RNG.standard_normal((90, 3)), np.diag(np.linspace(0.5, 1.0, 90))
    found = mean_difference(far + shapes @ shapes.T, far)
    assert found is not None
    np.testing.assert_allclose((found.shapes * found.weights) @ found.shapes.T, shapes @ shapes.T, atol=1e-6)
    assert mean_difference(2.0 * far, far) is None
