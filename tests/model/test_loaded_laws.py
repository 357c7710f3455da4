"""Laws that take their load from the joint, about the state at rest of a solved preload."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from law_studies import JOINT, REST, SETTINGS, write_masses, write_study
from sentences import rejects
from stickslip.contact.law.exponential import ExponentialContact
from stickslip.contact.law.normal_law import PressureGapLaw
from stickslip.model.model import ReducedModel
from stickslip.model.solved_preload import SolvedPreload

LENGTH = 2e-5  # m, over which the pressure of the table grows by the factor e
SPRING = 1e4  # N/m, of each mass
PRESSURE = np.array([1e2, 1e3, 1e4, 1e6])
TABLE = (
    'law = "exponential"\nstiffness_law = "measured"\nallocation = "pressure"\n[interfaces.joint.stiffness_constants]\n'
    f"pressure = {PRESSURE.tolist()}\nnormal_stiffness = {(PRESSURE / LENGTH).tolist()}\n"
    f"tangential_stiffness = {(0.8 * PRESSURE / LENGTH).tolist()}\n"
)


def study(folder: Path, *forces: float, traction: str = "released", push: str = REST) -> ss.Case:
    """Masses on springs, each pressed to the ground and pulled aside a little; K = p / LENGTH."""
    write_masses(folder, len(forces))
    joint = f'[interfaces.joint]\nfirst = "all"\nsecond = "ground"\n{JOINT}{TABLE}'
    loads = f'[preload]\nmethod = "solved"\nnormal_law = "pressure-gap"\nresidual_traction = "{traction}"\n'
    for node, force in enumerate(forces, start=1):
        loads += f"[static_loads.press{node}]\nnode = {node}\ndirection = [0.1, 0, {np.sign(force):g}]\n"
        loads += f"force = {abs(force)}\n"
    return ss.load_case(write_study(folder, joint, loads, rest=push))


def preload_of(model: ReducedModel) -> SolvedPreload:
    """The state at rest."""
    assert model.preload is not None
    return model.preload


def law_of(model: ReducedModel) -> ExponentialContact:
    """The one law beside Coulomb's."""
    (law,) = (each for each in model.pairs.laws if isinstance(each, ExponentialContact))
    return law


@pytest.mark.long
def test_the_law_about_rest_is_the_curve_that_the_static_solution_followed(tmp_path: Path) -> None:
    """Under half more load on the same curve, the law about the first state gives the forces of the second one."""
    model = ss.build_model(study(tmp_path, 6.0, 2.0))
    law, rest, area = law_of(model), preload_of(model).state, model.joint.face_pairs.area
    np.testing.assert_allclose(law.normal_load, rest.normal_force, rtol=1e-12)
    np.testing.assert_allclose(law.length, LENGTH, rtol=1e-4)
    mean = rest.normal_force.sum() / area.sum()
    curve = PressureGapLaw.from_stiffness(area, lambda pressure: pressure / LENGTH, 0.01 * mean, 1e3 * mean)
    before, after = (
        ss.static_preload(
            model.superelement, preload_of(model).unloaded, load * model.static_load, friction=False, normal_law=curve
        )
        for load in (1.0, 1.5)
    )
    closing = (model.pairs.operator @ (after.displacement - before.displacement)).reshape(-1, 3)[:, 2]
    assert (closing > 0.3 * LENGTH).all()
    growth = after.normal_force / before.normal_force
    np.testing.assert_allclose(law.normal_law.force(closing)[0] / law.normal_load, growth, rtol=1e-4)


@pytest.mark.long
def test_open_and_nearly_open_pairs_keep_coulomb_friction(tmp_path: Path) -> None:
    """6 N press the first mass; the second one is pulled off, the third is on the linear start of the curve."""
    model = ss.build_model(study(tmp_path, 6.0, -1.0, 0.005))
    coulomb, law = model.pairs.laws
    assert [group.tolist() for group in model.pairs.members] == [[1, 2], [0]]
    assert isinstance(law, ExponentialContact)
    assert coulomb.normal_load[0] == 0.0 < coulomb.normal_load[1]
    assert model.pairs.gap[1] == pytest.approx(1.0 / np.sqrt(1.01) / SPRING, rel=1e-6)
    assert model.joint.closed_at_rest.tolist() == [True, False, True]
    np.testing.assert_allclose(model.joint.resting_springs, model.pairs.resting_stiffness(), rtol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("traction", ["released", "kept"])
def test_a_study_solves_its_curve_about_that_state(traction: str, tmp_path: Path) -> None:
    """The same law by hand about the state at rest gives the curve of the study."""
    push = REST.replace('"2 N"', '"0.1 N"').replace("15 Hz", "60 Hz").replace("30 Hz", "90 Hz")
    solution = ss.solve_case(study(tmp_path, 6.0, traction=traction, push=push))
    response, rest = solution.response, preload_of(solution.model).state
    assert response.converged
    law = ss.ExponentialContact(
        rest.normal_stiffness, rest.tangential_stiffness, np.array([0.3]), rest.normal_force,
        rest.traction if traction == "kept" else None,
    )  # fmt: skip
    pairs = ss.ContactPairs.with_laws(solution.model.pairs.operator, [law])
    by_hand = ss.forced_response(
        solution.model.superelement, pairs, solution.model.excitation, frequency_hz=(60.0, 90.0), **SETTINGS
    )
    np.testing.assert_allclose(by_hand.displacement, response.displacement, rtol=0.0, atol=1e-12)
    assert (np.abs(law.resting_traction).max() > 0.1) == (traction == "kept")


GIVEN = 'law = "exponential"\nnormal_stiffness = "1e4 N/m"\ntangential_stiffness = "8e3 N/m"\n'


@pytest.mark.parametrize(
    ("keys", "key"),
    [(TABLE, "preload.normal_law"), (GIVEN, "preload.method")],
    ids=["no curve", "no law of the pressure"],
)
def test_a_law_that_takes_its_load_requires_the_curve(keys: str, key: str, tmp_path: Path) -> None:
    study(tmp_path, 6.0)
    file = tmp_path / "study.toml"
    text = file.read_text(encoding="utf-8").replace('normal_law = "pressure-gap"\n', "").replace(TABLE, keys)
    file.write_text(text, encoding="utf-8")
    with rejects(ss.StudyFileError, key):
        ss.load_case(file)
