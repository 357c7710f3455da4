"""Ridges of peaks of a study: the performance curve of two blades and the peaks over a key, from file to page."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from own_cases import mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import RoughnessError, StudyFileError
from stickslip.results.storage import load_results
from stickslip.solve.ridges.ridge_coverage import RiseBelow
from stickslip.study import analyses
from stickslip.study import run as study
from stickslip.study.check import check
from stickslip.study.performance_curve import (
    SAMPLED_BY,
    _open_below,
    _sampled_forces,
    has_performance_curve,
    why_no_performance_curve,
)
from stickslip.study.ridge import ridge
from sweep_cases import quick_case

RIDGE = {
    "analysis.kind": "ridge",
    "analysis.over": "excitation.amplitude",
    "analysis.over_from": "45 N",
    "analysis.over_to": "60 N",
    "analysis.performance_curve": True,
}
# Of a curve that shows the error of a check.
MORE_HARMONICS = {"solver.harmonics": 9, "solver.largest_step": 0.02, "analysis.kind": "forced"} | dict.fromkeys(
    ("analysis.over", "analysis.over_from", "analysis.over_to")
)


@pytest.mark.long
def test_run_writes_both_ridges_and_their_sections(tmp_path: Path) -> None:
    case = quick_case().replace(RIDGE | {"analysis.performance_curve": True})
    outcome = study.run(case, tmp_path)
    response = load_results(tmp_path / "results.nc").response
    assert response == outcome.response
    peaks, curve = response.peak_ridge, response.performance_curve
    assert peaks is not None
    assert curve is not None
    assert peaks.converged, peaks.message
    # A damper of little mass bounces, and no ridge is followed there.
    printed_sentence(curve.message.partition(" from ")[0])
    # Rough faces become stiffer with the load, so the lowest peak is at the end; the valley of friction is enclosed.
    assert curve.optimum.edge == "the upper end of the followed range"
    assert not curve.has_stuck_optimum
    assert curve.other_minima[0].parameter == pytest.approx(3.68, rel=0.05)
    assert float(curve.parameter.max()) == pytest.approx(30.0)
    # The minimum with slip is checked with more harmonics.
    (check,) = curve.checked
    assert check.parameter == pytest.approx(curve.other_minima[0].parameter)
    assert check.harmonics > 1
    more = case.replace({"preload.centrifugal_force": f"{50.0 * check.parameter!r} N"} | MORE_HARMONICS)
    fine = ss.solve_case(more)
    largest = fine.response.amplitude(next(iter(fine.model.outputs.values()))).max()
    assert check.amplitude == pytest.approx(largest, rel=check.error + 1e-3)
    assert curve.estimated_error is not None
    # Both contain the peak of the response itself.
    row = load_results(tmp_path / "results.nc").study.outputs["blade tip A"]  # type: ignore[union-attr]
    highest = float(response.amplitude(row).max())
    ratio = 500.0 / 50.0
    assert peaks.at(50.0).amplitude[0] == pytest.approx(highest, rel=2e-3)
    assert curve.at(ratio).amplitude[0] == pytest.approx(highest, rel=2e-3)
    assert curve.parameter_name == "centrifugal force over excitation force"
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<h2>Performance curve of the damper</h2>" in page
    assert "<h2>Peaks over a key of the study</h2>" in page
    assert f"Performance curve: {curve.message}" in outcome.message
    printed_sentence("\n".join(curve.warnings), "15.9 N", numbers=False)
    assert f"Ridge of peaks: {peaks.message}" in outcome.message
    printed_sentence(peaks.message)


@pytest.mark.long
def test_a_ridge_over_the_friction_coefficient_agrees_with_a_whole_curve() -> None:
    case = quick_case()
    peaks = ridge(case, "friction.coefficient", (0.2, 0.4))
    assert peaks.converged, peaks.message
    fine = case.replace({"friction.coefficient": 0.27, "solver.largest_step": 0.02})
    solution = ss.solve_case(fine)
    highest = solution.response.amplitude(next(iter(solution.model.outputs.values()))).max()
    assert peaks.at(0.27).amplitude[0] == pytest.approx(highest, rel=1e-3)


@pytest.mark.long
def test_a_ridge_over_a_dimension_agrees_with_a_whole_curve() -> None:
    """Each value has its own mesh and reduction."""
    case = quick_case()
    peaks = ridge(case, "geometry.platform_gap", ("0.7 mm", "1.3 mm"))
    assert peaks.converged, peaks.message
    fine = case.replace({"geometry.platform_gap": "0.8 mm", "solver.largest_step": 0.02})
    solution = ss.solve_case(fine)
    highest = solution.response.amplitude(next(iter(solution.model.outputs.values()))).max()
    assert peaks.at(8e-4).amplitude[0] == pytest.approx(highest, rel=1e-3)


@pytest.mark.long
def test_a_study_with_an_accuracy_has_a_performance_curve_with_the_harmonics_of_its_peak(tmp_path: Path) -> None:
    changes = {"solver.harmonics": None, "solver.accuracy": "1 %", "analysis.performance_curve": True}
    response = study.run(quick_case().replace(changes), tmp_path).response
    assert response.point_harmonics is not None
    assert response.performance_curve is not None, response.warnings
    row = load_results(tmp_path / "results.nc").study.outputs["blade tip A"]  # type: ignore[union-attr]
    highest = float(response.amplitude(row).max())
    assert response.performance_curve.at(500.0 / 50.0).amplitude[0] == pytest.approx(highest, rel=2e-3)


@pytest.mark.slow
def test_a_check_says_where_friction_locks_the_damper_in_the_range_of_a_ridge() -> None:
    ridge_over = {"analysis.kind": "ridge", "analysis.over": "friction.coefficient", "analysis.over_from": 0.1}
    case = quick_case().replace(ridge_over | {"analysis.over_to": 5.0})
    (words,) = [each for _, each in dict(check(case))["Warnings"] if "locks the damper" in each]
    printed_sentence(words)
    without = dict(check(case.replace({"analysis.over_to": 0.5}))).get("Warnings", [])
    assert not any("locks the damper" in each for _, each in without)


@pytest.mark.slow
def test_a_check_announces_the_ridges() -> None:
    case = quick_case().replace(RIDGE | {"analysis.performance_curve": True})
    shown = dict(dict(check(case))["Would run"])
    assert shown["peaks over a key"] == "excitation.amplitude from 45 to 60 N"
    assert (
        shown["performance curve"]
        == "centrifugal force 0.2 to 30 times the excitation force, and lower until the peak rises"
    )
    without = dict(dict(check(quick_case()))["Would run"])
    assert "performance curve" not in without
    assert "peaks over a key" not in without
    moving = quick_case().replace({"analysis.performance_curve": True, "reduction.pairs": "moving"})
    assert dict(dict(check(moving))["Would run"])["performance curve"].startswith('none: reduction.pairs is "moving"')


@pytest.mark.slow
def test_a_check_says_how_the_performance_curve_of_a_solved_preload_is_computed() -> None:
    case = quick_case().replace({"analysis.performance_curve": True, "preload.method": "solved"})
    shown = dict(dict(check(case))["Would run"])
    assert shown["performance curve"].startswith(
        "centrifugal force 0.2 to 30 times the excitation force, a whole curve"
    )


@pytest.mark.long
def test_a_solved_preload_has_a_performance_curve_from_whole_curves(tmp_path: Path) -> None:
    case = quick_case().replace(
        {"analysis.performance_curve": True, "preload.method": "solved", "solver.frequency_start": "400 Hz"}
    )
    response = study.run(case, tmp_path).response
    curve = response.performance_curve
    assert curve is not None, response.warnings
    assert curve.n_ridges == 1
    printed_sentence(curve.message, numbers=False)
    assert curve.converged
    assert float(curve.parameter.max()) == pytest.approx(30.0)
    output = load_results(tmp_path / "results.nc").study.outputs["blade tip A"]  # type: ignore[union-attr]
    # The force of the study is one of the samples; another one has the peak of its own study.
    other = float(curve.parameter[curve.parameter > 12.0][0])
    changed = case.replace({"preload.centrifugal_force": f"{50.0 * other!r} N", "analysis.performance_curve": False})
    fine = ss.solve_case(changed.replace({"solver.largest_step": 0.02}))
    for ratio, each, tolerance in ((10.0, response, 2e-3), (other, fine.response, 1e-3)):  # the study has long steps
        assert np.isclose(curve.parameter, ratio).any()
        assert curve.at(ratio).amplitude[0] == pytest.approx(float(each.amplitude(output).max()), rel=tolerance)


def test_forces_of_samples_contain_that_of_the_study_and_both_ends() -> None:
    forces = _sampled_forces(500.0, 60.0, 9000.0)
    assert forces == sorted(forces, reverse=True)
    assert forces[0] == pytest.approx(9000.0)
    assert forces[-1] == 60.0
    assert np.isclose(forces, 500.0).any()
    assert max(high / low for high, low in itertools.pairwise(forces)) <= SAMPLED_BY
    assert _sampled_forces(500.0, 500.0, 500.0) == [500.0]


def test_only_two_blades_under_a_centrifugal_force_have_a_performance_curve() -> None:
    assert has_performance_curve(Case())
    given = Case().replace({"preload.values": [1.0] * 110})
    assert not has_performance_curve(given)
    assert why_no_performance_curve(given)
    moving = Case().replace({"reduction.pairs": "moving"})
    assert not has_performance_curve(moving)
    printed_sentence(why_no_performance_curve(moving))
    assert not why_no_performance_curve(given.replace({"analysis.performance_curve": False}))
    assert has_performance_curve(Case().replace({"preload.method": "solved"}))
    assert not has_performance_curve(mesh_case())


@pytest.mark.long
@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"analysis.over": "preload.mass"}, "preload.mass"),
        ({"analysis.over": "friction"}, "friction"),
        ({"analysis.over": "solver.harmonics"}, "solver.harmonics"),
        ({"analysis.over": "excitation.mode"}, "excitation.mode"),
        ({"analysis.over_from": "30 mm"}, "excitation.amplitude"),
        ({"analysis.over_from": "60 N"}, "excitation.amplitude"),
        ({"analysis.over": "friction.coefficient", "analysis.over_from": 0.2, "analysis.over_to": 20},
         "friction.coefficient"),
        ({"analysis.over": "roughness.fractal_roughness", "analysis.over_from": 1e-9, "analysis.over_to": "1e-8 m"},
         "roughness.fractal_roughness"),
        ({"analysis.over": "preload.centrifugal_force", "analysis.over_from": 0, "analysis.over_to": 10},
         "preload.centrifugal_force"),
        ({"analysis.over_from": "70 N"}, "excitation.amplitude"),
    ],
)  # fmt: skip
def test_a_key_or_a_range_that_cannot_be_used_is_rejected_before_anything_runs(
    changes: dict[str, object], key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_run(*_: object, **__: object) -> None:
        raise AssertionError("nothing runs before the range is checked")

    monkeypatch.setattr(analyses, "unreported_response", no_run)
    case = quick_case().replace(RIDGE | changes)
    with rejects(ss.InputError, key):
        check(case)
    with rejects(ss.InputError, key):
        ss.solve_case(case)


@pytest.mark.slow
def test_a_dimension_that_does_not_fit_is_rejected_before_anything_runs() -> None:
    over = {"analysis.over": "geometry.damper_length", "analysis.over_from": "20 mm"}
    with rejects(ss.InputError, "geometry.damper_length", "geometry.width"):
        check(quick_case().replace(RIDGE | over | {"analysis.over_to": "33 mm"}))


@pytest.mark.slow
def test_a_range_in_which_the_roughness_gives_no_contact_is_rejected() -> None:
    changes = {"analysis.over": "preload.centrifugal_force", "analysis.over_from": "1 nN", "analysis.over_to": "100 N"}
    with rejects(RoughnessError, "preload.centrifugal_force"):
        check(quick_case().replace(RIDGE | changes))


def test_keys_of_a_ridge_belong_to_its_kind() -> None:
    with rejects(StudyFileError, "analysis.over"):
        Case.from_text('[analysis]\nover = "friction.coefficient"\n')
    with rejects(StudyFileError, "analysis.mode"):
        Case.from_text('[analysis]\nkind = "ridge"\nmode = 2\n')


def test_a_curve_whose_peak_rises_little_at_its_lower_end_says_so() -> None:
    (sentence,) = _open_below(RiseBelow(1.33, 1.33, 4.34), 60.0, 15.25)
    printed_sentence(sentence)
    assert _open_below(RiseBelow(2.6, 2.6, 4.34), 60.0, 15.25) == ()
    assert _open_below(RiseBelow(1.33, 1.33, 4.34), 15.25, 15.25) == ()
