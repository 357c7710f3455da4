"""The part of the ranges of a design in which friction locks the damper of two blades."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from stickslip.case.case import TwoBladeCase
from stickslip.model.kinds.damper_words import LOCK_UP_KEYS, lock_up_sentences
from stickslip.sweeps.design_space import DesignSpace


def lock_up_in_ranges(space: DesignSpace) -> Iterator[str]:
    """A sentence on the lock-up in the ranges and load cases of a design, where it is in them; solves nothing."""
    if not isinstance(space.case, TwoBladeCase):
        return
    ends = [(key.low, key.high) if key.name in LOCK_UP_KEYS else (key.low,) for key in space.keys]
    cases = [
        case
        for values in itertools.product(*ends)
        for load_case in space.load_cases
        if isinstance(case := space.case_at(values, load_case), TwoBladeCase)
    ]
    yield from lock_up_sentences(cases)
