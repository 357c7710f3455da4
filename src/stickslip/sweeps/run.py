"""A sweep from its keys to its table: plan, finished cases, checks, other cases, table and page."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, wait
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.case.case import Case
from stickslip.core.errors import InputError, StickslipError, WorkersError
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import usable_cores
from stickslip.core.validation import whole_number
from stickslip.model.model import kind_of, load_joint, set_up
from stickslip.reporting.linear_limits import differing_limits
from stickslip.reporting.sweep_page import write_sweep_page
from stickslip.reporting.sweep_view import SweepView
from stickslip.reporting.templates import StudyText
from stickslip.results.record import run_provenance
from stickslip.results.sweep_table import SweepCurve, SweepRow, SweepTable
from stickslip.study.analyses import SOLVED_AGAIN, again_because
from stickslip.sweeps.axes import Vary, swept_keys
from stickslip.sweeps.folder import SweepFolder
from stickslip.sweeps.plan import PlannedCase, plan_cases, plan_table
from stickslip.sweeps.pool import InProcess, LocalProcesses, SizedExecutor, WorkerDied
from stickslip.sweeps.record import SWEEP_FILE, StoredCase, SweepRecord, extended, store_record
from stickslip.sweeps.schedule import CHECK_SECONDS, Schedule, StructureGroup
from stickslip.sweeps.work import CaseOutcome, CaseTask, worker_version

TABLE_FILE = "sweep.csv"
DATASET_FILE = "sweep.nc"
PAGE_FILE = "sweep.html"
# chosen: tasks of an executor of the caller at a time, if the caller does not give its number of workers.
TASKS_AT_A_TIME = 64


@dataclass(frozen=True, eq=False)
class Sweep:
    """The result of a sweep.

    table:
        one row for each case; ``table.to_csv(path)``, ``table.to_dataset()``, ``table.column(name)``.
    curves:
        amplitude curve of each row, None for a case without result.
    case_files:
        results file of each row, None for a case without one.
    files:
        table as CSV and NetCDF, and the page.
    reused:
        number of cases that an earlier sweep had finished.
    notices:
        messages on files that could not be used.
    remarks:
        messages on all cases together, such as linear limits that differ between them.
    """

    table: SweepTable
    curves: tuple[SweepCurve | None, ...]
    case_files: tuple[Path | None, ...]
    files: tuple[Path, ...]
    reused: int
    notices: tuple[str, ...]
    remarks: tuple[str, ...]


def sweep(
    case: Case,
    vary: Vary,
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    workers: int | None = None,
    threads: int = 1,
) -> Sweep:
    """Solve a case for every combination of the values of some of its keys.

    Parameters
    ----------
    case:
        the case from which all others are made.
    vary:
        "section.key" -> values as in a study file (300, "300 N", "single"), or one text with a comma list and ranges
        "start:stop:count" or "start:stop:count:log". The last key runs fastest.
    executor:
        any ``concurrent.futures.Executor``, for example that of a Dask cluster; by default processes of this machine.
    out:
        folder for results files, tables and page. A sweep into a folder with finished cases of the same inputs and
        version does not solve these again; it adds its cases to those of the table. Without a folder nothing is
        written.
    workers:
        local processes, by default one for each usable processor; 1 solves in this process. With ``executor`` the
        number of its workers: it receives twice as many tasks at a time (by default 64 tasks).
    threads:
        threads of each worker.

    Raises
    ------
    InputError
        for keys, values or cases that are not valid, before anything is solved. ResultsFileError where files cannot be
        written. A case that fails raises nothing: its row has the message.
    """
    keys = swept_keys(vary, case)
    if out is None:
        planned = plan_cases(case, keys)
    else:
        keys, planned = plan_table(case, *extended(Path(out), case, keys), SweepFolder(Path(out)).folder_names())
    files = (TABLE_FILE, DATASET_FILE, PAGE_FILE, SWEEP_FILE)
    run = solve_planned(planned, out, files, executor, progress, workers=workers, threads=threads)
    table = SweepTable(keys, tuple(run.row(each) for each in planned))
    curves = tuple(run.outcomes[each.key].curve for each in planned)
    forces = np.array([kind_of(each.case).force_amplitude(each.case) for each in planned])
    view = SweepView(table, curves, forces)
    written = () if run.folder is None else _written(run.folder, case, view, planned)
    case_files = tuple(run.folder.path / row.file if run.folder and row.file else None for row in table.rows)
    return Sweep(table, curves, case_files, written, run.reused, tuple(run.notices), differing_limits(view))


def solve_planned(
    planned: tuple[PlannedCase, ...],
    out: str | PathLike[str] | None,
    files: tuple[str, ...],
    executor: Executor | None,
    progress: Progress | None,
    *,
    workers: int | None,
    threads: int,
) -> SolvedCases:
    """Solve planned cases that differ from each other, with any executor; resumes in the folder ``out``.

    ``files`` are the names of the files that the caller writes there; the other arguments are those of :func:`sweep`.
    """
    for name, number in (("workers", workers), ("threads", threads)):
        if number is not None:
            whole_number(name, number, 1)
    folder = None if out is None else SweepFolder(Path(out))
    if folder is not None:
        folder.make(files)
    run = SolvedCases(planned, folder, progress or SilentProgress())
    run.find_finished()
    groups = run.check_joints(threads)
    if groups:
        count = sum(len(group.cases) for group in groups)
        if executor is not None:
            if not isinstance(executor, SizedExecutor):  # that of a cluster has checked every worker
                run.require_same_version(executor)
            run.solve(groups, executor, free_workers(executor, workers))
        else:
            wanted = workers or max(1, usable_cores() // threads)
            with local_executor(min(wanted, count)) as local:
                run.solve(groups, local, free_workers(local, None))
    return run


@contextmanager
def local_executor(workers: int) -> Iterator[SizedExecutor]:
    """This process or some more, which end at once if something goes wrong."""
    if workers == 1:
        yield InProcess()
        return
    pool = LocalProcesses(workers)
    try:
        pool.require_start(worker_version)
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def free_workers(executor: Executor, workers: int | None) -> Callable[[], int]:
    """The number of tasks that may be submitted: that of the executor, or from the caller's number of workers."""
    if isinstance(executor, SizedExecutor):
        return lambda: executor.tasks_at_a_time
    number = TASKS_AT_A_TIME if workers is None else 2 * workers
    return lambda: number


class SolvedCases:
    """Planned cases and their outcomes so far: ``outcomes`` by the key of a case, ``row`` as a row of a table."""

    def __init__(self, planned: tuple[PlannedCase, ...], folder: SweepFolder | None, progress: Progress) -> None:
        self.planned, self.folder, self._progress = planned, folder, progress
        self.outcomes: dict[str, CaseOutcome] = {}
        self.notices: list[str] = []
        self.reused = 0
        self._filed: set[str] = set()
        self._to_solve = self._solved = self._failed = 0

    def find_finished(self) -> None:
        """Take over the finished cases of an earlier sweep in the folder."""
        if self.folder is None:
            return
        for number, planned in enumerate(self.planned):
            self._progress.update("Completed cases", number / len(self.planned), planned.name)
            outcome, notice = self.folder.finished(planned)
            if notice:
                self.notices.append(notice)
            if outcome is not None:
                self.outcomes[planned.key] = outcome
                if outcome.curve is not None:
                    self._filed.add(planned.key)
        self.reused = len(self.outcomes)
        self._progress.update("Completed cases", 1.0, f"{self.reused} of {len(self.planned)}")

    def check_joints(self, threads: int) -> list[StructureGroup]:
        """Mesh, pairs and joint of every remaining case; a case with an unusable joint has its message as outcome.

        Raises InputError if no case at all could be solved.
        """
        left = [planned for planned in self.planned if planned.key not in self.outcomes]
        groups: dict[str, StructureGroup | StickslipError] = {}
        first_error: StickslipError | None = None
        for number, planned in enumerate(left):
            self._progress.update("Checks", number / len(left), planned.name)
            try:
                group = self._group(groups, planned)
                joint = load_joint(planned.case, group.setup.layout)
            except StickslipError as error:
                first_error = first_error or error
                self.outcomes[planned.key] = CaseOutcome(converged=False, message=str(error), measures={})
                continue
            wants_file = self.folder is not None
            task = CaseTask(
                planned.case, planned.key, joint, threads, wants_file,
                checks=planned.checks, harmonics=planned.harmonics, name=planned.name,
                stress_of=planned.structure if planned.wants_stress else None,
            )  # fmt: skip
            group.cases.append((planned, task))
        if first_error is not None and len(self.planned) == len(self.outcomes) and not self.reused:
            raise _none_solvable(first_error, len(left))
        if left:
            self._progress.update("Checks", 1.0, f"{len(left)} cases")
        return [group for group in groups.values() if isinstance(group, StructureGroup) and group.cases]

    @staticmethod
    def _group(groups: dict[str, StructureGroup | StickslipError], planned: PlannedCase) -> StructureGroup:
        """The group of a case; its mesh and pairs are made once. Raises InputError for entries that do not fit."""
        group = groups.get(planned.structure)
        if group is None:
            try:
                group = StructureGroup(set_up(planned.case))
            except StickslipError as error:
                group = error
            groups[planned.structure] = group
        if isinstance(group, StickslipError):
            raise group
        return group

    def require_same_version(self, executor: Executor) -> None:
        """Raise InputError unless the first worker that answers can run stickslip and runs this code.

        Only the caller knows the waiting time of a queue, so there is no time limit. Every task is checked again where
        it runs (``work.open_parcel``).
        """
        self._progress.update("Workers", 0.0, "waiting for the first answer of the executor")
        try:
            future, began = executor.submit(worker_version), time.monotonic()
            while not wait([future], CHECK_SECONDS).done:
                words = f"no answer of the executor for {time.monotonic() - began:.0f} s; check that it has workers"
                self._progress.update("Workers", 0.0, words)
            version = future.result()
        except (ImportError, AttributeError, BrokenExecutor) as error:
            raise InputError(
                f"the workers of the executor cannot run stickslip ({type(error).__name__}: {error}). Install it for "
                'them; in a script the call must be below if __name__ == "__main__":.'
            ) from error
        if version != worker_version():
            raise InputError(
                f"the workers run stickslip {version}, but this is {worker_version()}. Install the same version "
                "for them."
            )
        self._progress.update("Workers", 1.0, "same version")

    def solve(
        self,
        groups: list[StructureGroup],
        executor: Executor,
        at_a_time: Callable[[], int],
        single: Sequence[tuple[PlannedCase, Any]] = (),
        solve: Callable[..., CaseOutcome] | None = None,
    ) -> None:
        """Solve the cases of the groups and ``single`` ones with their tasks; each is written as soon as it is
        finished. ``solve`` is the function of a worker (:class:`Schedule`)."""
        self._to_solve = sum(len(group.cases) for group in groups) + len(single)
        self._show("")
        try:
            Schedule(executor, at_a_time, self._finish, self._break, solve, waiting=self._show).run(groups, single)
        except WorkersError as error:
            closing = " and stored; the same command resumes with the others" if self.folder is not None else ""
            count, total = self.reused + self._solved - self._failed, len(self.planned)
            raise WorkersError(f"{error} {count} of {total} cases are completed{closing}.") from error

    def _finish(self, planned: PlannedCase, outcome: CaseOutcome) -> None:
        if self.folder is not None:
            self.folder.store(planned, outcome)
            if outcome.file:
                self._filed.add(planned.key)
        self._note(planned, outcome)

    def _break(self, planned: PlannedCase, error: BaseException) -> None:
        """A case that ended with an exception of another kind does not count as finished, so a later sweep repeats
        it."""
        if isinstance(error, BrokenExecutor | WorkerDied):
            words = (
                "its worker processes died at least twice, perhaps because the memory was too small. Use fewer workers."
            )
        elif isinstance(error, MemoryError):
            words = (
                "the memory of the worker was too small. Use fewer elements, harmonics or samples, or fewer workers."
            )
        else:
            words = f"defect of stickslip or of the executor ({type(error).__name__}: {error})."
            if self.folder is not None:
                words += f" The traceback is in {self.folder.store_traceback(planned, error)}"
        self._note(planned, CaseOutcome(converged=False, message=words, measures={}))

    def _note(self, planned: PlannedCase, outcome: CaseOutcome) -> None:
        self.outcomes[planned.key] = replace(outcome, file=b"")  # already on the disk, and too large to collect
        self._solved += 1
        self._failed += not outcome.converged
        self._show("")

    def _show(self, remark: str) -> None:
        """Report the number of finished cases, with the reason why the others wait or what one of them does."""
        words = f"{self._solved} of {self._to_solve}"
        words += f", {self._failed} failed" if self._failed else ""
        words += f"; {remark}" if remark else ""
        self._progress.update("Cases", self._solved / self._to_solve, words)

    def row(self, planned: PlannedCase) -> SweepRow:
        """The row of a case that has an outcome."""
        outcome = self.outcomes[planned.key]
        file = self.folder.relative(planned) if self.folder is not None and planned.key in self._filed else ""
        return SweepRow(
            planned.name,
            planned.values,
            outcome.converged,
            outcome.message,
            outcome.measures,
            outcome.warnings,
            file,
            outcome.details.get(SOLVED_AGAIN, ""),
            again_because(outcome.details),
        )


def _none_solvable(first: StickslipError, count: int) -> StickslipError:
    """The error of a sweep without a case that could be solved."""
    sentence = f"no case of {count} can be solved. The first: {first}"
    return first.reworded(sentence) if isinstance(first, InputError) else type(first)(sentence)


def _written(folder: SweepFolder, case: Case, view: SweepView, planned: tuple[PlannedCase, ...]) -> tuple[Path, ...]:
    """Tables and page; beside them the record with which another sweep extends them."""
    files = tuple(folder.path / name for name in (TABLE_FILE, DATASET_FILE, PAGE_FILE))
    cases = tuple(
        StoredCase(each.name, each.key, float(force), each.values)
        for each, force in zip(planned, view.force_n, strict=True)
    )
    study = StudyText(case.to_text(), case.changed_keys())
    title, inputs = case.study.title, case.to_dict()
    store_record(folder.path, SweepRecord(title, study.text, case.changed_keys(), inputs, view.table.keys, cases))
    view.table.to_csv(files[0])
    view.table.to_netcdf(files[1])
    write_sweep_page(files[2], view, case.study.title, study, run_provenance())
    return files
