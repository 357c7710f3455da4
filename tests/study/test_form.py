"""Waves of a roughness that contact pairs could carry as gaps: rows of `check`, and the warning of double counting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castings import casting_case
from sentences import printed_sentence
from stickslip.case.case import TwoBladeCase
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint
from stickslip.model.model import load_joint, set_up
from stickslip.study.facts import derived_quantities, study_warnings
from stickslip.study.form import form_of_gaps, form_rows, form_warnings

LONG = {"roughness.law": "persson", "roughness.fractal_roughness": "1e-12 m"}


def joint_of(changes: dict[str, object]) -> tuple[TwoBladeCase, Joint]:
    case = casting_case().replace(changes)
    assert isinstance(case, TwoBladeCase)
    return case, load_joint(case, set_up(case).layout)


def with_gaps(joint: Joint, gap: FloatArray) -> Joint:
    return replace(joint, layout=replace(joint.layout, face_pairs=replace(joint.face_pairs, gap=gap)))


@pytest.mark.slow
def test_check_gives_the_law_without_waves_that_the_pairs_could_carry() -> None:
    case, joint = joint_of(dict(LONG))
    rows = {name: (value, note) for name, value, _, note in derived_quantities(case, joint)}
    spacing = np.sqrt(joint.face_pairs.area[joint.face_pairs.face == 0].mean())
    assert f"{2e3 * spacing:.3g} mm" in rows["Sq of waves that the pairs could carry"][1]
    with_, without = (
        float(rows[name][0]) for name in ("Sq of waves that the pairs could carry", "Sq without these waves")
    )
    assert np.hypot(with_, without) == pytest.approx(float(rows["Sq"][0]), rel=1e-9)
    # What a user gets who follows the advice.
    _, short = joint_of({**LONG, "roughness.form_length": f"{2e3 * spacing} mm"})
    stiffness = short.face_sum(short.normal_stiffness)[0] / short.face_sum(short.face_pairs.area)[0]
    assert 1e9 * float(rows["Stiffness per unit area without these waves"][0]) == pytest.approx(stiffness, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {**LONG, "roughness.form_length": "2 mm"},
        {"roughness.law": "fractal"},
        {**LONG, "roughness.sample_length": "0.8 mm"},
    ],
    ids=["decided", "fractal", "only short waves"],
)
def test_no_row_where_there_is_nothing_to_decide(changes: dict[str, object]) -> None:
    case, joint = joint_of(dict(changes))
    assert list(form_rows(case, joint)) == []
    assert list(form_warnings(case, with_gaps(joint, 1e-4 * np.cos(np.arange(joint.face_pairs.gap.size))))) == []


@pytest.mark.slow
def test_long_waves_that_decide_the_stiffness_are_reported_although_the_mesh_is_flat() -> None:
    """The criterion is the believable band: a factor of 3 of the stiffness."""
    case = TwoBladeCase().replace({"roughness.fractal_dimension": 2.1, "roughness.sample_length": "28 mm"})
    assert isinstance(case, TwoBladeCase)
    joint = load_joint(case, set_up(case).layout)
    rows = {name: value for name, value, _, _ in derived_quantities(case, joint)}
    face = joint.rough_faces[0]
    assert face is not None
    assert face.believable is not None
    ratio = 1e9 * float(rows["Stiffness per unit area without these waves"]) / face.believable.persson
    assert ratio > 3.0
    sentences = [each for each in study_warnings(case, joint) if "Form or roughness" in each]
    assert f"{ratio:.3g} times without" in sentences[0]
    printed_sentence(sentences[0], "form_length", "sample_length")


@pytest.mark.slow
def test_gaps_as_high_as_the_long_waves_are_reported() -> None:
    case, joint = joint_of(dict(LONG))
    assert not any("Form or roughness" in sentence for sentence in study_warnings(case, joint))
    position = joint.face_pairs.face_position
    tilted = 1e-3 * position[:, 0] - 2e-3 * position[:, 1]
    assert form_of_gaps(with_gaps(joint, tilted).face_pairs, 0) < 1e-12  # a wedge is no wave
    waved = with_gaps(joint, tilted + 2e-6 * np.cos(2.0 * np.pi * position[:, 0] / 7e-3))
    sentences = list(form_warnings(case, waved))
    assert len(sentences) == len(joint.face_names)
    printed_sentence(sentences[0])
