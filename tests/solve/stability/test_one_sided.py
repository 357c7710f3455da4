"""Which disturbances remain on one side: those that exceed exactly the limits at which sliders follow them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stickslip.solve.stability.disturbances import DisturbanceModes
from stickslip.solve.stability.one_sided import growing_to_one_side

NONE, FIRST, SECOND, BOTH = (False, False), (True, False), (False, True), (True, True)
OPPOSITE = np.array([1.0, -1.0])


class OneDirection:
    """Two touches see a disturbance in one direction with opposite signs; its multiplier depends on the choice."""

    def __init__(self, multipliers: Mapping[tuple[bool, ...], complex]) -> None:
        self.multipliers, self.asked = multipliers, list[tuple[bool, ...]]()

    @property
    def n_touches(self) -> int:
        return 2

    def modes(self, follow: np.ndarray) -> DisturbanceModes:
        self.asked.append(tuple(follow.tolist()))
        return DisturbanceModes(np.array([self.multipliers[self.asked[-1]]], dtype=complex), np.ones((2, 1), complex))


def test_a_choice_between_none_and_all_may_grow_alone() -> None:
    """With one sign the disturbance exceeds the second limit alone, and grows if the slider follows there."""
    touches = OneDirection({NONE: 0.995, FIRST: 0.96, SECOND: 1.04, BOTH: 0.95})
    assert growing_to_one_side(touches, OPPOSITE).tolist() == [1.04]


def test_a_growth_of_a_choice_that_no_sign_exceeds_is_none() -> None:
    touches = OneDirection({NONE: 0.97, FIRST: 0.96, SECOND: 0.98, BOTH: 1.04})
    assert not growing_to_one_side(touches, OPPOSITE).size
    assert sorted(touches.asked) == sorted([NONE, FIRST, SECOND, BOTH])
    touches = OneDirection({NONE: 1.04, FIRST: 0.96, SECOND: 0.98, BOTH: 0.97})
    assert not growing_to_one_side(touches, OPPOSITE).size


def test_touches_in_one_sense_leave_a_sign_free() -> None:
    """Away from both limits nothing follows; towards them both do."""
    same = np.ones(2)
    assert growing_to_one_side(OneDirection({NONE: 1.04, BOTH: 0.9}), same).tolist() == [1.04]
    assert growing_to_one_side(OneDirection({NONE: 0.9, BOTH: 1.05}), same).tolist() == [1.05]


def test_disturbances_that_rotate_or_change_their_sign_have_no_side() -> None:
    touches = OneDirection({NONE: -1.2, BOTH: 1.2j})
    assert not growing_to_one_side(touches, OPPOSITE).size
    assert touches.asked == [NONE, BOTH]
