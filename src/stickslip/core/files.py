"""Files that are written whole or not at all, and the digest of source files."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from stickslip.core.errors import StickslipError


@contextmanager
def whole_file(target: Path, what: str, error: type[StickslipError]) -> Iterator[Path]:
    """A hidden file beside ``target`` to write to; it takes that name once the block ends well, else it is removed.

    ``what`` names the content ("results"); an operating system error becomes ``error`` with a sentence.
    """
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        yield part
        os.replace(part, target)
    except OSError as problem:
        raise error(
            f'the {what} could not be written to "{target}": {problem.strerror or problem}. Choose a folder that '
            "exists and that you may write to, with room on the disk."
        ) from problem
    finally:
        part.unlink(missing_ok=True)


def source_digest(sources: Iterable[Path]) -> str:
    """Hexadecimal digest of the content of source files, in the order of their paths: other code, other digest."""
    digest = hashlib.blake2b(digest_size=16)
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return digest.hexdigest()
