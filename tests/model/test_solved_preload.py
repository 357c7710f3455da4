"""A study whose preload is solved from its static load: equilibrium, stiffness laws, refusals, and the report."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from castings import casting_case
from sentences import rejects
from stickslip.contact.stiffness.asperities import fully_plastic_load
from stickslip.contact.stiffness.fractal import fractal_contact
from stickslip.core.errors import StudyFileError
from stickslip.model.model import Model, build_model, load_joint, set_up
from stickslip.model.rough_face import case_roughness
from stickslip.results.storage import load_results
from stickslip.structure.superelement import Superelement
from stickslip.study import run as study
from sweep_cases import COARSE_MESH

SOLVED = {**COARSE_MESH, "preload.method": "solved"}
FACE_ANGLE = np.pi / 6


@cache
def model(**changes: str) -> Model:
    """The coarse two-blade model; keys of changes have two underscores for the point."""
    case = casting_case().replace(SOLVED | {key.replace("__", "."): value for key, value in changes.items()})
    setup = set_up(case)
    return build_model(case, setup.assemble(), load_joint(case, setup.layout))


def force_on_damper(found: Model) -> np.ndarray:
    """Resultant (3,) of the contact on the damper at rest."""
    assert found.preload is not None
    state, pairs = found.preload.state, found.joint.face_pairs
    total = (
        state.normal_force[:, None] * pairs.normal
        + state.traction[:, :1] * pairs.tangent1
        + state.traction[:, 1:] * pairs.tangent2
    ).sum(axis=0)
    return -np.asarray(total)


@pytest.mark.slow
def test_contact_carries_the_centrifugal_force_with_and_without_friction() -> None:
    for traction in ("released", "kept"):
        actual = model(preload__residual_traction=traction)
        np.testing.assert_allclose(force_on_damper(actual), [0.0, 0.0, -500.0], atol=5e-3)
        assert actual.pairs.released == (traction == "released")
    face = model().joint.face_sum(np.maximum(model().joint.preload, 0.0))
    assert face == pytest.approx([250.0 / np.cos(FACE_ANGLE)] * 2, rel=2e-3)
    retained = model(preload__residual_traction="kept")
    assert retained.preload is not None
    # The damper slips up both faces, so friction takes its full part.
    face = retained.joint.face_sum(retained.preload.state.normal_force)
    assert face == pytest.approx([250.0 / (np.cos(FACE_ANGLE) + 0.3 * np.sin(FACE_ANGLE))] * 2, rel=2e-3)


@pytest.mark.slow
def test_the_pressure_is_far_from_uniform() -> None:
    """The platforms turn under the load: the low edge carries most, and stiff contact opens at the upper one."""
    joint = model(roughness__fractal_roughness="1e-10 m").joint
    pressure = joint.preload / joint.face_pairs.area
    assert pressure.max() > 3.0 * pressure.mean()
    assert (pressure < 0.0).any()


@pytest.mark.slow
def test_stiffness_follows_the_solved_load_of_the_face() -> None:
    """Iterated: the stiffness of each face is that of the normal force it ends with."""
    actual = model(preload__residual_traction="kept")
    expected = [face.stiffness.normal for face in actual.joint.rough_faces if face is not None]
    assert actual.joint.face_sum(actual.joint.normal_stiffness) == pytest.approx(expected, rel=1e-3)
    without_friction = [face.stiffness.normal for face in model().joint.rough_faces if face is not None]
    assert expected[0] < 0.95 * without_friction[0]


@pytest.mark.long
def test_local_stiffness_concentrates_the_load_that_the_pressure_gap_law_spreads() -> None:
    local, curve = model(roughness__allocation="pressure"), model(preload__normal_law="pressure-gap")
    for actual in (local, curve):
        np.testing.assert_allclose(force_on_damper(actual), [0.0, 0.0, -500.0], atol=5e-3)
        per_area = actual.joint.normal_stiffness / actual.joint.face_pairs.area
        pressure = actual.joint.preload / actual.joint.face_pairs.area
        closed = pressure > 0.1 * pressure.max()
        # A pair that is pressed harder is stiffer: the law of the rough face, not a constant.
        assert np.corrcoef(np.log(per_area[closed]), np.log(pressure[closed]))[0, 1] > 0.95
    # N = A kappa(p) closure takes the slope of the curve as its secant, which concentrates the load: it is told.
    weights = [np.sort(actual.joint.preload)[-5:].sum() / actual.joint.preload.sum() for actual in (local, curve)]
    assert weights[0] > 2.0 * weights[1]
    assert [any("normal_law" in words for words in actual.joint.layout.messages) for actual in (local, curve)] == [
        True,
        False,
    ]


@pytest.mark.long
@pytest.mark.parametrize(
    "allocation",
    [{}, {"roughness__allocation": "pressure", "roughness__reference_area": "0.002 m^2"}],  # models of other tests
    ids=["area", "pressure"],
)
def test_on_the_curve_tangential_stiffness_follows_the_pressure_of_each_pair(allocation: dict[str, str]) -> None:
    """By area, K_t/K_n was 0.3 to 2.3 on these faces, and 0.09 to 40 on machined ones."""
    joint = model(**allocation, preload__normal_law="pressure-gap").joint
    assert joint.normal_stiffness.max() > 3.0 * joint.normal_stiffness.min()
    ratio = 2.0 * (1.0 - 0.3) / (2.0 - 0.3)
    np.testing.assert_allclose(joint.tangential_stiffness / joint.normal_stiffness, ratio, rtol=2e-3)


@pytest.mark.long
@pytest.mark.parametrize("normal_law", ["spring", "pressure-gap"])
@pytest.mark.parametrize("reference", [20e-6, 2000e-6])
def test_solved_pressure_and_springs_share_the_reference_area(normal_law: str, reference: float) -> None:
    """Both laws, and the tangential springs beside them, follow kappa(p) = K(p A_ref) / A_ref.

    With the small area all spots are plastic up to a third of the mean pressure, so the least pressure knows it too.
    """
    joint = model(
        roughness__allocation="pressure",
        roughness__reference_area=f"{reference} m^2",
        preload__normal_law=normal_law,
    ).joint
    pressure = joint.preload / joint.face_pairs.area
    roughness = case_roughness(casting_case(), *joint.layout.face_materials[0])
    followed = pressure > max(0.1 * pressure.max(), 2.0 * fully_plastic_load(roughness) / reference)
    assert followed.sum() >= 4
    law = [fractal_contact(roughness, load) for load in pressure[followed] * reference]
    per_area = [
        values[followed] / joint.face_pairs.area[followed]
        for values in (joint.normal_stiffness, joint.tangential_stiffness)
    ]
    np.testing.assert_allclose(per_area[0], [k.normal / reference for k in law], rtol=5e-3)
    np.testing.assert_allclose(per_area[1], [k.tangential / reference for k in law], rtol=5e-3)
    of_the_face = fractal_contact(roughness, float(pressure.max()) * 182e-6)
    assert abs(of_the_face.normal / 182e-6 / per_area[0].max() - 1.0) > 0.05


@pytest.mark.slow
def test_rotation_loads_the_damper_with_its_mass() -> None:
    actual = model(rotation__speed="3000 rpm", rotation__axis=(0, 1, 0), rotation__point=("0 m", "0 m", "-300 mm"))
    assert actual.preload is not None
    setup = set_up(casting_case().replace(SOLVED))
    assert not isinstance(actual.structure, Superelement)
    mesh = actual.structure.mesh
    assert set(setup.layout.node_groups) >= {"damper_front_edge", "damper_back_edge"}
    damper = mesh.cells[mesh.body == 2]
    centre = mesh.points[np.unique(damper)].mean(axis=0)
    volume = 0.0114 / 7800.0
    expected = (100.0 * np.pi) ** 2 * 7800.0 * volume * (0.3 + centre[2])
    assert -force_on_damper(actual)[2] == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"preload.method": "guessed"}, "preload.method"),
        ({"preload.residual_traction": "kept"}, "preload.residual_traction"),
        ({"preload.normal_law": "pressure-gap"}, "preload.normal_law"),
        (
            {"preload.method": "solved", "preload.friction_coefficient_at_assembly": 0.2},
            "preload.friction_coefficient_at_assembly",
        ),
        (
            {
                "preload.method": "solved",
                "preload.centrifugal_force": "500 N",
                "rotation.speed": "3000 rpm",
                "rotation.axis": [0, 1, 0],
            },
            "preload.centrifugal_force",
        ),
        ({"preload.method": "solved", "preload.values": [1.0]}, "preload.values"),
    ],
)
def test_what_does_not_fit_is_rejected_in_the_file(changes: dict[str, object], key: str) -> None:
    with rejects(StudyFileError, key):
        casting_case().replace(changes)


@pytest.mark.long
def test_the_report_shows_the_rest_and_the_other_tractions(tmp_path: Path) -> None:
    case = casting_case().replace(
        SOLVED
        | {
            "geometry.excitation_height": "9 mm",
            "excitation.amplitude": "30 N",
            "preload.residual_traction": "kept",
            "roughness.fractal_roughness": "1e-9 m",
            "solver.harmonics": 3,
            "solver.samples": 128,
            "output.deflected_shape_frames": 0,
            "output.figure_formats": ["png"],
        }
    )
    outcome = study.run(case, tmp_path)
    assert outcome.converged, outcome.message
    assert (tmp_path / "figures" / "rest_pressure.png").stat().st_size > 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert re.search(r"<h2>Pressure at rest</h2>.*pairs open", page, flags=re.DOTALL)
    assert 'id="rest-map-1"' in page
    saved = load_results(tmp_path / "results.nc")
    assert saved.study is not None
    assert saved.response.pairs.residual_traction is not None
    rows = {name: value for name, value, _, _ in saved.study.derived}
    assert rows["Peak with tractions at rest released"] == pytest.approx(
        1e6 * saved.response.amplitude(saved.study.outputs["blade tip A"]).max(), rel=0.2
    )
    assert float(rows["Balance of forces at rest"]) < 1e-8
