"""The answer of a run and of a sweep in plain words."""

from __future__ import annotations

import dataclasses

import pytest

from stickslip.core.shown_numbers import length
from stickslip.reporting.best_of_worst import best_of_worst
from stickslip.reporting.verdict import verdict
from stickslip.reporting.view import View
from stickslip.results.sweep_table import SweptKey
from sweep_tables import sweep_view
from synthetic import synthetic_response, synthetic_study

DESIGN = SweptKey("friction.coefficient", "", (0.1, 0.3), (0.1, 0.3), "", ("0.1", "0.3"))
FORCES = SweptKey("excitation.amplitude", "N", (100.0, 200.0), (100.0, 200.0), "N", ("100 N", "200 N"))


def test_the_verdict_has_the_numbers_of_the_summary() -> None:
    view = View.of(synthetic_response(), synthetic_study())
    answer = verdict(view, warnings=2)
    measures = view.summary
    assert measures.reduction_from_stuck is not None
    first = answer.sentences[0]
    assert f"by {100.0 * measures.reduction_from_stuck:.2g} %" in first
    assert f"{measures.peak.frequency_hz:.2f} Hz" in first
    assert f"{measures.stuck_peak.frequency_hz:.2f} Hz" in first
    assert f"{sum(measures.state_counts[1:])} of 110 contact pairs" in answer.sentences[-1]
    assert "the 2 warnings below" in answer.limits


@pytest.mark.parametrize(
    ("counts", "cause"),
    [
        ((100, 10, 0), "Slip in the joint lowers"),
        ((100, 0, 10), "Separation in the joint lowers"),
        ((90, 10, 10), "Slip and separation in the joint lower"),
        ((110, 0, 0), "The joint lowers"),
    ],
)
def test_the_verdict_names_what_the_pairs_do(counts: tuple[int, int, int], cause: str) -> None:
    view = View.of(synthetic_response(), synthetic_study())
    object.__setattr__(view, "summary", dataclasses.replace(view.summary, state_counts=counts))
    assert verdict(view, warnings=0).sentences[0].startswith(f"{cause} the peak")


@pytest.mark.parametrize(
    ("reduction", "words"), [(-0.218, ": contact raises it by 22 %."), (0.3, " Hz."), (-0.004, " Hz.")]
)
def test_the_verdict_says_if_contact_raises_the_peak(reduction: float, words: str) -> None:
    view = View.of(synthetic_response(), synthetic_study())
    summary = dataclasses.replace(view.summary, reduction_from_free=reduction, free_peak=view.summary.stuck_peak)
    object.__setattr__(view, "summary", summary)
    (sentence,) = [each for each in verdict(view, warnings=0).sentences if each.startswith("Without contact")]
    assert sentence.endswith(words)
    assert ("raises" in sentence) == (reduction < -0.005)


def test_the_name_of_a_face_keeps_its_hyphens() -> None:
    study = synthetic_study()
    named = dataclasses.replace(study, face_names=tuple(f"side-{name} - B" for name in study.face_names))
    label = View.of(synthetic_response(), named).pair_label(0)
    assert label.startswith(f"side-{study.face_names[0]} - B, pair 1 (")


def test_an_incomplete_curve_limits_the_verdict() -> None:
    response = dataclasses.replace(synthetic_response(), converged=False)
    answer = verdict(View.of(response, synthetic_study()), warnings=0)
    assert answer.limits[0].startswith("the curve is not complete")


@pytest.mark.parametrize(
    ("value", "words"),
    [(5.18e-5, ("51.8", "µm")), (0.0123, ("12.3", "mm")), (3.4e-8, ("34", "nm")), (0.0, ("0", "µm"))],
)
def test_lengths_have_units_that_fit(value: float, words: tuple[str, str]) -> None:
    assert length(value) == words


def test_the_best_design_is_that_of_the_lowest_worst_load_case() -> None:
    # friction 0.1: 100 and 400 um under the two forces; friction 0.3: 200 and 300 um
    answer = best_of_worst(sweep_view((DESIGN, FORCES), [1e-4, 4e-4, 2e-4, 3e-4]))
    assert answer.startswith("Best design: friction coefficient 0.3. Its highest peak is 300 µm, ")
    assert answer.endswith(", in the load case excitation amplitude 200 N.")


def test_a_best_design_at_an_end_of_the_values_may_not_be_the_best() -> None:
    three = SweptKey("friction.coefficient", "", (0.1, 0.2, 0.3), (0.1, 0.2, 0.3), "", ("0.1", "0.2", "0.3"))
    assert best_of_worst(sweep_view((three,), [3e-4, 2e-4, 1e-4])).endswith(
        "This is at an end of the values of friction coefficient: a better one may be beyond."
    )
    assert "at an end" not in best_of_worst(sweep_view((three,), [3e-4, 1e-4, 2e-4]))


def test_a_design_with_an_unknown_peak_does_not_count() -> None:
    answer = best_of_worst(sweep_view((DESIGN, FORCES), [1e-4, 4e-4, None, 3e-4]))
    assert "friction coefficient 0.1" in answer
    assert answer.endswith("1 designs with an unknown peak do not count.")
    assert best_of_worst(sweep_view((FORCES,), [1e-4, 2e-4])) == ""
