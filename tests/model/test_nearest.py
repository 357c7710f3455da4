"""The node nearest to a point of a study file: one rule for meshes and matrices."""

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.model.nearest import nearest_node

LINE = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.2, 0.0, 0.0]])


def test_two_nodes_on_both_sides_of_the_point_are_two_places() -> None:
    """They were refused as one place, because both are equally far from the point."""
    assert nearest_node(LINE, np.array([0.105, 0.0, 0.0])) == 1
    between = np.array([[0.0, 0.0, 0.0], [0.100, 0.0, 0.0], [0.102, 0.0, 0.0]])
    assert nearest_node(between, np.array([0.101, 0.0, 0.0])) in (1, 2)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_one_place_is_a_fraction_of_the_size(scale: float) -> None:
    """The tolerance was one in metres, so small structures were refused and large ones not."""
    near = np.vstack([LINE, LINE[1] + [1e-5, 0.0, 0.0]])
    assert nearest_node(scale * near, scale * np.array([0.0999, 0.0, 0.0])) == 1
    same = np.vstack([LINE, LINE[1] + [1e-8, 0.0, 0.0]])
    with rejects(InputError):
        nearest_node(scale * same, scale * np.array([0.0999, 0.0, 0.0]))


def test_a_far_point_is_rejected() -> None:
    with rejects(InputError):
        nearest_node(LINE, np.array([0.25, 0.0, 0.0]))
