"""A contact stiffness per area that does not depend on the pressure."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stickslip.contact.constants import constant
from stickslip.core.validation import FloatArray, positive_number


@dataclass(frozen=True)
class ConstantStiffness:
    """The same stiffness per area at each pressure.

    Parameters
    ----------
    normal_stiffness, tangential_stiffness:
        N/m3, above zero.

    Raises
    ------
    InputError
        for a value that is not above zero.
    """

    normal_stiffness: float = field(metadata=constant("N/m^3", description="per area"))
    tangential_stiffness: float = field(metadata=constant("N/m^3", description="per area"))

    def __post_init__(self) -> None:
        for name in ("normal_stiffness", "tangential_stiffness"):
            object.__setattr__(self, name, positive_number(name, getattr(self, name), "N/m3"))

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return np.full(np.shape(pressure), self.normal_stiffness)

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return np.full(np.shape(pressure), self.tangential_stiffness)

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """No message: the law is what the user gives."""
        return ()

    def describe(self) -> str:
        """The law in one line."""
        return f"{self.normal_stiffness:.3g} N/m3 normal and {self.tangential_stiffness:.3g} N/m3 tangential"
