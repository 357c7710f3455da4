"""The cards of an Abaqus or CalculiX deck: keyword, parameters and data lines, each with its line number."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from stickslip.formats.meshes.included_files import IncludedFiles
from stickslip.formats.meshes.raw_model import fail, read_text
from stickslip.formats.meshes.words import as_label, as_number
from stickslip.structure.cell_kinds import IntArray


@dataclass
class Card:
    """One keyword with its parameters (names in capitals, values as written) and its data lines split at commas.

    ``instance`` is the part instance that it belongs to, if any.
    """

    source: Path
    keyword: str
    parameters: dict[str, str]
    line: int
    data: list[tuple[int, list[str]]] = field(default_factory=list)
    instance: str = ""

    def fail(self, sentence: str, line: int = 0) -> NoReturn:
        """Raise ImportFileError that names the file and the line, by default that of the keyword."""
        where = f" of instance '{self.instance}'" if self.instance else ""
        fail(self.source, f"*{self.keyword}{where}: {sentence}", line or self.line)

    def parameter(self, name: str) -> str:
        """A required parameter; raises ImportFileError if it is missing."""
        value = self.parameters.get(name, "")
        if not value:
            self.fail(f"the parameter {name}= is missing.")
        return value

    def label(self, word: str, line: int) -> int:
        """A node or element number; raises ImportFileError for anything else."""
        return as_label(self.fail, word, line)

    def number(self, word: str, line: int) -> float:
        """A finite number; raises ImportFileError for anything else."""
        return as_number(self.fail, word, line)


# CalculiX reads parameters with and without their blanks.
_WITH_BLANKS = {"REFNODE": "REF NODE", "ROTNODE": "ROT NODE"}
# Labels of nodes or elements of a card: its kind of set, a set or number, and the line.
Find = Callable[[Card, str, str, int], IntArray]


def read_cards(source: Path, included: IncludedFiles) -> list[Card]:
    """Cards of a deck in their order; included files (path relative to the deck) replace *INCLUDE.

    Raises ImportFileError where a file cannot be read, may not be included, or does not start with a keyword.
    """
    return _cards(source, read_text(source), included, 0)


def _cards(source: Path, text: list[str], included: IncludedFiles, depth: int) -> list[Card]:
    cards: list[Card] = []
    lines = enumerate(text, start=1)
    for number, whole in lines:
        line = whole.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*"):
            pieces = [line]
            while pieces[-1].endswith(","):  # parameters continue in the next line
                pieces.append(next(lines, (number, ""))[1].strip())
            card = _keyword(source, number, "".join(pieces).rstrip(","))
            if card.keyword == "INCLUDE":
                path = source.parent / card.parameter("INPUT")
                cards += _cards(path, included.lines(path, source, number, depth + 1), included, depth + 1)
            else:
                cards.append(card)
        elif cards:
            cards[-1].data.append((number, [word.strip() for word in line.split(",")]))
        else:
            # not quoted: it is not an entry of a deck, and may be any file
            fail(source, "the file has text before the first keyword; it is not an Abaqus or CalculiX deck.", number)
    return cards


def _keyword(source: Path, number: int, line: str) -> Card:
    words = line.lstrip("*").split(",")
    parameters = {}
    for word in words[1:]:
        name, _, value = word.partition("=")
        name = " ".join(name.split()).upper()
        parameters[_WITH_BLANKS.get(name, name)] = value.strip().strip('"')
    return Card(source, " ".join(words[0].split()).upper(), parameters, number)
