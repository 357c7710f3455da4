"""Flat and cylindrical dampers as studies: loads, stiffness, rolling, linear limits, energies, solved preload."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence
from stickslip.case.case import TwoBladeCase
from stickslip.contact.cylinder import line_loads
from stickslip.core.errors import InputError
from stickslip.model.kinds.contact_lines import contact_lines
from stickslip.model.model import build_model, load_joint, set_up
from stickslip.results.measures import summary
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import joined_modes
from stickslip.structure.model_facts import body_volumes
from stickslip.study.check import check
from stickslip.study.run import run
from sweep_cases import COARSE_MESH

SMALL = {
    **COARSE_MESH,
    "mesh.contact_columns": 3,
    "geometry.excitation_height": "9 mm",
    "reduction.modes": 8,
    "solver.harmonics": 3,
    "solver.samples": 128,
    "solver.largest_step": 0.15,
    "excitation.mode": "single",
    "analysis.performance_curve": False,
    "analysis.stiffness_band": False,
}
FLAT, ROUND = {"damper.kind": "flat"}, {"damper.kind": "cylindrical"}


def study(**changes: Any) -> TwoBladeCase:
    """A coarse case; keys as in a study file."""
    return TwoBladeCase().replace({**SMALL, **changes})


@pytest.mark.slow
@pytest.mark.parametrize("changes", [FLAT, ROUND, {**ROUND, "mesh.element": "serendipity"}])
def test_mass_and_loads(changes: dict[str, Any]) -> None:
    case = study(**changes)
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    rows = dict(dict(check(case))["Derived quantities"])
    mass = 7800.0 * body_volumes(setup.mesh)[2]  # type: ignore[attr-defined]
    assert rows["Mass of the damper by its dimensions"].startswith(f"{1e3 * mass:.4g} g")
    loads = joint.face_sum(joint.preload)
    up = loads @ (1.0, 1.0) * math.cos(case.geometry.platform_angle)
    assert up == pytest.approx(500.0)  # the share of both sides supports the centrifugal force
    assert loads[0] == pytest.approx(loads[1])


@pytest.mark.long
def test_a_run_with_contact_lines_has_a_page(tmp_path: Path) -> None:
    outcome = run(study(**ROUND, **{"output.figure_formats": []}), tmp_path)
    assert outcome.response.converged
    assert "Damper" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_lines_share_the_force_as_the_statics_of_a_cylinder() -> None:
    angles = {"geometry.right_platform_angle": "20 deg", "preload.friction_coefficient_at_assembly": 0.1}
    case = study(**ROUND, **angles)
    joint = load_joint(case, set_up(case).layout)
    expected = line_loads(500.0, (math.radians(30.0), math.radians(20.0)), 0.1)
    np.testing.assert_allclose(joint.face_sum(joint.preload), expected)
    assert joint.preload[0] == pytest.approx(0.125 * expected[0])  # half of the others: 4 elements along the line


def test_springs_are_those_of_hertz() -> None:
    case = study(**ROUND)
    joint, lines = load_joint(case, set_up(case).layout), contact_lines(case)
    assert lines is not None
    load = 250.0 / math.cos(math.radians(30.0))
    stiffness = float(lines.lines[0].stiffness(np.array([load / 28e-3]))[0]) * 28e-3
    assert joint.face_sum(joint.normal_stiffness) == pytest.approx([stiffness] * 2)
    ratio = 2.0 * (1.0 - 0.3) / (2.0 - 0.3)
    assert joint.tangential_stiffness == pytest.approx(ratio * joint.normal_stiffness)
    doubled = case.replace({"preload.centrifugal_force": "1000 N"})
    more = load_joint(doubled, set_up(case).layout)  # on the layout of the other load, as a ridge does
    expected = float(lines.lines[0].stiffness(np.array([2.0 * load / 28e-3]))[0]) * 28e-3
    assert more.face_sum(more.normal_stiffness) == pytest.approx([expected] * 2)


def test_the_cylinder_rolls_about_its_axis_without_normal_motion() -> None:
    case = study(**ROUND, **{"geometry.right_platform_angle": "20 deg"})
    setup = set_up(case)
    mesh = setup.mesh  # type: ignore[attr-defined]
    pairs = setup.layout.face_pairs
    damper = mesh.nodes_of_body(2)
    # The axis is where both normals meet.
    left, right = pairs.points[0], pairs.points[-1]
    distance = np.linalg.lstsq(np.column_stack([pairs.normal[0], -pairs.normal[-1]]), left - right, rcond=None)[0]
    axis = left - 6.6e-3 * pairs.normal[0]
    np.testing.assert_allclose(distance, 6.6e-3)
    turned = np.zeros((mesh.n_nodes, 3))
    turned[damper] = np.cross([0.0, 1.0, 0.0], mesh.points[damper] - axis)
    motion = (pairs.mesh_operator(mesh.n_nodes) @ turned.ravel()).reshape(-1, 3)
    np.testing.assert_allclose(motion[:, 2], 0.0, atol=1e-17)  # nothing closes or opens
    np.testing.assert_allclose(np.abs(motion[:, 0]), 6.6e-3)  # both lines move as far along their slopes
    assert motion[0, 0] * motion[-1, 0] < 0.0  # one up its slope, the other one down


def test_a_crown_moves_the_load_to_the_middle() -> None:
    case = study(**ROUND, **{"mesh.chordwise": 8})
    straight, crowned = (
        load_joint(each, set_up(each).layout) for each in (case, case.replace({"damper.crowning": "1 um"}))
    )
    left = slice(0, 9)
    assert crowned.face_sum(np.maximum(crowned.preload, 0.0)) == pytest.approx(straight.face_sum(straight.preload))
    assert crowned.preload[4] > 1.3 * straight.preload[4]
    pressure = crowned.preload[left] / crowned.face_pairs.area[left]
    assert (np.diff(pressure[:5]) > 0.0).all()
    np.testing.assert_allclose(pressure, pressure[::-1], rtol=1e-9)
    assert (crowned.normal_stiffness[left] / crowned.face_pairs.area[left]).argmax() == 4
    strong = case.replace({"damper.crowning": "20 um"})
    joint = load_joint(strong, set_up(strong).layout)
    assert (joint.preload < 0.0).any()  # ends that do not touch


@pytest.mark.long
@pytest.mark.parametrize(("changes", "force"), [(FLAT, "60 N"), (ROUND, "300 N")])
def test_small_forces_give_the_stuck_resonance_and_large_ones_the_energies(changes: dict[str, Any], force: str) -> None:
    case = study(**changes, **{"excitation.mode": "opposite"})
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    structure = setup.assemble()
    assert isinstance(structure, Structure)
    stuck = joined_modes(structure, joint.face_pairs, 2, joint.resting_springs)[0][1]
    window = {"solver.frequency_start": f"{stuck - 8.0} Hz", "solver.frequency_stop": f"{stuck + 5.0} Hz"}
    quiet = ss.solve_case(case.replace({**window, "excitation.amplitude": "0.01 N", "solver.harmonics": 1}))
    output = next(iter(quiet.model.outputs.values()))
    assert summary(quiet.response, output).peak.frequency_hz == pytest.approx(stuck, rel=1e-3)
    assert not quiet.response.friction_energy.any()
    loud = ss.solve_case(case.replace({**window, "excitation.amplitude": force})).response
    assert loud.converged
    assert loud.friction_energy.sum(axis=1).max() > 0.01 * loud.input_energy.max()
    lost = loud.dissipated_energy.sum(axis=1) + loud.viscous_energy
    assert np.abs(loud.input_energy - lost).max() < 1e-3 * loud.input_energy.max()


@pytest.mark.long  # thousands of load steps
def test_a_solved_preload_has_the_loads_of_the_statics() -> None:
    """The sums of both lines are those of a cylinder without friction; a crown has its load in the middle."""
    solved = {"preload.method": "solved", "geometry.right_platform_angle": "20 deg", "damper.crowning": "5 um"}
    model = build_model(study(**ROUND, **solved))
    assert model.preload is not None
    force = model.preload.state.normal_force
    expected = line_loads(500.0, (math.radians(30.0), math.radians(20.0)))
    np.testing.assert_allclose(model.joint.face_sum(force), expected, rtol=1e-6)
    assert (force[:5] / model.joint.face_pairs.area[:5]).argmax() in (1, 2, 3)


def test_a_contact_that_is_too_wide_is_rejected_by_check() -> None:
    case = study(**ROUND, **{"preload.centrifugal_force": "5 MN"})
    with pytest.raises(InputError) as found:
        check(case)
    assert "damper.radius" in found.value.keys
    printed_sentence(str(found.value))


@pytest.mark.slow
def test_check_says_what_lock_up_and_rolling_are() -> None:
    rows = dict(dict(check(study(**ROUND)))["Derived quantities"])
    assert rows["Friction coefficient of lock-up"].startswith("1.732")
    assert rows["Rolling of the cylinder"].startswith("free")
    flat = dict(dict(check(study(**FLAT)))["Derived quantities"])
    assert flat["Lock-up of the damper"].startswith("none")
    assert flat["Friction limit of each face"].startswith("75 N")
