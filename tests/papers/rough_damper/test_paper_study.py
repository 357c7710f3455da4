"""The whole path on a very coarse model: files, numbers of the page, resuming, damage, failures, the command."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from paper_scope import coarse_scope
from sentences import printed_sentence, rejects
from stickslip.cli import main as cli
from stickslip.core.errors import ConvergenceError, StudyFileError
from stickslip.papers.rough_damper import compute as computing
from stickslip.papers.rough_damper import study
from stickslip.papers.rough_damper.plan import Scope, computations
from stickslip.papers.rough_damper.study import PaperOutcome, paper_study
from stickslip.papers.rough_damper.verdicts import Verdict

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, PaperOutcome]:
    folder = tmp_path_factory.mktemp("paper")
    return folder, paper_study(folder, workers=1, scope=coarse_scope())


class _Tags(HTMLParser):
    """Open tags, ids, addresses of files that a page asks for or links to, and of other sites that it links to."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.asked: list[str] = []
        self.sites: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "link", "img", "br"):
            self.open.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("src", "href") and value and not value.startswith(("data:", "#")):
                is_site = tag == "a" and value.startswith("https://")
                (self.sites if is_site else self.asked).append(value)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_page_is_whole_and_requests_nothing(made: tuple[Path, PaperOutcome]) -> None:
    folder, outcome = made
    text = (folder / "paper.html").read_text(encoding="utf-8")
    tags = _Tags()
    tags.feed(text)
    assert tags.open == []
    assert {address.split("/")[0] for address in tags.asked} == {"figures", "tables"}
    assert tags.sites == ["https://doi.org/10.3390/app13042128"]
    assert all((folder / address).is_file() for address in tags.asked)
    assert tags.ids == [
        "conclusions", "choices", "reduction", "surfaces", "stiffness", "period", "damper", "states", "curves",
        "energies", "laws", "errata",
    ]  # fmt: skip
    assert "{{" not in text
    assert "nan" not in re.sub(r"base64,[^\"]*", "", text).lower().split()
    assert outcome.files[0] == folder / "paper.html"


def test_every_file_is_there(made: tuple[Path, PaperOutcome]) -> None:
    folder, outcome = made
    assert all(file.stat().st_size > 0 for file in outcome.files)
    names = {file.name for file in outcome.files}
    for number in ("02_reduction", "04_surfaces", "07_period_D", "09_damper", "12_curves_D", "15_energy_G"):
        assert {f"fig{number}.svg", f"fig{number}.png"} <= names
    assert {"conclusions.csv", "choices_verdicts.csv", "errata.csv", "table2_frequencies.csv", "paper.nc"} <= names
    assert not list(folder.rglob("*.part"))


def test_numbers_agree_between_tables_and_netcdf(made: tuple[Path, PaperOutcome]) -> None:
    folder, outcome = made
    assert outcome.failures == ()
    assert outcome.curves == len(computations(coarse_scope())) == 21
    with (folder / "tables" / "curves.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == outcome.curves
    with xarray.open_dataset(folder / "paper.nc", group="tables/curves", engine="h5netcdf") as table:
        peak = table["peak"].values
        assert table["peak"].attrs["units"] == "um"
    assert np.array([float(row["peak [um]"]) for row in rows]) == pytest.approx(peak)
    with xarray.open_dataset(folder / "paper.nc", group="curves/000", engine="h5netcdf") as curve:
        # the peak of the table is a parabola through the points of the curve
        assert 1e6 * curve["amplitude"].values.max() == pytest.approx(peak[0], rel=0.02)
        assert curve.attrs["excitation"] == "single"


def test_verdicts_of_the_page_are_those_of_the_claims(made: tuple[Path, PaperOutcome]) -> None:
    folder, outcome = made
    with (folder / "tables" / "conclusions.csv").open(encoding="utf-8") as stream:
        words = [row["verdict"] for row in csv.DictReader(stream)]
    assert {verdict: words.count(verdict.value) for verdict in Verdict} == outcome.verdicts
    assert outcome.verdicts[Verdict.HOLDS] < len(words)


def test_a_stopped_study_continues_and_damage_is_computed_again(
    made: tuple[Path, PaperOutcome], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, outcome = made
    files = sorted((folder / computing.FOLDER).iterdir())
    files[0].unlink()
    files[1].write_bytes(files[1].read_bytes()[:100])
    files[2].write_bytes(files[3].read_bytes())
    solved: list[object] = []
    original = computing.solve_setting

    def counted(task: Any, reduced: Any) -> Any:
        solved.append(task.setting)
        return original(task, reduced)

    monkeypatch.setattr(computing, "solve_setting", counted)
    monkeypatch.setattr(study, "_written", lambda folder, scope, computed, reported: computed)
    again = paper_study(folder, workers=1, scope=coarse_scope())
    assert (again.reused, len(solved), len(again.solved)) == (outcome.curves - 3, 3, outcome.curves)  # type: ignore[attr-defined]
    # the file that was missing needs no sentence
    for notice, file in zip(sorted(again.notices), files[1:3], strict=True):
        printed_sentence(notice, str(file))


def test_a_curve_that_fails_is_reported_and_without_any_curve_there_is_no_page(tmp_path: Path) -> None:
    plastic = replace(
        coarse_scope(), dimensions=(2.2,), scales=(1e-8,), dimension=2.2, scale=1e-8, choices=(), extra=()
    )
    with rejects(ConvergenceError):
        paper_study(tmp_path, workers=1, scope=plastic)
    assert not (tmp_path / "paper.html").exists()


def test_wrong_changes_are_rejected_before_anything_is_made(tmp_path: Path) -> None:
    with rejects(StudyFileError, "solver.samples"):
        paper_study(tmp_path / "out", scope=Scope(changes={"solver.samples": 2}))
    assert not (tmp_path / "out").exists()


def test_command(made: tuple[Path, PaperOutcome], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    _, outcome = made
    monkeypatch.setattr(study, "paper_study", lambda out, workers, progress: outcome)
    result = CliRunner().invoke(cli.app, ["paper", "--out", str(tmp_path), "--workers", "1"])
    assert result.exit_code == 0, result.stderr
    assert f"Wrote {outcome.files[0]}" in result.stdout
    assert "21 curves, 0 of them from an earlier run. Claims: " in result.stdout
    failed = replace(
        outcome,
        notices=("A file was damaged.",),
        failures=(computing.Failure(computations(coarse_scope())[0].setting, "No."),),
    )
    monkeypatch.setattr(study, "paper_study", lambda out, workers, progress: failed)
    result = CliRunner().invoke(cli.app, ["paper", "--out", str(tmp_path), "--quiet"])
    assert (result.exit_code, result.stdout) == (3, "")
    assert "No." in result.stderr
    assert "A file was damaged." in result.stderr
