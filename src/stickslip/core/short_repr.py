"""One line for a dataclass with arrays: shape and range of each array instead of its entries."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

FEW = 3  # chosen: so many numbers are shown, of more only their number and range
LONGEST = 90  # chosen: characters of one value: the line of another object of stickslip fits


def short_repr(data: Any) -> str:
    """Name of the class and the fields that are not None; a class assigns this to its ``__repr__``."""
    values = {each.name: getattr(data, each.name) for each in fields(data)}
    shown = ", ".join(f"{name}={_shown(value)}" for name, value in values.items() if value is not None)
    return f"{type(data).__name__}({shown})"


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return _shown_array(value)
    if hasattr(value, "nnz"):
        return f"sparse {value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping | list | tuple) and len(value) > FEW:
        return f"{len(value)} entries"
    text = " ".join(repr(value).split())
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def _shown_array(array: np.ndarray) -> str:
    numbers = array.ravel()
    if array.ndim <= 1 and numbers.size <= FEW:
        return f"[{', '.join(_shown(number.item()) for number in numbers)}]"
    if array.dtype == bool:
        return f"{array.shape} {int(array.sum())} True"
    if not np.issubdtype(array.dtype, np.number) or np.iscomplexobj(array) or not np.isfinite(array).any():
        return f"{array.shape} {array.dtype}"
    finite = numbers[np.isfinite(numbers)]
    low, high = _shown(finite.min().item()), _shown(finite.max().item())
    return f"{array.shape} of {low}" if low == high else f"{array.shape} from {low} to {high}"
