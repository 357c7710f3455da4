"""The torture set of benchmarks/: its problems have what their classes promise, and the search sees a missed peak."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import BENCHMARKS, benchmark_module

structures = benchmark_module("torture_structures")
problems = benchmark_module("torture_problems")
peaks = benchmark_module("torture_peaks")


def natural_omega(problem: object) -> np.ndarray:
    """Circular frequencies of the structure without its joint, rad/s."""
    structure = problem.structure  # type: ignore[attr-defined]
    return np.asarray(problems.modes_of(structure.mass, structure.stiffness)[0])


def test_a_problem_is_the_same_each_time_and_another_one_for_another_seed() -> None:
    first, again, other = (problems.make("damper", seed) for seed in (3, 3, 4))
    for name in ("preload", "force_cos", "window_hz", "tangential_stiffness"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
    assert first.window_hz != other.window_hz


@pytest.mark.slow
@pytest.mark.parametrize("kind", problems.KINDS)
def test_a_problem_has_consistent_sizes_and_a_resonance_in_its_range(kind: str) -> None:
    problem = problems.make(kind, 0)
    n_pairs = problem.preload.size
    assert problem.pairs().n_pairs == problem.pairs("kept").n_pairs == n_pairs <= 60
    assert problem.pairs().released
    assert not problem.pairs("kept").released
    assert problem.structure.operator.shape == (3 * n_pairs, problem.superelement().size)
    assert (problem.damping is None) == (problem.modal_damping_ratio is not None)
    low, high = sorted(problem.window_hz)
    assert problem.resonances
    assert all(low < each.frequency_hz < high and each.width_hz > 0.0 for each in problem.resonances)


def test_a_cantilever_has_the_first_frequency_of_the_textbook() -> None:
    """Clamped and free: ``1.8751^2 sqrt(E I / (rho A L^4))``."""
    body = structures.Cantilever(elements=8, length=0.2, width=0.03, height=0.01)
    omega, _ = problems.modes_of(*body.matrices)
    slenderness = np.sqrt(structures.YOUNGS_MODULUS / (12.0 * structures.DENSITY)) / body.length**2
    expected = 1.875104**2 * slenderness * np.array([body.height, body.width])
    assert omega[:2] == pytest.approx(expected, rel=1e-4)


def test_a_small_rotation_moves_a_point_by_the_cross_product() -> None:
    rotation, arm = np.array([0.4, -0.5, 0.6]), np.array([0.1, 0.2, 0.3])
    assert structures.cross_matrix(arm) @ rotation == pytest.approx(np.cross(rotation, arm))


def test_friction_alone_supports_the_damper() -> None:
    problem = problems.make("damper", 0)
    omega = natural_omega(problem)
    assert (omega < 1e-4 * omega.max()).sum() == 6
    # Pairs on both blades: each presses the wedge, and no pair is on the ground.
    wedge = problem.structure.operator[:, -6:]
    assert np.linalg.matrix_rank(wedge) == 6
    assert np.linalg.norm(wedge[2::3, :3], axis=1) == pytest.approx(np.ones(problem.preload.size))


def test_the_wedge_presses_outward_and_to_both_sides() -> None:
    problem = problems.make("damper", 0)
    normals = problem.structure.operator[2::3, -6:-3]
    half = len(normals) // 2
    assert (normals[:, 0] > 0.0).all()
    assert (normals[:half, 1] < 0.0).all()
    assert (normals[half:, 1] > 0.0).all()


@pytest.mark.slow
def test_other_classes_have_two_free_wedges_a_moving_base_and_wide_constants() -> None:
    row, shaken = problems.make("row", 100), problems.make("shaken", 100)
    omega = natural_omega(row)
    assert (omega < 1e-4 * omega.max()).sum() == 12
    # A constant acceleration of the base pulls the wedge with its mass.
    wedge = shaken.structure
    assert wedge.force[-5] == pytest.approx(wedge.mass[-5, -5])
    mixed = problems.make("mixed", 101)
    assert mixed.friction_coefficient.min() >= 0.01
    stiffness = np.concatenate([problems.make("mixed", seed).tangential_stiffness[:, 0] for seed in range(100, 103)])
    assert stiffness.max() > 100.0 * stiffness.min()
    assert problems.make("orders", 100).force_cos.shape[1] == 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_classes_have_what_their_names_promise(seed: int) -> None:
    assert problems.make("gaps", seed).preload.min() < 0.0
    assert problems.make("chain", seed).preload.min() > 0.0
    assert problems.make("multi", seed).force_cos.shape[1] in (2, 3)
    stiff = problems.make("stiff", seed)
    assert stiff.tangential_stiffness[:, 0].sum() > 500.0 * stiff.structure.stiffness_at_output
    aniso = problems.make("aniso", seed)
    assert (aniso.tangential_stiffness[:, 0] != aniso.tangential_stiffness[:, 1]).all()
    assert np.unique(aniso.friction_coefficient).size == aniso.preload.size
    close = natural_omega(problems.make("close", seed))
    assert close[1] < 1.05 * close[0]
    widths = [each.width_hz / each.frequency_hz for each in problems.make("light", seed).resonances]
    assert min(widths) < 2.0 * 3e-4
    assert len(problems.make("narrow", seed).resonances) >= 2


def test_a_width_is_twice_the_damping_ratio_times_the_frequency() -> None:
    problem = problems.make("narrow", 1)
    ratios = np.array([0.5 * each.width_hz / each.frequency_hz for each in problem.resonances])
    assert np.isclose(ratios, problem.modal_damping_ratio).sum() >= 2  # the stuck ones


def curve(frequency_hz: list[float], amplitude: list[float], *warnings: str) -> object:
    return peaks.Curve(np.array(frequency_hz), np.array(amplitude), warnings)


def test_a_maximum_that_the_tested_curve_lacks_is_a_missed_peak() -> None:
    fine = curve([99.0, 100.0, 101.0], [1.0, 5.0, 1.0])
    flat = curve([90.0, 110.0], [1.0, 1.0])
    (missed,) = peaks.higher_maxima(fine, flat, (99.0, 101.0), np.inf)
    assert (missed.frequency_hz, missed.amplitude, missed.tested_amplitude) == (100.0, 5.0, pytest.approx(1.0))


@pytest.mark.parametrize(
    "tested",
    [
        curve([90.0, 100.0, 110.0], [1.0, 4.96, 1.0]),  # the peak within 1 %
        curve([90.0, 110.0], [1.0, 1.0], "Near 88.10, 100.10 Hz the curve steps over a resonance."),
        curve([90.0, 110.0], [1.0, 501.0]),  # passes 251 m at 100 Hz
        curve([90.0, 98.0, 110.0, 120.0], [1.0, 1.0, 1.0, 501.0]),  # below 1 % of the highest amplitude
    ],
)
def test_other_maxima_are_not_missed(tested: object) -> None:
    fine = curve([99.0, 100.0, 101.0], [1.0, 5.0, 1.0])
    assert not peaks.higher_maxima(fine, tested, (99.0, 101.0), np.inf)


def test_a_warning_that_names_another_frequency_is_no_excuse() -> None:
    fine = curve([99.0, 100.0, 101.0], [1.0, 5.0, 1.0])
    warned = curve([90.0, 110.0], [1.0, 1.0], "Near 88.10 Hz there are corners; 100 points.")
    assert len(peaks.higher_maxima(fine, warned, (99.0, 101.0), np.inf)) == 1


def test_ends_of_a_curve_are_no_peaks() -> None:
    rising = curve([99.0, 100.0, 101.0], [1.0, 5.0, 9.0])
    assert not peaks.higher_maxima(rising, curve([90.0, 110.0], [1.0, 1.0]), (99.0, 101.0), np.inf)


def test_parts_of_the_range_that_overlap_become_one_with_the_finest_step() -> None:
    resonances = [problems.Resonance(100.0, 0.1), problems.Resonance(101.0, 0.05), problems.Resonance(150.0, 1.0)]
    first, second = peaks.parts_of(resonances, (155.0, 90.0))
    assert first[0] == pytest.approx((99.0, 101.5))
    assert first[1] == pytest.approx(0.05 / 4.0 / 2.5)
    assert second[0] == pytest.approx((140.0, 155.0))


@pytest.mark.long
def test_the_search_finds_the_peak_of_a_linear_resonance() -> None:
    """Under a preload at which nothing slips the peak has the closed form ``phi_o phi_F / (2 zeta w^2)``. The tested
    curve has it, or lost its points there."""
    problem = problems.make("narrow", 4)
    problem = replace(problem, preload=1e6 * problem.preload)
    structure = problem.structure
    springs = np.column_stack([problem.tangential_stiffness, problem.normal_stiffness])
    omega, modes = problems.modes_of(structure.mass, problems.with_springs(structure, springs))
    nearest = int(abs(omega / (2.0 * np.pi) - 680.0).argmin())
    shape, hertz = modes[:, nearest], omega[nearest] / (2.0 * np.pi)
    height = abs((shape @ structure.output) * (shape @ structure.force))
    height /= 2.0 * problem.modal_damping_ratio * omega[nearest] ** 2

    around = (hertz - 0.5, hertz + 0.5)
    fine = problem.solve(window_hz=around, continuation=ss.ContinuationSettings(largest_step=0.02))
    assert not fine.moving_pairs.any()
    complete = peaks.curve_of(problem, fine)
    ends = [0, -1]
    without = peaks.Curve(complete.frequency_hz[ends], complete.amplitude[ends], ())
    problem = replace(problem, window_hz=around)

    def search(tested: Any) -> Any:
        return peaks.search(problem, tested, "released", 3, lambda fraction, detail: None)

    passed = search(without)
    (missed,) = passed.missed
    assert missed.frequency_hz == pytest.approx(hertz, rel=1e-5)
    assert missed.amplitude == pytest.approx(height, rel=1e-3)
    assert missed.tested_amplitude < 0.5 * height
    assert (passed.curves, passed.incomplete) == (2, 0)
    assert not search(complete).missed


@pytest.mark.long
def test_the_table_resumes_from_its_folder(tmp_path: Path) -> None:
    command = [sys.executable, str(BENCHMARKS / "torture.py"), str(tmp_path), "--classes", "sdof", "--seeds", "4:6"]
    first = subprocess.run(command, capture_output=True, text=True, check=True)
    assert first.stderr.count("sdof") == 2
    assert "| sdof | 2 | 2 | 0 | 0 | 0 | 0 | 0 | 0 / 0 |" in first.stdout
    row = json.loads((tmp_path / "sdof-004.json").read_text(encoding="utf-8"))
    assert row["verdict"] == "complete"
    again = subprocess.run(command, capture_output=True, text=True, check=True)
    assert again.stderr == ""
    assert again.stdout == first.stdout
    other = subprocess.run([*command, "--harmonics", "5"], capture_output=True, text=True)
    assert other.returncode == 1
    assert str(tmp_path) in other.stderr


@pytest.mark.long
def test_the_time_limit_ends_a_problem_and_says_where(tmp_path: Path) -> None:
    command = [sys.executable, str(BENCHMARKS / "torture.py"), str(tmp_path), "--classes", "narrow", "--seeds", "2:3"]
    run = subprocess.run([*command, "--time-limit", "0.05"], capture_output=True, text=True, check=True)
    assert "| narrow | 1 | 0 | 0 | 0 | 0 | 1 | 0 |" in run.stdout
    assert "narrow 2: timed out, 0 points. the time limit was reached at" in run.stdout


@pytest.mark.parametrize("options", [["--classes", "damper,ligth"], ["--seeds", "8"], ["--seeds", "8:8"]])
def test_wrong_options_are_rejected_before_any_work(
    options: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["torture.py", str(tmp_path / "rows"), *options])
    with pytest.raises(SystemExit) as ending:
        benchmark_module("torture").main()
    assert ending.value.code == 2
    assert not (tmp_path / "rows").exists()


@pytest.mark.long
def test_another_process_follows_one_that_dies() -> None:
    script = """
import torture
worker, settings = torture.Worker(), torture.Settings(3, "released")
print(worker.answer(torture.Task("no class", 0, settings, 60.0)))
print(worker.answer(torture.Task("sdof", 4, settings, 60.0))["verdict"])
worker.close()
"""
    run = subprocess.run([sys.executable, "-c", script], cwd=BENCHMARKS, capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["crashed", "complete"]
    assert "ValueError" in run.stderr
