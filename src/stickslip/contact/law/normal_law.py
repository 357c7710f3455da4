"""Normal contact laws of a static solution: the force of each pair over its closure, with its derivative."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.preload import checked_area
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, finite_array, per_pair, require_positive, set_fields

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
    """``N_i = A_i p(closure_i)`` from a table of pressures over closures, linear beyond it.

    Between its entries it is linear, or with ``stiffness`` the compliance ``1 / stiffness`` is linear in the pressure,
    so that the slope has no jumps. Jumps of a fine table are small, but they make derivatives of a preload useless.

    Parameters
    ----------
    area:
        (n_pairs,) m2.
    closure, pressure:
        (n_points,) m and Pa, both rising from (0, 0).
    stiffness:
        None, or (n_points,) N/m3, the slope at each entry, from which the closure follows by the trapezoidal rule.

    Raises
    ------
    InputError
        for a table that does not rise, does not start at (0, 0), or has another closure than that of its stiffness.
    """

    area: FloatArray
    closure: FloatArray
    pressure: FloatArray
    stiffness: FloatArray | None = None

    __repr__ = short_repr

    def __init__(
        self, area: ArrayLike, closure: ArrayLike, pressure: ArrayLike, stiffness: ArrayLike | None = None
    ) -> None:
        set_fields(self, area=area, closure=closure, pressure=pressure, stiffness=stiffness)
        self.__post_init__()

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
        if self.stiffness is not None:
            stiffness = per_pair("stiffness", self.stiffness, self.pressure.size)
            require_positive(
                "stiffness", stiffness, "A pressure-gap law requires a stiffness per area at each pressure."
            )
            if not np.allclose(np.diff(self.closure), _closing(self.pressure, stiffness), rtol=1e-9, atol=0.0):
                raise InputError(
                    "closure does not follow from stiffness: between two entries it must grow by the step of the "
                    "pressure times the mean of 1 / stiffness. Use PressureGapLaw.from_stiffness.",
                    arguments=["closure", "stiffness"],
                )
            object.__setattr__(self, "stiffness", stiffness)

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
        pressure, kappa = np.concatenate([[0.0], pressure]), np.concatenate([kappa[:1], kappa])
        closure = np.concatenate([[0.0], np.cumsum(_closing(pressure, kappa))])
        return cls(np.asarray(area, dtype=float), closure, pressure, kappa)

    def force(self, closure: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and stiffness at the closure."""
        interval = np.clip(np.searchsorted(self.closure, closure, side="right") - 1, 0, self.closure.size - 2)
        if self.stiffness is None:
            slope = (np.diff(self.pressure) / np.diff(self.closure))[interval]
            pressure = self.pressure[interval] + slope * (closure - self.closure[interval])
            return self.area * pressure, self.area * slope
        compliance = 1.0 / self.stiffness
        bend = (np.diff(compliance) / np.diff(self.pressure))[interval]
        beyond = np.maximum(closure - self.closure[-1], 0.0)
        step = closure - beyond - self.closure[interval]
        # d closure = (compliance + bend x) dx, x the pressure above that of the entry
        root = np.sqrt(compliance[interval] ** 2 + 2.0 * bend * step)
        rise = 2.0 * step / (compliance[interval] + root)
        pressure = self.pressure[interval] + rise + self.stiffness[-1] * beyond
        return self.area * pressure, self.area / root


def _closing(pressure: FloatArray, stiffness: FloatArray) -> FloatArray:
    """(n_points - 1,) m between neighbours, by the trapezoidal rule for ``dp / stiffness``."""
    return np.asarray(0.5 * (1.0 / stiffness[1:] + 1.0 / stiffness[:-1]) * np.diff(pressure))
