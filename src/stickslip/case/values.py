"""Values of a case beside the ranges that its sections declare as usual."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pydantic import BaseModel

from stickslip.case.template import quantity_of
from stickslip.core.plausible import OddValue, odd_value

if TYPE_CHECKING:
    from stickslip.case.case import Case


def unusual_values(case: Case) -> tuple[OddValue, ...]:
    """The values of a case outside the usual range of their keys, in the order of the file."""
    return tuple(odd for name, section in _sections(case) for odd in _unusual(name, section))


def _sections(case: Case) -> Iterator[tuple[str, BaseModel]]:
    """(section, its values) and (section.NAME, its values)."""
    for name, value in case.sections.items():
        if isinstance(value, dict):
            yield from ((f"{name}.{entry}", each) for entry, each in value.items())
        elif value is not None:
            yield name, value


def _unusual(name: str, section: BaseModel) -> Iterator[OddValue]:
    for key, value in section:
        quantity = quantity_of(type(section), key)
        if quantity is not None and quantity.usual is not None and isinstance(value, float):
            where = f"{name}.{key}"
            yield from odd_value(f"{where} is", value, quantity.si_unit, quantity.usual, "its unit", where)
