"""The derivatives of the friction law step by step along its periodic state; see :mod:`linear_steps`."""

from __future__ import annotations

import math

import numpy as np

from stickslip.contact.law.coulomb_kernel import SLIP, STICK, advance, step_jacobian
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# A pair that has shaken down touches its limit, within this fraction of it, and does not slip. It counts as slipping
# there: a disturbance that goes farther moves its slider, as in the derivative of the periodic state.
TOUCH = 1e-9


def coulomb_linear_steps(
    displacement: FloatArray,
    walk: FloatArray,
    traction: FloatArray,
    springs: FloatArray,
    friction: FloatArray,
    load: FloatArray,
    slope: FloatArray,
    tractrix: bool,
) -> LinearSteps:
    """The steps along a periodic motion (n, p, 3) m with the tractions (n, p, 2) N of its periodic state.

    ``walk`` (p, 2) m is what each period adds to the tangential displacement. ``load`` (n, p) N is the normal force at
    the samples, below zero in a gap, and ``slope`` (n, p) N/m its derivative by the closing. ``springs`` (p, 2) and
    ``friction`` (p,) are constants of the law.
    """
    samples, n_pairs = displacement.shape[:2]
    limits = friction * load
    steps = LinearSteps(
        np.empty((samples, n_pairs, 2, 2)),
        np.empty((samples, n_pairs, 2, 3)),
        np.empty((samples, n_pairs, 2, 3)),
        np.empty((samples, n_pairs)),
    )
    ratios = springs / springs.max(axis=1)[:, None]
    _fill(
        displacement, walk / samples, traction, limits, springs, friction * slope, slope,
        ratios, tractrix, steps.keep, steps.by_end, steps.by_start, steps.normal,
    )  # fmt: skip
    return steps


@njit(cache=True, nogil=True, error_model="numpy")
def _closed_part(here: float, there: float) -> float:
    """Part of the half step next to ``here`` in which a limit that varies linearly from here to there is positive."""
    middle = 0.5 * (here + there)
    if here > 0.0 and middle > 0.0:
        return 1.0
    if here <= 0.0 and middle <= 0.0:
        return 0.0
    inside = here / (here - middle)  # where the limit is zero, from here on
    return inside if here > 0.0 else 1.0 - inside


@njit(cache=True, nogil=True, error_model="numpy")
def _fill(
    displacement: FloatArray,
    walk: FloatArray,
    traction: FloatArray,
    limits: FloatArray,
    springs: FloatArray,
    limit_slope: FloatArray,
    normal_stiffness: FloatArray,
    ratios: FloatArray,
    tractrix: bool,
    keep: FloatArray,
    by_end: FloatArray,
    by_start: FloatArray,
    normal: FloatArray,
) -> None:
    """Fill the last four arrays; ``walk`` (p, 2) m is that of one step."""
    n = limits.shape[0]
    jacobian = np.zeros((2, 6))
    for j in range(n):
        i = j - 1 if j > 0 else n - 1
        k = j + 1 if j < n - 1 else 0
        for pair in range(limits.shape[1]):
            start, end = limits[i, pair], limits[j, pair]
            closed = 0.5 * (_closed_part(end, start) + _closed_part(end, limits[k, pair]))
            normal[j, pair] = closed * normal_stiffness[j, pair]
            d1 = springs[pair, 0] * (displacement[j, pair, 0] - displacement[i, pair, 0] + walk[pair, 0])
            d2 = springs[pair, 1] * (displacement[j, pair, 1] - displacement[i, pair, 1] + walk[pair, 1])
            t1, t2 = traction[i, pair, 0], traction[i, pair, 1]
            ratio1, ratio2 = ratios[pair, 0], ratios[pair, 1]
            new1, new2, code = advance(t1, t2, d1, d2, start, end, ratio1, ratio2, tractrix)
            if code == STICK and math.hypot(new1, new2) >= end * (1.0 - TOUCH):
                code = SLIP
            step_jacobian(code, t1, t2, d1, d2, start, end, ratio1, ratio2, tractrix, jacobian)
            for row in range(2):
                for column in range(2):
                    keep[j, pair, row, column] = jacobian[row, column]
                    by_end[j, pair, row, column] = jacobian[row, 2 + column] * springs[pair, column]
                    by_start[j, pair, row, column] = -jacobian[row, 2 + column] * springs[pair, column]
                by_end[j, pair, row, 2] = jacobian[row, 5] * limit_slope[j, pair]
                by_start[j, pair, row, 2] = jacobian[row, 4] * limit_slope[i, pair]
