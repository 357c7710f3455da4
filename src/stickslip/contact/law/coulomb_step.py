"""The friction law along one straight step of all pairs, with exact derivatives, for a static load ramp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.coulomb_kernel import OPEN, SLIP, CodeArray, advance, slip_jacobian, stick_jacobian
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


def friction_step(traction: FloatArray, limit: FloatArray, pull: FloatArray, limit_end: FloatArray) -> StepForces:
    """Friction of pairs whose motion and limit change linearly from a given state (equal stiffness along t1 and t2).

    ``traction`` (n_pairs, 2) and ``limit`` (n_pairs,) N at the start, the limit negative in a gap; ``pull`` (n_pairs,
    2) N is ``k ds``. Slip turns the traction along the tractrix (docs/theory_friction.md).
    """
    n_pairs = limit.size
    forces = StepForces(
        np.empty((n_pairs, 2)), np.empty(n_pairs, dtype=np.int8), np.empty((n_pairs, 2, 2)), np.empty((n_pairs, 2))
    )
    _step_pairs(traction, limit, pull, limit_end, forces.traction, forces.code, forces.by_pull, forces.by_limit)
    return forces


@njit(cache=True, nogil=True, error_model="numpy")
def _step_pairs(
    traction: FloatArray,
    limit: FloatArray,
    pull: FloatArray,
    limit_end: FloatArray,
    new_traction: FloatArray,
    codes: CodeArray,
    by_pull: FloatArray,
    by_limit: FloatArray,
) -> None:
    """Fill the last four arrays, pair by pair."""
    jacobian = np.zeros((2, 6))
    for pair in range(limit.shape[0]):
        t1, t2, d1, d2 = traction[pair, 0], traction[pair, 1], pull[pair, 0], pull[pair, 1]
        start, end = limit[pair], limit_end[pair]
        new1, new2, code = advance(t1, t2, d1, d2, start, end, 1.0, 1.0, True)
        new_traction[pair, 0], new_traction[pair, 1], codes[pair] = new1, new2, code
        if code == OPEN:
            jacobian[:] = 0.0
        elif code == SLIP:
            slip_jacobian(t1, t2, d1, d2, start, end, new1, new2, 1.0, 1.0, True, jacobian)
        else:
            stick_jacobian(d1, d2, start, end, jacobian)
        for row in range(2):
            by_pull[pair, row, 0], by_pull[pair, row, 1] = jacobian[row, 2], jacobian[row, 3]
            by_limit[pair, row] = jacobian[row, 5]
