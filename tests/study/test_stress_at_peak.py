"""Stress of a solved study: against frames of its motion, with the state at rest, the Goodman check, and its input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from own_cases import MATRIX_STUDY, mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError, StudyFileError
from stickslip.core.fourier import synthesis_matrix
from stickslip.model.model import kind_of, set_up
from stickslip.results.peaks import peaks
from stickslip.results.storage import load_results, save_results
from stickslip.results.stress import Region, StressSummary, SurfaceStress
from stickslip.structure.elasticity import Structure
from stickslip.structure.stress import nodal_stress
from stickslip.structure.stress_cycle import principal_stresses, von_mises
from stickslip.study import stress as stress_module
from stickslip.study.rest import displacement_at_rest
from stickslip.study.solution import Solution, solve_case
from stickslip.study.stress import goodman_factor, largest_stresses_at_peak, stress_at_peak
from stickslip.study.stress_summary import stress_summary
from sweep_cases import quick_case

STRENGTHS = {"material.fatigue_limit": "300 MPa", "material.tensile_strength": "900 MPa"}


@pytest.fixture(scope="module")
def vibration() -> Solution:
    return solve_case(quick_case())


@pytest.fixture(scope="module")
def loaded() -> Solution:
    """The coarse two blades; a centrifugal force presses the damper on the platforms."""
    return solve_case(quick_case().replace({"preload.method": "solved", **STRENGTHS}))


def structure_of(solution: Solution) -> Structure:
    assert isinstance(solution.model.structure, Structure)
    return solution.model.structure


@pytest.mark.slow
def test_the_measures_are_those_of_frames_of_the_motion(vibration: Solution) -> None:
    """The stress of 200 instants, each from its displacements, against the measures from Fourier coefficients."""
    stress, motion = vibration.stress, vibration.motion
    assert stress is not None
    assert motion is not None
    assert (stress.static, stress.safety) == ("prescribed", None)
    structure = structure_of(vibration)
    recovery = vibration.model.superelement.recovery
    _, rest = displacement_at_rest(vibration.model, structure, recovery, np.zeros(structure.full_size))
    frames = rest + motion.displacement @ synthesis_matrix((motion.displacement.shape[1] - 1) // 2, 200).T
    instants = np.moveaxis(nodal_stress(structure, frames).stress, 2, 1)
    # The motion lacks the modes that the reduction omits.
    scale = 2.0 * stress.truncation * stress.cycle.alternating.max() + 1e-3 * stress.cycle.alternating.max()
    assert stress.truncation < 0.1
    ordinary = stress.region == Region.ORDINARY
    for values, expected in (
        (stress.cycle.largest_von_mises, von_mises(instants).max(axis=1)),
        (stress.cycle.largest_first_principal, principal_stresses(instants)[..., 0].max(axis=1)),
        (stress.cycle.smallest_third_principal, principal_stresses(instants)[..., 2].min(axis=1)),
    ):
        assert np.abs(values - expected)[ordinary].max() < scale


@pytest.mark.slow
def test_the_summary_has_extremes_where_they_are(vibration: Solution) -> None:
    stress, record = vibration.stress, vibration.record
    assert stress is not None
    assert record.stress is not None
    mesh = structure_of(vibration).mesh
    contact = np.unique(vibration.model.joint.face_pairs.nodes)
    assert (stress.region[np.isin(stress.nodal.node, contact)] == Region.CONTACT).all()
    assert set(np.unique(stress.region)) == set(Region)
    extreme = record.stress.extreme("alternating stress")
    row = int(np.flatnonzero(stress.cycle.alternating == extreme.value)[0])
    assert extreme.position == tuple(mesh.points[stress.nodal.node[row]])
    apart = np.isin(stress.region, [Region.ORDINARY, Region.CONSTRAINED])
    assert extreme.value == stress.cycle.alternating[apart].max()
    everywhere = next(each for each in record.stress.everywhere if each.quantity == "alternating stress")
    assert everywhere.value == stress.cycle.alternating.max() >= extreme.value
    assert record.stress.goodman == ()
    assert record.stress.force == pytest.approx(kind_of(vibration.case).force_amplitude(vibration.case))
    row_of_output = record.outputs[record.response_output]
    assert record.stress.displacement == pytest.approx(vibration.response.amplitude(row_of_output)[stress.point])
    with rejects(InputError, "quantity"):
        record.stress.extreme("hoop stress")


@pytest.mark.long
def test_a_solved_preload_is_part_of_the_stress(loaded: Solution) -> None:
    """The mean of the coefficients is the static stress plus that of the mean of the vibration."""
    stress, record = loaded.stress, loaded.record
    assert stress is not None
    assert stress.static == "solved"
    structure, recovery = structure_of(loaded), loaded.model.superelement.recovery
    assert loaded.model.preload is not None
    rest = recovery @ loaded.model.preload.state.displacement[:, None]
    vibration = recovery @ loaded.response.displacement[stress.point][:, :1]
    static = nodal_stress(structure, rest + vibration).stress[:, :, 0]
    apart = np.isin(stress.region, [Region.ORDINARY, Region.CONSTRAINED])
    difference = von_mises(stress.nodal.stress[:, :, 0] - static)[apart]
    assert difference.max() < 0.05 * von_mises(static)[apart].max()
    # With both strengths each node has a factor; the smallest of each body is in the record.
    assert stress.safety is not None
    assert stress.safety == pytest.approx(goodman_factor(stress.cycle.alternating, stress.cycle.mean, 300e6, 900e6))
    assert record.stress is not None
    assert {row.body for row in record.stress.goodman} <= set(loaded.model.joint.layout.body_names)
    smallest = min(row.value for row in record.stress.goodman)
    assert smallest == pytest.approx(stress.safety[apart].min())


@pytest.mark.slow
def test_prescribed_normal_loads_have_the_stress_of_the_solved_state_that_has_them(loaded: Solution) -> None:
    """The frictionless solved state is K u = F - B^T N; with N as prescribed loads the stress is the same, because the
    loads of the free damper are in balance without the help of an acceleration."""
    structure, recovery = structure_of(loaded), loaded.model.superelement.recovery
    assert loaded.model.preload is not None
    assert loaded.model.pairs.released
    load = np.zeros(structure.full_size)
    for force in kind_of(loaded.case).static_forces(loaded.case):
        group = loaded.model.joint.layout.node_groups[force.node_group]
        for axis in range(3):
            load[3 * group.nodes + axis] += force.amplitude * force.direction[axis] * group.weights
    state, solved = displacement_at_rest(loaded.model, structure, recovery, load)
    other, prescribed = displacement_at_rest(replace(loaded.model, preload=None), structure, recovery, load)
    assert (state, other) == ("solved", "prescribed")
    stresses = [nodal_stress(structure, each).stress[:, :, 0] for each in (solved, prescribed)]
    difference = von_mises(stresses[0] - stresses[1])
    assert difference.max() < 1e-4 * von_mises(stresses[0]).max()
    # Without the force on the damper it accelerates; the blades do not notice.
    free = replace(loaded.model, preload=None, static_load=np.zeros(loaded.model.superelement.size))
    _, without = displacement_at_rest(free, structure, recovery, np.zeros(structure.full_size))
    blades = nodal_stress(structure, without)
    of_blades = blades.body < 2
    single = von_mises(stresses[1])
    np.testing.assert_allclose(
        von_mises(blades.stress[:, :, 0])[of_blades], single[of_blades], rtol=1e-5, atol=1e-6 * single.max()
    )


@pytest.mark.slow
def test_the_record_of_a_stress_survives_its_file(loaded: Solution, tmp_path: Path) -> None:
    save_results(tmp_path / "results.nc", loaded.response, loaded.record)
    again = load_results(tmp_path / "results.nc").study
    assert again == loaded.record
    assert again is not None
    assert again.sketch is not None
    assert again.sketch.stress is not None
    assert again.sketch.stress.von_mises.size == len(again.sketch.points)
    without = replace(loaded.record, stress=None, sketch=replace(again.sketch, stress=None))
    save_results(tmp_path / "without.nc", loaded.response, without)
    assert load_results(tmp_path / "without.nc").study == without


@pytest.mark.slow
def test_without_a_mesh_or_without_the_wish_there_is_no_stress(vibration: Solution) -> None:
    matrices = replace(vibration.model, structure=vibration.model.superelement)
    assert stress_at_peak(vibration.case, matrices, vibration.response) is None
    unwanted = vibration.case.replace({"output.stress": False})
    assert stress_at_peak(unwanted, vibration.model, vibration.response) is None


@pytest.mark.slow
def test_the_largest_stresses_are_those_of_the_summary(vibration: Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    """But for the scale of the vibration, from the computed point to the peak between points."""
    case, model, response = vibration.case, vibration.model, vibration.response
    unwanted = case.replace({"output.stress": False})
    found = largest_stresses_at_peak(unwanted, model, response)
    assert vibration.record.stress is not None
    expected = vibration.record.stress.extreme("alternating stress").value
    highest = peaks(response.frequency_hz, response.amplitude(next(iter(model.outputs.values()))))[0]
    factor = highest.amplitude / vibration.record.stress.displacement
    assert found["alternating_stress"] == pytest.approx(factor * expected, rel=1e-6)
    matrices = replace(model, structure=model.superelement)
    with rejects(InputError):
        largest_stresses_at_peak(case, matrices, response)
    monkeypatch.setattr(
        stress_module, "_regions", lambda *_: np.full(structure_of(vibration).mesh.n_nodes, Region.LOAD)
    )
    with rejects(InputError):
        largest_stresses_at_peak(case, model, response)


@pytest.mark.slow
def test_a_body_that_is_not_checked_is_named_with_its_reason(loaded: Solution) -> None:
    stress = loaded.stress
    assert stress is not None
    assert stress.safety is not None
    body = stress.nodal.body
    factor, region = stress.safety.copy(), stress.region.copy()
    factor[body == 0] = np.nan
    region[body == 2] = Region.CONTACT
    factor[body == 1] *= 1e-3
    changed = replace(stress, safety=factor, region=region)
    summary = stress_summary(loaded.case, loaded.model, loaded.response, changed)
    assert [row.body for row in summary.goodman] == ["right blade"]
    assert summary.goodman[0].value < 1.0
    printed_sentence(summary.goodman_message)
    everything = replace(changed, region=np.full_like(region, Region.LOAD))
    summary = stress_summary(loaded.case, loaded.model, loaded.response, everything)
    assert summary.extremes == summary.goodman == ()
    assert len(summary.everywhere) == 8


def test_the_goodman_line() -> None:
    """Half of each strength, or all of one, uses the material completely; nothing uses nothing."""
    alternating, mean = np.array([150e6, 300e6, 0.0, 0.0]), np.array([450e6, 0.0, 900e6, 0.0])
    assert goodman_factor(alternating, mean, 300e6, 900e6) == pytest.approx([1.0, 1.0, 1.0, np.inf])
    assert goodman_factor(np.array([30e6]), np.array([90e6]), 300e6, 900e6) == pytest.approx(5.0)


def test_wrong_strengths_are_rejected_before_anything_runs() -> None:
    with rejects(StudyFileError, "material.fatigue_limit"):
        Case().replace({"material.fatigue_limit": "300"})
    with rejects(StudyFileError, "material.tensile_strength"):
        Case().replace({"material.tensile_strength": "0 MPa"})
    with rejects(InputError, "material.fatigue_limit"):
        set_up(Case().replace(STRENGTHS | {"material.fatigue_limit": "1000 MPa"}))
    of_body = {"bodies__damper__fatigue_limit": "1000 MPa", "bodies__damper__tensile_strength": "900 MPa"}
    with rejects(InputError, "bodies.damper.fatigue_limit"):
        set_up(mesh_case(**of_body))
    with rejects(StudyFileError, "material.fatigue_limit"):
        Case.from_text(MATRIX_STUDY + '[material]\nyoung_modulus = "197 GPa"\npoisson_ratio = 0.3\n'
                       'density = "7800 kg/m^3"\nfatigue_limit = "300 MPa"\n')  # fmt: skip
    with rejects(StudyFileError, "output.stress"):
        Case().replace({"output.stress": "von Mises"})


def test_a_stress_of_wrong_size_is_rejected() -> None:
    with rejects(InputError):
        SurfaceStress(np.ones(3, np.float32), np.ones(4, np.float32))
    with rejects(InputError, "static"):
        StressSummary((), (), (), "", "perhaps", 1.0, 1.0, 1.0, 0.0)
