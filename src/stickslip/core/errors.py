"""All errors that stickslip raises, in one tree.

A message gives the defect of the input, its position (key, line, file), the value found, the allowed values and what to
do.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Self, TextIO

from stickslip.core.terminal import echo


class StickslipError(Exception):
    """Root of all errors that stickslip raises on purpose. ``exit_code`` is what the command line returns.

    Errors of an input (:class:`InputError` and its classes) have ``keys``: the keys or arguments that are wrong.
    """

    exit_code = 2


class StickslipWarning(UserWarning):
    """stickslip corrected a problem by itself; the results are right."""


class NotConvergedWarning(UserWarning):
    """A result is not complete: its ``converged`` is False, and ``message`` gives the reason."""


def show_warnings_as_lines() -> None:
    """From now on print a StickslipWarning as one line on stderr, without file and line of the code."""
    usual = warnings.showwarning

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        if issubclass(category, StickslipWarning):
            echo(f"Warning: {message}", err=True)
        else:
            usual(message, category, filename, lineno, file, line)

    warnings.showwarning = show


class InputError(StickslipError, ValueError):
    """The input is not usable: a key, an array, a matrix or a file is wrong.

    ``keys`` are the subjects of the message, if any: keys or sections of a study file, such as "geometry.width" or
    "interfaces.joint", or arguments of a class that is used without a study file. If the keys are ``arguments`` of the
    function or class that raised the error, ``are_arguments`` is true: a study file need not have a key of that name,
    so callers that know the key replace them (:func:`concerning`), and the message has no line number.
    """

    def __init__(self, sentence: str, keys: Sequence[str] = (), *, arguments: Sequence[str] = ()) -> None:
        super().__init__(sentence)
        self.keys = tuple(keys or arguments)
        self.are_arguments = bool(arguments and not keys)

    def reworded(self, sentence: str) -> Self:
        """An error of the same class with the same keys and another message."""
        other = type(self)(sentence)
        other.keys, other.are_arguments = self.keys, self.are_arguments
        return other

    def concern(self, *keys: str) -> None:
        """From now on the error is about ``keys`` of the study file."""
        self.keys, self.are_arguments = keys, False


@contextmanager
def keys_of_section(section: str, renamed: Mapping[str, str] | None = None) -> Iterator[None]:
    """In an InputError raised inside, replace the names of arguments by keys of ``section`` of the study file.

    ``renamed`` maps argument -> key where the two differ.
    """
    try:
        yield
    except InputError as error:
        if not error.are_arguments:
            error.concern(*(f"{section}.{(renamed or {}).get(name, name)}" for name in error.keys))
        raise


@contextmanager
def concerning(*keys: str) -> Iterator[None]:
    """Give an InputError raised inside the ``keys`` of the study file, unless it has keys of its own."""
    try:
        yield
    except InputError as error:
        if error.are_arguments or not error.keys:
            error.concern(*keys)
        raise


class StudyFileError(InputError):
    """A study file cannot be read, or one of its keys or values is wrong."""


class ImportFileError(InputError):
    """A mesh or matrix file of another program cannot be read, or an entry of it is wrong; the message says which."""


class SingularMatrixError(InputError):
    """A matrix that must be factored is singular or nearly so."""


class RoughnessError(InputError):
    """A roughness, or a roughness with a load, gives no usable contact (for example zero stiffness)."""


class ResultsFileError(InputError):
    """A results file is missing, damaged, or was written by another version."""


class WorkersError(StickslipError, RuntimeError):
    """The workers of a sweep cannot continue: none is left, no scheduler answers, or one of them runs another
    version."""


class OutputError(InputError):
    """A folder, a file or the disk cannot be written to; the study file is not the cause."""


class MissingPackageError(StickslipError, ImportError):
    """An optional package is needed; the message names the extra that installs it."""


class ConvergenceError(StickslipError, RuntimeError):
    """An iteration did not converge, or a curve ends early; the message gives the place and the reason."""

    exit_code = 3
