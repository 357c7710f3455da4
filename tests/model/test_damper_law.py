"""The contact law of the two faces of a damper: `[friction] law`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.contact.law.exponential import ExponentialContact
from stickslip.model.model import load_joint, set_up
from stickslip.results.measures import summary
from stickslip.results.record import CONSTANT_STIFFNESS_PEAK
from stickslip.study.facts import derived_quantities, study_warnings
from sweep_cases import COARSE_MESH, quick_case

EXPONENTIAL: dict[str, Any] = {"friction.law": "exponential"}


def test_both_faces_follow_the_law_with_the_springs_at_rest_of_coulomb_pairs() -> None:
    plain, followed = (ss.build_model(quick_case().replace(changes)) for changes in ({}, EXPONENTIAL))
    laws = followed.pairs.laws
    assert all(isinstance(law, ExponentialContact) for law in laws)
    assert len(laws) == 2
    np.testing.assert_allclose(followed.pairs.resting_stiffness(), plain.pairs.resting_stiffness(), rtol=1e-13)
    np.testing.assert_allclose(followed.pairs.normal_load, plain.pairs.preload, rtol=1e-13)
    np.testing.assert_allclose(followed.pairs.friction_coefficient, 0.3)
    assert study_warnings(quick_case().replace(EXPONENTIAL), followed.joint) == study_warnings(
        quick_case(), plain.joint
    )


@pytest.mark.long
def test_a_study_with_the_law_moves_its_peak_reports_the_difference_and_balances_its_energy() -> None:
    solutions = [ss.solve_case(quick_case().replace(changes)) for changes in ({}, EXPONENTIAL)]
    curves = [each.response for each in solutions]
    assert curves[1].converged
    plain, followed = ({name: value for name, value, _, _ in each.record.derived} for each in solutions)
    assert not any(name.startswith(CONSTANT_STIFFNESS_PEAK) for name in plain)
    top = summary(curves[0], next(iter(solutions[0].record.outputs.values()))).peak
    assert followed[CONSTANT_STIFFNESS_PEAK] == pytest.approx(1e6 * top.amplitude, rel=1e-6)
    assert followed[f"{CONSTANT_STIFFNESS_PEAK}: frequency"] == pytest.approx(top.frequency_hz, rel=1e-6)
    lost = curves[1].dissipated_energy.sum(axis=1) + curves[1].viscous_energy
    np.testing.assert_allclose(lost, curves[1].input_energy, rtol=1e-5)
    first, second = (float(curve.amplitude(np.ones(curve.n_unknowns)).max()) for curve in curves)
    assert second != pytest.approx(first, rel=1e-3)


@pytest.mark.long
def test_under_a_solved_preload_the_pairs_follow_the_curve_of_their_face() -> None:
    """Machined faces: some pairs are open at rest or nearly so, the others have nearly the same length."""
    case = ss.Case().replace(
        COARSE_MESH | EXPONENTIAL | {"preload.method": "solved", "preload.normal_law": "pressure-gap"}
    )
    model = ss.build_model(case)
    assert model.preload is not None
    laws = model.pairs.laws[1:]
    assert all(isinstance(law, ExponentialContact) for law in laws)
    state, area = model.preload.state, model.joint.face_pairs.area
    mean = state.normal_force.sum() / area.sum()  # both faces carry the same
    nearly_open = np.flatnonzero(state.normal_force / area <= 0.01 * mean)
    assert model.pairs.members[0].tolist() == nearly_open.tolist()
    assert 0 < nearly_open.size < model.pairs.n_pairs / 2
    length = np.concatenate([law.length for law in laws if isinstance(law, ExponentialContact)])
    assert length.max() < 2.5 * length.min()
    rows = {name: words for name, _, _, words in derived_quantities(case, model.joint)}
    assert f"of {laws[0].n_pairs} of 15 pairs" in rows["Contact law, left face"]


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"friction.law": "exponentiel"}, "friction.law"),
        ({"friction.law": "iwan"}, "friction.law"),
        (EXPONENTIAL | {"preload.method": "solved"}, "preload.normal_law"),
        (
            EXPONENTIAL
            | {"analysis.kind": "wear", "analysis.wear_coefficient": "1e-8 mm^3/(N m)", "analysis.wear_cycles": 1e6},
            "friction.law",
        ),
    ],
)
def test_what_does_not_fit_the_law_is_rejected_by_its_key(changes: dict[str, Any], key: str) -> None:
    with rejects(ss.StudyFileError, key):
        quick_case().replace(changes)


@pytest.mark.parametrize(("allocation", "warns"), [("area", True), ("pressure", False)])
def test_a_face_whose_pairs_stiffen_at_different_rates_is_a_warning(allocation: str, warns: bool) -> None:
    """Loads of 1 and 20 N on pairs with nearly the same stiffness."""
    loads = ([1.0] * 5 + [20.0] * 10) * 2
    changes = {"preload.centrifugal_force": None, "preload.values": loads, "roughness.allocation": allocation}
    case = ss.Case().replace(COARSE_MESH | EXPONENTIAL | changes)
    found = load_joint(case, set_up(case).layout).stiffness_warnings
    assert len(found) == (2 if warns else 0)
    for sentence in found:
        printed_sentence(sentence, "face", numbers=False)


def test_pairs_without_load_are_rejected_by_the_key_of_the_preload() -> None:
    count = 2 * 3 * 5
    values = [1.0] * (count - 1) + [0.0]
    case = quick_case().replace(EXPONENTIAL | {"preload.centrifugal_force": None, "preload.values": values})
    with rejects(ss.InputError, "preload"):
        ss.build_model(case)
