"""Measures of a forced response: peaks, shifts, equivalent damping, states, energy balance.

A new measure is in this module only: a field of the summary, its row of the table, and its column of a sweep.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import Peak, half_power_damping, peaks
from stickslip.results.response import ForcedResponse


@dataclass(frozen=True)
class Summary:
    """The main measures, at the highest peak of one output.

    Shifts are in Hz, negative if the peak is below the linear one. Reductions are ``1 - amplitude / linear peak``. They
    are None where one of the two peaks is not inside the computed range. ``damping_ratio`` is None where the curve does
    not fall to half power on both sides. ``state_counts`` are pairs by the code of ContactState, ``state_names`` the
    names of the states in the laws of the pairs. ``first_harmonic`` and ``mean`` are those of the output at the point
    nearest to the peak, m. Energies in J per cycle, ``normal_work`` an error of sampling; ``energy_imbalance`` relative
    to the input and the largest on the whole curve.
    """

    peak: Peak
    stuck_peak: Peak
    free_peak: Peak
    shift_from_stuck_hz: float | None
    shift_from_free_hz: float | None
    reduction_from_stuck: float | None
    reduction_from_free: float | None
    damping_ratio: float | None
    friction_share: float
    state_counts: tuple[int, int, int]
    state_names: dict[ContactState, str]
    friction_energy: float
    normal_work: float
    viscous_energy: float
    input_energy: float
    first_harmonic: float
    mean: float
    energy_imbalance: float
    peak_energy: float
    peak_energy_frequency_hz: float


def state_counts(contact_state: NDArray[np.int8]) -> NDArray[np.int64]:
    """(n_points, 3) number of pairs in each state of ContactState at each point, from (n_points, n_pairs)."""
    return np.stack([(contact_state == state).sum(axis=1) for state in ContactState], axis=1)


def energy_imbalance(response: ForcedResponse) -> FloatArray:
    """(n_points,) ``(contact + viscous - input) / input`` per cycle; infinite where only the input is zero.

    The contact dissipates the friction energy and the work of the sampled normal force (``normal_work``).
    """
    loss = response.dissipated_energy.sum(axis=1) + response.viscous_energy
    difference = loss - response.input_energy
    still = np.where(difference == 0.0, 0.0, np.inf)
    imbalance: FloatArray = np.divide(difference, response.input_energy, out=still, where=response.input_energy != 0.0)
    return imbalance


def summary(response: ForcedResponse, output: ArrayLike) -> Summary:
    """The measures at the highest peak of ``output`` (n,). Raises InputError for a wrong output."""
    amplitude = response.amplitude(output)
    peak = peaks(response.frequency_hz, amplitude)[0]
    stuck, free = (
        peaks(response.linear.frequency_hz, response.linear_amplitude(output, limit))[0] for limit in ("stuck", "free")
    )
    point = peak.point
    friction = float(response.friction_energy[point].sum())
    viscous = float(response.viscous_energy[point])
    energy = response.friction_energy.sum(axis=1)
    counts = state_counts(response.contact_state[point][None])[0]
    return Summary(
        peak=peak,
        stuck_peak=stuck,
        free_peak=free,
        shift_from_stuck_hz=peak.frequency_hz - stuck.frequency_hz if peak.bracketed and stuck.bracketed else None,
        shift_from_free_hz=peak.frequency_hz - free.frequency_hz if peak.bracketed and free.bracketed else None,
        reduction_from_stuck=1.0 - peak.amplitude / stuck.amplitude if peak.bracketed and stuck.bracketed else None,
        reduction_from_free=1.0 - peak.amplitude / free.amplitude if peak.bracketed and free.bracketed else None,
        damping_ratio=half_power_damping(response.frequency_hz, amplitude, peak),
        friction_share=friction / (friction + viscous) if friction + viscous > 0.0 else 0.0,
        state_counts=(int(counts[0]), int(counts[1]), int(counts[2])),
        state_names=response.pairs.state_names,
        friction_energy=friction,
        normal_work=float(response.normal_work[point].sum()),
        viscous_energy=viscous,
        input_energy=float(response.input_energy[point]),
        first_harmonic=float(response.harmonic_amplitude(output, 1)[point]),
        mean=float(response.coefficients(output)[point, 0]),
        energy_imbalance=float(np.abs(energy_imbalance(response)).max()),
        peak_energy=float(energy.max()),
        peak_energy_frequency_hz=float(response.frequency_hz[energy.argmax()]),
    )


def hertz(value: float) -> str:
    """A frequency or a shift for tables: to 0.01 Hz, and below 1 Hz with four digits."""
    if abs(value) < 0.005:
        return "0.00"
    return f"{value:.2f}" if abs(value) >= 1.0 else f"{value:.4g}"


def summary_table(result: Summary) -> list[tuple[str, str, str]]:
    """Rows (name, value, unit) of the summary, ready for a terminal, a page or a text file; "-" where not available."""

    def number(value: float | None, scale: float = 1.0, digits: int = 4) -> str:
        return "-" if value is None else f"{scale * value:.{digits}g}"

    def shift(value: float | None) -> str:
        return "-" if value is None else hertz(value)

    what = "Peak" if result.peak.bracketed else "Highest computed (at an end of the curve)"
    return [
        (f"{what} amplitude, 0-to-peak, mean included", number(result.peak.amplitude, 1e6), "µm"),
        ("First harmonic there", number(result.first_harmonic, 1e6), "µm"),
        ("Mean there", number(result.mean, 1e6), "µm"),
        (f"{what} frequency", hertz(result.peak.frequency_hz), "Hz"),
        ("Shift from the linear stuck peak", shift(result.shift_from_stuck_hz), "Hz"),
        ("Shift from the linear free peak", shift(result.shift_from_free_hz), "Hz"),
        ("Reduction against the linear stuck peak", number(result.reduction_from_stuck, 100.0, 3), "%"),
        ("Reduction against the linear free peak", number(result.reduction_from_free, 100.0, 3), "%"),
        ("Half-power bandwidth ratio (equivalent damping)", number(result.damping_ratio, 100.0, 3), "%"),
        ("Fraction of friction in the energy loss", number(result.friction_share, 100.0, 3), "%"),
        *((f"Pairs {name}", str(result.state_counts[state]), "-") for state, name in result.state_names.items()),
        ("Energy dissipated by friction", number(result.friction_energy, 1e6), "µJ per cycle"),
        ("Work of the normal forces (zero except for sampling)", number(result.normal_work, 1e6, 2), "µJ per cycle"),
        ("Energy dissipated by viscous damping", number(result.viscous_energy, 1e6), "µJ per cycle"),
        ("Work of the excitation", number(result.input_energy, 1e6), "µJ per cycle"),
        ("Largest energy imbalance on the curve", number(result.energy_imbalance, digits=2), "of input"),
    ]


def _inside(measures: Summary, limit: str, what: str) -> float | None:
    """Amplitude or frequency of a linear peak, None if it is outside the computed range."""
    peak = getattr(measures, f"{limit}_peak")
    return getattr(peak, what) if peak.bracketed else None


# Columns of the table of a sweep: (unit, meaning, function of a summary); None gives an empty cell.
SUMMARY_COLUMNS: dict[str, tuple[str, str, Callable[[Summary], float | bool | None]]] = {
    "peak_amplitude_m": ("m", "highest peak, 0-to-peak, mean included", lambda s: s.peak.amplitude),
    "peak_frequency_hz": ("Hz", "frequency of the highest peak", lambda s: s.peak.frequency_hz),
    "peak_bracketed": ("1", "1 if the peak is inside the computed range, 0 at an end", lambda s: s.peak.bracketed),
    "shift_from_stuck_hz": ("Hz", "peak frequency less that of the linear stuck peak", lambda s: s.shift_from_stuck_hz),
    "shift_from_free_hz": ("Hz", "peak frequency less that of the linear free peak", lambda s: s.shift_from_free_hz),
    "reduction_from_stuck": ("1", "1 - peak / linear stuck peak", lambda s: s.reduction_from_stuck),
    "reduction_from_free": ("1", "1 - peak / linear free peak", lambda s: s.reduction_from_free),
    "stuck_peak_amplitude_m": (
        "m",
        "highest linear peak, each pair that is closed at rest stuck",
        lambda s: _inside(s, "stuck", "amplitude"),
    ),
    "stuck_peak_frequency_hz": ("Hz", "its frequency", lambda s: _inside(s, "stuck", "frequency_hz")),
    "free_peak_amplitude_m": ("m", "highest linear peak, no contact", lambda s: _inside(s, "free", "amplitude")),
    "free_peak_frequency_hz": ("Hz", "its frequency", lambda s: _inside(s, "free", "frequency_hz")),
    "damping_ratio": ("1", "half-power bandwidth ratio (equivalent damping)", lambda s: s.damping_ratio),
    "pairs_stuck": ("1", "pairs stuck at the peak", lambda s: s.state_counts[ContactState.STUCK]),
    "pairs_stick_slip": ("1", "pairs in stick-slip at the peak", lambda s: s.state_counts[ContactState.STICK_SLIP]),
    "pairs_separating": ("1", "pairs separating at the peak", lambda s: s.state_counts[ContactState.SEPARATING]),
    "friction_energy_j": ("J", "dissipated by friction per cycle at the peak", lambda s: s.friction_energy),
    "normal_work_j": (
        "J",
        "of the normal forces per cycle at the peak, zero except for sampling",
        lambda s: s.normal_work,
    ),
    "viscous_energy_j": ("J", "dissipated by viscous damping per cycle at the peak", lambda s: s.viscous_energy),
    "input_energy_j": ("J", "work of the excitation per cycle at the peak", lambda s: s.input_energy),
    "largest_friction_energy_j": ("J", "largest friction energy per cycle on the curve", lambda s: s.peak_energy),
    "largest_friction_energy_hz": ("Hz", "frequency of that energy", lambda s: s.peak_energy_frequency_hz),
    "energy_imbalance": ("1", "largest energy imbalance on the curve, of the input", lambda s: s.energy_imbalance),
}
