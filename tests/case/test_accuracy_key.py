"""The keys harmonics and accuracy of [solver]: exactly one of them, and what a study without either has."""

from __future__ import annotations

import pytest

from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.core.errors import StudyFileError


def test_an_accuracy_replaces_the_default_number_of_harmonics() -> None:
    solver = Case.from_mapping({"solver": {"accuracy": "0.5 %"}}).solver
    assert (solver.accuracy, solver.harmonics) == (0.005, None)
    assert solver.resolution == "harmonics by an accuracy of 0.5 %"


def test_a_study_without_either_has_five_harmonics() -> None:
    solver = Case().solver
    assert (solver.accuracy, solver.harmonics) == (None, 5)


@pytest.mark.parametrize("kind", EXAMPLES)
def test_written_studies_have_an_accuracy_and_name_the_other_key(kind: str) -> None:
    text = Case.from_mapping(EXAMPLES[kind]).to_text()
    assert f'\naccuracy = "{"2 %" if kind in ("two-blade", "bladed-disk") else "0.5 %"}"' in text
    assert "\n# harmonics = 5" in text


@pytest.mark.parametrize("kind", EXAMPLES)
def test_a_study_with_harmonics_names_the_accuracy(kind: str) -> None:
    solver = {"harmonics": 5, "frequency_start": 100.0, "frequency_stop": 200.0}
    text = Case.from_mapping(EXAMPLES[kind] | {"solver": solver}).to_text()
    assert "\nharmonics = 5" in text
    assert '\n# accuracy = "0.5 %"' in text


def test_both_keys_are_rejected() -> None:
    with rejects(StudyFileError, "solver.accuracy"):
        Case.from_mapping({"solver": {"accuracy": "0.5 %", "harmonics": 3}})


def test_neither_key_is_rejected() -> None:
    with rejects(StudyFileError, "solver.accuracy"):
        Case().replace({"solver.harmonics": None, "solver.accuracy": None})


def test_a_percentage_without_its_sign_is_rejected_with_advice() -> None:
    with rejects(StudyFileError, "solver.accuracy"):
        Case.from_mapping({"solver": {"accuracy": 0.5}})


def test_few_samples_are_rejected() -> None:
    with rejects(StudyFileError, "solver.samples"):
        Case.from_mapping({"solver": {"accuracy": "0.5 %", "samples": 32}})


def test_a_force_in_a_harmonic_that_the_samples_do_not_allow_is_rejected() -> None:
    study = EXAMPLES["mesh"] | {"solver": {"accuracy": "0.5 %", "samples": 64}}
    study |= {"forces": {"shaker": EXAMPLES["mesh"]["forces"]["shaker"] | {"harmonic": 17}}}
    with rejects(StudyFileError, "forces.shaker.harmonic"):
        Case.from_mapping(study)
