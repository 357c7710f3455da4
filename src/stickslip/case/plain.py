"""A study as plain mappings: sections with the values of a file, absolute names of files, and its title."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from stickslip.case.law_constants import TABLE_FILE, LawConstants
from stickslip.case.template import quantity_of, value_text

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


def changed_texts(section: BaseModel) -> list[str]:
    """The keys of a section in the file whose value is not the default, "key = value" in the units of engineers."""
    fields = type(section).model_fields
    given = {key: value for key, value in section if key in section.model_fields_set and value is not None}
    changed = {key: value for key, value in given.items() if value != fields[key].default}
    return [
        f"{key} = {', '.join(value.texts().values())}" if isinstance(value, LawConstants)
        else f"{key} = {value_text(quantity_of(type(section), key), value)}"
        for key, value in changed.items()
    ]  # fmt: skip


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
    mistuning = data.get("mistuning")
    if isinstance(mistuning, dict) and isinstance(mistuning.get("file"), str):
        data = {**data, "mistuning": {**mistuning, "file": str(folder / mistuning["file"])}}
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


def titled_by_its_file(data: Any) -> Any:
    """``data`` of a study of the user's own, with a title from the file of its structure if it has none."""
    study = data.get("study", {}) if isinstance(data, Mapping) else None
    if not isinstance(study, Mapping) or "title" in study or not isinstance(data.get("structure"), Mapping):
        return data
    file = data["structure"].get("file") or data["structure"].get("stiffness")
    if file is None:
        file = "bladed disk" if data["structure"].get("kind") == "cyclic" else "own matrices"
    return {**data, "study": {**study, "title": f"Vibration of {Path(str(file)).stem}"}}
