"""The friction law along one straight step of all pairs: for static loads and time integration, exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.coulomb_kernel import CodeArray, advance, step_jacobian
from stickslip.contact.law.law import LawStep
from stickslip.contact.law.normal_law import NormalLaw
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray


@dataclass(frozen=True)
class StepForces:
    """Friction forces at the end of a step, how it ended, and derivatives.

    Attributes
    ----------
    traction:
        (n_pairs, 2) N.
    code:
        (n_pairs,) 0 stick, 1 slip, 2 open.
    by_pull:
        (n_pairs, 2, 2) derivative by the elastic force ``K ds`` of the step.
    by_limit:
        (n_pairs, 2) derivative by the friction limit at the end.
    """

    traction: FloatArray
    code: CodeArray
    by_pull: FloatArray
    by_limit: FloatArray


def friction_step(
    traction: FloatArray,
    limit: FloatArray,
    pull: FloatArray,
    limit_end: FloatArray,
    ratios: FloatArray,
    tractrix: bool = True,
) -> StepForces:
    """Friction of pairs whose motion and limit change linearly from a given state.

    ``traction`` (n_pairs, 2) and ``limit`` (n_pairs,) N at the start, the limit negative in a gap; ``pull`` (n_pairs,
    2) N is ``k ds``; ``ratios`` (n_pairs, 2) are ``k / k_max`` along t1 and t2. Slip turns the traction along the
    ``tractrix`` where both are equal (docs/theory_friction.md).
    """
    n_pairs = limit.size
    forces = StepForces(
        np.empty((n_pairs, 2)), np.empty(n_pairs, dtype=np.int8), np.empty((n_pairs, 2, 2)), np.empty((n_pairs, 2))
    )
    filled = (forces.traction, forces.code, forces.by_pull, forces.by_limit)
    _step_pairs(traction, limit, pull, limit_end, ratios, tractrix, *filled)
    return forces


@dataclass(frozen=True)
class CoulombMemory:
    """The start of a step of Coulomb pairs."""

    displacement: FloatArray  # (n_pairs, 3) m
    traction: FloatArray  # (n_pairs, 2) N
    limit: FloatArray  # (n_pairs,) N, negative in a gap


@dataclass(frozen=True)
class PressedPairs:
    """Coulomb pairs with any normal law, step by step; their forces are whole ones, the normal load included.

    ``springs`` (n_pairs, 2) N/m along t1 and t2, ``friction`` (n_pairs,), ``gap`` (n_pairs,) m, negative for an
    interference, ``tractrix`` as :func:`friction_step` takes it.
    """

    springs: FloatArray
    friction: FloatArray
    law: NormalLaw
    gap: FloatArray
    tractrix: bool = True

    def memory_at_rest(self) -> CoulombMemory:
        """No displacement and no traction."""
        n_pairs = len(self.gap)
        return CoulombMemory(
            np.zeros((n_pairs, 3)), np.zeros((n_pairs, 2)), self.friction * self.law.force(-self.gap)[0]
        )

    def step(self, displacement: FloatArray, before: CoulombMemory) -> LawStep:
        """See :class:`stickslip.contact.law.law.ContactLaw`; the force is the whole one."""
        normal, slope = self.law.force(displacement[:, 2] - self.gap)
        limit = self.friction * normal
        pull = self.springs * (displacement[:, :2] - before.displacement[:, :2])
        ratios = self.springs / self.springs.max(axis=1)[:, None]
        step = friction_step(before.traction, before.limit, pull, limit, ratios, self.tractrix)
        force, derivative = np.empty_like(displacement), np.zeros((len(displacement), 3, 3))
        force[:, :2] = step.traction
        force[:, 2] = np.where(normal > 0.0, normal, 0.0)
        derivative[:, :2, :2] = step.by_pull * self.springs[:, None, :]
        derivative[:, :2, 2] = step.by_limit * (self.friction * slope)[:, None]
        derivative[:, 2, 2] = np.where(normal > 0.0, slope, 0.0)
        return LawStep(force, derivative, step.code, CoulombMemory(displacement, step.traction, limit))


@njit(cache=True, nogil=True, error_model="numpy")
def _step_pairs(
    traction: FloatArray,
    limit: FloatArray,
    pull: FloatArray,
    limit_end: FloatArray,
    ratios: FloatArray,
    tractrix: bool,
    new_traction: FloatArray,
    codes: CodeArray,
    by_pull: FloatArray,
    by_limit: FloatArray,
) -> None:
    """Fill the last four arrays, pair by pair."""
    jacobian = np.zeros((2, 6))
    for pair in range(limit.shape[0]):
        t1, t2, d1, d2 = traction[pair, 0], traction[pair, 1], pull[pair, 0], pull[pair, 1]
        start, end, ratio1, ratio2 = limit[pair], limit_end[pair], ratios[pair, 0], ratios[pair, 1]
        new1, new2, code = advance(t1, t2, d1, d2, start, end, ratio1, ratio2, tractrix)
        new_traction[pair, 0], new_traction[pair, 1], codes[pair] = new1, new2, code
        step_jacobian(code, t1, t2, d1, d2, start, end, ratio1, ratio2, tractrix, jacobian)
        for row in range(2):
            by_pull[pair, row, 0], by_pull[pair, row, 1] = jacobian[row, 2], jacobian[row, 3]
            by_limit[pair, row] = jacobian[row, 5]
