"""The band of a contact stiffness that was not measured: when it is computed, and that its curves are those of studies
with another stiffness."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from own_cases import mesh_case
from sentences import printed_sentence
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError
from stickslip.core.progress import SilentProgress
from stickslip.core.shown_numbers import number
from stickslip.model.model import ReducedModel, build_model, load_joint, set_up
from stickslip.reporting.page import page
from stickslip.reporting.stiffness_words import stiffness_lines, stiffness_range, stiffness_words
from stickslip.reporting.view import View
from stickslip.results.measures import _stiffness_rows, summary, summary_table
from stickslip.results.response import ForcedResponse
from stickslip.results.stiffness_band import StiffnessBand
from stickslip.results.storage import load_results, save_results
from stickslip.results.tables import study_tables
from stickslip.study import stiffness_band as band_module
from stickslip.study.analyses import solve
from stickslip.study.record import study_record
from stickslip.study.stiffness_band import has_stiffness_band, with_stiffness_band
from sweep_cases import quick_case

BAND_ON = {"analysis.stiffness_band": True}


@pytest.fixture(scope="module")
def banded() -> tuple[Case, ReducedModel, ForcedResponse]:
    case = quick_case().replace(BAND_ON)
    model = build_model(case)
    return case, model, with_stiffness_band(case, model, solve(case, model, threads=1), SilentProgress(), 1)


@pytest.mark.slow
def test_the_factor_multiplies_both_stiffnesses_of_any_law() -> None:
    for changes in ({}, {"roughness.law": "persson"}):
        case = quick_case().replace(changes)
        layout = set_up(case).layout
        once, thrice = (load_joint(case.replace({"roughness.stiffness_factor": f}), layout) for f in (1, 3))
        np.testing.assert_allclose(thrice.normal_stiffness, 3.0 * once.normal_stiffness, rtol=1e-14)
        np.testing.assert_allclose(thrice.tangential_stiffness, 3.0 * once.tangential_stiffness, rtol=1e-14)


@pytest.mark.long
def test_its_curves_are_those_of_studies_with_a_stiffness_given(
    banded: tuple[Case, ReducedModel, ForcedResponse],
) -> None:
    case, model, response = banded
    band = response.stiffness_band
    assert band is not None
    assert band.complete.all()
    np.testing.assert_allclose(band.factor, [1 / 3, 3])
    output = next(iter(model.outputs.values()))
    normal, tangential = (
        model.joint.face_sum(each)[0] for each in (model.joint.normal_stiffness, model.joint.tangential_stiffness)
    )
    mapping = case.to_dict()
    del mapping["roughness"]
    for factor, top in zip(band.factor, band.curve_peaks(output), strict=True):
        mapping["contact_stiffness"] = {
            "normal_stiffness": float(factor * normal),
            "tangential_stiffness": float(factor * tangential),
        }
        given = Case.from_mapping(mapping)
        alone = solve(given, build_model(given), threads=1)
        assert top.amplitude == pytest.approx(alone.amplitude(output).max(), rel=2e-3)
    low, high = band.curve_peaks(output)
    own = float(response.frequency_hz[response.amplitude(output).argmax()])
    assert low.frequency_hz < own < high.frequency_hz


@pytest.mark.slow
def test_page_file_and_tables_have_it(banded: tuple[Case, ReducedModel, ForcedResponse], tmp_path: Path) -> None:
    case, model, response = banded
    record = study_record(case, model, (), response)
    save_results(tmp_path / "results.nc", response, record)
    saved = load_results(tmp_path / "results.nc")
    assert saved.response.stiffness_band == response.stiffness_band
    assert "contact stiffness × 1/3" in repr(saved.response.stiffness_band)
    view = View.of(response, record)
    lines = list(stiffness_lines(view))
    assert [line["name"] for line in lines] == ["contact stiffness × 1/3", "contact stiffness × 3"]
    words = stiffness_words(view)
    measures = view.summary
    assert measures.stiffness_peaks is not None
    tops = (measures.peak, *response.stiffness_band.curve_peaks(view.output))  # type: ignore[union-attr]
    assert measures.stiffness_peaks == (min(t.amplitude for t in tops), max(t.amplitude for t in tops))
    rows = {name: value for name, value, _ in summary_table(measures)}
    low, high = (f"{1e6 * value:.4g}" for value in measures.stiffness_peaks)
    beside = "... with 1/3 to 3 of the contact stiffness, not measured (at an end)"
    assert rows[f"{beside}: amplitude"] == f"{low} to {high}"
    assert list(rows).index(f"{beside}: amplitude") == 2  # after the amplitude and frequency of the peak
    low, high = (number(1e6 * value) for value in measures.stiffness_peaks)
    assert f"; {low} to {high} µm or more with 1/3 to 3 of the stiffness, not measured" in page(response, record)
    assert stiffness_range(View.of(replace(response, stiffness_band=None), record).summary) == ""
    assert "was not measured" in words
    text = page(response, record)
    assert words in text
    for line in lines:  # both curves are in the figure, and are gone without the band
        name = json.dumps(line["name"])[1:-1]
        assert name in text or line["name"] in text
        alone = page(replace(response, stiffness_band=None), record)
        assert name not in alone
        assert line["name"] not in alone
    (table,) = [each for each in study_tables(response, record) if each.name == "stiffness_band"]
    assert table.columns


@pytest.mark.long
def test_a_study_with_an_accuracy_has_a_band_with_the_harmonics_of_its_peak(tmp_path: Path) -> None:
    case = quick_case().replace(BAND_ON | {"solver.harmonics": None, "solver.accuracy": "2 %"})
    model = build_model(case)
    response = with_stiffness_band(case, model, solve(case, model, threads=1), SilentProgress(), 1)
    band = response.stiffness_band
    assert band is not None
    save_results(tmp_path / "results.nc", response)
    assert load_results(tmp_path / "results.nc").response.stiffness_band == band


@pytest.mark.slow
def test_only_a_stiffness_from_roughness_has_a_band() -> None:
    assert has_stiffness_band(Case())
    assert not has_stiffness_band(Case().replace({"analysis.stiffness_band": False}))
    given = '[contact_stiffness]\nnormal_stiffness = "1e8 N/m"\ntangential_stiffness = "8e7 N/m"\n'
    assert not has_stiffness_band(Case.from_text(given))
    assert has_stiffness_band(mesh_case(analysis__stiffness_band=True))
    measured = {"normal_stiffness": "2e7 N/m", "tangential_stiffness": "1.6e7 N/m"}
    own = mesh_case(analysis__stiffness_band=True).to_dict() | {"contact_stiffness": measured}
    del own["roughness"]
    assert not has_stiffness_band(Case.from_mapping(own))


@pytest.mark.slow
def test_a_curve_that_fails_is_a_warning(
    banded: tuple[Case, ReducedModel, ForcedResponse], monkeypatch: pytest.MonkeyPatch
) -> None:
    case, model, response = banded

    def fails(*_: object, **__: object) -> ForcedResponse:
        raise ConvergenceError("no first point.")

    monkeypatch.setattr(band_module, "forced_curve", fails)
    plain = replace(response, stiffness_band=None, warnings=())
    without = with_stiffness_band(case, model, plain, SilentProgress(), 1)
    assert without.stiffness_band is None
    assert len(without.warnings) == 2
    for sentence in without.warnings:
        printed_sentence(sentence)


@pytest.mark.slow
def test_a_range_that_a_curve_leaves_is_marked(banded: tuple[Case, ReducedModel, ForcedResponse]) -> None:
    """With three times the stiffness the amplitude rises to the end of the sweep: its peak is beyond."""
    case, model, response = banded
    band, output = response.stiffness_band, next(iter(model.outputs.values()))
    assert band is not None
    assert not all(each.bracketed for each in band.curve_peaks(output))
    inside = StiffnessBand(
        ("higher",), np.array([True]), np.zeros(response.n_points, dtype=int), response.frequency_hz,
        1.1 * response.displacement, np.array([3.0]),
    )  # fmt: skip
    for curve, is_marked in ((response, True), (replace(response, stiffness_band=inside), False)):
        measures = summary(curve, output)
        assert measures.stiffness_at_end == is_marked
        assert any(name.endswith("(at an end): amplitude") for name, _, _ in _stiffness_rows(measures)) == is_marked
        text = page(curve, study_record(case, model, (), curve))
        assert (" µm or more with 1/3 to 3" in text) == is_marked
