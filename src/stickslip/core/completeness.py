"""A result that is not complete is reported at once: by a warning, or by an error if the caller wishes."""

from __future__ import annotations

import warnings
from typing import Protocol, TypeVar

from stickslip.core.errors import ConvergenceError, NotConvergedWarning


class Ended(Protocol):
    """A result with its end."""

    @property
    def converged(self) -> bool:
        """Whether it is complete."""

    @property
    def message(self) -> str:
        """A message on its end."""


ResultT = TypeVar("ResultT", bound=Ended)


def reported(result: ResultT, raise_on_failure: bool) -> ResultT:
    """The result; if it is not complete, with a NotConvergedWarning, which names the caller of the caller.

    Raises ConvergenceError instead if ``raise_on_failure`` is true. Public functions end with this call; stickslip
    itself calls the function ``unreported_...`` beside each of them, and reports the end in its own way.
    """
    if result.converged:
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
