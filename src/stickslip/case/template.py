"""A commented study file written from the sections themselves, so that file and defaults cannot differ."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from stickslip.case.law_constants import LawConstants
from stickslip.core.units import Quantity

_OPENING = """\
# A study of stickslip. Check it with "stickslip check FILE", solve it with "stickslip run FILE --out DIR".
# Values with a unit are texts ("145 mm", "197 GPa"); plain numbers are SI. A key that is omitted has its default,
# which "stickslip new FILE" writes. Lines that begin with "# key =" are optional keys.
"""
_WIDTH = 120  # columns of a study file
_COLUMN = 39  # comments start two columns further


def study_text(sections: Mapping[str, Any], study: type[BaseModel]) -> str:
    """The study file with ``sections``: name -> values, name -> values of each entry, or None.

    Every key, its value and its description; ``study`` is the model whose fields are the sections. Its
    ``own_examples`` (key -> example, None for a key without meaning there) are for keys without a value.
    """
    parts = [_OPENING]
    examples: Mapping[str, str | None] = getattr(study, "own_examples", {})
    for name, value in sections.items():
        kinds = section_types(study.model_fields[name].annotation)
        if isinstance(value, dict):
            entries = [(f"{name}.{bare_name(entry)}", values) for entry, values in value.items()]
        else:
            entries = [(name, value)]
        own = {key: example for path, example in examples.items() for home, key in [path.split(".")] if home == name}
        parts += [_section_text(title, kinds, values, own) for title, values in entries]
    return "\n".join(parts)


def is_named(field: FieldInfo) -> bool:
    """Whether a section has entries with names of their own."""
    return get_origin(field.annotation) is dict


def bare_name(name: str) -> str:
    """A name as TOML, in quotes where it needs them."""
    return name if re.fullmatch(r"[\w-]+", name, flags=re.ASCII) else json.dumps(name, ensure_ascii=False)


def section_types(annotation: Any) -> tuple[type[BaseModel], ...]:
    """The models in the annotation of a section: also where it is optional, has named entries, or is one of several."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return (annotation,)
    return tuple(dict.fromkeys(kind for each in get_args(annotation) for kind in section_types(each)))


def quantity_of(section: type[BaseModel], key: str) -> Quantity | None:
    """The ``Quantity`` that annotates a key (also an optional one), or None for a key that is not a quantity."""
    return next((entry for entry in metadata_of(section, key) if isinstance(entry, Quantity)), None)


def metadata_of(section: type[BaseModel], key: str) -> list[Any]:
    """The annotations of the values of a key, also of an optional one."""
    field = section.model_fields[key]
    inner = [entry for kind in get_args(field.annotation) for entry in getattr(kind, "__metadata__", ())]
    return [*field.metadata, *inner]


def _section_text(
    name: str, kinds: Sequence[type[BaseModel]], values: BaseModel | None, examples: Mapping[str, str | None]
) -> str:
    """Heading, description and keys; a section without values becomes comment lines with its examples.

    Where a section is one of several ``kinds``, the keys that only others have are comments.
    """
    own = kinds[0] if values is None else type(values)
    about = " ".join((own.__doc__ or "").split())
    lines = [
        f"[{name}]" if values is not None else f"# [{name}]",
        *textwrap.wrap(about, _WIDTH - 2, initial_indent="# ", subsequent_indent="# "),
    ]
    homes = {key: kind for kind in (*reversed(kinds), own) for key in kind.model_fields}
    tables: list[str] = []
    for key in dict.fromkeys(key for kind in (own, *kinds) for key in kind.model_fields):
        section = homes[key]
        field = section.model_fields[key]
        value = getattr(values, key, None)
        if key in examples and examples[key] is None and value == field.default:
            continue
        if isinstance(value, LawConstants):
            tables += _constants_text(f"{name}.{key}", value)
            continue
        if value is None:
            entry = f"# {key} = {examples.get(key) or _example(section, key)}"
        else:
            entry = f"{key} = {value_text(quantity_of(section, key), value)}"
        lines.append(_with_comment(entry, field.description))
    return "\n".join([*lines, *tables]) + "\n"


def _constants_text(name: str, constants: LawConstants) -> list[str]:
    """The section with the constants of a law."""
    keys = (
        _with_comment(f"{key} = {text}", constants.declared[key].description if key in constants.declared else None)
        for key, text in constants.texts().items()
    )
    return ["", f"[{name}]", *keys]


def _example(section: type[BaseModel], key: str) -> str:
    """The value of a key that is not set, as TOML: its default, or else its example."""
    field = section.model_fields[key]
    if field.examples:
        example = field.examples[0]
        return str(example) if LawConstants in get_args(field.annotation) else json.dumps(example)
    return value_text(quantity_of(section, key), field.default)


def _with_comment(entry: str, description: str | None) -> str:
    """The comment beside the entry, or on a line above where the line would be too long."""
    if not description:
        return entry
    beside = f"{entry:<{_COLUMN}}  # {description}"
    return beside if len(beside) <= _WIDTH else f"# {description}:\n{entry}"


def value_text(quantity: Quantity | None, value: Any) -> str:
    """A value as TOML."""
    if quantity is not None and isinstance(value, float):
        return quantity.text(value)
    return json.dumps(value, ensure_ascii=False)
