"""Contact stiffness from a table of measured values: pressure, normal and tangential stiffness per area."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.constants import constant
from stickslip.core.errors import InputError, concerning
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array, require_positive, set_fields

# A load over an area that should be an end of the table differs from it by round-off only.
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class MeasuredStiffness:
    """A stiffness law through measured points, a power law between neighbours: straight in logarithms.

    Measured contact stiffness grows with a power of the pressure (for Ti-6Al-4V k_t with p^0.64: Kartal, Mulvihill,
    Nowell, Hills, Tribol. Int. 44 (2011) 1188), so the table is interpolated in logarithms. Beyond its ends the last
    power continues, and :meth:`valid` reports it; an ultrasonic and a mechanical measurement of one contact differ by a
    factor of 3 (Mulvihill et al., Exp. Mech. 53 (2013) 1245).

    Parameters
    ----------
    pressure:
        (n_points,) Pa, above zero and rising; at least two.
    normal_stiffness, tangential_stiffness:
        (n_points,) N/m3, above zero.

    Raises
    ------
    InputError
        for a wrong shape, a pressure that does not rise, or a value that is not above zero.
    """

    pressure: FloatArray = field(metadata=constant("Pa", is_table=True, description="rising"))
    normal_stiffness: FloatArray = field(metadata=constant("N/m^3", is_table=True, description="per area"))
    tangential_stiffness: FloatArray = field(metadata=constant("N/m^3", is_table=True, description="per area"))

    __repr__ = short_repr

    def __init__(self, pressure: ArrayLike, normal_stiffness: ArrayLike, tangential_stiffness: ArrayLike) -> None:
        set_fields(
            self, pressure=pressure, normal_stiffness=normal_stiffness, tangential_stiffness=tangential_stiffness
        )
        self.__post_init__()

    def __post_init__(self) -> None:
        for name in ("pressure", "normal_stiffness", "tangential_stiffness"):
            values = finite_array(name, getattr(self, name))
            if values.ndim != 1 or values.size < 2:
                raise InputError(
                    f"{name} of measured stiffness must be a list of at least two numbers, but its shape is "
                    f"{values.shape}.",
                    (name,),
                )
            with concerning(name):
                require_positive(name, values, "Measured contact has a stiffness at each pressure.")
            object.__setattr__(self, name, values)
        lengths = {getattr(self, name).size for name in ("pressure", "normal_stiffness", "tangential_stiffness")}
        if len(lengths) > 1:
            raise InputError(
                f"pressure has {self.pressure.size} entries, normal_stiffness {self.normal_stiffness.size} and "
                f"tangential_stiffness {self.tangential_stiffness.size}; give one row for each pressure.",
                arguments=["pressure"],
            )
        if not (np.diff(self.pressure) > 0.0).all():
            first = int(np.flatnonzero(np.diff(self.pressure) <= 0.0)[0]) + 1
            raise InputError(
                f"pressure[{first}] is {self.pressure[first]:g} Pa, not above the one before; sort the rows.",
                ("pressure",),
            )

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return self._at(pressure, self.normal_stiffness)

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return self._at(pressure, self.tangential_stiffness)

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """A sentence for pressures below the table, and one for pressures above it."""
        low, high = self.pressure[0], self.pressure[-1]
        values = np.asarray(pressure, dtype=float)
        sides = (
            ("below", values[values < low * (1.0 - ROUND_OFF)]),
            ("above", values[values > high * (1.0 + ROUND_OFF)]),
        )
        return tuple(
            f"Pressures from {outside.min():.3g} to {outside.max():.3g} Pa are {side} the measured range, {low:.3g} to "
            f"{high:.3g} Pa; the stiffness there continues the power law of the two nearest points."
            for side, outside in sides
            if outside.size
        )

    def describe(self) -> str:
        """The law in one line."""
        return (
            f"{self.pressure.size} measured points from {self.pressure[0]:.3g} to {self.pressure[-1]:.3g} Pa, "
            f"{self.normal_stiffness[0]:.3g} to {self.normal_stiffness[-1]:.3g} N/m3 normal"
        )

    def _at(self, pressure: FloatArray, stiffness: FloatArray) -> FloatArray:
        x, table = np.log(self.pressure), np.log(stiffness)
        wanted = np.log(np.asarray(pressure, dtype=float))
        interval = np.clip(np.searchsorted(x, wanted, side="right") - 1, 0, x.size - 2)
        slope = (np.diff(table) / np.diff(x))[interval]
        return np.asarray(np.exp(table[interval] + slope * (wanted - x[interval])))
