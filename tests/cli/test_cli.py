"""The command line with a stand-in for the study module: files, exit codes, sentences, and what is printed where."""

import os
import stat
import subprocess
import sys
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import stickslip
from sentences import printed_sentence
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.cli import errors as cli_errors
from stickslip.cli import main as cli
from stickslip.core.errors import ConvergenceError, ResultsFileError, RoughnessError
from stickslip.core.progress import Progress


@dataclass
class Outcome:
    """Stand-in for study.StudyOutcome."""

    files: tuple[Path, ...] = (Path("results.nc"), Path("report.html"))
    converged: bool = True
    message: str = "The curve has 61 points."
    response: Any = None


@dataclass
class Study:
    """Stand-in for the study module; notes the calls, and raises ``error`` if it has one."""

    outcome: Outcome = field(default_factory=Outcome)
    error: BaseException | None = None
    calls: list[tuple[Any, ...]] = field(default_factory=list)

    def unreported_run(self, case: Case, out_dir: Path, progress: Progress, threads: int | None) -> Outcome:
        """Two stages, then the outcome."""
        self.threads = threads
        self.calls.append(("run", case, out_dir))
        progress.update("Mesh", 1.0, "5005 nodes")
        progress.update("Curve", 0.5, "484 Hz")
        if self.error:
            raise self.error
        return self.outcome

    def check(self, case: Case, assembled: Any) -> list[tuple[str, list[tuple[str, str]]]]:
        """Two sections."""
        if self.error:
            raise self.error
        return [("Sizes", [("nodes", "5005"), ("contact pairs", "110")]), ("Warnings", [])]

    def report(self, folder: Path) -> tuple[Path, ...]:
        """One file."""
        if self.error:
            raise self.error
        return (folder / "report.html",)


@pytest.fixture
def study(monkeypatch: pytest.MonkeyPatch) -> Study:
    """The stand-in, in place of the functions of stickslip.study.run and stickslip.study.check."""
    import_module("stickslip.sweeps.again")  # it keeps what it imports from stickslip.study.run by name
    fake = Study()
    for name in ("unreported_run", "report"):
        monkeypatch.setattr(f"stickslip.study.run.{name}", getattr(fake, name))
    monkeypatch.setattr("stickslip.study.assembled.Assembled.of", lambda case: None)
    monkeypatch.setattr("stickslip.study.check.check", fake.check)
    monkeypatch.setattr("stickslip.study.proposal.proposed_section", lambda case, assembled: ("A sensible study", []))
    return fake


@pytest.fixture
def study_file(tmp_path: Path) -> Path:
    """A study file with every default."""
    path = tmp_path / "study.toml"
    path.write_text(Case().to_text(), encoding="utf-8")
    return path


def invoke(*arguments: object) -> Any:
    """Run the command line in this process."""
    return CliRunner().invoke(cli.app, [str(each) for each in arguments])


def test_new_writes_a_file_that_check_accepts(study: Study, tmp_path: Path) -> None:
    path = tmp_path / "folder" / "blade.toml"
    assert invoke("new", path).exit_code == 0
    assert path.read_text(encoding="utf-8") == Case.from_mapping(EXAMPLES["two-blade"]).to_text()
    assert invoke("check", path).exit_code == 0


def test_new_rejects_to_overwrite_unless_forced(study_file: Path) -> None:
    study_file.write_text("precious", encoding="utf-8")
    result = invoke("new", study_file)
    assert result.exit_code == 2
    printed_sentence(result.stderr, "--force")
    assert study_file.read_text(encoding="utf-8") == "precious"
    assert invoke("new", study_file, "--force").exit_code == 0
    assert study_file.read_text(encoding="utf-8") == Case.from_mapping(EXAMPLES["two-blade"]).to_text()


def test_new_into_a_place_that_cannot_be_written(study_file: Path) -> None:
    result = invoke("new", study_file / "blade.toml")
    assert result.exit_code == 2
    printed_sentence(result.stderr, str(study_file))


def test_check_prints_the_sections(study: Study, study_file: Path) -> None:
    result = invoke("check", study_file)
    assert result.exit_code == 0
    assert result.stdout == "\nSizes\n  nodes          5005\n  contact pairs  110\n\nWarnings\n\nA sensible study\n"
    assert result.stderr == ""


def test_defaults_that_were_used_are_named(study: Study, tmp_path: Path) -> None:
    path = tmp_path / "short.toml"
    path.write_text("[friction]\ncoefficient = 0.2\n[preload]\ncentrifugal_force = 20\n", encoding="utf-8")
    result = invoke("check", path)
    printed_sentence(result.stderr, "[study]", "[geometry]", "preload.friction_coefficient_at_assembly")
    assert "[friction]" not in result.stderr


def test_run_passes_the_case_and_names_the_files(study: Study, study_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    result = invoke("run", study_file, "--out", out)
    assert result.exit_code == 0
    assert study.calls == [("run", Case.from_text(Case().to_text()), out)]
    assert out.is_dir()
    assert list(out.iterdir()) == []
    assert result.stdout == "Wrote results.nc\nWrote report.html\nThe curve has 61 points.\n"
    assert result.stderr.splitlines() == ["Mesh ...", "Mesh: 5005 nodes", "Curve ..."]


@pytest.mark.parametrize("key", ["preload.centrifugal_force", "centrifugal_force"])
def test_run_with_a_ridge_changes_the_analysis(study: Study, study_file: Path, tmp_path: Path, key: str) -> None:
    option = f"{key} = 50 N : 5 kN"
    assert invoke("run", study_file, "--out", tmp_path / "out", "--ridge", option, "--quiet").exit_code == 0
    ((_, case, _),) = study.calls
    analysis = case.to_dict()["analysis"]
    assert analysis["kind"] == "ridge"
    assert [analysis[name] for name in ("over", "over_from", "over_to")] == [
        "preload.centrifugal_force", "50 N", "5 kN",
    ]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("option", ["preload.centrifugal_force", "friction.coefficient=0.2", "=1:2", "a.b=1:"])
def test_a_ridge_of_another_form_is_rejected(study: Study, study_file: Path, tmp_path: Path, option: str) -> None:
    result = invoke("run", study_file, "--out", tmp_path / "out", "--ridge", option)
    assert (result.exit_code, study.calls) == (2, [])
    printed_sentence(result.stderr, option)


@pytest.mark.parametrize(
    "option",
    [
        "preload.nonsense=50 N:5 kN", "excitation.mode=1:2", "solver.tolerance=1e-3:1e-2",
        "preload.centrifugal_force=5 kN:50 N", "preload.centrifugal_force=50 m:5 km", "friction.coefficient=0.2:20",
    ],
)  # fmt: skip
def test_a_ridge_that_cannot_be_is_rejected_before_anything_else(
    study: Study, study_file: Path, tmp_path: Path, option: str
) -> None:
    result = invoke("run", study_file, "--out", tmp_path / "out", "--ridge", option)
    assert (result.exit_code, study.calls) == (2, [])
    assert not (tmp_path / "out").exists()
    printed_sentence(result.stderr, option.partition("=")[0])


def test_quiet_run_prints_nothing(study: Study, study_file: Path, tmp_path: Path) -> None:
    result = invoke("run", study_file, "--out", tmp_path / "out", "--quiet")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")


def test_not_converged_keeps_and_names_the_results(study: Study, study_file: Path, tmp_path: Path) -> None:
    study.outcome = Outcome(converged=False, message="The step became too small at 482 Hz.")
    result = invoke("run", study_file, "--out", tmp_path / "out", "--quiet")
    assert result.exit_code == 3
    printed_sentence(result.stderr, "482 Hz", "results.nc", "report.html")
    assert result.stdout == ""


def test_no_first_point_is_exit_3(study: Study, study_file: Path, tmp_path: Path) -> None:
    study.error = ConvergenceError("No first point at 440 Hz. Take a start further from the peak.")
    result = invoke("run", study_file, "--out", tmp_path / "out")
    assert result.exit_code == 3
    assert result.stderr.rstrip().endswith(str(study.error))


@pytest.mark.slow
@pytest.mark.parametrize("command", ["run", "check"])
def test_input_error_from_the_computation(study: Study, study_file: Path, tmp_path: Path, command: str) -> None:
    study.error = RoughnessError("The contact is fully plastic, its stiffness zero. Raise the load.")
    result = invoke(command, study_file, *(["--out", tmp_path / "out"] if command == "run" else []))
    assert result.exit_code == 2
    assert result.stderr.rstrip().endswith(str(study.error))
    assert "Traceback" not in result.stderr


def test_fault_writes_its_traceback_into_the_folder(study: Study, study_file: Path, tmp_path: Path) -> None:
    study.error = ZeroDivisionError("division by zero")
    out = tmp_path / "out"
    result = invoke("run", study_file, "--out", out)
    log = out / cli_errors.LOG_NAME
    assert result.exit_code == 1
    assert "Traceback" not in result.stderr
    printed_sentence(result.stderr, str(log))
    assert "ZeroDivisionError: division by zero" in log.read_text(encoding="utf-8")


@pytest.mark.slow
def test_fault_without_folder_points_to_debug(study: Study, study_file: Path) -> None:
    study.error = ZeroDivisionError("division by zero")
    result = invoke("check", study_file)
    assert result.exit_code == 1
    printed_sentence(result.stderr, "--debug")
    assert "Traceback" not in result.stderr
    assert "Traceback" in invoke("check", study_file, "--debug").stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("error", "code"),
    [(OSError(28, "No space left on device"), 1), (MemoryError(), 2), (KeyboardInterrupt(), 130)],
)
def test_troubles_of_the_machine(
    study: Study, study_file: Path, tmp_path: Path, error: BaseException, code: int
) -> None:
    study.error = error
    result = invoke("run", study_file, "--out", tmp_path / "out")
    assert result.exit_code == code
    printed_sentence(result.stderr)
    assert "Fault" not in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    "words",
    [("report", "a" * 5000), ("import", "a" * 5000 + ".inp"), ("export", "a" * 5000), ("new", "a" * 5000 + ".toml")],
    ids=lambda words: words[0],
)
def test_a_name_too_long_for_any_disk_is_rejected(words: tuple[str, str]) -> None:
    result = invoke(*words)
    assert result.exit_code == 2
    printed_sentence(result.stderr)
    assert len(result.stderr) < 400


def test_a_path_without_permission_is_rejected(study: Study, study_file: Path) -> None:
    """Root may read everywhere, so the error of the system stands in."""
    study.error = PermissionError(13, "Permission denied", "/closed/deck.inp")
    result = invoke("check", study_file)
    assert result.exit_code == 2
    printed_sentence(result.stderr)


def test_output_folder_that_cannot_be_made(study: Study, study_file: Path) -> None:
    result = invoke("run", study_file, "--out", study_file / "out")
    assert result.exit_code == 2
    printed_sentence(result.stderr, str(study_file / "out"))
    assert study.calls == []


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_output_folder_that_cannot_be_written(study: Study, study_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "locked"
    out.mkdir()
    out.chmod(stat.S_IRUSR | stat.S_IXUSR)
    result = invoke("run", study_file, "--out", out)
    assert result.exit_code == 2
    assert str(out) in result.stderr
    assert study.calls == []


def test_output_folder_that_rejects_files(
    study: Study, study_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def reject(**_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", reject)
    result = invoke("run", study_file, "--out", tmp_path)
    assert result.exit_code == 2
    printed_sentence(result.stderr, str(tmp_path))
    assert study.calls == []


def test_report_names_its_files(study: Study, tmp_path: Path) -> None:
    result = invoke("report", tmp_path)
    assert (result.exit_code, result.stdout) == (0, f"Wrote {tmp_path / 'report.html'}\n")


def test_report_of_another_version(study: Study, tmp_path: Path) -> None:
    study.error = ResultsFileError("results.nc was written by version 9 of the format; this program reads 1.")
    result = invoke("report", tmp_path)
    assert result.exit_code == 2
    assert result.stderr == f"Error: {study.error}\n"


def test_report_of_no_folder(study: Study, tmp_path: Path) -> None:
    result = invoke("report", tmp_path / "nowhere")
    assert result.exit_code == 2
    printed_sentence(result.stderr, "nowhere")
    assert not (tmp_path / "nowhere").exists()


def test_threads_reach_the_study(study: Study, study_file: Path, tmp_path: Path) -> None:
    assert invoke("run", study_file, "--out", tmp_path / "out").exit_code == 0
    assert study.threads is None
    assert invoke("run", study_file, "--out", tmp_path / "out", "--threads", "2").exit_code == 0
    assert study.threads == 2
    assert invoke("run", study_file, "--out", tmp_path / "out", "--threads", "0").exit_code == 2  # type: ignore[unreachable]


@pytest.mark.slow
def test_real_process_rejects_bad_input_without_traceback(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text("[material]\ndensity = -1\n", encoding="utf-8")
    result = _stickslip("run", str(path), "--out", str(tmp_path / "out"))
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr == (
        f"Error: {path}: 1 error.\n  line 2: material.density = -1 is not allowed: a value above 0 kg/m^3 is needed.\n"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_help_and_version() -> None:
    text = _stickslip("--help").stdout
    for command in ("new", "check", "run", "report"):
        assert f"\n  {command} " in text
    assert _stickslip("--version").stdout == f"stickslip {stickslip.__version__}\n"


def _stickslip(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    code = "from stickslip.cli.main import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )


@pytest.mark.parametrize("command", ["run", "sweep", "paper", "roughness"])
def test_an_empty_folder_is_rejected(study: Study, study_file: Path, command: str, tmp_path: Path) -> None:
    """An empty text would be the current folder: a script whose variable is not set writes nothing there."""
    more = ["--vary", "friction.coefficient=0.2,0.3"] if command == "sweep" else []
    result = invoke(command, *([] if command == "paper" else [study_file]), *more, "--out", "")
    assert result.exit_code == 2
    printed_sentence(" ".join(result.stderr.split()).partition("Error: ")[2], "--out")
    assert study.calls == []


def test_threads_of_the_environment_are_checked_first(
    study: Study, study_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "0")
    result = invoke("check", study_file)
    assert result.exit_code == 2
    printed_sentence(result.stderr, "NUMBA_NUM_THREADS")


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "run"])
def test_the_real_solver_does_not_meet_numba_without_threads(tmp_path: Path, command: str) -> None:
    path = tmp_path / "study.toml"
    path.write_text(Case().to_text(), encoding="utf-8")
    more = ["--out", str(tmp_path / "out")] if command == "run" else []
    result = _stickslip(command, str(path), *more, NUMBA_NUM_THREADS="0")
    assert result.returncode == 2
    printed_sentence(result.stderr, "NUMBA_NUM_THREADS", "'0'")
    assert not (tmp_path / "out").exists()
