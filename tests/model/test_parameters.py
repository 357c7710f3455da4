"""Inputs of a study as parameters: derivatives beside peaks of models that are meshed, reduced and solved again."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import stickslip as ss
from peak_differences import SolvedPeak
from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.continuous_keys import continuous_keys
from stickslip.core.errors import InputError
from stickslip.solve.solver_input import SolverInput
from sweep_cases import quick_case


def solver_input(case: Case) -> SolverInput:
    model = ss.build_model(case)
    output = next(iter(model.outputs.values()))
    return SolverInput(
        model.superelement, model.pairs, model.excitation, output, case.damping.modal_damping_ratio
    )  # fmt: skip


@cache
def peak_of(case: Case) -> SolvedPeak:
    return SolvedPeak.of(solver_input(case), (400.0, 500.0), 1, 64, 3e-4)


def resolved(case: Case, name: str) -> ss.Parameter:
    """A parameter that meshes, reduces and solves its model again."""
    keys = [key for key in continuous_keys(case) if name.startswith(key.path) or key.path in _joined(name)]

    def change(factor: float) -> SolverInput:
        changed = case
        for key in keys:
            changed = key.changed(changed, key.shown * factor)
        return solver_input(changed)

    return ss.Parameter(name, "1", 1.0, change, 1e-4)


def _joined(name: str) -> list[str]:
    first, *others = name.split(" = ")
    return [first, *(f"geometry.{other}" for other in others)]


@pytest.mark.parametrize(
    ("name", "fine"),
    [
        ("friction.coefficient", False),
        ("geometry.contact_face_width", False),
        *[
            pytest.param(name, True, marks=pytest.mark.slow)
            for name in (
                "geometry.width = damper_length", "geometry.blade_length", "geometry.airfoil_thickness",
                "geometry.platform_angle", "geometry.underside_height_at_shank", "geometry.shank_thickness_at_base",
                "geometry.inner_overhang", "geometry.platform_gap", "geometry.shank_thickness_at_platform",
                "material.young_modulus", "material.poisson_ratio", "roughness.fractal_dimension",
                "roughness.fractal_roughness", "roughness.hardness", "preload.centrifugal_force",
            )
        ],
    ],
)  # fmt: skip
def test_derivatives_are_those_of_models_that_are_built_again(
    name: str, fine: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STICKSLIP_CACHE", "off")
    case = quick_case().replace({"reduction.modes": 200 if fine else 30})
    peak, model = peak_of(case), ss.build_model(case)
    parameter = next(each for each in ss.case_parameters(case, model) if each.name == name)
    found = peak.gradient(parameter) * parameter.value
    step = 1e-5 if name == "roughness.fractal_dimension" else 1e-4  # it changes the stiffness by its tenth power
    expected, values = peak.differences(resolved(case, name), step), peak.values(peak.base)
    # 1e-4 of the value: differences of reduced models have errors by truncation and round-off of this size.
    assert found[:2] == pytest.approx(expected[:2], rel=1e-3, abs=1e-4 * float(values[0]))
    assert found[2] == pytest.approx(expected[2], rel=5e-3, abs=3e-3 * float(values[2]))


def test_the_density_only_lowers_the_frequency() -> None:
    case = quick_case().replace({"reduction.modes": 30})
    peak, model = peak_of(case), ss.build_model(case)
    parameter = next(each for each in ss.case_parameters(case, model) if each.name == "material.density")
    amplitude, hertz, energy = peak.gradient(parameter) * parameter.value / peak.values(peak.base)
    # The motion of the mesh is that of the reduced model with an estimate of what its modes leave out.
    assert hertz == pytest.approx(-0.5, rel=1e-5)
    assert amplitude == pytest.approx(0.0, abs=1e-4)
    assert energy == pytest.approx(0.0, abs=1e-3)


def test_each_number_of_the_study_is_a_parameter() -> None:
    case = quick_case()
    parameters = {each.name: each for each in ss.case_parameters(case, ss.build_model(case))}
    assert parameters["geometry.platform_angle"].unit == "deg"
    assert parameters["geometry.platform_angle"].value == pytest.approx(30.0)
    assert parameters["geometry.width = damper_length"].value == pytest.approx(28.0)
    assert parameters["roughness.fractal_dimension"].unit == "1"
    assert parameters["damping.modal_damping_ratio"].value == 0.001
    dimensions = {f"geometry.{key}" for key in type(case.geometry).model_fields}  # type: ignore[attr-defined]
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


@pytest.mark.slow
def test_rayleigh_damping() -> None:
    """Rayleigh damping follows the changed matrices."""
    rayleigh = {"damping.rayleigh_alpha": "3 1/s", "damping.rayleigh_beta": "2e-7 s", "reduction.modes": 30}
    case = quick_case().replace(rayleigh)
    peak = SolvedPeak.of(solver_input(case), (400.0, 500.0), 1, 80, 3e-4)
    parameters = {each.name: each for each in ss.case_parameters(case, ss.build_model(case))}
    for name in ("damping.rayleigh_alpha", "damping.rayleigh_beta", "material.density"):
        parameter = parameters[name]
        found, expected = peak.gradient(parameter), peak.differences(resolved(case, name), 1e-4) / parameter.value
        noise = 1e-5 * peak.values(peak.base) / parameter.value
        assert (np.abs(found - expected) <= 1e-3 * np.abs(expected) + noise).all(), name
