"""More points of a linear curve around its minima: the grid is dense at resonances, and antiresonances lie between."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.interpolate import BarycentricInterpolator

from stickslip.core.validation import FloatArray
from stickslip.results.periodic_amplitude import periodic_amplitude

# chosen: points added in each of the two intervals at a minimum, and points on each side that carry the polynomial.
ADDED, SIDE = 16, 3


def with_antiresonances(frequency_hz: FloatArray, coefficients: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frequencies and amplitudes of a linear curve (n_linear,) with coefficients (n_linear, 2H+1), refined at minima.

    Away from resonances the coefficients of the response are smooth functions of the frequency, while the amplitude has
    a corner where they change their sign: a polynomial through the coefficients of neighbouring points resolves it.
    """
    amplitude = periodic_amplitude(coefficients)
    low = np.flatnonzero((amplitude[1:-1] < amplitude[:-2]) & (amplitude[1:-1] < amplitude[2:])) + 1
    places, heights = [frequency_hz], [amplitude]
    for i in low:
        around = slice(max(0, i - SIDE), min(frequency_hz.size, i + SIDE + 1))
        through = BarycentricInterpolator(frequency_hz[around], coefficients[around])
        ends = frequency_hz[i - 1 : i + 2]
        fine = np.concatenate([np.linspace(a, b, ADDED + 2)[1:-1] for a, b in pairwise(ends)])
        places.append(fine)
        heights.append(periodic_amplitude(through(fine)))
    order = np.argsort(np.concatenate(places), kind="stable")
    return np.concatenate(places)[order], np.concatenate(heights)[order]
