"""Rows of pairs on faces whose pairs form a grid."""

from __future__ import annotations

import numpy as np

from stickslip.contact.pairing.rows import FEW_ROWS, faces_with_few_rows, rows_of_pairs


def grid(first: int, second: int) -> np.ndarray:
    """(first * second, 2) m on 28 by 6.5 mm, with the round-off of a mesh."""
    x, y = np.meshgrid(np.linspace(0.0, 0.028, first), np.linspace(0.0, 0.0065, second))
    noise = 1e-9 * np.random.default_rng(3).normal(size=(first * second, 2))
    return np.column_stack([x.ravel(), y.ravel()]) + noise


def test_a_grid_has_its_rows() -> None:
    position = np.vstack([grid(11, 5), grid(21, FEW_ROWS)])
    face = np.repeat([0, 1], [55, 21 * FEW_ROWS])
    assert rows_of_pairs(face, position) == [(11, 5), (21, FEW_ROWS)]
    assert faces_with_few_rows(face, position) == {0: 5}


def test_scattered_pairs_have_no_rows() -> None:
    position = np.random.default_rng(5).random((40, 2))
    assert rows_of_pairs(np.zeros(40, dtype=int), position) == []
    assert faces_with_few_rows(np.zeros(40, dtype=int), position) == {}


def test_a_line_counts_its_pairs_and_not_its_one_row() -> None:
    for count, few in ((FEW_ROWS, {}), (FEW_ROWS - 1, {0: FEW_ROWS - 1})):
        position = np.column_stack([np.zeros(count), np.linspace(0.0, 0.028, count)])
        assert faces_with_few_rows(np.zeros(count, dtype=int), position) == few
