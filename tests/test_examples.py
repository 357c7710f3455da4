"""Examples and the README run as a reader would run them, and print what they promise."""

from __future__ import annotations

import glob
import math
import re
import runpy
import shlex
import shutil
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

import stickslip as ss
from helpers import matched
from stickslip.cli.main import app
from stickslip.papers.rough_damper.plan import Scope, computations
from sweep_cases import COARSE_MESH, quick_file

ROOT = Path(__file__).parents[1]
# Commands of guides run with few points each; other tests read numbers of sweeps.
BELOW_THE_PEAK = {"frequency_stop": "446 Hz", "samples": 64}
READ_BY_USERS = [
    *sorted(ROOT.glob("examples/*.py")),
    *sorted(ROOT.glob("docs/*.py")),
    *sorted(ROOT.glob("docs/*.md")),
    ROOT / "README.md",
]
ROOMS = sorted(path.name for path in (ROOT / "src" / "stickslip").iterdir() if path.is_dir())


@pytest.mark.parametrize("path", READ_BY_USERS, ids=lambda path: path.name)
def test_users_import_the_public_package_and_nothing_deeper(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert not re.findall(r"^ *(?:from|import) stickslip\..*", text, flags=re.MULTILINE)
    assert not re.findall(rf"\bstickslip\.(?:{'|'.join(ROOMS)})\b.*", text)


@pytest.mark.long
def test_own_matrices(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    module = runpy.run_path("examples/own_matrices.py")
    numbers = module["main"]()
    printed = capsys.readouterr().out
    assert "um" in printed
    assert numbers["peak"] == pytest.approx(218.8e-6, rel=1e-3)
    assert numbers["peak_frequency_hz"] == pytest.approx(687.1, abs=0.6)
    assert (numbers["slipping"], numbers["separating"]) == (7, 2)
    assert abs(numbers["difference"]) < 3e-3


@pytest.mark.long
def test_joint_laws(capsys: pytest.CaptureFixture[str]) -> None:
    actual = runpy.run_path(str(ROOT / "examples" / "joint_laws.py"))["main"]()
    assert "0.2 N: peak at" in capsys.readouterr().out
    frequencies, energies = zip(*actual.values(), strict=True)
    assert frequencies == pytest.approx((1837.1, 1835.3, 1831.3), abs=0.3)  # the joints soften
    # friction grows with a power of the force between 1 (sliding) and 2.5 (microslip of this joint, exponent + 3)
    assert all(2.0 < more / less < 2.0**2.5 for less, more in pairwise(energies))


@pytest.mark.long
def test_measured_roughness(capsys: pytest.CaptureFixture[str]) -> None:
    module = runpy.run_path(str(ROOT / "examples" / "measured_roughness.py"))
    fit = module["main"]()
    assert "true value 2.4" in capsys.readouterr().out
    for name, true in (("fractal_dimension", 2.4), ("fractal_roughness", 1e-9)):
        low, high = getattr(fit, f"{name}_interval")
        assert low < true < high
    stored = module["DATA"].read_text(encoding="utf-8").splitlines()[2:]
    recipe = module["make_profile"]().splitlines()[2:]
    numbers = [[float(word) for line in text for word in line.split(",")] for text in (stored, recipe)]
    assert numbers[0] == pytest.approx(numbers[1], abs=2e-4)  # the last digit of um may round otherwise elsewhere


@pytest.mark.long
def test_roughness_page_shows_what_the_command_prints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs" / "roughness.md").read_text(encoding="utf-8")
    command = matched(r"^stickslip (roughness .+)$", page, flags=re.MULTILINE).group(1)
    promised = matched(r"```text\n(.*?)```", page, flags=re.DOTALL).group(1)
    words = command.replace("examples/", f"{ROOT}/examples/").split()
    monkeypatch.chdir(tmp_path)
    printed = CliRunner().invoke(app, words).stdout
    numbers = r"\d+(?:\.\d+)?(?:e[-+]\d+)?"
    assert re.sub(numbers, "", printed).replace("\\", "/") == re.sub(numbers, "", promised)
    for one, other in zip(re.findall(numbers, printed), re.findall(numbers, promised), strict=True):
        assert float(one) == pytest.approx(float(other), rel=0.02)


@pytest.mark.long
def test_two_blades(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """On a coarse mesh."""
    load_case = ss.load_case
    monkeypatch.setattr(ss, "load_case", lambda path: load_case(path).replace(COARSE_MESH))
    module = runpy.run_path(str(ROOT / "examples" / "two_blades.py"))
    peaks = module["main"](harmonics=1, samples=64)
    # Same direction works hardest on the first mode; opposite excites the stiffer second one.
    assert peaks["same"] > peaks["single"] > peaks["opposite"]
    assert capsys.readouterr().out.count("0-to-peak") == 3


@pytest.mark.long
def test_readme_python_block(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", readme, flags=re.DOTALL)
    assert len(blocks) == 1
    monkeypatch.chdir(ROOT)
    exec(compile(blocks[0], "README.md", "exec"), {})
    amplitude = float(matched(r"([\d.]+) um", capsys.readouterr().out).group(1))
    assert 190.0 < amplitude < 205.0


@pytest.mark.long
def test_the_page_on_rotation_runs(capsys: pytest.CaptureFixture[str]) -> None:
    page = (ROOT / "docs" / "theory_rotation.md").read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL):
        exec(compile(block, "theory_rotation.md", "exec"), names)
    printed = capsys.readouterr().out
    # A crossing of order k is at k W / 60 in Hz.
    at = float(matched(r"mode 1 meets engine order 4 at (\d+) rpm", printed).group(1))
    assert 4.0 * at / 60.0 == pytest.approx(545.3, abs=1.0)
    assert len(re.findall(r"\d+ rpm: [\d.]+ um", printed)) == 2


@pytest.mark.long
def test_readme_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The commands run as printed, after the first one on a coarse mesh; only the published study is too long."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("stickslip.sweeps.run.usable_cores", lambda: 1)
    shutil.copytree(ROOT / "examples" / "data", tmp_path / "examples" / "data")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = "".join(re.findall(r"```sh\n(.*?)```", readme, flags=re.DOTALL))
    commands = re.findall(r"^stickslip ([^#\n]+)", blocks, flags=re.MULTILINE)
    assert [line.split()[0] for line in commands] == [
        "new",
        "check",
        "run",
        "report",
        "export",
        "roughness",
        "sweep",
        "band",
        "paper",
    ]
    for line in commands[:-1]:
        result = CliRunner().invoke(app, shlex.split(line))
        assert result.exit_code == 0, result.output
        if line.startswith("new"):
            quick_file(tmp_path, **BELOW_THE_PEAK)
    assert (tmp_path / "results" / "report.html").is_file()
    assert len(list(tmp_path.glob("sweep/cases/*/results.nc"))) == 20


def documented_commands() -> list[str]:
    """Every command of the README and the guide, in a block or in a sentence, without its comment."""
    actual = []
    for page in [ROOT / "README.md", ROOT / "examples" / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        text = page.read_text(encoding="utf-8")
        blocks = "".join(re.findall(r"```sh\n(.*?)```", text, flags=re.DOTALL))
        actual += re.findall(r"^stickslip ([^#\n]+)", blocks, flags=re.MULTILINE)
        actual += re.findall(
            r"`(?:\.venv/bin/)?stickslip ([a-z]+ [^`]*)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        )
    return sorted({" ".join(line.split()) for line in actual})


@pytest.mark.long
@pytest.mark.parametrize("line", documented_commands())
def test_documented_commands_are_understood(line: str) -> None:
    """Name, options and kinds of values are those of the program. "[--workers 2]" marks what may be left out."""
    name, *words = shlex.split(line.replace("[", "").replace("]", ""))
    group = typer.main.get_command(app)
    group.commands[name].make_context(name, words)  # type: ignore[attr-defined]


def test_the_index_of_the_examples_has_one_command_for_each() -> None:
    """In the first argument of the command; :func:`documented_commands` has those of stickslip."""
    text = (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"^\| [^|]+ \| `((?:python|stickslip run) [^`]+)` \|$", text, flags=re.MULTILINE)
    assert len(commands) == len(re.findall(r"^\|", text, flags=re.MULTILINE)) - 2  # heading and rule
    listed = [next(word for word in shlex.split(command) if word.startswith("examples/")) for command in commands]
    scripts = [*ROOT.glob("examples/*.py"), *ROOT.glob("examples/**/*.toml")]
    assert sorted(listed) == sorted(path.relative_to(ROOT).as_posix() for path in scripts)


@pytest.mark.slow
def test_the_readme_counts_the_curves_of_the_published_study() -> None:
    readme, guide = ((ROOT / page).read_text(encoding="utf-8") for page in ("README.md", "docs/paper_study.md"))
    count = len(computations(Scope()))
    assert f"# {count} curves" in readme
    assert f" {count} curves of" in guide


@pytest.mark.long
def test_guide_to_sweeps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The commands of docs/sweeps.md run as printed, in one process and on a coarse mesh; so does its script."""
    guide = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("stickslip.sweeps.run.usable_cores", lambda: 1)
    runner, block = CliRunner(), re.findall(r"```sh\n(.*?)```", guide, flags=re.DOTALL)[0]
    for line in block.splitlines():
        words = [next(iter(sorted(glob.glob(word))), word) for word in shlex.split(line)[1:]]
        result = runner.invoke(app, ["1" if before == "--workers" else word for before, word in pairwise(["", *words])])
        assert result.exit_code == 0, result.output
        if words[0] == "new":
            quick_file(tmp_path, **BELOW_THE_PEAK)
    assert len(list(tmp_path.glob("loads/cases/*/results.nc"))) == 5
    assert len(list(tmp_path.glob("loads/cases/*/report.html"))) == 5
    assert len(list(tmp_path.glob("modes/cases/*/results.nc"))) == 6
    script = re.findall(r"<!-- tested -->\n```python\n(.*?)```", guide, flags=re.DOTALL)[0]
    exec(compile(script, "sweeps.md", "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out.count("0-to-peak") == 4
    options = runner.invoke(app, ["sweep", "--help"]).output
    for option in set(re.findall(r"--(?:vary|out|workers|scheduler|threads)", guide)):
        assert option in options


@pytest.mark.long
def test_guide_to_bands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The script of docs/band.md on a coarse mesh; the options of its command."""
    guide = (ROOT / "docs" / "band.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    quick_file(tmp_path)
    script = re.findall(r"<!-- tested -->\n```python\n(.*?)```", guide, flags=re.DOTALL)[0]
    exec(compile(script, "band.md", "exec"), {"__name__": "__main__"})
    printed = capsys.readouterr().out
    assert "90 % of the samples between" in printed
    assert "is exceeded by 0 of 8 samples" in printed
    options = CliRunner().invoke(app, ["band", "--help"]).output
    for option in set(re.findall(r"--(?:scatter|limit|samples|out|workers|scheduler|threads)", guide)):
        assert option in options


@pytest.mark.long
def test_guide_to_designs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The script of docs/design.md on a coarse mesh; the options of its command."""
    guide = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    quick_file(tmp_path, frequency_start="360 Hz", frequency_stop="520 Hz")
    script = re.findall(r"<!-- tested -->\n```python\n(.*?)```", guide, flags=re.DOTALL)[0]
    exec(compile(script, "design.md", "exec"), {"__name__": "__main__"})
    assert re.search(r"^\d+ N: peak [\d.]+ um$", capsys.readouterr().out, flags=re.MULTILINE)
    assert (tmp_path / "best" / "optimum.toml").is_file()
    options = CliRunner().invoke(app, ["design", "--help"]).output
    for option in set(
        re.findall(r"--(?:over|minimise|subject-to|worst-of|samples|starts|out|workers|scheduler)", guide)
    ):
        assert option in options


@pytest.mark.slow
def test_guide_to_matrices(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    guide = (ROOT / "docs" / "matrices.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    script = re.findall(r"<!-- tested -->\n```python\n(.*?)```", guide, flags=re.DOTALL)[0]
    exec(compile(script, "matrices.md", "exec"), {"__name__": "__main__"})
    printed = capsys.readouterr().out
    assert "108 unknowns reduced to 37 with 9 boundary nodes" in printed
    assert printed.count("the file contains only the lower triangle") == 2


def test_guide_to_loops(capsys: pytest.CaptureFixture[str]) -> None:
    guide = (ROOT / "docs" / "loops.md").read_text(encoding="utf-8")
    script = re.findall(r"<!-- tested -->\n```python\n(.*?)```", guide, flags=re.DOTALL)[0]
    exec(compile(script, "loops.md", "exec"), {"__name__": "__main__"})
    printed = capsys.readouterr().out
    assert printed == re.findall(r"```text\n(.*?)```", guide, flags=re.DOTALL)[0]


def write_loops(path: Path) -> None:
    """Loops of 1 mm of a slider with a limit of 50 N on a spring of 500 N/mm."""
    slider, rows = 0.0, ["displacement [mm], force [N]"]
    for step in range(601):
        x = math.sin(2.0 * math.pi * step / 200.0)
        slider = min(max(slider, x - 0.1), x + 0.1)
        rows.append(f"{x:.6f}, {500.0 * (x - slider):.6f}")
    path.write_text("\n".join(rows), encoding="utf-8")


@pytest.mark.slow
def test_command_of_the_guide_to_loops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_loops(tmp_path / "loops.csv")
    guide = (ROOT / "docs" / "loops.md").read_text(encoding="utf-8")
    result = CliRunner().invoke(app, shlex.split(re.findall(r"^stickslip (fit [^#\n]+)", guide, flags=re.MULTILINE)[0]))
    assert result.exit_code == 0, result.output
    assert "50 N" in result.output


def test_make_targets_of_the_readme_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"^make (\w+)", (ROOT / "README.md").read_text(encoding="utf-8"), flags=re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), target


@pytest.mark.long
def test_guide_to_own_structures(tmp_path: Path) -> None:
    """The study file of docs/studies.md is the example, and its commands exist; the example runs."""
    guide = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    study = ROOT / "examples" / "own_mesh" / "study.toml"
    assert matched(r"```toml\n(.*?)```", guide, flags=re.DOTALL).group(1) == study.read_text(encoding="utf-8")
    runner = CliRunner()
    for command in re.findall(r"^stickslip (\w+)", guide, flags=re.MULTILINE):
        assert runner.invoke(app, [command, "--help"]).exit_code == 0
    result = runner.invoke(app, ["run", str(study), "--out", str(tmp_path / "results")])
    assert result.exit_code == 0, result.output
    assert "The curve reached the stop frequency." in result.output
    assert (tmp_path / "results" / "contact_pairs.vtu").is_file()
