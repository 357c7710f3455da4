"""A bound on the memory that a test may take."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest


@contextmanager
def flat_memory(most: int = 300_000_000) -> Iterator[None]:
    """Let allocations fail that make this process more than ``most`` bytes larger, where the system can do so."""
    resource = pytest.importorskip("resource", reason="only POSIX systems bound the memory of a process")
    with open("/proc/self/statm", encoding="ascii") as stream:
        used = int(stream.read().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
