"""The result of wear: depth, normal load and response of a joint against the number of cycles."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, require_positive
from stickslip.results.variables import Attribute, Json, Labelled, Numbers, Text, stored

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STATES, _PAIRS = ("wear_state",), ("wear_state", "pair")


@dataclass(frozen=True, eq=False)
class Wear(Labelled):
    """A joint that wears: its states in the order of the cycles, the first one without wear (docs/theory_wear.md).

    Parameters
    ----------
    cycles:
        (n_states,) number of cycles, from 0.
    depth:
        (n_states, n_pairs) m, worn from both faces of a pair together.
    normal_load:
        (n_states, n_pairs) N at rest, 0 where wear opened the pair.
    friction_energy:
        (n_states, n_pairs) J per cycle.
    amplitude, frequency_hz:
        (n_states,) amplitude of the output, 0-to-peak (m for a displacement), and frequency of the motion in Hz.
    normal_stiffness:
        (n_states, n_pairs) N/m at rest.
    area:
        (n_pairs,) m2.
    converged, message:
        whether the states cover all cycles, and a message.
    settings, provenance:
        options of the run; software and machine.
    """

    DATASET_TITLE: ClassVar[str] = "Wear of a joint with rough, dry-friction contact"

    cycles: FloatArray = field(metadata=stored(Numbers(_STATES, "1", "number of cycles")))
    depth: FloatArray = field(metadata=stored(Numbers(_PAIRS, "m", "worn depth of both faces")))
    normal_load: FloatArray = field(metadata=stored(Numbers(_PAIRS, "N", "normal load at rest")))
    friction_energy: FloatArray = field(metadata=stored(Numbers(_PAIRS, "J", "energy of friction per cycle")))
    amplitude: FloatArray = field(metadata=stored(Numbers(_STATES, "m", "amplitude of the output, 0-to-peak")))
    frequency_hz: FloatArray = field(
        metadata=stored(Numbers(_STATES, "Hz", "frequency of the motion", name="frequency"))
    )
    normal_stiffness: FloatArray = field(metadata=stored(Numbers(_PAIRS, "N m-1", "normal stiffness at rest")))
    area: FloatArray = field(metadata=stored(Numbers(("pair",), "m2", "area of the pair")))
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message of the wear at its end")))
    settings: dict[str, str | float | int] = field(
        metadata=stored(Json(dict[str, str | float | int | None], "settings of the wear, JSON object"))
    )
    provenance: dict[str, str] = field(metadata=stored(Json(dict[str, str], "software and machine, JSON object")))

    def __post_init__(self) -> None:
        n_states, n_pairs = np.shape(self.depth)
        self._require_sizes({"wear_state": n_states, "pair": n_pairs})
        require_positive("area", self.area, "A pair that wears has an area.")
        if self.cycles[0] != 0.0 or (np.diff(self.cycles) <= 0.0).any():
            raise InputError("cycles must begin with 0 and rise.", arguments=["cycles"])

    @property
    def volume(self) -> FloatArray:
        """(n_states,) m3, worn so far."""
        return np.asarray(self.depth @ self.area)

    @property
    def energy(self) -> FloatArray:
        """(n_states,) J, dissipated by friction so far: the trapezoidal sum over the states."""
        rate = self.friction_energy.sum(axis=1)
        return np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(self.cycles)))

    @property
    def open_pairs(self) -> FloatArray:
        """(n_states,) number of pairs without a load at rest."""
        return np.asarray((self.normal_load == 0.0).sum(axis=1))

    def __repr__(self) -> str:
        return (
            f"Wear({self.cycles[-1]:.4g} cycles in {self.cycles.size} states: depth up to {1e6 * self.depth[-1].max():.3g} um, "
            f"amplitude {1e6 * self.amplitude[0]:.4g} to {1e6 * self.amplitude[-1]:.4g} um; "
            f"{'converged' if self.converged else 'NOT converged'})"
        )

    def plot(self) -> Figure:
        """Amplitude and largest and mean depth over the cycles, a matplotlib figure."""
        from stickslip.results.wear_figure import wear_figure

        return wear_figure(self.cycles, self.amplitude, self.depth, self.area)
