"""The laws of a joint step by step along one periodic motion."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.linear_steps import LinearSteps, SteppedLaw
from stickslip.core.validation import FloatArray


def laws_without_steps(pairs: ContactPairs) -> tuple[str, ...]:
    """Names of the laws that do not give :class:`LinearSteps`."""
    return tuple(dict.fromkeys(law.name for law in pairs.laws if not isinstance(law, SteppedLaw)))


def linear_steps(pairs: ContactPairs, displacement: FloatArray) -> LinearSteps:
    """The steps of all pairs under a motion (n, n_pairs, 3) m; each law must be a :class:`SteppedLaw`."""
    parts: list[LinearSteps] = []
    for law, group in zip(pairs.laws, pairs.members, strict=True):
        assert isinstance(law, SteppedLaw)  # the caller checks laws_without_steps first
        parts.append(law.linear_steps(np.ascontiguousarray(displacement[:, group])))
    if len(parts) == 1:
        return parts[0]
    joined: dict[str, Any] = {}
    for each in fields(LinearSteps):
        arrays = [getattr(part, each.name) for part in parts]
        joined[each.name] = np.empty((len(displacement), pairs.n_pairs, *arrays[0].shape[2:]))
        for array, group in zip(arrays, pairs.members, strict=True):
            joined[each.name][:, group] = array
    return LinearSteps(**joined)
