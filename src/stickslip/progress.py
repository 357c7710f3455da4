"""How long computations tell what they do: a protocol of one method, a silent version, and one for the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as RichBars
    from rich.progress import TaskID


# What a part of a computation calls with the share of it that is done, and a sentence.
ProgressCallback = Callable[[float, str], None]


class Progress(Protocol):
    """Whoever wants to know how far a computation is."""

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """``fraction`` (0 to 1) of ``stage`` is done; ``detail`` says what is being done now."""


class SilentProgress:
    """Nobody wants to know."""

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Ignore the news."""


class BarProgress:
    """One bar for each stage, with the time left."""

    def __init__(self, bars: RichBars) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Move the bar of ``stage``; the first news of a stage draws its bar."""
        if stage not in self._tasks:
            self._tasks[stage] = self._bars.add_task(stage, total=1.0, detail=detail)
        self._bars.update(self._tasks[stage], completed=fraction, detail=detail)


class LineProgress:
    """One line for the start of each stage and one for its end, for files and pipes."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._started: set[str] = set()
        self._finished: set[str] = set()

    def update(self, stage: str, fraction: float, detail: str = "") -> None:
        """Print a line where the stage begins or ends."""
        if stage not in self._started:
            self._started.add(stage)
            self._print(f"{stage}: {detail} ..." if detail and fraction == 0.0 else f"{stage} ...")
        if fraction >= 1.0 and stage not in self._finished:
            self._finished.add(stage)
            self._print(f"{stage}: {detail or 'done'}")

    def _print(self, text: str) -> None:
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)


@contextmanager
def terminal_progress(quiet: bool = False) -> Iterator[Progress]:
    """Progress on stderr: bars on a terminal, lines elsewhere, nothing if ``quiet``."""
    if quiet:
        yield SilentProgress()
        return
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield LineProgress(console)
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
