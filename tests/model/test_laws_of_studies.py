"""Contact laws that a study file names: the same answer as from Python, closed forms, and what a file may not say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from law_studies import JOINT, REST, SETTINGS, STUDIES, WINDOW_HZ, interface_text, law_of, write_masses, write_study
from sentences import printed_sentence
from stickslip.contact.law.registry import law_constants
from stickslip.study.facts import resting_state


@pytest.mark.long
@pytest.mark.parametrize("name", STUDIES)
def test_a_study_gives_what_python_gives(name: str, tmp_path: Path) -> None:
    masses = write_masses(tmp_path)
    solution = ss.solve_case(ss.load_case(write_study(tmp_path, interface_text("joint", name))))
    operator = solution.model.pairs.operator
    pairs = ss.ContactPairs.with_laws(operator, [law_of(name)])
    curve = ss.forced_response(masses, pairs, solution.model.excitation, frequency_hz=WINDOW_HZ, **SETTINGS)
    np.testing.assert_allclose(curve.frequency_hz, solution.response.frequency_hz, rtol=1e-12)
    np.testing.assert_allclose(curve.displacement, solution.response.displacement, rtol=0.0, atol=1e-15)
    assert solution.converged
    assert (curve.contact_state != 0).any() or name == "cubic"


@pytest.mark.long
def test_a_cubic_spring_of_a_study_follows_its_backbone(tmp_path: Path) -> None:
    """Duffing with one harmonic: at the peak of the response w^2 = (k + 3/4 k3 X^2) / m."""
    write_masses(tmp_path)
    joint = f"""\
[interfaces.joint]
first = "all"
second = "ground"
{JOINT}law = "cubic"
[interfaces.joint.constants]
stiffness = "1e4 N/m"
cubic_stiffness = "5e8 N/m^3"
"""
    rest = REST.replace("[1, 0.5, 0.7]", "[1, 0, 0]").replace(
        "[solver]", "[solver]\nharmonics = 1\nlargest_step = 0.01"
    )
    curve = ss.solve_case(ss.load_case(write_study(tmp_path, joint, rest=rest))).response
    size = curve.amplitude([1.0, 0.0, 0.0])
    peak = int(size.argmax())
    backbone = np.sqrt(1e4 + 1e4 + 0.75 * 5e8 * size[peak] ** 2) / (2.0 * np.pi)
    assert backbone > 23.5  # well away from the 22.5 Hz of small motions
    assert curve.frequency_hz[peak] == pytest.approx(backbone, rel=2e-3)


@pytest.mark.slow
def test_the_pairs_of_a_face_share_its_constants_by_area(tmp_path: Path) -> None:
    write_masses(tmp_path, 3)
    for name in STUDIES:
        case = ss.load_case(write_study(tmp_path, interface_text("joint", name)))
        law = ss.build_model(case).pairs.laws[0]
        for key, value in law_constants(law_of(name, 3)).items():
            if isinstance(value, np.ndarray):
                np.testing.assert_allclose(getattr(law, key), value, rtol=1e-14, err_msg=f"{name} {key}")
            else:
                assert getattr(law, key) == value


@pytest.mark.slow
def test_interfaces_follow_different_laws(tmp_path: Path) -> None:
    masses = write_masses(tmp_path, 2)
    text = [interface_text(name, law, name) for name, law in (("mass2", "iwan"), ("mass1", "coulomb"))]
    case = ss.load_case(write_study(tmp_path, *text))
    solution = ss.solve_case(case)
    pairs = ss.ContactPairs.with_laws(
        solution.model.pairs.operator, [law_of("iwan"), law_of("coulomb")], members=[[0], [1]]
    )
    curve = ss.forced_response(masses, pairs, solution.model.excitation, frequency_hz=WINDOW_HZ, **SETTINGS)
    np.testing.assert_allclose(curve.displacement, solution.response.displacement, rtol=0.0, atol=1e-15)
    derived = {name: (value, unit) for name, value, unit, _ in solution.record.derived}
    assert derived["Contact law, mass2"] == ("iwan", "-")
    assert derived["Slip force, mass2"] == ("4", "N")
    assert derived["Normal load, mass1"] == (3.0, "N")
    assert "Normal load, mass2" not in derived
    assert "mass2: law iwan (slip_force 4 N, exponent -0.5, ratio 0.3)" in solution.record.description


@pytest.mark.slow
def test_coulomb_by_name_is_the_joint_that_a_study_without_a_law_has(tmp_path: Path) -> None:
    write_masses(tmp_path, 2)
    text = interface_text("joint", "coulomb")
    named = ss.build_model(ss.load_case(write_study(tmp_path, text)))
    plain = ss.build_model(ss.load_case(write_study(tmp_path, text.replace('law = "coulomb"\n', ""))))
    assert named.joint.laws == ()
    for key, value in law_constants(plain.pairs.coulomb).items():
        np.testing.assert_array_equal(getattr(named.pairs.coulomb, key), value)


@pytest.mark.long
@pytest.mark.parametrize("traction", ["kept", "released"])
def test_laws_of_a_study_under_a_solved_preload_are_those_of_python(traction: str, tmp_path: Path) -> None:
    """Each of three masses on a joint of its own is pulled aside and pressed, then excited about this state."""
    names = ("coulomb", "elastic-stop", "jenkins")
    masses = write_masses(tmp_path, 3)
    joints = [
        interface_text(name.replace("-", ""), name, f"mass{at + 1}").replace('normal_load = "3 N"\n', "")
        for at, name in enumerate(names)
    ]
    pull = "".join(
        f'[static_loads.{name}{at}]\nnode = {at + 1}\ndirection = {direction}\nforce = "{force} N"\n'
        for at in range(3)
        for name, direction, force in (("press", [0, 0, 1], 9.0), ("pull", [1, 0, 0], 0.5))
    )
    solved = f'[preload]\nmethod = "solved"\nresidual_traction = "{traction}"\n'
    solution = ss.solve_case(ss.load_case(write_study(tmp_path, *joints, pull, solved)))
    model = solution.model
    assert model.preload is not None
    load = np.tile([0.5, 0.0, 9.0], 3)
    assert np.array_equal(model.static_load, load)
    parts = [law_of(name) for name in names]
    parts[0] = ss.CoulombLaw.with_preload(1, 1e4, 8e3, parts[0].friction_coefficient, 0.0)
    pairs = ss.ContactPairs.with_laws(model.pairs.operator, parts)
    state = ss.static_preload(masses, pairs, load, friction=traction == "kept")
    np.testing.assert_allclose(model.preload.state.displacement, state.displacement, rtol=1e-12)
    about = state.about(pairs, keep_traction=traction == "kept")
    curve = ss.forced_response(masses, about, model.excitation, frequency_hz=WINDOW_HZ, **SETTINGS)
    np.testing.assert_allclose(curve.displacement, solution.response.displacement, rtol=0.0, atol=1e-14)
    closed = model.joint.resting_springs.reshape(3, 3)
    assert closed[1, 2] == 3e4  # the stop of 2e4 N/m is closed at rest, beside its spring
    assert state.normal_force[0] > 0.0
    rows = {row[0]: row[1] for row in resting_state(model)}
    assert rows["Pairs in the state 'hits the stop' at rest, elasticstop"] == 1
    assert rows["Normal force at rest, elasticstop"] == pytest.approx(float(state.normal_force[1]))
    assert rows["Pairs open at rest, coulomb"] == 0


def test_a_stiffness_that_an_interface_leaves_out_is_that_of_all_faces(tmp_path: Path) -> None:
    """An Iwan joint requires the tangential one alone; the normal one was 0 then, whatever [contact_stiffness] said."""
    write_masses(tmp_path)
    common = '[contact_stiffness]\nnormal_stiffness = "1e6 N/m"\ntangential_stiffness = "9e5 N/m"\n'
    pairs = ss.build_model(ss.load_case(write_study(tmp_path, interface_text("joint", "iwan"), common))).pairs
    assert pairs.resting_stiffness().tolist() == [1e4, 1e4, 1e6]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["jenkins", "iwan"])
def test_a_released_joint_has_no_states_at_rest_and_keeps_its_normal_force(name: str, tmp_path: Path) -> None:
    """All pairs of laws with friction were called slipping, also where nothing can slip."""
    write_masses(tmp_path)
    common = '[contact_stiffness]\nnormal_stiffness = "1e6 N/m"\ntangential_stiffness = "9e5 N/m"\n'
    press = '[static_loads.press]\nnode = 1\ndirection = [0, 0, 1]\nforce = "9 N"\n[preload]\nmethod = "solved"\n'
    model = ss.build_model(ss.load_case(write_study(tmp_path, interface_text("joint", name), common, press)))
    rows = {row[0]: row[1] for row in resting_state(model)}
    assert not [row for row in rows if row.startswith("Pairs")]
    assert model.preload is not None
    printed_sentence(model.preload.state.message, name, numbers=False)
    assert float(rows["Normal force at rest, joint"]) > 3.0
    (law,) = model.pairs.laws
    assert law.normal_load == pytest.approx([rows["Normal force at rest, joint"]])
    assert law.cycle(np.zeros((8, 1, 3))).force[:, 0, 2] == pytest.approx(float(law.normal_load[0]))
