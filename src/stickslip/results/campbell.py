"""Natural frequencies over the speed of rotation, and their crossings with engine orders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from stickslip.core.short_repr import short_repr
from stickslip.core.units import Quantity
from stickslip.core.validation import FloatArray, require_choice
from stickslip.results.campbell_plot import campbell_plot
from stickslip.results.comparison import Compared

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEED_KEY = "rotation.speed"
RPM = 60.0 / (2.0 * np.pi)  # rad/s to revolutions per minute
SHOWN_MODES = 6  # chosen: more lines cannot be distinguished
ABOVE = 1.25  # chosen: modes up to this multiple of the highest computed excitation frequency
MOST_ORDERS = 24  # chosen: more engine orders cover the figure


@dataclass(frozen=True)
class Crossing:
    """A natural frequency ``frequency_hz`` that is a multiple of the speed ``speed_rpm``; mode and order from 1."""

    mode: int
    order: int
    speed_rpm: float
    frequency_hz: float


@dataclass(frozen=True, eq=False)
class Campbell:
    """Natural frequencies of one structure at different speeds, of several results or of :func:`campbell_diagram`.

    speed_rpm:
        (s,) rising.
    stuck_hz, free_hz:
        (s, modes) Hz, pairs closed at rest stuck, and without contact; NaN where a result has fewer modes.
    names:
        (s,) of the results or speeds.
    asked:
        engine orders of the excitation of the results, in rising order; empty for those without a travelling wave.
    """

    names: tuple[str, ...]
    speed_rpm: FloatArray
    stuck_hz: FloatArray
    free_hz: FloatArray
    asked: tuple[int, ...] = ()

    __repr__ = short_repr

    @property
    def highest_hz(self) -> float:
        """The highest frequency of both limits."""
        return float(max(np.nanmax(self.stuck_hz), np.nanmax(self.free_hz)))

    @property
    def orders(self) -> tuple[int, ...]:
        """Engine orders whose line meets the range of the frequencies between the lowest and the highest speed."""
        lowest = float(min(np.nanmin(self.stuck_hz), np.nanmin(self.free_hz)))
        first = max(1, int(np.ceil(60.0 * lowest / self.speed_rpm[-1])))
        last = int(60.0 * self.highest_hz / max(self.speed_rpm[0], 1e-9 * self.speed_rpm[-1]))
        return tuple(range(first, min(last, first + MOST_ORDERS - 1) + 1))

    def crossings(self, limit: Literal["stuck", "free"] = "stuck") -> tuple[Crossing, ...]:
        """The crossings of the frequencies of a limit with the lines of the ``asked`` orders, or of all ``orders``.

        Sorted by speed.
        """
        require_choice("limit", limit, ("stuck", "free"))
        frequency_hz = self.stuck_hz if limit == "stuck" else self.free_hz
        return crossings(self.speed_rpm, frequency_hz, self.asked or self.orders)

    def plot(self) -> Figure:
        """The diagram as a figure of matplotlib."""
        marks = [(each.speed_rpm, each.frequency_hz) for each in self.crossings()]
        return campbell_plot(self.speed_rpm, self.stuck_hz, self.free_hz, self.asked or self.orders, marks)


def campbell(compared: Sequence[Compared]) -> Campbell | None:
    """The frequencies of results with ``[rotation]``, in the order of their speeds; None for fewer than two speeds.

    Raises InputError for inputs that are no study file.
    """
    quantity = Quantity("speed of rotation")
    texts = [each.study.input_values().get(SPEED_KEY) for each in compared]
    turning = [
        (RPM * quantity.parse(text), each) for text, each in zip(texts, compared, strict=True) if text is not None
    ]
    if len({speed for speed, _ in turning}) < 2:
        return None
    turning.sort(key=lambda pair: pair[0])
    highest = ABOVE * max(float(each.response.frequency_hz.max()) for _, each in turning)
    stuck, free = (
        _lowest([getattr(each.response.linear, f"{limit}_frequency_hz") for _, each in turning], highest)
        for limit in ("stuck", "free")
    )
    names = tuple(each.name for _, each in turning)
    orders = {each.study.disk.engine_order for _, each in turning if each.study.disk is not None}
    asked = tuple(sorted(orders - {0}))
    return Campbell(names, np.array([speed for speed, _ in turning]), stuck, free, asked)


def _lowest(frequencies: Sequence[FloatArray], highest: float) -> FloatArray:
    """(s, modes) Hz, at least one mode and those that are below ``highest`` at some speed; NaN where there is none."""
    padded = np.full((len(frequencies), SHOWN_MODES), np.nan)
    for row, frequency in zip(padded, frequencies, strict=True):
        shown = frequency[:SHOWN_MODES]
        row[: shown.size] = shown
    return padded[:, : max(1, int((padded < highest).any(axis=0).sum()))]


def crossings(speed_rpm: FloatArray, frequency_hz: FloatArray, orders: Sequence[int]) -> tuple[Crossing, ...]:
    """Crossings of frequencies (s, modes) with ``order * speed / 60``, frequencies straight between two speeds.

    Sorted by speed. A frequency that touches a line at a speed counts once.
    """
    crossings = []
    for order in orders:
        excess = frequency_hz - order * speed_rpm[:, None] / 60.0
        for mode in range(frequency_hz.shape[1]):
            for at in range(len(speed_rpm) - 1):
                low, high = excess[at, mode], excess[at + 1, mode]
                ends_here = high == 0.0 and at + 2 < len(speed_rpm)  # it is the start of the next interval
                if np.isnan(low + high) or low * high > 0.0 or low == high or ends_here:
                    continue
                speed = speed_rpm[at] + low / (low - high) * (speed_rpm[at + 1] - speed_rpm[at])
                crossings.append(Crossing(mode + 1, order, float(speed), order * float(speed) / 60.0))
    return tuple(sorted(crossings, key=lambda crossing: crossing.speed_rpm))
