"""The number of threads, and independent work distributed among them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, wait
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple, TypeVar

from threadpoolctl import threadpool_limits

from stickslip.core.thread_variables import MOST_THREADS, VARIABLE, threads_of_variable
from stickslip.core.validation import require_allowed, whole_number

# More threads than this gain nothing on problems of this package.
MOST_BY_DEFAULT = 4

# Size of a matrix from which its Cholesky factor and its inverse take less time with two threads of the library. With
# 3600, factors take as long as with one; eigenvalues take 1.3 times as long, and have one.
LARGE_MATRIX = 6000

Answer = TypeVar("Answer")


class Helpers(NamedTuple):
    """The threads beside that of the solver, and their number."""

    pool: Executor
    threads: int


_HELPERS: ContextVar[Helpers | None] = ContextVar("helpers", default=None)


@contextmanager
def solver_threads(threads: int) -> Iterator[None]:
    """Inside, loops that are divided by :func:`in_shares` are shared among ``threads`` threads.

    The linear algebra library uses one, except in :func:`library_threads`. NumPy and SciPy have a library each, whose
    further threads wait actively for a while after every product and take the cores from all others: on two cores
    curves of 440 and 990 pairs took 2.3 and 1.5 times as long by the clock as with one thread in the library.
    """
    with threadpool_limits(limits=1):
        if threads == 1:
            yield
            return
        with ThreadPoolExecutor(threads - 1, thread_name_prefix="stickslip") as pool:
            before = _HELPERS.set(Helpers(pool, threads - 1))
            try:
                yield
            finally:
                _HELPERS.reset(before)


@contextmanager
def library_threads(size: int) -> Iterator[None]:
    """Inside, the linear algebra library uses all threads of :func:`solver_threads` for a matrix (size, size), if it is
    large; for single operations that take a time of ``size**3``.
    """
    helpers = _HELPERS.get()
    if helpers is None or size < LARGE_MATRIX:
        yield
        return
    with threadpool_limits(limits=1 + helpers.threads):
        yield


@contextmanager
def single_library_thread(size: int) -> Iterator[None]:
    """Inside, the linear algebra library uses one thread for many operations with matrices (size, size), unless they
    are large; without :func:`solver_threads`. On two cores a static preload of 700 unknowns takes 0.5 instead of 1.2 s.
    """
    if size >= LARGE_MATRIX:
        yield
        return
    with threadpool_limits(limits=1):
        yield


def in_shares(work: Callable[[int, int], None], count: int, least: int) -> None:
    """Call ``work(start, stop)`` for shares of ``count`` items, each of at least ``least`` if there are as many.

    The shares are worked on by the threads of :func:`solver_threads`, whoever is free, and must not depend on each
    other. Outside of it, inside of another share and for less than two shares there is one call for everything.
    """
    helpers = _HELPERS.get()
    if helpers is None or count < 2 * least:
        work(0, count)
        return
    starts = iter(range(0, count, least))  # each next() is one step of the interpreter: no start is given out twice

    def take() -> None:
        for start in starts:
            work(start, min(start + least, count))

    alone = _HELPERS.set(None)
    try:
        waiting = [helpers.pool.submit(take) for _ in range(helpers.threads)]
        try:
            take()
        finally:
            for _ in starts:  # after an error nobody begins another share
                pass
            started = [each for each in waiting if not each.cancel()]
            wait(started)
        for each in started:
            each.result()
    finally:
        _HELPERS.reset(alone)


def side_by_side(tasks: Sequence[Callable[[], Answer]], stop: Callable[[], None]) -> list[Answer]:
    """The answers of tasks of seconds, which must not depend on each other; in the threads of :func:`solver_threads`.

    The first task is that of this thread, which then takes others that nobody has begun; loops of :func:`in_shares` in
    its tasks use threads that are free. After an error the first one is raised, and ``stop`` ends tasks that still run.
    """
    helpers = _HELPERS.get()
    if helpers is None:
        return [task() for task in tasks]
    others = tasks[1:]
    waiting = [helpers.pool.submit(task) for task in others]
    try:
        first = tasks[0]()
        own = {i: task() for i, task in enumerate(others) if waiting[i].cancel()}
        return [first, *(own[i] if i in own else each.result() for i, each in enumerate(waiting))]
    except BaseException:
        stop()
        wait([each for each in waiting if not each.cancel()])
        raise


def in_threads(work: Callable[[int], None], items: Iterable[int], threads: int) -> None:
    """Call ``work`` for each item, in ``threads`` threads; for compiled work that releases the interpreter's lock.

    Matrix products inside ``work`` use one thread each: several BLAS pools would only wait for each other.
    """
    if threads == 1:
        for item in items:
            work(item)
        return
    with threadpool_limits(limits=1), ThreadPoolExecutor(threads, thread_name_prefix="stickslip") as pool:
        for _ in pool.map(work, items):
            pass


def thread_count(wanted: int | None = None) -> int:
    """``wanted``, else the environment variable STICKSLIP_THREADS, else the usable cores, at most 4.

    Raises InputError for anything but a whole number from 1 to ``MOST_THREADS``.
    """
    if wanted is None:
        return threads_of_variable(VARIABLE) or min(MOST_BY_DEFAULT, usable_cores())
    count = whole_number("threads", wanted, 1)
    require_allowed("threads", count, count <= MOST_THREADS, f"at most {MOST_THREADS}")
    return count


def usable_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
