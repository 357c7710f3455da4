"""The joint at rest under a static load."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.law import CodeArray, ContactLaw, IndexArray
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
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
        (n_pairs,) m of Coulomb pairs, 0 where closed and for other laws.
    state:
        (n_pairs,) codes of :class:`stickslip.ContactState`: 0 stuck, 1 slipping (on the friction limit), 2 open;
        other laws have names of their own for them. Without friction all closed pairs are 1, as they are free to slide.
    normal_stiffness, tangential_stiffness:
        (n_pairs,) N/m at rest, for small motions about it; NaN for the tangential one of other laws than Coulomb.
    residual:
        ``|K u + B^T f - load| / (|load| + |B^T f|)`` with the forces f of this state.
    steps, iterations:
        load steps and Newton iterations of the last ramp.
    message:
        the way to the solution.
    memory:
        memory of each law there; None without friction.
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
    memory: tuple[Any, ...] | None = None

    __repr__ = short_repr

    @property
    def preload(self) -> FloatArray:
        """(n_pairs,) N as :class:`ContactPairs` takes it: the normal force, or minus k_n times the gap."""
        return np.where(self.gap > 0.0, -self.normal_stiffness * self.gap, self.normal_force)

    def pairs(self, operator: FloatArray, friction_coefficient: ArrayLike, keep_traction: bool) -> ContactPairs:
        """Coulomb pairs about this state, with the traction at rest retained or released.

        Raises InputError if pairs follow other laws.
        """
        if np.isnan(self.tangential_stiffness).any():
            raise InputError(
                "some pairs of this static state follow other laws than Coulomb friction; use about(pairs, "
                "keep_traction) for them."
            )
        return ContactPairs(
            operator,
            self.normal_stiffness,
            self.tangential_stiffness,
            friction_coefficient,
            self.preload,
            self.traction if keep_traction else None,
        )

    def about(self, pairs: ContactPairs, keep_traction: bool) -> ContactPairs:
        """The ``pairs`` that :func:`static_preload` loaded, with any laws, about this state.

        Kept: friction starts from the traction that it holds here, and elastic laws from their stretch. Released: the
        same without traction, which needs a state without friction. Raises InputError where state and choice differ.
        """
        if keep_traction and self.memory is None:
            raise InputError(
                "this static state is without friction, so there is no traction to retain. Use static_preload with "
                "friction, or keep_traction=False."
            )
        if not keep_traction and self.traction[pairs.frictional()[:, :2]].any():
            raise InputError(
                "this static state has friction tractions, and without them it is not in equilibrium. Use "
                "static_preload(..., friction=False) to release them, or keep_traction=True."
            )
        relative = (pairs.operator @ self.displacement).reshape(-1, 3)
        memories = self.memory if self.memory is not None and keep_traction else (None,) * len(pairs.laws)
        laws: list[ContactLaw] = []
        for law, members, memory in zip(pairs.laws, pairs.members, memories, strict=True):
            if isinstance(law, CoulombLaw):
                laws.append(self._coulomb(law, members, keep_traction))
            else:
                laws.append(law.about(relative[members], memory))
        return ContactPairs.with_laws(pairs.operator, laws, pairs.members)

    def _coulomb(self, law: CoulombLaw, members: IndexArray, keep_traction: bool) -> CoulombLaw:
        """A Coulomb law with the stiffness, loads and gaps of this state."""
        springs = self.normal_stiffness[members], self.tangential_stiffness[members]
        rest = CoulombLaw.with_preload(len(members), *springs, law.friction_coefficient, self.preload[members])
        return replace(rest, residual_traction=self.traction[members] if keep_traction else None, update=law.update)
