"""The errors of pydantic for a study file, with more specific messages of the sections."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from stickslip.case.section import Required, Section
from stickslip.case.template import section_types
from stickslip.case.toml_text import STATED


def explained(
    details: ErrorDetails, data: Mapping[str, Any], own: type[BaseModel], kinds: Mapping[str, type[BaseModel]]
) -> list[ErrorDetails]:
    """The error itself, or its replacement: for a required key the message of its section; for an entry of studies of
    another kind the error in its value, or else a message that it does not belong here.

    ``own`` is the class of the study with the sections ``data``, ``kinds`` those of all kinds.
    """
    path = tuple(str(part) for part in details["loc"])
    if details["type"] == "missing":
        sentence = next((entry.sentence for entry in _required(own, path)), None)
        return [details if sentence is None else _stated(details, sentence)]
    if details["type"] != "extra_forbidden":
        return [details]
    sentence = _foreign_message(path, data, own, kinds)
    if sentence is None:
        return [details]
    return _wrong_values(path, data, own, kinds) or [_stated(details, sentence)]


def _stated(details: ErrorDetails, sentence: str) -> ErrorDetails:
    return {**details, "type": STATED, "ctx": {"sentence": sentence}}


def _classes(case: type[BaseModel], section: str) -> tuple[type[BaseModel], ...]:
    field = case.model_fields.get(section)
    return () if field is None else section_types(field.annotation)


def _required(own: type[BaseModel], path: tuple[str, ...]) -> list[Required]:
    fields = [each.model_fields[path[-1]] for each in _classes(own, path[0]) if path[-1] in each.model_fields]
    return [entry for field in fields for entry in field.metadata if isinstance(entry, Required)]


def _foreign_message(
    path: tuple[str, ...], data: Mapping[str, Any], own: type[BaseModel], kinds: Mapping[str, type[BaseModel]]
) -> str | None:
    """The message on an entry that only studies of other kinds have; None if none has it."""
    if len(path) == 1:
        owners = [name for name, kind in kinds.items() if path[0] in kind.model_fields]
        kind = next((name for name, each in kinds.items() if each is own), "")
        if not owners:
            return None
        return (
            f'does not belong to a structure of kind "{kind}", only to {" and ".join(owners)}. Remove the section, '
            "or set structure.kind."
        )
    sections = [each for each in _classes(own, path[0]) if issubclass(each, Section)]
    # The kind that the section has comes first: several may not have the key, each with its own sentence.
    sections.sort(key=lambda each: not _has_kind(each, data.get(path[0])))
    return next((each.foreign[path[-1]] for each in sections if path[-1] in each.foreign), None)


def _has_kind(section: type[BaseModel], data: Any) -> bool:
    """Whether the content of a section names the kind of a class."""
    field = section.model_fields.get("kind")
    return field is not None and isinstance(data, Mapping) and data.get("kind") in get_args(field.annotation)


def _wrong_values(
    path: tuple[str, ...], data: Mapping[str, Any], own: type[BaseModel], kinds: Mapping[str, type[BaseModel]]
) -> list[ErrorDetails]:
    """The errors in the value of an entry for the first other kind that has it."""
    for name, other in kinds.items():
        if other is own or path[0] not in other.model_fields:
            continue
        section = data[path[0]]
        if path[0] == "structure":
            section = {**section, "kind": name}
        try:
            other.model_validate({"structure": {"kind": name}, path[0]: section})
        except ValidationError as error:
            details = [each for each in error.errors(include_url=False) if _is_below(each, path)]
            if details:
                return details
    return []


def _is_below(details: ErrorDetails, path: tuple[str, ...]) -> bool:
    """Whether an error is about a value at or below a path, and not about missing or extra keys."""
    place = tuple(str(part) for part in details["loc"])
    return place[: len(path)] == path and details["type"] not in ("missing", "extra_forbidden")
