"""The data that a sweep stores beside its table: study, keys and cases, so that it can be extended and shown again.

``DIR/sweep.json`` is written with the table and sealed. A sweep into a folder with this file adds its cases to those of
the table (:func:`extended`); ``stickslip report`` reads keys and cases from it (``sweeps/again.py``).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from stickslip.case.case import Case
from stickslip.case.key_kinds import UNSWEPT_SECTIONS, kind_of_key
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.results.sweep_table import SweptKey, Value
from stickslip.sweeps.axes import key_with_values, single_value
from stickslip.sweeps.folder import read_sealed, write_sealed

SWEEP_FILE = "sweep.json"
_SUBJECT = "sweep, layout 1"  # another layout of the file needs another number
_SHOWN_KEYS = 6  # chosen: keys of a message
Rows = tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class StoredCase:
    """A case of the table: name of its folder, hash of its inputs and version, excitation force in N, values."""

    name: str
    key: str
    force_n: float
    values: tuple[Value, ...]


@dataclass(frozen=True)
class SweepRecord:
    """Study and keys of a sweep, and all cases of its table.

    ``text`` is the study file of the base case, ``changed`` its keys that differ from their defaults, ``inputs`` its
    sections.
    """

    title: str
    text: str
    changed: tuple[str, ...]
    inputs: Mapping[str, Any]
    keys: tuple[SweptKey, ...]
    cases: tuple[StoredCase, ...]


def store_record(folder: Path, record: SweepRecord) -> None:
    """Write the record of a sweep, completely or not at all. Raises ResultsFileError."""
    write_sealed(folder / SWEEP_FILE, _SUBJECT, asdict(record))


def read_record(folder: Path) -> SweepRecord | None:
    """The record of the sweep in a folder, None if there is none. Raises ResultsFileError for a damaged one."""
    if not (folder / SWEEP_FILE).exists():
        return None
    try:
        entries = read_sealed(folder / SWEEP_FILE, _SUBJECT)
    except ResultsFileError as error:
        raise ResultsFileError(f"{error} Use another folder, or delete this file to begin a new table.") from error
    keys = tuple(SweptKey(**{name: _frozen(value) for name, value in key.items()}) for key in entries["keys"])
    cases = tuple(StoredCase(**{name: _frozen(value) for name, value in case.items()}) for case in entries["cases"])
    return SweepRecord(entries["title"], entries["text"], tuple(entries["changed"]), entries["inputs"], keys, cases)


def extended(folder: Path, case: Case, keys: tuple[SweptKey, ...]) -> tuple[tuple[SweptKey, ...], Rows]:
    """Keys and rows of the table that contains the sweep in ``folder`` and all combinations of ``keys``.

    A row is the position of its value of each key. A key that one of the two sweeps does not vary has there the value
    of its study. Raises InputError if the studies differ in another key, ResultsFileError for a damaged record.
    """
    new = tuple(itertools.product(*(range(len(key.values)) for key in keys)))
    earlier = read_record(folder)
    if earlier is None:
        return keys, new
    names = tuple(dict.fromkeys(key.name for key in (*earlier.keys, *keys)))
    inputs = case.to_dict()
    _require_same_study(earlier.inputs, inputs, names, folder)
    chosen = ({key.name: key.values[place] for key, place in zip(keys, row, strict=True)} for row in new)
    stored = (dict(zip((key.name for key in earlier.keys), each.values, strict=True)) for each in earlier.cases)
    rows = [*_values(stored, names, earlier.inputs, case), *_values(chosen, names, inputs, case)]
    merged = tuple(
        key_with_values(name, kind_of_key(name, case), _ordered(row[place] for row in rows))
        for place, name in enumerate(names)
    )
    places = {tuple(key.values.index(value) for key, value in zip(merged, row, strict=True)) for row in rows}
    return merged, tuple(sorted(places))


def _values(
    rows: Iterable[Mapping[str, Value]], names: tuple[str, ...], inputs: Mapping[str, Any], case: Case
) -> list[tuple[Value, ...]]:
    """The value of each key in each row: its own, else that of the study with these ``inputs``."""
    return [tuple(row[name] if name in row else _value_of_study(name, inputs, case) for name in names) for row in rows]


def _value_of_study(name: str, inputs: Mapping[str, Any], case: Case) -> Value:
    value: Any = inputs
    for part in filter(None, Case.parts_of_key(name)):
        value = value.get(part) if isinstance(value, Mapping) else None
    if value is None:
        raise InputError(
            f"{name} varies in one of the two sweeps of this folder, and the study of the other does not contain it. "
            f"Give the key a value in the study file, or use another folder.",
            (name,),
        )
    return single_value(name, kind_of_key(name, case), value)


def _ordered(values: Iterable[Value]) -> list[Value]:
    """Each value once: numbers by size, words in the order of their first use."""
    once = list(dict.fromkeys(values))
    return once if any(isinstance(value, str) for value in once) else sorted(once, key=float)


def _require_same_study(
    earlier: Mapping[str, Any], inputs: Mapping[str, Any], swept: tuple[str, ...], folder: Path
) -> None:
    """Raise InputError unless the inputs are equal in all keys that change a result and do not vary."""
    before, now = (_flat(each) for each in (earlier, inputs))
    names = sorted(name for name in before.keys() | now.keys() if before.get(name) != now.get(name))
    differing = [name for name in names if name not in swept and name.split(".")[0] not in UNSWEPT_SECTIONS]
    if differing:
        shown = "; ".join(
            f"{name} = {before.get(name, 'absent')} there, {now.get(name, 'absent')} here"
            for name in differing[:_SHOWN_KEYS]
        )
        more = f"; and {len(differing) - _SHOWN_KEYS} further keys" if len(differing) > _SHOWN_KEYS else ""
        raise InputError(
            f'the folder "{folder}" contains a sweep of another study: {shown}{more}. Use another folder, vary this '
            f'key too, or delete "{SWEEP_FILE}" in the folder to begin a new table.',
            tuple(differing),
        )


def _flat(inputs: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Full name of each key -> value."""
    flat: dict[str, Any] = {}
    for name, value in inputs.items():
        flat |= _flat(value, f"{above}{name}.") if isinstance(value, Mapping) else {f"{above}{name}": _thawed(value)}
    return flat


def _thawed(value: Any) -> Any:
    """A value as JSON returns it."""
    if isinstance(value, list | tuple):
        return [_thawed(each) for each in value]
    return None if isinstance(value, float) and math.isnan(value) else value


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
