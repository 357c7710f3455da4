"""Declarations of the constants of a law, with which study files give them: unit, size, and for which pairs.

A law is a dataclass; ``field(metadata=constant("N/m", of_face=True))`` declares a constant. This module loads no
numerical package: study files are read without them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from typing import Any

from stickslip.core.errors import InputError
from stickslip.core.units import Quantity

# What the joint of a study knows of each pair: fields of these names need no declaration.
NORMAL_LOAD, GAP, FRICTION = "normal_load", "gap", "friction_coefficient"
STIFFNESSES = ("normal_stiffness", "tangential_stiffness")
OF_JOINT = (NORMAL_LOAD, GAP, FRICTION, *STIFFNESSES)
_KEY = "stickslip constant"


@dataclass(frozen=True)
class Constant:
    """One constant as a study file gives it: the arguments of :func:`constant`; no ``quantity`` for a switch."""

    quantity: Quantity | None
    of_face: bool = False
    components: int = 1
    is_table: bool = False
    description: str = ""

    @property
    def unit(self) -> str:
        """SI unit, "" for a pure number and a switch."""
        return "" if self.quantity is None else self.quantity.si_unit

    def words(self, name: str) -> str:
        """The constant in a list of constants: its name and unit."""
        return f"{name} (true or false)" if self.quantity is None else f"{name} ({self.unit})" if self.unit else name


def units_of(law: type) -> dict[str, str]:
    """SI unit of each constant of a law, as far as they are declared or those of the joint; "1" for a pure number."""
    of_joint = dict(zip(OF_JOINT, ("N", "m", "1", "N/m", "N/m"), strict=True))
    declared = {field.name: field.metadata.get(_KEY) for field in fields(law)}
    units = {name: each.unit or "1" for name, each in declared.items() if each is not None and each.quantity}
    return {name: of_joint[name] for name in declared if name in of_joint} | units


def constant(
    unit: str = "",
    *,
    of_face: bool = False,
    components: int = 1,
    is_switch: bool = False,
    is_table: bool = False,
    description: str = "",
) -> dict[str, Any]:
    """Metadata of a dataclass field: the form of this constant of a law in study files.

    Parameters
    ----------
    unit:
        SI unit of the value, such as "N/m"; "" for a pure number.
    of_face:
        True for the value of a whole face, distributed over its pairs by area (stiffness, force): the law gets (p,) or
        (p, components). False for a value that is the same for each pair: the law gets it as it is, one number.
    components:
        number of values that a list may have instead of one number: 3 along t1, t2, n, or 2 along t1, t2.
    is_switch:
        True for true or false.
    is_table:
        True for a list of any length; the tables of one law are columns of one file.
    description:
        one line for study files.
    """
    quantity = None if is_switch else Quantity.of_unit(unit)
    return {_KEY: Constant(quantity, of_face, components, is_table, description)}


@dataclass(frozen=True)
class Declaration:
    """The constants of one law as a study file sees them.

    Attributes
    ----------
    constants:
        name -> what is declared, in the order of the law.
    of_joint:
        names that the joint gives.
    optional:
        names of both kinds that have a default.
    """

    constants: Mapping[str, Constant]
    of_joint: tuple[str, ...]
    optional: frozenset[str]

    @property
    def required(self) -> tuple[str, ...]:
        """Constants that a study file must give."""
        return tuple(name for name in self.constants if name not in self.optional)

    def needs(self, *names: str) -> bool:
        """Whether the joint must give one of these values."""
        return any(name in self.of_joint and name not in self.optional for name in names)

    @property
    def follows_load(self) -> bool:
        """Whether the joint gives the law its normal load and all else, so that each load makes another law."""
        return NORMAL_LOAD in self.of_joint and not self.constants

    def words(self) -> str:
        """All constants with their units, for a sentence."""
        return ", ".join(each.words(name) for name, each in self.constants.items()) or "none"


def declaration_of(maker: Callable[..., Any]) -> Declaration:
    """The declarations of a contact law. Raises InputError if a study file cannot create it."""
    return _declaration(maker, OF_JOINT, lambda field: None)


def stiffness_declaration_of(maker: Callable[..., Any]) -> Declaration:
    """The declarations of a stiffness law; a plain ``float`` without a declaration is a number in SI units.

    Raises InputError where a study file cannot make it.
    """

    def plain_number(field: Field[Any]) -> Constant | None:
        return Constant(Quantity("pure number")) if field.type in (float, "float") else None

    return _declaration(maker, (), plain_number)


def _declaration(
    maker: Callable[..., Any], of_joint: tuple[str, ...], undeclared: Callable[[Field[Any]], Constant | None]
) -> Declaration:
    if not is_dataclass(maker):
        raise InputError("can be used from Python only: it is not a dataclass, so it declares no constants.")
    constants: dict[str, Constant] = {}
    of_joint_found, optional, unknown = [], set(), []
    for field in fields(maker):
        if not field.init:
            continue
        declared = field.metadata.get(_KEY) or (None if field.name in of_joint else undeclared(field))
        has_default = field.default is not MISSING or field.default_factory is not MISSING
        if has_default:
            optional.add(field.name)
        if declared is not None:
            _require_si(field.name, declared)
            constants[field.name] = declared
        elif field.name in of_joint:
            of_joint_found.append(field.name)
        elif not has_default:
            unknown.append(field.name)
    if unknown:
        raise InputError(
            f"can be used from Python only: it does not declare its constant {unknown[0]}, so a study file cannot give "
            "it. Declare it in the law with field(metadata=stickslip.constant(...))."
        )
    return Declaration(constants, tuple(of_joint_found), frozenset(optional))


def _require_si(name: str, declared: Constant) -> None:
    """Raise InputError for a declared unit that is no SI unit: a plain number of a file is in SI units."""
    if declared.quantity is not None and not declared.quantity.is_si:
        raise InputError(
            f'can be used from Python only: it declares {name} in "{declared.unit}", not a product of SI units.'
        )
