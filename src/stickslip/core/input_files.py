"""Reading small input files whole: text files that a user wrote or an instrument exported."""

from __future__ import annotations

import stat
from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError


def read_input(path: str | PathLike[str], advice: str, most_bytes: int, error: type[InputError] = InputError) -> bytes:
    """The content of a file.

    Raises ``error`` with a sentence that ends with ``advice`` for a file that is missing, cannot be read, is no regular
    file (a folder; a pipe or a device, which may never end) or has more than ``most_bytes``.
    """
    require_file(path, advice, error)
    with Path(path).open("rb") as stream:
        content = stream.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise error(f"{path}: the file has more than {most_bytes / 1e6:g} MB, which is too large. {advice}")
    return content


def require_file(path: str | PathLike[str], advice: str, error: type[InputError] = InputError) -> None:
    """Raise ``error`` unless ``path`` is a regular file that can be opened; nothing else is opened, nor waited for."""
    try:
        mode = Path(path).stat().st_mode
        if stat.S_ISREG(mode):
            Path(path).open("rb").close()
            return
    except FileNotFoundError as problem:
        raise error(f"{path}: there is no such file. {advice}") from problem
    except (OSError, ValueError) as problem:  # a name with the character NUL is a ValueError
        why = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise error(f"{_short(str(path))}: the file cannot be read ({why}). {advice}") from problem
    if stat.S_ISDIR(mode):
        raise error(f"{path}: this is a folder, so it cannot be read. {advice}")
    raise error(f"{path}: this is a pipe or a device, which cannot be read, because it may never end. {advice}")


def _short(name: str) -> str:
    """A name that may be too long for any disk, as a sentence shows it."""
    return name if len(name) <= 200 else f"{name[:100]} ... {name[-40:]}"
