"""The generalised-alpha scheme (Chung and Hulbert, J. Appl. Mech. 60, 1993) with the contacts condensed out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray
from stickslip.structure.superelement import Superelement


@dataclass(frozen=True)
class Scheme:
    """Constant matrices of one step ``u_1 = load + state_response [u_0, v_0, a_0] - force_response f``.

    ``f`` is the deviation of the contact force from stuck springs at the end of the step plus ``old_force_weight``
    times the contact force (less preload) at its start. The stuck springs are in the factored matrix, so that a stuck
    pair costs nothing. The ``contact_`` arrays are ``B`` times the others.
    """

    load_response: FloatArray  # (n_steps, n), for each step of the period
    state_response: FloatArray  # (n, 3 n)
    force_response: FloatArray  # (n, 3 n_pairs)
    contact_load_response: FloatArray  # (n_steps, 3 n_pairs)
    contact_state_response: FloatArray  # (3 n_pairs, 3 n)
    contact_compliance: FloatArray  # (3 n_pairs, 3 n_pairs)
    old_force_weight: float
    acceleration_weights: FloatArray  # (5,), see march_period


def generalised_alpha(
    superelement: Superelement, pairs: ContactPairs, load: FloatArray, time_step: float, spectral_radius: float
) -> Scheme:
    """Factor the effective matrix once. ``load`` (n_steps, n) N at the start of each step of one period."""
    mass, stiffness, operator = superelement.mass, superelement.stiffness, pairs.operator
    damping = superelement.velocity_matrix
    alpha_mass = (2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0)
    alpha_force = spectral_radius / (spectral_radius + 1.0)
    gamma = 0.5 - alpha_mass + alpha_force
    beta = 0.25 * (1.0 - alpha_mass + alpha_force) ** 2
    # a_1 = w0 (u_1 - u_0) + w1 v_0 + w2 a_0   and   v_1 = v_0 + w3 a_0 + w4 a_1
    w0, w1, w2 = 1.0 / (beta * time_step**2), -1.0 / (beta * time_step), 1.0 - 0.5 / beta
    w3, w4 = time_step * (1.0 - gamma), time_step * gamma
    mass_weight, old = (1.0 - alpha_mass) / (1.0 - alpha_force), alpha_force / (1.0 - alpha_force)

    springs = pairs.stuck_stiffness()
    effective = stiffness + w4 * w0 * damping + mass_weight * w0 * mass + operator.T @ (springs[:, None] * operator)
    from_displacement = -old * stiffness + mass_weight * w0 * mass + w4 * w0 * damping
    from_velocity = -mass_weight * w1 * mass - (old + 1.0 + w4 * w1) * damping
    from_acceleration = -(mass_weight * w2 + alpha_mass / (1.0 - alpha_force)) * mass - (w3 + w4 * w2) * damping
    solve = _solver(effective, is_symmetric=superelement.gyroscopic is None)
    state_response = solve(np.hstack([from_displacement, from_velocity, from_acceleration]))
    force_response = solve(operator.T)
    load_response = solve((np.roll(load, -1, axis=0) + old * load).T).T
    return Scheme(
        load_response=np.ascontiguousarray(load_response),
        state_response=np.ascontiguousarray(state_response),
        force_response=np.ascontiguousarray(force_response),
        contact_load_response=np.ascontiguousarray(load_response @ operator.T),
        contact_state_response=np.ascontiguousarray(operator @ state_response),
        contact_compliance=np.ascontiguousarray(operator @ force_response),
        old_force_weight=old,
        acceleration_weights=np.array([w0, w1, w2, w3, w4]),
    )


def _solver(matrix: FloatArray, is_symmetric: bool) -> Callable[[FloatArray], FloatArray]:
    """The solution of a system with the matrix, which is positive definite but for Coriolis forces."""
    if is_symmetric:
        factor = scipy.linalg.cho_factor(matrix)
        return lambda right: np.asarray(scipy.linalg.cho_solve(factor, right))
    general = scipy.linalg.lu_factor(matrix)
    return lambda right: np.asarray(scipy.linalg.lu_solve(general, right))
