"""The number of threads, and independent work distributed among them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

from threadpoolctl import threadpool_limits

from stickslip.core.thread_variables import MOST_THREADS, VARIABLE, threads_of_variable
from stickslip.core.validation import require_allowed, whole_number

# More threads than this gain nothing on problems of this package.
MOST_BY_DEFAULT = 4

# Rows of relative displacement below which a second thread of the linear algebra costs more than it gains.
FEWEST_ROWS = 1000


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


def blas_threads(rows: int, threads: int) -> int:
    """Threads of the linear algebra for products with ``rows`` rows: small ones are slower with several."""
    return threads if rows >= FEWEST_ROWS else 1


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
