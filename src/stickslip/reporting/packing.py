"""Arrays as short text: little-endian numbers in base64, which unpack.js reads."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

FULL_SCALE = 32767  # of 16-bit numbers


def packed(array: NDArray[Any], kind: str) -> str:
    """Base64 of an array in little-endian ``kind``: "i1", "i2", "i4" or "f4"."""
    return base64.b64encode(np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()).decode("ascii")
