"""The cards of Nastran bulk data: fields of small, large and free format, continued lines joined."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NoReturn

from stickslip.formats.meshes.raw_model import LARGEST_LABEL, LinePositions

# A line of 20 characters can name a million grids; this is five sets of all grids of the largest solved meshes.
MOST_IN_RANGES = 5_000_000
_REPEATED = re.compile(r"=\(?(?P<count>\d{1,9})\)?")
_STEP = re.compile(r"\*\(?(?P<step>[^()]+)\)?")
_EXPONENT = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))([-+]\d+)")  # 1.5-3 is 1.5e-3


@dataclass
class RemainingRanges:
    """Limit on the numbers that further ranges of a deck may name."""

    count: int = MOST_IN_RANGES


@dataclass
class BulkCard:
    """One entry: its name in capitals, its fields from the second on, blank ones as "", and its line.

    ``places`` maps ``line`` to its file and line; all entries of a deck have the same ``ranges``.
    """

    places: LinePositions
    name: str
    fields: list[str]
    line: int
    ranges: RemainingRanges

    def fail(self, sentence: str) -> NoReturn:
        """Raise ImportFileError that names the file, the line and the card."""
        self.places.fail(f"{self.name}: {sentence}", self.line)

    def where(self) -> str:
        """Its line for a message, with its file unless it is the deck itself."""
        return self.places.words(self.line)

    def word(self, position: int) -> str:
        """A field, counted from 0 after the name; "" beyond the last one."""
        return self.fields[position] if position < len(self.fields) else ""

    def integer(self, position: int, default: int | None = None) -> int:
        """A number of at least 0; raises ImportFileError for anything else, or if it is blank without a default."""
        word = self.word(position)
        if not word and default is not None:
            return default
        if not word.isdecimal() or int(word) >= LARGEST_LABEL:
            self.fail(f'field {position + 2} is "{word[:24]}", not a whole number from 0 to {LARGEST_LABEL - 1}.')
        return int(word)

    def real(self, position: int, default: float | None = None) -> float:
        """A finite number; raises ImportFileError for anything else, or if it is blank without a default."""
        word = self.word(position)
        if not word and default is not None:
            return default
        text = word.upper().replace("D", "E")
        match = _EXPONENT.fullmatch(text)
        try:
            value = float(f"{match[1]}e{match[2]}" if match else text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or "_" in word:
            self.fail(f'field {position + 2} is "{word[:24]}", not a number.')
        return value

    def numbers(self, start: int) -> list[int]:
        """Whole numbers of the fields from ``start`` on without blanks; ``a THRU b`` gives a and all up to b."""
        answer: list[int] = []
        words = [(position, word) for position, word in enumerate(self.fields) if position >= start and word]
        through = False
        for position, word in words:
            if word.upper() == "THRU":
                through = True
                continue
            value = self.integer(position)
            if through and answer:
                self.ranges.count -= max(value - answer[-1], 0)
                if self.ranges.count < 0:
                    self.fail(
                        f"{answer[-1]} THRU {value} is too long: the ranges of the deck contain more than "
                        f"{MOST_IN_RANGES} numbers in total, the limit."
                    )
                answer += range(answer[-1] + 1, value)
            through = False
            answer.append(value)
        return answer


def start_of_bulk(lines: list[str]) -> int:
    """Number of lines up to BEGIN BULK, which is counted; 0 where there is none."""
    return next((at for at, text in enumerate(lines, start=1) if text.upper().split()[:2] == ["BEGIN", "BULK"]), 0)


def ends_bulk(line: str) -> bool:
    """Whether a line is ENDDATA."""
    return line.strip().upper().startswith("ENDDATA")


def read_bulk(lines: list[str], places: LinePositions) -> Iterator[BulkCard]:
    """Cards of bulk data, from BEGIN BULK (or the first line) to ENDDATA, each with its continuation lines joined.

    Lines that replicate the entry above them ("=,*1,=,*10.,==" and "=4") give their entries. Raises ImportFileError for
    a continuation or a replication without an entry, for replicated entries of several lines, and where a second part
    of bulk data begins.
    """
    start = start_of_bulk(lines)
    card: BulkCard | None = None
    ranges = RemainingRanges()
    pattern: list[str] = []  # the fields of the last line that replicates an entry
    for number, text in enumerate(lines[start:], start=start + 1):
        line = text.split("$")[0].rstrip()
        if not line.strip():
            continue
        if ends_bulk(line):
            break
        name, fields = _split(line)
        if name.startswith("="):
            if card is None:
                places.fail("a line that replicates an entry (=) is before the first entry.", number)
            pattern = fields if name == "=" else pattern
            for _ in range(_number_of_replicas(card, name, pattern, number)):
                yield card
                card = _replica(card, pattern, number)
            continue
        if name in ("", "+", "*") or name[:1] in "+*":
            if card is None:
                places.fail("a continuation line is before the first entry.", number)
            card.fields += fields
            continue
        if line.split()[0].upper() == "BEGIN":
            places.fail(
                f'"{line.strip()[:40]}" begins a second part of bulk data (a superelement or another deck), which is '
                "not read. Put all entries after one BEGIN BULK.",
                number,
            )
        if card is not None:
            yield card
        card = BulkCard(places, name.rstrip("*").upper(), fields, number, ranges)
    if card is not None:
        yield card


def _number_of_replicas(card: BulkCard, name: str, pattern: list[str], line: int) -> int:
    """Of a line with "=" 1, of a line with "=4" or "=(4)" 4; raises ImportFileError for anything else."""
    if name == "=":
        return 1
    match = _REPEATED.fullmatch(name)
    if not match or not pattern:
        card.places.fail(
            f'{card.name}: the line "{name[:16]}" does not replicate an entry. Write =,*1,=,*10.,== and below it =4 '
            "for 4 more entries, or write each entry out.",
            line,
        )
    count = int(match["count"])
    card.ranges.count -= count
    if card.ranges.count < 0:
        card.places.fail(
            f"{card.name}: {name} replicates more than {MOST_IN_RANGES} entries, the limit of a deck.", line
        )
    return count


def _replica(card: BulkCard, pattern: list[str], line: int) -> BulkCard:
    """The entry below ``card``: "=" copies a field, "*2" adds 2, "==" copies all others; other words remain."""
    if len(card.fields) > len(pattern):
        card.places.fail(f"{card.name}: an entry of several lines cannot be replicated. Write each entry out.", line)
    fields: list[str] = []
    for position, word in enumerate(pattern):
        if word == "==":
            fields += card.fields[position:]
            break
        step = _STEP.fullmatch(word)
        before = card.word(position)
        if step and _is_whole(before) and _is_whole(step["step"]):
            fields.append(str(int(before) + int(step["step"])))
        elif step:
            steps = replace(card, fields=[before, step["step"]], line=line)
            fields.append(repr(steps.real(0) + steps.real(1)))
        else:
            fields.append(before if word == "=" else word)
    return replace(card, fields=fields, line=line)


def _is_whole(word: str) -> bool:
    return word.removeprefix("-").removeprefix("+").isdecimal()


def _split(line: str) -> tuple[str, list[str]]:
    """Name and data fields of one line: 8 of small or free format, 4 of large format."""
    if "," in line:
        words = [word.strip() for word in line.split(",")]
        count = 4 if words[0].endswith("*") or words[0].startswith("*") else 8
        fields = words[1 : 1 + count]
        return words[0], fields + [""] * (count - len(fields))
    line = line.expandtabs(8)
    name = line[:8].strip()
    width, count = (16, 4) if name.endswith("*") or name.startswith("*") else (8, 8)
    return name, [line[8 + width * at : 8 + width * (at + 1)].strip() for at in range(count)]
