"""A stiffness law times a factor: a calibration to a measurement, or one end of the band of its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.contact.stiffness.stiffness_law import StiffnessLaw
from stickslip.core.validation import FloatArray, positive_number


@dataclass(frozen=True)
class ScaledStiffness:
    """``factor`` times the normal and the tangential stiffness of ``law``; InputError unless it is above zero."""

    law: StiffnessLaw
    factor: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "factor", positive_number("factor", self.factor, "1"))

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return self.factor * self.law.normal(pressure)

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return self.factor * self.law.tangential(pressure)

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """The messages of the law."""
        return self.law.valid(pressure)

    def describe(self) -> str:
        """The law in one line."""
        return f"{self.factor:g} times: {self.law.describe()}"
