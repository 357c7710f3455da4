"""One load step of a joint with friction as a problem of Newton's method.

With the springs of all pairs in ``Kbar = K + B^T k B`` the unknowns are the relative displacements ``x``:

    R(x) = x - load B Kbar^-1 F + A (f(x) - k x) = 0,   A = B Kbar^-1 B^T,

so open pairs may leave ``K`` nearly singular (a free damper): ``Kbar`` is not. The derivative of the law is exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_step import friction_step
from stickslip.contact.law.law import CodeArray, ContactState
from stickslip.contact.law.normal_law import NormalLaw
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.compliance import MEAN_RESTRAINT, StaticFactor
from stickslip.solve.path.problem import NO_PARAMETERS, Plane, Step
from stickslip.structure.superelement import Superelement

# chosen: a step longer than this multiple of the bonded solution and the gaps is a body without support.
LARGEST_STEP = 1e6


@dataclass(frozen=True)
class RestingJoint:
    """A joint with constant stiffness under a static load, and the response of its structure.

    ``gap`` (n_pairs,) m is negative for an interference. Without ``friction`` the pairs slide freely.
    """

    superelement: Superelement
    pairs: ContactPairs
    load: FloatArray  # (n,) N
    law: NormalLaw
    gap: FloatArray
    friction: bool
    springs: FloatArray  # (n_pairs, 3) N/m
    factor: StaticFactor
    compliance: FloatArray  # (3 n_pairs, 3 n_pairs) m/N
    bonded: FloatArray  # (3 n_pairs,) m, relative displacement with every pair bonded

    @classmethod
    def build(
        cls,
        superelement: Superelement,
        pairs: ContactPairs,
        load: FloatArray,
        law: NormalLaw,
        gap: FloatArray,
        friction: bool,
    ) -> RestingJoint:
        """The joint of a structure. Raises InputError where it is singular with all pairs bonded."""
        springs = pairs.stuck_stiffness().reshape(-1, 3)
        factor = StaticFactor.build(superelement, pairs, springs)
        compliance = pairs.operator @ factor.solve(pairs.operator.T)
        bonded = pairs.operator @ factor.solve(load)
        return cls(superelement, pairs, load, law, gap, friction, springs, factor, compliance, bonded)


@dataclass(frozen=True)
class History:
    """A converged state on the ramp, the start of the next step."""

    relative: FloatArray  # (n_pairs, 3) m
    traction: FloatArray  # (n_pairs, 2) N
    limit: FloatArray  # (n_pairs,) N, negative in a gap


@dataclass(frozen=True)
class StaticPoint:
    """A trial at the end of a load step."""

    unknowns: FloatArray  # (n_pairs, 3) m, relative displacements
    code: CodeArray
    force: FloatArray  # (n_pairs, 3) N
    derivative: FloatArray  # (n_pairs, 3, 3) N/m
    residual: FloatArray  # (n_pairs, 3) m
    error: float  # norm of the residual over that of the bonded solution and of the gaps

    @property
    def parameters(self) -> FloatArray:
        """No parameter is free."""
        return NO_PARAMETERS

    @property
    def conditions(self) -> FloatArray:
        """No conditions."""
        return NO_PARAMETERS

    @property
    def measured(self) -> FloatArray:
        """(n_pairs, 3) m."""
        return self.unknowns


class LoadStep:
    """The step from ``history`` to a fraction ``load`` of the static load.

    Without friction, the restraint of a body carries no force at the position ``slider_rest`` (n_pairs, 2) m.
    ``damping`` ties the solution to ``centre`` with that fraction of the springs, for an approach in small steps.
    """

    def __init__(
        self,
        joint: RestingJoint,
        history: History,
        load: float,
        slider_rest: FloatArray,
        damping: float = 0.0,
        centre: FloatArray | None = None,
    ) -> None:
        self._joint, self._history, self._load, self._slider_rest = joint, history, load, slider_rest
        self._damping, self._centre = damping, centre

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray = NO_PARAMETERS) -> StaticPoint:
        """Contact forces and residual."""
        joint, history, relative = self._joint, self._history, unknowns
        tangential, friction = joint.springs[:, :2], joint.pairs.friction_coefficient
        normal, slope = joint.law.force(relative[:, 2] - joint.gap)
        force, derivative = np.empty_like(relative), np.zeros((len(relative), 3, 3))
        if joint.friction:
            limit_slope = friction * slope
            pull = tangential * (relative[:, :2] - history.relative[:, :2])
            step = friction_step(history.traction, history.limit, pull, friction * normal)
            code, force[:, :2] = step.code, step.traction
            derivative[:, :2, :2] = step.by_pull * tangential[:, None, :]
            derivative[:, :2, 2] = step.by_limit * limit_slope[:, None]
        else:
            # A body that only friction would support has the restraint of the mean position, as in dynamics.
            code = np.where(normal > 0.0, ContactState.STICK_SLIP, ContactState.SEPARATING).astype(np.int8)
            force[:, :2] = MEAN_RESTRAINT * tangential * (relative[:, :2] - self._slider_rest)
            derivative[:, [0, 1], [0, 1]] = MEAN_RESTRAINT * tangential
        closed = normal > 0.0
        force[:, 2] = np.where(closed, normal, 0.0)
        derivative[:, 2, 2] = np.where(closed, slope, 0.0)
        total = force
        if self._centre is not None:
            total = force + self._damping * joint.springs * (relative - self._centre)
            derivative[:, [0, 1, 2], [0, 1, 2]] += self._damping * joint.springs
        deviation = (total - joint.springs * relative).ravel()
        residual = relative.ravel() - self._load * joint.bonded + joint.compliance @ deviation
        error = float(np.linalg.norm(residual)) / self.scale
        return StaticPoint(relative, code, force, derivative, residual.reshape(-1, 3), error)

    @property
    def scale(self) -> float:
        """Size of the displacements, m, of the bonded solution and the gaps.

        Not of the solution itself: a body without support would make any residual look small.
        """
        joint = self._joint
        return self._load * float(np.linalg.norm(joint.bonded)) + float(np.linalg.norm(joint.gap)) + 1e-300

    def linearised(self, point: StaticPoint, plane: Plane | None) -> _StepSystem:
        """The Newton equations; there is no parameter, so there is no plane."""
        return _StepSystem(self._joint, point, LARGEST_STEP * self.scale)

    def measured_change(self, point: StaticPoint, step: Step) -> FloatArray:
        """(n_pairs, 3) m."""
        return step.unknowns

    def determined(self, unknowns: FloatArray) -> FloatArray:
        """All of the relative displacements."""
        return unknowns.copy()

    def named(self, parameter: float) -> str:
        """The fraction of the load in words."""
        return f"{100.0 * parameter:.4g} % of the static load"


class _StepSystem:
    """``(I + A D) dx = -R`` on the pairs where D, the deviation from the springs, is not zero."""

    def __init__(self, joint: RestingJoint, point: StaticPoint, largest_step: float) -> None:
        self._joint, self._point, self._largest_step = joint, point, largest_step

    def solve(self, residual: FloatArray, conditions: FloatArray, plane: float, tolerance: float) -> Step:
        """The step; not finite where the equations are singular or a body has no support."""
        joint, right = self._joint, residual.ravel()
        n_pairs = len(residual)
        change = self._point.derivative.copy()
        change[:, [0, 1, 2], [0, 1, 2]] -= joint.springs
        moving = np.flatnonzero(change.any(axis=(1, 2)))
        rows = (3 * moving[:, None] + np.arange(3)).ravel()
        compliance = joint.compliance[:, rows].reshape(3 * n_pairs, moving.size, 3)
        product = np.einsum("mpa,pab->mpb", compliance, change[moving]).reshape(3 * n_pairs, rows.size)
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
