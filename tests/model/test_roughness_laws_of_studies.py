"""The law of [roughness] in a study: its stiffness, its keys, and its comparison with the believable band."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from castings import casting_case
from sentences import printed_sentence, rejects
from stickslip.case.case import TwoBladeCase
from stickslip.contact.stiffness.fractal import published_contact
from stickslip.model.joint import Joint
from stickslip.model.model import load_joint, set_up
from stickslip.model.rough_face import case_material, case_roughness
from stickslip.study.facts import derived_quantities, study_warnings
from stickslip.study.figure_process import rough_patch

SMOOTH: dict[str, object] = {"roughness.fractal_roughness": "1e-12 m"}


def joint_of(changes: dict[str, object]) -> tuple[TwoBladeCase, Joint]:
    case = casting_case().replace(changes)
    assert isinstance(case, TwoBladeCase)
    return case, load_joint(case, set_up(case).layout)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["persson", "greenwood-williamson", "bush-gibson-thomas"])
def test_a_study_names_the_law_of_its_roughness(law: str) -> None:
    case, joint = joint_of({**SMOOTH, "roughness.law": law})
    rough = case_roughness(case, *[case_material(case)] * 2)
    area, load = joint.face_sum(joint.face_pairs.area)[0], joint.face_sum(joint.preload)[0]
    wanted = ss.contact_stiffness(rough, load, area=area, law=law)  # type: ignore[call-overload]
    assert joint.face_sum(joint.normal_stiffness)[0] == pytest.approx(wanted.normal, rel=1e-9)
    assert joint.face_sum(joint.tangential_stiffness)[0] == pytest.approx(wanted.tangential, rel=1e-9)


def test_the_fractal_law_of_a_rough_casting_is_believable() -> None:
    case, joint = joint_of({})
    assert joint.face_sum(joint.normal_stiffness)[0] == pytest.approx(7.856e7, rel=1e-3)
    face = joint.rough_faces[0]
    assert face is not None
    assert face.believable is not None
    assert 0.5 < face.believable.ratio < 2.0
    assert not any("Believable" in sentence for sentence in study_warnings(case, joint))


def test_a_law_outside_of_the_band_is_reported_with_its_ratio() -> None:
    case, joint = joint_of(SMOOTH)
    sentences = [each for each in study_warnings(case, joint) if each.startswith("Believable")]
    assert len(sentences) == 1  # both faces have the same
    printed_sentence(sentences[0])


def test_a_law_in_the_band_that_is_softer_than_any_contact_of_its_area_is_reported() -> None:
    """With 1.8 GPa the face has 4 times the load of full plasticity; with 3 GPa 33 times."""
    case, joint = joint_of({"roughness.hardness": "1.8 GPa"})
    face = joint.rough_faces[0]
    assert face is not None
    assert face.believable is not None
    assert face.believable.is_inside
    assert face.one_spot is not None
    rough = case_roughness(case, *[case_material(case)] * 2)
    found = published_contact(rough, face.pressure * face.reference_area)
    assert face.believable.chosen * face.reference_area == pytest.approx(
        found.normal, rel=1e-13
    )  # the law is as it was
    least = 2 * rough.reduced_modulus * np.sqrt(found.real_area / np.pi)
    assert face.one_spot.ratio == pytest.approx(found.normal / least, rel=1e-9)
    assert face.one_spot.pressure / face.one_spot.plastic_pressure == pytest.approx(4.0, abs=0.5)
    sentences = [each for each in study_warnings(case, joint) if each.startswith("Below one spot")]
    assert len(sentences) == 1  # both faces have the same
    printed_sentence(sentences[0])


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"roughness.mode": "unloading", "roughness.hardness": "1.8 GPa"},
        {"roughness.law": "persson", "roughness.hardness": "1.8 GPa"},
        {"roughness.hardness": "0.5 GPa"},
    ],
    ids=["enough elastic spots", "unloading", "persson", "fully plastic"],
)
def test_laws_with_all_spots_are_not_below_one_spot(changes: dict[str, object]) -> None:
    case, joint = joint_of(changes)
    assert not any(each.startswith("Below one spot") for each in study_warnings(case, joint))


@pytest.mark.slow
def test_the_laws_are_beside_each_other_in_the_quantities() -> None:
    case, joint = joint_of({**SMOOTH, "roughness.law": "persson"})
    found = {name: value for name, value, _, _ in derived_quantities(case, joint)}
    fractal, persson = (found[f"Stiffness per unit area by {law} law"] for law in ("the fractal", "Persson's"))
    assert found["Stiffness of this study over Persson's law"] == 1.0
    assert found["Normal stiffness per unit area, left face"] == pytest.approx(persson, rel=1e-9)
    assert float(fractal) > 50 * float(persson)
    low, high = (float(end) for end in str(found["Believable stiffness per unit area"]).split(" to "))
    assert (low, high) == pytest.approx((float(persson) / 3, 3 * float(persson)), rel=0.01)


@pytest.mark.slow
def test_each_pair_at_its_own_pressure_and_form_that_the_mesh_has() -> None:
    _, even = joint_of({**SMOOTH, "roughness.law": "persson"})
    _, own = joint_of({**SMOOTH, "roughness.law": "persson", "roughness.allocation": "pressure"})
    assert own.normal_stiffness == pytest.approx(even.normal_stiffness, rel=1e-9)  # uniform pressure
    _, short = joint_of({**SMOOTH, "roughness.law": "persson", "roughness.form_length": "2 mm"})
    assert (short.normal_stiffness > 2 * even.normal_stiffness).all()
    _, other = joint_of({**SMOOTH, "roughness.law": "persson", "roughness.tangential_law": "sherif-kossa"})
    assert other.tangential_stiffness == pytest.approx(np.pi / 4 * even.tangential_stiffness, rel=1e-9)


@pytest.mark.parametrize(
    ("key", "value", "law"),
    [
        ("mode", "unloading", "persson"),
        ("domain_extension", 2.0, "persson"),
        ("form_length", "2 mm", "fractal"),
        ("tangential_law", "sherif-kossa", "fractal"),
    ],
)
def test_keys_of_another_law_are_rejected(key: str, value: object, law: str) -> None:
    with rejects(ss.StudyFileError, f"roughness.{key}"):
        casting_case().replace({"roughness.law": law, f"roughness.{key}": value})


@pytest.mark.slow
def test_sq_in_place_of_g() -> None:
    case = TwoBladeCase.from_text('[roughness]\nsq = "1.2 um"\nlaw = "persson"\n')
    again = TwoBladeCase.from_text(case.to_text())
    assert again == case
    assert 'sq = "1.2 um"' in case.to_text()
    joint = load_joint(case, set_up(case).layout)
    found = {name: value for name, value, _, _ in derived_quantities(case, joint)}
    assert found["Sq"] == pytest.approx(1.2, rel=1e-9)
    rough = case_roughness(case, *[case_material(case)] * 2)
    assert found["Fractal roughness G"] == rough.fractal_roughness
    with rejects(ss.StudyFileError, "roughness.sq"):
        TwoBladeCase.from_text('[roughness]\nsq = "1.2 um"\nfractal_roughness = "1e-8 m"\n')
    with rejects(ss.StudyFileError, "roughness.sq"):
        TwoBladeCase().replace({"roughness.sq": "0 um"})


def test_measured_sq_and_sdq_are_those_of_the_surface() -> None:
    case = TwoBladeCase.from_text('[roughness]\nsq = "1.2 um"\nsdq = 0.07\nsample_length = "0.8 mm"\n')
    joint = load_joint(case, set_up(case).layout)
    found = {name: value for name, value, _, _ in derived_quantities(case, joint)}
    assert found["Sq"] == pytest.approx(1.2, rel=1e-9)
    assert found["Sdq"] == pytest.approx(0.07, rel=1e-9)
    rough = case_roughness(case, *[case_material(case)] * 2)
    known = rough.hardness, rough.reduced_modulus, rough.poisson_ratio
    assert rough == ss.roughness_of_heights(1.2e-6, 0.07, 0.8e-3, *known)
    assert rough.shortest_length is not None
    assert found["Shortest wave"] == pytest.approx(1e6 * rough.shortest_length)
    area, load = joint.face_sum(joint.face_pairs.area)[0], joint.face_sum(joint.preload)[0]
    wanted = ss.contact_stiffness(rough, load, area=area)
    assert joint.face_sum(joint.normal_stiffness)[0] == pytest.approx(wanted.normal, rel=1e-9)
    patch = rough_patch(case, (4, 6))
    assert patch is not None
    assert (patch.sq, patch.sdq) == pytest.approx((1.2e-6, 0.07), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [{"roughness.sdq": 1e-4}, {"roughness.sdq": 5.0}, {"roughness.sdq": 0.5, "roughness.sq": "0.5 um"}],
    ids=["below one wave", "beyond all waves", "waves below atoms"],
)
def test_a_slope_that_no_surface_of_this_height_has(changes: dict[str, object]) -> None:
    case = TwoBladeCase().replace(changes)
    with rejects(ss.InputError, "roughness.sdq"):
        load_joint(case, set_up(case).layout)


def test_a_constant_stiffness_per_area() -> None:
    case = TwoBladeCase.from_text(
        '[contact_stiffness]\nstiffness_law = "constant"\n'
        'stiffness_constants = { normal_stiffness = "500 N/mm^3", tangential_stiffness = "400 N/mm^3" }\n'
    )
    joint = load_joint(case, set_up(case).layout)
    assert joint.normal_stiffness == pytest.approx(5e11 * joint.face_pairs.area)
    assert joint.tangential_stiffness == pytest.approx(4e11 * joint.face_pairs.area)
