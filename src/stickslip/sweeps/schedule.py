"""Which task goes to the executor next: reductions once for each structure, cases as their structure is ready."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass, field
from typing import Any

from stickslip.errors import StickslipError
from stickslip.interface.pairing import FacePairs
from stickslip.structure.mesh import Mesh
from stickslip.sweeps.plan import PlannedCase
from stickslip.sweeps.pool import LocalProcesses
from stickslip.sweeps.work import CaseOutcome, CaseTask, ReducedStructure, reduce_task, solve_task


@dataclass(frozen=True, eq=False)
class StructureGroup:
    """Cases that share a structure, with the mesh and the pairs that the check of their joints needed already."""

    mesh: Mesh
    face_pairs: FacePairs
    cases: list[tuple[PlannedCase, CaseTask]] = field(default_factory=list)


@dataclass(eq=False)
class _Job:
    """A reduction of a group, or the solution of one of its cases; how often a worker died while it was out."""

    group: StructureGroup
    planned: PlannedCase | None = None
    task: CaseTask | None = None
    reduced: ReducedStructure | None = None
    deaths: int = 0

    @property
    def cases(self) -> list[PlannedCase]:
        return [self.planned] if self.planned else [planned for planned, _ in self.group.cases]


class Schedule:
    """Carries groups of cases through an executor, a limited number of tasks at a time.

    ``finished(planned, outcome)`` hears of every case that stickslip answered, ``broke(planned, error)`` of every case
    that ended with another exception. When a worker process dies, the tasks that were out run again; one that was out
    at two deaths runs alone, so that no innocent case is blamed.
    """

    def __init__(
        self,
        executor: Executor,
        at_a_time: int,
        finished: Callable[[PlannedCase, CaseOutcome], None],
        broke: Callable[[PlannedCase, BaseException], None],
    ) -> None:
        self._executor, self._at_a_time = executor, at_a_time
        self._finished, self._broke = finished, broke
        self._reductions: deque[_Job] = deque()
        self._solutions: deque[_Job] = deque()
        self._suspects: deque[_Job] = deque()
        self._out: dict[Future[Any], _Job] = {}

    def run(self, groups: list[StructureGroup]) -> None:
        """Carry every case to its end; on an exception (an interrupt, a full disk) what is out is cancelled."""
        self._reductions.extend(_Job(group) for group in groups)
        try:
            while self._out or self._waiting():
                self._fill()
                done, _ = wait(self._out, return_when=FIRST_COMPLETED)
                for future in done:
                    self._take(self._out.pop(future), future)
        except BaseException:
            for future in self._out:
                future.cancel()
            raise

    def _waiting(self) -> bool:
        return bool(self._reductions or self._solutions or self._suspects)

    def _fill(self) -> None:
        """Hand out tasks as long as there is room; solutions first, so that few structures are held at once."""
        while queue := self._next_queue():
            job = queue.popleft()
            try:
                future = self._submit(job)
            except BrokenExecutor as error:
                queue.appendleft(job)
                if self._out:  # these learn of the death first
                    return
                self._renew(error)
                continue
            self._out[future] = job

    def _next_queue(self) -> deque[_Job] | None:
        if self._suspects:
            return None if self._out else self._suspects
        alone = any(job.deaths > 1 for job in self._out.values())
        if alone or len(self._out) >= self._at_a_time:
            return None
        return self._solutions or self._reductions or None

    def _submit(self, job: _Job) -> Future[Any]:
        if job.planned is None or job.task is None or job.reduced is None:
            planned, task = job.group.cases[0]
            group = job.group
            return self._executor.submit(reduce_task, planned.case, group.mesh, group.face_pairs, task.threads)
        return self._executor.submit(solve_task, job.task, job.reduced)

    def _renew(self, error: BrokenExecutor) -> None:
        """New worker processes, or the end of all waiting cases where the executor is not ours to renew."""
        if isinstance(self._executor, LocalProcesses):
            self._executor.renew()
            return
        for queue in (self._suspects, self._solutions, self._reductions):
            while queue:
                self._fail(queue.popleft(), error)

    def _take(self, job: _Job, future: Future[Any]) -> None:
        try:
            result = future.result()
        except BrokenExecutor as error:
            job.deaths += 1
            if job.deaths > 2:
                self._fail(job, error)
            elif job.deaths == 2:
                self._suspects.append(job)
            else:
                (self._solutions if job.planned else self._reductions).appendleft(job)
        except StickslipError as error:
            for planned in job.cases:
                self._finished(planned, CaseOutcome(converged=False, message=str(error), measures={}))
        except (Exception, CancelledError) as error:
            self._fail(job, error)
        else:
            if job.planned is None:
                self._solutions.extend(_Job(job.group, planned, task, result) for planned, task in job.group.cases)
            else:
                self._finished(job.planned, result)

    def _fail(self, job: _Job, error: BaseException) -> None:
        for planned in job.cases:
            self._broke(planned, error)
