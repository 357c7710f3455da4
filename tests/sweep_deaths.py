"""Tasks for worker processes that die, import nothing heavy, and count how often they ran."""

from __future__ import annotations

import os
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from stickslip.sweeps.task_reports import report


def reduce(*_: Any) -> str:
    """Stand-in for the reduction of a structure."""
    return "reduced"


def solve(task: Any, reduced: str) -> str:
    """Answer, or die: always, or at the first call for a task with a ``marker`` file; or raise a fault."""
    if task.deed == "dies":
        os._exit(1)
    if task.deed == "dies once" and not Path(task.marker).exists():
        Path(task.marker).touch()
        os._exit(1)
    if task.deed == "fault":
        raise ZeroDivisionError("division by zero")
    return f"{task.deed} {reduced}"


def unpicklable() -> Any:
    """An answer that no pipe carries."""
    return lambda: None


def die_in_answer() -> bytes:
    """An answer of which the parent gets the beginning only, because the process dies while it is sent."""

    def send_the_beginning(connection: Connection, content: bytes) -> None:
        os.write(connection.fileno(), content[:1000])
        os._exit(1)

    Connection._send = send_the_beginning  # type: ignore[attr-defined]
    return bytes(100_000)


def report_until(words: str, end: str) -> str:
    """Report once, wait for the file ``end``, and answer."""
    report(words)
    while not Path(end).exists():
        time.sleep(0.02)
    return "answer"
