"""The continuous inputs of a case: numbers with a key by which a result can be differentiated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from stickslip.case.case import Case
from stickslip.case.law_constants import LawConstants
from stickslip.case.law_keys import CONSTANT_TABLES
from stickslip.case.template import quantity_of
from stickslip.core.units import Quantity

# Sections that describe the structure, its joint and its loads; the others describe the computation and its files.
PHYSICAL = (
    "geometry", "damper", "material", "bodies", "roughness", "contact_stiffness", "friction", "interfaces", "preload",
    "damping", "excitation", "forces", "base_motion", "unbalance", "static_loads", "pressures", "gravity", "rotation",
)  # fmt: skip
# Keys of these sections on which no motion depends: how the program forms pairs, and strengths of materials.
_WITHOUT_EFFECT = ("search_distance", "edge_tolerance", "gap_tolerance", "fatigue_limit", "tensile_strength")


@dataclass(frozen=True)
class ContinuousKey:
    """A number of a study: its dotted key, its value in SI, and its quantity."""

    path: str
    value: float
    quantity: Quantity

    @property
    def section(self) -> str:
        """The section of the key."""
        return self.path.partition(".")[0]

    @property
    def unit(self) -> str:
        """The unit that texts show; "1" for a pure number."""
        return self.quantity.shown_unit[0] or "1"

    @property
    def shown(self) -> float:
        """The value in this unit."""
        return self.value / self.quantity.shown_unit[1]

    def changed(self, case: Case, shown: float) -> Case:
        """A validated copy of a case with another value, in the unit of :attr:`unit`. Raises StudyFileError."""
        return case.replace({self.path: self.quantity.stored(shown * self.quantity.shown_unit[1])})


def continuous_keys(case: Case) -> Iterator[ContinuousKey]:
    """The numbers of a case that are not zero, in the order of the file."""
    for name, section in case.sections.items():
        if name not in PHYSICAL or section is None:
            continue
        entries = section if isinstance(section, dict) else {"": section}
        for entry, values in entries.items():
            yield from _keys(f"{name}.{entry}" if entry else name, values)


def _keys(path: str, section: Any) -> Iterator[ContinuousKey]:
    for key, value in section:
        if key in CONSTANT_TABLES and isinstance(value, LawConstants):
            yield from _constants(f"{path}.{key}", value)
            continue
        quantity = quantity_of(type(section), key)
        if quantity is not None and isinstance(value, float) and value != 0.0 and key not in _WITHOUT_EFFECT:
            yield ContinuousKey(f"{path}.{key}", value, quantity)


def _constants(path: str, constants: LawConstants) -> Iterator[ContinuousKey]:
    for key, value in constants.values.items():
        declared = constants.declared.get(key)
        if declared is None or declared.quantity is None or not isinstance(value, float) or value == 0.0:
            continue
        yield ContinuousKey(f"{path}.{key}", value, declared.quantity)
