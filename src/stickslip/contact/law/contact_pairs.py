"""The joint as the solver sees it: an operator to relative displacements, and the constants of each contact pair."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike, NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, per_pair, require_positive


@dataclass(frozen=True)
class ContactPairs:
    """Contact pairs with 3-D Coulomb friction, variable normal load and separation.

    Relative displacement ``x = operator @ u`` (t1, t2, n of each pair; n > 0 closes). The force on the left-hand side
    of the equation of motion is ``operator.T @ f`` with ``f = (T1, T2, N - max(preload, 0))`` and
    ``N = max(preload + normal_stiffness * n, 0)``, ``|T| <= friction_coefficient * N``: displacements count from the
    state at rest, where a positive preload is balanced and a gap carries nothing.

    Parameters
    ----------
    operator:
        (3 * n_pairs, n), rows t1, t2, n of pair 0, then of pair 1, ...
    normal_stiffness:
        (n_pairs,) N/m, above zero; a number serves for all pairs.
    tangential_stiffness:
        (n_pairs,) N/m, above zero, or (n_pairs, 2) for different stiffness along t1 and t2.
    friction_coefficient:
        (n_pairs,), above zero.
    preload:
        (n_pairs,) N at rest; a negative value is an initial gap of ``-preload / normal_stiffness``.
    residual_traction:
        None ("released"): the slider of a pair starts each period at the mean of its motion, so what friction held at
        rest is forgotten. Or (n_pairs, 2) N along t1, t2 ("kept"): the traction that friction holds at rest, which the
        structure's static state balances; a pair that never slips keeps it. It must not exceed ``mu * preload``.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, zero stiffness, a friction coefficient that is not positive, or
        a residual traction beyond the friction limit.
    """

    operator: FloatArray
    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    friction_coefficient: FloatArray
    preload: FloatArray
    residual_traction: FloatArray | None

    def __init__(
        self,
        operator: Any,
        normal_stiffness: ArrayLike,
        tangential_stiffness: ArrayLike,
        friction_coefficient: ArrayLike,
        preload: ArrayLike,
        residual_traction: ArrayLike | None = None,
    ) -> None:
        matrix = finite_array("operator", operator.toarray() if scipy.sparse.issparse(operator) else operator)
        if matrix.ndim != 2 or matrix.shape[0] % 3 or matrix.shape[0] == 0:
            raise InputError(
                f"operator must have shape (3 * n_pairs, n): rows t1, t2, n for each pair; found shape {matrix.shape}."
            )
        n_pairs = matrix.shape[0] // 3
        tangential = finite_array("tangential_stiffness", tangential_stiffness)
        if tangential.shape != (n_pairs, 2):
            tangential = per_pair("tangential_stiffness", tangential, n_pairs)
        normal = per_pair("normal_stiffness", normal_stiffness, n_pairs)
        friction = per_pair("friction_coefficient", friction_coefficient, n_pairs)
        advice = (
            "A pair without stiffness carries no contact: leave it out of the operator, or check the roughness and the "
            "load that gave the stiffness."
        )
        require_positive("normal_stiffness", normal, advice)
        require_positive("tangential_stiffness", tangential, advice)
        require_positive("friction_coefficient", friction, "Dry metal joints lie between 0.1 and 0.8.")
        object.__setattr__(self, "operator", matrix)
        object.__setattr__(self, "normal_stiffness", normal)
        object.__setattr__(self, "tangential_stiffness", tangential)
        object.__setattr__(self, "friction_coefficient", friction)
        object.__setattr__(self, "preload", per_pair("preload", preload, n_pairs))
        kept = None if residual_traction is None else self._admissible(residual_traction)
        object.__setattr__(self, "residual_traction", kept)

    def _admissible(self, traction: ArrayLike) -> FloatArray:
        """A residual traction (n_pairs, 2), cut to the limit where it is above it by round-off alone."""
        kept = finite_array("residual_traction", traction)
        if kept.shape != (self.n_pairs, 2):
            raise InputError(
                f"residual_traction must have shape ({self.n_pairs}, 2), N along t1 and t2 of each pair; found "
                f"{kept.shape}."
            )
        size, limit = np.hypot(kept[:, 0], kept[:, 1]), self.friction_coefficient * self.static_load
        beyond = np.flatnonzero(size > limit * (1.0 + 1e-6))
        if beyond.size:
            pair = beyond[0]
            raise InputError(
                f"residual_traction[{pair}] is {size[pair]:.4g} N, but friction holds only {limit[pair]:.4g} N at rest "
                f"(friction_coefficient * preload; {beyond.size} of {self.n_pairs} pairs are above). Take it from a "
                "static solution with friction, such as static_preload gives."
            )
        return np.asarray(kept * np.where(size > limit, limit / np.where(size > 0.0, size, 1.0), 1.0)[:, None])

    @property
    def n_pairs(self) -> int:
        """Number of contact pairs."""
        return int(self.normal_stiffness.shape[0])

    @property
    def tangential_springs(self) -> FloatArray:
        """(n_pairs, 2) N/m along t1 and t2, also where one number was given for both."""
        if self.tangential_stiffness.ndim == 2:
            return self.tangential_stiffness
        return np.repeat(self.tangential_stiffness[:, None], 2, axis=1)

    @property
    def released(self) -> bool:
        """True if the sliders start at the mean of the motion, so that no traction at rest is remembered."""
        return self.residual_traction is None

    @property
    def resting_traction(self) -> FloatArray:
        """(n_pairs, 2) N along t1, t2 at rest: the residual traction; zero if released."""
        return np.zeros((self.n_pairs, 2)) if self.residual_traction is None else self.residual_traction

    @property
    def static_load(self) -> FloatArray:
        """(n_pairs,) N: the part of the preload that the structure's static state balances; a gap carries none."""
        return np.maximum(self.preload, 0.0)

    @property
    def closed_at_rest(self) -> NDArray[np.bool_]:
        """(n_pairs,) True where the preload presses the pair together."""
        return self.preload > 0.0

    def stuck_stiffness(self) -> FloatArray:
        """(3 * n_pairs,) N/m: k_t1, k_t2, k_n of each pair, the springs of a closed and stuck contact."""
        return np.column_stack([self.tangential_springs, self.normal_stiffness]).ravel()

    def resting_stiffness(self) -> FloatArray:
        """(3 * n_pairs,) N/m: the springs that small motions about the rest feel; none for a pair open there."""
        return self.stuck_stiffness() * np.repeat(self.closed_at_rest, 3)
