"""Measures that engineers read off a forced response: peaks, shifts, equivalent damping, states, energy balance.

Everything walks the curve in its own order (the index), because a curve that folds has several amplitudes at one
frequency and must never be sorted by it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array
from stickslip.results.response import ForcedResponse


@dataclass(frozen=True)
class Peak:
    """A maximum of an amplitude curve.

    ``point`` is the computed point nearest to it; ``bracketed`` is False where the largest amplitude lies at an end of
    the curve, so that the true peak may be higher.
    """

    point: int
    frequency_hz: float
    amplitude: float
    bracketed: bool


@dataclass(frozen=True)
class Summary:
    """What a reader wants first, all at the highest peak of one output.

    Shifts are in Hz, negative when the peak lies below the linear one. Reductions are ``1 - amplitude / linear peak``.
    They are None where one of the two peaks is not inside the computed range. ``damping_ratio`` is None where the curve
    does not fall to half power on both sides. ``state_counts`` are pairs by the code of ContactState, ``state_names``
    what the laws of the pairs call the states that they can have. ``first_harmonic`` and ``mean`` are those of the
    output at the point nearest to the peak, m. Energies in J per cycle, ``normal_work`` an error of sampling;
    ``energy_imbalance`` relative to the input and the largest on the whole curve.
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


def peaks(frequency_hz: ArrayLike, amplitude: ArrayLike) -> list[Peak]:
    """Local maxima along the curve, highest first; if there is none, the higher end of the curve, not bracketed.

    Around each maximum ``1 / amplitude^2`` and the frequency are taken as parabolas through three neighbouring points,
    over the frequency, or over the index where the curve folds. ``1 / amplitude^2`` of a lightly damped linear
    resonance is a parabola in the frequency, so that one is found almost exactly.

    Parameters
    ----------
    frequency_hz, amplitude:
        (n_points,) along the curve. Amplitudes must not be negative.

    Raises
    ------
    InputError
        for arrays of different or zero length, or a negative amplitude.
    """
    frequency, height = finite_array("frequency_hz", frequency_hz), finite_array("amplitude", amplitude)
    if frequency.ndim != 1 or frequency.shape != height.shape or not frequency.size:
        raise InputError(
            f"frequency_hz and amplitude must be two lists of one length, but their shapes are {frequency.shape} and "
            f"{height.shape}."
        )
    if height.min() < 0:
        raise InputError("amplitude must not be negative: a 0-to-peak amplitude is the largest absolute value.")
    inside = np.flatnonzero((height[1:-1] >= height[:-2]) & (height[1:-1] > height[2:])) + 1
    found = [_interpolated_peak(frequency, height, int(i)) for i in inside]
    top = int(height.argmax())
    if top in (0, height.size - 1):
        found.append(Peak(top, float(frequency[top]), float(height[top]), bracketed=False))
    return sorted(found, key=lambda peak: -peak.amplitude)


def _interpolated_peak(frequency: FloatArray, height: FloatArray, i: int) -> Peak:
    f, a = frequency[i - 1 : i + 2], height[i - 1 : i + 2]
    if a.min() <= 0.0:
        return Peak(i, float(frequency[i]), float(height[i]), bracketed=True)
    # The frequency is the best length where its two steps are alike. Round a fold it slows and turns back, and the
    # index stands for the length of the continuation's steps, which change little from one to the next.
    first, second = np.diff(f)
    alike = first * second > 0 and max(abs(first), abs(second)) < 3.0 * min(abs(first), abs(second))
    steps = np.abs(np.diff(f)) if alike else np.ones(2)
    length = np.concatenate([[-steps[0]], [0.0], [steps[1]]])
    inverse = (a[1] / a) ** 2
    parabola = np.polyfit(length, inverse, 2)
    bend, slope = parabola[:2]
    place = float(np.clip(-0.5 * slope / bend, length[0], length[2])) if bend > 0 else 0.0
    smallest = float(np.polyval(parabola, place))
    nearest = i + int(np.abs(length - place).argmin()) - 1
    peak_frequency = float(np.polyval(np.polyfit(length, f, 2), place))
    # A parabola through a sharp corner could pass zero; the computed maximum then stands.
    amplitude = float(a[1] / np.sqrt(smallest)) if smallest > 0.25 else float(a[1])
    return Peak(nearest, peak_frequency, amplitude, bracketed=True)


def half_power_damping(frequency_hz: ArrayLike, amplitude: ArrayLike, peak: Peak) -> float | None:
    """Equivalent viscous damping ratio ``(f_2 - f_1) / (2 f_peak)`` from the half-power band of the curve.

    ``f_1`` and ``f_2`` are the first points on either side of the peak, walking along the curve, where the amplitude is
    ``peak.amplitude / sqrt(2)`` (linear between points). This is the ratio that a linear single resonance of the same
    width has; it holds friction and viscous losses together. Friction makes a curve that is not a resonance curve, so
    read it as a measure of width. None if the curve ends before it has fallen that far, or the peak is not bracketed.
    """
    frequency, height = finite_array("frequency_hz", frequency_hz), finite_array("amplitude", amplitude)
    if not peak.bracketed or peak.amplitude <= 0.0:
        return None
    level = peak.amplitude / np.sqrt(2.0)
    lower = _crossing(frequency[peak.point :: -1], height[peak.point :: -1], level)
    upper = _crossing(frequency[peak.point :], height[peak.point :], level)
    if lower is None or upper is None:
        return None
    return abs(upper - lower) / (2.0 * peak.frequency_hz)


def _crossing(frequency: FloatArray, height: FloatArray, level: float) -> float | None:
    below = np.flatnonzero(height <= level)
    if not below.size or below[0] == 0:
        return None
    i = int(below[0])
    share = (height[i - 1] - level) / (height[i - 1] - height[i])
    return float(frequency[i - 1] + share * (frequency[i] - frequency[i - 1]))


def state_counts(contact_state: NDArray[np.int8]) -> NDArray[np.int64]:
    """(n_points, 3) how many pairs have each state of ContactState at each point, from (n_points, n_pairs)."""
    return np.stack([(contact_state == state).sum(axis=1) for state in ContactState], axis=1)


def energy_imbalance(response: ForcedResponse) -> FloatArray:
    """(n_points,) ``(contact + viscous - input) / input`` per cycle; infinite where only the input is zero.

    The contact takes what friction takes, and what the sampled normal force does (``normal_work``).
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
    """A frequency or a shift as tables show it: to 0.01 Hz, and below 1 Hz with four digits."""
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
        ("Share of friction in the loss", number(result.friction_share, 100.0, 3), "%"),
        *((f"Pairs {name}", str(result.state_counts[state]), "-") for state, name in result.state_names.items()),
        ("Energy dissipated by friction", number(result.friction_energy, 1e6), "µJ per cycle"),
        ("Work of the normal forces (zero but for sampling)", number(result.normal_work, 1e6, 2), "µJ per cycle"),
        ("Energy dissipated by viscous damping", number(result.viscous_energy, 1e6), "µJ per cycle"),
        ("Energy put in by the excitation", number(result.input_energy, 1e6), "µJ per cycle"),
        ("Largest energy imbalance on the curve", number(result.energy_imbalance, digits=2), "of input"),
    ]
