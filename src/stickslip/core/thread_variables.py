"""Environment variables with numbers of threads, checked before a library fails on an invalid one."""

from __future__ import annotations

import os

from stickslip.core.errors import InputError

VARIABLE = "STICKSLIP_THREADS"
_OPENMP = "OMP_NUM_THREADS"
_OF_LIBRARIES = ("NUMBA_NUM_THREADS", _OPENMP)
# The largest machines of today have some hundred cores; more threads are a typing error, and may exhaust the system.
MOST_THREADS = 1024
_LONGEST_TEXT = 12  # of one number with its blanks


def require_thread_variables() -> None:
    """Raise InputError for an invalid number of threads in the environment, before a library fails on it."""
    for variable in (VARIABLE, *_OF_LIBRARIES):
        threads_of_variable(variable)


def threads_of_variable(variable: str) -> int | None:
    """The number in an environment variable, None if it is not set. Raises InputError if it is not a number of
    threads."""
    text = os.environ.get(variable, "").strip()
    if not text:
        return None
    # OpenMP allows a list: one number for each level of nested parallel work
    parts = text.split(",") if variable == _OPENMP else [text]
    numbers = [int(part) if part.strip().isdecimal() and len(part) <= _LONGEST_TEXT else 0 for part in parts]
    if not all(1 <= number <= MOST_THREADS for number in numbers):
        shortened = text if len(text) <= 40 else f"{text[:36]} ..."
        raise InputError(
            f"the environment variable {variable} is {shortened!r}, but it must be a whole number from 1 to "
            f"{MOST_THREADS}. Change it, or unset it."
        )
    return numbers[0]
