"""The result of a nonlinear mode: frequency, damping ratio, shape, contact states and energies against amplitude."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.validation import FloatArray, require_positive
from stickslip.results.mode_figure import Backbone, mode_figure
from stickslip.results.periodic_motions import CURVE, PeriodicMotions
from stickslip.results.table import Table, column_of
from stickslip.results.variables import Attribute, Numbers, Text, stored

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stickslip.results.quasi_static_mode import QuasiStaticMode

# Above this damping ratio the nonlinear mode no longer passes through the peaks of forced responses. Chosen: at 3 % a
# peak of a linear oscillator is 0.1 % away from its natural frequency, and the contact changes within the width of the
# peak.
LARGEST_RATIO_OF_PEAKS = 0.03
# Begins the warning of a mode whose frequency or shape differs from that of the full model.
POOR_REDUCTION = "The reduction represents mode"


@dataclass(frozen=True, eq=False)
class NonlinearMode(PeriodicMotions):
    """A nonlinear mode by the extended periodic motion concept (Krack 2015), in the order of the branch.

    Each point is a periodic motion of ``M u'' + (C - xi M) u' + K u + B^T f(B u) = 0``: the artificial damping
    ``-xi M`` supplies what friction and viscous damping dissipate. Theory: docs/theory_modes.md.

    Parameters
    ----------
    modal_amplitude:
        (n_points,) m kg^(1/2), mass norm of the first harmonic: ``sqrt(c_1 . M c_1 + s_1 . M s_1)``. An unknown of a
        linear mode has the modal amplitude times its entry in the mass-normalised mode shape as 0-to-peak amplitude.
    frequency_hz:
        (n_points,) Hz.
    damping_ratio:
        (n_points,) ``xi / (2 w)``, of friction and viscous damping.
    displacement, contact_state, dissipated_energy, normal_work, closure, residual, iterations, viscous_energy, pairs,
    harmonics, samples, settings, provenance:
        as in :class:`ForcedResponse`.
    input_energy:
        (n_points,) J per cycle, supplied by the artificial damping; it is dissipated + viscous.
    stuck_frequency_hz, sliding_frequency_hz:
        (n_modes,) Hz, frequencies of the linear modes with all pairs that are closed at rest stuck, and with the same
        pairs without friction.
    stuck_mac, sliding_mac:
        (n_points, n_modes) modal assurance criterion with mass of the first harmonic and each of these modes, 0 to 1.
    step_mac:
        (n_points,) the same between the first harmonics of a point and the one before, 1 at the first.
    mode, limit:
        number of the linear mode from 1, and the linear limit in which it is counted: "stuck" or "sliding".
    converged, message:
        whether the mode covers the whole range of amplitudes, and a message on its end.
    warnings:
        messages, for example on a shape that becomes that of another mode.

    Raises
    ------
    InputError
        for an array of the wrong shape or with an entry that is not finite.
    """

    DATASET_TITLE: ClassVar[str] = "Nonlinear mode of a structure with rough, dry-friction joints"
    STUDY_GROUP: ClassVar[str] = "nonlinear_mode"

    modal_amplitude: FloatArray = field(
        metadata=stored(Numbers(CURVE, "m kg0.5", "modal amplitude: mass norm of the first harmonic"))
    )
    damping_ratio: FloatArray = field(metadata=stored(Numbers(CURVE, "1", "damping ratio of the mode")))
    input_energy: FloatArray = field(
        metadata=stored(Numbers(CURVE, "J", "energy that the artificial damping supplies per cycle"))
    )
    stuck_frequency_hz: FloatArray = field(
        metadata=stored(
            Numbers(("stuck_mode",), "Hz", "natural frequency, contacts closed at rest stuck", name="stuck_frequency")
        )
    )
    stuck_mac: FloatArray = field(
        metadata=stored(Numbers(("point", "stuck_mode"), "1", "MAC with mass, first harmonic and stuck mode"))
    )
    sliding_frequency_hz: FloatArray = field(
        metadata=stored(
            Numbers(
                ("sliding_mode",), "Hz", "natural frequency, contacts closed at rest frictionless",
                name="sliding_frequency",
            )
        )
    )  # fmt: skip
    sliding_mac: FloatArray = field(
        metadata=stored(Numbers(("point", "sliding_mode"), "1", "MAC with mass, first harmonic and sliding mode"))
    )
    step_mac: FloatArray = field(
        metadata=stored(Numbers(CURVE, "1", "MAC with mass of the first harmonics of the point and the one before"))
    )
    mode: int = field(metadata=stored(Attribute(1, 10**9)))
    limit: str = field(metadata=stored(Text("linear limit in which the mode is counted")))

    def __post_init__(self) -> None:
        modes = {"stuck_mode": np.size(self.stuck_frequency_hz), "sliding_mode": np.size(self.sliding_frequency_hz)}
        self._require_sizes(self._checked_sizes() | modes)
        require_positive("modal_amplitude", self.modal_amplitude, "A mode requires a motion.")
        object.__setattr__(self, "warnings", tuple(self.warnings))

    def __repr__(self) -> str:
        return (
            f"NonlinearMode({self.limit} mode {self.mode}, {self.n_points} points from "
            f"{self.modal_amplitude.min():.2g} to {self.modal_amplitude.max():.2g} m kg^0.5, "
            f"{self.frequency_hz.min():.2f} to {self.frequency_hz.max():.2f} Hz, damping ratio "
            f"{self.damping_ratio.min():.2g} to {self.damping_ratio.max():.2g}; "
            f"{'converged' if self.converged else 'NOT converged'})"
        )

    @property
    def state_fractions(self) -> dict[ContactState, FloatArray]:
        """(n_points,) fraction of the pairs in each state that the laws have."""
        return {state: (self.contact_state == state).mean(axis=1) for state in self.pairs.state_names}

    @property
    def closest_linear_modes(self) -> tuple[tuple[str, float], ...]:
        """Name and frequency in Hz of the stuck and of the sliding linear mode that is closest to the shape."""
        limits = (
            ("stuck", self.stuck_frequency_hz, self.stuck_mac),
            ("sliding", self.sliding_frequency_hz, self.sliding_mac),
        )
        closest = [int(mac.max(axis=0).argmax()) for _, _, mac in limits]
        return tuple(
            (f"linear {limit} mode {index + 1}", float(hertz[index]))
            for (limit, hertz, _), index in zip(limits, closest, strict=True)
        )

    @property
    def passes_peaks(self) -> NDArray[np.bool_]:
        """(n_points,) whether peaks of forced responses are on the mode: the damping ratio is at most 3 %."""
        return np.asarray(self.damping_ratio <= LARGEST_RATIO_OF_PEAKS)

    @property
    def reduction_is_poor(self) -> bool:
        """Whether a warning says that the reduced structure does not have this mode as the full model has it."""
        return any(each.startswith(POOR_REDUCTION) for each in self.warnings)

    def tables(self, name: str, outputs: Mapping[str, FloatArray]) -> Iterator[Table]:
        """See :class:`stickslip.results.part.ResultPart`."""
        columns = (
            column_of("modal amplitude", "m kg^0.5", self.modal_amplitude),
            column_of("frequency", "Hz", self.frequency_hz),
            column_of("damping ratio", "1", self.damping_ratio),
            *(
                column_of(f"first-harmonic amplitude of {output}", "m", self.harmonic_amplitude(row, 1))
                for output, row in outputs.items()
            ),
            column_of("friction energy of all pairs", "J", self.dissipated_energy.sum(axis=1)),
            column_of("viscous energy", "J", self.viscous_energy),
            column_of("supplied energy", "J", self.input_energy),
            column_of("MAC with the closest stuck mode", "1", self.stuck_mac.max(axis=1)),
            column_of("MAC with the closest sliding mode", "1", self.sliding_mac.max(axis=1)),
            *(
                column_of(f"fraction of pairs {self.pairs.state_names[state]}", "1", fraction)
                for state, fraction in self.state_fractions.items()
            ),
        )
        yield Table(name, f"nonlinear mode {self.mode}", columns)

    def closing_words(self, name: str) -> Iterator[str]:
        """See :class:`stickslip.results.part.ResultPart`."""
        yield f"Nonlinear mode {self.mode}: {self.message} {self.n_points} points."
        low, high = self.damping_ratio.min(), self.damping_ratio.max()
        yield f"  frequency      {self.frequency_hz.min():.2f} to {self.frequency_hz.max():.2f} Hz"
        yield f"  damping ratio  {100 * low:.3g} to {100 * high:.3g} %"
        yield from (f"Warning: {sentence}" for sentence in self.warnings)

    def plot(self, quasi_static: QuasiStaticMode | None = None) -> Figure:
        """Frequency and damping ratio against modal amplitude, with the linear limits, as a figure of matplotlib.

        The figure shows a ``quasi_static`` estimate of the same mode beside it.
        """
        other = None if quasi_static is None else _backbone(quasi_static)
        return mode_figure(_backbone(self), self.closest_linear_modes, other)


def _backbone(mode: NonlinearMode | QuasiStaticMode) -> Backbone:
    return Backbone(mode.modal_amplitude, mode.frequency_hz, mode.damping_ratio)
