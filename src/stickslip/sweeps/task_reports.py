"""Reports of a running task to the process that waits for it: what it does now, in words.

The executor that runs a task chooses the way (:func:`reports_to`); the task itself only reports.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Listener = Callable[[str], None]

# chosen: a curve has many points in a second, and each report crosses a pipe.
REPORT_SECONDS = 1.0


def ignore(words: str) -> None:
    """The listener of a task that nobody watches."""


_listener: ContextVar[Listener] = ContextVar("_listener", default=ignore)


@contextmanager
def reports_to(listener: Listener) -> Iterator[None]:
    """Give ``listener`` the reports of the tasks in the block."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def report(words: str) -> None:
    """Report from a task."""
    _listener.get()(words)


class TaskProgress:
    """The progress of a task (:class:`stickslip.core.progress.Progress`) as reports, at most one in a second."""

    def __init__(self, name: str, clock: Callable[[], float] = time.monotonic) -> None:
        self._name, self._clock = name, clock
        self._last = clock()

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Report the name of the task, the finished part of the stage, and the current work."""
        now = self._clock()
        if now - self._last >= REPORT_SECONDS:
            self._last = now
            report(f"{self._name}: {100.0 * fraction:.0f} %, {detail or stage}")
