"""Small disturbances along a curve: how multipliers and changes of stability are stored in results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, get_args

import numpy as np

from stickslip.core.validation import argument_error, finite_array, require_choice
from stickslip.results.stored import StoredGroup, UnreadableError
from stickslip.results.variables import Entry, Variables, json_text, variable

BifurcationKind = Literal["fold", "branch point", "period doubling", "torus"]


@dataclass(frozen=True)
class Bifurcation:
    """A point of a curve at which a multiplier leaves or enters the unit circle.

    Attributes
    ----------
    kind:
        "fold": through +1 where the frequency turns; "branch point": through +1 where it does not turn, as where
        an unsymmetric motion branches off; "period doubling": through -1; "torus": a complex pair.
    frequency_hz:
        Hz, between the two points around it; at a fold that at which the frequency turns.
    position:
        number of the point before it, plus the fraction of the way to the next one.
    """

    kind: BifurcationKind
    frequency_hz: float
    position: float

    def __post_init__(self) -> None:
        require_choice("kind", self.kind, get_args(BifurcationKind))


@dataclass(frozen=True)
class BifurcationRows(Entry):
    """Bifurcations as a JSON list."""

    def variables(self, owner: Any, field: str) -> Variables:
        rows = [asdict(each) for each in getattr(owner, field)]
        return {self.label(field): json_text(rows, "changes of stability along the curve, JSON list")}

    def checked(self, field: str, value: Any, sizes: Mapping[str, int]) -> tuple[Bifurcation, ...]:
        return tuple(value)

    def read(self, group: StoredGroup, field: str, harmonics: int) -> tuple[Bifurcation, ...]:
        return tuple(group.parsed(self.label(field), list[Bifurcation]))


@dataclass(frozen=True)
class ComplexNumbers(Entry):
    """Complex numbers (first dimension, any number of columns), as their real and imaginary parts."""

    dims: tuple[str, str]
    unit: str
    long_name: str

    def is_in(self, group: StoredGroup, field: str) -> bool:
        return f"{self.label(field)}_real" in group

    def variables(self, owner: Any, field: str) -> Variables:
        array, name = getattr(owner, field), self.label(field)
        return {
            f"{name}_real": variable(self.dims, array.real, self.unit, f"{self.long_name}, real part"),
            f"{name}_imaginary": variable(self.dims, array.imag, self.unit, f"{self.long_name}, imaginary part"),
        }

    def read(self, group: StoredGroup, field: str, harmonics: int) -> Any:
        real, imaginary = (group.numbers(f"{self.label(field)}_{part}") for part in ("real", "imaginary"))
        if real.shape != imaginary.shape:
            raise UnreadableError(f'the parts of "{self.label(field)}" do not have compatible shapes')
        return real + 1j * imaginary

    def checked(self, field: str, value: Any, sizes: Mapping[str, int]) -> Any:
        array = np.asarray(value, dtype=complex)
        parts = finite_array(field, np.stack([array.real, array.imag]))
        if parts.ndim != 3 or parts.shape[1] != sizes[self.dims[0]]:
            raise argument_error(
                field, f"{field} must have {sizes[self.dims[0]]} rows of numbers, but its shape is {array.shape}."
            )
        return array
