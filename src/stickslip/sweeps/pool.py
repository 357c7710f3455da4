"""Executors of a sweep: this process, or processes on this machine that neither outlive it nor ruin each other."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from multiprocessing.connection import wait
from typing import Any, ParamSpec, TypeVar

from stickslip.errors import InputError

P = ParamSpec("P")
T = TypeVar("T")


def usable_processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class InProcess(Executor):
    """Runs every task at once, in this process and thread."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Run the task; the future that is returned is done."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class LocalProcesses(Executor):
    """Processes on this machine, started afresh (spawn), that can be renewed after one of them died.

    They ignore the interrupt key, which is the parent's to answer, and end by themselves if the parent is killed.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._strangers = set(multiprocessing.active_children())
        self._pool = self._new_pool()

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Hand a task to the processes. Raises BrokenExecutor if one has died since the last ``renew``."""
        return self._pool.submit(fn, *args, **kwargs)

    def require_start(self, probe: Callable[[], Any]) -> None:
        """Raise InputError unless a worker process can be started and run ``probe``."""
        try:
            self.submit(probe).result()
        except BrokenExecutor as error:
            raise InputError(
                "worker processes cannot be started. In a script the call of stickslip.sweep must stand below "
                'if __name__ == "__main__": because every worker process reads the script first; or give workers=1.'
            ) from error

    def renew(self) -> None:
        """Replace all processes, after one of them died."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool = self._new_pool()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes; without ``wait`` also those that are at work."""
        if not wait:
            for process in set(multiprocessing.active_children()) - self._strangers:
                process.terminate()
        self._pool.shutdown(wait=True, cancel_futures=cancel_futures)

    def _new_pool(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self.workers, multiprocessing.get_context("spawn"), initializer=_prepare_process)


def _prepare_process() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A parent that is killed cannot end its pool, whose processes would then wait for work for ever."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
