"""One table of the torture set: which curves are complete, which end early, which step over a resonance, at what cost.

    python benchmarks/torture.py FOLDER [--classes damper,light] [--seeds 0:8] [--peaks] [--no-checks]

Without options it solves all problems of all classes (torture_problems.py) with 3 harmonics and 128 samples, one after
the other, in a process of its own with a time limit. ``--peaks`` then looks for missed peaks in the completed curves
(torture_peaks.py). FOLDER receives one file for each problem, so an interrupted run resumes; use a new folder for each
version of the code and each choice of ``--harmonics``, ``--residual-traction`` and ``--no-checks``, and delete the file
of a problem to solve it again. All seconds are processor time. Work is counted in iterations of Newton's method,
searches and time integrations included (``response.provenance["solve_work"]``), the same on each machine.

A curve that is not complete is "unsettled" if a time integration at the place where it was lost does not settle on a
motion with the period of the force. It is "few harmonics" if the motion settles and the message has a larger number of
harmonics that gives this motion: the equations with the harmonics of the curve do not. Else it is "early": there a
motion exists that the curve does not have, for no known reason.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import re
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, get_args

import numpy as np
from torture_peaks import Curve, Progress, curve_of, search
from torture_problems import KINDS, SEEDS, SET_KINDS, ResidualTraction, make

import stickslip as ss

# Beside these a row may be "crashed": its process died without an answer, and stderr has the traceback.
VERDICTS = ("complete", "unsettled", "few harmonics", "early", "timed out", "crashed")
# Words of any time integration (solve/evidence.py).
INTEGRATED = "A time integration"
# Words of a time integration that found no motion with the period of the force.
UNSETTLED = ("has not settled", "repeats only after")
# Words of a settled motion that more harmonics give.
FEW_HARMONICS = re.compile(r"\d+ harmonics with \d+ samples give it")
MESSAGE_WIDTH = 150
# Wall time over the time limit at which a process that reports no progress is killed; the machine may have other work.
PATIENCE = 10.0
Row = dict[str, Any]


@dataclass(frozen=True)
class Settings:
    """What is the same in all problems of a folder."""

    harmonics: int
    residual_traction: ResidualTraction
    checks: bool = True  # stability, and the search for missed peaks of the curve itself; neither decides the verdict


class TimeLimitError(Exception):
    """A solution took more processor time than allowed."""


@dataclass(frozen=True)
class Task:
    """A problem, and its completed curve if missed peaks are to be found."""

    kind: str
    seed: int
    settings: Settings
    time_limit_seconds: float
    curve: Row | None = None

    def clock(self) -> Progress:
        """A listener that raises TimeLimitError at the time limit from now on."""
        end = time.process_time() + self.time_limit_seconds

        def progress(fraction: float, detail: str) -> None:
            if time.process_time() > end:
                raise TimeLimitError(f"the time limit was reached at: {detail}")

        return progress


def curve_row(task: Task) -> Row:
    """The response of a problem as plain data."""
    problem = make(task.kind, task.seed)
    begin = time.process_time()
    verdict, message, response = "timed out", "", None
    try:
        response = problem.solve(
            task.settings.residual_traction,
            harmonics=task.settings.harmonics,
            checks=task.settings.checks,
            progress=task.clock(),
        )
    except ss.ConvergenceError as error:
        message = str(error)
        verdict = ended(message)
    except TimeLimitError as error:
        message = str(error)
    seconds = time.process_time() - begin
    if response is None:
        return {"verdict": verdict, "points": 0, "seconds": seconds, "message": message}
    curve = curve_of(problem, response)
    return {
        "verdict": "complete" if response.converged else ended(response.message, response.warnings),
        "points": response.n_points,
        "work": int(response.provenance["solve_work"].split()[0]),
        "seconds": seconds,
        "message": response.message,
        "pairs_open": bool((response.contact_state == ss.ContactState.SEPARATING).any()),
        "curve": {
            "frequency_hz": curve.frequency_hz.tolist(),
            "amplitude": curve.amplitude.tolist(),
            "warnings": list(curve.warnings),
        },
    }


def ended(message: str, warnings: Sequence[str] = ()) -> str:
    """The verdict on a curve that is not complete: that of its message, or of its warnings if they name its gaps."""
    words = message if INTEGRATED in message else " ".join(warnings)
    if any(each in words for each in UNSETTLED):
        return "unsettled"
    return "few harmonics" if FEW_HARMONICS.search(words) else "early"


def peaks_row(task: Task) -> Row:
    """The missed peaks of a completed curve as plain data."""
    assert task.curve is not None
    problem, tested = make(task.kind, task.seed), task.curve
    curve = Curve(np.array(tested["frequency_hz"]), np.array(tested["amplitude"]), tuple(tested["warnings"]))
    begin = time.process_time()
    try:
        answer = search(problem, curve, task.settings.residual_traction, task.settings.harmonics, task.clock())
    except TimeLimitError as error:
        return {"search": None, "search_message": str(error)}
    return {"search": asdict(answer), "search_seconds": time.process_time() - begin}


def work(connection: Connection) -> None:
    """Answer tasks until the other side closes."""
    make("sdof", 3).solve()  # compiles, so that no row contains it
    connection.send("ready")
    while True:
        try:
            task = connection.recv()
        except EOFError:
            return
        connection.send(peaks_row(task) if task.curve else curve_row(task))


class Worker:
    """A process that answers one task after the other; another one replaces it after a death."""

    def __init__(self) -> None:
        self._process: Any = None

    def answer(self, task: Task) -> Row | str:
        """The row of a task; "timed out" or "crashed" without an answer."""
        if self._process is None:
            self._start()
        self._connection.send(task)
        try:
            if self._connection.poll(PATIENCE * task.time_limit_seconds):
                row: Row = self._connection.recv()
                return row
        except EOFError:
            self._stop()
            return "crashed"
        self._stop()
        return "timed out"

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._connection.close()
            self._process.join()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, other = context.Pipe()
        self._process = context.Process(target=work, args=(other,), daemon=True)
        self._process.start()
        other.close()
        self._connection.recv()  # ready

    def _stop(self) -> None:
        self._process.kill()
        self._process.join()
        self._process = None


class Results:
    """The folder with one file for each problem."""

    def __init__(self, folder: Path, settings: Settings) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._folder = folder
        present = {"version": ss.__version__} | asdict(settings)
        description = folder / "settings.json"
        if not description.exists():
            description.write_text(json.dumps(present), encoding="utf-8")
        earlier = json.loads(description.read_text(encoding="utf-8"))
        if earlier != present:
            sys.exit(f"{folder} contains results with {earlier}, but this run has {present}. Give another folder.")

    def read(self, kind: str, seed: int) -> Row | None:
        """The row of a problem, None before it has one."""
        path = self._path(kind, seed)
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None

    def write(self, row: Row) -> None:
        """Store a row, completely or not at all."""
        path = self._path(row["kind"], row["seed"])
        draft = path.with_suffix(".part")
        draft.write_text(json.dumps(row), encoding="utf-8")
        os.replace(draft, path)

    def _path(self, kind: str, seed: int) -> Path:
        return self._folder / f"{kind}-{seed:03d}.json"


def solve_all(tasks: Sequence[Task], results: Results, worker: Worker) -> None:
    """The curves that the folder does not have."""
    for count, task in enumerate(tasks, start=1):
        if results.read(task.kind, task.seed):
            continue
        answer = worker.answer(task)
        row: Row = {"verdict": answer, "points": 0, "message": ""} if isinstance(answer, str) else answer
        results.write({"kind": task.kind, "seed": task.seed} | row)
        seconds = f"{row['seconds']:.1f} s" if "seconds" in row else "no answer"
        size = f"{row['points']} points, work {row.get('work', 'unknown')}, {seconds}"
        report(f"{count}/{len(tasks)} {task.kind} {task.seed}: {row['verdict']}, {size}")


def search_all(tasks: Sequence[Task], results: Results, worker: Worker) -> None:
    """Missed peaks of the completed curves that no search tested yet."""
    for count, task in enumerate(tasks, start=1):
        row = results.read(task.kind, task.seed)
        if row is None or row["verdict"] != "complete" or "search" in row:
            continue
        answer = worker.answer(replace(task, curve=row["curve"]))
        row |= {"search": None, "search_message": answer} if isinstance(answer, str) else answer
        results.write(row)
        words = f"{len(row['search']['missed'])} missed" if row["search"] else row["search_message"]
        report(f"search {count}/{len(tasks)} {task.kind} {task.seed}: {words}")


def report(words: str) -> None:
    """Progress."""
    print(words, file=sys.stderr, flush=True)


def table(rows: Sequence[Row]) -> list[str]:
    """Lines of the table by class, with a sum."""
    head = ["class", "problems", *VERDICTS, "with missed peaks / tested"]
    head += ["points median", "points max", "seconds median", "seconds max", "work median", "work max / median, all"]
    kinds = [kind for kind in KINDS if any(row["kind"] == kind for row in rows)]
    lines = [head, ["---"] * len(head)]
    lines += [cells(kind, [row for row in rows if row["kind"] == kind]) for kind in kinds]
    lines.append(cells("all", rows))
    return ["| " + " | ".join(line) + " |" for line in lines]


def cells(name: str, rows: Sequence[Row]) -> list[str]:
    """One line: counts of all rows, points, seconds and work of the completed ones, and most work of all rows."""
    complete = [row for row in rows if row["verdict"] == "complete"]
    tested = [row["search"] for row in complete if row.get("search")]
    counts = [sum(row["verdict"] == verdict for row in rows) for verdict in VERDICTS]
    figures = []
    for key, digits in (("points", 0), ("seconds", 1)):
        values = [row[key] for row in complete]
        figures += [f"{np.median(values):.{digits}f}", f"{max(values):.{digits}f}"] if values else ["", ""]
    work = [row["work"] for row in rows if "work" in row]
    usual = float(np.median([row["work"] for row in complete])) if complete else float("nan")
    figures += [f"{usual:.0f}", f"{max(work, default=0) / usual:.1f}"]
    missed = f"{sum(bool(search['missed']) for search in tested)} / {len(tested)}"
    return [name, str(len(rows)), *map(str, counts), missed, *figures]


def opening(rows: Sequence[Row]) -> list[str]:
    """Completion of the curves where some pair opens, and of the others."""
    lines = []
    for words, opens in (("some pair opens", True), ("no pair opens", False)):
        those = [row for row in rows if row.get("pairs_open") == opens]
        complete = sum(row["verdict"] == "complete" for row in those)
        lines.append(f"Curves on which {words}: {complete} of {len(those)} are complete.")
    return lines


def failures(rows: Sequence[Row]) -> list[str]:
    """A line for each problem without a complete curve, for each missed peak, and for each search that has gaps."""
    lines = []
    for row in rows:
        name = f"{row['kind']} {row['seed']}"
        if row["verdict"] != "complete":
            # A curve with points first says how its first point converged.
            words = row["message"].partition(". ")[2] if "curve" in row else row["message"]
            lines.append(f"{name}: {row['verdict']}, {row['points']} points. {words}"[:MESSAGE_WIDTH])
        elif "search_message" in row:
            lines.append(f"{name}: not tested for missed peaks, {row['search_message']}"[:MESSAGE_WIDTH])
        elif "search" in row:
            search = row["search"]
            lines += [
                f"{name}: misses {peak['amplitude']:.3g} m at {peak['frequency_hz']:.3f} Hz; its highest amplitude "
                f"near it is {peak['tested_amplitude']:.3g} m"
                for peak in search["missed"]
            ]
            if search["incomplete"]:
                lines.append(f"{name}: {search['incomplete']} of {search['curves']} curves of the search end early")
    return lines


def class_names(text: str) -> list[str]:
    """Classes of the command line. Raises ArgumentTypeError for a name that no class has."""
    names = text.split(",")
    unknown = sorted(set(names) - set(KINDS))
    if unknown:
        raise argparse.ArgumentTypeError(f"no class is named {', '.join(unknown)}; allowed: {', '.join(KINDS)}.")
    return names


def seed_range(text: str) -> range:
    """Seeds of the command line. Raises ArgumentTypeError unless they are FIRST:END."""
    first, _, end = text.partition(":")
    if not (first.isdigit() and end.isdigit() and int(first) < int(end)):
        raise argparse.ArgumentTypeError(f"{text} must be FIRST:END with FIRST below END, for example 0:8.")
    return range(int(first), int(end))


def chosen(kinds: Sequence[str], seeds: range | None) -> list[tuple[str, int]]:
    """The problems of some classes: the first seed of each class, then the second, and so on."""
    problems = [(seed, kind) for kind in kinds for seed in (seeds or SEEDS[kind])]
    return [(kind, seed) for seed, kind in sorted(problems, key=lambda each: each[0])]


def main() -> None:
    """Solve, check, print."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--classes", type=class_names, default=SET_KINDS, help="names with commas; default: all of the set"
    )
    words = "FIRST:END, for example 0:8; default: 0:14, and 0:60 of the class narrow"
    parser.add_argument("--seeds", type=seed_range, help=words)
    parser.add_argument("--harmonics", type=int, default=3)
    parser.add_argument("--residual-traction", choices=get_args(ResidualTraction), default="released")
    parser.add_argument("--peaks", action="store_true", help="look for missed peaks in the completed curves")
    words = "curves without multipliers and without their own search for missed peaks: the same verdicts in less time"
    parser.add_argument("--no-checks", action="store_true", help=words)
    words = "seconds of each curve, and of each search; default: %(default)g"
    parser.add_argument("--time-limit", type=float, default=60.0, help=words)
    options = parser.parse_args()
    if options.peaks and options.no_checks:
        parser.error("--peaks needs the warnings of the curves, which --no-checks leaves out.")
    settings = Settings(options.harmonics, options.residual_traction, not options.no_checks)
    tasks = [Task(*each, settings, options.time_limit) for each in chosen(options.classes, options.seeds)]
    results, worker = Results(options.folder, settings), Worker()
    solve_all(tasks, results, worker)
    if options.peaks:
        search_all(tasks, results, worker)
    worker.close()
    rows = [row for row in (results.read(task.kind, task.seed) for task in tasks) if row is not None]
    rows.sort(key=lambda row: (KINDS.index(row["kind"]), row["seed"]))
    print("\n".join([*table(rows), "", *opening(rows), "", *failures(rows)]))


if __name__ == "__main__":
    main()
