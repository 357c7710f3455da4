"""Laws from plain numbers and lists. mypy checks this module in strict mode: the calls are those of a user."""

from dataclasses import MISSING, fields
from inspect import Parameter, signature

import numpy as np
import pytest

import stickslip as ss

LAWS: list[object] = [
    ss.CubicSpring(1e5, 1e15),
    ss.CubicSpring([1e5, 2e5], 1e15, rest_displacement=1e-6),
    ss.ElasticStop(1e6, 1e-4, spring=1e3, two_sided=True),
    ss.JenkinsElement(1e6, 10.0, 1e6, [[1.0, -1.0]], rest_normal_force=5.0),
    ss.IwanJoint(1e6, 10.0, -0.5, 0.1, path_to_rest=[[[1e-6], [0.0]]]),
    ss.CoulombLaw([1e6, 2e6], 1e6, 0.3, 100, 0, [[1.0, 2.0], [0.0, 0.0]]),
    ss.ExponentialContact(1e6, 1e6, 0.3, 100, residual_traction=((1.0, 2.0),)),
    ss.PressureGapLaw([1e-6], [0.0, 1e-6], (0.0, 1e6)),
    ss.MeasuredStiffness([1e5, 1e6], [1e12, 3e12], [1e12, 2e12]),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_numbers_and_lists_become_arrays(law: object) -> None:
    for name in signature(type(law)).parameters:
        value = getattr(law, name)
        assert value is None or isinstance(value, bool | str) or (isinstance(value, np.ndarray) and value.ndim), name


@pytest.mark.parametrize("law", dict.fromkeys(map(type, LAWS)), ids=lambda law: law.__name__)
def test_constructors_have_the_names_and_defaults_of_the_fields(law: type) -> None:
    """The constructors are written out, so that they accept more than the fields contain."""
    given = {
        name: (each.default, each.kind is Parameter.KEYWORD_ONLY) for name, each in signature(law).parameters.items()
    }
    wanted = {
        field.name: (Parameter.empty if field.default is MISSING else field.default, field.kw_only)
        for field in sorted(fields(law), key=lambda field: field.kw_only)  # type: ignore[arg-type, return-value]
    }
    assert list(given.items()) == list(wanted.items())
