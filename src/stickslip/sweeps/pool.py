"""Executors of a sweep: this process, or processes on this machine that end with it and do not affect each other.

The pool of the standard library abandons all tasks when one process dies, and waits for ever if that process was
sending its answer (Python 3.11). Here every process has its own pipe and thread, so that a death affects one task only.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
import traceback
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import Executor, Future
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from queue import Empty, SimpleQueue
from typing import Any, ParamSpec, TypeVar

from stickslip.core.errors import InputError, show_warnings_as_lines
from stickslip.core.processes import leave_signals_to_parent, safe_path
from stickslip.sweeps.task_reports import Listener, ignore, reports_to

P = ParamSpec("P")
T = TypeVar("T")


class SizedExecutor(Executor, ABC):
    """An executor with a recommended number of tasks, so that all its workers are busy and few tasks wait."""

    @property
    @abstractmethod
    def tasks_at_a_time(self) -> int:
        """The number of tasks that may be submitted now. Raises WorkersError if no workers can be expected."""

    def waiting_for(self) -> str:
        """The reason why all tasks wait, in words; "" while they run. Raises WorkersError if no workers can be
        expected."""
        return ""

    def meaning(self, error: BaseException) -> BaseException:
        """The meaning of an exception of a task: WorkerDied, BrokenExecutor or WorkersError, else itself."""
        return error

    def last_report(self) -> str:
        """The last report of a running task (:mod:`stickslip.sweeps.task_reports`); "" if the executor has none."""
        return ""


class InProcess(SizedExecutor):
    """Runs every task at once, in this process and thread."""

    def __init__(self) -> None:
        self._listener: Listener = ignore

    @property
    def tasks_at_a_time(self) -> int:
        """One."""
        return 1

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Run the task; the future is done."""
        future: Future[T] = Future()
        with reports_to(self._listener):
            try:
                future.set_result(fn(*args, **kwargs))
            except Exception as error:
                future.set_exception(error)
        return future

    def listen(self, listener: Listener) -> None:
        """Give ``listener`` the reports of the tasks, from within :meth:`submit`."""
        self._listener = listener


class WorkerDied(RuntimeError):
    """A worker process ended before it answered: it was killed, crashed, or could not start."""


class LocalProcesses(SizedExecutor):
    """Processes on this machine, started afresh (spawn); one that dies fails its task only and is replaced.

    They ignore the interrupt key, which the parent handles, and end by themselves if the parent is killed.
    """

    def __init__(self, workers: int) -> None:
        self._tasks: SimpleQueue[_Task | None] = SimpleQueue()
        self._workers = [_Worker(self._tasks) for _ in range(workers)]

    @property
    def tasks_at_a_time(self) -> int:
        """One for each process, and one in reserve."""
        return 2 * len(self._workers)

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Submit a task to the processes; its future raises WorkerDied if its process dies."""
        future: Future[T] = Future()
        self._tasks.put((future, (fn, args, kwargs)))
        return future

    def last_report(self) -> str:
        """That of the first process with a task that reports."""
        return next((worker.report for worker in self._workers if worker.report), "")

    def require_start(self, probe: Callable[[], Any]) -> None:
        """Raise InputError unless a worker process can be started and run ``probe``."""
        try:
            self.submit(probe).result()
        except WorkerDied as error:
            raise InputError(
                "worker processes cannot be started. In a script the call of stickslip.sweep must be below "
                'if __name__ == "__main__": because each worker process reads the script first. Or give workers=1.'
            ) from error

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes; without ``wait`` also those that run a task."""
        while cancel_futures:
            try:
                task = self._tasks.get_nowait()
            except Empty:
                break
            if task is not None:
                task[0].cancel()
        for _ in self._workers:
            self._tasks.put(None)
        for worker in self._workers:
            worker.end(at_once=not wait)


_Task = tuple[Future[Any], tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]]


class _Worker:
    """A process with the thread that sends it one task after the other."""

    def __init__(self, tasks: SimpleQueue[_Task | None]) -> None:
        self._tasks = tasks
        self.report = ""  # the last one of the present task
        self._process: SpawnProcess | None = None
        self._pipe: Connection | None = None
        self._ended = False
        self._lock = threading.Lock()  # no process may start once the end has begun
        self._thread = threading.Thread(target=self._run_tasks, daemon=True)
        self._thread.start()

    def end(self, at_once: bool) -> None:
        """End thread and process, after the current task or at once."""
        if at_once:
            with self._lock:
                self._ended = True
                if self._process is not None:
                    self._process.terminate()
        self._thread.join()

    def _run_tasks(self) -> None:
        while (task := self._tasks.get()) is not None:
            future, call = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                worked, answer = self._answer(call)
            except Exception as error:  # also what cannot be pickled
                future.set_exception(error)
                continue
            if worked:
                future.set_result(answer)
            else:
                future.set_exception(answer)
        self._close()

    def _answer(self, call: Any) -> tuple[bool, Any]:
        """(True, result) or (False, exception) of a call in the process. Raises WorkerDied."""
        try:
            pipe = self._started()
            pipe.send(call)
            # Reports have None in place of True or False.
            answer: tuple[bool | None, Any] = pipe.recv()
            while answer[0] is None:
                self.report = answer[1]
                answer = pipe.recv()
        except (EOFError, OSError) as error:
            self._close()
            raise WorkerDied("the worker process stopped without an answer") from error
        finally:
            self.report = ""
        return bool(answer[0]), answer[1]

    def _started(self) -> Connection:
        """The pipe to the process, which is started for the first task and after a death."""
        with self._lock:
            if self._ended:
                raise WorkerDied("the worker processes were stopped")
            if self._pipe is None:
                context = multiprocessing.get_context("spawn")
                pipe, theirs = context.Pipe()
                process = context.Process(target=_work, args=(theirs,), daemon=True)
                with safe_path():
                    process.start()
                theirs.close()  # else the pipe would stay open when the process dies
                self._pipe, self._process = pipe, process  # only now: a process that did not start cannot be ended
            return self._pipe

    def _close(self) -> None:
        with self._lock:
            if self._pipe is not None:
                self._pipe.close()
            if self._process is not None:
                self._process.join()
            self._pipe = self._process = None


def _work(pipe: Connection) -> None:
    """Main function of a worker process: answer calls until the pipe is closed."""
    leave_signals_to_parent()
    show_warnings_as_lines()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            call, args, kwargs = pipe.recv()
        except EOFError:
            return
        except Exception as error:  # a call that this process cannot read
            pipe.send((False, RuntimeError(f"the worker process cannot read a task: {error!r}")))
            continue
        try:
            with reports_to(lambda words: pipe.send((None, words))):
                answer = True, call(*args, **kwargs)
        except Exception as error:
            error.add_note("In the worker process:\n" + traceback.format_exc())
            answer = False, error
        try:
            pipe.send(answer)
        except Exception as error:  # an answer that cannot be pickled; nothing of it was sent
            pipe.send((False, RuntimeError(f"the answer of a task cannot be sent ({error}): {answer[1]!r}")))


def _end_with_parent() -> None:
    """End at once when the parent is killed, also during a case."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
