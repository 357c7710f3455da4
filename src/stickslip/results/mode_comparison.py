"""The quasi-static estimate of a mode beside the nonlinear mode, in a sentence."""

from __future__ import annotations

import numpy as np

from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.quasi_static_mode import QuasiStaticMode

# chosen: difference of the damping ratio from that of the nonlinear mode above which the estimate is no substitute.
LARGEST_DIFFERENCE = 0.1
_ROUND_OFF = 1e-6  # of the ends of a range of amplitudes


def comparison(mode: NonlinearMode, estimate: QuasiStaticMode) -> str:
    """The differences of an estimate from the nonlinear mode of the same structure, within the common amplitudes."""
    low, high = float(estimate.modal_amplitude[0]), float(estimate.modal_amplitude[-1])
    inside = (mode.modal_amplitude >= (1.0 - _ROUND_OFF) * low) & (mode.modal_amplitude <= (1.0 + _ROUND_OFF) * high)
    points = np.flatnonzero(inside)
    if not points.size:
        return "It has no amplitude in common with the nonlinear mode."
    points = points[np.argsort(mode.modal_amplitude[points], kind="stable")]
    amplitude, exact = mode.modal_amplitude[points], mode.damping_ratio[points]
    frequency_hz, ratio = (
        np.interp(np.log(amplitude), np.log(estimate.modal_amplitude), values)
        for values in (estimate.frequency_hz, estimate.damping_ratio)
    )
    change = (100.0 * (frequency_hz / mode.frequency_hz[points] - 1.0)).round(3) + 0.0  # no -0.000
    smallest, largest = (
        f"{change[at]:+.3f} % in frequency and a damping ratio of {100 * ratio[at]:.4g} instead of "
        f"{100 * exact[at]:.4g} %"
        for at in (0, -1)
    )
    words = f"Against the nonlinear mode it has {smallest} at the smallest amplitude, {largest} at the largest."
    apart = np.abs(ratio - exact) > LARGEST_DIFFERENCE * np.abs(exact)
    if apart.any():
        words += (
            f" From {amplitude[apart.argmax()]:.3g} m kg^0.5 on, damping ratios differ by more than "
            f"{100 * LARGEST_DIFFERENCE:.0f} %: do not use the estimate there."
        )
    return words
