"""The part of the ranges of a design in which friction locks the damper of two blades."""

from __future__ import annotations

from math import atan, degrees
from pathlib import Path

from design_cases import LIMIT, jenkins_case
from sentences import printed_sentence
from stickslip.case.case import Case
from stickslip.sweeps.axes import Vary
from stickslip.sweeps.design_lock_up import lock_up_in_ranges
from stickslip.sweeps.design_space import DesignSpace

ANGLE, RIGHT, FRICTION = "geometry.platform_angle", "geometry.right_platform_angle", "friction.coefficient"


def sentences(over: dict[str, str], worst_of: Vary | None = None, **values: object) -> list[str]:
    """On the default study, with a friction coefficient of 0.3."""
    case = Case().replace({FRICTION: 0.3} | {key.replace("__", "."): value for key, value in values.items()})
    return list(lock_up_in_ranges(DesignSpace.of(case, over, worst_of or {})))


def test_the_angle_of_lock_up_is_that_of_the_friction_cones() -> None:
    (words,) = sentences({ANGLE: "15 deg:80 deg"})
    printed_sentence(words)
    assert f"from a mean platform angle of {90.0 - degrees(atan(0.3)):.4g} deg on" in words
    assert sentences({ANGLE: "15 deg:73.2 deg"}) == []
    assert sentences({ANGLE: "15 deg:73.4 deg"}) != []


def test_a_range_of_the_friction_coefficient_has_two_angles() -> None:
    (words,) = sentences({ANGLE: "15 deg:60 deg", FRICTION: "0.2:0.8"})
    printed_sentence(words)
    assert sentences({ANGLE: "15 deg:60 deg", FRICTION: "0.2:0.5"}) == []


def test_load_cases_with_more_friction_count() -> None:
    (words,) = sentences({ANGLE: "15 deg:60 deg"}, {FRICTION: "0.2,0.8"})
    assert words == sentences({ANGLE: "15 deg:60 deg", FRICTION: "0.2:0.8"})[0]


def test_at_one_angle_the_friction_coefficient_of_lock_up_is_named() -> None:
    (words,) = sentences({FRICTION: "0.2:1.2"}, geometry__platform_angle="45 deg")
    printed_sentence(words)
    assert "from a friction coefficient of 1 on" in words


def test_the_mean_of_two_angles_counts() -> None:
    over = {RIGHT: "20 deg:80 deg"}
    assert sentences(over, geometry__platform_angle="30 deg", geometry__right_platform_angle="30 deg") == []
    (words,) = sentences(over, geometry__platform_angle="70 deg", geometry__right_platform_angle="30 deg")
    assert "mean angles of 45 to 75 deg" in words


def test_a_range_that_is_locked_everywhere() -> None:
    (words,) = sentences({ANGLE: "75 deg:80 deg"})
    assert words.startswith("Friction locks the damper in the whole of these ranges")


def test_other_keys_and_other_structures_lock_nothing(tmp_path: Path) -> None:
    assert sentences({"preload.centrifugal_force": "50 N:5 kN"}) == []
    assert list(lock_up_in_ranges(DesignSpace.of(jenkins_case(tmp_path), {LIMIT: "2 N:15 N"}, {}))) == []
