"""Natural frequencies of a tuned disk over the speed of rotation, and the engine orders that excite them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, require_choice
from stickslip.results.campbell import MOST_ORDERS, Crossing, crossings
from stickslip.results.campbell_plot import disk_campbell_plot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WaveDirection = Literal["forward", "backward"]


@dataclass(frozen=True)
class DiskCrossing(Crossing):
    """A crossing of a wave of a nodal diameter in one direction with an engine order that excites it."""

    diameter: int
    direction: WaveDirection


@dataclass(frozen=True, eq=False)
class DiskCampbell:
    """Natural frequencies of travelling waves of a disk in the rotating frame.

    sectors:
        number of sectors.
    speed_rpm:
        (s,) rising.
    diameters:
        (k,) nodal diameters.
    stuck_hz, free_hz:
        (2, k, s, modes) Hz of forward and of backward waves, pairs closed at rest stuck, and without contact.
    """

    sectors: int
    speed_rpm: FloatArray
    diameters: tuple[int, ...]
    stuck_hz: FloatArray
    free_hz: FloatArray

    __repr__ = short_repr

    def frequency_hz(
        self, diameter: int, direction: WaveDirection = "forward", limit: Literal["stuck", "free"] = "stuck"
    ) -> FloatArray:
        """(s, modes) Hz of the waves of a nodal diameter. Raises InputError for one that the diagram does not have."""
        require_choice("limit", limit, ("stuck", "free"))
        require_choice("direction", direction, ("forward", "backward"))
        if diameter not in self.diameters:
            raise InputError(
                f"diameter is {diameter}, but the diagram has the nodal diameters "
                f"{', '.join(map(str, self.diameters))}.",
                arguments=["diameter"],
            )
        table = self.stuck_hz if limit == "stuck" else self.free_hz
        return np.asarray(table[int(direction == "backward"), self.diameters.index(diameter)])

    def crossings(self, limit: Literal["stuck", "free"] = "stuck") -> tuple[DiskCrossing, ...]:
        """Where an engine order excites a natural frequency, sorted by speed.

        A force that is constant in space, such as that of vanes, is a backward wave of engine order k in a disk that
        rotates in the positive sense. It excites backward waves of nodal diameter d if k - d is a multiple of the
        number of sectors N, and forward ones if k + d is. Only the first 24 engine orders count.
        """
        found = []
        for diameter in self.diameters:
            for direction, sign in (("backward", 1), ("forward", -1)):
                standing = 2 * diameter % self.sectors == 0  # both directions are the same motion
                if standing and direction == "forward":
                    continue
                orders = [k for k in range(1, MOST_ORDERS + 1) if (k - sign * diameter) % self.sectors == 0]
                table = self.frequency_hz(diameter, direction, limit)  # type: ignore[arg-type]
                for each in crossings(self.speed_rpm, table, orders):
                    place = (each.mode, each.order, each.speed_rpm, each.frequency_hz)
                    found.append(DiskCrossing(*place, diameter, direction))  # type: ignore[arg-type]
        return tuple(sorted(found, key=lambda crossing: crossing.speed_rpm))

    def plot(self) -> Figure:
        """The diagram as a figure of matplotlib: stuck contact, a colour for each nodal diameter."""
        return disk_campbell_plot(self.speed_rpm, self.diameters, self.stuck_hz, self.crossings())
