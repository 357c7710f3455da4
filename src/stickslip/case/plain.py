"""A study as plain mappings: sections with the values of a file, and absolute names of files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel

from stickslip.case.template import quantity_of

_FILE_KEYS = ("file", "stiffness", "mass", "damping", "unknown_map", "node_positions")


def plain_section(section: BaseModel, only_given: bool) -> dict[str, Any]:
    """Key -> value of one section as in a study file, without empty keys, or only with explicit keys of the file."""
    values = {}
    for key, value in section:
        if value is None or (only_given and key not in section.model_fields_set):
            continue
        quantity = quantity_of(type(section), key)
        plain = list(value) if isinstance(value, tuple) else value
        values[key] = quantity.stored(value) if quantity and isinstance(value, float) else plain
    return values


def keys_left_out(section: BaseModel, everything: bool = False) -> list[str]:
    """Keys of a section whose value is not in the file; ``everything``: the file has no such section."""
    given = set() if everything else section.model_fields_set
    return [key for key, value in section if key not in given and value is not None]


def with_absolute_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The sections of a study file in ``folder``, whose names of files are relative to it."""
    structure = data.get("structure")
    if isinstance(structure, dict):
        files = {key: str(folder / structure[key]) for key in _FILE_KEYS if isinstance(structure.get(key), str)}
        data = {**data, "structure": {**structure, **files}}
    interfaces = data.get("interfaces")
    if isinstance(interfaces, dict):
        data = {**data, "interfaces": {name: _with_pairs_in(folder, each) for name, each in interfaces.items()}}
    return data


def _with_pairs_in(folder: Path, interface: Any) -> Any:
    """An interface whose file of pairs is absolute."""
    if isinstance(interface, dict) and isinstance(interface.get("pairs"), str):
        return {**interface, "pairs": str(folder / interface["pairs"])}
    return interface
