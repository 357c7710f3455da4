"""The block Lanczos iteration: all solutions, multiple ones too, and only those up to a limit."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from sentences import rejects
from stickslip.core import block_lanczos
from stickslip.core.block_lanczos import TooManyModes, lowest_modes
from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray


class Pencil:
    """``K v = x M v`` with given x; a full mass matrix, and a count of the columns that were solved."""

    def __init__(self, values: FloatArray, shift: float = 0.0) -> None:
        random, self.size = np.random.default_rng(3), len(values)
        root = random.standard_normal((self.size, self.size)) + 4.0 * np.diag(np.sqrt(1.0 + np.arange(self.size)))
        turned = np.linalg.qr(random.standard_normal((self.size, self.size)))[0] @ root
        self.mass = root.T @ root
        self.stiffness = turned.T @ (values[:, None] * turned)
        self._factor = scipy.linalg.cho_factor(self.stiffness - shift * self.mass)
        self.columns = 0

    def solve(self, block: FloatArray) -> FloatArray:
        self.columns += block.shape[1]
        return np.asarray(scipy.linalg.cho_solve(self._factor, block))

    def weigh(self, block: FloatArray) -> FloatArray:
        return np.asarray(self.mass @ block)

    def require_solutions(self, values: FloatArray, vectors: FloatArray) -> None:
        np.testing.assert_allclose(vectors.T @ self.mass @ vectors, np.eye(len(values)), atol=1e-11)
        left = self.stiffness @ vectors - self.mass @ vectors * values
        assert np.abs(left).max() < 1e-8 * np.abs(self.stiffness @ vectors).max()


@pytest.mark.parametrize("room", [64, 5])
def test_the_lowest_solutions_are_those_of_a_dense_solver_in_fewer_solutions(
    room: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where a block of vectors is divided between arrays of the basis."""
    monkeypatch.setattr(block_lanczos, "MORE_ROOM", room)
    values = np.geomspace(1.0, 1e6, 400)
    pencil = Pencil(values)
    found, vectors = lowest_modes(pencil.solve, pencil.weigh, 400, count=20, columns=8)
    np.testing.assert_allclose(found, values[:20], rtol=1e-8)
    pencil.require_solutions(found, vectors)
    assert pencil.columns < 300


@pytest.mark.parametrize("times", [3, 8, 14])
def test_multiple_solutions_are_found_as_often_as_they_are(times: int) -> None:
    """Also more often than a block has columns, up to twice as often."""
    values = np.concatenate([[1.0, 2.0], np.full(times, 3.0), np.geomspace(3.5, 1e4, 180)])
    pencil = Pencil(values)
    found, vectors = lowest_modes(pencil.solve, pencil.weigh, len(values), count=times + 6, columns=8)
    np.testing.assert_allclose(found, values[: times + 6], rtol=1e-8)
    pencil.require_solutions(found, vectors)


def test_a_limit_and_a_shift_give_all_solutions_up_to_it_also_at_zero() -> None:
    values = np.concatenate([np.zeros(6), np.geomspace(1.0, 1e5, 194)])
    pencil = Pencil(values, shift=-0.5)
    limit = float(0.5 * (values[39] + values[40]))
    found, vectors = lowest_modes(pencil.solve, pencil.weigh, 200, limit=limit, shift=-0.5, columns=8)
    np.testing.assert_allclose(found, values[:40], rtol=1e-8, atol=1e-8)
    pencil.require_solutions(found, vectors)
    assert len(lowest_modes(pencil.solve, pencil.weigh, 200, limit=-0.1, shift=-0.5)[0]) == 0


def test_a_small_structure_is_solved_in_its_whole_space() -> None:
    values = np.array([1.0, 1.0, 4.0, 9.0, 1e3])
    pencil = Pencil(values)
    found, vectors = lowest_modes(pencil.solve, pencil.weigh, 5, count=5)
    np.testing.assert_allclose(found, values, rtol=1e-9)
    pencil.require_solutions(found, vectors)


def test_too_many_solutions_up_to_a_limit_are_not_computed() -> None:
    pencil = Pencil(np.geomspace(1.0, 1e3, 300))
    with pytest.raises(TooManyModes):
        lowest_modes(pencil.solve, pencil.weigh, 300, limit=500.0, most=30, columns=8)
    assert pencil.columns < 120


def test_solutions_that_contradict_the_matrix_are_an_error() -> None:
    """A solver that is none of a symmetric matrix does not converge silently."""
    pencil, random = Pencil(np.geomspace(1.0, 1e3, 40)), np.random.default_rng(1)
    with rejects(ConvergenceError):
        lowest_modes(lambda block: random.standard_normal(block.shape), pencil.weigh, 40, count=5, columns=8)
