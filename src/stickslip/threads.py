"""How many threads, and independent work shared among them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

from threadpoolctl import threadpool_limits

# Rows of relative displacement below which a second thread of the linear algebra costs more than it brings.
FEWEST_ROWS = 1000


def in_threads(work: Callable[[int], None], items: Iterable[int], threads: int) -> None:
    """Call ``work`` for each item, ``threads`` at a time; for compiled work that releases the interpreter's lock.

    Matrix products inside ``work`` get one thread each: the threads of several BLAS pools only wait for each other.
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
