"""Values of a study file: ``"145 mm"`` or a plain SI number becomes an SI float, or an InputError explains why not.

``Quantity``, ``Count`` and ``Respelled`` annotate the fields of the study file's sections; pydantic calls their
``parse``. The units package (pint) is loaded when the first value with a unit that is not the SI one appears.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from pydantic_core import CoreSchema, core_schema

from stickslip.core.errors import InputError

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|nan|inf))\s*(.*?)\s*")
_UNIT_NAME = r"[A-Za-zµμ%°]+(?:(?:\^|\*\*)[-+]?\d)?"
_PRODUCT = rf"{_UNIT_NAME}(?:\s*\*\s*{_UNIT_NAME}|\s+{_UNIT_NAME})*"
# A product in brackets may end it, "mm^3/(N m)".
_UNIT = re.compile(
    rf"(?:1\s*/\s*)?{_UNIT_NAME}(?:\s*[*/]\s*{_UNIT_NAME}|\s+{_UNIT_NAME})*(?:\s*/\s*\(\s*{_PRODUCT}\s*\))?"
)

# name of the kind -> its SI unit and a value as an engineer would write it
KINDS: dict[str, tuple[str, str]] = {
    "pure number": ("", "0.3"),
    "length": ("m", '"28 mm"'),
    "angle": ("rad", '"30 deg"'),
    "mass": ("kg", '"20 g"'),
    "force": ("N", '"500 N"'),
    "pressure": ("Pa", '"197 GPa"'),
    "density": ("kg/m^3", '"7800 kg/m^3"'),
    "frequency": ("Hz", '"440 Hz"'),
    "stiffness": ("N/m", '"1.3e8 N/m"'),
    "area": ("m^2", '"180 mm^2"'),
    "speed of rotation": ("rad/s", '"3000 rpm"'),
    "time": ("s", '"1e-7 s"'),
    "rate": ("1/s", '"0.5 1/s"'),
    "acceleration": ("m/s^2", '"9.81 m/s^2"'),
    "unbalance": ("kg m", '"2e-6 kg m"'),
    "wear coefficient": ("m^3/J", '"1e-5 mm^3/(N m)"'),
}


LONGEST_UNIT = 60  # pint nests as deep as a unit has factors
LARGEST_INTEGER = 2**63 - 1  # of 64-bit integers in arrays and files
# No measured value is closer to zero without being zero, and squares of smaller numbers underflow. The smallest value
# of a study is G of a nearly smooth face, about 1e-100 m as D approaches 2.
NEGLIGIBLE = 1e-150
# From the adhesion of a single microcontact (1 nN) to the thrust of all rockets together (1e8 N), with room.
LARGEST_FORCE = 1e12
# 1 m2 of ground steel faces under load has 1e14 N/m; more than 1e18 N/m only a wrong unit explains.
LARGEST_STIFFNESS = 1e18
_LARGEST = {"force": LARGEST_FORCE, "stiffness": LARGEST_STIFFNESS}
# A cubic spring that doubles a stiffness of 1e18 N/m within 1e-9 m has 1e36 N/m3; no constant of a law is larger.
LARGEST_CONSTANT = 1e40


@dataclass(frozen=True)
class Quantity:
    """A physical quantity of a study file: its kind, the unit that texts show, and the allowed range in SI.

    kind:
        a key of ``KINDS``, or words of its own with a ``unit``.
    shown:
        unit of written study files; by default the SI unit.
    above, below:
        exclusive bounds; ``at_least``, ``at_most``: inclusive bounds. A nonzero value must not be below ``NEGLIGIBLE``
        in size either.
    usual:
        range of machine parts: values outside are allowed, but a warning says that the unit may be wrong.
    unit_required:
        a sentence why a plain number is rejected, or "" where a plain number is the SI value.
    example:
        a value as messages show it, where the example of the kind would mislead.
    unit:
        SI unit of a kind that ``KINDS`` does not have.
    """

    kind: str
    shown: str = ""
    above: float | None = None
    below: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    unit_required: str = ""
    example: str = ""
    usual: tuple[float, float] | None = None
    unit: str = ""

    @classmethod
    def of_unit(cls, unit: str) -> Quantity:
        """A value in an SI unit: of the kind that has this unit, with its largest size, or else of one that is named
        after it."""
        kind = next((name for name, (si, _) in KINDS.items() if si == unit), None)
        largest = _LARGEST.get(kind or "", LARGEST_CONSTANT)
        if kind is None:
            return cls(f"value in {unit}", at_least=-largest, at_most=largest, example=f'"1 {unit}"', unit=unit)
        return cls(kind, at_least=-largest, at_most=largest)

    @property
    def si_unit(self) -> str:
        """SI unit of the loaded float, "" for a pure number."""
        return KINDS[self.kind][0] if self.kind in KINDS else self.unit

    @property
    def is_si(self) -> bool:
        """Whether the unit is one that can be read and equals its SI unit; that of each kind of ``KINDS`` does."""
        if self.kind in KINDS:
            return True
        return _parsed(self.unit) is not None and math.isclose(_factor_to_si(self.unit), 1.0, rel_tol=1e-12)

    def parse(self, value: object) -> float:
        """The SI value of a number or of a string with a unit. Raises InputError."""
        number, unit = self._split(value)
        if unit is None:
            self._reject_missing_unit(value, number)
            unit = self.si_unit
        if not math.isfinite(number):
            raise InputError(f"must be a finite number. {self._example()}")
        result = number if unit == self.si_unit else self._in_si(number, unit)
        if 0.0 < abs(result) < NEGLIGIBLE:
            raise InputError(f"is too close to zero for a computation. {self._example()}")
        self._check_range(result, plain=isinstance(value, int | float))
        return result

    def text(self, value: float) -> str:
        """``value`` (SI) as a study file shows it: a TOML string with the shown unit, or a plain number."""
        if not self.si_unit and not self.shown:
            return _short(value)
        shown, factor = self.shown_unit
        return f'"{_short(value / factor)} {shown}"'

    @property
    def shown_unit(self) -> tuple[str, float]:
        """The unit that texts show, "" for a pure number, and its size in SI units."""
        shown = self.shown or self.si_unit
        return shown, 1.0 if shown == self.si_unit else _factor_to_si(shown)

    def stored(self, value: float) -> str | float:
        """``value`` (SI) with every digit and its SI unit, for a record that ``parse`` reads back exactly."""
        return f"{value!r} {self.si_unit}" if self.si_unit else value

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Let pydantic call ``parse``; the type beside this annotation is for readers and type checkers."""
        return core_schema.no_info_plain_validator_function(self.parse)

    def _split(self, value: object) -> tuple[float, str | None]:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            unit = " or a text with a number and a unit" if self.si_unit else ""
            raise InputError(f"must be a number{unit}. {self._example()}")
        if not isinstance(value, str):
            try:
                return float(value), None
            except OverflowError:  # TOML has whole numbers of any length
                return math.inf, None
        match = _NUMBER_AND_UNIT.fullmatch(value)
        if match is None:
            raise InputError(f"does not start with a number. {self._example()}")
        unit = match[2]
        if not unit and self.si_unit:
            raise InputError(f"has no unit, but {self._kind_with_article()} in quotes needs one. {self._example()}")
        return float(match[1]), unit

    def _kind_with_article(self) -> str:
        return f"{'an' if self.kind[0] in 'aeiou' else 'a'} {self.kind}"

    def _in_si(self, number: float, unit: str) -> float:
        """``number unit`` in the SI unit. Raises InputError for an unknown unit or one of another kind."""
        example = self._usual_example()
        needed = f"{self._kind_with_article()} is needed, such as {example}."
        root_unit = _root_unit(unit)
        if root_unit is None:
            raise InputError(
                f'has the unknown unit "{unit[:40]}"; {needed} Capitals matter: mm, um, GPa, MPa, N, kN, Hz, kg/m^3.'
            )
        if root_unit != _root_unit(self.si_unit):
            other = next((name for name, (si, _) in KINDS.items() if _root_unit(si) == root_unit), "another kind")
            angular = " For rad/s divide by 2 pi, for rpm by 60." if self.kind == "frequency" else ""
            raise InputError(f'has "{unit[:40]}", a unit of {other}, but {needed}{angular}')
        # 15 digits: the factor of a prefix is not exact in binary, and "36.7 mm" shall be the float 0.0367
        return float(f"{number * _factor_to_si(unit):.15g}")

    def _reject_missing_unit(self, value: object, number: float) -> None:
        if self.unit_required:
            raise InputError(
                f"has no unit. {self.unit_required} Write the unit that you mean, for example "
                f'"{_short(number)} {self.shown or self.si_unit}".'
            )

    def _check_range(self, value: float, plain: bool) -> None:
        limits = (
            (self.above, "above", self.above is None or value > self.above),
            (self.at_least, "of at least", self.at_least is None or value >= self.at_least),
            (self.below, "below", self.below is None or value < self.below),
            (self.at_most, "of at most", self.at_most is None or value <= self.at_most),
        )
        if all(satisfied for _, _, satisfied in limits):
            return
        unit, size = self.shown_unit if self.kind == "angle" else (self.si_unit, 1.0)  # nobody knows 1.5708 rad
        allowed = " and ".join(f"{word} {_short(bound / size)}" for bound, word, _ in limits if bound is not None)
        if value <= 0.0 and self.at_least is not None and self.at_least > 0.0:
            allowed = "above 0"  # clearer for a value of 0 than the smallest allowed number
        unit = f" {unit}" if unit else ""
        hint = ""
        if plain and self.shown and value > 0:
            plainly = f"in {self.si_unit}" if self.si_unit else "a fraction"
            hint = f' A plain number is {plainly}; write "{_short(value)} {self.shown}" if you mean {self.shown}.'
        raise InputError(f"is not allowed: a value {allowed}{unit} is needed.{hint}")

    def _example(self) -> str:
        return f"Write for example {self._usual_example()}."

    def _usual_example(self) -> str:
        return self.example or KINDS[self.kind][1]


@dataclass(frozen=True)
class Count:
    """A whole number of a study file, from ``at_least`` to ``at_most``."""

    at_least: int
    at_most: int | None = None

    def parse(self, value: object) -> int:
        """The number itself. Raises InputError for anything but a whole number in the range."""
        upper = "" if self.at_most is None else f" and at most {self.at_most}"
        allowed = f"a whole number of at least {self.at_least}{upper}"
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError(f"is not {allowed}, written without quotes and decimals.")
        if value < self.at_least or (self.at_most is not None and value > self.at_most):
            raise InputError(f"is not allowed: {allowed} is needed.")
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Let pydantic call ``parse``."""
        return core_schema.no_info_plain_validator_function(self.parse)


@dataclass(frozen=True)
class NodeNumber(Count):
    """The number of a node in a file: a name, which counts nothing."""


@dataclass(frozen=True)
class Respelled:
    """A choice of a study file of which one word had another spelling in earlier versions; both read as the new one."""

    earlier: str
    word: str

    def parse(self, value: Any) -> Any:
        """The new word in place of the earlier one; anything else as it is."""
        return self.word if value == self.earlier else value

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Let pydantic call ``parse`` before it looks for the word among the choices."""
        return core_schema.no_info_before_validator_function(self.parse, handler(source))


def number_and_unit(text: str) -> tuple[float, str]:
    """The number of a text and its unit, "" without one. Raises InputError if it is not a finite number."""
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None or not math.isfinite(float(match[1])) or (match[2] and _UNIT.fullmatch(match[2]) is None):
        raise InputError(f'"{text}" is not a number, nor a number with a unit.')
    return float(match[1]), match[2]


def in_unit(number: float, unit: str, other: str) -> float:
    """``number unit`` in an ``other`` unit. Raises InputError if there is no such unit, or it is of another kind."""
    if unit == other:
        return number
    if _root_unit(unit) is None or _root_unit(unit) != _root_unit(other):
        raise InputError(f'has the units "{other}" and "{unit}", which are not of the same kind.')
    return number * _factor_to_si(unit) / _factor_to_si(other)


def number_or_text(item: str) -> int | float | str:
    """A number as TOML would read it, or the text itself."""
    for kind in (int, float):
        try:
            return kind(item)
        except ValueError:
            continue
    return item


def _short(value: float) -> str:
    """At most 15 significant digits, so that 0.0367 m is 36.7 mm and not 36.699999999999996 mm; 1e8, not 100000000."""
    plain = f"{value:.15g}"
    mantissa, exponent = f"{value:.14e}".split("e")
    scientific = f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"
    return plain if "e" not in plain and len(plain) <= max(len(scientific), 6) else scientific


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint  # a quarter of a second: only for files that use units

    return pint.UnitRegistry()


@lru_cache(maxsize=256)
def _parsed(unit: str) -> Any:
    """One ``unit`` as a pint quantity in root units, or None if it is not a product of units of pint.

    The pattern comes first because pint passes other text to Python's tokenizer, whose errors differ by version.
    """
    if len(unit) > LONGEST_UNIT or (unit and _UNIT.fullmatch(unit) is None):
        return None
    import pint

    registry = _registry()
    try:
        return registry.Quantity(1.0, registry.parse_units(unit)).to_root_units()
    except (pint.PintError, ValueError):  # ValueError: "nan" and the like, which pint reads as numbers
        return None


def _root_unit(unit: str) -> str | None:
    """The unit in powers of gram, metre, second and radian; rad/s and rpm contain the radian and so differ from Hz."""
    parsed = _parsed(unit)
    return None if parsed is None else str(parsed.units)


def _factor_to_si(unit: str) -> float:
    """The number of SI units in one ``unit``; root units contain gram, so a mass is scaled to kilogram."""
    parsed = _parsed(unit)
    grams = next((power for name, power in parsed.unit_items() if name == "gram"), 0)
    return float(parsed.magnitude) / 1000.0**grams
