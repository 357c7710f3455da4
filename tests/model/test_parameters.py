"""Inputs of a study as parameters: derivatives beside peaks of models that are meshed, reduced and solved again."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stickslip as ss
from peak_differences import SolvedPeak, built_again, solver_input
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from sweep_cases import quick_case

pytestmark = pytest.mark.slow


@cache
def peak_of(case: Case) -> SolvedPeak:
    return SolvedPeak.of(solver_input(case), (400.0, 500.0), 1, 64, 3e-4)


@cache
def parameters_of_case(case: Case) -> dict[str, ss.Parameter]:
    return {each.name: each for each in ss.case_parameters(case, ss.build_model(case))}


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "modes"),
    [
        ("friction.coefficient", 8),
        pytest.param("geometry.contact_face_width", 30, marks=pytest.mark.slow),
        *[
            pytest.param(name, 200, marks=pytest.mark.slow)
            for name in (
                "geometry.width = damper_length", "geometry.blade_length", "geometry.platform_angle",
                "material.poisson_ratio", "roughness.fractal_dimension", "preload.centrifugal_force",
            )
        ],
    ],
)  # fmt: skip
def test_derivatives_are_those_of_models_that_are_built_again(
    name: str, modes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STICKSLIP_CACHE", "off")
    case = quick_case().replace({"reduction.modes": modes})
    peak, parameter = peak_of(case), parameters_of_case(case)[name]
    # The fractal dimension changes the stiffness by its tenth power: with these few samples, the touchdown of a pair
    # passes a sample within 1e-4 of it. The curvature of the curve jumps there, and differences mix both sides.
    step = 1e-5 if name == "roughness.fractal_dimension" else 1e-4
    found = peak.gradient(replace(parameter, step=step * parameter.value)) * parameter.value
    expected, values = peak.differences(built_again(case, name), step), peak.sensitivity.values
    # 1e-4 of the value: differences of reduced models have errors by truncation and round-off of this size.
    assert found[:2] == pytest.approx(expected[:2], rel=1e-3, abs=1e-4 * float(values[0]))
    assert found[2] == pytest.approx(expected[2], rel=5e-3, abs=3e-3 * float(values[2]))


def test_the_density_only_lowers_the_frequency() -> None:
    case = quick_case().replace({"reduction.modes": 30})
    peak, parameter = peak_of(case), parameters_of_case(case)["material.density"]
    amplitude, hertz, energy = peak.gradient(parameter) * parameter.value / peak.sensitivity.values
    # The motion of the mesh is that of the reduced model with an estimate of what its modes leave out.
    assert hertz == pytest.approx(-0.5, rel=1e-5)
    assert amplitude == pytest.approx(0.0, abs=1e-4)
    assert energy == pytest.approx(0.0, abs=1e-3)


def test_each_number_of_the_study_is_a_parameter() -> None:
    case = quick_case().replace({"material.fatigue_limit": "450 MPa", "material.tensile_strength": "1 GPa"})
    parameters = parameters_of_case(case)
    assert not {"material.fatigue_limit", "material.tensile_strength"} & parameters.keys()  # no motion depends on them
    assert parameters["geometry.platform_angle"].unit == "deg"
    assert parameters["geometry.platform_angle"].value == pytest.approx(30.0)
    assert parameters["geometry.width = damper_length"].value == pytest.approx(28.0)
    assert parameters["roughness.fractal_dimension"].unit == "1"
    assert parameters["damping.modal_damping_ratio"].value == 0.001
    given = case.geometry.model_dump(exclude_none=True)  # type: ignore[attr-defined]
    dimensions = {f"geometry.{key}" for key in given}
    joined = {"geometry.width", "geometry.damper_length"}
    assert dimensions - joined <= parameters.keys()
    assert not {"geometry.width", "preload.friction_coefficient_at_assembly", "solver.tolerance"} & parameters.keys()


def test_values_that_have_no_derivative_are_rejected() -> None:
    case = quick_case().replace({"geometry.damper_length": "20 mm"})
    model = ss.build_model(case)
    parameters = {each.name: each for each in ss.case_parameters(case, model)}
    assert "geometry.damper_length" in parameters
    with rejects(InputError, "roughness.domain_extension"):
        parameters["roughness.domain_extension"].change(0.9999)
    with rejects(InputError):  # the force is at the nearest node
        parameters["geometry.excitation_height"].change(20.0)
    with rejects(InputError, "output"):
        ss.case_parameters(case, model, "no output")


@pytest.mark.long
def test_rayleigh_damping() -> None:
    """Rayleigh damping follows the changed matrices."""
    case = quick_case().replace({"damping.rayleigh_alpha": "8 1/s", "reduction.modes": 30})
    peak = SolvedPeak.of(solver_input(case), (400.0, 500.0), 1, 64, 3e-4)
    parameters = parameters_of_case(case)
    for name in ("damping.rayleigh_alpha", "material.density"):
        parameter = parameters[name]
        found, expected = peak.gradient(parameter), peak.differences(built_again(case, name), 1e-4) / parameter.value
        noise = 1e-5 * peak.sensitivity.values / parameter.value
        assert (np.abs(found - expected) <= 1e-3 * np.abs(expected) + noise).all(), name
