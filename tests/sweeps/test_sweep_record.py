"""A sweep into the folder of another one: the table contains both; the pages of its folder, without solving."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from pathlib import Path

import pytest
from typer.testing import CliRunner

from sentences import rejects
from stickslip.case.case import Case
from stickslip.cli import main as cli
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.sweeps import work
from stickslip.sweeps.axes import Vary, swept_keys
from stickslip.sweeps.plan import plan_table
from stickslip.sweeps.record import SWEEP_FILE, StoredCase, SweepRecord, extended, read_record, store_record
from stickslip.sweeps.run import sweep
from sweep_cases import quick_case

LOAD, MODE, FRICTION = "preload.centrifugal_force", "excitation.mode", "friction.coefficient"


def stored_sweep(folder: Path, case: Case, vary: Vary) -> None:
    """The record of a sweep that has solved all its cases."""
    keys = swept_keys(vary, case)
    _, planned = plan_table(case, *extended(folder, case, keys), {})
    cases = tuple(StoredCase(each.name, each.key, 50.0, each.values) for each in planned)
    store_record(folder, SweepRecord("t", "text", ("a.b = 1",), case.to_dict(), keys, cases))


def rows_of(folder: Path, case: Case, vary: Vary) -> list[Mapping[str, object]]:
    """Key -> value of each row of the extended table."""
    keys, rows = extended(folder, case, swept_keys(vary, case))
    return [{key.name: key.values[place] for key, place in zip(keys, row, strict=True)} for row in rows]


def test_further_values_extend_the_table_in_the_order_of_their_size(tmp_path: Path) -> None:
    case = quick_case()
    assert rows_of(tmp_path, case, {LOAD: [300, 100]}) == [{LOAD: 300.0}, {LOAD: 100.0}]
    stored_sweep(tmp_path, case, {LOAD: [300, 100]})
    assert rows_of(tmp_path, case, {LOAD: ["0.2 kN", "100 N"]}) == [{LOAD: each} for each in (100.0, 200.0, 300.0)]


def test_a_key_that_one_sweep_does_not_vary_has_the_value_of_its_study(tmp_path: Path) -> None:
    case = quick_case()
    stored_sweep(tmp_path, case, {LOAD: [300, 100]})
    stronger = case.replace({LOAD: "500 N"})  # the base value of a key that varies there may differ
    assert rows_of(tmp_path, stronger, {MODE: ["same", "opposite"]}) == [
        {LOAD: 100.0, MODE: "single"},
        {LOAD: 300.0, MODE: "single"},
        {LOAD: 500.0, MODE: "same"},
        {LOAD: 500.0, MODE: "opposite"},
    ]


def test_cases_retain_their_folders_when_a_key_is_added(tmp_path: Path) -> None:
    case = quick_case()
    _, before = plan_table(case, *extended(tmp_path, case, swept_keys({LOAD: [300, 100]}, case)), {})
    stored_sweep(tmp_path, case, {LOAD: [300, 100]})
    names = {each.key[:12]: each.name for each in before}
    added = swept_keys({LOAD: [100], FRICTION: [0.3, 0.4]}, case.replace({FRICTION: 0.3}))
    _, after = plan_table(case, *extended(tmp_path, case, added), names)
    assert {each.name for each in before} < {each.name for each in after}
    assert len(after) == 3


def test_another_study_is_rejected(tmp_path: Path) -> None:
    case = quick_case()
    stored_sweep(tmp_path, case, {LOAD: [300, 100]})
    other = case.replace({FRICTION: 0.4, "study.title": "Another title"})
    with rejects(InputError, FRICTION):
        rows_of(tmp_path, other, {LOAD: [200]})
    assert len(rows_of(tmp_path, other, {FRICTION: [0.4], LOAD: [200]})) == 3


def test_a_key_without_value_in_the_study_is_rejected(tmp_path: Path) -> None:
    case = quick_case()
    stored_sweep(tmp_path, case, {LOAD: [300]})
    with rejects(InputError, "reduction.modes"):
        inputs = case.to_dict() | {"reduction": {"pairs": "all"}}
        store_record(tmp_path, SweepRecord("t", "", (), inputs, swept_keys({LOAD: [300]}, case), read_cases(tmp_path)))
        rows_of(tmp_path, case, {"reduction.modes": [7]})


def read_cases(folder: Path) -> tuple[StoredCase, ...]:
    record = read_record(folder)
    assert record is not None
    return record.cases


def test_a_damaged_record_is_rejected(tmp_path: Path) -> None:
    case = quick_case()
    stored_sweep(tmp_path, case, {LOAD: [300]})
    file = tmp_path / SWEEP_FILE
    file.write_bytes(file.read_bytes().replace(b"300.0", b"310.0"))
    with rejects(ResultsFileError):
        rows_of(tmp_path, case, {LOAD: [200]})


@pytest.mark.long
def test_two_sweeps_are_one_table_and_report_writes_every_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = sweep(quick_case(), {LOAD: [600]}, out=tmp_path, workers=1)
    both = sweep(quick_case(), {LOAD: [650], MODE: ["single"]}, out=tmp_path, workers=1)
    assert both.reused == 1
    assert both.table.column(LOAD) == [600.0, 650.0]
    assert both.table.column("peak_amplitude_m")[0] == first.table.column("peak_amplitude_m")[0]
    with (tmp_path / "sweep.csv").open(encoding="utf-8") as stream:
        assert [row[LOAD] for row in csv.DictReader(stream)] == ["600.0", "650.0"]
    monkeypatch.setattr(work, "solve", None)  # nothing is solved again
    result = CliRunner().invoke(cli.app, ["report", str(tmp_path)])
    assert result.exit_code == 0, result.stderr
    text = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    links = re.findall(r'<a href="(cases/[^"]*)"', text)
    table = text[text.index('<table class="cases">') :].partition("</table>")[0]
    assert len(links) == 2, (result.output, sorted(map(str, tmp_path.rglob("*"))), table)
    assert all((tmp_path / link).exists() for link in links)
    (tmp_path / "cases" / Path(links[0]).parent.name / "results.nc").unlink()
    result = CliRunner().invoke(cli.app, ["report", str(tmp_path)])
    assert result.exit_code == ResultsFileError.exit_code
    assert Path(links[0]).parent.name in result.stderr
    assert (tmp_path / "sweep.html").read_text(encoding="utf-8").count('<a href="cases/') == 1
