"""Stress at the peak for results files and pages: its extremes with their positions, and its values on the surface."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import finite_array
from stickslip.results.stored import StoredGroup
from stickslip.results.variables import Entry, Labelled, Numbers, Text, Variables, json_text, stored

STATIC_STATES = ("solved", "prescribed", "none")


class Region(IntEnum):
    """The location of a node."""

    ORDINARY = 0
    CONTACT = 1  # on a contact face, or in a cell that touches one
    LOAD = 2  # where a force acts, or in a cell there
    CONSTRAINED = 3


REGION_WORDS = {
    Region.ORDINARY: "",
    Region.CONTACT: "in the cells at a contact",
    Region.LOAD: "in the cells at a load",
    Region.CONSTRAINED: "constrained node",
}


@dataclass(frozen=True)
class StressExtreme:
    """The extreme of a measure of stress: value in Pa (a factor for safety), body, position (3,) m, code of region."""

    quantity: str
    value: float
    body: str
    position: tuple[float, float, float]
    region: int


@dataclass(frozen=True, eq=False)
class SurfaceStress(Labelled):
    """Measures at the points of a sketch: largest von Mises and alternating stress, Pa; safety factor or None."""

    von_mises: NDArray[np.float32] = field(
        metadata=stored(
            Numbers(("point",), "Pa", "largest von Mises stress of the cycle", np.float32, name="surface_von_mises")
        )
    )
    alternating: NDArray[np.float32] = field(
        metadata=stored(Numbers(("point",), "Pa", "alternating stress", np.float32, name="surface_alternating"))
    )

    def __post_init__(self) -> None:
        for name in ("von_mises", "alternating"):
            array = finite_array(f"{name} of the surface", getattr(self, name))
            if array.ndim != 1 or array.shape != np.shape(self.von_mises) or (array < 0.0).any():
                raise InputError(f"{name} of the surface must be one value of at least 0 Pa for each point.")
            object.__setattr__(self, name, array.astype(np.float32))


@dataclass(frozen=True)
class _Extremes(Entry):
    """Extremes as a JSON list of objects."""

    long_name: str

    def variables(self, owner: Any, field: str) -> Variables:
        return {self.label(field): json_text([asdict(row) for row in getattr(owner, field)], self.long_name)}

    def read(self, group: StoredGroup, field: str, harmonics: int) -> tuple[StressExtreme, ...]:
        rows = group.parsed(self.label(field), list[StressExtreme])
        return tuple(rows)


@dataclass(frozen=True, eq=False)
class StressSummary(Labelled):
    """The stress at the peak in numbers.

    extremes:
        of each measure away from contacts and loads.
    everywhere:
        of each measure on the whole mesh, cells at contacts and loads included.
    frequency_hz, force, displacement:
        of the peak: Hz; amplitude of the excitation force in N; 0-to-peak displacement of the response in m.
    static:
        "solved", "prescribed" or "none" (:class:`stickslip.study.stress.StressAtPeak`).
    truncation:
        largest part of the vibration stress by omitted modes over the largest alternating stress.
    goodman:
        smallest safety factor of each body that has both strengths, away from contacts and loads.
    goodman_message:
        the check in words, or the reason why there is none.
    """

    extremes: tuple[StressExtreme, ...] = field(
        metadata=stored(_Extremes("extremes of stress away from contacts and loads, JSON list"))
    )
    everywhere: tuple[StressExtreme, ...] = field(
        metadata=stored(_Extremes("extremes of stress on the whole mesh, JSON list"))
    )
    goodman: tuple[StressExtreme, ...] = field(
        metadata=stored(_Extremes("smallest safety factors of bodies, JSON list"))
    )
    goodman_message: str = field(metadata=stored(Text("the Goodman check in words")))
    static: str = field(metadata=stored(Text("state at rest in the stress: solved, prescribed or none")))
    frequency_hz: float = field(metadata=stored(Numbers((), "Hz", "frequency of the peak", name="stress_frequency")))
    force: float = field(metadata=stored(Numbers((), "N", "amplitude of the excitation force")))
    displacement: float = field(metadata=stored(Numbers((), "m", "0-to-peak displacement of the response")))
    truncation: float = field(
        metadata=stored(Numbers((), "1", "part of the vibration stress by omitted modes over the alternating stress"))
    )

    def __post_init__(self) -> None:
        if str(self.static) not in STATIC_STATES:
            raise InputError(
                f'static is "{self.static}", but must be one of {", ".join(STATIC_STATES)}.', arguments=["static"]
            )
        for name in ("frequency_hz", "force", "displacement", "truncation"):
            object.__setattr__(self, name, float(getattr(self, name)))

    def extreme(self, quantity: str) -> StressExtreme:
        """The extreme of a measure away from contacts and loads. Raises InputError for an unknown one."""
        rows = [row for row in self.extremes if row.quantity == quantity]
        if not rows:
            names = ", ".join(row.quantity for row in self.extremes)
            raise InputError(f'quantity is "{quantity}", but must be one of {names}.', arguments=["quantity"])
        return rows[0]
