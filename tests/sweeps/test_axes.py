"""The grammar of --vary: what is read, and the sentence for what is not."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.core.errors import InputError
from stickslip.sweeps.axes import split_options, study_value, swept_keys


def values(name: str, given: object) -> tuple:
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
def test_values_are_si(name: str, given: object, expected: tuple) -> None:
    found = values(name, given)
    assert found == expected
    assert [type(value) for value in found] == [type(value) for value in expected]


def test_logarithmic_range_has_a_constant_factor_and_exact_ends() -> None:
    found = values("roughness.fractal_roughness", "1e-10 m:1e-7 m:4:log")
    assert (found[0], found[-1]) == (1e-10, 1e-7)
    assert np.diff(np.log10(found)) == pytest.approx(1.0)


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
    ("name", "given", "sentence"),
    [
        ("preload.force", "1,2", r"preload.force is not a key .* Did you mean preload"),
        ("centrifugal_force", "1,2", r"Did you mean preload.centrifugal_force\?"),
        ("study.title", "a,b", r"study.title does not change the answer"),
        ("output.mode_shapes", "1,2", r"output.mode_shapes does not change the answer"),
        ("excitation.direction", "1,2", r"excitation.direction holds a list"),
        ("preload.values", "1,2", r"preload.values holds a list"),
        ("rotation.point", "1,2", r"rotation.point holds a list"),
        ("structure.length_unit", "mm,m", r"structure.length_unit holds a text; a sweep varies keys that hold a quan"),
        ("forces.push.node", "1,2", r"forces.push.node holds the number of a node; "),
        ("excitation.mode", "sinlge", r"one of single, same, opposite. Did you mean \"single\"\?"),
        ("excitation.mode", "1:3:2", r"excitation.mode has the range \"1:3:2\", but it holds a choice"),
        ("preload.centrifugal_force", "-5", r"preload.centrifugal_force = -5 is not allowed: a value above 0 N"),
        ("preload.centrifugal_force", "5 mm", r"5 mm has \"mm\", a unit of length, but a force is needed"),
        ("preload.centrifugal_force", "nan", r"must be a finite number"),
        ("preload.centrifugal_force", "much", r"does not start with a number"),
        ("preload.centrifugal_force", "5,,6", r"empty value between commas"),
        ("preload.centrifugal_force", "5,5 N", r"the value 5 N twice"),
        ("preload.centrifugal_force", "50:10:1000", r"stop is not above its start. The third number is the count"),
        ("preload.centrifugal_force", "50:100", r"cannot be read. A range is start:stop:count"),
        ("preload.centrifugal_force", "50:100:3:lin", r"cannot be read"),
        ("preload.centrifugal_force", "50:100:2.5", r"count is 2.5: it must be a whole number from 2"),
        ("preload.centrifugal_force", "50:100:1", r"count is 1: "),
        ("friction.coefficient", "0.1:0.5:100000", r"count is 100000: "),
        ("preload.friction_coefficient_at_assembly", "0:0.3:3:log", r"logarithmic range must start above zero"),
        ("solver.harmonics", "1:4:3", r"holds 2.5, but this key takes whole numbers"),
        ("solver.harmonics", "2.5", r"solver.harmonics = 2.5 is not a whole number"),
        ("geometry.platform_angle", "20,30", r"has no unit. A plain number would be radian"),
        ("preload.centrifugal_force", (), r"has no values"),
        ("preload.centrifugal_force", (True,), r"must be a number"),
    ],
)
def test_what_cannot_be_read_is_said(name: str, given: object, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        swept_keys({name: given})


def test_nothing_to_vary_is_refused() -> None:
    with pytest.raises(InputError, match="no key to vary"):
        swept_keys({})


def test_options_of_the_command_line() -> None:
    assert split_options(["a.b=1,2", " c.d = x "]) == {"a.b": "1,2", "c.d": "x"}
    for wrong in ("a.b", "=1", "a.b="):
        with pytest.raises(InputError, match=r"must be section\.key=values"):
            split_options([wrong])
    with pytest.raises(InputError, match="given twice"):
        split_options(["a.b=1", "a.b=2"])
