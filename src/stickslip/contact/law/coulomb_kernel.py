"""One time step of the friction law and its Jacobian: scalar functions for the marches over a period.

Everything is in force units: ``d = K ds`` is the elastic force that the step would add if the pair stuck, and a limit
is ``lambda = mu * (N0 + kn * n)``, negative where the pair is open. Inside a step the displacement and the limit vary
linearly. The stiffness enters as the ratios ``k1 / k_max, k2 / k_max`` (both 1: isotropic).

Equations, sources and derivations: docs/theory_friction.md.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.law import ContactState
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray

CodeArray = NDArray[np.int8]
# Sample numbers; constants are written np.int64(...), else numba compiles a version for each constant.
Index = int | np.int64
STICK, SLIP, OPEN = (int(state) for state in ContactState)  # numba takes plain numbers
# |T| may exceed the limit by this relative amount and still count as stick: round-off of a pair that touches its limit.
STICK_TOLERANCE = 1e-14
# chosen: between these, the square of a length has all digits (double precision: 1e-308 to 1e308).
SMALLEST_SQUARE, LARGEST_SQUARE = 1e-280, 1e280


@njit(cache=True, nogil=True, error_model="numpy")
def inverse_mean_limit(first: float, last: float) -> tuple[float, float, float]:
    """Mean of 1 / lambda while lambda varies linearly from first to last, and its two partial derivatives.

    ``ln(last / first) / (last - first)``, written with h = (last - first) / (last + first) as atanh(h) / (h * middle),
    which stays exact for equal limits.
    """
    middle = 0.5 * (first + last)
    h = (last - first) / (first + last)
    if abs(h) < 1e-2:
        square = h * h
        value = 1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0 + square / 9.0)))
        slope = h * (2.0 / 3.0 + square * (4.0 / 5.0 + square * (6.0 / 7.0 + square * 8.0 / 9.0)))
    else:
        value = 0.5 * math.log(last / first) / h
        slope = (middle * middle / (first * last) - value) / h
    by_first = 0.5 * (-slope * (1.0 + h) - value) / (middle * middle)
    by_last = 0.5 * (slope * (1.0 - h) - value) / (middle * middle)
    return value / middle, by_first, by_last


@njit(cache=True, nogil=True, error_model="numpy")
def slip_onset(t1: float, t2: float, d1: float, d2: float, limit_start: float, limit_end: float) -> float:
    """Fraction theta of the step at which ``|T + theta d| = lambda(theta)`` is crossed outwards.

    Call it only if the end of the step lies outside the limit. ``|T + theta d| - lambda(theta)`` is convex in theta and
    not positive at 0, so there is exactly one such crossing: also for a pair that starts on the limit and first unloads
    across the whole disc. The force at the end of the step does not depend on theta to first order.
    """
    change = limit_end - limit_start
    square = d1 * d1 + d2 * d2 - change * change
    half = t1 * d1 + t2 * d2 - limit_start * change
    start = min(t1 * t1 + t2 * t2 - limit_start * limit_start, 0.0)
    root = math.sqrt(max(half * half - square * start, 0.0))
    if half < 0.0:
        return min((root - half) / square, 1.0)
    if start == 0.0:
        return 0.0
    return min(-start / (half + root), 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
def length_of(x: float, y: float) -> float:
    """``hypot(x, y)``, quicker wherever the square of the length is a normal number."""
    square = x * x + y * y
    if SMALLEST_SQUARE < square < LARGEST_SQUARE:
        return math.sqrt(square)
    return math.hypot(x, y)


@njit(cache=True, nogil=True, error_model="numpy")
def slide_frame(t1: float, t2: float, d1: float, d2: float) -> tuple[float, float, float, float, float]:
    """Direction e of the motion, its length, and (a, b) with tan(phi / 2) = b / a, phi the angle from e to T.

    The function uses the half-angle form without cancellation, so phi near pi has all digits.
    """
    length, norm = length_of(d1, d2), length_of(t1, t2)
    u1, u2 = t1 / norm, t2 / norm
    e1, e2 = u1, u2
    if length > 0.0:
        e1, e2 = d1 / length, d2 / length
    cosine, sine = u1 * e1 + u2 * e2, e1 * u2 - e2 * u1
    if cosine >= 0.0:
        return e1, e2, length, 1.0 + cosine, sine
    return e1, e2, length, sine, 1.0 - cosine


@njit(cache=True, nogil=True, error_model="numpy")
def turned(a: float, b: float, decay: float) -> tuple[float, float]:
    """cos(phi), sin(phi) after the tractrix has multiplied tan(phi / 2) = b / a by ``decay``."""
    if a == 0.0:
        return -1.0, 0.0
    b = b * decay
    norm = a * a + b * b
    return (a * a - b * b) / norm, 2.0 * a * b / norm


@njit(cache=True, nogil=True, error_model="numpy")
def associated_return(
    trial1: float, trial2: float, limit: float, ratio1: float, ratio2: float
) -> tuple[float, float, float]:
    """Return of a trial force to |T| = limit with the slider moving along T: ``T_i = trial_i / (1 + x r_i)``.

    Returns T1, T2, x. Newton on the increasing, concave ``1 / |T(x)|`` from a lower bound of the root rises
    monotonically to it, so it cannot fail; for equal ratios the bound is the root (radial return).
    """
    norm = math.hypot(trial1, trial2)
    x = norm / limit - 1.0
    if ratio1 == ratio2:
        return trial1 * (limit / norm), trial2 * (limit / norm), x
    for _ in range(60):
        f1, f2 = 1.0 / (1.0 + x * ratio1), 1.0 / (1.0 + x * ratio2)
        t1, t2 = trial1 * f1, trial2 * f2
        square = t1 * t1 + t2 * t2
        size = math.sqrt(square)
        step = (size - limit) / limit * square / (t1 * t1 * ratio1 * f1 + t2 * t2 * ratio2 * f2)
        x += step
        if not step > 1e-15 * (1.0 + x):
            break
    t1, t2 = trial1 / (1.0 + x * ratio1), trial2 / (1.0 + x * ratio2)
    scale = limit / math.hypot(t1, t2)
    return t1 * scale, t2 * scale, x


@njit(cache=True, nogil=True, error_model="numpy")
def elastic_step(
    t1: float, t2: float, d1: float, d2: float, limit_start: float, limit_end: float
) -> tuple[float, float, int]:
    """Force at the end of a step that the pair would have without slip, and how the step ends: STICK, SLIP or OPEN."""
    if limit_end <= 0.0:
        return 0.0, 0.0, OPEN
    if limit_start <= 0.0:
        # Touchdown: the spring starts to load, from zero, where the limit passes zero.
        closed = limit_end / (limit_end - limit_start)
        t1, t2, d1, d2 = 0.0, 0.0, d1 * closed, d2 * closed
    trial1, trial2 = t1 + d1, t2 + d2
    if trial1 * trial1 + trial2 * trial2 <= (limit_end * (1.0 + STICK_TOLERANCE)) ** 2:
        return trial1, trial2, STICK
    return trial1, trial2, SLIP


@njit(cache=True, nogil=True, error_model="numpy")
def advance(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    tractrix: bool,
) -> tuple[float, float, int]:
    """Friction force at the end of a step, and how it ends: STICK, SLIP or OPEN."""
    trial1, trial2, code = elastic_step(t1, t2, d1, d2, limit_start, limit_end)
    if code != SLIP:
        return trial1, trial2, code
    if not tractrix or limit_start <= 0.0 or ratio1 != ratio2:
        new1, new2, _ = associated_return(trial1, trial2, limit_end, ratio1, ratio2)
        return new1, new2, SLIP
    theta = slip_onset(t1, t2, d1, d2, limit_start, limit_end)
    e1, e2, length, a, b = slide_frame(t1 + theta * d1, t2 + theta * d2, d1, d2)
    inverse, _, _ = inverse_mean_limit(limit_start + theta * (limit_end - limit_start), limit_end)
    cosine, sine = turned(a, b, math.exp(-length * (1.0 - theta) * inverse))
    return limit_end * (cosine * e1 - sine * e2), limit_end * (cosine * e2 + sine * e1), SLIP


@njit(cache=True, nogil=True, error_model="numpy")
def return_jacobian(
    new1: float, new2: float, x: float, limit: float, ratio1: float, ratio2: float
) -> tuple[float, float, float, float, float, float]:
    """Derivatives of the associated return: T1 by trial1, trial2, T2 by trial1, trial2, T1 and T2 by the limit."""
    f1, f2 = 1.0 / (1.0 + x * ratio1), 1.0 / (1.0 + x * ratio2)
    n1, n2 = new1 / limit, new2 / limit
    h1, h2 = n1 * ratio1 * f1, n2 * ratio2 * f2
    q = n1 * h1 + n2 * h2
    h1, h2 = h1 / q, h2 / q
    return f1 - h1 * n1 * f1, -h1 * n2 * f2, -h2 * n1 * f1, f2 - h2 * n2 * f2, h1, h2


@njit(cache=True, nogil=True, error_model="numpy")
def slip_jacobian(
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    tractrix: bool,
    jacobian: FloatArray,
) -> tuple[float, float]:
    """Force at the end of a SLIP step; fills ``jacobian`` (2, 6) by t1, t2, d1, d2, limit_start, limit_end."""
    if not tractrix or limit_start <= 0.0 or ratio1 != ratio2:
        closed, by_start, by_end, from_old = 1.0, 0.0, 0.0, 1.0
        if limit_start <= 0.0:
            span = limit_end - limit_start
            closed, by_start, by_end, from_old = limit_end / span, limit_end / span**2, -limit_start / span**2, 0.0
        trial1, trial2 = from_old * t1 + closed * d1, from_old * t2 + closed * d2
        new1, new2, x = associated_return(trial1, trial2, limit_end, ratio1, ratio2)
        r11, r12, r21, r22, l1, l2 = return_jacobian(new1, new2, x, limit_end, ratio1, ratio2)
        jacobian[0, 0], jacobian[0, 1] = from_old * r11, from_old * r12
        jacobian[1, 0], jacobian[1, 1] = from_old * r21, from_old * r22
        jacobian[0, 2], jacobian[0, 3] = closed * r11, closed * r12
        jacobian[1, 2], jacobian[1, 3] = closed * r21, closed * r22
        along1, along2 = r11 * d1 + r12 * d2, r21 * d1 + r22 * d2
        jacobian[0, 4], jacobian[1, 4] = by_start * along1, by_start * along2
        jacobian[0, 5], jacobian[1, 5] = l1 + by_end * along1, l2 + by_end * along2
        return new1, new2
    theta = slip_onset(t1, t2, d1, d2, limit_start, limit_end)
    change, rest = limit_end - limit_start, 1.0 - theta
    s1, s2 = t1 + theta * d1, t2 + theta * d2
    limit_onset = limit_start + theta * change
    e1, e2, length, a, b = slide_frame(s1, s2, d1, d2)
    inverse, inverse_by_first, inverse_by_last = inverse_mean_limit(limit_onset, limit_end)
    travel = length * rest * inverse
    decay = math.exp(-travel)
    cosine, sine = turned(a, b, decay)
    norm = a * a + (b * decay) ** 2
    keep = decay * (a * a + b * b) / norm if norm > 0.0 else 1.0
    loss_per_length = -math.expm1(-travel) / length if length > 0.0 else rest * inverse
    loss_per_length *= (a * a - b * b * decay) / norm if norm > 0.0 else 1.0
    u1, u2 = cosine * e1 - sine * e2, cosine * e2 + sine * e1
    n1, n2 = s1 / limit_onset, s2 / limit_onset
    # theta is constant here: the rates of stick and slip differ along T alone, so a shift of the onset turns T to
    # second order.
    by_old, by_travel = keep / limit_onset, -sine * rest
    along = -by_travel * inverse
    turn1, turn2 = -by_old * n2, by_old * n1  # derivatives of the angle of T by t1, t2, then d1, d2 and the limits
    turn3 = theta * turn1 - e2 * loss_per_length - along * e1
    turn4 = theta * turn2 + e1 * loss_per_length - along * e2
    turn5 = by_travel * length * rest * inverse_by_first
    turn6 = by_travel * length * (theta * inverse_by_first + inverse_by_last)
    across1, across2 = -limit_end * u2, limit_end * u1
    jacobian[0, 0], jacobian[1, 0] = across1 * turn1, across2 * turn1
    jacobian[0, 1], jacobian[1, 1] = across1 * turn2, across2 * turn2
    jacobian[0, 2], jacobian[1, 2] = across1 * turn3, across2 * turn3
    jacobian[0, 3], jacobian[1, 3] = across1 * turn4, across2 * turn4
    jacobian[0, 4], jacobian[1, 4] = across1 * turn5, across2 * turn5
    jacobian[0, 5], jacobian[1, 5] = u1 + across1 * turn6, u2 + across2 * turn6
    return limit_end * u1, limit_end * u2


@njit(cache=True, nogil=True, error_model="numpy")
def stick_jacobian(d1: float, d2: float, limit_start: float, limit_end: float, jacobian: FloatArray) -> None:
    """Fill ``jacobian`` (2, 6) of a STICK step, touchdown included."""
    jacobian[:] = 0.0
    if limit_start > 0.0:
        jacobian[0, 0] = jacobian[1, 1] = jacobian[0, 2] = jacobian[1, 3] = 1.0
        return
    span = limit_end - limit_start
    jacobian[0, 2] = jacobian[1, 3] = limit_end / span
    jacobian[0, 4], jacobian[1, 4] = d1 * limit_end / span**2, d2 * limit_end / span**2
    jacobian[0, 5], jacobian[1, 5] = -d1 * limit_start / span**2, -d2 * limit_start / span**2


@njit(cache=True, nogil=True, error_model="numpy")
def step_jacobian(
    code: int,
    t1: float,
    t2: float,
    d1: float,
    d2: float,
    limit_start: float,
    limit_end: float,
    ratio1: float,
    ratio2: float,
    tractrix: bool,
    jacobian: FloatArray,
) -> None:
    """Fill ``jacobian`` (2, 6) of a step that ends with ``code``; zero where it ends open."""
    if code == OPEN:
        jacobian[:] = 0.0
    elif code == SLIP:
        slip_jacobian(t1, t2, d1, d2, limit_start, limit_end, ratio1, ratio2, tractrix, jacobian)
    else:
        stick_jacobian(d1, d2, limit_start, limit_end, jacobian)
