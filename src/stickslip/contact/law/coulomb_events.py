"""Instants of the period at which a pair begins to slip, lifts off or touches down, between the samples.

The Fourier integrals of the force are sums over samples. A force with a kink between two samples differs from its sum
by an amount that has corners of its own: each sample that changes state makes a corner in the curve of solutions. The
kink at the fraction theta of a step, where the rate of the force falls by r, adds ``theta (1 - theta) r / 2`` of a
sample (trapezoidal rule on both sides of the instant), and similarly at lift-off and touchdown, where the force is zero
on one side. With this part the integrals are those of a motion that is linear between samples. A pair that sticks and
then lifts off in one step has two events: on its way to zero the falling limit meets the force first, and the pair
slips from there on. The sums are of second order, as sums are, but their error does not scatter with the place of the
events between the samples, and they are continuously differentiable where one passes a sample. A corner remains at
reversals: where another sample becomes the last that slips.
"""

from __future__ import annotations

import math

import numpy as np

from stickslip.contact.law.coulomb_kernel import SLIP, CodeArray, slip_onset
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# Onsets before this fraction of a step belong to slip that continues: round-off of a force on its limit.
LEAST_ONSET = 1e-9
# Place that no onset before lift-off has: it is above.
NO_ONSET = -1.0


@njit(cache=True, nogil=True, error_model="numpy")
def onset_of_slip(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    new1: float,
    new2: float,
) -> tuple[float, float, float]:
    """Instant theta of the onset in a SLIP step that ends with the force T_1 = (new1, new2), and the correction.

    At the onset, with the force T = lambda n, the rate falls from d to ``d - g R n``, with the stiffness ratios R and
    ``g = (n . d - dlambda) / (n . R n)``, so that the force follows the limit. The correction is ``theta (1 - theta) /
    2`` times this change of rate in the part ``1 - theta``, and ``theta (T_0 + d - T_1) / 2``, by the mean rates, in
    the part theta. On a straight line both are equal. Where T turns, the first is the same on both sides of a sample,
    and vanishes with the onset of a pair that starts on its limit and dips below it: the second has a corner at each.
    But only the second bounds the force where it turns far within the step. 0 for no onset.
    """
    theta = slip_onset(t1, t2, d1, d2, limit_start, limit_end)
    on1, on2 = t1 + theta * d1, t2 + theta * d2
    size = math.hypot(on1, on2)
    if theta <= LEAST_ONSET or size == 0.0:
        return 0.0, 0.0, 0.0
    n1, n2 = on1 / size, on2 / size
    rate = n1 * d1 + n2 * d2 - (limit_end - limit_start)
    if rate <= 0.0:  # it only grazes its limit
        return 0.0, 0.0, 0.0
    share = 0.5 * theta * (1.0 - theta) ** 2 * rate / (n1 * n1 * ratio1 + n2 * n2 * ratio2)
    mean = 0.5 * theta**2
    return theta, share * ratio1 * n1 + mean * (t1 + d1 - new1), share * ratio2 * n2 + mean * (t2 + d2 - new2)


@njit(cache=True, nogil=True, error_model="numpy")
def event(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    new1: float,
    new2: float,
    code: int,
) -> tuple[float, float, float]:
    """Instant of the event in a step as a fraction of it, and the correction of the sum of samples; 0 for none."""
    if limit_end <= 0.0:
        if limit_start <= 0.0:
            return 0.0, 0.0, 0.0
        closed = limit_start / (limit_start - limit_end)
        return closed, 0.5 * (closed - 1.0) * t1, 0.5 * (closed - 1.0) * t2
    if limit_start <= 0.0:
        closed = limit_end / (limit_end - limit_start)
        return 1.0 - closed, 0.5 * (closed - 1.0) * new1, 0.5 * (closed - 1.0) * new2
    if code != SLIP:
        return 0.0, 0.0, 0.0
    theta, c1, c2 = onset_of_slip(t1, t2, d1, d2, limit_start, limit_end, ratio1, ratio2, new1, new2)
    return theta, c1, c2


@njit(cache=True, nogil=True, error_model="numpy")
def onset_before_lift_off(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
) -> tuple[float, float, float]:
    """Place and correction of the slip that begins in a step before the pair lifts off; the limit starts above zero.

    Until lift-off the step is one of its own, whose limit ends at zero: without this part the force would jump where
    the limit at the end of the step passes zero. With the instants ``onset`` and ``closed`` of both events as fractions
    of the step, the place is ``onset + closed - 1``, NO_ONSET for none: a pair that already slips has the correction
    of lift-off alone, and the first moments of both together continue it only from there. Beside a sample, at
    ``closed = 1`` and at ``onset = 0``, a place at the onset would leave a corner.
    """
    closed = limit_start / (limit_start - limit_end)
    theta, c1, c2 = onset_of_slip(t1, t2, closed * d1, closed * d2, limit_start, 0.0, ratio1, ratio2, 0.0, 0.0)
    if theta == 0.0:
        return NO_ONSET, 0.0, 0.0
    return closed * theta + closed - 1.0, closed * c1, closed * c2


@njit(cache=True, nogil=True, error_model="numpy")
def share_between(i: int, j: int, theta: float, c1: float, c2: float, out: FloatArray) -> None:
    """Add the correction (c1, c2) at the place ``theta``, a fraction of a step, to both of its samples."""
    out[0, i] += (1.0 - theta) * c1
    out[1, i] += (1.0 - theta) * c2
    out[0, j] += theta * c1
    out[1, j] += theta * c2


@njit(cache=True, nogil=True, error_model="numpy")
def corrected_samples(
    path: FloatArray,
    limit: FloatArray,
    ratio1: float,
    ratio2: float,
    t1: float,
    t2: float,
    force: FloatArray,
    mode: CodeArray,
    out: FloatArray,
) -> None:
    """Fill ``out`` (2, n): the samples of a period from (t1, t2), with the corrections beside its events."""
    n = limit.shape[0]
    for j in range(n):
        out[0, j], out[1, j] = force[0, j], force[1, j]
    for step in range(1, n + 1):
        i, j = step - 1, step % n
        if mode[j] == SLIP or limit[i] <= 0.0 or limit[j] <= 0.0:
            theta, c1, c2 = event(
                t1, t2, path[0, step] - path[0, i], path[1, step] - path[1, i], limit[i], limit[j], ratio1, ratio2,
                force[0, j], force[1, j], mode[j],
            )  # fmt: skip
            share_between(i, j, theta, c1, c2, out)
        if limit[i] > 0.0 >= limit[j]:
            theta, c1, c2 = onset_before_lift_off(
                t1, t2, path[0, step] - path[0, i], path[1, step] - path[1, i], limit[i], limit[j], ratio1, ratio2
            )
            share_between(i, j, theta, c1, c2, out)
        t1, t2 = force[0, j], force[1, j]


@njit(cache=True, nogil=True, error_model="numpy")
def corrected_limits(limits: FloatArray, out: FloatArray) -> None:
    """Fill ``out`` (n_pairs, n): ``max(limits, 0)`` with the corrections beside lift-off and touchdown."""
    for pair in range(limits.shape[0]):
        limit = limits[pair]
        n = limit.shape[0]
        for j in range(n):
            out[pair, j] = max(limit[j], 0.0)
        for j in range(n):
            i = j - 1 if j > 0 else n - 1
            if (limit[i] > 0.0) != (limit[j] > 0.0):
                theta = limit[i] / (limit[i] - limit[j])
                part = 0.5 * limit[i] * limit[j] / abs(limit[i] - limit[j])
                out[pair, i] += (1.0 - theta) * part
                out[pair, j] += theta * part


@njit(cache=True, nogil=True, error_model="numpy")
def onset_of_slip_jacobian(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    new1: float,
    new2: float,
    jacobian: FloatArray,
    local: FloatArray,
) -> tuple[float, float, float]:
    """:func:`onset_of_slip`, and its derivatives in ``local`` as of :func:`event_jacobian`."""
    local[:] = 0.0
    theta, c1, c2 = onset_of_slip(t1, t2, d1, d2, limit_start, limit_end, ratio1, ratio2, new1, new2)
    if theta == 0.0:
        return theta, c1, c2
    on1, on2 = t1 + theta * d1, t2 + theta * d2
    size = math.hypot(on1, on2)
    n1, n2 = on1 / size, on2 / size
    rate = n1 * d1 + n2 * d2 - (limit_end - limit_start)
    rest = 1.0 - theta
    weight, mean, spread = 0.5 * theta * rest**2, 0.5 * theta**2, n1 * n1 * ratio1 + n2 * n2 * ratio2
    local[2, 0], local[2, 1] = -n1 / rate, -n2 / rate
    local[2, 2], local[2, 3] = -theta * n1 / rate, -theta * n2 / rate
    local[2, 4], local[2, 5] = (1.0 - theta) / rate, theta / rate
    for k in range(6):
        slope = local[2, k]
        o1, o2 = slope * d1, slope * d2  # of the force at the onset, which n turns with
        rate_slope = 0.0
        if k == 0 or k == 2:
            o1 += 1.0 if k == 0 else theta
        elif k == 1 or k == 3:
            o2 += 1.0 if k == 1 else theta
        if k == 2:
            rate_slope = n1
        elif k == 3:
            rate_slope = n2
        elif k >= 4:
            rate_slope = 1.0 if k == 4 else -1.0
        along = n1 * o1 + n2 * o2
        by1, by2 = (o1 - along * n1) / size, (o2 - along * n2) / size  # of n
        rate_slope += by1 * d1 + by2 * d2
        share_slope = 0.5 * rest * (1.0 - 3.0 * theta) * slope * rate + weight * rate_slope
        share_slope -= weight * rate * 2.0 * (n1 * ratio1 * by1 + n2 * ratio2 * by2) / spread
        local[0, k] = ratio1 * (share_slope * n1 + weight * rate * by1) / spread
        local[1, k] = ratio2 * (share_slope * n2 + weight * rate * by2) / spread
        local[0, k] += theta * slope * (t1 + d1 - new1) - mean * jacobian[0, k]
        local[1, k] += theta * slope * (t2 + d2 - new2) - mean * jacobian[1, k]
    for k in range(2):  # of T_0 + d
        local[k, k] += mean
        local[k, 2 + k] += mean
    return theta, c1, c2


@njit(cache=True, nogil=True, error_model="numpy")
def event_jacobian(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    new1: float,
    new2: float,
    code: int,
    jacobian: FloatArray,
    local: FloatArray,
) -> tuple[float, float, float]:
    """:func:`event`, and ``local`` (3, 6): derivatives of the correction (2) and of the instant by the first six.

    ``jacobian`` (2, 6) is that of the end of the step (of a step that does not end open).
    """
    if limit_end > 0.0 and limit_start > 0.0 and code == SLIP:
        theta, c1, c2 = onset_of_slip_jacobian(
            t1, t2, d1, d2, limit_start, limit_end, ratio1, ratio2, new1, new2, jacobian, local
        )
        return theta, c1, c2
    local[:] = 0.0
    theta, c1, c2 = event(t1, t2, d1, d2, limit_start, limit_end, ratio1, ratio2, new1, new2, code)
    if (limit_end <= 0.0) == (limit_start <= 0.0):
        return theta, c1, c2
    square = (limit_end - limit_start) ** 2
    local[2, 4], local[2, 5] = -limit_end / square, limit_start / square
    if limit_end <= 0.0:
        local[0, 0] = local[1, 1] = 0.5 * (theta - 1.0)
        for k in range(4, 6):
            local[0, k], local[1, k] = 0.5 * t1 * local[2, k], 0.5 * t2 * local[2, k]
    else:
        for k in range(6):
            local[0, k] = -0.5 * (theta * jacobian[0, k] + new1 * local[2, k])
            local[1, k] = -0.5 * (theta * jacobian[1, k] + new2 * local[2, k])
    return theta, c1, c2


@njit(cache=True, nogil=True, error_model="numpy")
def onset_before_lift_off_jacobian(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    local: FloatArray,
) -> tuple[float, float, float]:
    """:func:`onset_before_lift_off`, and its derivatives in ``local`` as of :func:`event_jacobian`."""
    span = limit_start - limit_end
    closed = limit_start / span
    theta, c1, c2 = onset_of_slip_jacobian(
        t1, t2, closed * d1, closed * d2, limit_start, 0.0, ratio1, ratio2, 0.0, 0.0, np.zeros((2, 6)), local
    )  # fmt: skip
    if theta == 0.0:
        return NO_ONSET, 0.0, 0.0
    for row in range(3):
        # By the limits, through ``closed``: that of the part until lift-off ends at zero.
        by_closed = local[row, 2] * d1 + local[row, 3] * d2
        local[row, 2] *= closed
        local[row, 3] *= closed
        local[row, 4] -= by_closed * limit_end / span**2
        local[row, 5] = by_closed * limit_start / span**2
    for k in range(6):
        closed_slope = -limit_end / span**2 if k == 4 else (limit_start / span**2 if k == 5 else 0.0)
        local[0, k] = closed * local[0, k] + c1 * closed_slope
        local[1, k] = closed * local[1, k] + c2 * closed_slope
        local[2, k] = closed * local[2, k] + theta * closed_slope + closed_slope
    return closed * theta + closed - 1.0, closed * c1, closed * c2
