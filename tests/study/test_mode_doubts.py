"""What makes the nonlinear mode of a study doubtful: reduction, nodes, and amplitudes that the output does not have."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.case.analysis import ModeAnalysis
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.model.model import build_model
from stickslip.study import mode_doubts
from stickslip.study.check import check
from stickslip.study.mode import FirstMotion, allowed_mode
from stickslip.study.mode_doubts import amplitude_doubts, node_doubts, reduction_doubts
from sweep_cases import quick_case


def mode_case(mode: int, **keys: Any) -> Case:
    """The coarse case, with 8 modes in its reduction."""
    others = {f"analysis.{key}": value for key, value in keys.items()}
    return quick_case().replace({"analysis.kind": "mode", "analysis.mode": mode, **others})


def analysis_of(case: Case) -> ModeAnalysis:
    assert isinstance(case.analysis, ModeAnalysis)
    return case.analysis


def test_modes_that_the_reduction_represents_have_no_warning() -> None:
    for case in (mode_case(1), mode_case(6), mode_case(2, limit="sliding"), quick_case()):
        assert not reduction_doubts(case, build_model(case))


def test_a_mode_that_is_one_or_two_percent_off_has_a_warning() -> None:
    case = mode_case(9)
    (words,) = reduction_doubts(case, build_model(case))
    printed_sentence(words)


@pytest.mark.parametrize(("mode", "limit"), [(24, "stuck"), (99, "stuck"), (99, "sliding")])
def test_a_mode_that_the_full_model_does_not_have_is_rejected(mode: int, limit: str) -> None:
    case = mode_case(mode, limit=limit)
    with rejects(InputError, "analysis.mode"):
        reduction_doubts(case, build_model(case))


def test_a_comparison_that_fails_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_modes(*_: object) -> None:
        raise ConvergenceError("the iteration did not converge.")

    monkeypatch.setattr(mode_doubts, "closest_full_mode", no_modes)
    case = mode_case(1)
    (words,) = reduction_doubts(case, build_model(case))
    printed_sentence(words)


def test_a_check_tells_of_a_mode_above_those_of_the_reduction() -> None:
    (words,) = (sentence for _, sentence in dict(check(mode_case(9)))["Warnings"] if "analysis.mode" in sentence)
    printed_sentence(words)
    assert "analysis.mode" not in str(dict(check(mode_case(8))).get("Warnings"))


def test_a_mode_with_a_node_at_the_output_is_rejected() -> None:
    """In mode 3 both blades twist, and the middle of their tips stays."""
    case = mode_case(3)
    with rejects(InputError, "analysis.mode"):
        allowed_mode(case, build_model(case))


def test_an_output_close_to_a_node_has_a_warning() -> None:
    analysis = analysis_of(mode_case(1))
    assert not node_doubts("tip", FirstMotion(3.0, 0.02), analysis)
    (words,) = node_doubts("tip", FirstMotion(3.0, 0.002), analysis)
    printed_sentence(words)


def moved(smallest: float, largest: float, limit: str = "stuck", converged: bool = True) -> Any:
    """A mode whose output moves by so many m at its ends."""
    order = 1 if limit == "stuck" else -1
    return SimpleNamespace(
        modal_amplitude=np.array([1e-6, 1e-5, 1e-4])[::order],
        harmonic_amplitude=lambda output, harmonic: np.array([smallest, 1e-6, largest])[::order],
        converged=converged,
        limit=limit,
    )


def test_amplitudes_that_the_output_does_not_have_are_named() -> None:
    """The study asks for 0.01 to 100 um."""
    analysis, row = analysis_of(mode_case(1)), np.ones(1)
    assert not amplitude_doubts(moved(1.04e-8, 0.96e-4), "tip", row, analysis)
    for mode in (moved(0.8e-8, 1.3e-4), moved(1e-8, 0.5e-4, "sliding")):
        (words,) = amplitude_doubts(mode, "tip", row, analysis)
        printed_sentence(words)
    # An end that the branch does not reach has a message of its own.
    assert not amplitude_doubts(moved(1e-8, 0.5e-4, converged=False), "tip", row, analysis)
    assert not amplitude_doubts(moved(0.5e-8, 1e-4, "sliding", converged=False), "tip", row, analysis)
