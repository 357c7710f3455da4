"""The two linear limits beside a computed curve."""

from __future__ import annotations

from dataclasses import dataclass, field

from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.variables import Coefficients, Labelled, Numbers, stored

_LIMIT = ("linear_point", "unknown")


@dataclass(frozen=True, eq=False)
class LinearCurves(Labelled):
    """The two linear limits beside the computed curve: all pairs that are closed at rest stuck, and no contact at all.

    Parameters
    ----------
    frequency_hz:
        (n_linear,) Hz.
    stuck, free:
        (n_linear, n, 2 * harmonics + 1) m, displacement coefficients under the same force.
    stuck_frequency_hz, free_frequency_hz:
        (n_modes,) Hz, natural frequencies without damping.
    """

    frequency_hz: FloatArray = field(
        metadata=stored(Numbers(("linear_point",), "Hz", "excitation frequency", name="frequency"))
    )
    stuck: FloatArray = field(
        metadata=stored(
            Coefficients(_LIMIT, "m", "displacement, contacts closed at rest stuck", "stuck_harmonic", True)
        )
    )
    free: FloatArray = field(
        metadata=stored(Coefficients(_LIMIT, "m", "displacement without contact", "free_harmonic", True))
    )
    stuck_frequency_hz: FloatArray = field(
        metadata=stored(
            Numbers(("stuck_mode",), "Hz", "natural frequency, contacts closed at rest stuck", name="stuck_frequency")
        )
    )
    free_frequency_hz: FloatArray = field(
        metadata=stored(Numbers(("free_mode",), "Hz", "natural frequency, no contact", name="free_frequency"))
    )

    def __post_init__(self) -> None:
        for name in ("frequency_hz", "stuck", "free", "stuck_frequency_hz", "free_frequency_hz"):
            object.__setattr__(self, name, finite_array(f"linear.{name}", getattr(self, name)))

    def __repr__(self) -> str:
        return (
            f"LinearCurves({points_between(self.frequency_hz)}; first natural frequency "
            f"{_first_hz(self.stuck_frequency_hz)} stuck, {_first_hz(self.free_frequency_hz)} free)"
        )


def points_between(frequency_hz: FloatArray) -> str:
    """Number of points and their range of frequencies in words."""
    return f"{frequency_hz.size} points from {frequency_hz.min():.2f} to {frequency_hz.max():.2f} Hz"


def _first_hz(frequencies_hz: FloatArray) -> str:
    return f"{frequencies_hz.min():.2f} Hz" if frequencies_hz.size else "none"
