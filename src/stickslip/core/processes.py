"""Other processes of Python, started without the current folder in the module search path."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_SAFE_PATH = "PYTHONSAFEPATH"
_lock = threading.RLock()


def python_command(code: str) -> list[str]:
    """The command that runs ``code`` in another process of this Python, with the module search path of this process.

    ``python -c`` searches modules in the current folder first: a "random.py" of the user would run in place of Python's
    own. Option -P leaves this folder out; the rest of the search path is that of this process.
    """
    here = str(Path(__file__).parents[2])
    places = [place for place in sys.path if place and Path(place).is_absolute()]
    places += [] if here in places else [here]
    return [sys.executable, "-P", "-c", f"import sys; sys.path[:] = {places!r}\n{code}"]


@contextmanager
def safe_path() -> Iterator[None]:
    """Make processes that ``multiprocessing`` starts in the block omit the current folder too.

    They too begin with ``python -c``, but without options; later they take the module search path of this process.
    """
    with _lock:
        before = os.environ.get(_SAFE_PATH)
        os.environ[_SAFE_PATH] = "1"
        try:
            yield
        finally:
            if before is None:
                del os.environ[_SAFE_PATH]
            else:
                os.environ[_SAFE_PATH] = before


def leave_signals_to_parent() -> None:
    """Ignore the interrupt key and a lost terminal, which reach every process of a terminal."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
