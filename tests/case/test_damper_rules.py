"""Kinds of dampers in study files: defaults that belong to a wedge, keys of another kind, contradictions."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sentences import printed_sentence
from stickslip.case.case import Case, TwoBladeCase
from stickslip.case.two_blade_sections import CylindricalSection, FlatSection, GeometrySection, WedgeSection
from stickslip.core.errors import StudyFileError

FLAT, ROUND = {"damper.kind": "flat"}, {"damper.kind": "cylindrical"}


def test_a_wedge_is_the_default() -> None:
    case = TwoBladeCase()
    assert case.damper == WedgeSection()
    assert Case.from_mapping({"damper": {"kind": "wedge"}}) == case


@pytest.mark.parametrize(
    ("text", "damper", "angle"),
    [
        ('[damper]\nkind = "flat"\nthickness = "3 mm"', FlatSection(thickness=0.003), 0.0),
        ('[damper]\nkind = "cylindrical"\ncrowning = "2 um"', CylindricalSection(crowning=2e-6), math.radians(30.0)),
    ],
)
def test_defaults_of_a_wedge_are_switched_off(text: str, damper: object, angle: float) -> None:
    case = Case.from_text(text)
    assert isinstance(case, TwoBladeCase)
    assert case.damper == damper
    assert case.geometry.damper_flank_height is None
    assert case.geometry.platform_angle == pytest.approx(angle)
    assert (case.roughness is None) == isinstance(damper, CylindricalSection)
    assert Case.from_mapping(case.to_dict()) == case
    assert Case.from_text(case.to_text()) == case
    assert case.replace({"preload.centrifugal_force": "300 N"}).replace({"preload.centrifugal_force": "500 N"}) == case


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({**FLAT, "geometry.platform_angle": "30 deg"}, "geometry.platform_angle"),
        ({**FLAT, "geometry.right_platform_angle": "5 deg"}, "geometry.right_platform_angle"),
        ({"geometry.platform_angle": "0 deg"}, "geometry.platform_angle"),
        ({**ROUND, "geometry.platform_angle": "0 deg"}, "geometry.platform_angle"),
        ({**FLAT, "geometry.damper_flank_height": "2 mm"}, "geometry.damper_flank_height"),
        ({**FLAT, "damper.radius": "5 mm"}, "damper.radius"),
        ({**ROUND, "damper.thickness": "5 mm"}, "damper.thickness"),
        ({"damper.crowning": "5 um"}, "damper.crowning"),
        ({"damper.kind": "round"}, "damper.kind"),
        ({**ROUND, "damper.radius": "0 mm"}, "damper.radius"),
        ({**ROUND, "damper.radius": "0.5 mm", "damper.crowning": "600 um"}, "damper.crowning"),
        ({**ROUND, "roughness.sq": "2 um"}, "roughness"),
        (
            {**ROUND, "analysis.kind": "wear", "analysis.energy_wear_coefficient": "1e-5 mm^3/J"},
            "analysis.kind",
        ),
        (
            {
                **ROUND,
                "contact_stiffness.stiffness_law": "constant",
                "contact_stiffness.stiffness_constants": {"normal_stiffness": 1e12, "tangential_stiffness": 1e12},
            },
            "contact_stiffness.stiffness_law",
        ),
    ],
)
def test_keys_that_contradict_the_damper(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(StudyFileError) as found:
        TwoBladeCase().replace(changes)
    assert key in found.value.keys
    printed_sentence(str(found.value), key)


def test_a_wedge_has_flanks() -> None:
    with pytest.raises(ValueError, match="flanks"):
        TwoBladeCase(geometry=GeometrySection(damper_flank_height=None))


def test_a_measured_stiffness_of_a_line_is_allowed() -> None:
    stiffness = {"contact_stiffness.normal_stiffness": 1e9, "contact_stiffness.tangential_stiffness": 8e8}
    assert TwoBladeCase().replace({**ROUND, **stiffness}).roughness is None
