"""Joints with plastic faces or pairs: springs, warnings, and a solved preload beside the jump of the law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castings import ROUGH_CASTING, casting_case
from sentences import printed_sentence
from stickslip.case.case import Case
from stickslip.contact.stiffness.asperities import fully_plastic_load
from stickslip.model.joint import Joint
from stickslip.model.model import build_model, load_joint, set_up
from stickslip.model.rough_face import case_roughness
from sweep_cases import COARSE_MESH

MODULUS, HARDNESS = 108.2417582e9, 3e9  # E* and H of the case, Pa


def joint_of(case: Case) -> Joint:
    return load_joint(case, set_up(case).layout)


def one_spot(face_load: np.ndarray) -> np.ndarray:
    """2 E* sqrt(F / (pi H)), N/m."""
    return 2.0 * MODULUS * np.sqrt(face_load / (np.pi * HARDNESS))


def test_pairs_on_both_sides_of_the_jump_are_reported() -> None:
    """Half of the pairs under a third of the plastic pressure, the others above it; the mean pressure is elastic."""
    coarse = casting_case().replace(COARSE_MESH)
    layout = set_up(coarse).layout
    area = layout.face_pairs.area
    roughness = case_roughness(coarse, *layout.face_materials[0])
    plastic = fully_plastic_load(roughness) / area[layout.face_pairs.face == 0].sum()
    is_light = np.arange(area.size) % 2 == 0
    values = np.where(is_light, plastic / 3.0, 30.0 * plastic) * area
    changes: dict[str, Any] = {**ROUGH_CASTING, **COARSE_MESH, "roughness.allocation": "pressure"}
    case = Case.from_mapping({"preload": {"values": values.tolist()}}).replace(changes)
    joint = joint_of(case)
    assert joint.faces_with_least_stiffness == (False, False)
    face_area = joint.face_sum(area)[joint.face_pairs.face]
    spots = one_spot(values / area * face_area) * area / face_area
    np.testing.assert_allclose(joint.normal_stiffness[is_light], spots[is_light], rtol=1e-9)
    assert (np.abs(joint.normal_stiffness[~is_light] / spots[~is_light] - 1.0) > 0.1).all()
    sentences = [each for each in joint.stiffness_warnings if "Plastic pairs" in each]
    assert len(sentences) == 2
    printed_sentence(sentences[0], "law jumps", f"{is_light[joint.face_pairs.face == 0].sum()} of ")
    uniform = casting_case().replace({**COARSE_MESH, "roughness.allocation": "pressure"})
    assert not any("Plastic pairs" in each for each in joint_of(uniform).stiffness_warnings)


def test_plastic_faces_of_other_loads_are_as_the_roots_of_their_real_areas() -> None:
    joints = [
        joint_of(casting_case().replace({**COARSE_MESH, **changes, "roughness.fractal_dimension": 2.2}))
        for changes in (
            {"preload.centrifugal_force": "500 N"},
            {"preload.centrifugal_force": "2 kN"},
            {"preload.centrifugal_force": "2 kN", "roughness.allocation": "pressure"},
        )
    ]
    sums = [joint.face_sum(joint.normal_stiffness) for joint in joints]
    np.testing.assert_allclose(sums[0], one_spot(joints[0].face_sum(joints[0].preload)), rtol=1e-6)
    np.testing.assert_allclose(sums[1], 2.0 * sums[0], rtol=1e-9)
    np.testing.assert_allclose(sums[2], sums[1], rtol=1e-9)
    assert all(joint.faces_with_least_stiffness == (True, True) for joint in joints)


@pytest.mark.long
@pytest.mark.parametrize(
    "changes",
    [{}, {"roughness.allocation": "pressure"}, {"preload.normal_law": "pressure-gap"}],
    ids=["area", "pressure", "curve"],
)
@pytest.mark.parametrize("force", [15.0, 15.4])
def test_no_face_with_a_solved_preload_has_pairs_on_both_sides_of_the_jump(
    changes: dict[str, str], force: float
) -> None:
    """Elastic spots begin under 15.2 N.

    With 15.0 N the faces are plastic, some pairs have more than the plastic pressure, and the law is that of one round
    spot up to this pressure and constant above it.
    """
    settings: dict[str, Any] = {**COARSE_MESH, "preload.method": "solved", "preload.centrifugal_force": f"{force} N"}
    case = casting_case().replace(settings | changes)
    setup = set_up(case)
    joint = build_model(case, setup.assemble(), load_joint(case, setup.layout)).joint
    pairs = joint.face_pairs
    face_load = joint.face_sum(np.maximum(joint.preload, 0.0))
    assert face_load == pytest.approx([force / 2.0 / np.cos(np.pi / 6)] * 2, rel=5e-3)
    is_plastic = force < 15.2
    assert joint.faces_with_least_stiffness == (is_plastic, is_plastic)
    area = joint.face_sum(pairs.area)[pairs.face]
    border = fully_plastic_load(case_roughness(case, *joint.layout.face_materials[0])) / area
    pressure = joint.preload / pairs.area
    if not is_plastic:
        assert not any("Fully plastic" in each for face in joint.rough_faces if face for each in face.messages)
        return
    assert (pressure > border).any()
    assert (pressure < border).any()
    assert all(face is not None and face.messages[0].startswith("Fully plastic") for face in joint.rough_faces)
    mean = face_load[pairs.face] / area
    at = np.clip(pressure, 0.01 * mean, border) if changes else mean
    expected = one_spot(at * area) * pairs.area / area
    np.testing.assert_allclose(joint.normal_stiffness, expected, rtol=5e-3)
