"""Bands of a linear case against closed forms; resumed, with failing samples, listed inputs and wrong inputs."""

from __future__ import annotations

import csv
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

import stickslip as ss
from band_cases import DAMPING, FORCE, linear_study, peak_m
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError, InputError, StudyFileError
from stickslip.core.progress import Progress
from stickslip.model.model import ReducedModel
from stickslip.results.response import ForcedResponse
from stickslip.study.analyses import solve
from stickslip.sweeps import schedule, work
from stickslip.sweeps.band import Band

pytestmark = pytest.mark.slow

SCATTER = {FORCE: "1 mN .. 3 mN", DAMPING: "1 % .. 3 %"}
LIMIT = "peak_amplitude < 3 um"
SAMPLES = 20


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return linear_study(tmp_path_factory.mktemp("study"))


@pytest.fixture(scope="module")
def linear(study: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Band, Path]:
    folder = tmp_path_factory.mktemp("band")
    return ss.band(study, SCATTER, out=folder, samples=SAMPLES, limits=[LIMIT], workers=1), folder


@pytest.mark.long
def test_each_sample_has_the_peak_of_its_inputs(linear: tuple[Band, Path]) -> None:
    table = linear[0].table
    expected = [peak_m(*row.values) for row in table.rows]  # type: ignore[arg-type]
    assert table.column("peak_amplitude_m") == pytest.approx(expected, rel=1e-5)
    assert len({row.values for row in table.rows}) == SAMPLES


def test_percentiles_are_those_of_the_closed_form(linear: tuple[Band, Path]) -> None:
    """The distribution of F / zeta on a fine grid of both; sample k of n is between the quantiles (k - 1)/n and k/n
    but for what two inputs mix, so 20 samples determine a percentile to 5 % of probability."""
    force, damping = np.meshgrid(*(low * (1.0 + 2.0 * (np.arange(400) + 0.5) / 400) for low in (1e-3, 1e-2)))
    every = np.sort(np.vectorize(peak_m)(force, damping).ravel())
    result = linear[0].percentiles["peak_amplitude"]
    for value, probability in zip(result.values, (0.05, 0.5, 0.95), strict=True):
        assert np.searchsorted(every, value) / every.size == pytest.approx(probability, abs=1.0 / SAMPLES)
    exceeded = linear[0].exceedances[0]
    assert exceeded.probability == pytest.approx((every > 3e-6).mean(), abs=1.0 / SAMPLES)
    assert exceeded.interval[0] < (every > 3e-6).mean() < exceeded.interval[1]


def test_sobol_indices_of_a_product_are_those_of_the_closed_form(linear: tuple[Band, Path]) -> None:
    """y = F / zeta with uniform F on (1, 3) and zeta on (1, 3): E(1/zeta) = ln 3 / 2, E(1/zeta^2) = 1/3. The next term
    of the peak, sqrt(1 - zeta^2), is below 5e-4."""
    (mx, vx), (mz, vz) = (2.0, 4.0 / 12.0), (math.log(3.0) / 2.0, 1.0 / 3.0 - (math.log(3.0) / 2.0) ** 2)
    whole = (vx + mx**2) * (vz + mz**2) - (mx * mz) ** 2
    result = linear[0].influences["peak_amplitude"]
    assert result.names == (FORCE, DAMPING)
    assert result.first == pytest.approx((mz**2 * vx / whole, mx**2 * vz / whole), abs=0.01)
    assert result.total == pytest.approx((vx * (vz + mz**2) / whole, vz * (vx + mx**2) / whole), abs=0.01)
    assert result.unexplained < 2e-3
    assert linear[0].influences["peak_frequency"].total[1] > 0.99  # f sqrt(1 - 2 zeta^2): of the damping alone


@pytest.mark.long
def test_residual_tractions_are_varied_with_central_inputs(study: Path, tmp_path: Path) -> None:
    """A joint that never slips, with tractions far below its limit: each of them has the same linear peak."""
    case = ss.load_case(study).replace({"analysis.traction_band": True, FORCE: "1.5 mN", DAMPING: "3 %"})
    band = ss.band(case, SCATTER, out=tmp_path, samples=8, workers=1)
    assert band.tractions is not None
    middle = peak_m(2e-3, 0.02)
    assert (band.tractions.peak, band.tractions.low, band.tractions.high) == pytest.approx((middle,) * 3, rel=1e-4)
    assert len(band.tractions.curves) == 1
    assert len(band.table.rows) == 8
    assert all("lowest_traction_peak_amplitude_m" not in row.measures for row in band.table.rows)
    (central,) = (tmp_path / "cases").glob("central_*/results.nc")
    saved = ss.ForcedResponse.load(central).traction_band
    assert saved is not None
    again = ss.band(case, SCATTER, out=tmp_path, samples=8, workers=1)
    assert again.reused == 9
    assert again.tractions is not None
    assert again.tractions.high == band.tractions.high


@pytest.mark.long
def test_the_band_of_the_curves_is_proportional_to_a_force_alone(study: Path) -> None:
    """A quantile of a force F_q gives everywhere F_q / F of any one curve."""
    case = ss.load_case(study).replace({DAMPING: "2 %"})
    band = ss.band(case, {FORCE: "2 mN +- 0.5 mN"}, samples=8, workers=1)
    force = np.array(band.table.column(FORCE))
    curves = band.curve_band
    assert curves is not None
    expected = np.percentile(force, (5.0, 50.0, 95.0), method="hazen") / force[0]
    first = band.curves[0]
    assert first is not None
    height = np.interp(curves.frequency_hz, first.frequency_hz, first.amplitude_m)
    np.testing.assert_allclose(curves.amplitude_m, np.outer(expected, height), rtol=5e-3)  # of linear interpolation
    peaks = band.percentiles["peak_amplitude"].values
    assert peaks == pytest.approx([peak_m(each * force[0], 0.02) for each in expected], rel=1e-5)
    assert band.influences["peak_amplitude"].reason == ""
    assert band.influences["peak_amplitude"].first == pytest.approx((1.0,), abs=1e-6)
    assert (band.files, band.case_files) == ((), (None,) * 8)


def test_files_contain_samples_and_statistics(linear: tuple[Band, Path]) -> None:
    band, folder = linear
    assert band.files == tuple(folder / name for name in ("band.csv", "band.nc", "band.html"))
    with (folder / "band.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["peak_amplitude_m"]) for row in rows] == band.table.column("peak_amplitude_m")
    with xarray.load_dataset(folder / "band.nc", engine="h5netcdf") as data:
        assert data["peak_amplitude_percentile"].values.tolist() == list(band.percentiles["peak_amplitude"].values)
        assert data["peak_amplitude_sobol_total"].sel(input=DAMPING) == band.influences["peak_amplitude"].total[1]
        assert data["exceedance_probability"].values.tolist() == [band.exceedances[0].probability]
        assert data["band_amplitude"].sel(percentile=95.0).max() > 4e-6
    assert all(file is not None and file.exists() for file in band.case_files)


@pytest.mark.long
def test_a_band_resumes_and_more_samples_contain_those_of_fewer(
    study: Path, linear: tuple[Band, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    solved = []

    def counted(*arguments: object, **options: object) -> object:
        solved.append(arguments)
        return solve(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(work, "solve", counted)
    again = ss.band(study, SCATTER, out=linear[1], samples=SAMPLES, limits=[LIMIT], workers=1)
    assert (again.reused, solved) == (SAMPLES, [])
    assert again.table == linear[0].table
    assert again.influences == linear[0].influences
    more = ss.band(study, SCATTER, out=linear[1], samples=SAMPLES + 2, workers=1)
    assert (more.reused, len(solved)) == (SAMPLES, 2)
    assert more.table.rows[:SAMPLES] == linear[0].table.rows
    printed_sentence(" ".join(more.remarks), f"{SAMPLES + 2} samples")


@pytest.mark.long
def test_samples_have_checks_only_for_limits_of_slow_sweeps(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stability decides where a slow sweep jumps; no other measure requires it."""
    checks = []

    def seen(*arguments: object, **options: object) -> object:
        checks.append(options["checks"])
        return solve(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(work, "solve", seen)
    plain = ss.band(study, SCATTER, samples=8, limits=[LIMIT], workers=1)
    checked = ss.band(study, SCATTER, samples=8, limits=["upward_peak_amplitude < 1 mm"], workers=1)
    assert checks == [False] * 8 + [True] * 8
    assert plain.table.column("peak_amplitude_m") == checked.table.column("peak_amplitude_m")


@pytest.mark.long
def test_samples_with_and_without_checks_resume_apart(study: Path, tmp_path: Path) -> None:
    """Each kind uses its own results again, without a notice, whatever the other one did in between."""
    plain, slow = [LIMIT], ["upward_peak_amplitude < 1 mm"]
    reused = []
    for limits in (plain, slow, plain, slow):
        band = ss.band(study, SCATTER, out=tmp_path, samples=8, limits=limits, workers=1)
        reused.append(band.reused)
        assert band.notices == ()
    assert reused == [0, 0, 8, 8]
    assert len([*tmp_path.glob("cases/checked_*")]) == 8


@pytest.mark.long
def test_any_executor_gives_the_same_band(study: Path, linear: tuple[Band, Path]) -> None:
    with ThreadPoolExecutor(1) as executor:
        other = ss.band(study, SCATTER, executor, samples=8)
    assert [row.measures for row in other.table.rows] == [row.measures for row in linear[0].table.rows[:8]]


@pytest.mark.long
def test_failed_and_incomplete_samples_are_reported_and_not_dropped(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def partly(
        case: Case, model: ReducedModel, progress: Progress, threads: int, checks: bool, harmonics: int | None
    ) -> ForcedResponse:
        force = case.sections["forces"]["push"].amplitude
        if force > 2.7e-3:
            raise ConvergenceError("No first point at 19 Hz.")
        response = solve(case, model, progress, threads, checks, harmonics)
        return replace(response, converged=force < 2.4e-3, message="It ended.")

    monkeypatch.setattr(work, "solve", partly)
    band = ss.band(study, SCATTER, out=tmp_path, samples=8, limits=[LIMIT], workers=1)
    force = np.array(band.table.column(FORCE))
    failed = int((force >= 2.4e-3).sum())
    assert 2 <= failed < 8
    assert len(band.table.failed) == band.exceedances[0].undecided == failed
    assert band.percentiles["peak_amplitude"].count == 8 - failed
    assert band.curve_band is not None
    assert band.curve_band.count.max() == 8 - failed
    printed_sentence(" ".join(band.remarks), f"{failed} of 8 samples failed")
    assert "No first point at 19 Hz." in (tmp_path / "band.html").read_text(encoding="utf-8")


def test_equal_samples_of_listed_inputs_are_solved_once(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    solved = []

    def counted(*arguments: object) -> object:
        solved.append(arguments)
        return work.solve_task(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(schedule, "solve_task", counted)
    band = ss.band(study, {DAMPING: "1 % | 2 %"}, samples=16, workers=1)
    assert len(solved) == 2
    values = band.table.column(DAMPING)
    assert sorted(values) == [0.01] * 8 + [0.02] * 8
    assert band.influences["peak_amplitude"].first == pytest.approx((1.0,), abs=1e-6)
    assert [row.measures["peak_amplitude_m"] for row in band.table.rows] == pytest.approx(
        [peak_m(2e-3, value) for value in values], rel=1e-5
    )


def test_whole_numbers_can_be_listed(study: Path, tmp_path: Path) -> None:
    band = ss.band(study, {"solver.samples": "64 | 128"}, samples=8, workers=1)
    assert sorted(band.table.column("solver.samples")) == [64] * 4 + [128] * 4
    linear_study(tmp_path)
    file = tmp_path / "study.toml"
    text = file.read_text(encoding="utf-8").replace("samples = 16", 'samples = "64 | 128"')
    file.write_text(text, encoding="utf-8")
    assert sorted(ss.band(file, samples=8, workers=1).table.column("solver.samples")) == [64] * 4 + [128] * 4


@pytest.mark.long
def test_distributions_of_the_file_apply_and_are_replaced(study: Path, tmp_path: Path) -> None:
    linear_study(tmp_path)
    text = (tmp_path / "study.toml").read_text(encoding="utf-8").replace('"2 mN"', '"2 mN +- 10 %"')
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    band = ss.band(tmp_path / "study.toml", samples=8, workers=1)
    force = np.array(band.table.column(FORCE))
    assert 1.4e-3 < force.min() < force.max() < 2.6e-3
    other = ss.band(tmp_path / "study.toml", {FORCE: "5 mN | 6 mN"}, samples=8, workers=1)
    assert set(other.table.column(FORCE)) == {5e-3, 6e-3}


def test_wrong_input_is_rejected_before_a_folder_is_made(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    case = ss.load_case(study)
    for scatter, options, expected in (
        ({}, {}, (InputError,)),
        ({DAMPING: "1 % +- 1 %"}, {}, (InputError, DAMPING)),
        (SCATTER, {"limits": ["peak < 1 mm"]}, (InputError, "limits")),
        (SCATTER, {"samples": 4}, (InputError, "samples")),
        (SCATTER, {"samples": 100_000}, (InputError, "samples")),
        ({"solver.first_step": "0.01 .. 0.2"}, {"samples": 8}, (StudyFileError,)),
    ):
        with rejects(*expected):
            ss.band(case, scatter, out=out, **options)
    assert not out.exists()
