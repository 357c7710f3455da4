"""The entry of a study file in messages about it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from stickslip.core.errors import InputError, concerning


@contextmanager
def named_entry(name: str) -> Iterator[None]:
    """Put the entry of the study file before the message of an InputError, and set its keys."""
    try:
        with concerning(name):
            yield
    except InputError as error:
        raise error.reworded(f"{name}: {error}") from error
