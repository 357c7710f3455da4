"""Measures of a forced response: peaks, shifts, equivalent damping, states, energy balance.

A new measure is in this module only: a field of the summary, its row of the table, and its column of a sweep.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import Peak, caution, half_power_width, peaks
from stickslip.results.response import ForcedResponse
from stickslip.results.sweeps_of_curve import Direction, Jump, largest_jump, notable_jumps, reaches

# An energy imbalance below it is round-off of the sums: 1e-16 to 1e-13 on different machines.
ROUND_OFF = 1e-12


@dataclass(frozen=True)
class Summary:
    """The main measures of one output, at the highest peak on the curve.

    ``complete``: the curve covers its range; else each peak is only the highest of the computed part (:meth:`caution`).
    ``peak`` is the highest one on the curve, ``upward_peak`` and ``downward_peak`` are those that a slow sweep up and a
    slow sweep down reach (None without a stable point); they are equal where the curve does not fold. ``jumps`` are
    those of both sweeps. Shifts are in Hz, negative if the peak is below the linear one. Reductions are ``1 - amplitude
    / linear peak``. They are None where one of the two peaks is not inside the computed range. ``equivalent_damping``
    follows from the energies at the peak (:func:`equivalent_damping`); None for a file of an earlier version.
    ``half_power_width`` is None where the curve does not fall to half power on both sides. ``state_counts`` are pairs
    by the code of ContactState, ``state_names`` the names of the states in the laws of the pairs. ``first_harmonic``
    and ``mean`` are those of the output at the point nearest to the peak, m. Energies in J per cycle, ``normal_work``
    an error of sampling; ``energy_imbalance`` relative to the input and the largest on the whole curve.
    ``traction_peaks`` (m) and ``traction_jumps_up_hz`` and ``_down_hz`` are the ranges over this curve and those with
    extreme residual tractions (:class:`stickslip.results.traction_band.TractionBand`); None without such curves.
    ``stiffness_peaks`` (m) and ``stiffness_peaks_hz`` are the ranges of the highest peak over this curve and those with
    another contact stiffness (:class:`stickslip.results.stiffness_band.StiffnessBand`); None without such curves.
    ``stiffness_at_end`` is True if one of these curves has its largest amplitude at an end, so the range is larger.
    ``amplification_factor`` is that of a mistuned disk (:attr:`stickslip.results.mistuning.Mistuning.factor`).
    """

    complete: bool
    peak: Peak
    upward_peak: Peak | None
    downward_peak: Peak | None
    jumps: tuple[Jump, ...]
    stuck_peak: Peak
    free_peak: Peak
    shift_from_stuck_hz: float | None
    shift_from_free_hz: float | None
    reduction_from_stuck: float | None
    reduction_from_free: float | None
    equivalent_damping: float | None
    half_power_width: float | None
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
    amplification_factor: float | None = None
    traction_peaks: tuple[float, float] | None = None
    traction_jumps_up_hz: tuple[float, float] | None = None
    traction_jumps_down_hz: tuple[float, float] | None = None
    stiffness_peaks: tuple[float, float] | None = None
    stiffness_peaks_hz: tuple[float, float] | None = None
    stiffness_at_end: bool = False

    @property
    def sweeps_differ(self) -> bool:
        """Whether a slow sweep up or a slow sweep down does not reach the highest peak."""
        return not all(reaches(self.peak, side) for side in (self.upward_peak, self.downward_peak))

    def caution(self, peak: Peak) -> str:
        """Words beside a peak of the curve that may not be the highest one, "" beside others."""
        return caution(peak.bracketed, self.complete)

    @property
    def notable_jumps(self) -> tuple[Jump, ...]:
        """Jumps by more than 1 % of the highest peak; smaller ones are corners of the curve."""
        return notable_jumps(self.peak, self.jumps)


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


def equivalent_damping(response: ForcedResponse) -> FloatArray:
    """(n_points,) equivalent viscous damping ratio ``W / (4 pi E)`` from energies; 0 where no kinetic energy is stored.

    ``W`` is the energy that contact and viscous damping dissipate per cycle, ``E`` the kinetic energy of the first
    harmonic (``response.kinetic_energy``). At a resonance E is also the largest potential energy; with it this is the
    usual definition, ``loss / (4 pi maximum strain energy)`` (A. K. Chopra, Dynamics of Structures, "equivalent viscous
    damping"). For viscous damping at a resonance it is the damping ratio of the mode.
    """
    loss = response.dissipated_energy.sum(axis=1) + response.viscous_energy
    stored = 4.0 * np.pi * response.kinetic_energy
    ratio: FloatArray = np.divide(loss, stored, out=np.zeros_like(loss), where=stored > 0.0)
    return ratio


def summary(response: ForcedResponse, output: ArrayLike) -> Summary:
    """The measures at the highest peak of ``output`` (n,). Raises InputError for a wrong output."""
    amplitude = response.amplitude(output)
    peak = peaks(response.frequency_hz, amplitude, response.part)[0]
    up, down = response.slow_sweeps(output)
    stuck, free = (
        peaks(response.linear.frequency_hz, response.linear_amplitude(output, limit))[0] for limit in ("stuck", "free")
    )
    point = peak.point
    friction = _beyond_round_off(float(response.friction_energy[point].sum()), float(response.input_energy[point]))
    viscous = float(response.viscous_energy[point])
    energy = response.friction_energy.sum(axis=1)
    counts = state_counts(response.contact_state[point][None])[0]
    return Summary(
        complete=response.converged,
        peak=peak,
        upward_peak=up.peak,
        downward_peak=down.peak,
        jumps=(*up.jumps, *down.jumps),
        stuck_peak=stuck,
        free_peak=free,
        shift_from_stuck_hz=peak.frequency_hz - stuck.frequency_hz if peak.bracketed and stuck.bracketed else None,
        shift_from_free_hz=peak.frequency_hz - free.frequency_hz if peak.bracketed and free.bracketed else None,
        reduction_from_stuck=1.0 - peak.amplitude / stuck.amplitude if peak.bracketed and stuck.bracketed else None,
        reduction_from_free=1.0 - peak.amplitude / free.amplitude if peak.bracketed and free.bracketed else None,
        equivalent_damping=float(equivalent_damping(response)[point]) or None,
        half_power_width=half_power_width(response.frequency_hz, amplitude, peak, response.part),
        friction_share=friction / (friction + viscous) if friction + viscous > 0.0 else 0.0,
        state_counts=(int(counts[0]), int(counts[1]), int(counts[2])),
        state_names=response.pairs.state_names,
        friction_energy=friction,
        normal_work=_beyond_round_off(float(response.normal_work[point].sum()), float(response.input_energy[point])),
        viscous_energy=viscous,
        input_energy=float(response.input_energy[point]),
        first_harmonic=float(response.harmonic_amplitude(output, 1)[point]),
        mean=float(response.coefficients(output)[point, 0]),
        amplification_factor=None if response.mistuning is None else response.mistuning.factor,
        energy_imbalance=float(np.abs(energy_imbalance(response)).max()),
        peak_energy=float(energy.max()),
        peak_energy_frequency_hz=float(response.frequency_hz[energy.argmax()]),
        **_traction_ranges(response, output, peak, (*up.jumps, *down.jumps)),
        **_stiffness_ranges(response, output, peak),
    )


def _traction_ranges(
    response: ForcedResponse, output: ArrayLike, peak: Peak, jumps: tuple[Jump, ...]
) -> dict[str, Any]:
    """Ranges of the peak and of the largest jump of each slow sweep over the curve and its band of tractions."""
    band = response.traction_band
    if band is None:
        return {}
    low, high = band.peak_range(output)
    ranges: dict[str, tuple[float, float] | None] = {
        "traction_peaks": (min(low, peak.amplitude), max(high, peak.amplitude))
    }
    for direction in get_args(Direction):
        places = list(band.jump_range_hz(direction, output) or ())
        own = [jump for jump in notable_jumps(peak, jumps) if jump.direction == direction]
        places += [largest_jump(own).frequency_hz] if own else []
        ranges[f"traction_jumps_{direction}_hz"] = (min(places), max(places)) if places else None
    return ranges


def _stiffness_ranges(response: ForcedResponse, output: ArrayLike, peak: Peak) -> dict[str, Any]:
    """Ranges of amplitude and frequency of the peak over the curve and its band of contact stiffness."""
    if response.stiffness_band is None:
        return {}
    every = (peak, *response.stiffness_band.curve_peaks(output))
    amplitude, frequency_hz = [each.amplitude for each in every], [each.frequency_hz for each in every]
    return {
        "stiffness_peaks": (min(amplitude), max(amplitude)),
        "stiffness_peaks_hz": (min(frequency_hz), max(frequency_hz)),
        "stiffness_at_end": not all(each.bracketed for each in every),
    }


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

    def reached(what: str, peak: Peak | None) -> list[tuple[str, str, str]]:
        note = "" if peak is None else result.caution(peak)
        words = f"{what} ({note})" if note else what
        return [
            (f"{words}: amplitude, 0-to-peak, mean included", number(_reached(peak, "amplitude"), 1e6), "µm"),
            (f"{words}: frequency", shift(_reached(peak, "frequency_hz")), "Hz"),
        ]

    return [
        *reached("Highest peak on the curve", result.peak),
        *_stiffness_rows(result),
        *reached("Peak of a slow sweep up", result.upward_peak),
        *reached("Peak of a slow sweep down", result.downward_peak),
        *(_jump_row(jump) for jump in result.notable_jumps),
        *_traction_rows(result),
        *_mistuning_rows(result),
        ("First harmonic at the highest peak", number(result.first_harmonic, 1e6), "µm"),
        ("Mean there", number(result.mean, 1e6), "µm"),
        ("Shift from the linear stuck peak", shift(result.shift_from_stuck_hz), "Hz"),
        ("Shift from the linear free peak", shift(result.shift_from_free_hz), "Hz"),
        ("Reduction against the linear stuck peak", number(result.reduction_from_stuck, 100.0, 3), "%"),
        ("Reduction against the linear free peak", number(result.reduction_from_free, 100.0, 3), "%"),
        ("Equivalent damping ratio, from energies", number(result.equivalent_damping, 100.0, 3), "%"),
        ("Half-power width of the curve, (f2 - f1) / (2 f)", number(result.half_power_width, 100.0, 3), "%"),
        ("Fraction of friction in the energy loss", number(result.friction_share, 100.0, 3), "%"),
        *((f"Pairs {name}", str(result.state_counts[state]), "-") for state, name in result.state_names.items()),
        ("Energy dissipated by friction", number(result.friction_energy, 1e6), "µJ per cycle"),
        ("Work of the normal forces (zero except for sampling)", number(result.normal_work, 1e6, 2), "µJ per cycle"),
        ("Energy dissipated by viscous damping", number(result.viscous_energy, 1e6), "µJ per cycle"),
        ("Work of the excitation", number(result.input_energy, 1e6), "µJ per cycle"),
        ("Largest energy imbalance on the curve", _imbalance_words(result.energy_imbalance), "of input"),
    ]


def _beyond_round_off(energy: float, supplied: float) -> float:
    """An energy, 0 if it is round-off of the ``supplied`` one: the sum over stuck pairs is not exactly zero."""
    return 0.0 if abs(energy) <= ROUND_OFF * abs(supplied) else energy


def _imbalance_words(value: float) -> str:
    """An imbalance, or the limit of the round-off below which its digits say nothing."""
    return f"below {ROUND_OFF:.0e}" if value < ROUND_OFF else f"{value:.2g}"


def _stiffness_rows(result: Summary) -> Iterator[tuple[str, str, str]]:
    """The range beside the highest peak: nobody measured the stiffness that it belongs to."""
    if result.stiffness_peaks is not None and result.stiffness_peaks_hz is not None:
        (low, high), (first, last) = result.stiffness_peaks, result.stiffness_peaks_hz
        words = "... with 1/3 to 3 of the contact stiffness, not measured"
        if result.stiffness_at_end:
            words += " (at an end)"
        yield f"{words}: amplitude", f"{1e6 * low:.4g} to {1e6 * high:.4g}", "µm"
        yield f"{words}: frequency", f"{hertz(first)} to {hertz(last)}", "Hz"


def _traction_rows(result: Summary) -> Iterator[tuple[str, str, str]]:
    if result.traction_peaks is not None:
        low, high = result.traction_peaks
        yield "Highest peak over extreme residual tractions", f"{1e6 * low:.4g} to {1e6 * high:.4g}", "µm"
    for direction, places in (("up", result.traction_jumps_up_hz), ("down", result.traction_jumps_down_hz)):
        if places is not None:
            yield f"Jump of a slow sweep {direction} over them", f"{hertz(places[0])} to {hertz(places[1])}", "Hz"


def _mistuning_rows(result: Summary) -> Iterator[tuple[str, str, str]]:
    if result.amplification_factor is not None:
        yield "Amplification factor of the mistuned disk", f"{result.amplification_factor:.3f}", "-"


def _jump_row(jump: Jump) -> tuple[str, str, str]:
    name = f"Jump of a slow sweep {jump.direction} at {hertz(jump.frequency_hz)} Hz"
    return name, f"{1e6 * jump.amplitude_from:.4g} to {1e6 * jump.amplitude_to:.4g}", "µm"


def _inside(measures: Summary, limit: str, what: str) -> float | None:
    """Amplitude or frequency of a linear peak, None if it is outside the computed range."""
    peak = getattr(measures, f"{limit}_peak")
    return getattr(peak, what) if peak.bracketed else None


def _reached(peak: Peak | None, what: str) -> float | None:
    """Amplitude or frequency of the peak of a sweep, None if it has none."""
    return None if peak is None else getattr(peak, what)


# Columns of the table of a sweep: (unit, meaning, function of a summary); None gives an empty cell.
SUMMARY_COLUMNS: dict[str, tuple[str, str, Callable[[Summary], float | bool | None]]] = {
    "peak_amplitude_m": ("m", "highest peak on the curve, 0-to-peak, mean included", lambda s: s.peak.amplitude),
    "peak_frequency_hz": ("Hz", "frequency of the highest peak", lambda s: s.peak.frequency_hz),
    "upward_peak_amplitude_m": ("m", "peak of a slow sweep up", lambda s: _reached(s.upward_peak, "amplitude")),
    "upward_peak_frequency_hz": ("Hz", "its frequency", lambda s: _reached(s.upward_peak, "frequency_hz")),
    "downward_peak_amplitude_m": ("m", "peak of a slow sweep down", lambda s: _reached(s.downward_peak, "amplitude")),
    "downward_peak_frequency_hz": ("Hz", "its frequency", lambda s: _reached(s.downward_peak, "frequency_hz")),
    "lowest_traction_peak_amplitude_m": (
        "m",
        "lowest of the highest peaks over extreme residual tractions",
        lambda s: s.traction_peaks and s.traction_peaks[0],
    ),
    "highest_traction_peak_amplitude_m": (
        "m",
        "highest of the highest peaks over extreme residual tractions",
        lambda s: s.traction_peaks and s.traction_peaks[1],
    ),
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
    "equivalent_damping_ratio": ("1", "from the energies at the peak", lambda s: s.equivalent_damping),
    "half_power_width_ratio": ("1", "half-power width of the curve, (f2 - f1) / (2 f)", lambda s: s.half_power_width),
    "pairs_stuck": (
        "1",
        "pairs stuck at the peak, Iwan joints without motion included",
        lambda s: s.state_counts[ContactState.STUCK],
    ),
    "pairs_stick_slip": (
        "1",
        "pairs in stick-slip at the peak, Iwan joints in microslip included",
        lambda s: s.state_counts[ContactState.STICK_SLIP],
    ),
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
    "amplification_factor": (
        "1",
        "highest amplitude of a blade of the mistuned disk over the tuned one, with friction if it was solved",
        lambda s: s.amplification_factor,
    ),
    "energy_imbalance": ("1", "largest energy imbalance on the curve, of the input", lambda s: s.energy_imbalance),
}
