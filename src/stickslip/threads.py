"""Threads: how many, and pairs shared among them by compiled functions that release the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

# Below this many items for each thread handing over costs more than it saves.
FEWEST_ITEMS = 16


def shared(work: Callable[[slice], None], count: int, threads: int) -> None:
    """Call ``work`` on slices that cover ``range(count)``, one for each thread, and wait for all of them."""
    parts = min(threads, count // FEWEST_ITEMS)
    if parts <= 1:
        work(slice(0, count))
        return
    slices = [slice(count * part // parts, count * (part + 1) // parts) for part in range(parts)]
    for done in [_pool(threads).submit(work, part) for part in slices]:
        done.result()


@lru_cache(maxsize=4)
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="stickslip")
