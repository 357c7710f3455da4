"""Stiffness of the faces of a study while they wear: roughness that runs in, and loads that change."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint
from stickslip.model.model import kind_of, load_joint, set_up
from stickslip.model.worn_faces import RunningIn, WornFaces
from sweep_cases import COARSE_MESH

ROUGH: dict[str, Any] = {**COARSE_MESH, "roughness.sq": "2 um", "roughness.fractal_roughness": None,
                         "roughness.law": "persson"}  # fmt: skip


def joint_of(**changes: Any) -> tuple[Case, Joint]:
    case = Case().replace(ROUGH | {f"roughness.{key}": value for key, value in changes.items()})
    return case, load_joint(case, set_up(case).layout)


def worn_faces(running_in: tuple[float, float] | None = None, **changes: Any) -> tuple[WornFaces, FloatArray]:
    """The faces, and the loads of their pairs."""
    case, joint = joint_of(**changes)
    rule = None if running_in is None else RunningIn.of(case, *running_in)
    return WornFaces(case, joint, kind_of(case).face_settings(case), rule), joint.preload


def test_without_wear_the_springs_are_those_of_the_study() -> None:
    faces, load = worn_faces((0.5e-6, 1e-6))
    normal, tangential = faces.stiffness(load, np.zeros(load.size))
    assert normal == pytest.approx(faces.joint.normal_stiffness, rel=1e-12)
    assert tangential == pytest.approx(faces.joint.tangential_stiffness, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["persson", "greenwood-williamson"])
def test_a_face_runs_in_with_its_mean_depth(law: str) -> None:
    faces, load = worn_faces((0.5e-6, 2e-6), law=law)
    pairs = faces.joint.face_pairs
    depth = np.where(pairs.face == 0, 3e-6, 0.0)
    normal, _ = faces.stiffness(load, depth)
    # The study with the roughness of the worn face.
    sq = 0.5e-6 + 1.5e-6 * math.exp(-1.5)
    _, smooth = joint_of(law=law, sq=sq)
    assert normal[pairs.face == 0] == pytest.approx(smooth.normal_stiffness[pairs.face == 0], rel=1e-6)
    assert normal[pairs.face == 1] == pytest.approx(faces.joint.normal_stiffness[pairs.face == 1], rel=1e-12)
    assert normal[pairs.face == 0].sum() > 1.5 * normal[pairs.face == 1].sum()


@pytest.mark.slow
def test_the_slope_of_a_face_that_runs_in_falls_with_its_height() -> None:
    """Sdq is proportional to Sq where the waves remain, so the smooth face has the same waves."""
    faces, load = worn_faces((0.5e-6, 2e-6), sdq=0.1)
    normal, _ = faces.stiffness(load, np.full(load.size, 3e-6))
    sq = 0.5e-6 + 1.5e-6 * math.exp(-1.5)
    _, smooth = joint_of(sq=sq, sdq=0.1 * sq / 2e-6)
    assert normal == pytest.approx(smooth.normal_stiffness, rel=1e-6)


def test_pairs_with_their_own_pressure_follow_their_load() -> None:
    faces, load = worn_faces(allocation="pressure")
    normal, _ = faces.stiffness(2.0 * load, np.zeros(load.size))
    twice = faces.joint.normal_stiffness * 2.0
    assert normal == pytest.approx(twice, rel=0.3)  # of Persson's law nearly proportional
    assert (normal > 1.4 * faces.joint.normal_stiffness).all()


def test_a_face_that_loses_its_load_keeps_a_small_stiffness() -> None:
    faces, load = worn_faces()
    normal, _ = faces.stiffness(np.zeros(load.size), np.zeros(load.size))
    assert (normal > 0.0).all()
    assert normal.sum() < 0.1 * faces.joint.normal_stiffness.sum()


def test_a_roughness_that_would_rise_is_rejected() -> None:
    with rejects(ss.InputError, "analysis.running_in_sq"):
        RunningIn.of(joint_of()[0], 3e-6, 1e-6)
