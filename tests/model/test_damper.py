"""The damper of two blades: its force from mass, radius and speed; two platform angles; lock-up in the check."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.case.case import Case, TwoBladeCase
from stickslip.core.errors import InputError, StudyFileError
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.model.model import build_joint, build_structure, load_joint, set_up
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import joined_modes
from stickslip.study.check import check
from sweep_cases import COARSE_MESH

SPINNING = {
    "preload.damper_mass": "20 g",
    "preload.radius_of_rotation": "300 mm",
    "preload.speed_of_rotation": "3000 rpm",
}


def coarse(**changes: Any) -> TwoBladeCase:
    """A coarse case; keys as in a study file."""
    return TwoBladeCase().replace({**COARSE_MESH, "geometry.excitation_height": "9 mm", **changes})


def test_mass_radius_and_speed_give_the_force() -> None:
    case = coarse(**SPINNING)
    force = 0.02 * 0.3 * (2.0 * math.pi * 50.0) ** 2
    assert case.preload.centrifugal_force is None
    assert case.preload.damper_force == pytest.approx(force)
    joint = load_joint(case, set_up(case).layout)
    given = coarse(**{"preload.centrifugal_force": force})
    assert joint.preload == pytest.approx(load_joint(given, set_up(given).layout).preload)
    assert Case.from_mapping(case.as_mapping(only_explicit=True)) == case


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"preload.damper_mass": "20 g"}, "preload.radius_of_rotation"),
        ({**SPINNING, "preload.centrifugal_force": "500 N"}, "preload.damper_mass"),
        ({**SPINNING, "preload.values": [1.0]}, "preload.damper_mass"),
        ({**SPINNING, "preload.speed_of_rotation": "0 rpm"}, "preload.speed_of_rotation"),
        ({**SPINNING, "preload.damper_mass": "20 N"}, "preload.damper_mass"),
    ],
)
def test_keys_that_contradict_each_other(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(StudyFileError) as found:
        coarse(**changes)
    assert key in found.value.keys
    printed_sentence(str(found.value), key)


def test_faces_have_their_own_angles() -> None:
    geometry = BladePairGeometry(platform_angle_deg=30.0, right_platform_angle_deg=20.0)
    mesh = blade_pair_mesh(geometry, BladePairElements())
    for name, angle in (("left_face", 30.0), ("right_face", 20.0)):
        points = mesh.points[mesh.node_set(name)]
        assert np.array_equal(np.sort(points, axis=0), np.sort(mesh.points[mesh.node_set(f"damper_{name}")], axis=0))
        run, rise = np.ptp(points[:, 0]), np.ptp(points[:, 2])
        assert math.degrees(math.atan2(rise, run)) == pytest.approx(angle)
        assert math.hypot(run, rise) == pytest.approx(geometry.contact_face_width)


def test_equal_angles_are_the_mirrored_structure() -> None:
    one = blade_pair_mesh(BladePairGeometry(), BladePairElements())
    two = blade_pair_mesh(BladePairGeometry(right_platform_angle_deg=30.0), BladePairElements())
    np.testing.assert_allclose(one.points, two.points, rtol=0.0, atol=1e-15)


@pytest.mark.slow
def test_exchanged_angles_have_the_same_frequencies() -> None:
    """The mirrored structure: its left underside is the right one of the other."""
    width, height = 6.5e-3, 36.7e-3
    other = height + width * (math.sin(math.radians(20.0)) - math.sin(math.radians(40.0)))
    found = []
    for left, right, underside in (("20 deg", "40 deg", height), ("40 deg", "20 deg", other)):
        angles = {"geometry.platform_angle": left, "geometry.right_platform_angle": right}
        case = coarse(**angles, **{"geometry.underside_height_at_shank": underside})
        structure = build_structure(case)
        assert isinstance(structure, Structure)
        joint = build_joint(case, structure)
        loads = [joint.preload[joint.face_pairs.face == face].sum() for face in (0, 1)]
        found.append((joined_modes(structure, joint.face_pairs, 3, joint.resting_springs)[0], loads))
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-6)
    assert found[0][1] == pytest.approx(found[1][1][::-1])


def test_a_part_of_the_right_side_that_does_not_fit() -> None:
    """The face of the right side is so steep and long that its lower end is below the base."""
    with rejects(InputError, "damper_flank_height", "underside_height_at_shank"):
        BladePairGeometry(contact_face_width=0.04, platform_angle_deg=5.0, right_platform_angle_deg=80.0)


@pytest.mark.slow
def test_check_states_the_force_and_whether_the_damper_locks() -> None:
    rows = dict(dict(check(coarse(**SPINNING)))["Derived quantities"])
    assert rows["Centrifugal force of the damper"].startswith("592.2 N")
    assert rows["Platform angle of lock-up"].startswith(f"{90.0 - math.degrees(math.atan(0.3)):.4g}")
    locked = coarse(**{"geometry.platform_angle": "50 deg", "friction.coefficient": 0.9})
    sentences = [words for _, words in dict(check(locked))["Warnings"] if "locks" in words]
    assert len(sentences) == 1
    printed_sentence(sentences[0])
    rows = dict(dict(check(locked))["Derived quantities"])
    assert rows["Normal load that moves the damper inwards, left face"].startswith("unlimited")
