"""The command line as a process: signals, readers that go away, limits of the system, warnings."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from helpers import unmeasured
from sentences import printed_sentence
from stickslip.cli.process import StoppedBySignal, plain_warnings, stopping_signals
from stickslip.core.errors import StickslipWarning
from strangers import is_alive
from sweep_cases import quick_file

posix = pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX systems")
SIGNALS = ("SIGTERM", "SIGHUP")


# A command that was started with SIGHUP ignored, as nohup does, goes on; so would these if nohup started the tests.
HEARS_SIGNALS = "import signal; signal.signal(signal.SIGHUP, signal.SIG_DFL); " if os.name == "posix" else ""


def start(*arguments: object, **options: object) -> subprocess.Popen[str]:
    """The command in a process of its own, without coverage: a signal that ends it inside of the tracer would leave the
    tracer's lock behind, and the process would wait for ever."""
    command = [sys.executable, "-c", f"{HEARS_SIGNALS}from stickslip.cli.main import main; main()"]
    command += map(str, arguments)
    process: subprocess.Popen[str] = subprocess.Popen(
        command,
        stdout=-1,
        stderr=-1,
        text=True,
        env=unmeasured(),
        **options,  # type: ignore[call-overload]
    )
    return process


def wait_until(done: Callable[[], object], process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 120.0
    while not done():
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.02)


def children(process: subprocess.Popen[str]) -> list[int]:
    listed = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [int(number) for number in listed.read_text().split()] if listed.exists() else []


def require_end(numbers: list[int]) -> None:
    deadline = time.monotonic() + 20.0
    while any(is_alive(number) for number in numbers):
        assert time.monotonic() < deadline, "processes outlive the command"
        time.sleep(0.05)


@pytest.mark.long
@posix
def test_a_stopped_sweep_reports_it_and_continues(tmp_path: Path) -> None:
    """As a run that is stopped, which the next test does with each signal."""
    name, out = "SIGTERM", tmp_path / "out"
    loads = ("--vary", "preload.centrifugal_force=450:700:4", "--workers", 2)
    with start("sweep", quick_file(tmp_path), "--out", out, *loads) as process:
        wait_until(lambda: list(out.glob("cases/*/results.nc")), process)
        workers = children(process)
        process.send_signal(getattr(signal, name))
        _, printed = process.communicate(timeout=60)
    assert process.returncode == 128 + getattr(signal, name)
    assert printed.endswith(
        f"Stopped by {name}; the study is not complete. Completed cases are stored; the same command resumes with the "
        "others.\n"
    )
    assert "Traceback" not in printed
    require_end(workers)
    assert list(out.rglob(".*.part")) == []


@pytest.mark.long
@posix
@pytest.mark.parametrize("name", SIGNALS)
def test_a_stopped_run_reports_it_and_leaves_nothing(tmp_path: Path, name: str) -> None:
    out = tmp_path / "out"
    with start("run", quick_file(tmp_path), "--out", out) as process:
        assert process.stderr is not None
        while "Structure" not in process.stderr.readline():
            assert process.poll() is None
        drawing = children(process)
        process.send_signal(getattr(signal, name))
        _, printed = process.communicate(timeout=60)
    assert process.returncode == 128 + getattr(signal, name)
    assert printed.endswith(f"Stopped by {name}; the study is not complete.\n")
    require_end(drawing)
    assert [path for path in out.rglob("*") if path.suffix == ".part"] == []


@posix
def test_a_signal_that_is_ignored_stays_ignored() -> None:
    """nohup starts commands that shall outlive their terminal."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stopping_signals():
            os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


@posix
def test_the_second_signal_does_not_disturb_the_end() -> None:
    ended = []

    def stopped() -> None:
        with stopping_signals():
            try:
                os.kill(os.getpid(), signal.SIGTERM)
            finally:
                os.kill(os.getpid(), signal.SIGHUP)
                ended.append("in order")

    with pytest.raises(StoppedBySignal) as caught:
        stopped()
    assert str(caught.value) == "SIGTERM"
    assert ended == ["in order"]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@pytest.mark.long
@pytest.mark.parametrize("arguments", [["check"], ["new"], ["--help"]])
def test_a_reader_that_goes_away_is_no_error(tmp_path: Path, arguments: list[str]) -> None:
    """``stickslip check study.toml | head -1``"""
    files = {"check": [quick_file(tmp_path)], "new": [tmp_path / "new.toml"], "--help": []}[arguments[0]]
    with start(*arguments, *files) as process:
        assert process.stdout is not None
        process.stdout.close()
        process.stdout = None
        _, printed = process.communicate(timeout=120)
    assert (process.returncode, printed) == (0, "")


@pytest.mark.long
@pytest.mark.usefixtures("untraced_commands")
def test_a_run_continues_when_nobody_reads_its_output(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with start("run", quick_file(tmp_path), "--out", out) as process:
        for stream in (process.stdout, process.stderr):
            assert stream is not None
            stream.close()
        process.wait(timeout=120)
    assert process.returncode == 0
    assert (out / "results.nc").exists()
    assert (out / "report.html").exists()


@pytest.mark.long
@posix
def test_a_limit_of_file_sizes_is_found_before_solving(tmp_path: Path) -> None:
    """``(ulimit -f 1000; stickslip run study.toml --out fs)``"""
    import resource

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1_024_000, 1_024_000))

    out = tmp_path / "out"
    with start("run", quick_file(tmp_path), "--out", out, preexec_fn=limit) as process:
        _, printed = process.communicate(timeout=120)
    assert process.returncode == 2
    printed_sentence(printed.splitlines()[-1], "1.0 MB", "ulimit -f")
    assert "Response" not in printed
    assert list(out.iterdir()) == []


def test_warnings_of_the_package_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    def warn() -> None:
        with plain_warnings():
            warnings.warn("of another package", UserWarning, stacklevel=1)
            warnings.warn("the code is elsewhere.", StickslipWarning, stacklevel=1)

    with pytest.warns(UserWarning, match="of another package"):
        warn()
    assert capsys.readouterr().err == "Warning: the code is elsewhere.\n"


@pytest.mark.slow
def test_the_package_runs_as_a_module() -> None:
    outcome = subprocess.run(
        [sys.executable, "-m", "stickslip", "run", "--help"], capture_output=True, text=True, timeout=60, check=False
    )
    assert (outcome.returncode, outcome.stderr) == (0, "")
    assert outcome.stdout.startswith("Usage: stickslip run ")
