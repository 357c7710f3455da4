"""Ranges of keys that change continuously, for a design and for a ridge of peaks."""

from __future__ import annotations

import pytest

from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.key_ranges import CaseFamily, continuous_quantity, ridge_of_study, rising_range
from stickslip.core.errors import InputError, StudyFileError
from stickslip.sweeps.design_space import DesignSpace

FORCE, ANGLE = "preload.centrifugal_force", "geometry.platform_angle"


def test_a_range_is_in_si_units_with_and_without_units() -> None:
    quantity = continuous_quantity(FORCE, Case(), "a design")
    assert rising_range(FORCE, quantity, ("50 N", "5 kN")) == (50.0, 5000.0)
    assert rising_range(FORCE, quantity, ("50", 5000.0)) == (50.0, 5000.0)


@pytest.mark.parametrize("purpose", ["a design", "a ridge of peaks"])
@pytest.mark.parametrize("name", ["preload.nonsense", "excitation.mode", "solver.harmonics", "solver.frequency_stop"])
def test_a_key_that_does_not_change_continuously_is_rejected(name: str, purpose: str) -> None:
    with rejects(InputError, name):
        continuous_quantity(name, Case(), purpose)


@pytest.mark.parametrize("limits", [("5 kN", "50 N"), ("50 N", "50 N"), ("50 m", "5 km")])
def test_designs_and_ridges_reject_the_same_ranges_in_the_same_words(limits: tuple[str, str]) -> None:
    with rejects(InputError, FORCE) as of_ridge:
        CaseFamily.of(Case(), FORCE).bounds(limits)
    with pytest.raises(InputError) as of_design:
        DesignSpace.of(Case(), {FORCE: limits}, {})
    assert str(of_design.value) == str(of_ridge.value)


def test_a_ridge_is_above_zero_and_a_design_may_begin_there() -> None:
    with rejects(InputError, ANGLE):
        CaseFamily.of(Case(), ANGLE).bounds(("0 deg", "30 deg"))
    (key,) = DesignSpace.of(Case(), {ANGLE: ("0 deg", "30 deg")}, {}).keys
    assert key.low == 0.0


def test_the_ridge_of_a_study() -> None:
    assert ridge_of_study(Case()) is None
    study = Case().replace({"analysis.kind": "ridge", "analysis.over_from": "100 N", "analysis.over_to": 200})
    ridge = ridge_of_study(study)
    assert ridge is not None
    family, bounds = ridge
    assert (family.key, bounds) == (FORCE, (100.0, 200.0))
    assert not family.changes_structure
    assert CaseFamily.of(Case(), ANGLE).changes_structure
    assert family.at(150.0) == study.replace({FORCE: 150.0})


def test_the_ends_of_a_ridge_are_valid_studies() -> None:
    length = "roughness.shortest_length"
    with rejects(StudyFileError, length):
        CaseFamily.of(Case(), length).bounds(("1 um", "1 m"))  # longer than the longest wave
