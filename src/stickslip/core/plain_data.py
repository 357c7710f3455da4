"""Plain data (dataclasses, mappings, sequences, arrays, numbers): comparison, and values that JSON can store."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def same_content(first: Any, second: Any) -> bool:
    """Whether two values of plain data (dataclasses, mappings, sequences, arrays, numbers) agree in every entry."""
    if isinstance(first, np.ndarray) or isinstance(second, np.ndarray):
        return np.array_equal(first, second)
    if type(first) is not type(second):
        return False
    if is_dataclass(first):
        return all(same_content(getattr(first, f.name), getattr(second, f.name)) for f in fields(first))
    if isinstance(first, Mapping):
        return list(first) == list(second) and all(same_content(first[key], second[key]) for key in first)
    if isinstance(first, list | tuple):
        return len(first) == len(second) and all(map(same_content, first, second))
    return bool(first == second)


def plain(value: Any) -> Any:
    """Numbers of numpy as numbers of Python, so that JSON can store them; tuples stay tuples."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def dotted(data: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Dotted key and value as text of nested tables of TOML, such as ``("interfaces.lid.normal_load", "40 N")``.

    Strings are without quotes.
    """
    for key, value in data.items():
        name = f"{above}.{key}" if above else key
        if isinstance(value, Mapping):
            yield from dotted(value, name)
        else:
            yield name, _written(value)


def _written(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"[{', '.join(map(_written, value))}]" if isinstance(value, list) else str(value)
