"""Values that are valid but most likely in a wrong unit, and errors that they explain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from stickslip.core.errors import ConvergenceError, InputError


@dataclass(frozen=True)
class OddValue:
    """A value outside the range of machine parts: a message, and the key of the study file that gave it, if any."""

    sentence: str
    key: str = ""


def odd_value(
    words: str, value: float, unit: str, usual: tuple[float, float], cause: str, key: str = ""
) -> Iterator[OddValue]:
    """An OddValue for ``value``, or None in its ``usual`` range. Message: "``words`` 3 Pa, outside ... Check ..."."""
    low, high = usual
    if not low <= value <= high:
        shown = f" {unit}" if unit else ""
        yield OddValue(
            f"{words} {value:.3g}{shown}; machine parts have {low:g} to {high:g}{shown}. Check {cause}.",
            key,
        )


@contextmanager
def suspecting(odd: Sequence[OddValue]) -> Iterator[None]:
    """Put the first odd value before the message of an error raised inside, as its most likely cause.

    A ConvergenceError becomes an InputError, because other input is needed.
    """
    try:
        yield
    except (InputError, ConvergenceError) as error:
        if not odd:
            raise
        first = odd[0]
        sentence = f"{first.sentence} This is the probable cause of the following error: {error}"
        reworded = error.reworded(sentence) if isinstance(error, InputError) else InputError(sentence)
        if first.key:
            reworded.concern(first.key)
        raise reworded from error
