"""Motions by time integration beside a harmonic balance: same structure, joint and force, and guesses for Newton."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import ConvergenceError
from stickslip.core.fourier import analysis_matrix
from stickslip.core.validation import FloatArray
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.unbounded import sliding_shapes
from stickslip.solve.transient.integrate import TransientResponse, integrate_to_steady_state
from stickslip.structure.superelement import Superelement


@dataclass(frozen=True)
class MotionInTime:
    """Time integration of a structure, with its damping, a joint and a force."""

    structure: Superelement
    pairs: ContactPairs
    force: ExcitationForce

    def after(
        self, start: Mapping[str, FloatArray], omega: float, steps: int, periods: int, tolerance: float
    ) -> TransientResponse | None:
        """The motion at a frequency (rad/s) after some periods, or once a period changes by less than a tolerance.

        ``start`` has ``initial_...`` arguments of :func:`integrate_to_steady_state`; without them from rest. None if
        the iteration of a step fails.
        """
        force = self.force.coefficients(omega)
        try:
            return integrate_to_steady_state(
                self.structure,
                self.pairs,
                force[1::2].T,
                force[2::2].T,
                omega / (2.0 * np.pi),
                steps_per_period=steps,
                max_periods=periods,
                tolerance=tolerance,
                initial_displacement=start.get("initial_displacement"),
                initial_velocity=start.get("initial_velocity"),
                initial_slider=start.get("initial_slider"),
                initial_cycle=start.get("initial_cycle"),
            )
        except ConvergenceError:
            return None

    def unknowns(self, motion: TransientResponse, harmonics: int) -> FloatArray:
        """(2H+1, m) the last period as unknowns of the balance; if a body walks their mean is that of many cycles."""
        pairs, steps = self.pairs, len(motion.displacement)
        walking = pairs.walking()
        straight, way = motion.displacement, np.zeros(walking.shape)
        if walking.any():
            walk = np.diff(motion.period_starts[-2:], axis=0).sum(axis=0)
            straight = straight - walk * np.arange(steps)[:, None] / steps
            way = np.where(walking, pairs.way(walk), 0.0)
        unknowns = analysis_matrix(harmonics, steps) @ straight @ pairs.operator.T
        unknowns[0] += way.ravel()
        return np.asarray(unknowns)

    def without_walk(self, displacement: FloatArray) -> FloatArray:
        """Displacements (k, n) without the position of a body that may walk, on which no force depends."""
        if not self.pairs.walking().any():
            return displacement
        matrices = self.structure
        assert matrices.damping is not None  # the balances give it
        free = LinearLimit.of_matrices(matrices.mass, matrices.stiffness, matrices.damping)
        shapes = sliding_shapes(free, self.pairs)
        return np.asarray(displacement - displacement @ matrices.mass @ shapes @ shapes.T)
