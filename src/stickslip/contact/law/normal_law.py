"""Normal contact laws of a static solution: the force of each pair over its closure, with its derivative."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.preload import checked_area
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, require_positive

# A law over the pressure is tabulated at this number of pressures, evenly spaced in their logarithm.
TABLE_POINTS = 2000


class NormalLaw(Protocol):
    """Force over closure: ``closure`` (n_pairs,) m is 0 at first touch and above 0 when pressed together.

    The force (n_pairs,) in N continues below zero for an open pair, where it only measures the distance from touching;
    the derivative (n_pairs,) in N/m is above zero.
    """

    def force(self, closure: FloatArray) -> tuple[FloatArray, FloatArray]: ...


@dataclass(frozen=True)
class SpringLaw:
    """``N = k_n closure``, with ``normal_stiffness`` (n_pairs,) N/m."""

    normal_stiffness: FloatArray

    def force(self, closure: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and stiffness at the closure."""
        return self.normal_stiffness * closure, self.normal_stiffness


@dataclass(frozen=True)
class FaceLaws:
    """A law for each face: ``face`` (n_pairs,) is the index in ``laws`` of the law of a pair."""

    face: NDArray[np.int64]
    laws: tuple[NormalLaw, ...]

    def force(self, closure: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and stiffness at the closure."""
        force, slope = np.empty_like(closure), np.empty_like(closure)
        for number, law in enumerate(self.laws):
            members = self.face == number
            force[members], slope[members] = law.force(closure[members])
        return force, slope


@dataclass(frozen=True)
class PressureGapLaw:
    """``N_i = A_i p(closure_i)`` from a table of pressures over closures, linear between its entries and beyond.

    Parameters
    ----------
    area:
        (n_pairs,) m2.
    closure, pressure:
        (n_points,) m and Pa, both rising from (0, 0).

    Raises
    ------
    InputError
        for a table that does not rise, or does not start at (0, 0).
    """

    area: FloatArray
    closure: FloatArray
    pressure: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "area", checked_area(self.area))
        for name, unit in (("closure", "m"), ("pressure", "Pa")):
            table = finite_array(name, getattr(self, name))
            if table.ndim != 1 or table.size < 2 or table[0] != 0.0 or not (np.diff(table) > 0.0).all():
                raise InputError(
                    f"{name} of a pressure-gap law must be (n_points,) values in {unit} that start at 0 and rise, at "
                    f"least two of them, but the shape is {table.shape}, from {table.flat[0]:g} to {table.flat[-1]:g}.",
                    arguments=[name],
                )
            object.__setattr__(self, name, table)
        if self.closure.size != self.pressure.size:
            raise InputError(
                f"closure has {self.closure.size} entries and pressure {self.pressure.size}; a pressure-gap law "
                "requires one pressure for each closure.",
                arguments=["closure"],
            )

    @classmethod
    def from_stiffness(
        cls, area: ArrayLike, stiffness: Callable[[FloatArray], FloatArray], lowest: float, highest: float
    ) -> PressureGapLaw:
        """The law whose slope is a stiffness over pressure: ``closure(p) = integral of dp / kappa(p)``.

        ``stiffness`` gives kappa (k,) in N/m3 at pressures (k,) in Pa. Below the ``lowest`` pressure kappa is constant,
        because many laws vanish at zero pressure, and above the ``highest`` too. Raises InputError unless 0 < lowest <
        highest and kappa is above zero.
        """
        if not 0.0 < lowest < highest:
            raise InputError(f"the pressures must satisfy 0 < lowest < highest, but are {lowest:g} and {highest:g} Pa.")
        pressure = np.geomspace(lowest, highest, TABLE_POINTS)
        kappa = finite_array("stiffness", stiffness(pressure))
        require_positive("stiffness", kappa, "A pressure-gap law requires a stiffness per area at each pressure.")
        slope = 0.5 * (1.0 / kappa[1:] + 1.0 / kappa[:-1])
        first = lowest / kappa[0]
        closure = np.concatenate([[0.0, first], first + np.cumsum(slope * np.diff(pressure))])
        return cls(np.asarray(area, dtype=float), closure, np.concatenate([[0.0], pressure]))

    def force(self, closure: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and stiffness at the closure."""
        interval = np.clip(np.searchsorted(self.closure, closure, side="right") - 1, 0, self.closure.size - 2)
        slope = (np.diff(self.pressure) / np.diff(self.closure))[interval]
        pressure = self.pressure[interval] + slope * (closure - self.closure[interval])
        return self.area * pressure, self.area * slope
