"""Hostile surroundings: modules of the current folder with names of others, and processes that should be gone."""

from __future__ import annotations

import os
from pathlib import Path

NAMES = ("random", "copy", "numpy", "tempfile", "matplotlib", "stickslip", "signal", "pickle", "socket")


def strangers(folder: Path) -> None:
    """Modules in ``folder`` with the names of others; one that is run leaves a file "ran" in it and fails."""
    for name in NAMES:
        text = f"open({str(folder / 'ran')!r}, 'a').write({name!r} + ' ')\nraise SystemExit({name!r})\n"
        (folder / f"{name}.py").write_text(text, encoding="utf-8")


def is_alive(number: int) -> bool:
    """Whether a process runs; one that ended and that nobody waits for counts as ended."""
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    try:
        state = Path(f"/proc/{number}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"
