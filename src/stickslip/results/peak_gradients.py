"""The result of the gradients of a peak: what each input changes in its amplitude, frequency and friction energy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from stickslip.core.validation import FloatArray, real_number, require_positive
from stickslip.results.gradient_figure import tornado_figure
from stickslip.results.table import Table, column_of
from stickslip.results.variables import Json, Labelled, Numbers, stored

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PARAMETER = ("parameter",)

STRONGEST = 5  # chosen: inputs whose gradients the command prints; the page has all


@dataclass(frozen=True, eq=False)
class PeakGradients(Labelled):
    """Derivatives of a peak of one output by parameters (docs/theory_gradients.md).

    Parameters
    ----------
    names, units:
        name and unit of each parameter.
    value:
        (n_parameters,) its value, in that unit.
    amplitude, frequency_hz, friction_energy:
        of the refined peak: 0-to-peak amplitude (m for a displacement), frequency in Hz and energy in J per cycle that
        friction dissipates.
    by_amplitude, by_frequency_hz, by_friction_energy:
        (n_parameters,) derivatives of these three by the parameter, over its unit.
    error_amplitude, error_frequency_hz, error_friction_energy:
        (n_parameters,) estimated errors of the derivatives, in their units.
    messages:
        sentences on parameters without a derivative, which the arrays do not contain, and on uncertain derivatives.

    Raises
    ------
    InputError
        for arrays of different length, or a peak without amplitude or frequency.
    """

    DATASET_TITLE: ClassVar[str] = "Derivatives of a peak by parameters"

    names: tuple[str, ...] = field(metadata=stored(Json(list[str], "names of the parameters, JSON list")))
    units: tuple[str, ...] = field(metadata=stored(Json(list[str], "units of the parameters, JSON list")))
    value: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "1", "value of the parameter in its unit")))
    amplitude: FloatArray = field(metadata=stored(Numbers((), "m", "amplitude of the peak, 0-to-peak")))
    frequency_hz: FloatArray = field(metadata=stored(Numbers((), "Hz", "frequency of the peak", name="frequency")))
    friction_energy: FloatArray = field(metadata=stored(Numbers((), "J", "dissipated by friction per cycle")))
    by_amplitude: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "m", "derivative of the amplitude")))
    by_frequency_hz: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "Hz", "derivative of the frequency")))
    by_friction_energy: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "J", "derivative of the energy")))
    error_amplitude: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "m", "error of its derivative")))
    error_frequency_hz: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "Hz", "error of its derivative")))
    error_friction_energy: FloatArray = field(metadata=stored(Numbers(_PARAMETER, "J", "error of its derivative")))
    messages: tuple[str, ...] = field(default=(), metadata=stored(Json(list[str], "messages, JSON list")))

    def __post_init__(self) -> None:
        for name in ("names", "units", "messages"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        self._require_sizes({"parameter": len(self.names)})
        for name in ("amplitude", "frequency_hz"):
            require_positive(name, np.atleast_1d(getattr(self, name)), "A peak requires a motion.")

    def __repr__(self) -> str:
        strongest = f"; strongest: {self.names[self.order[0]]}" if self.names else ""
        return (
            f"PeakGradients({1e6 * float(self.amplitude):.4g} um at {float(self.frequency_hz):.2f} Hz by "
            f"{len(self.names)} parameters{strongest})"
        )

    def relative_changes(self, change: float = 0.1) -> FloatArray:
        """(3, n_parameters) what a relative ``change`` of each parameter does to amplitude, frequency and energy, first
        order and relative to them; energy: zero without friction."""
        step = real_number("change", change) * self.value
        energy = float(self.friction_energy)
        by_energy = self.by_friction_energy / energy if energy > 0.0 else np.zeros(len(self.names))
        return np.asarray(
            [
                step * self.by_amplitude / self.amplitude,
                step * self.by_frequency_hz / self.frequency_hz,
                step * by_energy,
            ]
        )

    @property
    def order(self) -> list[int]:
        """The parameters by the size of the relative change of the amplitude, the largest first."""
        return [int(place) for place in np.argsort(-np.abs(self.relative_changes()[0]), kind="stable")]

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """See :class:`stickslip.results.part.ResultPart`: derivatives, each over the unit of its parameter."""
        columns = (
            column_of("parameter", "", self.names),
            column_of("value", "", self.value),
            column_of("unit", "", self.units),
            column_of("amplitude by it", "m", self.by_amplitude),
            column_of("error of the amplitude", "m", self.error_amplitude),
            column_of("frequency by it", "Hz", self.by_frequency_hz),
            column_of("error of the frequency", "Hz", self.error_frequency_hz),
            column_of("friction energy by it", "J", self.by_friction_energy),
            column_of("error of the friction energy", "J", self.error_friction_energy),
        )
        yield Table(name, "derivatives of the peak by each parameter, for one unit of it", columns)

    def closing_words(self, name: str) -> Iterator[str]:
        """See :class:`stickslip.results.part.ResultPart`: the strongest inputs."""
        yield "Change of the peak amplitude by 10 % more of an input, first order:"
        changes, strongest = self.relative_changes(0.1)[0], self.order[:STRONGEST]
        width = max((len(self.names[place]) for place in strongest), default=0)
        for place in strongest:
            percent = float(f"{100 * changes[place]:.2g}")  # two digits, but -100, not -1e+02
            yield f"  {self.names[place]:<{width}}  {percent:+g} %"
        yield from (f"Note: {sentence}" for sentence in self.messages)

    def plot(self, change: float = 0.1, count: int = 15) -> Figure:
        """A tornado plot: what a relative ``change`` of each parameter to both sides does to the amplitude, the
        strongest ``count`` parameters, as a figure of matplotlib."""
        shown = self.order[:count]
        percent = 100.0 * self.relative_changes(change)[0]
        return tornado_figure([self.names[place] for place in shown], percent[shown], 100.0 * change)
