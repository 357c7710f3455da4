"""A result that is not complete is reported at once: by a warning, or by an error if the caller wishes."""

from __future__ import annotations

import warnings
from typing import Protocol, TypeVar

from stickslip.core.errors import ConvergenceError, NotConvergedWarning

# Value of ``raise_on_failure`` in calls of stickslip itself, which reports the end of a result in its own way.
CALLER_REPORTS = None


class Ended(Protocol):
    """A result with its end."""

    @property
    def converged(self) -> bool:
        """Whether it is complete."""

    @property
    def message(self) -> str:
        """A message on its end."""


ResultT = TypeVar("ResultT", bound=Ended)


def reported(result: ResultT, raise_on_failure: bool | None) -> ResultT:
    """The result; if it is not complete, with a NotConvergedWarning, which names the caller of the caller.

    Raises ConvergenceError instead if ``raise_on_failure`` is true; None reports nothing (:data:`CALLER_REPORTS`).
    """
    if result.converged or raise_on_failure is CALLER_REPORTS:
        return result
    sentence = f"The result is not complete: {result.message}"
    if raise_on_failure:
        raise ConvergenceError(sentence)
    warnings.warn(
        f"{sentence} Use only its computed part.",
        NotConvergedWarning,
        stacklevel=3,
    )
    return result
