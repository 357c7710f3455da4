"""One case from file to report, on a coarse two-blade model that solves in seconds."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from castings import ROUGH_CASTING, casting_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.cli.main import app
from stickslip.core.errors import InputError, OutputError, ResultsFileError
from stickslip.model.model import build_joint, build_model, build_structure
from stickslip.results.measures import energy_imbalance
from stickslip.results.storage import load_results
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.structure.elasticity import Structure
from stickslip.study import analyses, assembled, pairs_that_move, solution
from stickslip.study import places as run_places
from stickslip.study import run as study
from stickslip.study.check import check
from stickslip.study.figure_process import PAGE_GRID, rough_patch
from sweep_cases import COARSE_MESH, quick_case

pytestmark = pytest.mark.slow

COARSE = {
    **ROUGH_CASTING,
    **COARSE_MESH,
    "geometry.excitation_height": "9 mm",
    "excitation.amplitude": "60 N",
    "solver.harmonics": 3,
    "solver.samples": 128,
    "analysis.performance_curve": False,  # tests/study/test_ridge_study.py
    "output.deflected_shape_frames": 4,  # fewer than the harmonics require
    "output.figure_formats": ["png"],
}


class Heard:
    """Progress that remembers."""

    def __init__(self) -> None:
        self.news: list[tuple[str, float]] = []

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        self.news.append((stage, fraction))


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, study.StudyOutcome, Heard]:
    folder, received = tmp_path_factory.mktemp("study"), Heard()
    return folder, study.run(Case().replace(COARSE), folder, received), received


@pytest.mark.long
def test_run_writes_every_file(solved: tuple[Path, study.StudyOutcome, Heard]) -> None:
    folder, outcome, received = solved
    assert outcome.converged, outcome.message
    names = {str(path.relative_to(folder)) for path in outcome.files}
    assert {"results.nc", "report.html", "mode_shapes.vtu", "deflected_shape.pvd"} <= names
    assert {"figures/amplitude_frequency.png", "figures/contact_states.png", "figures/rough_face.png"} <= names
    assert all(path.stat().st_size > 0 for path in outcome.files)
    assert len(list((folder / "deflected_shape_frames").glob("*.vtu"))) == 7
    assert next(stage for stage, fraction in received.news if fraction == 1.0) == "Structure"
    assert received.news[-1] == ("Files", 1.0)


def test_the_curve_is_physical(solved: tuple[Path, study.StudyOutcome, Heard]) -> None:
    _, outcome, _ = solved
    response = outcome.response
    assert (
        np.abs(energy_imbalance(response)).max() < 1e-5
    )  # creep of pairs that keep their traction, see test_mesh_study.py
    assert response.residual.max() < 1e-7
    assert (response.contact_state > 0).any(), "nothing moves: raise the force of this test"
    printed_sentence(outcome.message, numbers=False)


def test_results_load_back_equal_and_report_is_remade(solved: tuple[Path, study.StudyOutcome, Heard]) -> None:
    folder, outcome, _ = solved
    saved = load_results(folder / "results.nc")
    assert saved.response == outcome.response
    assert saved.study is not None
    assert saved.study.pair_face.size == outcome.response.pairs.n_pairs
    assert saved.study.sketch is not None
    assert saved.study.sketch.body_names == ("left blade", "right blade", "damper")
    assert saved.study.rough_patch == rough_patch(Case().replace(COARSE), PAGE_GRID)
    before = (folder / "report.html").read_text(encoding="utf-8")
    assert '<section id="structure">' in before
    (folder / "report.html").unlink()
    study.report(folder)
    assert (folder / "report.html").read_text(encoding="utf-8") == before


def test_the_mode_table_has_no_reference_unless_the_study_gives_one(
    solved: tuple[Path, study.StudyOutcome, Heard],
) -> None:
    folder, _, _ = solved
    record = load_results(folder / "results.nc").study
    assert record is not None
    assert len(record.mode_table) == 10
    assert not any("reference_hz" in row for row in record.mode_table)
    assert record.mode_reference == ""
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Reference" not in page[page.index("Natural frequencies, contact tied") :].partition("</section>")[0]


@pytest.mark.long
def test_a_reference_goes_from_the_study_file_to_results_page_and_figure(tmp_path: Path) -> None:
    few_points = {"solver.harmonics": 1, "solver.frequency_start": "450 Hz", "solver.frequency_stop": "451 Hz"}
    values = Case().replace({**COARSE, **few_points, "output.deflected_shape_frames": 0})
    text = values.to_text().partition("# [reference]")
    reference = '[reference]\nmode_frequencies = ["0.5 kHz", 0, 1200]\nsource = "modal test <2024>"\n'
    rest = text[2][text[2].index("[analysis]") :]
    (tmp_path / "study.toml").write_text(f"{text[0]}{reference}{rest}", encoding="utf-8")
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["run", str(tmp_path / "study.toml"), "--out", str(out), "--quiet"])
    assert result.exit_code == 0, result.output
    record = load_results(out / "results.nc").study
    assert record is not None
    assert record.mode_reference == "modal test <2024>"
    assert len(record.mode_table) == 10
    assert [row.get("reference_hz") for row in record.mode_table[:4]] == [500.0, None, 1200.0, None]
    assert (out / "figures" / "mode_comparison.png").is_file()
    page = (out / "report.html").read_text(encoding="utf-8")
    section = page[page.index("Natural frequencies, contact tied") :].partition("</section>")[0]
    assert "Reference: modal test &lt;2024&gt;." in section
    assert "Reference, Hz" in section
    assert "Full model against reference, %" in section
    first, second = re.findall(r"<tr><td>[12]</td>.*?</tr>", section)
    deviation = 100.0 * (float(record.mode_table[0]["full_hz"]) / 500.0 - 1.0)
    assert first.endswith(f"<td>500.00</td><td>{deviation:+.2f}</td></tr>".replace("-", "−"))
    assert second.endswith("<td>–</td><td>–</td></tr>")


def test_report_of_an_empty_folder_is_rejected(tmp_path: Path) -> None:
    with rejects(ResultsFileError):
        study.report(tmp_path)


def test_check_says_what_would_run() -> None:
    sections = dict(check(Case()))
    sizes = dict(sections["Sizes"])
    assert sizes["nodes"] == "5005"
    assert sizes["unknowns after reduction"].startswith("699 ")
    derived = dict(sections["Derived quantities"])
    assert derived["Normal load, left face"] == "288.7 N"
    assert derived["Sq"].endswith("µm")
    assert dict(sections["Would run"])["sweep"] == "400 to 550 Hz"


def test_check_shows_the_warnings_of_the_roughness() -> None:
    sections = dict(
        check(casting_case().replace({"roughness.fractal_dimension": 2.49, "roughness.fractal_roughness": "1e-11 m"}))
    )
    assert "Warnings" in sections


@pytest.mark.long
def test_an_unfinished_curve_is_kept_and_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The branch ends after six points: exit code 3, the sentence why, and every file of what was found."""
    monkeypatch.setattr(
        analyses, "ContinuationSettings", lambda **steps: ContinuationSettings(**{**steps, "max_points": 6})
    )
    path = tmp_path / "study.toml"
    path.write_text(Case().replace(COARSE).to_text(), encoding="utf-8")
    result = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "out"), "--quiet"])
    assert result.exit_code == 3
    printed_sentence(result.stderr, str(tmp_path / "out" / "results.nc"))
    saved = load_results(tmp_path / "out" / "results.nc").response
    assert not saved.converged
    assert saved.n_points == 6
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "6 points were not enough" in page


@pytest.mark.long
def test_the_curve_is_the_same_with_one_and_two_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a kept superelement. Joints of 1000 rows and more sum with several threads; this one does not."""
    monkeypatch.setenv("STICKSLIP_CACHE", "off")
    curves = [solution.solve_case(Case().replace(COARSE), threads=threads).response for threads in (1, 2)]
    assert np.array_equal(curves[0].frequency_hz, curves[1].frequency_hz)
    assert np.array_equal(curves[0].displacement, curves[1].displacement)


@pytest.mark.long
def test_a_folder_that_is_removed_while_the_case_is_solved_loses_no_curve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = vars(pairs_that_move)["solve"]

    def solve_and_remove(*arguments: Any) -> Any:
        response = solve(*arguments)
        shutil.rmtree(tmp_path / "out")
        return response

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(pairs_that_move, "solve", solve_and_remove)
    with rejects(ResultsFileError) as error:
        study.run(quick_case(), tmp_path / "out")
    (retained,) = (tmp_path / "cache").rglob("results.nc")
    assert str(retained) in str(error.value)
    assert load_results(retained).response.converged
    assert not (tmp_path / "out").exists()


def test_places_that_are_taken_are_found_before_anything_is_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(assembled, "set_up", None)
    for name in ("results.nc", "report.html", "mode_shapes.vtu", "deflected_shape.pvd", "contact_pairs.vtu"):
        (tmp_path / name).mkdir()
        with rejects(OutputError):
            study.run(Case().replace(COARSE), tmp_path)
        (tmp_path / name).rmdir()
    for name in ("figures", "deflected_shape_frames"):
        (tmp_path / name).write_text("a file", encoding="utf-8")
        with rejects(OutputError):
            study.run(Case().replace(COARSE), tmp_path)
        (tmp_path / name).unlink()


@pytest.mark.long
def test_a_disk_that_fills_up_after_the_results_keeps_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise InputError("the report could not be written: No space left on device.")

    monkeypatch.setattr(study, "_page", full)
    with rejects(InputError):
        study.run(quick_case(), tmp_path)
    assert load_results(tmp_path / "results.nc").response.converged


def test_too_little_room_is_found_before_solving(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solution, "solved_with_moving_pairs", None)
    usage = SimpleNamespace(free=11_500_000)  # enough at the start, not for the results of this model
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    with rejects(OutputError):
        study.run(Case().replace(COARSE), tmp_path)


def test_the_estimate_of_the_room_covers_what_a_run_writes(
    solved: tuple[Path, study.StudyOutcome, Heard], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, _, _ = solved
    asked: list[tuple[int, int]] = []
    monkeypatch.setattr(run_places, "require_disk_space", lambda _, whole, largest: asked.append((whole, largest)))
    case = Case().replace(COARSE)
    structure = build_structure(case)
    assert isinstance(structure, Structure)
    run_places.require_space_for(case, build_model(case, structure, build_joint(case, structure)), folder)
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    ((whole, largest),) = asked
    assert sum(sizes) < whole < 3 * sum(sizes)
    assert max(sizes) < largest < 3 * max(sizes)


@pytest.mark.long
def test_a_study_asks_for_the_band_of_residual_tractions(tmp_path: Path) -> None:
    case = quick_case().replace({"analysis.traction_band": True, "output.figure_formats": ["png"]})
    assert Case.from_text(case.to_text()) == case
    outcome = study.run(case, tmp_path)
    saved = load_results(tmp_path / "results.nc")
    band = saved.response.traction_band
    assert band is not None
    assert band == outcome.response.traction_band
    assert band.complete.all()
    assert saved.study is not None
    output = saved.study.outputs[saved.study.response_output]
    low, high = band.peak_range(output)
    assert low < high
    assert "Highest peak over extreme residual tractions" in outcome.message
    assert f"and {band.n_curves} with extreme tractions" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.long
def test_run_searches_for_other_solutions(tmp_path: Path) -> None:
    case = quick_case().replace({"analysis.search_starts": 1, "output.figure_formats": ["png"]})
    (tmp_path / "study.toml").write_text(case.to_text(), encoding="utf-8")
    out = tmp_path / "out"
    command = ["run", str(tmp_path / "study.toml"), "--out", str(out), "--quiet", "--search"]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.output
    other = load_results(out / "results.nc").response.other_solutions
    assert other is not None
    assert (other.random_starts, other.random_motions, other.seed) == (1, 8, 0)
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "<h2>Other solutions</h2>" in page
    assert "from 1 random states" in page
