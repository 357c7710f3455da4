"""Order of the tasks for the executor: reductions once for each structure, cases when their structure is ready."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass, field
from typing import Any

from stickslip.core.errors import StickslipError, WorkersError
from stickslip.model.layout import Setup
from stickslip.model.study_structure import ReducedStructure
from stickslip.sweeps.plan import PlannedCase
from stickslip.sweeps.pool import InProcess, SizedExecutor, WorkerDied
from stickslip.sweeps.work import CaseOutcome, CaseTask, open_parcel, parcel, reduce_task, solve_task

# chosen: interval at which a schedule without results checks its workers.
CHECK_SECONDS = 2.0


@dataclass(frozen=True, eq=False)
class StructureGroup:
    """Cases with the same structure, and the setup from the check of their joints."""

    setup: Setup
    cases: list[tuple[PlannedCase, CaseTask]] = field(default_factory=list)


@dataclass(eq=False)
class _Job:
    """A reduction of a group, the solution of one of its cases or of a single one, and how many of its workers died."""

    group: StructureGroup | None = None
    planned: PlannedCase | None = None
    task: Any = None
    reduced: ReducedStructure | None = None
    deaths: int = 0

    @property
    def cases(self) -> list[PlannedCase]:
        if self.planned:
            return [self.planned]
        return [planned for planned, _ in self.group.cases] if self.group else []


class Schedule:
    """Runs groups of cases on an executor, with at most ``at_a_time()`` submitted tasks.

    ``finished(planned, outcome)`` is called for every case with an outcome, ``broke(planned, error)`` for every case
    that ended with another exception. A task whose worker process dies is repeated once. ``solve`` is the function of a
    worker for a case, a function of a module, so that it can be pickled; by default :func:`solve_task`. It receives the
    task and the reduced structure of its group; a single case has no group, and ``solve`` receives its task alone.
    ``waiting(words)`` is called every few seconds with the reason why all tasks wait, or the report of one that runs.
    """

    def __init__(
        self,
        executor: Executor,
        at_a_time: Callable[[], int],
        finished: Callable[[PlannedCase, CaseOutcome], None],
        broke: Callable[[PlannedCase, BaseException], None],
        solve: Callable[..., CaseOutcome] | None = None,
        waiting: Callable[[str], None] = lambda words: None,
    ) -> None:
        self._executor, self._at_a_time, self._solve = executor, at_a_time, solve or solve_task
        self._finished, self._broke, self._waiting = finished, broke, waiting
        if isinstance(executor, InProcess):
            executor.listen(waiting)
        self._reductions: deque[_Job] = deque()
        self._solutions: deque[_Job] = deque()
        self._out: dict[Future[Any], _Job] = {}

    def run(self, groups: list[StructureGroup], single: Sequence[tuple[PlannedCase, Any]] = ()) -> None:
        """Run every case of the groups and the ``single`` ones with their tasks to its end; an exception (an interrupt,
        a full disk) cancels the submitted tasks.

        Raises WorkersError if the workers cannot continue.
        """
        self._reductions.extend(_Job(group) for group in groups)
        self._solutions.extend(_Job(planned=planned, task=task) for planned, task in single)
        try:
            while self._out or self._solutions or self._reductions:
                self._fill()
                done, _ = wait(self._out, CHECK_SECONDS, return_when=FIRST_COMPLETED)
                if not done and isinstance(self._executor, SizedExecutor):
                    self._waiting(self._executor.waiting_for() or self._executor.last_report())
                for future in done:
                    self._finish_job(self._out.pop(future), future)
        except BaseException:
            for future in self._out:
                future.cancel()
            raise

    def _fill(self) -> None:
        """Submit tasks up to the limit; solutions first, so that few structures are in memory."""
        while (self._solutions or self._reductions) and len(self._out) < self._at_a_time():
            job = (self._solutions or self._reductions).popleft()
            try:
                self._out[self._submit(job)] = job
            except BrokenExecutor as error:
                self._fail(job, error)

    def _submit(self, job: _Job) -> Future[Any]:
        if job.group is None:
            return self._hand_out(self._solve, job.task)
        if job.planned is None or job.task is None or job.reduced is None:
            planned, task = job.group.cases[0]
            return self._hand_out(reduce_task, planned.case, job.group.setup, task.threads)
        return self._hand_out(self._solve, job.task, job.reduced)

    def _hand_out(self, task: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Submit a task; one for another process contains the version of the code."""
        if isinstance(self._executor, InProcess):
            return self._executor.submit(task, *arguments)
        return self._executor.submit(open_parcel, parcel(task, *arguments))

    def _finish_job(self, job: _Job, future: Future[Any]) -> None:
        try:
            result = self._result(future)
        except WorkersError:
            raise
        except WorkerDied as error:
            job.deaths += 1
            if job.deaths > 1:
                self._fail(job, error)
            else:
                (self._solutions if job.planned else self._reductions).append(job)
        except StickslipError as error:
            for planned in job.cases:
                self._finished(planned, CaseOutcome(converged=False, message=str(error), measures={}))
        except (Exception, CancelledError) as error:
            self._fail(job, error)
        else:
            if job.planned is None and job.group is not None:
                self._solutions.extend(_Job(job.group, planned, task, result) for planned, task in job.group.cases)
            elif job.planned is not None:
                self._finished(job.planned, result)

    def _result(self, future: Future[Any]) -> Any:
        """Result of a task, or an exception that is the same for every executor."""
        try:
            return future.result()
        except (Exception, CancelledError) as error:
            meaning = self._executor.meaning(error) if isinstance(self._executor, SizedExecutor) else error
            if meaning is error:
                raise
            raise meaning from error

    def _fail(self, job: _Job, error: BaseException) -> None:
        for planned in job.cases:
            self._broke(planned, error)
