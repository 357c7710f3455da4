"""Nastran case control: active sets of constraints and loads, and combinations of sets by SPCADD and LOAD."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

from stickslip.formats.meshes.bulk_data import BulkCard, start_of_bulk
from stickslip.formats.meshes.raw_model import RawConstraint, RawLoad, RawModel
from stickslip.formats.meshes.raw_ties import RawEquation

Entry = TypeVar("Entry", RawConstraint, RawLoad, RawEquation)

_SELECTION = re.compile(r"\s*(?P<what>SPC|LOAD|MPC)\s*=\s*(?P<number>\d+)\s*", re.IGNORECASE)
_ENTRIES = {"SPC": "SPC or SPC1", "LOAD": "FORCE", "MPC": "MPC"}
_COMBINATION = {"SPC": "SPCADD", "LOAD": "LOAD", "MPC": "MPCADD"}


@dataclass(frozen=True)
class CaseControl:
    """The part before BEGIN BULK: whether it exists, and all sets that it selects, by SPC, LOAD and MPC."""

    exists: bool
    selected: Mapping[str, tuple[int, ...]]

    @classmethod
    def of(cls, lines: list[str]) -> CaseControl:
        """The case control of a file with these lines; comments ($) are omitted."""
        end = start_of_bulk(lines)
        selected: dict[str, tuple[int, ...]] = {}
        for line in lines[:end]:
            match = _SELECTION.fullmatch(line.partition("$")[0])
            if match:
                what = match["what"].upper()
                selected[what] = tuple(dict.fromkeys((*selected.get(what, ()), int(match["number"]))))
        return cls(end > 0, selected)

    def ties_nodes(self) -> bool:
        """Whether multipoint constraints of the bulk data act; without case control this is an assumption."""
        return not self.exists or "MPC" in self.selected


def active_entries(
    raw: RawModel,
    case: CaseControl,
    what: str,
    sets: Mapping[int, list[Entry]],
    combined: Mapping[int, BulkCard],
) -> list[Entry]:
    """Constraints ("SPC"), equations ("MPC") or forces ("LOAD") of the first set that the case control selects, else
    of all sets.

    ``sets`` contains them by the number of their set, ``combined`` the SPCADD, MPCADD or LOAD cards. Raises
    ImportFileError for a selected or combined set of constraints that has no entries; for one of loads it adds a
    message, because the set may contain loads of other kinds.
    """
    chosen = case.selected.get(what, ())
    if not chosen:
        if len(sets) > 1 or (sets and case.exists) or combined:
            no_sum = f", without the factors of {_COMBINATION[what]} {next(iter(combined))}" if combined else ""
            numbers = ", ".join(map(str, sets))
            used = f"the entries of all {len(sets)} sets ({numbers}) together" if len(sets) > 1 else f"set {numbers}"
            raw.messages.append(f"the case control selects no {what}, so stickslip uses {used}{no_sum}.")
        return [entry for entries in sets.values() for entry in entries]
    if len(chosen) > 1:
        raw.messages.append(
            f"the case control selects {what} = {', '.join(map(str, chosen))} in several subcases; stickslip uses "
            f"{chosen[0]}."
        )
    if chosen[0] in combined:
        return list(_combination(raw, what, sets, combined[chosen[0]]))
    if chosen[0] not in sets:
        _report_missing_set(raw, what, f"the case control selects {what} = {chosen[0]}, but", chosen[0], 0)
    return sets.get(chosen[0], [])


def _combination(raw: RawModel, what: str, sets: Mapping[int, list[Entry]], card: BulkCard) -> Iterator[Entry]:
    """Entries of the sets that SPCADD or MPCADD names, or of those of LOAD times the factor of each and the common
    factor."""
    if what != "LOAD":
        parts = [(1.0, number) for number in card.numbers(1)]
    else:
        last = max((at for at, word in enumerate(card.fields) if word), default=0)
        parts = [(card.real(1) * card.real(at), card.integer(at + 1)) for at in range(2, max(last, 3) + 1, 2)]
    if not parts:
        card.fail("it has no set number.")
    for factor, number in parts:
        if number not in sets:
            _report_missing_set(
                raw, what, f"{card.name} {card.integer(0)} names the set {number}, but", number, card.line
            )
        for entry in sets.get(number, []):
            yield entry.scaled(factor)


def _report_missing_set(raw: RawModel, what: str, words: str, number: int, line: int) -> None:
    sentence = f"{words} there are no {_ENTRIES[what]} entries of set {number}"
    if what != "LOAD":
        raw.fail(f"{sentence}. Add them, or select another set.", line)
    raw.messages.append(f"{sentence}; stickslip reads no loads of other kinds.")
