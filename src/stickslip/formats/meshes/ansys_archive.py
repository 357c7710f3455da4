"""The commands and blocks of an Ansys archive (.cdb, command CDWRITE), each with its line number.

Source: Ansys Mechanical APDL command reference, CDWRITE, NBLOCK, EBLOCK, CMBLOCK, MPDATA.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from stickslip.formats.meshes.raw_model import LARGEST_LABEL, fail, read_text

_FORMAT = re.compile(
    r"\(\s*(?P<count>\d+)\s*i\s*(?P<whole>\d+)(?:\s*,\s*\d+\s*e\s*(?P<real>\d+)[.\d]*(?:e\d+)?)?\s*\)", re.I
)
_BLOCKS = ("NBLOCK", "EBLOCK", "CMBLOCK")
_LARGEST_WIDTH = 40  # of a field; programs write 8 to 25


@dataclass
class Entry:
    """One command with its words; of a block also the fields of each of its lines."""

    source: Path
    name: str
    words: list[str]
    line: int
    rows: list[tuple[int, list[str]]] = field(default_factory=list)

    def fail(self, sentence: str, line: int = 0) -> NoReturn:
        """Raise ImportFileError that names the file and the line, by default that of the command."""
        fail(self.source, f"{self.name}: {sentence}", line or self.line)

    def word(self, position: int) -> str:
        """A word in capitals, "" where there is none."""
        return self.words[position].upper() if position < len(self.words) else ""

    def label(self, word: str, line: int = 0) -> int:
        """A number of a node, element, type or material; raises ImportFileError for anything else."""
        value = self.whole(word, line)
        if not 0 < value < LARGEST_LABEL:
            self.fail(f'"{word.strip()[:40]}" is not a number of 1 to {LARGEST_LABEL - 1}.', line)
        return value

    def whole(self, word: str, line: int = 0) -> int:
        """A whole number, 0 for a blank; raises ImportFileError for anything else."""
        try:
            return int(word) if word.strip() else 0
        except ValueError:
            self.fail(f'"{word.strip()[:40]}" is not a whole number.', line)

    def number(self, word: str, line: int = 0) -> float:
        """A finite number, 0 for a blank; raises ImportFileError for anything else."""
        try:
            value = float(word) if word.strip() else 0.0
        except ValueError:
            self.fail(f'"{word.strip()[:40]}" is not a number. Parameters are not read: write numbers.', line)
        if not math.isfinite(value) or "_" in word:
            self.fail(f'"{word.strip()[:40]}" is not a finite number.', line)
        return value


def read_archive(source: Path) -> list[Entry]:
    """Commands and blocks in their order. Raises ImportFileError for a block whose format or end is missing."""
    text = read_text(source)
    entries: list[Entry] = []
    at = 0
    while at < len(text):
        line = text[at].split("!", 1)[0].strip()
        at += 1
        if not line[:1].isalpha():  # comments, /commands, *commands and the numbers of blocks that are not read
            continue
        words = [word.strip() for word in line.split(",")]
        entry = Entry(source, words[0].upper(), words[1:], at)
        if entry.name in _BLOCKS:
            at = _read_block(entry, text, at)
        entries.append(entry)
    return entries


def _read_block(entry: Entry, text: list[str], at: int) -> int:
    """Put the lines of a block into its entry; the position of the line after it."""
    form = _FORMAT.match(text[at].replace(" ", "")) if at < len(text) else None
    if form is None:
        entry.fail('the line below must be a format such as "(3i9,6e21.13e3)".')
    n_whole, whole, real = int(form["count"]), int(form["whole"]), int(form["real"] or 0)
    if not (0 < whole <= _LARGEST_WIDTH and real <= _LARGEST_WIDTH and 0 < n_whole <= 40):
        entry.fail(f"the format {form[0]} is not one that Ansys writes.")
    expected = entry.whole(entry.word(2)) if entry.name == "CMBLOCK" else None
    count = 0
    at += 1
    while at < len(text):
        if expected is not None and count >= expected:
            return at
        line = text[at].rstrip()
        if expected is None and (line.strip() == "-1" or line[:1].isalpha()):
            return at if line[:1].isalpha() and not line.upper().startswith("N,") else at + 1
        at += 1
        if line.strip():
            fields = _fields(line, n_whole, whole, real)
            count += len(fields)
            entry.rows.append((at, fields))
    if expected is None or count < expected:
        entry.fail("the file ends inside this block. Write the archive again.")
    return at


def _fields(line: str, n_whole: int, whole: int, real: int) -> list[str]:
    """Fields of fixed width, first whole numbers, then real ones."""
    head = n_whole * whole
    fields = [line[at : at + whole] for at in range(0, min(head, len(line)), whole)]
    return fields + ([line[at : at + real] for at in range(head, len(line), real)] if real else [])
