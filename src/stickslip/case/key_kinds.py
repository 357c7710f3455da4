"""The values that a key of study files can have in a sweep or along a ridge of peaks."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from types import UnionType
from typing import Annotated, Literal, Union, get_args, get_origin

from stickslip.case.case import Case
from stickslip.case.law_constants import LawConstants
from stickslip.case.template import metadata_of, quantity_of
from stickslip.core.errors import InputError
from stickslip.core.units import Count, NodeNumber, Quantity

# These change the files beside the results of a single run, never a result.
UNSWEPT_SECTIONS = ("study", "output")


def kind_of_key(name: str, case: Case | None) -> Quantity | Count | tuple[str, ...]:
    """Type of the values of a key: a quantity, a count, or the words of a choice. Raises InputError."""
    all_keys = Case.allowed_keys()
    named = Case.named_sections()
    section, entry, table, key = Case.parts_of_key(name)
    if table:
        return _constant_kind(name, case)
    entry = entry if section in named else "NAME"
    if section not in all_keys or key not in all_keys.get(section, ()) or not entry:
        between = {each: ".NAME." if each in named else "." for each in all_keys}
        everything = [f"{each}{between[each]}{inner}" for each, keys in all_keys.items() for inner in keys]
        last = name.split(".")[-1]
        homes = [f"{each}.{last}" for each in _homes(last, case) if each not in named]
        nearest = homes or difflib.get_close_matches(name, everything, n=1)
        advice = f"Did you mean {nearest[0]}?" if nearest else '"stickslip new FILE" writes a file with all keys.'
        raise InputError(
            f"{name} is not a key of a study file (section.key or section.NAME.key). {advice}", arguments=[name]
        )
    if section in UNSWEPT_SECTIONS:
        raise InputError(f"{name} does not change the result of a case. Remove it.", arguments=[name])
    model, field = Case.field_of(section, key)
    quantity, annotation = quantity_of(model, key), field.annotation
    counts = [entry for entry in metadata_of(model, key) if isinstance(entry, Count)]
    count = next((entry for entry in counts if not isinstance(entry, NodeNumber)), None)
    value_type = next(kind for kind in (annotation, *get_args(annotation)) if kind is not None and not _is_union(kind))
    value_type = get_args(value_type)[0] if get_origin(value_type) is Annotated else value_type
    if get_origin(value_type) is Literal:
        return get_args(value_type)
    if quantity is not None and get_origin(value_type) is not tuple:
        return quantity
    if count is not None:
        return count
    words = "a text" if value_type is str else "the number of a node" if value_type is int else "a list of values"
    raise InputError(
        f"{name} is {words}; a sweep varies only quantities, counts and choices.",
        arguments=[name],
    )


def full_key(name: str, case: Case | None = None) -> str:
    """The key of a name without section that one section alone has, of the ``case`` if it is known, such as
    damper_mass; any other name as it is."""
    homes = [] if "." in name else _homes(name, case)
    return f"{homes[0]}.{name}" if len(homes) == 1 and homes[0] not in Case.named_sections() else name


def _homes(key: str, case: Case | None) -> list[str]:
    """The sections that have a key: those of the case, or without any there, of all kinds of studies."""
    homes = [section for section, keys in Case.allowed_keys().items() if key in keys]
    own = [each for each in homes if case is not None and hasattr(case.sections.get(each), key)]
    return own or homes


def _constant_kind(name: str, case: Case | None) -> Quantity:
    """The values that a constant of a law can have, from its declaration. Raises InputError."""
    section, entry, table, key = Case.parts_of_key(name)
    holder = None if case is None else case.sections.get(section)
    if isinstance(holder, Mapping):
        holder = holder.get(entry)
    constants: LawConstants | None = getattr(holder, table, None)
    above = name.removesuffix(f".{table}.{key}")
    if constants is None:
        raise InputError(f"{name} is not in the study: its section [{above}] has no law with such constants.")
    declared = constants.declared.get(key)
    if declared is None:
        raise InputError(f"{name} is not a constant of the law; its constants are: {', '.join(constants.declared)}.")
    if declared.quantity is None or declared.is_table:
        raise InputError(f"{name} is {'a list' if declared.is_table else 'true or false'}; a sweep varies quantities.")
    return declared.quantity


def _is_union(kind: object) -> bool:
    return get_origin(kind) in (Union, UnionType)
