"""The class of all sections of a study file, and the rules between its keys.

The fields are the keys of the file, their descriptions and the docstrings its comments (``template.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    PlainValidator,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from stickslip.case.quantities import require_printable
from stickslip.core.errors import InputError


@dataclass(frozen=True)
class Required:
    """The message on a missing required key, after its name."""

    sentence: str


class Section(BaseModel):
    """A section of the study file.

    ``foreign`` are keys that the section has in a study of another kind, with what a message says of them here.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    foreign: ClassVar[Mapping[str, str]] = {}

    @model_validator(mode="before")
    @classmethod
    def _drop_empty_foreign_keys(cls, data: Any) -> Any:
        """Files of earlier versions contain foreign keys that are empty or zero, which have no effect."""
        if not isinstance(data, Mapping):
            return data
        return {key: value for key, value in data.items() if value or key not in cls.foreign}

    @field_validator("*", mode="before")
    @classmethod
    def _texts_can_be_shown(cls, value: Any) -> Any:
        return require_printable(value)


def chosen_by(choose: Callable[[Any], type[Section]]) -> PlainValidator:
    """The validator of a union of sections of which ``choose`` picks one for the data of a file."""
    return PlainValidator(lambda data: data if isinstance(data, Section) else choose(data).model_validate(data))


def _literal(words: tuple[str, ...]) -> Any:
    return Literal[words]


def of_kind(classes: Mapping[str, type[Section]], default: str) -> PlainValidator:
    """The validator of a union of sections that differ by their key ``kind``."""
    config = ConfigDict(extra="ignore", frozen=True)
    unknown = create_model("UnknownKind", __config__=config, kind=(_literal(tuple(classes)), ...))

    def validated(data: Any) -> Any:
        if isinstance(data, Section):
            return data
        kind = data.get("kind", default) if isinstance(data, Mapping) else default
        is_valid = isinstance(kind, str) and kind in classes
        return (classes[kind] if is_valid else unknown).model_validate(data)

    return PlainValidator(validated)


def without_default(data: Any, alternatives: tuple[str, ...], default: str) -> Any:
    """``data`` with ``default`` switched off where a ``alternatives`` key replaces it and the file does not name it."""
    if isinstance(data, Mapping) and default not in data and any(key in data for key in alternatives):
        return {default: None, **data}
    return data


def instead_of(value: Any, info: ValidationInfo, other: str) -> Any:
    """``value``, after checking that ``other`` is not given as well. Raises InputError."""
    if value is not None and info.data.get(other) is not None:
        raise InputError(f"and {other} cannot both be given. Remove one of them.")
    return value


def has_value(data: Any, key: str) -> bool:
    """Whether the data of a section in a file contain a key with a value."""
    return isinstance(data, Mapping) and data.get(key) is not None
