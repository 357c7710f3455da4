"""Motions by time integration beside a harmonic balance: same structure, joint and force, and guesses for Newton."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.fourier import analysis_matrix
from stickslip.core.validation import FloatArray
from stickslip.solve.setting_up import Balances
from stickslip.solve.transient.integrate import TransientResponse, integrate_to_steady_state
from stickslip.structure.superelement import Superelement


class MotionInTime:
    """Time integration of the structure, joint and force of ``balances``."""

    def __init__(self, balances: Balances) -> None:
        self._balances = balances

    @cached_property
    def structure(self) -> Superelement:
        """The structure with the damping of the balance."""
        superelement = self._balances.superelement
        return replace(superelement, damping=self._balances.stuck.damping, recovery=None)

    def after(
        self, start: Mapping[str, FloatArray], omega: float, steps: int, periods: int, tolerance: float
    ) -> TransientResponse | None:
        """The motion at a frequency (rad/s) after some periods, or once a period changes by less than a tolerance.

        ``start`` has ``initial_...`` arguments of :func:`integrate_to_steady_state`; without them from rest. None if
        the iteration of a step fails.
        """
        force = self._balances.force.coefficients(omega)
        try:
            return integrate_to_steady_state(
                self.structure,
                self._balances.pairs,
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
        pairs, steps = self._balances.pairs, len(motion.displacement)
        walking = pairs.walking()
        straight, way = motion.displacement, np.zeros(walking.shape)
        if walking.any():
            walk = np.diff(motion.period_starts[-2:], axis=0).sum(axis=0)
            straight = straight - walk * np.arange(steps)[:, None] / steps
            way = np.where(walking, pairs.way(walk), 0.0)
        unknowns = analysis_matrix(harmonics, steps) @ straight @ pairs.operator.T
        unknowns[0] += way.ravel()
        return np.asarray(unknowns)
