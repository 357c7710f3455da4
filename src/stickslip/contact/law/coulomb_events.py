"""Instants of the period at which a pair begins to slip, lifts off or touches down, between the samples.

The Fourier integrals of the force are sums over samples. A force with a kink between two samples differs from its sum
by an amount that has corners of its own: each sample that changes state makes a corner in the curve of solutions. The
kink at the fraction theta of a step, with a force that would arrive at T_0 + d without it and arrives at T_1 with it,
adds ``theta (T_0 + d - T_1) / 2`` of a sample (trapezoidal rule on both sides of the instant), and similarly at
lift-off and touchdown, where the force is zero on one side. With this part the integrals are those of a motion that is
linear between samples. A pair that sticks and then lifts off in one step has two events: on its way to zero the
falling limit meets the force first, and the pair slips from there on. The sums are of second order, as sums are, but
their error does not scatter with the place of the events between the samples, and they are continuously differentiable
where one passes a sample. A corner remains at reversals: where another sample becomes the last that slips.
"""

from __future__ import annotations

import math

from stickslip.contact.law.coulomb_kernel import SLIP, CodeArray, slip_onset
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

# Onsets before this fraction of a step belong to slip that continues: round-off of a force on its limit.
LEAST_ONSET = 1e-9
# Place that no onset before lift-off has: it is above.
NO_ONSET = -1.0


@njit(cache=True, nogil=True, error_model="numpy")
def event(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
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
    theta = slip_onset(t1, t2, d1, d2, limit_start, limit_end)
    if theta <= LEAST_ONSET:
        return 0.0, 0.0, 0.0
    return theta, 0.5 * theta * (t1 + d1 - new1), 0.5 * theta * (t2 + d2 - new2)


@njit(cache=True, nogil=True, error_model="numpy")
def onset_before_lift_off(
    t1: float, t2: float, d1: float, d2: float, limit_start: float, limit_end: float
) -> tuple[float, float, float]:
    """Place and correction of the slip that begins in a step before the pair lifts off; the limit starts above zero.

    Until lift-off the step is one of its own, whose limit ends at zero: without this part the force would jump where
    the limit at the end of the step passes zero. With the instants ``onset`` and ``closed`` of both events as fractions
    of the step, the place is ``onset + closed - 1``, NO_ONSET for none: a pair that already slips has the correction
    of lift-off alone, and the first moments of both together continue it only from there. Beside a sample, at
    ``closed = 1`` and at ``onset = 0``, a place at the onset would leave a corner.
    """
    closed = limit_start / (limit_start - limit_end)
    theta = slip_onset(t1, t2, closed * d1, closed * d2, limit_start, 0.0)
    if theta <= LEAST_ONSET:
        return NO_ONSET, 0.0, 0.0
    onset = closed * theta
    return onset + closed - 1.0, 0.5 * onset * (t1 + closed * d1), 0.5 * onset * (t2 + closed * d2)


@njit(cache=True, nogil=True, error_model="numpy")
def share_between(i: int, j: int, theta: float, c1: float, c2: float, out: FloatArray) -> None:
    """Add the correction (c1, c2) at the place ``theta``, a fraction of a step, to both of its samples."""
    out[0, i] += (1.0 - theta) * c1
    out[1, i] += (1.0 - theta) * c2
    out[0, j] += theta * c1
    out[1, j] += theta * c2


@njit(cache=True, nogil=True, error_model="numpy")
def corrected_samples(
    path: FloatArray, limit: FloatArray, t1: float, t2: float, force: FloatArray, mode: CodeArray, out: FloatArray
) -> None:
    """Fill ``out`` (2, n): the samples of a period from (t1, t2), with the corrections beside its events."""
    n = limit.shape[0]
    for j in range(n):
        out[0, j], out[1, j] = force[0, j], force[1, j]
    for step in range(1, n + 1):
        i, j = step - 1, step % n
        if mode[j] == SLIP or limit[i] <= 0.0 or limit[j] <= 0.0:
            theta, c1, c2 = event(
                t1, t2, path[0, step] - path[0, i], path[1, step] - path[1, i], limit[i], limit[j],
                force[0, j], force[1, j], mode[j],
            )  # fmt: skip
            share_between(i, j, theta, c1, c2, out)
        if limit[i] > 0.0 >= limit[j]:
            theta, c1, c2 = onset_before_lift_off(
                t1, t2, path[0, step] - path[0, i], path[1, step] - path[1, i], limit[i], limit[j]
            )
            share_between(i, j, theta, c1, c2, out)
        t1, t2 = force[0, j], force[1, j]


@njit(cache=True, nogil=True, error_model="numpy")
def corrected_limit(limit: FloatArray, out: FloatArray) -> None:
    """Fill ``out`` (n,): ``max(limit, 0)`` with the corrections beside lift-off and touchdown."""
    n = limit.shape[0]
    for j in range(n):
        out[j] = max(limit[j], 0.0)
    for j in range(n):
        i = j - 1 if j > 0 else n - 1
        if (limit[i] > 0.0) != (limit[j] > 0.0):
            theta = limit[i] / (limit[i] - limit[j])
            part = 0.5 * limit[i] * limit[j] / abs(limit[i] - limit[j])
            out[i] += (1.0 - theta) * part
            out[j] += theta * part


@njit(cache=True, nogil=True, error_model="numpy")
def event_jacobian(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    new1: float,
    new2: float,
    code: int,
    jacobian: FloatArray,
    local: FloatArray,
) -> tuple[float, float, float]:
    """:func:`event`, and ``local`` (3, 6): derivatives of the correction (2) and of the instant by the first six.

    ``jacobian`` (2, 6) is that of the end of the step (of a step that does not end open).
    """
    local[:] = 0.0
    theta, c1, c2 = event(t1, t2, d1, d2, limit_start, limit_end, new1, new2, code)
    if limit_end <= 0.0 or limit_start <= 0.0:
        if limit_end <= 0.0 and limit_start <= 0.0:
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
    if theta == 0.0:
        return theta, c1, c2
    on1, on2 = t1 + theta * d1, t2 + theta * d2
    size = math.hypot(on1, on2)
    n1, n2 = on1 / size, on2 / size
    # Rate at which the stuck force would leave the limit; zero only where it grazes it, and then nothing slips.
    rate = n1 * d1 + n2 * d2 - (limit_end - limit_start)
    if rate <= 0.0:
        return 0.0, 0.0, 0.0
    local[2, 0], local[2, 1] = -n1 / rate, -n2 / rate
    local[2, 2], local[2, 3] = -theta * n1 / rate, -theta * n2 / rate
    local[2, 4], local[2, 5] = (1.0 - theta) / rate, theta / rate
    slip1, slip2 = t1 + d1 - new1, t2 + d2 - new2
    for k in range(6):
        local[0, k] = 0.5 * (slip1 * local[2, k] - theta * jacobian[0, k])
        local[1, k] = 0.5 * (slip2 * local[2, k] - theta * jacobian[1, k])
    for k in range(2):  # of T_0 + d
        local[k, k] += 0.5 * theta
        local[k, 2 + k] += 0.5 * theta
    return theta, c1, c2


@njit(cache=True, nogil=True, error_model="numpy")
def onset_before_lift_off_jacobian(
    t1: float, t2: float, d1: float, d2: float, limit_start: float, limit_end: float, local: FloatArray
) -> tuple[float, float, float]:
    """:func:`onset_before_lift_off`, and its derivatives in ``local`` as of :func:`event_jacobian`."""
    local[:] = 0.0
    place, c1, c2 = onset_before_lift_off(t1, t2, d1, d2, limit_start, limit_end)
    if place == NO_ONSET:
        return place, c1, c2
    span = limit_start - limit_end
    closed = limit_start / span
    onset = place + 1.0 - closed
    theta = onset / closed
    closing1, closing2 = closed * d1, closed * d2
    on1, on2 = t1 + theta * closing1, t2 + theta * closing2
    size = math.hypot(on1, on2)
    if size == 0.0:  # the force vanishes exactly at lift-off
        return place, c1, c2
    n1, n2 = on1 / size, on2 / size
    rate = n1 * closing1 + n2 * closing2 + limit_start
    if rate <= 0.0:
        return NO_ONSET, 0.0, 0.0
    # Derivatives of ``closed`` and of theta, at whose instant the force is on the limit (1 - theta) limit_start.
    by_closed = -theta * (n1 * d1 + n2 * d2) / rate
    closed_by_start, closed_by_end = -limit_end / span**2, limit_start / span**2
    for k in range(6):
        closed_slope = closed_by_start if k == 4 else (closed_by_end if k == 5 else 0.0)
        theta_slope = by_closed * closed_slope
        if k < 2:
            theta_slope -= (n1 if k == 0 else n2) / rate
        elif k < 4:
            theta_slope -= theta * closed * (n1 if k == 2 else n2) / rate
        elif k == 4:
            theta_slope += (1.0 - theta) / rate
        slope = closed * theta_slope + theta * closed_slope
        local[2, k] = slope + closed_slope
        local[0, k] = 0.5 * (slope * (t1 + closing1) + onset * d1 * closed_slope)
        local[1, k] = 0.5 * (slope * (t2 + closing2) + onset * d2 * closed_slope)
    for k in range(2):  # of T_0 + d until lift-off
        local[k, k] += 0.5 * onset
        local[k, 2 + k] += 0.5 * onset * closed
    return place, c1, c2
