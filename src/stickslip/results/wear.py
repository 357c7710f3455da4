"""The result of wear: depth, normal load and response of a joint against the number of cycles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, require_positive
from stickslip.results.groups import read_groups, write_groups
from stickslip.results.table import Table, column_of
from stickslip.results.variables import Attribute, Json, Labelled, Numbers, Text, stored
from stickslip.results.wear_figure import wear_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MICRO, _CUBIC_MILLI = 1e6, 1e9  # m to µm, m3 to mm3
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
    area, energy_wear_coefficient:
        (n_pairs,) m2, and m3/J: volume that both faces lose for each joule of friction.
    converged, message:
        whether the states cover all cycles, and a message.
    warnings:
        messages, for example on another peak that became the highest.
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
    energy_wear_coefficient: FloatArray = field(
        metadata=stored(Numbers(("pair",), "m3 J-1", "worn volume for each joule of friction"))
    )
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message of the wear at its end")))
    warnings: tuple[str, ...] = field(metadata=stored(Json(list[str], "warnings, JSON list")))
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
        object.__setattr__(self, "warnings", tuple(self.warnings))

    def __repr__(self) -> str:
        return (
            f"Wear({self.cycles[-1]:.4g} cycles in {self.n_states} states: depth up to "
            f"{_MICRO * self.depth[-1].max():.3g} um, amplitude {_MICRO * self.amplitude[0]:.4g} to "
            f"{_MICRO * self.amplitude[-1]:.4g} um; {'converged' if self.converged else 'NOT converged'})"
        )

    @property
    def n_states(self) -> int:
        """Number of states, with that before the wear."""
        return int(self.cycles.size)

    @property
    def volume(self) -> FloatArray:
        """(n_states,) m3 worn so far from all pairs."""
        return np.asarray(self.depth @ self.area)

    @property
    def mean_depth(self) -> FloatArray:
        """(n_states,) m, volume over the area of all pairs."""
        return np.asarray(self.volume / self.area.sum())

    @property
    def energy_volume(self) -> FloatArray:
        """(n_states,) m3: coefficient times the friction energy so far, a monotone cubic through the states.

        It differs from :attr:`volume` by the errors of both integrations, and where another peak takes over.
        """
        rate = PchipInterpolator(self.cycles, self.friction_energy @ self.energy_wear_coefficient)
        return np.asarray(rate.antiderivative()(self.cycles))

    @property
    def open_pairs(self) -> NDArray[np.int64]:
        """(n_states,) number of pairs without a load at rest."""
        return np.asarray((self.normal_load == 0.0).sum(axis=1))

    @property
    def total_normal_stiffness(self) -> FloatArray:
        """(n_states,) N/m, sum over all pairs."""
        return np.asarray(self.normal_stiffness.sum(axis=1))

    @property
    def changes_stiffness(self) -> bool:
        """Whether the total normal stiffness leaves its first value by more than 0.1 %."""
        total = self.total_normal_stiffness
        return bool((np.abs(total - total[0]) > 1e-3 * total[0]).any())

    def words(self) -> Iterator[str]:
        """Sentences on what wears, and what it does to the motion."""
        first, last = self.amplitude[0], self.amplitude[-1]
        if not self.depth[-1].any():
            yield "No pair slips, so nothing wears."
            return
        yield (
            f"After {self.cycles[-1]:.4g} cycles both faces of a pair together have lost up to "
            f"{_MICRO * self.depth[-1].max():.3g} µm, {_MICRO * self.mean_depth[-1]:.3g} µm in the mean, in all "
            f"{_CUBIC_MILLI * self.volume[-1]:.3g} mm³."
        )
        low, high = self.amplitude.min(), self.amplitude.max()
        between = f", between {_MICRO * low:.4g} and {_MICRO * high:.4g} µm"
        yield (
            f"The amplitude goes from {_MICRO * first:.4g} to {_MICRO * last:.4g} µm ({_percent(last / first)})"
            f"{'' if {low, high} <= {first, last} else between}; the frequency from {self.frequency_hz[0]:.2f} to "
            f"{self.frequency_hz[-1]:.2f} Hz."
        )
        if self.changes_stiffness:
            stiffness = self.total_normal_stiffness
            yield (
                f"The normal stiffness of all pairs goes from {stiffness[0]:.4g} to {stiffness[-1]:.4g} N/m "
                f"({_percent(stiffness[-1] / stiffness[0])}), because roughness runs in or loads move "
                "between the pairs."
            )
        before, after = int(self.open_pairs[0]), int(self.open_pairs[-1])
        if after or before:
            yield f"Pairs without load at rest: {before} of {self.area.size} before, {after} after."

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """See :class:`stickslip.results.part.ResultPart`: the states, and the pairs at the end."""
        columns = (
            column_of("cycles", "", self.cycles),
            column_of("amplitude", "m", self.amplitude),
            column_of("frequency", "Hz", self.frequency_hz),
            column_of("largest depth", "m", self.depth.max(axis=1)),
            column_of("mean depth", "m", self.mean_depth),
            column_of("volume", "m3", self.volume),
            column_of("volume from energy", "m3", self.energy_volume),
            column_of("friction energy per cycle", "J", self.friction_energy.sum(axis=1)),
            column_of("open pairs", "", self.open_pairs),
        )
        yield Table(name, "states of the wear against cycles; amplitude 0-to-peak", columns)
        pairs = (
            column_of("pair", "", np.arange(1, self.area.size + 1)),
            column_of("depth", "m", self.depth[-1]),
            column_of("normal load before", "N", self.normal_load[0]),
            column_of("normal load after", "N", self.normal_load[-1]),
            column_of("normal stiffness before", "N/m", self.normal_stiffness[0]),
            column_of("normal stiffness after", "N/m", self.normal_stiffness[-1]),
            column_of("area", "m2", self.area),
        )
        yield Table("worn_pairs", "pairs at the end of the wear", pairs)

    def closing_words(self, name: str) -> Iterator[str]:
        """See :class:`stickslip.results.part.ResultPart`: what the wear removes and changes."""
        yield f"Wear: {self.message} {self.n_states} states."
        yield from (f"  {sentence}" for sentence in self.words())
        yield from (f"Warning: {sentence}" for sentence in self.warnings)

    def plot(self) -> Figure:
        """Amplitude, frequency, and largest and mean depth over the cycles, as a figure of matplotlib."""
        return wear_figure(self.cycles, self.amplitude, self.frequency_hz, self.depth.max(axis=1), self.mean_depth)

    def save(self, path: str | PathLike[str]) -> None:
        """Write one NetCDF-4 file, completely or not at all. Raises ResultsFileError if it cannot be written."""
        write_groups(path, self.to_groups())

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Wear:
        """Read a file of :meth:`save`; the object is equal. Raises ResultsFileError."""
        return read_groups(path, cls.from_group)


def _percent(ratio: float) -> str:
    """The change to this multiple: "-28 %", "+120 %"."""
    change = 100.0 * (ratio - 1.0)
    return f"{change:+.2g} %" if abs(change) < 99.5 else f"{change:+.0f} %"
