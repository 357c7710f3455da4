"""Data for the report beside a response: references of the mode table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from own_cases import mesh_case
from sentences import printed_sentence
from stickslip.contact.law.law import ContactState
from stickslip.model.model import build_model, set_up
from stickslip.reporting.page import page
from stickslip.results.record import Value
from stickslip.study.analyses import solve
from stickslip.study.check import check
from stickslip.study.record import (
    _beside_reference,
    _doubtful_order,
    _face_directions,
    changed_inputs,
    study_record,
)
from stickslip.study.run import _with_unit
from sweep_cases import quick_case
from synthetic import synthetic_response, synthetic_study

MODES = (350.0, 415.0, 528.0)


def warnings_with(*reference_hz: float) -> tuple[str, ...]:
    rows: list[dict[str, Value]] = [{"mode": place + 1, "full_hz": frequency} for place, frequency in enumerate(MODES)]
    return _doubtful_order(tuple(_beside_reference(rows, reference_hz)))


def test_references_of_a_test_that_lacks_the_first_mode_are_doubted() -> None:
    (sentence,) = warnings_with(412.0, 530.0)
    printed_sentence(sentence, "reference.mode_frequencies", "412", "530")


@pytest.mark.parametrize("reference_hz", [(0.0, 412.0, 530.0), (300.0, 400.0), (0.0, 0.0, 528.0, 900.0)])
def test_references_in_the_order_of_the_modes_are_not(reference_hz: tuple[float, ...]) -> None:
    assert warnings_with(*reference_hz) == ()


def test_modes_so_close_that_order_is_all_there_is_are_not_doubted() -> None:
    rows: list[dict[str, Value]] = [{"mode": 1, "full_hz": 500.0}, {"mode": 2, "full_hz": 500.5}]
    assert _doubtful_order(tuple(_beside_reference(rows, (500.4, 500.9)))) == ()


@pytest.mark.long
def test_few_rows_of_pairs_are_a_warning_if_pairs_separate_at_the_peak() -> None:
    case = quick_case()
    model = build_model(case)
    response = solve(case, model, threads=1)
    peak = int(response.amplitude(next(iter(model.outputs.values()))).argmax())
    few = study_record(case, model, (), response).warnings
    opens = response.contact_state[peak] == ContactState.SEPARATING
    assert opens.any()
    printed_sentence("\n".join(few), "3 on left face")
    assert "mesh.contact_columns = 8" in few[-1]
    closed = replace(response, contact_state=np.zeros_like(response.contact_state))
    assert study_record(case, model, (), closed).warnings == few[:-1]


def test_values_without_a_unit_have_none_in_the_terminal() -> None:
    assert [_with_unit(*each) for each in (("12", "-"), ("-", "Hz"), ("81.32", "Hz"))] == ["12", "-", "81.32 Hz"]


@pytest.mark.slow
def test_check_lists_the_rows_of_pairs() -> None:
    (sizes,) = [dict(rows) for name, rows in check(quick_case()) if name == "Sizes"]
    assert sizes["rows of pairs"].startswith("3 by 5 on a face; few, if pairs separate")


@pytest.mark.slow
def test_the_page_lists_the_inputs_that_differ_from_their_defaults() -> None:
    case = quick_case().replace({"friction.coefficient": 0.25})
    record = replace(synthetic_study(), inputs=case.to_text())
    lines = changed_inputs(record)
    assert lines == case.changed_keys()
    assert "friction.coefficient = 0.25" in lines
    assert "<li><code>friction.coefficient = 0.25</code></li>" in page(synthetic_response(), record, lines)


def test_inputs_of_a_version_with_other_keys_have_no_such_list() -> None:
    assert changed_inputs(replace(synthetic_study(), inputs='[friction]\nroughening = "0.2"\n')) == ()


@pytest.mark.slow
def test_directions_of_faces_are_those_of_their_pairs() -> None:
    pairs = set_up(mesh_case()).layout.face_pairs
    directions = _face_directions(pairs, 2)
    for face in range(2):  # both look along z
        assert directions.tangent1[face] == pytest.approx([1.0, 0.0, 0.0])
        assert directions.tangent2[face] == pytest.approx([0.0, 1.0, 0.0])
        assert directions.middle[face] == pytest.approx(pairs.points[pairs.face == face].mean(axis=0))


@pytest.mark.slow
def test_a_map_that_is_not_along_the_tangents_has_no_directions() -> None:
    pairs = set_up(mesh_case()).layout.face_pairs
    in_a_row = np.column_stack([np.zeros(pairs.n_pairs), 1e-3 * np.arange(pairs.n_pairs)])  # as without positions
    assert not _face_directions(replace(pairs, face_position=in_a_row), 2).tangent1.any()
