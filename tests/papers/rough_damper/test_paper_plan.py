"""The plan: every case of the whole study is valid, has its own key, and differs from the base as its labels say."""

from __future__ import annotations

import pytest

from sentences import rejects
from stickslip.case.case import TwoBladeCase
from stickslip.core.errors import StudyFileError
from stickslip.model.model import load_joint, set_up
from stickslip.papers.rough_damper.plan import (
    BASE_CHOICE,
    CHOICES,
    EXCITATIONS,
    LOAD_KEY,
    MODES,
    Choice,
    Computation,
    Scope,
    base_case,
    changes,
    computations,
    variant,
)


@pytest.fixture(scope="module")
def plan() -> tuple[Computation, ...]:
    return computations(Scope())


@pytest.mark.slow
def test_size_and_keys(plan: tuple[Computation, ...]) -> None:
    assert 350 <= len(plan) <= 420  # at some 2.3 s each, 420 take 8 minutes on two cores
    assert len({each.planned.key for each in plan}) == len(plan)
    assert len({each.planned.name for each in plan}) == len(plan)
    # Three excitation heights, and one with the places of the static load.
    assert len({each.planned.structure for each in plan}) == 4


@pytest.mark.long
def test_every_joint_of_the_study_has_a_stiffness(plan: tuple[Computation, ...]) -> None:
    layout = set_up(plan[0].planned.case).layout
    for each in plan:
        joint = load_joint(each.planned.case, layout)
        assert joint.normal_stiffness.min() > 0.0


@pytest.mark.slow
def test_labels_are_the_inputs(plan: tuple[Computation, ...]) -> None:
    for each in plan:
        s, case = each.setting, each.planned.case
        assert case.roughness is not None
        assert isinstance(case, TwoBladeCase)
        assert (case.excitation.mode, case.excitation.amplitude) == (s.excitation, s.force)
        assert case.preload.centrifugal_force == s.load
        assert (case.roughness.fractal_dimension, case.roughness.fractal_roughness) == (s.dimension, s.scale)
        assert case.roughness.mode == MODES[s.law]


LABELLED = {
    "excitation.mode",
    "excitation.amplitude",
    "preload.centrifugal_force",
    "roughness.fractal_dimension",
    "roughness.fractal_roughness",
}


@pytest.mark.slow
@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: choice.name)
def test_a_changed_choice_changes_that_key_alone(plan: tuple[Computation, ...], choice: Choice) -> None:
    base = base_case(Scope()).to_dict()
    for value in choice.others:
        actual = [each for each in plan if each.setting.choice == variant(choice, value)]
        assert {each.setting.excitation for each in actual} == set(EXCITATIONS)
        for each in actual:
            inputs = each.planned.case.to_dict()
            changed = {
                f"{part}.{name}" for part in inputs for name in inputs[part] if inputs[part][name] != base[part][name]
            }
            assert choice.key in changed
            assert changed - LABELLED <= {choice.key}


@pytest.mark.parametrize(("choice", "value"), list(changes(Scope())), ids=str)
def test_under_every_change_forces_and_loads_can_be_compared(
    plan: tuple[Computation, ...], choice: Choice, value: str
) -> None:
    scope, name = Scope(), variant(choice, value)
    labels = {name, BASE_CHOICE} if choice.key == LOAD_KEY else {name}
    computed = {
        (s.force, s.load, s.dimension, s.scale, s.excitation)
        for s in (each.setting for each in plan)
        if s.choice in labels and (s.choice != BASE_CHOICE or s.law == "consistent")
    }
    main = {"50 N": 50.0, "200 N": 200.0}[value] if choice.key == LOAD_KEY else 100.0
    for excitation in EXCITATIONS:
        for dimension, scale in scope.roughness(short=True):
            assert (5.0, main, dimension, scale, excitation) in computed
        for dimension, scale in scope.compared:
            assert (2.0, main, dimension, scale, excitation) in computed
            assert (5.0, main / 2, dimension, scale, excitation) in computed


@pytest.mark.slow
def test_the_papers_roughness_is_plastic_in_the_base_law_and_runs_in_unloading(plan: tuple[Computation, ...]) -> None:
    layout = set_up(plan[0].planned.case).layout
    for dimension in (2.2, 2.3):
        actual = [each for each in plan if (each.setting.dimension, each.setting.scale) == (dimension, 1e-8)]
        assert {each.setting.law for each in actual} == {"unloading"}
        face = load_joint(actual[0].planned.case.replace({"roughness.mode": "consistent"}), layout).rough_faces[0]
        assert face is not None
        assert face.messages[0].startswith("Fully plastic")


@pytest.mark.slow
def test_a_scope_that_computes_a_curve_twice_is_rejected() -> None:
    with rejects(StudyFileError):
        computations(Scope(extra=((2.4, 1e-9, "consistent"),)))


def test_base_comes_first(plan: tuple[Computation, ...]) -> None:
    assert plan[0].setting.choice == BASE_CHOICE
