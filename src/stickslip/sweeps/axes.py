"""Keys of a sweep: ``section.key=values`` becomes a ``SweptKey``, or raises an InputError.

Values are a comma list of single values, written as in a study file, and of ranges ``start:stop:count`` (evenly spaced,
both ends included) or ``start:stop:count:log`` (a constant factor from one to the next).
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.case.case import Case
from stickslip.case.key_kinds import full_key, kind_of_key
from stickslip.core.errors import InputError
from stickslip.core.units import Count, Quantity, Respelled, number_or_text
from stickslip.results.sweep_table import SweptKey, Value

LARGEST_COUNT = 10_000  # chosen: more values of one key are probably an error
_RANGE = "A range is start:stop:count, evenly spaced with both ends, or start:stop:count:log, for example 50:1000:10."
KeyKind = Quantity | Count | tuple[str, ...]  # the last one: the words of a choice
Vary = Mapping[str, str | Sequence[Value]]


def split_options(
    options: Sequence[str],
    option: str = "--vary",
    example: str = "preload.centrifugal_force=100,300",
    case: Case | None = None,
) -> dict[str, str]:
    """Key -> values of texts ``section.key=values``. Raises InputError for another form or a key that comes twice.

    The section may be omitted if no other one, of the ``case`` if it is given, has this key. ``option`` and ``example``
    are for messages.
    """
    varied: dict[str, str] = {}
    for text in options:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not (equals and key and values):
            raise InputError(f'{option} "{text}" must be section.key=values, for example {option} {example}.')
        key = full_key(key, case)
        if key in varied:
            raise InputError(f"{option} {key} is given twice. Give it once, with all its values.")
        varied[key] = values
    return varied


def swept_keys(vary: Vary, case: Case | None = None) -> tuple[SweptKey, ...]:
    """The keys of a sweep with their values; a text holds lists and ranges, a sequence single values.

    The constants of a law can be varied only if the ``case`` has the law.

    Raises InputError for an unknown key, a key without numbers or choices, or values that it does not allow.
    """
    if not vary:
        raise InputError("no key to vary is given. Give at least one, for example preload.centrifugal_force=100,300.")
    return tuple(_swept_key(name, values, case) for name, values in vary.items())


def _swept_key(name: str, values: str | Sequence[Value], case: Case | None) -> SweptKey:
    kind = kind_of_key(name, case)
    if isinstance(values, str):
        parsed = [value for item in values.split(",") for value in _item(name, kind, item.strip())]
    else:
        parsed = [single_value(name, kind, value) for value in values]
    if not parsed:
        raise InputError(f"{name} has no values. Give at least one.", arguments=[name])
    for place, value in enumerate(parsed):
        if value in parsed[:place]:
            raise InputError(
                f"{name} has the value {value_label(kind, value)} twice. Give each value once.", arguments=[name]
            )
    return key_with_values(name, kind, parsed)


def key_with_values(name: str, kind: KeyKind, values: Sequence[Value]) -> SweptKey:
    """A key with its values in SI, also in the units that engineers use."""
    shown = tuple(shown_value(kind, value)[0] for value in values if not isinstance(value, str))
    labels = tuple(value_label(kind, value) for value in values)
    unit = kind.si_unit if isinstance(kind, Quantity) else ""
    return SweptKey(name, unit, tuple(values), shown, shown_value(kind, values[0])[1], labels)


def _item(name: str, kind: KeyKind, item: str) -> list[Value]:
    """The values of one item between commas."""
    if not item:
        raise InputError(
            f"{name} has an empty value between commas. Write for example {name}=100,300,500.", arguments=[name]
        )
    if ":" in item:
        return _range(name, kind, item)
    return [single_value(name, kind, number_or_text(item))]


def single_value(name: str, kind: KeyKind, value: Value) -> Value:
    """One value in SI, after checking that the key allows it. Raises InputError."""
    if isinstance(kind, tuple):
        value = _respelled(name, value)
        if value not in kind:
            nearest = difflib.get_close_matches(str(value).lower(), kind, n=1)
            advice = f' Did you mean "{nearest[0]}"?' if nearest else ""
            raise InputError(
                f"{name} = {value} is not allowed: it must be one of {', '.join(kind)}.{advice}", arguments=[name]
            )
        return value
    try:
        return kind.parse(value.item() if isinstance(value, np.generic) else value)
    except InputError as error:
        raise InputError(f"{name} = {value} {error}", arguments=[name]) from error


def _respelled(name: str, value: Value) -> Value:
    """A word as studies spell it today."""
    _, field = Case.field_of(name.partition(".")[0], name.rpartition(".")[2])
    return next((entry.parse(value) for entry in field.metadata if isinstance(entry, Respelled)), value)


def _range(name: str, kind: KeyKind, item: str) -> list[Value]:
    """The values of ``start:stop:count`` or ``start:stop:count:log``. Raises InputError."""
    statement = f'{name} has the range "{item}"'
    parts = [part.strip() for part in item.split(":")]
    if isinstance(kind, tuple):
        raise InputError(
            f"{statement}, but its value is a choice: {', '.join(kind)}. Give a list of these words.", arguments=[name]
        )
    if len(parts) not in (3, 4) or not all(parts) or (len(parts) == 4 and parts[3] != "log"):
        raise InputError(f"{statement}, which is not valid. {_RANGE}", arguments=[name])
    start, stop = (float(single_value(name, kind, number_or_text(part))) for part in parts[:2])
    if not parts[2].isdecimal() or not 2 <= int(parts[2]) <= LARGEST_COUNT:
        raise InputError(
            f"{statement}, whose count is {parts[2]}: it must be a whole number from 2 to 10000. {_RANGE}",
            arguments=[name],
        )
    if not stop > start:
        raise InputError(
            f"{statement}, whose stop is not above its start. The third number is the count, not a step. {_RANGE}",
            arguments=[name],
        )
    count, logarithmic = int(parts[2]), len(parts) == 4
    if logarithmic and not start > 0:
        raise InputError(
            f"{statement}, but a logarithmic range must start above zero. Start it above zero, or drop :log.",
            arguments=[name],
        )
    spaced = np.geomspace(start, stop, count) if logarithmic else np.linspace(start, stop, count)
    # 15 digits, so that 0.1:0.3:3 contains 0.2 and not 0.19999999999999998; the ends are unchanged
    values = [start, *(float(f"{value:.15g}") for value in spaced[1:-1]), stop]
    if isinstance(kind, Quantity):
        return [*values]
    broken = next((value for value in values if not value.is_integer()), None)
    if broken is not None:
        raise InputError(
            f"{statement}, which contains {broken:g}, but this key requires whole numbers. Choose a count that divides "
            f"{stop - start:g} evenly, or list the numbers: {name}=1,3,5.",
            arguments=[name],
        )
    return [int(value) for value in values]


def shown_value(kind: KeyKind, value: Value) -> tuple[float, str]:
    """A value in the unit that study files show, and this unit; NaN for a choice."""
    if isinstance(value, str):
        return math.nan, ""
    if not isinstance(kind, Quantity):
        return float(value), ""
    number, _, unit = kind.text(float(value)).strip('"').partition(" ")
    return float(number), unit


def value_label(kind: KeyKind, value: Value) -> str:
    """A value in words, such as "500 N"."""
    if isinstance(value, str):
        return value
    number, unit = shown_value(kind, value)
    return f"{number:.6g} {unit}".rstrip()


def study_value(key: SweptKey, place: int) -> Value:
    """Value ``place`` of a key for a study file: with its SI unit and all digits."""
    value = key.values[place]
    return f"{value!r} {key.unit}" if key.unit else value
