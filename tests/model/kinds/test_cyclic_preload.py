"""The state at rest of a disk at its speed, solved in one sector, against the ring of all sectors and equilibrium."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.core.errors import StudyFileError
from stickslip.model.kinds.cyclic import CyclicSetup
from stickslip.model.model import Model, build_model, set_up
from stickslip.reporting.page import page
from stickslip.structure.body_load import centrifugal_load
from stickslip.study.disk import DiskOfStudy
from stickslip.study.solution import solve_case

STIFFNESS = {"normal_stiffness": "20 N/um", "tangential_stiffness": "15 N/um"}


def disk(speed_rpm: float = 3000.0, residual: str = "released", **sections: Any) -> Case:
    """A coarse disk of six sectors whose dampers the rotation presses against the platforms."""
    content = copy.deepcopy(EXAMPLES["bladed-disk"])
    for interface in content["interfaces"].values():
        del interface["normal_load"]
    del content["roughness"]
    content["structure"] = {"kind": "cyclic", "contact_columns": 2, "contact_rows": 2, "sectors": 6}
    solved = {"method": "solved", "residual_traction": residual}
    content |= {"contact_stiffness": STIFFNESS, "friction": {"coefficient": 0.3}, "preload": solved}
    content |= {"rotation": {"speed": f"{speed_rpm} rpm"}, "reduction": {"modes": 8}}
    content |= {"analysis": {"stiffness_band": False}, "output": {"figure_formats": []}}
    content["solver"] = {"frequency_start": "560 Hz", "frequency_stop": "600 Hz", "harmonics": 1, "samples": 64}
    return Case.from_mapping(content | sections)


def force_on_damper(model: Model, mesh: ss.Mesh) -> Any:
    """(3,) N, the contact force on the damper at rest."""
    assert model.preload is not None
    state = model.preload.state
    local = np.column_stack([state.traction, state.normal_force]).ravel()
    operator = model.joint.face_pairs.mesh_operator(2 * mesh.n_nodes)
    return (operator.T @ local).reshape(-1, 3)[mesh.nodes_of_body(1)].sum(axis=0)


@pytest.mark.long
@pytest.mark.parametrize("residual", ["released", "kept"])
def test_the_state_at_rest_is_that_of_the_full_ring(residual: str) -> None:
    case = disk(residual=residual)
    model = build_model(case)
    assert model.preload is not None
    found = DiskOfStudy.of(case, model)
    assert found is not None
    ring, layout = found.ring, found.ring_layout(model.joint.layout)
    setup = set_up(case)
    assert isinstance(setup, CyclicSetup)
    materials = setup.sector.materials
    whole = ss.assemble_bodies(ring.mesh, materials, fixed_nodes=ring.mesh.node_set("bore"))
    rotor = ss.rotating(whole, (0.0, 0.0, 1.0), free_bodies="at rest")
    pairs = layout.face_pairs
    superelement = ss.craig_bampton(rotor.at(3000.0), np.unique(pairs.nodes), n_modes=8)
    load = superelement.recovery.project(centrifugal_load(ring.mesh, materials, np.eye(3)[2], np.zeros(3))[:, None])
    np.testing.assert_allclose(layout.unit_loads["rotation"][:, 0], rotor.load, rtol=0.0, atol=1e-9 * rotor.load.max())
    joint = model.joint
    normal, tangential = (np.tile(each, 6) for each in (joint.normal_stiffness, joint.tangential_stiffness))
    touching = ss.ContactPairs(
        superelement.operator(pairs), normal, tangential, friction_coefficient=0.3, normal_load=0.0
    )
    speed = 3000.0 * np.pi / 30.0
    state = ss.static_preload(superelement, touching, speed**2 * load[:, 0], friction=residual == "kept")
    largest = state.normal_force.max()
    own = model.preload.state
    assert (own.normal_force > 0.0).any()
    np.testing.assert_allclose(state.normal_force, np.tile(own.normal_force, 6), atol=1e-6 * largest)
    np.testing.assert_allclose(state.gap, np.tile(own.gap, 6), atol=1e-6 * max(own.gap.max(), largest / 2e7))
    if residual == "kept":
        np.testing.assert_allclose(state.traction, np.tile(own.traction, (6, 1)), atol=1e-6 * largest)


@pytest.mark.long
def test_normal_loads_grow_with_the_square_of_the_speed() -> None:
    """The contact forces of the damper balance its centrifugal force at each speed."""
    for speed_rpm in (1500.0, 3000.0):
        case = disk(speed_rpm)
        setup = set_up(case)
        assert isinstance(setup, CyclicSetup)
        mesh, model = setup.sector.mesh, build_model(case)
        at_one = setup.layout.unit_loads["rotation"].reshape(-1, 3)[mesh.nodes_of_body(1)].sum(axis=0)
        expected = (speed_rpm * np.pi / 30.0) ** 2 * at_one
        assert np.linalg.norm(expected) > 50.0
        np.testing.assert_allclose(force_on_damper(model, mesh), expected, atol=1e-9 * float(np.linalg.norm(expected)))


@pytest.mark.long
def test_a_constant_force_on_each_damper_adds_to_the_rotation() -> None:
    push = {"push": {"set": "damper middle", "direction": [1, 0, 0], "force": "100 N"}}
    forces = []
    sections: list[dict[str, Any]] = [{}, {"static_loads": push}]
    for loads in sections:
        case = disk(**loads)
        setup = set_up(case)
        assert isinstance(setup, CyclicSetup)
        forces.append(force_on_damper(build_model(case), setup.sector.mesh))
    np.testing.assert_allclose(forces[1] - forces[0], [100.0, 0.0, 0.0], atol=1e-6)


@pytest.mark.long
def test_the_page_of_a_disk_with_a_solved_preload() -> None:
    solution = solve_case(disk())
    assert solution.converged
    text = str(page(solution.response, solution.record))
    assert "Largest pressure at rest, own platform" in text
    assert "Preload solved from rotation at 314.159 rad/s" in text
    assert "The normal loads are those of the static state at this speed." in text
    assert "Coriolis forces are not included" in text
    assert "coriolis = false" in solution.record.inputs
    inputs = solution.record.inputs.replace("coriolis = false", "coriolis = true")
    whirling = replace(solution.record, inputs=inputs)
    assert "spin softening and Coriolis forces. The normal" in str(page(solution.response, whirling))
    assert not any("normal loads" in each for each in solution.record.warnings)


def test_what_a_solved_preload_of_a_disk_requires() -> None:
    push = {"push": {"set": "tip", "direction": [1, 0, 0], "force": "100 N"}}
    content = disk().as_mapping(only_explicit=True)
    with rejects(StudyFileError, "preload.method"):
        Case.from_mapping({key: value for key, value in content.items() if key != "rotation"})
    prescribed = content | {"preload": {"method": "prescribed"}, "static_loads": push}
    with pytest.raises(StudyFileError) as caught:
        Case.from_mapping(prescribed)
    assert "static_loads" in caught.value.keys
