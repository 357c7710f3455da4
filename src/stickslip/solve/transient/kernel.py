"""Compiled parts of the time integration: the friction law over one step, and the march over one period.

Independent of the friction law of the harmonic balance on purpose: each checks the other.
"""

from __future__ import annotations

import math

import numpy as np

from stickslip.contact.law.law import ContactState
from stickslip.core.compiled import njit

STUCK, SLIPPING, OPEN = (int(state) for state in ContactState)  # numba takes plain numbers

# A force this close to the friction limit (relative, squared) counts as on it: slip then starts at once, and round-off
# of the last step is not mistaken for a short stick.
_ON_THE_LIMIT = 1e-13
# Below this ratio of k * path to friction limit the direction of the step is round-off.
_NO_MOTION = 1e-12


@njit(cache=True, nogil=True)
def mean_inverse(ratio):  # type: ignore[no-untyped-def]  # pragma: no cover
    """``log(1 + r) / r`` and its derivative: the mean of 1/N over a linear change of N from 1 to 1 + r."""
    if abs(ratio) < 1e-4:
        value = 1.0 - ratio / 2.0 + ratio**2 / 3.0 - ratio**3 / 4.0
        return value, -0.5 + 2.0 * ratio / 3.0 - 0.75 * ratio**2
    value = math.log1p(ratio) / ratio
    return value, (1.0 / (1.0 + ratio) - value) / ratio


@njit(cache=True, nogil=True)
def step_law(  # type: ignore[no-untyped-def]  # pragma: no cover
    step, traction, normal_force, tangential_stiffness, normal_stiffness, friction, force, tangent
):
    """Contact force of one pair at the end of a step along which its displacement is a straight line.

    ``step`` (3,) m is the increment of t1, t2, n; ``traction`` (2,) N the friction force at the start of the step;
    ``normal_force`` N the unclipped ``preload + k_n n`` there (negative: a gap). Fills ``force`` (3,) = T1, T2, N at
    the end and ``tangent`` (3, 3) = d force / d step, and returns STUCK, SLIPPING or OPEN.

    The law is integrated exactly along the line: lift-off, touchdown and slip onset are located inside the step, and
    the slip phase, in which the angle psi from the motion to the friction force obeys ``d psi / d s = -k sin(psi) / (mu
    N)`` with N linear in s, is solved in closed form. Radial return is its first-order approximation.
    """
    force[:] = 0.0
    tangent[:, :] = 0.0
    k, mu = tangential_stiffness, friction
    normal_change = normal_stiffness * step[2]
    normal_end = normal_force + normal_change
    if normal_end <= 0.0:
        return OPEN
    force[2] = normal_end
    tangent[2, 2] = normal_stiffness
    pull0, pull1 = k * step[0], k * step[1]
    pull = math.hypot(pull0, pull1)
    limit_end = mu * normal_end

    if normal_force <= 0.0:
        # Touchdown: friction grows from zero over the part of the step in contact.
        share = normal_end / normal_change
        if pull <= mu * normal_change:
            force[0], force[1] = share * pull0, share * pull1
            fraction_rate = -normal_stiffness * normal_force / normal_change**2
            tangent[0, 0] = tangent[1, 1] = share * k
            tangent[0, 2], tangent[1, 2] = pull0 * fraction_rate, pull1 * fraction_rate
            return STUCK
        e0, e1 = pull0 / pull, pull1 / pull
        force[0], force[1] = limit_end * e0, limit_end * e1
        turn = limit_end * k / pull
        tangent[0, 0], tangent[1, 1] = turn * e1 * e1, turn * e0 * e0
        tangent[0, 1] = tangent[1, 0] = -turn * e0 * e1
        tangent[0, 2], tangent[1, 2] = mu * normal_stiffness * e0, mu * normal_stiffness * e1
        return SLIPPING

    trial0, trial1 = traction[0] + pull0, traction[1] + pull1
    trial = math.hypot(trial0, trial1)
    limit_start = mu * normal_force
    if trial <= limit_end:
        force[0], force[1] = trial0, trial1
        tangent[0, 0] = tangent[1, 1] = k
        return STUCK

    if pull <= _NO_MOTION * limit_start:
        # Only the limit shrinks (or the motion is too small to have a direction): radial return is exact here.
        e0, e1 = trial0 / trial, trial1 / trial
        force[0], force[1] = limit_end * e0, limit_end * e1
        turn = limit_end * k / trial
        tangent[0, 0], tangent[1, 1] = turn * e1 * e1, turn * e0 * e0
        tangent[0, 1] = tangent[1, 0] = -turn * e0 * e1
        tangent[0, 2], tangent[1, 2] = mu * normal_stiffness * e0, mu * normal_stiffness * e1
        return SLIPPING

    # Slip onset: |traction + tau * pull| = limit_start + tau * mu * normal_change, tau in [0, 1]. The cone is convex,
    # so the force leaves it once.
    limit_change = mu * normal_change
    a = pull * pull - limit_change * limit_change
    b = traction[0] * pull0 + traction[1] * pull1 - limit_start * limit_change
    c = traction[0] ** 2 + traction[1] ** 2 - limit_start**2
    if c > -_ON_THE_LIMIT * limit_start**2:
        c = 0.0
    onset = 0.0
    onset_rate = np.zeros(3)
    if c < 0.0 or b < 0.0:
        root = math.sqrt(max(b * b - a * c, 0.0))
        onset = -c / (b + root) if b >= 0.0 else (root - b) / a
        onset = min(max(onset, 0.0), 1.0)
        if root > 0.0:
            a_rate = (2.0 * k * pull0, 2.0 * k * pull1, -2.0 * mu * normal_stiffness * limit_change)
            b_rate = (k * traction[0], k * traction[1], -mu * normal_stiffness * limit_start)
            for j in range(3):
                onset_rate[j] = -(a_rate[j] * onset + 2.0 * b_rate[j]) * onset / (2.0 * root)

    # Force direction t at slip onset, motion direction e, and q = t . e.
    normal_onset = normal_force + onset * normal_change
    limit_onset = mu * normal_onset
    t0, t1 = (traction[0] + onset * pull0) / limit_onset, (traction[1] + onset * pull1) / limit_onset
    length = math.hypot(t0, t1)
    t0, t1 = t0 / length, t1 / length
    e0, e1 = pull0 / pull, pull1 / pull
    q = t0 * e0 + t1 * e1
    # decay = tan(psi_end / 2) / tan(psi_onset / 2) = exp(-k / mu * integral of ds / N).
    ratio = (normal_end - normal_onset) / normal_onset
    inverse, inverse_rate = mean_inverse(ratio)
    exponent = (1.0 - onset) * pull / limit_onset * inverse
    decay = math.exp(-min(exponent, 200.0))
    along = (1.0 - decay) * (1.0 + decay + q * (1.0 - decay))
    below = 1.0 + decay * decay + q * (1.0 - decay * decay)
    direction0 = (along * e0 + 2.0 * decay * t0) / below
    direction1 = (along * e1 + 2.0 * decay * t1) / below
    force[0], force[1] = limit_end * direction0, limit_end * direction1

    for j in range(3):
        pull0_rate, pull1_rate = (k if j == 0 else 0.0), (k if j == 1 else 0.0)
        normal_rate = normal_stiffness if j == 2 else 0.0
        pull_rate = e0 * pull0_rate + e1 * pull1_rate
        e0_rate, e1_rate = (pull0_rate - e0 * pull_rate) / pull, (pull1_rate - e1 * pull_rate) / pull
        normal_onset_rate = onset_rate[j] * normal_change + onset * normal_rate
        limit_onset_rate = mu * normal_onset_rate
        t0_rate = (onset_rate[j] * pull0 + onset * pull0_rate - t0 * limit_onset_rate) / limit_onset
        t1_rate = (onset_rate[j] * pull1 + onset * pull1_rate - t1 * limit_onset_rate) / limit_onset
        q_rate = t0_rate * e0 + t1_rate * e1 + t0 * e0_rate + t1 * e1_rate
        ratio_rate = (normal_rate - (1.0 + ratio) * normal_onset_rate) / normal_onset
        exponent_rate = (
            (-onset_rate[j] * pull + (1.0 - onset) * pull_rate - (1.0 - onset) * pull * limit_onset_rate / limit_onset)
            * inverse
            + (1.0 - onset) * pull * inverse_rate * ratio_rate
        ) / limit_onset
        decay_rate = -decay * exponent_rate
        along_rate = -decay_rate * (1.0 + decay + q * (1.0 - decay)) + (1.0 - decay) * (
            decay_rate * (1.0 - q) + q_rate * (1.0 - decay)
        )
        below_rate = 2.0 * decay * decay_rate * (1.0 - q) + q_rate * (1.0 - decay * decay)
        change0 = (
            along_rate * e0 + along * e0_rate + 2.0 * (decay_rate * t0 + decay * t0_rate) - direction0 * below_rate
        )
        change1 = (
            along_rate * e1 + along * e1_rate + 2.0 * (decay_rate * t1 + decay * t1_rate) - direction1 * below_rate
        )
        tangent[0, j] = mu * normal_rate * direction0 + limit_end * change0 / below
        tangent[1, j] = mu * normal_rate * direction1 + limit_end * change1 / below
    return SLIPPING


@njit(cache=True, nogil=True)
def march_period(  # type: ignore[no-untyped-def]  # pragma: no cover
    motion,
    contact_motion,
    contact_force,
    load_response,
    state_response,
    force_response,
    contact_load_response,
    contact_state_response,
    contact_compliance,
    old_force_weight,
    acceleration_weights,
    stuck_springs,
    friction,
    preload,
    at_rest,
    tolerance,
    max_iterations,
    motion_history,
    force_history,
):
    """March one period of the generalised-alpha scheme; all arrays are described in ``scheme.Scheme``.

    ``motion`` (3 n,) = displacement, velocity, acceleration; ``contact_motion`` (n_pairs, 3) and ``contact_force``
    (n_pairs, 3) = T1, T2, N are updated in place, ``at_rest`` (n_pairs, 3) is the part in equilibrium with the static
    state; the histories receive the start of each step. Returns -1, or the number of the step whose iteration did not
    converge.
    """
    n_steps, n = load_response.shape
    n_pairs = friction.shape[0]
    size = 3 * n_pairs
    trial_force = np.empty((n_pairs, 3))
    tangents = np.empty((n_pairs, 3, 3))
    deviation_tangent = np.zeros((n_pairs, 3, 3))
    step = np.empty(3)
    weighted_old_force = np.empty(size)
    deviation = np.empty(size)
    relative = np.empty(size)
    residual = np.empty(size)
    active = np.empty(n_pairs, np.int64)
    normal_start = np.empty(n_pairs)
    largest = 0.0
    for pair in range(n_pairs):
        largest = max(largest, abs(preload[pair]))

    for index in range(n_steps):
        motion_history[index] = motion[: 2 * n]
        force_history[index] = contact_force
        for pair in range(n_pairs):
            for axis in range(3):
                old_force = contact_force[pair, axis] - at_rest[pair, axis]
                weighted_old_force[3 * pair + axis] = old_force_weight * old_force
            normal_start[pair] = preload[pair] + stuck_springs[3 * pair + 2] * contact_motion[pair, 2]
        linear = (
            contact_load_response[index] + contact_state_response @ motion - contact_compliance @ weighted_old_force
        )
        for row in range(size):
            # Start of the iteration: the deviation from stuck springs stays that of the last step.
            pair, axis = row // 3, row % 3
            force_now = contact_force[pair, axis] - at_rest[pair, axis]
            deviation[row] = force_now - stuck_springs[row] * contact_motion[pair, axis]
        relative[:] = linear - contact_compliance @ deviation

        converged = False
        for _ in range(max_iterations):
            n_active = 0
            for pair in range(n_pairs):
                for axis in range(3):
                    step[axis] = relative[3 * pair + axis] - contact_motion[pair, axis]
                kind = step_law(
                    step,
                    contact_force[pair],
                    normal_start[pair],
                    stuck_springs[3 * pair],
                    stuck_springs[3 * pair + 2],
                    friction[pair],
                    trial_force[pair],
                    tangents[pair],
                )
                for axis in range(3):
                    row = 3 * pair + axis
                    force_now = trial_force[pair, axis] - at_rest[pair, axis]
                    deviation[row] = force_now - stuck_springs[row] * relative[row]
                    for other in range(3):
                        spring = stuck_springs[row] if axis == other else 0.0
                        deviation_tangent[pair, axis, other] = tangents[pair, axis, other] - spring
                if kind != STUCK or normal_start[pair] <= 0.0:
                    active[n_active] = pair
                    n_active += 1
            residual[:] = relative - linear + contact_compliance @ deviation
            worst = 0.0
            for row in range(size):
                worst = max(worst, stuck_springs[row] * abs(residual[row]))
                largest = max(largest, stuck_springs[row] * abs(relative[row]))
            if worst <= tolerance * largest:
                converged = True
                break
            # Newton: (1 + A D) change = -residual, where D has columns for the pairs that are not stuck only.
            spread = np.zeros((size, 3 * n_active))
            for i in range(n_active):
                for axis in range(3):
                    for row in range(size):
                        total = 0.0
                        for other in range(3):
                            total += (
                                contact_compliance[row, 3 * active[i] + other]
                                * deviation_tangent[active[i], other, axis]
                            )
                        spread[row, 3 * i + axis] = total
            if n_active > 0:
                small = np.eye(3 * n_active)
                right = np.empty(3 * n_active)
                for i in range(n_active):
                    for axis in range(3):
                        right[3 * i + axis] = -residual[3 * active[i] + axis]
                        small[3 * i + axis] += spread[3 * active[i] + axis]
                relative -= residual + spread @ np.linalg.solve(small, right)
            else:
                relative -= residual
        if not converged:
            return index

        full_force = weighted_old_force + deviation
        displacement = load_response[index] + state_response @ motion - force_response @ full_force
        velocity_old = motion[n : 2 * n].copy()
        acceleration_old = motion[2 * n :].copy()
        change = displacement - motion[:n]
        acceleration = (
            acceleration_weights[0] * change
            + acceleration_weights[1] * velocity_old
            + acceleration_weights[2] * acceleration_old
        )
        motion[:n] = displacement
        motion[n : 2 * n] = (
            velocity_old + acceleration_weights[3] * acceleration_old + acceleration_weights[4] * acceleration
        )
        motion[2 * n :] = acceleration
        for pair in range(n_pairs):
            for axis in range(3):
                contact_motion[pair, axis] = relative[3 * pair + axis]
                contact_force[pair, axis] = trial_force[pair, axis]
    return -1
