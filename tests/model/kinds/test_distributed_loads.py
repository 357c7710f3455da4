"""Pressures and gravity of a study: loads of a solved preload, state at rest, and entries that do not fit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from own_cases import MATRIX_STUDY, mesh_case
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import StudyFileError
from stickslip.model.kinds.distributed_loads import load_sizes
from stickslip.model.model import Model, build_model, load_joint, set_up
from stickslip.study.check import check
from stickslip.study.solution import solve_case
from stickslip.sweeps.plan import case_hashes

PRESSED = {"lid": {"set": "damper_top", "pressure": "0.5 MPa"}}
WEIGHT = {"direction": [0, 0, -2], "acceleration": "5e4 m/s^2"}
AREA, BLOCK = 160e-6, 8200.0 * 0.02 * 0.008 * 0.006  # m2, kg


def loaded_case(**sections: Any) -> Case:
    """The block on the beam without its lid, pressed by static loads alone."""
    data = mesh_case().to_dict() | {"preload": {"method": "solved"}} | sections
    del data["interfaces"]["lid"], data["interfaces"]["sole"]["normal_load"]
    return Case.from_mapping(data)


def built(case: Case) -> Model:
    setup = set_up(case)
    return build_model(case, setup.assemble(), load_joint(case, setup.layout))


@pytest.mark.slow
def test_the_normal_load_of_a_face_is_the_pressure_and_the_weight_above_it() -> None:
    model = built(loaded_case(pressures=PRESSED, gravity=WEIGHT))
    expected = 0.5e6 * AREA + 5e4 * BLOCK
    assert model.joint.preload.sum() == pytest.approx(expected, rel=1e-7)
    only_weight = built(loaded_case(gravity=WEIGHT))
    assert only_weight.joint.preload.sum() == pytest.approx(5e4 * BLOCK, rel=1e-5)


@pytest.mark.slow
def test_the_full_mesh_is_in_balance_in_its_stress_at_rest() -> None:
    """The mean displacement of the stress: off the contact, K u is the load of pressure and weight at every node."""
    pressures = PRESSED | {"end": {"set": "tip", "pressure": "3 MPa"}}
    case = loaded_case(pressures=pressures, gravity=WEIGHT, analysis={"stiffness_band": False})
    solution = solve_case(case.replace({"solver.frequency_stop": "1650 Hz"}))
    model, stress = solution.model, solution.stress
    structure = model.structure
    assert isinstance(structure, ss.Structure)
    assert stress is not None
    assert stress.static == "solved"
    mesh = structure.mesh
    load = ss.pressure_load(mesh, "damper_top", 0.5e6) + ss.pressure_load(mesh, "tip", 3e6)
    load += ss.gravity_load(mesh, structure.materials, (0.0, 0.0, -5e4))
    outer = structure.gather(load[:, None])[:, 0]
    residual = outer - structure.stiffness @ stress.displacement[structure.free_unknowns, 0]
    touched = np.isin(structure.node, model.joint.layout.face_pairs.nodes)
    assert np.abs(residual[~touched]).max() < 1e-8 * np.abs(outer).max()
    block = np.isin(structure.node, mesh.nodes_of_body(1))
    assert residual[touched & block][2::3].sum() == pytest.approx(-model.joint.preload.sum(), rel=1e-5)


@pytest.mark.slow
def test_check_shows_the_resultants() -> None:
    rows = dict(dict(check(loaded_case(pressures=PRESSED, gravity=WEIGHT)))["Derived quantities"])
    assert rows["Static force, pressures.lid"] == "0, 0, -80 N"
    whole = BLOCK + 7850.0 * 0.06 * 0.01 * 0.008
    assert rows["Static force, gravity"] == f"0, 0, {-5e4 * whole:.4g} N"


def test_cases_of_a_sweep_share_the_structure_unless_a_load_acts_elsewhere() -> None:
    case = loaded_case(pressures=PRESSED, gravity=WEIGHT)
    keys = {"pressures.lid.pressure": "1 MPa", "gravity.acceleration": "9.81 m/s^2"}
    other = case.replace(keys)
    assert case_hashes(other)[1] == case_hashes(case)[1]
    assert case_hashes(other)[0] != case_hashes(case)[0]
    assert case_hashes(case.replace({"pressures.lid.set": "tip"}))[1] != case_hashes(case)[1]
    assert case_hashes(loaded_case(pressures=PRESSED))[1] != case_hashes(case)[1]
    assert load_sizes(other) == {"gravity": pytest.approx((0.0, 0.0, -9.81)), "pressures.lid": (1e6,)}  # type: ignore[arg-type]


def test_a_study_file_contains_its_loads() -> None:
    case = loaded_case(pressures=PRESSED, gravity=WEIGHT)
    again = Case.from_text(case.to_text())
    assert again.to_dict() == case.to_dict()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pressures", "keys"),
    [
        pytest.param({"a": {"set": "cover", "pressure": "1 MPa"}}, ("pressures.a.set",), id="unknown"),
        pytest.param({"a": {"set": "root", "pressure": "1 MPa"}}, ("pressures.a.set",), id="constrained"),
        pytest.param(
            {"a": {"set": "beam_top", "pressure": "1 MPa"}}, ("pressures.a.set", "interfaces.sole"), id="contact"
        ),
    ],
)
def test_a_pressure_that_cannot_act_is_rejected(pressures: dict[str, Any], keys: tuple[str, ...]) -> None:
    case = loaded_case(pressures=pressures)
    with rejects(ss.InputError, *keys):
        set_up(case)


def prescribed(section: str, content: dict[str, Any]) -> dict[str, Any]:
    return mesh_case().to_dict() | {section: content}


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        pytest.param(prescribed("pressures", PRESSED), ("pressures",), id="pressure-prescribed"),
        pytest.param(prescribed("gravity", WEIGHT), ("gravity",), id="gravity-prescribed"),
        pytest.param(prescribed("gravity", {"direction": [0, 0, 0]}), ("gravity.direction",), id="zero-direction"),
        pytest.param(
            prescribed("gravity", {"direction": [0, 0, 1], "acceleration": "0 m/s^2"}),
            ("gravity.acceleration",),
            id="zero-acceleration",
        ),
        pytest.param(prescribed("gravity", {}), ("gravity.direction",), id="no-direction"),
        pytest.param(prescribed("pressures", {"a": {"set": "tip"}}), ("pressures.a.pressure",), id="no-pressure"),
        pytest.param(prescribed("pressures", {"a": {"pressure": "1 MPa"}}), ("pressures.a.set",), id="no-set"),
        pytest.param(
            prescribed("pressures", {"a": {"set": "tip", "pressure": "1 N"}}), ("pressures.a.pressure",), id="unit"
        ),
        pytest.param(
            prescribed("pressures", {"a": {"set": "tip", "pressure": 2.0}}), ("pressures.a.pressure",), id="no-unit"
        ),
    ],
)
def test_entries_that_do_not_fit_are_rejected(data: dict[str, Any], keys: tuple[str, ...]) -> None:
    with rejects(StudyFileError, *keys):
        Case.from_mapping(data)


def test_matrices_have_neither_faces_nor_the_mass_of_their_bodies() -> None:
    for section in ("[gravity]\ndirection = [0, 0, -1]\n", '[pressures.a]\nset = "lid"\npressure = "1 MPa"\n'):
        with rejects(StudyFileError, section[1:].partition("]")[0].partition(".")[0]):
            Case.from_text(MATRIX_STUDY + section)
