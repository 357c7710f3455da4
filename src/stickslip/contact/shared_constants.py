"""Constants of a study, given for a whole face, as the arguments of a law of its pairs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.contact.constants import Constant
from stickslip.core.validation import FloatArray


def shared_constants(declared: Mapping[str, Constant], values: Mapping[str, Any], share: FloatArray) -> dict[str, Any]:
    """Arguments of a law from SI values by name.

    ``share`` (p,) is the part of each pair in its face, adding up to 1. A value of the whole face becomes (p,), or
    (p, components) where a list gives one for each component; a value that is the same for each pair stays as it is, a
    list of it becomes an array.
    """
    arguments = {}
    for name, value in values.items():
        entries = np.asarray(value, dtype=float) if isinstance(value, tuple) else value
        if declared[name].of_face:
            entries = np.multiply.outer(share, entries)
        arguments[name] = entries
    return arguments
