"""A study with a nonlinear mode, from file to page, on a coarse two-blade model."""

from __future__ import annotations

from pathlib import Path

import pytest

import stickslip as ss
from law_studies import REST, interface_text, write_masses, write_study
from sentences import printed_sentence, rejects
from stickslip.core.errors import InputError
from stickslip.model.kinds.two_blade import TwoBladeSetup
from stickslip.model.model import build_model, set_up
from stickslip.results.storage import load_results
from stickslip.study import analyses
from stickslip.study import run as study
from stickslip.study.check import check
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
    assert "<h2>Nonlinear mode</h2>" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.long
def test_a_mode_from_the_sliding_limit() -> None:
    mode = solve_case(quick_case().replace(MODE | {"analysis.limit": "sliding"})).response.nonlinear_mode
    assert mode is not None
    assert mode.limit == "sliding"
    assert mode.modal_amplitude[0] > mode.modal_amplitude[-1]


def test_a_check_announces_the_mode() -> None:
    shown = dict(dict(check(quick_case().replace(MODE)))["Would run"])
    assert shown["nonlinear mode"] == "mode 1, 0.01 to 10 um at the first output"
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
