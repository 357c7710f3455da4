"""The user guide: its scripts run and print what it shows, its commands run, its links and pictures are there."""

from __future__ import annotations

import contextlib
import re
import socket
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from helpers import absent_tool, matched
from stickslip.cli.main import app
from stickslip.reporting.page_sections import CURVE, SECTIONS
from sweep_cases import quick_file

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = (
    "guide",
    "first_run",
    "reading_the_report",
    "choosing_harmonics_and_samples",
    "roughness",
    "loops",
    "sweeps",
    "band",
    "design",
    "comparing",
    "paper_study",
    "solved_preload",
    "studies",
)


@pytest.mark.parametrize("name", PAGES)
def test_links_and_pictures_are_there(name: str) -> None:
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert target.startswith("https://") or (DOCS / target).is_file(), target


def test_the_guide_names_every_page_in_its_order() -> None:
    text = (DOCS / "guide.md").read_text(encoding="utf-8")
    assert re.findall(r"^\d+\. \[[^]]+\]\((\w+)\.md\)", text, flags=re.MULTILINE) == list(PAGES[1:])


def test_the_guide_to_the_report_follows_the_page() -> None:
    text = (DOCS / "reading_the_report.md").read_text(encoding="utf-8")
    *headings, last = re.findall(r"^## (.+)$", text, flags=re.MULTILINE)
    assert last == "Warnings"  # above the sections of the page
    page = [section.heading for section in (CURVE, *SECTIONS)]
    shown = [next(place for place, each in enumerate(page) if each.startswith(heading)) for heading in headings]
    assert shown == sorted(shown)


@pytest.mark.long
def test_first_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every command as printed; the study file is the coarse one, so that it takes seconds."""
    monkeypatch.chdir(tmp_path)
    text = (DOCS / "first_run.md").read_text(encoding="utf-8")
    block = re.findall(r"```sh\n(.*?)```", text, flags=re.DOTALL)[0]
    names = []
    for line in block.splitlines():
        words = line.split()[1:]
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, result.output
        names.append(words[0])
        if words[0] == "new":
            quick_file(tmp_path)
    assert names == ["new", "check", "run", "report"]
    for name in ("results.nc", "report.html"):
        assert (tmp_path / "results" / name).is_file()


@pytest.mark.long
def test_harmonics_and_samples(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    text = (DOCS / "choosing_harmonics_and_samples.md").read_text(encoding="utf-8")
    script = matched(r"<!-- tested -->\n```python\n(.*?)```", text, flags=re.DOTALL).group(1)
    promised = matched(r"```text\n(.*?)```", text, flags=re.DOTALL).group(1).splitlines()
    monkeypatch.chdir(ROOT)
    exec(compile(script, "choosing_harmonics_and_samples.md", "exec"), {})
    printed = capsys.readouterr().out.splitlines()
    row = r"(\d+) harmonics, +(\d+) samples: ([\d.]+) um, ([-+][\d.]+) %"
    assert len(printed) == len(promised) == 7
    error = {}
    for line, shown in zip(printed, promised, strict=True):
        actual, reported = (matched(f"^(?:{row})$", words).groups() for words in (line, shown))
        assert actual[:2] == reported[:2]
        assert float(actual[2]) == pytest.approx(float(reported[2]), abs=0.05)
        error[int(actual[0]), int(actual[1])] = abs(float(actual[3]))
    assert error[1, 256] > error[3, 256] > error[5, 256]


@pytest.mark.slow
def test_job_script_of_the_cluster_example(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        import dask_jobqueue  # noqa: F401
    except ImportError:
        absent_tool("dask-jobqueue", 'pip install "stickslip[cluster]"')
    import runpy

    module = runpy.run_path(str(ROOT / "examples" / "cluster_sweep.py"))
    with socket.socket() as somebody_else:  # holds the dashboard's fixed port, or another process holds it already
        somebody_else.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        with contextlib.suppress(OSError):
            somebody_else.bind(("0.0.0.0", 8787))
            somebody_else.listen()
        module["main"](["--show-job"])
    script = capsys.readouterr().out
    for line in ("#SBATCH --mem=4G", "#SBATCH -t 04:00:00", "#SBATCH --job-name=stickslip", "export OMP_NUM_THREADS=1"):
        assert line in script
    assert re.search(r"distributed.cli.dask_worker tcp://\S+ .*--nthreads 1 ", script)
    assert sys.executable in script
