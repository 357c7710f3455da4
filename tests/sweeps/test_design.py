"""Designs against the closed form of a friction damper; limits, load cases, differences, failures, resumed runs."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.optimize

import stickslip as ss
from design_cases import (
    JOINT_STIFFNESS,
    LIMIT,
    FakeSolver,
    PeaksOf,
    closed_form,
    jenkins_case,
    jenkins_peak,
    optimum,
)
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.study.solution import solve_case
from stickslip.sweeps import design_cases, design_task
from stickslip.sweeps.design import Design
from sweep_cases import quick_case

RANGE = {LIMIT: ("2 N", "15 N")}
FEW: dict[str, Any] = {"samples": 3, "starts": 2, "workers": 1}


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return jenkins_case(tmp_path_factory.mktemp("jenkins"))


@pytest.fixture(scope="module")
def damper(case: Case, tmp_path_factory: pytest.TempPathFactory) -> tuple[Design, Path]:
    folder = tmp_path_factory.mktemp("design")
    return ss.design(case, RANGE, out=folder, **FEW), folder


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> Callable[..., FakeSolver]:
    """Replaces the solution by the peaks of a function; by default of the closed form."""

    def replaced(peaks_of: PeaksOf = closed_form, **options: Any) -> FakeSolver:
        fake = FakeSolver(peaks_of, **options)
        monkeypatch.setattr(design_cases, "solve_design", fake)
        return fake

    return replaced


def values_of(result: Design) -> list[tuple[float, float]]:
    return [(each.values[0], each.objective) for each in result.evaluations]


@pytest.mark.long
def test_the_optimum_is_that_of_the_closed_form(damper: tuple[Design, Path]) -> None:
    result = damper[0]
    best = result.optimum
    assert best is not None
    assert best.objective == pytest.approx(optimum()[1], rel=1e-3)
    assert best.values[0] == pytest.approx(optimum()[0], rel=0.02)  # flat: 2 % of the limit change the peak by 0.04 %
    for limit, peak in values_of(result):
        assert peak == pytest.approx(jenkins_peak(limit), rel=3e-3)  # those of samples are interpolated
    assert [each.same_place for each in result.starts] == [True, True]
    assert result.sharpness[0].shape == "smooth"
    printed_sentence(result.remarks[0])
    printed_sentence(result.remarks[1], "2 of 2")
    assert {each.gradient for each in result.evaluations if each.stage.startswith("start")} == {"exact"}


@pytest.mark.slow
def test_files_contain_the_designs_and_the_optimum(damper: tuple[Design, Path]) -> None:
    result, folder = damper
    assert result.files == tuple(folder / name for name in ("design.csv", "optimum.toml", "design.html"))
    with (folder / "design.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(float(row[LIMIT]), float(row["peak_amplitude_m"])) for row in rows] == values_of(result)
    assert result.case is not None
    stored = result.case.sections["interfaces"]["joint"].constants.values["friction_limit"]
    assert result.optimum is not None
    assert stored == result.optimum.values[0]
    assert "<h2>How sharp the optimum is</h2>" in (folder / "design.html").read_text(encoding="utf-8")
    solved = [case for each in result.evaluations for case in each.cases]
    assert all((folder / each.file).exists() for each in solved)


@pytest.mark.slow
def test_a_resumed_design_solves_nothing_again(case: Case, damper: tuple[Design, Path]) -> None:
    again = ss.design(case, RANGE, out=damper[1], **FEW)
    assert (again.solved, again.reused) == (0, len(damper[0].evaluations))
    assert values_of(again) == values_of(damper[0])


@pytest.mark.slow
def test_the_sharpness_is_that_of_the_closed_form(case: Case, solver: Callable[..., FakeSolver]) -> None:
    """Where the peak is 5 % higher; the line between designs whose distance doubles is less exact than they are."""
    solver()
    along = ss.design(case, RANGE, **FEW).sharpness[0]
    best, lowest = optimum()
    for end, bounds in ((along.lower, (1.8, best)), (along.upper, (best, 8.0))):
        expected = scipy.optimize.brentq(lambda limit: jenkins_peak(limit) - 1.05 * lowest, *bounds)
        assert end == pytest.approx(expected, rel=0.03)


@pytest.mark.long
def test_a_killed_design_loses_no_completed_case(case: Case, tmp_path: Path, solver: Callable[..., FakeSolver]) -> None:
    options: dict[str, Any] = {**FEW, "worst_of": {"forces.push.amplitude": ["1 N", "2 N"]}}
    complete = solver()
    expected = ss.design(case, RANGE, **options)
    first = solver(killed_at=9)
    with pytest.raises(KeyboardInterrupt):
        ss.design(case, RANGE, out=tmp_path, **options)
    rest = solver()
    result = ss.design(case, RANGE, out=tmp_path, **options)
    assert result.reused == 9
    assert [*first.solved, *rest.solved] == complete.solved
    assert values_of(result) == values_of(expected)
    assert result.load_cases == ("forces.push.amplitude = 1 N", "forces.push.amplitude = 2 N")
    assert any(not each.failure for each in result.evaluations)
    for each in [one for one in result.evaluations if not one.failure]:  # the larger force is the worse load case
        assert each.objective == each.cases[1].peaks[0].amplitude_m > each.cases[0].peaks[0].amplitude_m


@pytest.mark.slow
def test_a_limit_of_the_frequency_is_satisfied_and_active(case: Case, solver: Callable[..., FakeSolver]) -> None:
    solver()
    result = ss.design(case, RANGE, subject_to=["peak_frequency < 18.5 Hz"], **FEW)
    best = result.optimum
    assert best is not None
    assert best.required[0] < 18.5
    expected = scipy.optimize.brentq(lambda limit: closed_form(limit)[0][1] - 18.5, 1.7, 3.0)
    assert best.values[0] == pytest.approx(expected, rel=5e-3)
    assert any(each.excess > 0.0 for each in result.evaluations)
    printed_sentence(result.remarks[0])


@pytest.mark.slow
def test_the_optimum_between_two_peaks_is_a_switch(case: Case, solver: Callable[..., FakeSolver]) -> None:
    """Peaks of 1e-4 L and 8e-4 / L: equally high for L = sqrt(8)."""
    solver(lambda limit: [(1e-4 * limit, 17.0), (8e-4 / limit, 20.0)])
    result = ss.design(case, RANGE, **FEW)
    best = result.optimum
    assert best is not None
    assert best.values[0] == pytest.approx(math.sqrt(8.0), rel=1e-3)
    assert result.sharpness[0].shape == "corner"
    assert all(each.same_place for each in result.starts)
    printed_sentence(result.remarks[0])


@pytest.mark.long
def test_without_gradients_differences_find_the_optimum(case: Case, solver: Callable[..., FakeSolver]) -> None:
    solver(has_gradients=False)
    result = ss.design(case, RANGE, **FEW)
    assert result.optimum is not None
    assert result.optimum.objective == pytest.approx(optimum()[1], rel=1e-4)
    assert any(each.gradient == f"differences by {LIMIT}" for each in result.evaluations)
    printed_sentence(result.remarks[2], "central differences")


@pytest.mark.slow
def test_an_optimum_on_a_bound_is_reported(case: Case, solver: Callable[..., FakeSolver]) -> None:
    solver()
    result = ss.design(case, {LIMIT: ("2 N", "2.5 N")}, **FEW)
    assert result.optimum is not None
    assert result.optimum.values == (2.5,)
    assert (result.sharpness[0].shape, result.sharpness[0].upper) == ("bound", None)
    printed_sentence(result.remarks[0])


@pytest.mark.slow
def test_failed_designs_and_peaks_beyond_the_range_do_not_count(case: Case, solver: Callable[..., FakeSolver]) -> None:
    """Lower peaks below 3.3 N, without a result; frequencies from 22 Hz are at the end of the range."""
    solver(lambda limit: closed_form(limit) if limit > 3.3 else [])
    result = ss.design(case, RANGE, **FEW)
    failures = {each.failure for each in result.evaluations if each.failure}
    assert len(failures) == 2
    assert result.optimum is not None
    assert 3.3 < result.optimum.values[0] < 3.5
    printed_sentence(result.remarks[0])
    printed_sentence(result.remarks[-1])


@pytest.mark.long
def test_limits_that_no_design_satisfies_are_a_result(
    case: Case, tmp_path: Path, solver: Callable[..., FakeSolver]
) -> None:
    solver()
    result = ss.design(case, RANGE, subject_to=["peak < 0.3 mm"], out=tmp_path, **FEW)
    assert (result.converged, result.optimum, result.case) == (False, None, None)
    nearest = min(result.evaluations, key=lambda each: each.excess)
    assert nearest.excess == pytest.approx(optimum()[1] / 3e-4 - 1.0, rel=1e-3)
    printed_sentence(result.remarks[0], numbers=False)  # their count depends on the order in which they end
    assert not (tmp_path / "optimum.toml").exists()
    assert "No design satisfies the limits" in (tmp_path / "design.html").read_text(encoding="utf-8")


def test_a_design_without_any_result_writes_its_page_and_table(
    case: Case, tmp_path: Path, solver: Callable[..., FakeSolver]
) -> None:
    solver(lambda limit: [])
    result = ss.design(case, RANGE, out=tmp_path, **FEW)
    assert (result.converged, result.has_results, result.case, result.starts) == (False, False, None, ())
    printed_sentence(result.remarks[0])
    assert [file.name for file in result.files] == ["design.csv", "design.html"]
    assert (tmp_path / "design.csv").read_text(encoding="utf-8").count("The curve ended.") == result.solved == 3
    assert "No design has a result" in (tmp_path / "design.html").read_text(encoding="utf-8")
    assert ss.design(case, RANGE, **FEW).remarks == result.remarks


@pytest.mark.long
def test_a_task_has_stress_and_gradients_of_its_peaks() -> None:
    """Beside the same case solved as a study."""
    case = quick_case().replace({"solver.frequency_start": "450 Hz", "solver.frequency_stop": "470 Hz"})
    names = ("preload.centrifugal_force", "friction.coefficient")
    outcome = design_task.solve_design(design_task.DesignTask(case, "key", "name", names, True, 1, False))
    assert outcome.converged, outcome.message
    solution = solve_case(case.replace({"analysis.gradients": True}), threads=1)
    peak, gradients = outcome.details["peaks"][0], solution.response.gradients
    assert gradients is not None
    for name in names:
        place = gradients.names.index(name)
        assert peak["by_amplitude"][name] == pytest.approx(gradients.by_amplitude[place], rel=1e-6)
    summary = solution.record.stress
    assert summary is not None
    stresses = outcome.details["stresses"]
    assert stresses["stress"] == pytest.approx(summary.extreme("largest von Mises stress").value, rel=0.01)
    assert stresses["alternating_stress"] == pytest.approx(summary.extreme("alternating stress").value, rel=0.01)


def test_wrong_input_is_rejected_before_a_folder_is_made(case: Case, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for over, options, expected in (
        ({}, {}, ("over",)),
        ({"interfaces.joint.nothing": (1, 2)}, {}, ("interfaces.joint.nothing",)),
        ({"solver.tolerance": (1e-9, 1e-8)}, {}, ("solver.tolerance",)),
        ({"solver.samples": (64, 128)}, {}, ("solver.samples",)),
        ({LIMIT: (5.0, 2.0)}, {}, (LIMIT,)),
        ({LIMIT: "5 N"}, {}, (LIMIT,)),
        ({LIMIT: ("1 mm", "2 mm")}, {}, (LIMIT,)),
        ({"static_loads.push.amplitude": ("1 N", "2 N")}, {}, ("static_loads.push.amplitude",)),
        (RANGE, {"minimise": "mass"}, ("minimise",)),
        (RANGE, {"subject_to": ["stress < 300 MPa"]}, ("structure.kind",)),
        (RANGE, {"subject_to": ["peak < 300 MPa"]}, ("subject_to",)),
        (RANGE, {"subject_to": ["temperature < 300 K"]}, ("subject_to",)),
        (RANGE, {"subject_to": ["peak is small"]}, ("subject_to",)),
        (RANGE, {"worst_of": {LIMIT: ["3 N", "4 N"]}}, (LIMIT,)),
        (RANGE, {"samples": 100_000}, ("samples",)),
        (RANGE, {"starts": 0}, ("starts",)),
    ):
        with rejects(InputError, *expected):
            ss.design(case, over, out=out, **options)
    assert not out.exists()


@pytest.mark.slow
def test_a_box_with_an_invalid_geometry_is_rejected() -> None:
    """The damper's flank reaches the base at one corner of the box; inside, most designs are valid."""
    over = {"geometry.damper_flank_height": ("2 mm", "34 mm"), "geometry.underside_height_at_shank": ("30 mm", "40 mm")}
    with rejects(InputError, *over):
        ss.design(Case(), over)


def test_ranges_of_wide_keys_are_logarithmic(case: Case) -> None:
    from stickslip.sweeps.design_space import DesignSpace

    space = DesignSpace.of(case, {LIMIT: "2 N:20 N", JOINT_STIFFNESS: (1e4, 5e4)}, {})
    assert space.values(np.array([0.5, 0.5])) == pytest.approx((math.sqrt(40.0), 3e4))
    assert space.start is None  # the limit of the study is 1.5 N
