"""Progress of long computations: a protocol of one method, a silent version, and versions for terminals and files."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from stickslip.core.terminal import printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as RichBars
    from rich.progress import TaskID


REMINDER_SECONDS = 30.0  # chosen: to a user a longer silence looks like an endless loop
REMINDER_FRACTION = 0.02  # of the time of the stage so far: about 50 lines, however long it runs

# A part of a computation calls it with its finished fraction and a message.
ProgressCallback = Callable[[float, str], None]


class Progress(Protocol):
    """Receives the progress of a computation."""

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """``fraction`` (0 to 1) of ``stage`` is done; ``detail`` describes the current work."""


class SilentProgress:
    """Shows nothing."""

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Ignore the report."""


class BarProgress:
    """One bar for each stage, with the time left."""

    def __init__(self, bars: RichBars) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Move the bar of ``stage``; the first report of a stage draws its bar."""
        if stage not in self._tasks:
            self._tasks[stage] = self._bars.add_task(printable(stage), total=1.0, detail="")
        self._bars.update(self._tasks[stage], completed=fraction, detail=printable(detail))


class LineProgress:
    """Lines for files and pipes: at the start and the end of each stage, and reminders of the current work between
    them.

    A reminder comes ``REMINDER_SECONDS`` after the last line of a stage, and in a stage that takes long after
    ``REMINDER_FRACTION`` of its time so far, so that a log of days stays short.
    """

    def __init__(self, console: Console, clock: Callable[[], float] = time.monotonic) -> None:
        self._console, self._clock = console, clock
        self._started: set[str] = set()
        self._finished: set[str] = set()
        self._current: tuple[str, float, str] | None = None  # stage, fraction and detail of the current work
        self._began = self._last_line = clock()
        # reports may come from several threads, and reminders do
        self._lock = threading.RLock()

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Print a line where the stage begins or ends, or where a reminder is due."""
        with self._lock:
            if self._current is None or self._current[0] != stage:
                self._began = self._last_line = self._clock()
            self._current = (stage, fraction, detail) if fraction < 1.0 else None
            if stage not in self._started:
                self._started.add(stage)
                self._print(f"{stage}: {detail} ..." if detail and fraction == 0.0 else f"{stage} ...")
            if fraction >= 1.0 and stage not in self._finished:
                self._finished.add(stage)
                self._print(f"{stage}: {detail or 'done'}")
            self.remind()

    def remind(self) -> None:
        """Print the current work and its duration, if a reminder is due."""
        with self._lock:
            if self._current is None:
                return
            now = self._clock()
            elapsed = now - self._began
            if now - self._last_line < max(REMINDER_SECONDS, REMINDER_FRACTION * elapsed):
                return
            stage, fraction, detail = self._current
            took = f"{elapsed:.0f} s" if elapsed < 600.0 else f"{elapsed / 60.0:.0f} min"
            self._print(f"{stage}: {f'{detail} ' if detail else ''}({100.0 * fraction:.0f} % done, {took})")

    @contextmanager
    def reminding(self, every_seconds: float = 1.0) -> Iterator[None]:
        """Check from a second thread whether a reminder is due, also during a long step without reports."""
        stop = threading.Event()

        def look() -> None:
            while not stop.wait(every_seconds):
                self.remind()

        thread = threading.Thread(target=look, name="reminders of progress", daemon=True)
        thread.start()
        try:
            yield
        finally:
            stop.set()
            thread.join()

    def _print(self, text: str) -> None:
        self._console.print(printable(text), markup=False, highlight=False, soft_wrap=True)
        self._last_line = self._clock()


@contextmanager
def terminal_progress(quiet: bool = False) -> Iterator[Progress]:
    """Progress on stderr: bars on a terminal, lines elsewhere, nothing if ``quiet``."""
    if quiet:
        yield SilentProgress()
        return
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        lines = LineProgress(console)
        with lines.reminding():
            yield lines
        return
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as RichBars

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[detail]}", markup=False),
    )
    # The cases of a sweep may take minutes each, and the time left is estimated from those of the last day.
    with RichBars(*columns, console=console, speed_estimate_period=86_400.0) as bars:
        yield BarProgress(bars)
