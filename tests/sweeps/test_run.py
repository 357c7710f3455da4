"""A real sweep of a coarse model: tables, files, resume, failing cases; in this process and in two others."""

from __future__ import annotations

import csv
import math
import shutil
from collections import Counter
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.case.case import Case, TwoBladeCase
from stickslip.core.errors import ConvergenceError, InputError, RoughnessError, StudyFileError
from stickslip.core.progress import Progress
from stickslip.model.model import ReducedModel
from stickslip.results.measures import summary
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results
from stickslip.study import run as study
from stickslip.study.analyses import solve
from stickslip.sweeps import run as sweep_run
from stickslip.sweeps import schedule, work
from sweep_cases import quick_case

VARY = {"preload.centrifugal_force": "450:600:2", "excitation.mode": ["single", "same"]}


class Heard:
    """Progress that remembers."""

    def __init__(self) -> None:
        self.news: list[tuple[str, float, str]] = []

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        self.news.append((stage, fraction, detail))


Swept = tuple[Path, sweep_run.Sweep, Heard, Counter[str]]


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Swept:
    """A sweep of four cases in this process, its progress, and how often each shared step ran."""
    calls: Counter[str] = Counter()

    def counted(module: object, name: str) -> None:
        original = getattr(module, name)

        def call(*arguments: object, **options: object) -> object:
            calls[name] += 1
            return original(*arguments, **options)

        patch.setattr(module, name, call)

    folder, received = tmp_path_factory.mktemp("sweep"), Heard()
    with pytest.MonkeyPatch.context() as patch:
        for module, name in ((sweep_run, "set_up"), (work, "reduce_structure"), (work, "solve")):
            counted(module, name)
        result = ss.sweep(quick_case(), VARY, out=folder, progress=received, workers=1)
    return folder, result, received, calls


@pytest.mark.long
def test_one_row_and_one_file_for_each_case(swept: Swept) -> None:
    folder, result, _, _ = swept
    table = result.table
    assert table.column("preload.centrifugal_force") == [450.0, 450.0, 600.0, 600.0]
    assert table.column("excitation.mode") == ["single", "same", "single", "same"]
    assert table.failed == ()
    for row, file, curve in zip(table.rows, result.case_files, result.curves, strict=True):
        assert file is not None
        saved = load_results(file)
        assert file == folder / "cases" / row.name / "results.nc"
        assert saved.study is not None
        assert curve is not None
        actual = summary(saved.response, saved.study.outputs["blade tip A"])
        assert row.measures["peak_amplitude_m"] == actual.peak.amplitude
        assert row.measures["shift_from_stuck_hz"] == actual.shift_from_stuck_hz
        assert (row.measures["pairs_stuck"], row.measures["pairs_separating"]) == (
            actual.state_counts[0],
            actual.state_counts[2],
        )
        assert row.measures["friction_energy_j"] == actual.friction_energy
        assert curve.amplitude_m.max() == pytest.approx(row.measures["peak_amplitude_m"], rel=0.02)
        assert len(saved.study.mode_table) == 10


@pytest.mark.long
def test_a_case_of_a_sweep_is_the_case_of_a_run(swept: Swept, tmp_path: Path) -> None:
    _, result, _, _ = swept
    case = quick_case().replace(
        {"preload.centrifugal_force": 600, "output.figure_formats": [], "output.mode_shapes": 0}
    )
    outcome = study.run(case.replace({"output.deflected_shape_frames": 0}), tmp_path)
    assert result.case_files[2] is not None
    saved = load_results(result.case_files[2])
    assert saved.study is not None
    assert saved.study.rough_patch is None  # not the same picture in every case
    np.testing.assert_array_equal(saved.response.displacement, outcome.response.displacement)
    alone = load_results(tmp_path / "results.nc").study
    assert alone is not None
    assert saved.study.derived == alone.derived
    assert alone.sketch is not None
    assert saved.study.sketch is None  # it would be the same in the file of every case


@pytest.mark.slow
def test_shared_work_is_done_once(swept: Swept) -> None:
    assert swept[3] == {"set_up": 1, "reduce_structure": 1, "solve": 4}


@pytest.mark.slow
def test_progress_counts_the_cases(swept: Swept) -> None:
    news = swept[2].news
    assert [stage for stage, fraction, _ in news if fraction == 1.0] == ["Completed cases", "Checks", "Cases"]
    assert news[-1] == ("Cases", 1.0, "4 of 4")
    fractions = [fraction for stage, fraction, _ in news if stage == "Cases"]
    assert list(dict.fromkeys(fractions)) == [0.0, 0.25, 0.5, 0.75, 1.0]  # slow cases report in between
    assert fractions == sorted(fractions)


@pytest.mark.slow
def test_table_files_contain_the_table(swept: Swept) -> None:
    folder, result, _, _ = swept
    with (folder / "sweep.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["peak_amplitude_m"]) for row in rows] == result.table.column("peak_amplitude_m")
    assert rows[1]["excitation.mode"] == "same"
    assert rows[0]["converged"] == "yes"
    assert rows[0]["free_peak_amplitude_m"] == ""  # its peak lies below the range
    assert rows[0]["pairs_stuck"] == str(int(result.table.column("pairs_stuck")[0]))
    with xarray.load_dataset(folder / "sweep.nc", engine="h5netcdf") as data:
        assert data["peak_frequency_hz"].values.tolist() == result.table.column("peak_frequency_hz")
        assert data["preload.centrifugal_force"].attrs["units"] == "N"
        assert data["excitation.mode"].values.tolist() == ["single", "same", "single", "same"]
        assert math.isnan(data["free_peak_amplitude_m"].values[0])
    assert "Damper performance" in (folder / "sweep.html").read_text(encoding="utf-8")


@pytest.mark.long
def test_two_processes_and_any_executor_give_the_same_table(swept: Swept, tmp_path: Path) -> None:
    folder, result, _, _ = swept
    local = ss.sweep(quick_case(), VARY, out=tmp_path / "processes", workers=2)
    assert local.table == result.table
    assert (tmp_path / "processes" / "sweep.csv").read_bytes() == (folder / "sweep.csv").read_bytes()
    with ThreadPoolExecutor(1) as executor:
        other = ss.sweep(quick_case(), VARY | {"excitation.mode": "same"}, executor)
    assert [row.measures for row in other.table.rows] == [row.measures for row in result.table.rows[1::2]]
    assert (other.files, other.case_files) == ((), (None, None))


@pytest.mark.slow
def test_an_executor_without_answer_is_reported_and_its_version_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    class Slow(Executor):
        """Answers, with another version, once the wait was told."""

        def submit(self, *_: object, **__: object) -> Future[Any]:
            self.future: Future[Any] = Future()
            return self.future

    class Listening(Heard):
        def update(self, stage: str, fraction: float, detail: str = "") -> None:
            super().update(stage, fraction, detail)
            if detail.startswith("no answer of the executor for "):
                executor.future.set_result("0.0.9 (code 0)")

    executor, received = Slow(), Listening()
    monkeypatch.setattr(sweep_run, "CHECK_SECONDS", 0.01)
    with rejects(InputError):
        ss.sweep(quick_case(), VARY, executor, progress=received)
    assert received.news[-1][2].endswith("check that it has workers")


@pytest.mark.slow
def test_a_sweep_continues_where_it_ended(swept: Swept, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, result, _, _ = swept
    monkeypatch.setattr(schedule, "solve_task", None)  # solving would be a fault
    monkeypatch.setattr(sweep_run, "set_up", None)
    page = (folder / "sweep.html").read_text(encoding="utf-8")
    again = ss.sweep(quick_case(), VARY, out=folder)
    assert (again.reused, again.notices) == (4, ())
    assert again.table == result.table
    assert len((folder / "sweep.html").read_text(encoding="utf-8")) == pytest.approx(len(page), abs=50)
    part = ss.sweep(quick_case(), VARY | {"excitation.mode": "same"}, out=folder)
    assert (part.reused, part.table.rows) == (4, result.table.rows)  # the table retains the other cases


@pytest.mark.long
def test_damaged_and_foreign_files_are_reported_and_solved_again(swept: Swept, tmp_path: Path) -> None:
    folder, result, _, _ = swept
    shutil.copytree(folder, tmp_path / "copy")
    files = [tmp_path / "copy" / row.file for row in result.table.rows]
    text = files[0].with_name("row.json").read_text(encoding="utf-8")
    peak = repr(result.table.rows[0].measures["peak_amplitude_m"])
    assert f'"peak_amplitude_m": {peak}' in text
    files[0].with_name("row.json").write_text(text.replace(peak, "9" + peak[1:]), encoding="utf-8")
    shutil.copytree(files[0].parent, files[1].parent, dirs_exist_ok=True)  # whole, but of another case
    files[2].unlink()
    abandoned = files[0].with_name(".results.nc.1.part")
    abandoned.write_bytes(b"half")
    again = ss.sweep(quick_case(), VARY, out=tmp_path / "copy", workers=1)
    assert again.reused == 1
    unfit = "is not used: its digest does not match: it is damaged, or belongs to other inputs or another version."
    assert again.notices == (
        f'"{files[0].with_name("row.json")}" {unfit} This case is solved again.',
        f'"{files[1].with_name("row.json")}" {unfit} This case is solved again.',
        f'"{files[2]}" is missing. This case is solved again.',
    )
    assert again.table == result.table
    assert result.case_files[0] is not None
    displacement = [load_results(file).response.displacement for file in (files[0], result.case_files[0])]
    np.testing.assert_array_equal(displacement[0], displacement[1])
    assert not abandoned.exists()
    assert ss.sweep(quick_case(), VARY, out=tmp_path / "copy", workers=1).reused == 4


@pytest.mark.long
def test_cases_that_fail_are_rows_and_the_others_continue(swept: Swept, tmp_path: Path) -> None:
    vary: dict[str, list[float | int | str]] = {
        "roughness.fractal_dimension": [2.4, 2.001],
        "geometry.damper_length": ["28 mm", "40 mm"],
    }
    case = quick_case().replace({"preload.centrifugal_force": 450})
    result = ss.sweep(case, vary, out=tmp_path, workers=1)
    good, long, rough, both = result.table.rows
    assert good.measures == swept[1].table.rows[0].measures
    assert [row.converged for row in result.table.rows] == [True, False, False, False]
    printed_sentence(rough.message)
    printed_sentence(long.message, "damper_length", "40 mm")
    assert both.message == long.message
    assert result.table.failed == (long, rough, both)
    assert result.case_files[1:] == (None, None, None)
    assert long.message in (tmp_path / "sweep.csv").read_text(encoding="utf-8")
    with rejects(RoughnessError, "roughness", "preload.centrifugal_force"):
        ss.sweep(case, {"roughness.fractal_dimension": [2.001]}, workers=1)


@pytest.mark.long
def test_curves_without_end_or_start_are_kept_and_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(case: Case, model: ReducedModel, progress: Progress, threads: int, **options: Any) -> ForcedResponse:
        assert isinstance(case, TwoBladeCase)
        if case.excitation.mode == "same":
            raise ConvergenceError("No first point at 440 Hz.")
        if case.excitation.mode == "opposite":
            raise ZeroDivisionError("division by zero")
        return replace(
            solve(case, model, progress, threads, **options), converged=False, message="The step became too small."
        )

    monkeypatch.setattr(work, "solve", stopped)
    vary = {"excitation.mode": "single,same,opposite"}
    result = ss.sweep(quick_case(), vary, out=tmp_path, workers=1)
    partial, absent, fault = result.table.failed
    assert (partial.message, absent.message) == ("The step became too small.", "No first point at 440 Hz.")
    assert partial.measures["peak_amplitude_m"] > 0
    assert result.case_files[0] is not None
    assert not load_results(result.case_files[0]).response.converged
    assert (absent.measures, absent.file) == ({}, "")
    log = tmp_path / "cases" / fault.name / "traceback.log"
    printed_sentence(fault.message, "ZeroDivisionError", str(log))
    assert "in stopped" in log.read_text(encoding="utf-8")
    page = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    assert "3 cases failed" in page
    assert "mode same: No first point at 440 Hz." in page

    monkeypatch.undo()  # the fault is repaired: what stickslip answered stands, the fault is tried again
    again = ss.sweep(quick_case(), vary, out=tmp_path, workers=1)
    assert again.reused == 2
    assert again.table.rows[:2] == result.table.rows[:2]
    assert again.table.rows[2].converged
    assert not log.exists()
    (tmp_path / "cases" / absent.name / "failed.json").write_text("half", encoding="utf-8")
    once_more = ss.sweep(quick_case(), vary, out=tmp_path, workers=1)
    assert "failed.json" in once_more.notices[0]
    assert once_more.table.rows[1].converged


def test_wrong_input_is_rejected_before_a_folder_is_made(tmp_path: Path) -> None:
    out = tmp_path / "out"
    wrong: tuple[tuple[dict[str, Any], dict[str, Any], tuple[Any, ...]], ...] = (
        ({"preload.centrifugal_force": "-1"}, {}, (InputError, "preload.centrifugal_force")),
        ({"solver.samples": "11,9"}, {}, (StudyFileError,)),
        (VARY, {"workers": 0}, (InputError, "workers")),
        (VARY, {"threads": 0}, (InputError, "threads")),
    )
    for vary, options, expected in wrong:
        with rejects(*expected):
            ss.sweep(quick_case().replace({"solver.harmonics": 5}), vary, out=out, **options)
    assert not out.exists()
