"""Every error that a caller can meet, in one tree.

A message says what is wrong, where in the input it stands, what was found, what is allowed, and what to do.
"""

from __future__ import annotations


class StickslipError(Exception):
    """Root of all errors that stickslip raises on purpose. ``exit_code`` is what the command line returns."""

    exit_code = 2


class InputError(StickslipError, ValueError):
    """The input is not usable: a key, an array, a matrix or a file is wrong."""


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


class MissingPackageError(StickslipError, ImportError):
    """An optional package is needed; the message names the extra that installs it."""


class ConvergenceError(StickslipError, RuntimeError):
    """An iteration did not converge; the message says how far it came and what to try."""

    exit_code = 3
