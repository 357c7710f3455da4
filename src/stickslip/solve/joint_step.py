"""One step of a joint on a structure, condensed to the relative displacements, as a problem of Newton's method.

    R(x) = x - linear + A (f(x) - k x) = 0

``A`` is the answer of the structure with the springs ``k`` of all pairs in it, ``linear`` the displacement that the
load would cause if all pairs stayed on these springs, and ``f`` the contact force after the step. A load step at rest
and a step in time are both of this form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.contact.law.law import CodeArray, LawStep
from stickslip.core.validation import FloatArray
from stickslip.solve.path.problem import NO_PARAMETERS, Plane, Step


@dataclass(frozen=True)
class StepPoint:
    """A trial at the end of a step."""

    unknowns: FloatArray  # (n_pairs, 3) m, relative displacements
    forces: LawStep
    residual: FloatArray  # (n_pairs, 3) m
    error: float  # norm of the residual over the scale of the step

    @property
    def force(self) -> FloatArray:
        """(n_pairs, 3) N."""
        return self.forces.force

    @property
    def code(self) -> CodeArray:
        """(n_pairs,) codes of :class:`stickslip.ContactState`."""
        return self.forces.state

    @property
    def memory(self) -> Any:
        """The memory with which the next step starts."""
        return self.forces.memory

    @property
    def parameters(self) -> FloatArray:
        """None are free."""
        return NO_PARAMETERS

    @property
    def conditions(self) -> FloatArray:
        """There are none."""
        return NO_PARAMETERS

    @property
    def measured(self) -> FloatArray:
        """(n_pairs, 3) m."""
        return self.unknowns


@dataclass(frozen=True)
class JointStep:
    """The equations of one step.

    Parameters
    ----------
    forces:
        contact forces after a step to relative displacements (n_pairs, 3) m.
    springs:
        (n_pairs, 3) N/m, in the structure that ``compliance`` (3 n_pairs, 3 n_pairs) m/N and ``linear`` (3 n_pairs,) m
        answer for.
    scale:
        m, the size of displacements that the error is relative to.
    largest_step:
        m, from which on a correction is a body that flies away.
    tie:
        springs (n_pairs, 3) N/m and the displacements (n_pairs, 3) m to which they tie the solution, for an approach in
        small steps; None for none.
    name:
        of the parameter, for messages.
    """

    forces: Callable[[FloatArray], LawStep]
    springs: FloatArray
    compliance: FloatArray
    linear: FloatArray
    scale: float
    largest_step: float
    tie: tuple[FloatArray, FloatArray] | None = None
    name: str = "the step"

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray = NO_PARAMETERS) -> StepPoint:
        """Contact forces and residual."""
        forces = self.forces(unknowns)
        total = forces.force
        if self.tie is not None:
            stiffness, centre = self.tie
            total = total + stiffness * (unknowns - centre)
        deviation = (total - self.springs * unknowns).ravel()
        residual = unknowns.ravel() - self.linear + self.compliance @ deviation
        error = float(np.linalg.norm(residual)) / self.scale
        return StepPoint(unknowns, forces, residual.reshape(-1, 3), error)

    def linearised(self, point: StepPoint, plane: Plane | None) -> _StepSystem:
        """The Newton equations; there is no parameter, so there is no plane."""
        change = point.forces.derivative.copy()
        springs = self.springs if self.tie is None else self.springs - self.tie[0]
        change[:, [0, 1, 2], [0, 1, 2]] -= springs
        return _StepSystem(self.compliance, change, self.largest_step)

    def measured_change(self, point: StepPoint, step: Step) -> FloatArray:
        """(n_pairs, 3) m."""
        return step.unknowns

    def determined(self, unknowns: FloatArray) -> FloatArray:
        """All of the relative displacements."""
        return unknowns.copy()

    def named(self, parameter: float) -> str:
        """There is no parameter."""
        return self.name


class _StepSystem:
    """``(I + A D) dx = -R`` on the pairs where D, the change from the springs (n_pairs, 3, 3), acts."""

    def __init__(self, compliance: FloatArray, change: FloatArray, largest_step: float) -> None:
        self._compliance, self._change, self._largest_step = compliance, change, largest_step

    def solve(self, residual: FloatArray, conditions: FloatArray, plane: float, tolerance: float) -> Step:
        """The step; not finite where the equations are singular or a body flies away."""
        right, n_pairs = residual.ravel(), len(residual)
        moving = np.flatnonzero(self._change.any(axis=(1, 2)))
        rows = (3 * moving[:, None] + np.arange(3)).ravel()
        compliance = self._compliance[:, rows].reshape(3 * n_pairs, moving.size, 3)
        product = np.einsum("mpa,pab->mpb", compliance, self._change[moving]).reshape(3 * n_pairs, rows.size)
        matrix = product[rows]
        matrix[np.diag_indices(rows.size)] += 1.0
        nowhere = Step(np.full((n_pairs, 3), np.nan), NO_PARAMETERS)
        try:
            solved = np.linalg.solve(matrix, -right[rows])
        except np.linalg.LinAlgError:
            return nowhere
        step = -right - product @ solved
        step[rows] = solved
        if not float(np.abs(step).max()) < self._largest_step:
            return nowhere
        return Step(step.reshape(-1, 3), NO_PARAMETERS)
