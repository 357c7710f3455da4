"""Several results on one page: what is compared, and what is rejected before anything is read."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat
from typer.testing import CliRunner

from browser_pages import WIDTHS, opened_page, require_readable
from helpers import opened_browser
from sentences import printed_sentence, rejects
from stickslip.cli.main import app
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.validation import FloatArray
from stickslip.reporting.compare_page import _measure_cells
from stickslip.reporting.compare_verdict import compare_verdict
from stickslip.results.comparison import (
    Compared,
    ComparedMeasure,
    amplitude_at,
    compared_measures,
    differing_inputs,
    names_of_cases,
)
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import save_results
from stickslip.results.sweep_table import SweepCurve
from stickslip.study.compare import compare
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow


def scaled(factor: float) -> ForcedResponse:
    """The response with all displacements times a factor."""
    response = synthetic_response()
    return replace(response, displacement=factor * response.displacement)


def write(folder: Path, response: ForcedResponse, inputs: str = "") -> Path:
    folder.mkdir(parents=True)
    study = replace(synthetic_study(), inputs=inputs or synthetic_study().inputs)
    save_results(folder / "results.nc", response, study)
    return folder


@pytest.fixture
def two(tmp_path: Path) -> list[Path]:
    text = synthetic_study().inputs.replace("0.3", "0.5") + '[damping]\nratio = "1 %"\n'
    return [
        write(tmp_path / "first <run>", synthetic_response()),
        write(tmp_path / "second", scaled(1.1), text),
    ]


def test_the_page_has_curves_differences_and_inputs(two: list[Path], tmp_path: Path) -> None:
    (target,) = compare(two, tmp_path / "page.html")
    text = target.read_text(encoding="utf-8")
    assert "first &lt;run&gt;" in text
    assert "<run>" not in text.split("<script")[0]
    for words in (
        "contact.friction_coefficient</th><td>0.3</td><td>0.5</td>",
        "damping.ratio</th><td>–</td><td>1 %</td>",
    ):
        assert words in text
    assert "fractal_dimension" not in text
    assert re.search(r"Highest peak on the curve, µm</th><td>[\d.]+</td><td>[\d.]+ \(\+10\N{NO-BREAK SPACE}%\)", text)
    figures = json.loads(re.findall(r'id="page-figures">(.*?)</script>', text, re.DOTALL)[0])
    entries = [trace["name"] for trace in figures["curves"]["data"] if "legendgroup" in trace]
    assert entries == ["first &lt;run&gt;", "second"]
    assert np.abs(np.array(figures["differences"]["data"][0]["y"]) - 10.0).max() < 1e-4


def test_the_page_begins_with_the_lowest_peak(two: list[Path], tmp_path: Path) -> None:
    (target,) = compare(two, tmp_path / "page.html")
    answer = re.findall(r'<div class="answer">(.*?)</div>', target.read_text(encoding="utf-8"), re.DOTALL)[0]
    assert "The lowest peak is that of first &lt;run&gt;: " in answer
    assert "The highest one, second, is 10 % higher: " in answer
    assert "2 inputs differ: contact.friction_coefficient, damping.ratio." in answer


def test_the_answer_ranks_only_what_is_known() -> None:
    study, cut = synthetic_study(), replace(scaled(0.5), converged=False)
    results = [Compared("a", synthetic_response(), study), Compared("b", cut, study), Compared("c", scaled(1.0), study)]
    measures = [each.curve_and_measures()[1] for each in results]
    equal, rest, same = compare_verdict(results, measures, {})
    assert equal.startswith("All peaks are equal within 0.5 %: ")
    assert rest.startswith("Without a rank: b. ")
    assert same == "The inputs are the same."
    far = [results[0], Compared("e", scaled(5.0), study)]
    (words, _) = compare_verdict(far, [each.curve_and_measures()[1] for each in far], {})
    assert "The highest one, e, is 5 times as high: " in words
    assert compare_verdict(results, measures, {"forces.gas.amplitude": None})[-1].startswith("The excitation differs")
    reordered = replace(study, outputs=dict(reversed(study.outputs.items())))
    other = [results[0], Compared("d", synthetic_response(), reordered)]
    assert compare_verdict(other, measures[:2], {})[0].startswith("The results have different responses")


def test_cases_of_a_sweep_have_the_names_of_their_inputs() -> None:
    study = synthetic_study()
    other = replace(study, inputs=study.inputs.replace("0.3", "0.5"))
    folders = ("friction_coefficient-0.3_0123456789ab", "friction_coefficient-0.5_ba9876543210")
    assert names_of_cases(folders, [study, other]) == ("friction coefficient 0.3", "friction coefficient 0.5")
    assert names_of_cases(folders, [study, study]) == ("friction_coefficient-0.3", "friction_coefficient-0.5")
    long = [replace(study, inputs=study.inputs.replace("0.3", digits)) for digits in ("0.196798967", "0.2000001")]
    assert names_of_cases(folders, long) == ("friction coefficient 0.1968", "friction coefficient 0.2")
    close = [replace(study, inputs=study.inputs.replace("0.3", digits)) for digits in ("0.196798967", "0.196798968")]
    assert names_of_cases(folders, close)[1] == "friction coefficient 0.196798968"
    section = [
        replace(study, inputs=f"[friction]\ncoefficient = {number}\n[preload]\nspeed_of_rotation = {number}\n")
        for number in (0.2, 0.4)
    ]
    assert names_of_cases(folders, section)[0] == "friction coefficient 0.2, speed of rotation 0.2"
    alike = ("a_0123456789ab", "a_ba9876543210")
    assert names_of_cases(alike, [study, study]) == alike


def test_measures_and_inputs_in_python() -> None:
    study = synthetic_study()
    results = [Compared("a", synthetic_response(), study), Compared("b", scaled(0.5), study)]
    rows = {row.name: row for row in compared_measures([each.curve_and_measures()[1] for each in results])}
    assert rows["peak_amplitude_m"].differences == pytest.approx((0.0, -0.5))
    assert rows["peak_frequency_hz"].differences == (0.0, 0.0)
    assert differing_inputs([study, study]) == {}


def test_the_upper_branch_of_a_folded_curve_counts() -> None:
    frequency: FloatArray = np.array([1.0, 3.0, 2.0, 4.0, 5.0, 6.0])
    amplitude = np.array([1.0, 3.0, 5.0, 1.0, 9.0, 9.0])
    curve = SweepCurve(frequency, amplitude, np.ones(6, bool), np.array([0, 0, 0, 0, 1, 1]))
    found = amplitude_at(curve, np.array([0.5, 1.5, 2.5, 3.5, 4.5, 5.5]))
    np.testing.assert_allclose(found, [np.nan, 1.5, 4.0, 2.0, np.nan, 9.0])


def test_wrong_requests_are_rejected_before_anything_is_written(two: list[Path], tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    for folders in ([two[0]], [two[0], two[0]], [two[0], tmp_path / "absent"], [two[0], tmp_path]):
        with rejects(InputError):
            compare(folders, target)
    with rejects(InputError):
        compare(two * 7, target)
    (tmp_path / "sweep" / "cases").mkdir(parents=True)
    with rejects(InputError):
        compare([two[0], tmp_path / "sweep"], target)
    with rejects(InputError):
        compare(two, tmp_path / "page.pdf")
    target.write_text("mine", encoding="utf-8")
    with rejects(InputError):
        compare(two, target)
    assert target.read_text(encoding="utf-8") == "mine"
    compare(two, target, force=True)
    assert target.stat().st_size > 1e6


def test_the_tables_of_a_comparison_are_those_of_the_page(two: list[Path], tmp_path: Path) -> None:
    page, file = compare(two, tmp_path / "page.html", to="mat")
    assert (page.name, file.name) == ("page.html", "page.mat")
    content: Any = loadmat(file, simplify_cells=True)
    measures = content["measures"]
    at = list(measures["measure"]).index("peak_amplitude_m")
    assert measures["second_over_first_run_1"][at] == pytest.approx(0.1)
    assert measures["second"][at] == pytest.approx(1.1 * measures["first_run"][at])
    assert list(content["inputs"]["key"]) == ["contact.friction_coefficient", "damping.ratio"]
    assert content["curves"]["frequency"].size == 2 * synthetic_response().n_points
    page.unlink()
    with rejects(InputError):
        compare(two, page, to="mat")
    assert not page.exists()
    with rejects(InputError, "to"):
        compare(two, tmp_path / "third.html", to="ods")
    assert not (tmp_path / "third.html").exists()


def test_results_that_do_not_fit_together_are_rejected(two: list[Path], tmp_path: Path) -> None:
    response = synthetic_response()
    factors = np.linspace(0.5, 1.5, response.n_points)
    controlled = write(tmp_path / "controlled", replace(response, load_factor=factors))
    with rejects(InputError):
        compare([two[0], controlled], tmp_path / "page.html")
    bare = tmp_path / "bare"
    bare.mkdir()
    save_results(bare / "results.nc", response)
    with rejects(InputError):
        compare([two[0], bare], tmp_path / "page.html")
    (bare / "results.nc").write_bytes(b"damaged")
    with rejects(ResultsFileError):
        compare([two[0], bare], tmp_path / "page.html")


def test_folders_of_one_name_are_told_apart_by_their_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        write(Path(name) / "run", synthetic_response())
    (page,) = compare([Path("a/run"), Path("b/run")])
    text = page.read_text(encoding="utf-8")
    assert "Comparison of a/run, b/run" in text.replace("\\", "/")
    assert "The study files of all results have the same keys and values." in text


def test_long_names_are_not_all_in_the_title(tmp_path: Path) -> None:
    folders = [tmp_path / f"{part}-{'centrifugal_force' * 2}" for part in "abc"]
    for folder in folders:
        write(folder, synthetic_response())
    (page,) = compare(folders, tmp_path / "page.html")
    assert f"<h1>Comparison of {folders[0].name} and 2 more</h1>" in page.read_text(encoding="utf-8")


def test_the_command_writes_the_page_and_exits_with_two_for_a_wrong_folder(two: list[Path], tmp_path: Path) -> None:
    runner = CliRunner()
    target = tmp_path / "page.html"
    done = runner.invoke(app, ["compare", *map(str, two), "--out", str(target), "--to", "csv"])
    assert done.exit_code == 0
    assert target.exists()
    assert sorted(path.name for path in (tmp_path / "page_tables").iterdir()) == [
        "curves.csv",
        "inputs.csv",
        "measures.csv",
    ]
    wrong = runner.invoke(app, ["compare", str(two[0]), "--out", str(target)])
    assert wrong.exit_code == 2
    printed_sentence(wrong.output.replace(str(tmp_path), "<folder>"))
    exported = runner.invoke(app, ["export", str(two[1]), "--to", "xlsx"])
    assert exported.exit_code == 0
    assert (two[1] / "tables.xlsx").exists()


@pytest.mark.long
def test_the_page_is_readable_in_a_browser(two: list[Path], tmp_path: Path) -> None:
    (target,) = compare(two, tmp_path / "page.html")
    with opened_browser() as browser:
        for width in WIDTHS:
            with opened_page(browser, target, width) as page:
                require_readable(page)


def test_a_reduction_has_no_quotient_of_two_fractions() -> None:
    """A peak that is 4 % above the linear one, and another one 18 % below it, are no change of -513 %."""
    reduction = ComparedMeasure("reduction_from_stuck", "1", "1 - peak / linear stuck peak", (-0.043, 0.177))
    assert [cell.count("(") for cell in _measure_cells(reduction)[1]] == [0, 0]
    amplitude = ComparedMeasure("peak_amplitude_m", "m", "peak", (1e-4, 2e-4))
    negligible = ComparedMeasure("reduction_from_stuck", "1", "1 - peak / linear stuck peak", (6e-7, 0.2))
    assert _measure_cells(negligible)[1] == ["0", "20"]
    assert _measure_cells(amplitude)[1][1].endswith("(+100\N{NO-BREAK SPACE}%)")
