"""The march of disturbances over a period without touches, for tests."""

from __future__ import annotations

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.stability.march import Period


def marched(period: Period, states: FloatArray) -> FloatArray:
    """States (size, c) one period later."""
    none = np.zeros(0, dtype=np.int64)
    return period.march(states, none, none, none, np.zeros((0, 2)))[0]
