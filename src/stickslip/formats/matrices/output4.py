"""Nastran OUTPUT4 files: text and binary, dense and sparse columns, single and double precision."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.errors import ImportFileError, InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.matrices.coordinates import Matrices, require_plausible
from stickslip.formats.matrices.source import errors_naming, file_bytes, quoted, text_lines

_FORMAT = re.compile(r"(?:1P,?)?(\d+)[ED](\d+)\.\d+", re.IGNORECASE)
_DEFAULT_FORMAT = "1P,5E16.9"
_STRING_ROWS = 65536  # a short string header packs its length and its first row into one word
# The length of the first record of a binary file gives its byte order and the bytes of a word.
_FIRST_RECORDS = {b"\x18\0\0\0": ("<", 4), b"\0\0\0\x18": (">", 4), b"\x30\0\0\0": ("<", 8), b"\0\0\0\x30": (">", 8)}


@dataclass
class _Header:
    """One matrix: size, precision, and whether strings of a column carry long headers ("bigmat")."""

    name: str
    columns: int
    rows: int
    kind: int
    long_strings: bool

    @property
    def words(self) -> int:
        """Words of one number: types 1 (real) and 3 (complex) are of single, 2 and 4 of double precision."""
        return 1 if self.kind in (1, 3) else 2

    def entries(self, numbers: FloatArray) -> Any:
        """The entries from numbers; real and imaginary parts of a complex matrix alternate."""
        if self.kind <= 2:
            return numbers
        if len(numbers) % 2:
            raise InputError(f'a string of the complex matrix "{self.name}" has {len(numbers)} numbers.')
        return numbers[::2] + 1j * numbers[1::2]


def output4(path: Path) -> Matrices:
    """All matrices of an OUTPUT4 file by name (KGG, MGG ...).

    A column is dense, or a list of strings, each with its first row. Text files have fixed columns (``1P,5E16.9`` or
    the like); binary files are Fortran records with words of 32 or 64 bits, of either byte order. Raises
    ImportFileError, which names the line or the byte, for damaged headers and columns, and files that end early.

    Source: MSC Nastran DMAP Programmer's Guide, module OUTPUT4, data formats.
    """
    content = file_bytes(path)
    if content[:4] in _FIRST_RECORDS:
        return _all_matrices(path, _BinaryFile(path, content))
    return _all_matrices(path, _TextFile(path, text_lines(path)))


def _all_matrices(path: Path, file: _TextFile | _BinaryFile) -> Matrices:
    matrices: Matrices = {}
    while not file.at_end:
        header = file.header()
        require_plausible(path, header.rows, file.remaining)
        require_plausible(path, header.columns, file.remaining)
        if header.name in matrices:
            raise ImportFileError(f'"{path}" contains two matrices "{header.name}"; remove one.')
        matrices[header.name] = _matrix(path, file, header)
    if not matrices:
        raise ImportFileError(f'"{path}" contains no matrix.')
    return matrices


def _matrix(path: Path, file: _TextFile | _BinaryFile, header: _Header) -> Any:
    rows, columns, values = [], [], []
    previous = 0
    for column, first_row, numbers in file.columns(header):
        with errors_naming(path):
            part = header.entries(numbers)
        if not previous <= column <= header.columns or column < 1:
            raise ImportFileError(f'"{path}", {file.place}: column {column} of "{header.name}" is out of order.')
        if first_row < 1 or first_row - 1 + len(part) > header.rows:
            raise ImportFileError(
                f'"{path}", {file.place}: column {column} of "{header.name}" has rows {first_row} to '
                f"{first_row - 1 + len(part)}, but the matrix has {header.rows}."
            )
        previous = column
        rows.append(np.arange(first_row - 1, first_row - 1 + len(part)))
        columns.append(np.full(len(part), column - 1))
        values.append(part)
    if not values:
        return scipy.sparse.csr_matrix((header.rows, header.columns))
    row, column_of, data = (np.concatenate(part) for part in (rows, columns, values))
    key = row.astype(np.int64) * header.columns + column_of
    if len(np.unique(key)) != len(key):
        raise ImportFileError(f'"{path}": an entry of "{header.name}" occurs twice; each must occur once.')
    return scipy.sparse.csr_matrix((data, (row, column_of)), shape=(header.rows, header.columns))


def _checked_header(path: Path, place: str, numbers: list[int], name: str) -> _Header:
    columns, rows, form, kind = numbers
    clean = name.strip().upper()
    if columns < 1 or rows == 0 or not re.fullmatch(r"[A-Z][A-Z0-9]{0,7}", clean):
        raise ImportFileError(
            f'"{path}", {place}: columns {columns}, rows {rows}, form {form}, type {kind}, name "{clean}" is not a '
            "header of an OUTPUT4 matrix."
        )
    if kind not in (1, 2, 3, 4):
        raise ImportFileError(f'"{path}", {place}: matrix "{clean}" is of type {kind}; types are 1 to 4.')
    return _Header(clean, columns, abs(rows), kind, rows < 0 or rows >= _STRING_ROWS)


def _strings(
    path: Path, file: _TextFile | _BinaryFile, header: _Header, column: int, n_words: int
) -> Iterator[tuple[int, int, FloatArray]]:
    """The strings of one sparse column: first row and values of each."""
    used = 0
    while used < n_words:
        if header.long_strings:
            length, row = file.whole_numbers(2)
            length, used = length - 1, used + 2
        else:
            (packed,) = file.whole_numbers(1)
            length, row = divmod(packed, _STRING_ROWS)
            length, used = length - 1, used + 1
        if length < 1 or used + length > n_words or length % header.words:
            raise ImportFileError(f'"{path}", {file.place}: a string of column {column} of "{header.name}" is damaged.')
        used += length
        yield column, row, file.values(length // header.words, header)


class _TextFile:
    """An OUTPUT4 file in text form, read line by line."""

    def __init__(self, path: Path, lines: list[str]) -> None:
        self._path, self._lines, self._next = path, lines, 0
        self._per_line, self._width = 5, 16
        while self._lines and not self._lines[-1].strip():
            self._lines.pop()

    @property
    def place(self) -> str:
        """The position of the reader."""
        return f"line {self._next}"

    @property
    def at_end(self) -> bool:
        """Whether no matrix follows."""
        return self._next >= len(self._lines)

    @property
    def remaining(self) -> int:
        """An upper bound of the entries that follow."""
        return self._per_line * (len(self._lines) - self._next)

    def header(self) -> _Header:
        line = self._line()
        numbers = self._integers(line, 4)
        form = _FORMAT.search(line[40:].strip() or _DEFAULT_FORMAT)
        if form is None or not 1 <= int(form[1]) <= 100 or not 1 <= int(form[2]) <= 100:
            raise ImportFileError(
                f'"{self._path}", {self.place}: "{line[40:].strip()[:40]}" must be a format such as 1P,5E16.9.'
            )
        self._per_line, self._width = int(form[1]), int(form[2])
        return _checked_header(self._path, self.place, numbers, line[32:40])

    def columns(self, header: _Header) -> Iterator[tuple[int, int, FloatArray]]:
        while True:
            column, row, count = self._integers(self._line(), 3)
            if column > header.columns:
                self._next += -(-max(count, 0) // self._per_line)  # a closing column with one value ends the matrix
                return
            if count < 1:
                raise ImportFileError(f'"{self._path}", {self.place}: column {column} has {count} words.')
            if row > 0:
                yield column, row, self.values(count, header)  # text counts the numbers of a dense column, not words
            else:
                yield from _strings(self._path, self, header, column, count)

    def whole_numbers(self, count: int) -> list[int]:
        return self._integers(self._line(), count)

    def values(self, count: int, header: _Header) -> FloatArray:
        n_lines = -(-count // self._per_line)
        words: list[str] = []
        for _ in range(n_lines):
            line = self._line().rstrip()
            words += [
                line[i : i + self._width] for i in range(0, min(len(line), self._per_line * self._width), self._width)
            ]
        try:
            numbers = np.array([word.replace("D", "E") for word in words], dtype=float)
        except ValueError as problem:
            raise ImportFileError(
                f'"{self._path}", lines {self._next - n_lines + 1} to {self._next}: {problem}; values of '
                f'"{header.name}" must be numbers in {self._width} columns.'
            ) from problem
        if len(numbers) != count:
            raise ImportFileError(
                f'"{self._path}", lines {self._next - n_lines + 1} to {self._next}: {len(numbers)} values of '
                f'"{header.name}", but the file announces {count}.'
            )
        return numbers

    def _line(self) -> str:
        if self._next >= len(self._lines):
            raise ImportFileError(f'"{self._path}" ends in line {self._next}, in the middle of a matrix.')
        self._next += 1
        return self._lines[self._next - 1]

    def _integers(self, line: str, count: int) -> list[int]:
        words = [line[8 * i : 8 * i + 8].strip() for i in range(count)]
        if count == 1:
            words = [line.strip()]  # a packed string header may take more than eight columns
        if not all(re.fullmatch(r"-?\d{1,12}", word) for word in words):
            raise ImportFileError(
                f'"{self._path}", {self.place}: {quoted(line)} must begin with {count} whole numbers in columns '
                "of 8. Is the file complete?"
            )
        return [int(word) for word in words]


class _BinaryFile:
    """An OUTPUT4 file as Fortran records: length, content, length."""

    def __init__(self, path: Path, content: bytes) -> None:
        self._path, self._content, self._next = path, content, 0
        self._order, self._word = _FIRST_RECORDS[content[:4]]
        self._record = b""
        self._used = 0

    @property
    def place(self) -> str:
        """The position of the reader."""
        return f"byte {self._next}"

    @property
    def at_end(self) -> bool:
        """Whether no matrix follows."""
        return self._next >= len(self._content)

    @property
    def remaining(self) -> int:
        """An upper bound of the entries that follow."""
        return (len(self._content) - self._next) // 4

    def header(self) -> _Header:
        self._read_record()
        numbers = self.whole_numbers(4)
        name = self._read_bytes(2 * self._word).decode("latin-1")
        header = _checked_header(self._path, self.place, numbers, name)
        if self._word == 8 and header.words == 2:
            raise ImportFileError(
                f'"{self._path}", {self.place}: matrix "{header.name}" is of type {header.kind} (double precision) in '
                "words of 64 bits, a layout that stickslip does not read. Write it in single precision or as text."
            )
        return header

    def columns(self, header: _Header) -> Iterator[tuple[int, int, FloatArray]]:
        while True:
            self._read_record()
            column, row, count = self.whole_numbers(3)
            if column > header.columns:
                return
            if count < 1:
                raise ImportFileError(f'"{self._path}", {self.place}: column {column} has {count} words.')
            if row > 0:
                if count % header.words:
                    raise ImportFileError(
                        f'"{self._path}", {self.place}: column {column} has {count} words, which is not a whole number '
                        f"of values of {header.words} words. The file is damaged; write it again."
                    )
                yield column, row, self.values(count // header.words, header)
            else:
                yield from _strings(self._path, self, header, column, count)

    def whole_numbers(self, count: int) -> list[int]:
        return [
            int(number) for number in np.frombuffer(self._read_bytes(self._word * count), f"{self._order}i{self._word}")
        ]

    def values(self, count: int, header: _Header) -> FloatArray:
        width = self._word * header.words
        return np.frombuffer(self._read_bytes(width * count), dtype=f"{self._order}f{width}").astype(float)

    def _read_record(self) -> None:
        start = self._next
        length = self._length(start)
        stop = start + 4 + length
        if length < 0 or stop + 4 > len(self._content) or self._length(stop) != length:
            raise ImportFileError(
                f'"{self._path}", byte {start}: a record of {length} bytes does not end at its announced length; the '
                "file is damaged, incomplete, or was transferred as text."
            )
        self._record, self._used, self._next = self._content[start + 4 : stop], 0, stop + 4

    def _length(self, start: int) -> int:
        part = self._content[start : start + 4]
        return int(np.frombuffer(part, dtype=f"{self._order}i4")[0]) if len(part) == 4 else -1

    def _read_bytes(self, size: int) -> bytes:
        if self._used + size > len(self._record):
            raise ImportFileError(f'"{self._path}", {self.place}: a record is shorter than it announces.')
        self._used += size
        return self._record[self._used - size : self._used]
