"""The result of a quasi-static estimate of a mode: frequency and damping ratio against amplitude."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.validation import FloatArray, require_positive
from stickslip.results.periodic_motions import CURVE, PAIRS
from stickslip.results.saved import Saved
from stickslip.results.table import Table, column_of
from stickslip.results.variables import Attribute, Json, Numbers, Text, WholeNumbers, stored


@dataclass(frozen=True, eq=False)
class QuasiStaticMode(Saved):
    """Frequency and damping ratio of a stuck mode from its static load curve with friction (docs/theory_modes.md).

    Parameters
    ----------
    modal_amplitude:
        (n_points,) m kg^(1/2), amplitude of the stuck mode in the static displacement.
    frequency_hz:
        (n_points,) Hz, from the secant of the load curve.
    damping_ratio:
        (n_points,) of friction, from the area of the hysteresis loop by Masing's rule, and of viscous damping.
    modal_force:
        (n_points,) m kg^(1/2) / s2, factor of the static load ``M phi``.
    friction_energy:
        (n_points,) J per cycle, area of the hysteresis loop.
    displacement:
        (n_points, n) m, static displacement about the state at rest.
    contact_state:
        (n_points, n_pairs) codes of :class:`stickslip.ContactState` at the end of the load: 1 slips there.
    linear_frequency_hz:
        Hz, of the stuck mode.
    mode:
        number of the stuck mode from 1.
    converged, message, warnings, settings, provenance:
        as in :class:`NonlinearMode`.
    """

    DATASET_TITLE: ClassVar[str] = "Quasi-static estimate of a mode of a structure with rough, dry-friction joints"
    STUDY_GROUP: ClassVar[str] = "quasi_static_mode"

    modal_amplitude: FloatArray = field(metadata=stored(Numbers(CURVE, "m kg0.5", "amplitude of the stuck mode")))
    frequency_hz: FloatArray = field(metadata=stored(Numbers(CURVE, "Hz", "frequency by the secant", name="frequency")))
    damping_ratio: FloatArray = field(metadata=stored(Numbers(CURVE, "1", "damping ratio")))
    modal_force: FloatArray = field(metadata=stored(Numbers(CURVE, "m kg0.5 s-2", "factor of the static load")))
    friction_energy: FloatArray = field(metadata=stored(Numbers(CURVE, "J", "area of the hysteresis loop")))
    displacement: FloatArray = field(metadata=stored(Numbers(("point", "unknown"), "m", "static displacement")))
    contact_state: NDArray[np.int8] = field(
        metadata=stored(WholeNumbers(PAIRS, "1", "contact state at the end of the load", np.int8))
    )
    linear_frequency_hz: FloatArray = field(metadata=stored(Numbers((), "Hz", "frequency of the stuck mode")))
    mode: int = field(metadata=stored(Attribute(1, 10**9)))
    converged: bool = field(metadata=stored(Attribute(0, 1, bool)))
    message: str = field(metadata=stored(Text("message of the solver at its end")))
    warnings: tuple[str, ...] = field(metadata=stored(Json(list[str], "warnings, JSON list")))
    settings: dict[str, str | float | int] = field(
        metadata=stored(Json(dict[str, str | float | int | None], "settings of the solve, JSON object"))
    )
    provenance: dict[str, str] = field(metadata=stored(Json(dict[str, str], "software and machine, JSON object")))

    def __post_init__(self) -> None:
        n_points, n_pairs = np.shape(self.contact_state)
        self._require_sizes({"point": n_points, "pair": n_pairs, "unknown": np.shape(self.displacement)[-1]})
        require_positive("modal_amplitude", self.modal_amplitude, "A mode requires a motion.")
        object.__setattr__(self, "warnings", tuple(self.warnings))

    def __repr__(self) -> str:
        return (
            f"QuasiStaticMode(stuck mode {self.mode}, {self.modal_amplitude.size} points from "
            f"{self.modal_amplitude.min():.2g} to {self.modal_amplitude.max():.2g} m kg^0.5, "
            f"{self.frequency_hz.min():.2f} to {self.frequency_hz.max():.2f} Hz, damping ratio "
            f"{self.damping_ratio.min():.2g} to {self.damping_ratio.max():.2g}; "
            f"{'converged' if self.converged else 'NOT converged'})"
        )

    @property
    def moving_fraction(self) -> FloatArray:
        """(n_points,) fraction of the pairs that slip or separate at the end of the load."""
        return np.asarray((self.contact_state != ContactState.STUCK).mean(axis=1))

    def amplitude(self, output: FloatArray) -> FloatArray:
        """(n_points,) amplitude of ``output @ u`` at the end of the load; ``output`` is a row (n,)."""
        return np.asarray(np.abs(self.displacement @ output))

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """See :class:`stickslip.results.part.ResultPart`."""
        columns = (
            column_of("modal amplitude", "m kg^0.5", self.modal_amplitude),
            column_of("frequency", "Hz", self.frequency_hz),
            column_of("damping ratio", "1", self.damping_ratio),
            *(column_of(f"amplitude of {output}", "m", self.amplitude(row)) for output, row in outputs.items()),
            column_of("friction energy", "J", self.friction_energy),
            column_of("moving pairs", "1", self.moving_fraction),
        )
        yield Table(name, f"quasi-static estimate of mode {self.mode} (Masing)", columns)

    def closing_words(self, name: str) -> Iterator[str]:
        """See :class:`stickslip.results.part.ResultPart`."""
        low, high = self.damping_ratio.min(), self.damping_ratio.max()
        yield f"Quasi-static estimate of mode {self.mode}: {self.message} {self.modal_amplitude.size} points."
        yield f"  frequency      {self.frequency_hz.min():.2f} to {self.frequency_hz.max():.2f} Hz"
        yield f"  damping ratio  {100 * low:.3g} to {100 * high:.3g} %"
        yield from (f"Warning: {sentence}" for sentence in self.warnings)
