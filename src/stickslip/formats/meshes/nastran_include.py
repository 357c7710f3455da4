"""Nastran decks in several files: the text of each included file replaces its INCLUDE."""

from __future__ import annotations

import os
import re
from pathlib import Path

from stickslip.formats.meshes.bulk_data import ends_bulk
from stickslip.formats.meshes.included_files import IncludedFiles
from stickslip.formats.meshes.raw_model import LinePositions, fail, read_text

_INCLUDE = re.compile(r"\s*INCLUDE\b(?P<name>.*)", re.IGNORECASE)
_LONGEST_STATEMENT = 10  # lines; chosen: in a longer statement the closing quote is missing


def join_files(source: Path, included: IncludedFiles) -> tuple[list[str], LinePositions]:
    """All lines of a deck and of the files that it includes, and the file and line of each.

    ``INCLUDE name`` may be anywhere up to ENDDATA, the name in single, double or no quotes; inside quotes it may
    continue over several lines, whose blanks at both ends do not count. A name is relative to the folder of the file
    that includes, then to that of ``source``.

    Raises ImportFileError, which names file and line, for a statement without a name, a missing file, one that
    ``included`` does not allow, files that include each other in a circle, and entries that follow an included ENDDATA.
    """
    joiner = _Joiner(source, included)
    joiner.take(source, read_text(source), ())
    return joiner.lines, joiner.places


class _Joiner:
    """Joins the lines of the files."""

    def __init__(self, top: Path, included: IncludedFiles) -> None:
        self.lines: list[str] = []
        self.places = LinePositions()
        self._top, self._included = top, included
        self._end: tuple[Path, int] | None = None  # position of ENDDATA

    def take(self, source: Path, text: list[str], path: tuple[Path, ...]) -> None:
        """Append a file; ``path`` are the files that include it, the deck itself first."""
        path = (*path, source)
        self.places.begin(len(self.lines) + 1, source, 1)
        at = 0
        while at < len(text):
            line = text[at]
            self._require_no_entry_after_the_end(source, line, at + 1)
            match = None if self._end else _INCLUDE.match(line)
            if match is None:
                self.lines.append(line)
                at += 1
                if ends_bulk(line) and self._end is None:
                    self._end = source, at
                continue
            name, count = _name_and_lines(source, match["name"], text, at)
            included = self._locate(name, path, at + 1)
            self.take(included, self._included.lines(included, source, at + 1, len(path)), path)
            at += count
            self.places.begin(len(self.lines) + 1, source, at + 1)

    def _require_no_entry_after_the_end(self, source: Path, line: str, number: int) -> None:
        """Text after ENDDATA in its own file is not part of a deck; in a file that includes it, it is an input
        error."""
        if self._end is None or self._end[0] == source or ends_bulk(line):
            return
        if line.partition("$")[0].strip():
            end, end_line = self._end
            fail(
                source,
                f"entries follow, but ENDDATA in line {end_line} of the included file {end} ends the bulk data before. "
                "Remove that ENDDATA.",
                number,
            )

    def _locate(self, name: str, path: tuple[Path, ...], number: int) -> Path:
        """The file that INCLUDE in line ``number`` of the last file of ``path`` names."""
        source = path[-1]
        folders = dict.fromkeys((source.parent, self._top.parent))
        spellings = dict.fromkeys((name, name.replace("\\", "/")))  # decks of Windows are read elsewhere, too
        candidates = [folder / spelling for folder in folders for spelling in spellings]
        readable = [each for each in candidates if self._included.may_read(each)]
        # a file outside the folder is rejected by its name, whether it exists or not
        existing = next((each for each in readable if os.path.exists(each) and not os.path.isdir(each)), None)
        if existing is None and len(readable) < len(candidates):
            return next(each for each in candidates if each not in readable)
        if existing is None:
            fail(
                source,
                f"INCLUDE: there is no file '{name[:200]}' in {' or '.join(str(each) for each in folders)}. Put it "
                "there, or correct the name (upper and lower case differ).",
                number,
            )
        if existing.resolve() in [each.resolve() for each in path]:
            way = " includes ".join(str(each) for each in (*path, existing))
            fail(source, f"INCLUDE: files include each other in a circle: {way}. Remove one INCLUDE.", number)
        return existing


def _name_and_lines(source: Path, rest: str, text: list[str], at: int) -> tuple[str, int]:
    """Name of the file, and number of lines, of a statement with ``rest`` behind the word INCLUDE in ``text[at]``."""
    rest = rest.strip()
    quote = rest[:1]
    if quote not in ("'", '"'):
        words = rest.partition("$")[0].split()
        if len(words) != 1:
            fail(source, f'INCLUDE: "{rest[:60]}" is not the name of one file. Put the name in quotes.', at + 1)
        return words[0], 1
    pieces: list[str] = []
    for count, line in enumerate([rest[1:], *text[at + 1 : at + _LONGEST_STATEMENT]], start=1):
        piece, closing, after = line.partition(quote)
        pieces.append(piece.strip())
        if closing:
            name = "".join(pieces)
            if not name or after.partition("$")[0].strip():
                fail(
                    source,
                    f'INCLUDE: the quotes must contain one file name and end the line, but it has "{name[:60]}'
                    f'" and "{after.strip()[:60]}".',
                    at + count,
                )
            return name, count
    fail(source, f"INCLUDE: the quote that opens here is not closed within {_LONGEST_STATEMENT} lines.", at + 1)
