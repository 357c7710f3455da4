"""Matrices as text, one entry a line: row, column, value, counted from 1 (CalculiX, Matrix Market)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.matrices.source import quoted, text_lines
from stickslip.structure.mesh import IntArray

Matrices = dict[str, Any]

# More rows than this with fewer entries than rows is a damaged size, not a model.
_PLAUSIBLE_SIZE = 1_000_000


def number_table(path: Path, lines: Sequence[str], first_line: int, width: int) -> tuple[FloatArray, IntArray]:
    """Numbers (k, width) of the lines that are not blank, and the number (k,) of each line in the file.

    ``first_line`` is the number of the first of ``lines``. Raises ImportFileError that names the line.
    """
    where = np.array([i for i, line in enumerate(lines) if line and not line.isspace()], dtype=np.int64)
    if not where.size:
        return np.empty((0, width)), where
    numbers = first_line + where
    try:
        table = np.loadtxt(lines, ndmin=2, comments=None)
    except ValueError as problem:
        _name_bad_line(path, lines, numbers, first_line, width)
        raise ImportFileError(
            f'"{path}" could not be read as a table of {width} numbers on each line: {problem}.'
        ) from problem
    if table.shape != (len(where), width):
        _name_bad_line(path, lines, numbers, first_line, width)
        raise ImportFileError(f'"{path}" must have {width} numbers on each line.')
    return table, numbers


def _name_bad_line(path: Path, lines: Sequence[str], numbers: IntArray, first_line: int, width: int) -> None:
    """Raise ImportFileError for the first line that is no row of ``width`` numbers, if there is one."""
    for number in numbers:
        line = lines[number - first_line]
        words = line.split()
        shown = quoted(line)
        if len(words) != width:
            raise ImportFileError(
                f'"{path}", line {number}: {shown} has {len(words)} words, but each line must have {width} numbers. '
                "Is the file complete?"
            )
        for word in words:
            try:
                float(word)
            except ValueError as problem:
                what = f'"{word[:40]}" in {shown}' if shown.startswith('"') else shown
                raise ImportFileError(f'"{path}", line {number}: {what} is not a number.') from problem


def coordinate_matrix(path: Path, table: FloatArray, lines: IntArray, size: int | None = None) -> Any:
    """csr matrix of the rows ``row, column, value`` (k, 3), as stored; ``size`` rows, or the largest index.

    Raises ImportFileError for an index that is not a whole number or out of range, and for an entry that occurs twice
    (a triangle or a diagonal that counts twice would give a wrong model).
    """
    index = table[:, :2]
    bad = np.flatnonzero(~(np.isfinite(index) & (index == np.floor(index)) & (np.abs(index) < 2**31)).all(axis=1))
    if bad.size:
        raise ImportFileError(
            f'"{path}", line {lines[bad[0]]}: row {index[bad[0], 0]:g} and column {index[bad[0], 1]:g} must be whole '
            "numbers."
        )
    row, column = index.astype(np.int64).T
    size = int(max(row.max(), column.max())) if size is None else size
    bad = np.flatnonzero((np.minimum(row, column) < 1) | (np.maximum(row, column) > size))
    if bad.size:
        raise ImportFileError(
            f'"{path}", line {lines[bad[0]]}: row {row[bad[0]]}, column {column[bad[0]]} is outside 1 to {size}; '
            "indices count from 1."
        )
    require_plausible(path, size, len(table))
    key = (row - 1) * size + column - 1
    order = np.argsort(key, kind="stable")
    twice = np.flatnonzero(np.diff(key[order]) == 0)
    if twice.size:
        first, second = order[twice[0]], order[twice[0] + 1]
        raise ImportFileError(
            f'"{path}": entry {row[first]}, {column[first]} is in two lines, {lines[first]} and {lines[second]}; '
            "each entry must occur once."
        )
    return scipy.sparse.csr_matrix((table[:, 2], (row - 1, column - 1)), shape=(size, size))


def require_plausible(path: Path, size: int, entries: int) -> None:
    """Raise ImportFileError for a size that only a damaged file has, before memory is allocated."""
    if size < 1 or (size > _PLAUSIBLE_SIZE and entries < size):
        raise ImportFileError(f'"{path}" has {size} rows in its header, but only {entries} entries. It is damaged.')


def calculix_matrix(path: Path) -> Matrices:
    """The matrix of a CalculiX ``.sti`` or ``.mas`` file: one triangle, each line row, column, value.

    CalculiX writes them with ``*FREQUENCY, SOLVER=MATRIXSTORAGE``. Raises ImportFileError.
    """
    table, numbers = number_table(path, text_lines(path), 1, 3)
    if not len(table):
        raise ImportFileError(f'"{path}" has no entries.')
    matrix = one_triangle(path, coordinate_matrix(path, table, numbers))
    on_diagonal = table[table[:, 0] == table[:, 1], 0].astype(np.int64)
    if len(on_diagonal) != matrix.shape[0]:
        row = np.setdiff1d(np.arange(1, matrix.shape[0] + 1), on_diagonal)[0]
        raise ImportFileError(
            f'"{path}" lacks the diagonal entry {row}, {row}; CalculiX stores all of them, also zeros, so the file '
            "is not complete."
        )
    return {"": matrix}


def one_triangle(path: Path, matrix: Any) -> Any:
    """``matrix`` after checking that it has entries on one side of the diagonal only; raises ImportFileError."""
    if scipy.sparse.tril(matrix, -1).nnz and scipy.sparse.triu(matrix, 1).nnz:
        entries = matrix.tocoo()
        below, above = (np.flatnonzero(side)[0] for side in (entries.row > entries.col, entries.row < entries.col))
        raise ImportFileError(
            f'"{path}" is a symmetric matrix and must contain one triangle, but it has entries on both sides of '
            f"the diagonal: {entries.row[below] + 1}, {entries.col[below] + 1} and {entries.row[above] + 1}, "
            f"{entries.col[above] + 1}."
        )
    return matrix


def matrix_market(path: Path) -> Matrices:
    """The matrix of a Matrix Market file: coordinate or array, real or integer, general or symmetric.

    Raises ImportFileError, which names the line, for other kinds, for a number of entries that the header does not
    promise, and for entries that are out of range, occur twice, or are in both triangles of a symmetric matrix.

    Source: R. F. Boisvert, R. Pozo, K. A. Remington, The Matrix Market exchange formats, NISTIR 5935 (1996).
    """
    lines = text_lines(path)
    words = lines[0].lower().split()
    allowed = (("%%matrixmarket",), ("matrix",), ("coordinate", "array"), ("real", "integer"), ("general", "symmetric"))
    if len(words) != 5 or any(word not in choices for word, choices in zip(words, allowed, strict=True)):
        header = f'"{lines[0][:80]}"' if lines[0].startswith("%%") else "the content"
        raise ImportFileError(
            f'"{path}", line 1: {header} must read "%%MatrixMarket matrix", then coordinate or array, then '
            "real or integer, then general or symmetric. Complex, pattern and skew matrices are not allowed."
        )
    coordinate, symmetric = words[2] == "coordinate", words[4] == "symmetric"
    start = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("%")), len(lines))
    promised, _ = number_table(path, lines[start : start + 1], start + 1, 3 if coordinate else 2)
    if not len(promised):
        raise ImportFileError(f'"{path}" ends before the line with its size.')
    if (
        not (np.abs(promised) < 2**40).all()
        or (promised != np.floor(promised)).any()
        or promised[0, 0] != promised[0, 1]
    ):
        raise ImportFileError(f'"{path}", line {start + 1}: {quoted(lines[start])} is not the size of a square matrix.')
    size = int(promised[0, 0])
    table, numbers = number_table(path, lines[start + 1 :], start + 2, 3 if coordinate else 1)
    full = size * (size + 1) // 2 if symmetric else size * size
    expected = int(promised[0, 2]) if coordinate else full
    if len(table) != expected:
        raise ImportFileError(f'"{path}" announces {expected} entries in line {start + 1}, but it has {len(table)}.')
    require_plausible(path, size, len(table))
    if coordinate:
        matrix = coordinate_matrix(path, table, numbers, size)
        return {"": one_triangle(path, matrix) if symmetric else matrix}
    if not symmetric:
        return {"": table.reshape(size, size).T}
    dense = np.zeros((size, size))
    dense.T[np.triu_indices(size)] = table[:, 0]  # the lower triangle, column by column
    return {"": dense}
