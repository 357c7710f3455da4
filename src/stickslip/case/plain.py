"""A study as plain mappings: sections with the values of a file, and absolute names of files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel

from stickslip.case.law_constants import TABLE_FILE, LawConstants
from stickslip.case.template import quantity_of

_FILE_KEYS = ("file", "stiffness", "mass", "damping", "unknown_map", "node_positions")


def plain_section(section: BaseModel, only_explicit: bool) -> dict[str, Any]:
    """Key -> value of one section as in a study file, without empty keys, or only with explicit keys of the file."""
    values: dict[str, Any] = {}
    for key, value in section:
        if value is None or (only_explicit and key not in section.model_fields_set):
            continue
        if isinstance(value, LawConstants):
            if value:
                values[key] = value.plain()
            continue
        quantity = quantity_of(type(section), key)
        plain = list(value) if isinstance(value, tuple) else value
        values[key] = quantity.stored(value) if quantity and isinstance(value, float) else plain
    return values


def omitted_keys(section: BaseModel, everything: bool = False) -> list[str]:
    """Keys of a section whose value is not in the file; ``everything``: the file has no such section."""
    explicit = set() if everything else section.model_fields_set
    return [key for key, value in section if key not in explicit and value is not None]


def with_absolute_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The sections of a study file in ``folder``, whose names of files are relative to it."""
    structure = data.get("structure")
    if isinstance(structure, dict):
        files = {key: str(folder / structure[key]) for key in _FILE_KEYS if isinstance(structure.get(key), str)}
        data = {**data, "structure": {**structure, **files}}
    interfaces = data.get("interfaces")
    if isinstance(interfaces, dict):
        data = {**data, "interfaces": {name: _with_files_in(folder, each) for name, each in interfaces.items()}}
    if "contact_stiffness" in data:
        data = {**data, "contact_stiffness": _with_files_in(folder, data["contact_stiffness"])}
    return data


def _with_files_in(folder: Path, section: Any) -> Any:
    """A section whose file of pairs and whose file of stiffness over pressure are absolute."""
    if not isinstance(section, dict):
        return section
    if isinstance(section.get("pairs"), str):
        section = {**section, "pairs": str(folder / section["pairs"])}
    table = section.get("stiffness_constants")
    if isinstance(table, dict) and isinstance(table.get(TABLE_FILE), str):
        section = {**section, "stiffness_constants": {**table, TABLE_FILE: str(folder / table[TABLE_FILE])}}
    return section
