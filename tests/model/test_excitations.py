"""Excitations of a study file against closed forms and against the Python API."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from own_cases import EXAMPLE, mesh_case
from sentences import rejects
from stickslip.core.errors import StudyFileError
from stickslip.model.model import kind_of, set_up
from stickslip.structure.elasticity import Structure

PLACE = {"set": "damper_top"}


def with_sections(**sections: object) -> ss.Case:
    """The example without its force, with other sections."""
    data = {name: section for name, section in mesh_case().to_dict().items() if name != "forces"}
    return ss.Case.from_mapping({**data, **sections})


@pytest.mark.slow
def test_forces_in_several_harmonics() -> None:
    base = {**PLACE, "direction": [0, 0, 1]}
    case = with_sections(
        solver={**mesh_case().to_dict()["solver"], "harmonics": 3},
        forces={
            "first": {**base, "amplitude": "2 N"},
            "third": {**base, "amplitude": "5 N", "harmonic": 3, "phase": "90 deg"},
        },
    )
    model = ss.build_model(case)
    force = model.excitation.on(model.superelement, 3).coefficients(123.0)
    row = force[2] / 2.0
    expected = np.zeros_like(force)
    expected[2], expected[5] = 2.0 * row, 5.0 * row
    np.testing.assert_allclose(force, expected, atol=1e-12 * np.abs(force).max())
    with rejects(StudyFileError, "forces.third.harmonic"):
        case.replace({"solver.harmonics": 1})


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["acceleration", "displacement"])
def test_base_motion_drives_with_the_mass_that_it_carries(kind: str) -> None:
    """In the unknowns of the mesh the force is ``-M r a`` with all columns of M, those of held nodes too."""
    unit = "m/s^2" if kind == "acceleration" else "mm"
    case = with_sections(base_motion={"direction": [1, 2, 2], "amplitude": f"3 {unit}", "kind": kind})
    model = ss.build_model(case)
    omega, direction = 700.0, np.array([1.0, 2.0, 2.0]) / 3.0
    acceleration = 3.0 if kind == "acceleration" else -3e-3 * omega**2
    force = model.excitation.on(model.superelement, 1).coefficients(omega)

    # the same from matrices: no node held, so that the mass of the held ones is in the matrix
    setup: Any = set_up(case)  # of a mesh: a dataclass with the unknowns that are held
    whole = replace(setup, fixed_unknowns=np.empty(0, dtype=np.int64)).assemble()
    assert isinstance(whole, Structure)
    rigid = np.tile(direction, whole.mesh.n_nodes)
    full = np.zeros(rigid.size)
    full[whole.free_unknowns] = -acceleration * (whole.mass @ rigid[whole.free_unknowns])
    np.testing.assert_allclose(force[1], model.superelement.recovery.project(full), rtol=1e-9, atol=1e-15)
    assert not force[2].any()


@pytest.mark.slow
def test_base_motion_needs_constrained_nodes(tmp_path: Path) -> None:
    deck = tmp_path / "free.inp"
    text = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    deck.write_text(text[: text.index("*BOUNDARY")], encoding="utf-8")
    case = with_sections(base_motion={"direction": [1, 0, 0], "amplitude": "1 m/s^2"})
    assert kind_of(case).description(case).startswith("Base acceleration 1 m/s^2. ")
    with rejects(ss.InputError, "base_motion"):
        ss.build_model(case.replace({"structure.file": str(deck)}))


def test_base_motion_is_an_acceleration_or_a_displacement_of_a_mesh() -> None:
    motion = {"direction": [1, 0, 0], "amplitude": "1 m/s^2"}
    case = with_sections(base_motion=motion)
    with rejects(StudyFileError, "base_motion.kind"):
        case.replace({"base_motion.kind": "speed"})
    with rejects(StudyFileError, "base_motion.amplitude"):
        case.replace({"base_motion.kind": "displacement"})
    matrices = {"structure": {"kind": "matrices", "file": "a.npz"}, "base_motion": motion}
    with rejects(StudyFileError, "base_motion"):
        ss.Case.from_mapping(matrices)


@pytest.mark.slow
def test_unbalance_turns_about_its_axis() -> None:
    case = with_sections(unbalance={"rotor": {**PLACE, "axis": [0, 0, 1], "mass_times_radius": "2e-6 kg m"}})
    model = ss.build_model(case)
    omega = 500.0
    force = model.excitation.on(model.superelement, 1).coefficients(omega)
    along = ss.build_model(
        with_sections(
            forces={
                "x": {**PLACE, "direction": [1, 0, 0], "amplitude": "1 N", "phase": "90 deg"},
                "y": {**PLACE, "direction": [0, 1, 0], "amplitude": "1 N"},
            }
        )
    )
    unit = along.excitation.on(along.superelement, 1).coefficients(omega)
    np.testing.assert_allclose(force, 2e-6 * omega**2 * unit, atol=1e-15)


@pytest.mark.long
def test_a_case_is_solved_in_memory() -> None:
    case = mesh_case(solver__frequency_start="1850 Hz", solver__frequency_stop="1842 Hz")
    solution = ss.solve_case(case, threads=1)
    again = ss.forced_response(
        solution.model.superelement,
        solution.model.pairs,
        solution.model.excitation,
        frequency_hz=(case.solver.frequency_start, case.solver.frequency_stop),
        harmonics=case.solver.harmonics,
        samples=case.solver.samples,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        threads=1,
    )
    np.testing.assert_allclose(solution.response.displacement, again.displacement, rtol=1e-6, atol=1e-15)
    assert solution.converged
    assert "points from" in repr(solution)
    assert solution.plot().axes
