"""Functions compiled by numba, with a folder that keeps their code for the next run."""

from __future__ import annotations

import os
import stat
import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from stickslip.core.errors import StickslipWarning
from stickslip.core.thread_variables import require_thread_variables

_VARIABLE = "NUMBA_CACHE_DIR"


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit(**options)``, which also works where numba finds no folder for its code.

    numba writes compiled code beside the package or into the user's cache folder. In a container neither may be
    writable; the code then goes to the temporary files, with a StickslipWarning.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        numba = _numba()
        try:
            return numba.njit(**options)(function)
        except RuntimeError as error:
            if "no locator available" not in str(error):
                raise
        folder = _private_folder()
        if folder is None:
            _warn("numba has no writable folder for compiled code. Each run compiles again, which takes a minute.")
            return numba.njit(**{**options, "cache": False})(function)
        numba.config.CACHE_DIR = os.environ[_VARIABLE] = str(folder)  # also for processes that are started later
        _warn(
            f'numba stores compiled code in "{folder}", because the installation and the cache folder of the user '
            "are not writable."
        )
        return numba.njit(**options)(function)

    return compiled


@cache  # once for all functions
def _warn(sentence: str) -> None:
    warnings.warn(f"{sentence} Set {_VARIABLE} to a permanent folder.", StickslipWarning, stacklevel=4)


@cache
def _numba() -> Any:
    """The package numba. Raises InputError for thread variables of the environment on which numba would fail."""
    require_thread_variables()
    import numba

    return numba


@cache
def _private_folder() -> Path | None:
    """A temporary folder that no other user can write to, because code runs from it; None if there is none."""
    try:
        base = Path(tempfile.gettempdir())
        if not hasattr(os, "getuid"):
            return Path(tempfile.mkdtemp(prefix="stickslip-numba-"))
        folder = base / f"stickslip-numba-{os.getuid()}"
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
        if stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid() and not status.st_mode & 0o077:
            return folder
        return Path(tempfile.mkdtemp(prefix="stickslip-numba-"))
    except OSError:
        return None
