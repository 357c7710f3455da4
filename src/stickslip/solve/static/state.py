"""The joint at rest under a static load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import CodeArray, ContactState
from stickslip.core.validation import FloatArray


@dataclass(frozen=True)
class StaticState:
    """The joint at rest under a static load.

    Attributes
    ----------
    displacement:
        (n,) m, unknowns of the superelement.
    normal_force, traction:
        (n_pairs,) and (n_pairs, 2) N along t1, t2.
    gap:
        (n_pairs,) m, 0 where closed.
    state:
        (n_pairs,) codes of :class:`stickslip.ContactState`: 0 stuck, 1 slipping (on the friction limit), 2 open;
        without friction all closed pairs are 1, as they are free to slide.
    normal_stiffness, tangential_stiffness:
        (n_pairs,) N/m at rest, for small motions about it.
    residual:
        ``|K u + B^T f - load| / (|load| + |B^T f|)`` with the forces f of this state.
    steps, iterations:
        load steps and Newton iterations of the last ramp.
    message:
        the way to the solution.
    """

    displacement: FloatArray
    normal_force: FloatArray
    traction: FloatArray
    gap: FloatArray
    state: CodeArray
    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    residual: float
    steps: int
    iterations: int
    message: str

    @property
    def preload(self) -> FloatArray:
        """(n_pairs,) N as :class:`ContactPairs` takes it: the normal force, or minus k_n times the gap."""
        return np.where(self.state == ContactState.SEPARATING, -self.normal_stiffness * self.gap, self.normal_force)

    def pairs(self, operator: FloatArray, friction_coefficient: ArrayLike, keep_traction: bool) -> ContactPairs:
        """Contact pairs about this state, with the traction at rest retained or released."""
        return ContactPairs(
            operator,
            self.normal_stiffness,
            self.tangential_stiffness,
            friction_coefficient,
            self.preload,
            self.traction if keep_traction else None,
        )
