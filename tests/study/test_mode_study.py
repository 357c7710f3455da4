"""A study with a nonlinear mode, from file to page, on a coarse two-blade model."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from law_studies import REST, interface_text, write_masses, write_study
from sentences import printed_sentence, rejects
from stickslip.case.analysis import ModeAnalysis
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.model.kinds.two_blade import TwoBladeSetup
from stickslip.model.model import build_model, set_up
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.quasi_static_mode import QuasiStaticMode
from stickslip.results.storage import load_results
from stickslip.study import analyses, nonlinear_mode
from stickslip.study import run as study
from stickslip.study.check import check
from stickslip.study.export import export_tables
from stickslip.study.mode import has_estimate
from stickslip.study.solution import solve_case
from sweep_cases import quick_case

pytestmark = pytest.mark.slow

MODE = {
    "analysis.kind": "mode",
    "analysis.mode": 1,
    "analysis.smallest_amplitude": "0.01 um",
    "analysis.largest_amplitude": "10 um",
    "output.figure_formats": [],
}


@pytest.mark.long
def test_run_writes_the_mode_and_its_section(tmp_path: Path) -> None:
    outcome = study.run(quick_case().replace(MODE), tmp_path)
    saved = load_results(tmp_path / "results.nc")
    mode = saved.response.nonlinear_mode
    assert mode is not None
    assert mode == outcome.response.nonlinear_mode
    assert mode.converged, mode.message
    assert saved.study is not None
    output = saved.study.outputs[saved.study.response_output]
    # The amplitude of the output is that of the study file while the mode is linear.
    assert mode.harmonic_amplitude(output, 1)[0] == pytest.approx(1e-8, rel=1e-3)
    assert mode.frequency_hz[0] == pytest.approx(saved.response.linear.stuck_frequency_hz[0], rel=1e-6)
    assert mode.provenance == {"solve_seconds": mode.provenance["solve_seconds"]}
    assert f"Nonlinear mode 1: {mode.message}" in outcome.message
    printed_sentence(mode.message)
    estimate = saved.response.quasi_static_mode
    assert estimate is not None
    assert estimate == outcome.response.quasi_static_mode
    assert f"Quasi-static estimate of mode 1: {estimate.message}" in outcome.message
    printed_sentence(estimate.message)
    _agree_while_pairs_stick(mode, estimate, saved.response.linear.stuck_frequency_hz[0])
    assert "<h2>Nonlinear mode</h2>" in (tmp_path / "report.html").read_text(encoding="utf-8")


def _agree_while_pairs_stick(mode: NonlinearMode, estimate: QuasiStaticMode, linear_hz: float) -> None:
    sticks = mode.moving_pairs == 0
    assert sticks.sum() > 5
    assert estimate.frequency_hz[0] == pytest.approx(linear_hz, rel=1e-9)
    logarithm = np.log(mode.modal_amplitude[sticks])
    for name in ("frequency_hz", "damping_ratio"):
        beside = np.interp(logarithm, np.log(estimate.modal_amplitude), getattr(estimate, name))
        assert beside == pytest.approx(getattr(mode, name)[sticks], rel=1e-6)


def test_the_estimate_alone_needs_no_nonlinear_mode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_mode(*_: object, **__: object) -> None:
        raise AssertionError("no nonlinear mode may be computed")

    monkeypatch.setattr(nonlinear_mode, "unreported_mode", no_mode)
    case = quick_case().replace(MODE | {"analysis.mode_method": "quasi-static"})
    outcome = study.run(case, tmp_path)
    saved = load_results(tmp_path / "results.nc")
    assert saved.response.nonlinear_mode is None
    estimate = saved.response.quasi_static_mode
    assert estimate is not None
    assert estimate.converged
    assert QuasiStaticMode.load(tmp_path / "results.nc") == estimate
    assert estimate.friction_energy.min() == 0.0
    assert estimate.message in outcome.message
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<h2>Quasi-static estimate of a mode</h2>" in text
    assert "<h2>Nonlinear mode</h2>" not in text
    (table,) = (path for path in export_tables(tmp_path) if path.name == "quasi_static_mode.csv")
    assert table.read_text(encoding="utf-8").count("\n") == estimate.modal_amplitude.size + 1
    shown = dict(dict(check(case))["Would run"])
    assert shown["quasi-static estimate"] == "mode 1, 0.01 to 10 um at the first output"


def test_an_estimate_that_fails_leaves_the_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both are replaced, which saves their time."""

    def fails(*_: object, **__: object) -> None:
        raise ConvergenceError("there is no static equilibrium.")

    monkeypatch.setattr(nonlinear_mode, "unreported_estimate", fails)
    monkeypatch.setattr(nonlinear_mode, "unreported_mode", fails)
    response = solve_case(quick_case().replace(MODE)).response
    assert (response.nonlinear_mode, response.quasi_static_mode) == (None, None)
    printed_sentence("\n".join(response.warnings[-2:]))


def test_a_joint_of_many_pairs_has_no_estimate_beside_its_mode() -> None:
    analysis = quick_case().replace(MODE).analysis
    alone = quick_case().replace(MODE | {"analysis.mode_method": "quasi-static"}).analysis
    sliding = quick_case().replace(MODE | {"analysis.limit": "sliding"}).analysis
    for each, pairs, expected in (
        (analysis, 400, True),
        (analysis, 401, False),
        (alone, 401, True),
        (sliding, 5, False),
    ):
        assert isinstance(each, ModeAnalysis)
        assert has_estimate(each, pairs) == expected


@pytest.mark.long
def test_a_mode_from_the_sliding_limit() -> None:
    mode = solve_case(quick_case().replace(MODE | {"analysis.limit": "sliding"})).response.nonlinear_mode
    assert mode is not None
    assert mode.limit == "sliding"
    assert mode.modal_amplitude[0] > mode.modal_amplitude[-1]


def test_a_check_announces_the_mode() -> None:
    shown = dict(dict(check(quick_case().replace(MODE)))["Would run"])
    assert shown["nonlinear mode"] == "mode 1, 0.01 to 10 um at the first output"
    assert shown["quasi-static estimate"] == "beside the nonlinear mode, as a check"
    assert "nonlinear mode" not in dict(dict(check(quick_case()))["Would run"])


def test_a_mode_above_the_unknowns_is_rejected_before_the_matrices(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_matrices(*_: object, **__: object) -> None:
        raise AssertionError("nothing may be assembled")

    monkeypatch.setattr(TwoBladeSetup, "assemble", no_matrices)
    case = quick_case().replace(MODE | {"analysis.mode": 99_999})
    for run in (check, solve_case):
        with rejects(InputError, "analysis.mode"):
            run(case)


def test_the_largest_number_of_unknowns_is_that_of_the_reduction() -> None:
    case = quick_case().replace(MODE)
    setup, model = set_up(case), build_model(case)
    assert setup.most_unknowns(case.reduction.modes) == model.superelement.size


def test_a_mode_that_does_not_exist_is_rejected_before_the_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_curve(*_: object, **__: object) -> None:
        raise AssertionError("the curve must not be computed")

    monkeypatch.setattr(analyses, "unreported_response", no_curve)
    case = quick_case().replace(MODE | {"analysis.mode": 99_999})
    with rejects(InputError, "analysis.mode"):
        analyses.solve(case, build_model(case))


def test_amplitudes_that_a_law_forbids_are_rejected_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A softening spring of 1e4 N/m along the output does not resist beyond sqrt(1e4 / 3e9) m, 1.826 mm."""

    def no_curve(*_: object, **__: object) -> None:
        raise AssertionError("the curve must not be computed")

    monkeypatch.setattr(analyses, "unreported_response", no_curve)
    write_masses(tmp_path)
    joint = (
        interface_text("joint", "cubic")
        .replace('"1e9 N/m^3"', '"-1e9 N/m^3"')
        .replace('"9 kN/m", 0]', '"9 kN/m", "7e3 N/m"]')
    )
    mode = '[analysis]\nkind = "mode"\nmode = 3\nsmallest_amplitude = "1 um"\nlargest_amplitude = "{} mm"\n'
    case = ss.load_case(write_study(tmp_path, joint, rest=REST + mode.format(2)))
    for run in (check, solve_case):
        with rejects(InputError, "analysis.largest_amplitude"):
            run(case)
    allowed = ss.load_case(write_study(tmp_path, joint, rest=REST + mode.format(1.7)))
    assert "nonlinear mode" in dict(dict(check(allowed))["Would run"])
