"""The contact law of the two faces of a damper: `[friction] law`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import rejects
from stickslip.contact.law.exponential import ExponentialContact
from stickslip.study.facts import study_warnings
from sweep_cases import quick_case

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


@pytest.mark.slow
def test_a_study_with_the_law_moves_its_peak_and_balances_its_energy() -> None:
    curves = [ss.solve_case(quick_case().replace(changes)).response for changes in ({}, EXPONENTIAL)]
    assert curves[1].converged
    lost = curves[1].dissipated_energy.sum(axis=1) + curves[1].viscous_energy
    np.testing.assert_allclose(lost, curves[1].input_energy, rtol=1e-5)
    first, second = (float(curve.amplitude(np.ones(curve.n_unknowns)).max()) for curve in curves)
    assert second != pytest.approx(first, rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"friction.law": "exponentiel"}, "friction.law"),
        ({"friction.law": "iwan"}, "friction.law"),
        (EXPONENTIAL | {"preload.method": "solved"}, "preload.method"),
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


def test_pairs_without_load_are_rejected_by_the_key_of_the_preload() -> None:
    count = 2 * 3 * 5
    values = [1.0] * (count - 1) + [0.0]
    case = quick_case().replace(EXPONENTIAL | {"preload.centrifugal_force": None, "preload.values": values})
    with rejects(ss.InputError, "preload"):
        ss.build_model(case)
