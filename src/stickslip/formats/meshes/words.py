"""Numbers in the words of a text file, with errors that name file and line."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NoReturn

from stickslip.formats.meshes.raw_model import LARGEST_LABEL

Fail = Callable[[str, int], NoReturn]


def as_label(fail: Fail, word: str, line: int) -> int:
    """A number of a node or element; ``fail`` reports anything else."""
    try:
        value = int(word)
    except ValueError:
        fail(f'"{word[:40]}" is not a node or element number.', line)
    if not 0 < value < LARGEST_LABEL:
        fail(f"{word[:40]} is not a node or element number; numbers are 1 to {LARGEST_LABEL - 1}.", line)
    return value


def as_number(fail: Fail, word: str, line: int) -> float:
    """A finite number, also with the exponent D of Fortran; ``fail`` reports anything else."""
    try:
        value = float(word.upper().replace("D", "E"))
    except ValueError:
        fail(f'"{word[:40]}" is not a number.', line)
    if not math.isfinite(value) or "_" in word:
        fail(f'"{word[:40]}" is not a finite number.', line)
    return value
