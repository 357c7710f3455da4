"""One case from file to report, on a coarse two-blade model that solves in seconds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from stickslip.case.case import Case
from stickslip.cli.main import app
from stickslip.core.errors import ResultsFileError
from stickslip.results.measures import energy_imbalance
from stickslip.results.storage import load_results
from stickslip.solve.path.continuation import ContinuationSettings
from stickslip.study import run as study
from stickslip.study.figure_process import PAGE_GRID, rough_patch
from sweep_cases import COARSE_MESH

pytestmark = pytest.mark.slow

COARSE = {
    **COARSE_MESH,
    "geometry.excitation_height": "9 mm",
    "excitation.amplitude": "60 N",
    "solver.harmonics": 3,
    "solver.samples": 128,
    "output.deflected_shape_frames": 8,
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
    folder, heard = tmp_path_factory.mktemp("study"), Heard()
    return folder, study.run(Case().replace(COARSE), folder, heard), heard


def test_run_writes_every_file(solved: tuple[Path, study.StudyOutcome, Heard]) -> None:
    folder, outcome, heard = solved
    assert outcome.converged, outcome.message
    names = {str(path.relative_to(folder)) for path in outcome.files}
    assert {"results.nc", "report.html", "mode_shapes.vtu", "deflected_shape.pvd"} <= names
    assert {"figures/amplitude_frequency.png", "figures/contact_states.png", "figures/rough_face.png"} <= names
    assert all(path.stat().st_size > 0 for path in outcome.files)
    assert next(stage for stage, fraction in heard.news if fraction == 1.0) == "Structure"
    assert heard.news[-1] == ("Files", 1.0)


def test_the_curve_is_physical(solved: tuple[Path, study.StudyOutcome, Heard]) -> None:
    _, outcome, _ = solved
    response = outcome.response
    assert np.abs(energy_imbalance(response)).max() < 1e-6
    assert response.residual.max() < 1e-7
    assert (response.contact_state > 0).any(), "nothing moves: raise the force of this test"
    assert "Peak amplitude, 0-to-peak" in outcome.message


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


def test_paper_column_only_beside_the_fitted_geometry(solved: tuple[Path, study.StudyOutcome, Heard]) -> None:
    folder, _, _ = solved
    record = load_results(folder / "results.nc").study
    assert record is not None
    assert len(record.mode_table) == 10
    assert not any("table2_hz" in row for row in record.mode_table)


def test_report_of_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ResultsFileError, match=r"results\.nc"):
        study.report(tmp_path)


def test_check_says_what_would_run() -> None:
    sections = dict(study.check(Case()))
    sizes = dict(sections["Sizes"])
    assert sizes["nodes"] == "5005"
    assert sizes["unknowns after reduction"].startswith("699 ")
    derived = dict(sections["Derived quantities"])
    assert derived["Normal load, left face"] == "288.7 N"
    assert derived["Sq"].endswith("µm")
    assert dict(sections["Would run"])["sweep"] == "400 to 530 Hz"


def test_check_shows_the_warnings_of_the_roughness() -> None:
    sections = dict(
        study.check(Case().replace({"roughness.fractal_dimension": 2.49, "roughness.fractal_roughness": "1e-11 m"}))
    )
    assert "Warnings" in sections


def test_an_unfinished_curve_is_kept_and_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The branch ends after six points: exit code 3, the sentence why, and every file of what was found."""
    monkeypatch.setattr(study, "ContinuationSettings", lambda **steps: ContinuationSettings(max_points=6, **steps))
    path = tmp_path / "study.toml"
    path.write_text(Case().replace(COARSE).to_text(), encoding="utf-8")
    result = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "out"), "--quiet"])
    assert result.exit_code == 3
    assert "6 points were not enough" in result.stderr
    assert str(tmp_path / "out" / "results.nc") in result.stderr
    saved = load_results(tmp_path / "out" / "results.nc").response
    assert not saved.converged
    assert saved.n_points == 6
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "6 points were not enough" in page
