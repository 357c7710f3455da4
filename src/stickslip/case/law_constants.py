"""The laws that a study file chooses by name, and their constants, read by what each law declares.

A law may come from another package, so its constants are no fields of a section: they are read with the declaration of
the law (:mod:`stickslip.contact.constants`). The laws need numerical packages and are loaded when a study names one.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, core_schema

from stickslip.case.toml_text import STATED
from stickslip.contact.constants import Constant, Declaration, declaration_of, stiffness_declaration_of
from stickslip.core.errors import InputError

COULOMB = "coulomb"
FRACTAL = "fractal"
TABLE_FILE = "file"  # the key that names a file with all tables of a law
ConstantValue = float | bool | str | tuple[float, ...]


@dataclass(frozen=True)
class LawConstants:
    """Constants of a law as a study gives them, in SI; the name of a file instead of all tables under TABLE_FILE."""

    declared: Mapping[str, Constant]
    values: Mapping[str, ConstantValue]

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> CoreSchema:
        """Only :func:`read_constants` makes one."""
        return core_schema.is_instance_schema(cls)

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.values)

    @property
    def file(self) -> str | None:
        """The file that contains the tables."""
        file = self.values.get(TABLE_FILE)
        return file if isinstance(file, str) else None

    def plain(self) -> dict[str, Any]:
        """Key -> value as in a study file, with every digit and SI units."""
        return {key: self._each(key, lambda constant, value: constant.stored(value)) for key in self.values}

    def texts(self) -> dict[str, str]:
        """Key -> value as TOML."""
        shown = {key: self._each(key, lambda constant, value: constant.text(value)) for key in self.values}
        return {
            key: f"[{', '.join(text)}]" if isinstance(text, list) else _toml(self.declared.get(key), text)
            for key, text in shown.items()
        }

    def words(self) -> str:
        """The constants in a sentence."""
        return ", ".join(f"{key} {value} {unit}".rstrip() for key, value, unit in self.rows())

    def rows(self) -> tuple[tuple[str, str, str], ...]:
        """Name, value and SI unit of each constant, for people."""
        return tuple((key, _shown(value), self._unit(key)) for key, value in self.values.items())

    def _unit(self, key: str) -> str:
        return self.declared[key].unit if key in self.declared else ""

    def _each(self, key: str, convert: Callable[[Any, float], Any]) -> Any:
        value, constant = self.values[key], self.declared.get(key)
        if constant is None or constant.quantity is None:
            return value
        if isinstance(value, tuple):
            return [convert(constant.quantity, entry) for entry in value]
        return convert(constant.quantity, float(value))


def _toml(constant: Constant | None, text: Any) -> str:
    """What a quantity shows is TOML already; a switch and the name of a file are not."""
    return json.dumps(text, ensure_ascii=False) if constant is None or constant.quantity is None else str(text)


def _shown(value: ConstantValue) -> str:
    """A value as people read it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return ", ".join(f"{entry:g}" for entry in value)
    return value if isinstance(value, str) else f"{value:g}"


def contact_law_declaration(name: str) -> Declaration:
    """The declarations of a contact law. Raises InputError for a name without a law, and for a law of Python only."""
    from stickslip.contact.law.registry import contact_law, contact_law_names

    return declaration_of(_maker(name, contact_law, contact_law_names(), "contact law"))


def stiffness_law_declaration(name: str) -> Declaration:
    """The declarations of a stiffness law. Raises InputError for a name without a law, and for a law of Python only."""
    from stickslip.contact.stiffness.registry import stiffness_law, stiffness_law_names

    names = tuple(each for each in stiffness_law_names() if each != FRACTAL)
    if name == FRACTAL:
        raise InputError(
            "is the law of [roughness]; its values are the keys of that section. Remove stiffness_law, and give "
            "[roughness] instead."
        )
    return stiffness_declaration_of(_maker(name, stiffness_law, names, "stiffness law"))


def _maker(name: str, find: Callable[[str], Any], names: tuple[str, ...], what: str) -> Any:
    if name not in names:
        raise InputError(f"is not a {what}; there are: {', '.join(names)}.")
    return find(name)


def read_constants(given: object, law: str, declaration: Declaration, try_law: Callable[..., Any]) -> LawConstants:
    """The constants of a table of a study file, checked by their declaration and by the law itself.

    ``try_law(**constants)`` makes the law as far as it can be made without the joint; its InputError counts where it
    is about constants of the table alone. Raises ValidationError with the place of each error, or PydanticCustomError
    for the table as a whole.
    """
    if given is None:
        given = {}
    if isinstance(given, LawConstants):
        given = given.plain()
    if not isinstance(given, Mapping):
        raise PydanticCustomError(STATED, "{sentence}", {"sentence": "must be a section of its own, with its keys."})
    tables = tuple(name for name, each in declaration.constants.items() if each.is_table)
    errors: list[InitErrorDetails] = []
    values: dict[str, ConstantValue] = {}
    for key, value in given.items():
        try:
            values[key] = _parsed(key, value, declaration, law)
        except _UnknownKeyError as error:
            errors.append(_stated(key, value, str(error)))
        except InputError as error:
            errors.append(_wrong(key, value, str(error)))
    if TABLE_FILE in values:
        twice = [name for name in tables if name in given]
        errors += [
            _stated(name, given[name], f"and {TABLE_FILE} are both given. Remove one of the two.") for name in twice
        ]
    lacking = [name for name in declaration.required if name not in given]
    if TABLE_FILE in given:
        lacking = [name for name in lacking if name not in tables]
    for name in lacking:
        instead = f", or {TABLE_FILE} with all tables of the law" if name in tables else ""
        constant = declaration.constants[name]
        about = f" ({constant.description})" if constant.description else ""
        sentence = f'is missing: the law "{law}" requires it{about}{instead}. Its constants are: {declaration.words()}.'
        errors.append(_stated(name, None, sentence))
    if not errors and TABLE_FILE not in values:
        errors += _rejected(try_law, values)
    if errors:
        raise ValidationError.from_exception_data("constants", errors)
    return LawConstants(dict(declaration.constants), values)


class _UnknownKeyError(InputError):
    """A key that the law does not have."""


def _parsed(key: str, value: Any, declaration: Declaration, law: str) -> ConstantValue:
    """The SI value of one constant. Raises InputError with the end of a sentence."""
    if key == TABLE_FILE and any(each.is_table for each in declaration.constants.values()):
        if not isinstance(value, str):
            raise InputError("must be the name of a file, a text in quotes.")
        return value
    if key not in declaration.constants:
        home = f" The joint defines it: {_HOMES[key]}." if key in declaration.of_joint else ""
        raise _UnknownKeyError(
            f'is not a constant of the law "{law}" in a study file.{home} Its constants are: {declaration.words()}.'
        )
    constant = declaration.constants[key]
    if constant.quantity is None:
        if not isinstance(value, bool):
            raise InputError("must be true or false.")
        return value
    if isinstance(value, list | tuple):
        allowed = constant.is_table or (constant.components > 1 and len(value) == constant.components)
        if not allowed:
            several = f", or a list of {constant.components}" if constant.components > 1 else ""
            raise InputError(f"is a list of {len(value)}, but one value is needed{several}.")
        return tuple(constant.quantity.parse(entry) for entry in value)
    if constant.is_table:
        raise InputError("must be a list of values in square brackets.")
    return constant.quantity.parse(value)


_HOMES = {
    "normal_load": "interfaces.NAME.normal_load, or preload.values",
    "gap": "interfaces.NAME.gap, or the gaps between two meshes",
    "friction_coefficient": "interfaces.NAME.friction, or [friction]",
    "normal_stiffness": "interfaces.NAME.normal_stiffness, [contact_stiffness], or [roughness]",
    "tangential_stiffness": "interfaces.NAME.tangential_stiffness, [contact_stiffness], or [roughness]",
}


def _rejected(try_law: Callable[..., Any], values: Mapping[str, ConstantValue]) -> list[InitErrorDetails]:
    """The objections of the law itself to constants of the table."""
    try:
        try_law(**values)
    except InputError as error:
        if error.keys and set(error.keys) <= set(values):
            return [_stated(error.keys[0], values[error.keys[0]], f"is rejected by the law: {error}")]
    return []


def _stated(key: str, value: object, sentence: str) -> InitErrorDetails:
    """An error whose sentence follows the name of the key."""
    return {"type": PydanticCustomError(STATED, "{sentence}", {"sentence": sentence}), "loc": (key,), "input": value}


def _wrong(key: str, value: object, sentence: str) -> InitErrorDetails:
    """An error whose sentence follows the name of the key and its value."""
    return {"type": PydanticCustomError("value_error", "{error}", {"error": sentence}), "loc": (key,), "input": value}
