"""The grammar of --vary: what is read, and the sentence for what is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.sweeps.axes import split_options, study_value, swept_keys


def values(name: str, given: Any) -> tuple[Any, ...]:
    return swept_keys({name: given})[0].values


@pytest.mark.parametrize(
    ("name", "given", "expected"),
    [
        ("preload.centrifugal_force", "50,100, 300 N,1 kN", (50.0, 100.0, 300.0, 1000.0)),
        ("preload.centrifugal_force", "50:1000:3", (50.0, 525.0, 1000.0)),
        ("preload.centrifugal_force", "100 N:1 kN:3", (100.0, 550.0, 1000.0)),
        ("preload.centrifugal_force", "10,100:300:3", (10.0, 100.0, 200.0, 300.0)),
        ("friction.coefficient", "0.1:0.3:3", (0.1, 0.2, 0.3)),
        ("excitation.mode", "single,same,opposite", ("single", "same", "opposite")),
        ("roughness.mode", "consistent,paper", ("consistent", "varying-curvature")),
        ("solver.harmonics", "1:5:3", (1, 3, 5)),
        ("solver.harmonics", "3", (3,)),
        ("damping.rayleigh_beta", "1e-7 s,2e-7", (1e-7, 2e-7)),
        ("preload.centrifugal_force", (300, "0.5 kN", np.float64(700.0)), (300.0, 500.0, 700.0)),
        ("roughness.ridges", np.array([5, 10]), (5, 10)),
        ("roughness.reference_area", "25 mm^2:1 cm^2:2", (25e-6, 1e-4)),
    ],
)
def test_values_are_si(name: str, given: Any, expected: tuple[Any, ...]) -> None:
    actual = values(name, given)
    assert actual == expected
    assert [type(value) for value in actual] == [type(value) for value in expected]


def test_logarithmic_range_has_a_constant_factor_and_exact_ends() -> None:
    actual = values("roughness.fractal_roughness", "1e-10 m:1e-7 m:4:log")
    assert (actual[0], actual[-1]) == (1e-10, 1e-7)
    assert np.diff(np.log10(actual)) == pytest.approx(1.0)


def test_labels_and_shown_numbers_are_in_the_unit_of_engineers() -> None:
    key = swept_keys({"geometry.platform_angle": "20 deg:40 deg:3"})[0]
    assert key.labels == ("20 deg", "30 deg", "40 deg")
    assert key.shown == pytest.approx((20.0, 30.0, 40.0))
    assert (key.unit, key.shown_unit) == ("rad", "deg")
    assert study_value(key, 1) == f"{key.values[1]!r} rad"
    assert swept_keys({"interfaces.sole.points": "nodes,quadrature"})[0].labels == ("nodes", "quadrature")
    choice = swept_keys({"excitation.mode": "same"})[0]
    assert choice.is_choice
    assert (choice.labels, choice.shown, study_value(choice, 0)) == (("same",), (), "same")


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("preload.force", "1,2"),
        ("centrifugal_force", "1,2"),
        ("study.title", "a,b"),
        ("output.mode_shapes", "1,2"),
        ("excitation.direction", "1,2"),
        ("preload.values", "1,2"),
        ("rotation.point", "1,2"),
        ("structure.length_unit", "mm,m"),
        ("forces.push.node", "1,2"),
        ("excitation.mode", "sinlge"),
        ("excitation.mode", "1:3:2"),
        ("preload.centrifugal_force", "-5"),
        ("preload.centrifugal_force", "5 mm"),
        ("preload.centrifugal_force", "nan"),
        ("preload.centrifugal_force", "much"),
        ("preload.centrifugal_force", "5,,6"),
        ("preload.centrifugal_force", "5,5 N"),
        ("preload.centrifugal_force", "50:10:1000"),
        ("preload.centrifugal_force", "50:100"),
        ("preload.centrifugal_force", "50:100:3:lin"),
        ("preload.centrifugal_force", "50:100:2.5"),
        ("preload.centrifugal_force", "50:100:1"),
        ("friction.coefficient", "0.1:0.5:100000"),
        ("preload.friction_coefficient_at_assembly", "0:0.3:3:log"),
        ("solver.harmonics", "1:4:3"),
        ("solver.harmonics", "2.5"),
        ("geometry.platform_angle", "20,30"),
        ("preload.centrifugal_force", ()),
        ("preload.centrifugal_force", (True,)),
    ],
)
def test_what_cannot_be_read_is_reported(name: str, given: Any) -> None:
    with rejects(InputError, name):
        swept_keys({name: given})


def test_nothing_to_vary_is_rejected() -> None:
    with rejects(InputError):
        swept_keys({})


def test_options_of_the_command_line() -> None:
    assert split_options(["a.b=1,2", " c.d = x "]) == {"a.b": "1,2", "c.d": "x"}
    # one section alone has the first key, several the second one
    assert split_options(["damper_mass=5g:50g"]) == {"preload.damper_mass": "5g:50g"}
    assert split_options(["amplitude=1 N"]) == {"amplitude": "1 N"}
    # of two blades; a sector of a disk has a platform angle in another section
    two_blades = ss.TwoBladeCase()
    assert split_options(["platform_angle=1 deg"]) == {"platform_angle": "1 deg"}
    assert split_options(["platform_angle=1 deg"], case=two_blades) == {"geometry.platform_angle": "1 deg"}
    with pytest.raises(InputError, match=r"Did you mean geometry\.platform_angle\?"):
        swept_keys({"damper.platform_angle": "20 deg"}, two_blades)
    for wrong in ("a.b", "=1", "a.b="):
        with rejects(InputError):
            split_options([wrong])
    with rejects(InputError):
        split_options(["a.b=1", "a.b=2"])
