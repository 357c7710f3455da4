"""Limits of the INCLUDE statements of a deck: folder, depth, number and size of files."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stickslip.core.errors import ImportFileError
from stickslip.core.input_files import LARGEST_FILE, in_words
from stickslip.formats.meshes.raw_model import fail, read_text

DEEPEST_INCLUDE = 5  # files that include each other
# chosen: decks of whole engines have some hundred files; one file is repeated for each part that uses it.
MOST_FILES = 1000
MOST_REPEATS = 20


class IncludedFiles:
    """The files of one deck. Those outside of its folder (links resolved) are read only where ``outside`` allows it."""

    def __init__(self, deck: Path, outside: bool) -> None:
        self._folder = deck.parent.resolve()
        self._outside = outside
        self._times: Counter[Path] = Counter()
        self._characters = 0
        self._foreign: set[Path] = set()

    def may_read(self, path: Path) -> bool:
        """Whether the deck may read from the folder of a file, which need not exist."""
        return self._outside or self._is_inside(path)

    def lines(self, path: Path, source: Path, number: int, depth: int) -> list[str]:
        """Lines of the file that INCLUDE in line ``number`` of ``source`` names, ``depth`` files below the deck.

        Raises ImportFileError that names ``source`` and the line for a file outside of the deck's folder and where a
        limit is exceeded; that names ``path`` where it cannot be read.
        """
        if not self.may_read(path):
            fail(
                source,
                f"INCLUDE names '{str(path)[:200]}', which is outside of the deck's folder {self._folder}. A deck "
                "from another person could read any file in this way. Copy the file into the folder of the deck or "
                "below; if you trust the deck, use --includes-outside (structure.includes_outside = true in a study).",
                number,
            )
        if depth > DEEPEST_INCLUDE:
            fail(source, f"INCLUDE: files include each other more than {DEEPEST_INCLUDE} deep.", number)
        if not self._is_inside(path):
            self._foreign.add(path)
        self._times[path.resolve()] += 1
        if self._times[path.resolve()] > MOST_REPEATS:
            fail(source, f"INCLUDE reads {path} more than {MOST_REPEATS} times. Remove some.", number)
        if self._times.total() > MOST_FILES:
            fail(source, f"INCLUDE: the deck reads more than {MOST_FILES} files. Join some of them.", number)
        lines = read_text(path)
        self._characters += len(lines) + sum(map(len, lines))
        if self._characters > LARGEST_FILE:
            fail(
                source,
                f"INCLUDE: with {path} the included files have more than {in_words(LARGEST_FILE)} in total, the limit "
                "for a model.",
                number,
            )
        return lines

    @contextmanager
    def hidden_if_foreign(self) -> Iterator[None]:
        """Remove the content of a file outside of the deck's folder from the message of an error about it."""
        try:
            yield
        except ImportFileError as error:
            for path in self._foreign:
                place = re.match(re.escape(str(path)) + r"(, line \d+)?: ", str(error))
                if place:
                    raise ImportFileError(
                        f"{place[0]}this file cannot be read as a part of the deck. It is outside of the deck's "
                        "folder, so the message shows no text of it. Copy it below that folder to see the error."
                    ) from None
            raise

    def _is_inside(self, path: Path) -> bool:
        return path.resolve().is_relative_to(self._folder)
