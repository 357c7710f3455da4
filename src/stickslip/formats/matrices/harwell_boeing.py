"""Harwell-Boeing files, as the command HBMAT of Ansys writes them: real assembled matrices in fixed columns."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import scipy.sparse

from stickslip.core.errors import ImportFileError
from stickslip.formats.matrices.coordinates import Matrices, one_triangle, require_plausible
from stickslip.formats.matrices.source import quoted, text_lines

# (8I10), (4E20.12), (1P,3D25.16), (1P3E25.16), (10F7.1E3): numbers a line, letter, columns of each.
_FORMAT = re.compile(r"^\((?:\d+P,?)?(\d*)([IEDFG])(\d+)(?:\.\d+)?(?:E\d+)?\)$")


def harwell_boeing(path: Path) -> Matrices:
    """The matrix of a Harwell-Boeing file of type RSA (symmetric, one triangle) or RUA (all entries).

    Right-hand sides after the matrix are ignored. Raises ImportFileError, which names the line, for other types
    (complex, pattern, unassembled), damaged headers, column pointers or row numbers, and files that end early.

    Source: I. S. Duff, R. G. Grimes, J. G. Lewis, Users' guide for the Harwell-Boeing sparse matrix collection,
    TR/PA/92/86, CERFACS (1992).
    """
    lines = text_lines(path)
    if len(lines) < 5:
        raise ImportFileError(f'"{path}" ends in line {len(lines)}, within the header of a Harwell-Boeing file.')
    counts = _whole_numbers(path, lines[1], 2, 14, 0)
    kind = lines[2][:3].upper()
    if kind not in ("RSA", "RUA"):
        raise ImportFileError(
            f'"{path}", line 3: the matrix is of type "{kind}", but it must be RSA (real, symmetric, assembled) or RUA '
            "(real, unsymmetric, assembled)."
        )
    rows, columns, entries = _whole_numbers(path, lines[2], 3, 14, 14)[:3]
    if rows != columns:
        raise ImportFileError(f'"{path}", line 3: {rows} rows and {columns} columns; the matrix must be square.')
    require_plausible(path, rows, entries)
    formats = [lines[3][:16], lines[3][16:32], lines[3][32:52]]
    line = 5 if len(counts) > 4 and counts[4] > 0 else 4  # the format of right-hand sides has a line of its own
    parts = []
    for name, form, count in zip(
        ("column pointers", "row numbers", "values"), formats, (rows + 1, entries, entries), strict=True
    ):
        part, line = _block(path, lines, line, form.strip().upper().replace(" ", ""), count, name)
        parts.append(part)
    pointer, index, data = parts[0].astype(np.int64) - 1, parts[1].astype(np.int64) - 1, parts[2]
    if pointer[0] != 0 or pointer[-1] != entries or (np.diff(pointer) < 0).any():
        raise ImportFileError(
            f'"{path}": the column pointers must rise from 1 to {entries + 1}, the number of entries plus 1; they run '
            f"from {pointer[0] + 1} to {pointer[-1] + 1}."
        )
    bad = np.flatnonzero((index < 0) | (index >= rows))
    if bad.size:
        raise ImportFileError(f'"{path}": row number {index[bad[0]] + 1} of entry {bad[0] + 1} is outside 1 to {rows}.')
    matrix = scipy.sparse.csc_matrix((data, index, pointer), shape=(rows, rows))
    if not matrix.has_canonical_format:
        matrix.sum_duplicates()
        if matrix.nnz != entries:
            raise ImportFileError(
                f'"{path}": {entries - matrix.nnz} of {entries} entries occur twice; each must occur once.'
            )
    matrix = scipy.sparse.csr_matrix(matrix)
    return {"": one_triangle(path, matrix) if kind == "RSA" else matrix}


def _whole_numbers(path: Path, line: str, number: int, width: int, start: int) -> list[int]:
    """The numbers in columns of ``width`` from ``start`` on; raises ImportFileError that names the line."""
    words = [line[i : i + width].strip() for i in range(start, len(line.rstrip()), width)]
    if len(words) < 3 or not all(re.fullmatch(r"[+-]?\d{1,12}", word) for word in words):
        raise ImportFileError(
            f'"{path}", line {number}: {quoted(line)} must contain whole numbers in columns of {width}, as the '
            "header of a Harwell-Boeing file does."
        )
    return [int(word) for word in words]


def _block(path: Path, lines: list[str], start: int, form: str, count: int, name: str) -> tuple[np.ndarray, int]:
    """``count`` numbers in the Fortran format ``form`` from line ``start`` (counted from 0) on, and the next line."""
    match = _FORMAT.match(form)
    if match is None or not int(match[3]) or int(match[1] or 1) < 1:
        raise ImportFileError(f'"{path}", line 4: "{form[:30]}" is not a Fortran format such as (8I10) or (4E20.12).')
    per_line, width = int(match[1] or 1), int(match[3])
    n_lines = -(-count // per_line)
    if start + n_lines > len(lines):
        raise ImportFileError(
            f'"{path}" ends in line {len(lines)}, but its {count} {name} need lines {start + 1} to {start + n_lines}.'
        )
    words = [line[i : i + width] for line in lines[start : start + n_lines] for i in range(0, per_line * width, width)]
    words = words[:count]
    try:
        if match[2] == "I":
            return np.array(words, dtype=np.int64).astype(float), start + n_lines
        return np.array([word.replace("D", "E").replace("d", "e") for word in words], dtype=float), start + n_lines
    except ValueError:
        for position, word in enumerate(words):
            if not re.fullmatch(r"\s*[+-]?(\d+\.?\d*|\.\d+)([EDed][+-]?\d+)?\s*", word):
                raise ImportFileError(
                    f'"{path}", line {start + 1 + position // per_line}: "{word.strip()}" among the {name} is not a '
                    f"number in {width} columns ({form})."
                ) from None
        raise ImportFileError(f'"{path}": the {name} from line {start + 1} on are not numbers ({form}).') from None
