"""Marches over one period: compiled for Coulomb pairs, whose law is written apart here, and by steps of any laws."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.validation import FloatArray
from stickslip.solve.joint_step import JointStep
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.transient.kernel import march_period
from stickslip.solve.transient.scheme import Scheme

# chosen: a step that needs more iterations has no solution; far below the tolerance from period to period.
MAX_STEP_ITERATIONS = 40
STEP_TOLERANCE = 1e-10
# A law with kinks requires short steps where the full one overshoots.
NEWTON = NewtonSettings(STEP_TOLERANCE, MAX_STEP_ITERATIONS, fractions=(1.0, 0.5, 0.25, 0.1, 0.03))
# A correction this many times larger than any displacement so far is no solution.
LARGEST_CORRECTION = 1e6


class March(Protocol):
    """The contacts of a time integration between its periods."""

    @property
    def force(self) -> FloatArray:
        """(n_pairs, 3) N, less what the state at rest balances."""

    def period(self, motion: FloatArray, motion_history: FloatArray, force_history: FloatArray) -> int:
        """March one period of the scheme.

        ``motion`` (3 n,) = displacement, velocity, acceleration is updated; the histories (n_steps, 2 n) and
        (n_steps, n_pairs, 3), whole forces, receive the start of each step. Returns -1, or the number of the step whose
        iteration did not converge.
        """


class CoulombMarch:
    """Coulomb pairs by the compiled march; ``slider`` (n_pairs, 2) m is where a pair carries no friction."""

    def __init__(self, scheme: Scheme, pairs: ContactPairs, relative: FloatArray, slider: FloatArray) -> None:
        self._scheme, self._pairs = scheme, pairs
        self._relative, self._force = relative, _starting_force(pairs, relative, slider)
        self._offset = force_at_rest(pairs)

    @property
    def force(self) -> FloatArray:
        """(n_pairs, 3) N."""
        return self._force - self._offset

    def period(self, motion: FloatArray, motion_history: FloatArray, force_history: FloatArray) -> int:
        """See :class:`March`."""
        scheme, pairs = self._scheme, self._pairs
        return int(
            march_period(
                motion,
                self._relative,
                self._force,
                scheme.load_response,
                scheme.state_response,
                scheme.force_response,
                scheme.contact_load_response,
                scheme.contact_state_response,
                scheme.contact_compliance,
                scheme.old_force_weight,
                scheme.acceleration_weights,
                pairs.stuck_stiffness(),
                pairs.friction_coefficient,
                pairs.preload,
                self._offset,
                STEP_TOLERANCE,
                MAX_STEP_ITERATIONS,
                motion_history,
                force_history,
            )
        )


class LawMarch:
    """Pairs of any laws, step by step through :meth:`ContactLaw.step`.

    ``cycle`` (n_samples, n_pairs, 3) m, if given, is a period of the relative motion that ends at time 0: the laws go
    through it twice from rest, so that they remember what they do in that periodic state. Means that no force depends
    on count from the mean of the cycle, as in the harmonic balance.
    """

    def __init__(self, scheme: Scheme, pairs: ContactPairs, relative: FloatArray, cycle: FloatArray | None) -> None:
        self._scheme, self._pairs = scheme, pairs
        self._springs = pairs.stuck_stiffness().reshape(-1, 3)
        self._offset = force_at_rest(pairs)
        memory = pairs.memory_at_rest()
        self._origin = np.zeros((pairs.n_pairs, 3))
        if cycle is not None:
            self._origin = np.where(pairs.undetermined(), cycle.mean(axis=0), 0.0)
            for displacement in (*cycle, *cycle):
                memory = pairs.step(displacement - self._origin, memory).memory
        self._relative, self._step = relative, pairs.step(relative - self._origin, memory)
        self._largest = float(np.linalg.norm(relative))

    @property
    def force(self) -> FloatArray:
        """(n_pairs, 3) N."""
        return self._step.force

    def period(self, motion: FloatArray, motion_history: FloatArray, force_history: FloatArray) -> int:
        """See :class:`March`."""
        scheme, n = self._scheme, self._scheme.load_response.shape[1]
        w0, w1, w2, w3, w4 = scheme.acceleration_weights
        for index in range(len(scheme.load_response)):
            motion_history[index], force_history[index] = motion[: 2 * n], self._step.force + self._offset
            old_force = scheme.old_force_weight * self._step.force.ravel()
            linear = scheme.contact_load_response[index] + scheme.contact_state_response @ motion
            linear -= scheme.contact_compliance @ old_force
            if not self._advance(linear):
                return index
            deviation = (self._step.force - self._springs * self._relative).ravel()
            displacement = scheme.load_response[index] + scheme.state_response @ motion
            displacement -= scheme.force_response @ (old_force + deviation)
            velocity, acceleration = motion[n : 2 * n].copy(), motion[2 * n :].copy()
            motion[2 * n :] = w0 * (displacement - motion[:n]) + w1 * velocity + w2 * acceleration
            motion[n : 2 * n] = velocity + w3 * acceleration + w4 * motion[2 * n :]
            motion[:n] = displacement
        return -1

    def _advance(self, linear: FloatArray) -> bool:
        """Solve the contact displacements of a step; whether Newton's method converged."""
        before = self._step.memory
        deviation = (self._step.force - self._springs * self._relative).ravel()
        guess = (linear - self._scheme.contact_compliance @ deviation).reshape(-1, 3)
        self._largest = max(self._largest, float(np.linalg.norm(guess)), 1e-300)
        step = JointStep(
            forces=lambda relative: self._pairs.step(relative - self._origin, before),
            springs=self._springs,
            compliance=self._scheme.contact_compliance,
            linear=linear,
            scale=self._largest,
            largest_step=LARGEST_CORRECTION * self._largest,
        )
        correction = Newton(step, NEWTON).correct(step.evaluate(guess))
        self._relative, self._step = correction.point.unknowns, correction.point.forces
        return correction.converged


def force_at_rest(pairs: ContactPairs) -> FloatArray:
    """(n_pairs, 3) N that the state at rest balances."""
    return np.column_stack([pairs.resting_traction, pairs.normal_load])


def _starting_force(pairs: ContactPairs, contact_motion: FloatArray, slider: FloatArray) -> FloatArray:
    """(n_pairs, 3) T1, T2, N of a pair at ``contact_motion`` (n_pairs, 3): ``T = k_t (s - slider)`` cut to the cone."""
    normal = np.maximum(pairs.preload + pairs.normal_stiffness * contact_motion[:, 2], 0.0)
    traction = pairs.tangential_springs * (contact_motion[:, :2] - slider)
    size = np.hypot(traction[:, 0], traction[:, 1])
    limit = pairs.friction_coefficient * normal
    scale = np.where(size > limit, limit / np.where(size > 0.0, size, 1.0), 1.0)
    return np.column_stack([traction * scale[:, None], normal])
