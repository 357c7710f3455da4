"""The Coulomb law of contact pairs: friction in two directions, variable normal load and separation.

    N = max(N0 + kn (n - gap), 0),   |T| <= mu N,   T = K (s - w)

Periodic states and derivatives: :mod:`stickslip.contact.law.coulomb_harmonics`; theory: docs/theory_friction.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.coulomb_harmonics import Update, contact_cycle, harmonic_force, harmonic_tangent
from stickslip.contact.law.coulomb_kernel import OPEN
from stickslip.contact.law.coulomb_linear import coulomb_linear_steps
from stickslip.contact.law.coulomb_step import CoulombMemory, PressedPairs
from stickslip.contact.law.friction_law import STIFFNESS_ADVICE, FrictionLaw, tangential_constant
from stickslip.contact.law.law import ContactCycle, ContactState, IndexArray, LawPeriod
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.contact.law.normal_law import SpringLaw
from stickslip.core.errors import InputError
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, per_pair, require_positive, set_fields


@dataclass(frozen=True)
class CoulombLaw(FrictionLaw):
    """Contact pairs with 3-D Coulomb friction, variable normal load and separation.

    Parameters
    ----------
    normal_stiffness:
        (p,) N/m, above zero, for each pair. The others may be numbers, for all pairs.
    tangential_stiffness:
        (p,) N/m, above zero, or (p, 2) for different stiffness along t1 and t2.
    friction_coefficient:
        (p,), above zero.
    normal_load:
        (p,) N at rest, not negative.
    gap:
        (p,) m at rest, not negative; zero where a normal load presses.
    residual_traction:
        None (released): the slider of a pair starts each period at the mean of its motion, so the traction at rest has
        no effect. Or (p, 2) N along t1, t2 (retained): the traction of friction at rest, in equilibrium with the static
        state of the structure; it stays in a pair that never slips. At most ``mu * normal_load``.
    update:
        "tractrix" (second order) or "radial" return.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, zero stiffness, a friction coefficient that is not positive, a
        gap under a normal load, or a residual traction beyond the friction limit.
    """

    name: ClassVar[str] = "coulomb"
    per_pair: ClassVar[tuple[str, ...]] = (*FrictionLaw.per_pair, "gap")
    states: ClassVar[Mapping[ContactState, str]] = {state: state.label for state in ContactState}

    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    friction_coefficient: FloatArray
    normal_load: FloatArray
    gap: FloatArray
    residual_traction: FloatArray | None = None
    update: Update = "tractrix"

    __repr__ = short_repr

    def __init__(
        self,
        normal_stiffness: ArrayLike,
        tangential_stiffness: ArrayLike,
        friction_coefficient: ArrayLike,
        normal_load: ArrayLike,
        gap: ArrayLike,
        residual_traction: ArrayLike | None = None,
        update: Update = "tractrix",
    ) -> None:
        set_fields(
            self,
            normal_stiffness=normal_stiffness,
            tangential_stiffness=tangential_stiffness,
            friction_coefficient=friction_coefficient,
            normal_load=normal_load,
            gap=gap,
            residual_traction=residual_traction,
            update=update,
        )
        self.__post_init__()

    @classmethod
    def with_preload(
        cls,
        n_pairs: int,
        normal_stiffness: ArrayLike,
        tangential_stiffness: ArrayLike,
        friction_coefficient: ArrayLike,
        preload: ArrayLike,
    ) -> CoulombLaw:
        """The law of ``n_pairs`` pairs from numbers or arrays, with a ``preload`` (n_pairs,) N below zero for a gap.

        A negative preload is a gap of ``-preload / normal_stiffness``.
        """
        normal = per_pair("normal_stiffness", normal_stiffness, n_pairs)
        require_positive("normal_stiffness", normal, STIFFNESS_ADVICE)
        force = per_pair("preload", preload, n_pairs)
        return cls(
            normal,
            tangential_constant(tangential_stiffness, n_pairs),
            per_pair("friction_coefficient", friction_coefficient, n_pairs),
            np.maximum(force, 0.0),
            np.maximum(-force, 0.0) / normal,
        )

    def _require_rest(self) -> None:
        """Raise InputError for a gap or a normal load below zero, or for both at one pair."""
        for name, unit in (("normal_load", "N"), ("gap", "m")):
            values = getattr(self, name)
            wrong = np.flatnonzero(values < 0.0)
            if wrong.size:
                raise InputError(
                    f"{name}[{wrong[0]}] is {values[wrong[0]]:g} {unit}, but it must be 0 or above.", (name,)
                )
        both = np.flatnonzero((self.normal_load > 0.0) & (self.gap > 0.0))
        if both.size:
            raise InputError(
                f"pair {both[0]} has a normal load of {self.normal_load[both[0]]:g} N and a gap of "
                f"{self.gap[both[0]]:g} m at rest; give one of the two.",
                ("normal_load", "gap"),
            )

    @cached_property
    def offset_force(self) -> FloatArray:
        """(p,) N, the normal force at ``n = 0`` with its sign: the load, or minus the force that closes the gap."""
        return np.where(self.gap > 0.0, -self.normal_stiffness * self.gap, self.normal_load)

    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m: those of a stuck pair, zero for a pair that is open at rest."""
        return self.stuck_springs() * self.closed_at_rest[:, None]

    def period(self, coefficients: FloatArray, samples: int) -> LawPeriod:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        contact = harmonic_force(coefficients, self, samples, self.update)
        moves = np.empty((self.n_pairs, 3), dtype=np.bool_)
        moves[:] = contact.deviates[:, None]
        moves[:, 2] &= (contact.state == OPEN) | self.open_at_rest
        return LawPeriod(contact.force, moves, contact.state, contact.closure, contact.period_start)

    def tangent(self, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod) -> FloatArray:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        return harmonic_tangent(coefficients, self, samples, select, self.update, period.memory)

    def hidden_springs(self, period: LawPeriod) -> FloatArray:
        """(p, 3) N/m of pairs with a gap that close."""
        closing = period.moves[:, 0] & self.open_at_rest
        return self.stuck_springs() * closing[:, None] if closing.any() else np.zeros((self.n_pairs, 3))

    def cycle(self, displacement: FloatArray) -> ContactCycle:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        return contact_cycle(displacement, self, self.update)

    def linear_steps(self, displacement: FloatArray) -> LinearSteps:
        """See :class:`stickslip.contact.law.linear_steps.SteppedLaw`."""
        traction = self.cycle(displacement).force[:, :, :2]
        return coulomb_linear_steps(
            displacement, self.walk(displacement), traction, self.tangential_springs, self.friction_coefficient,
            self.offset_force + self.normal_stiffness * displacement[:, :, 2],
            np.repeat(self.normal_stiffness[None], len(displacement), axis=0), self.update == "tractrix",
        )  # fmt: skip

    def _pressed(self) -> PressedPairs:
        """The pairs whose whole forces a step gives."""
        closes_at = -self.offset_force / self.normal_stiffness
        tractrix = self.update == "tractrix"
        return PressedPairs(
            self.tangential_springs, self.friction_coefficient, SpringLaw(self.normal_stiffness), closes_at, tractrix
        )

    def about(self, displacement: FloatArray, memory: CoulombMemory | None) -> CoulombLaw:
        """See :class:`stickslip.contact.law.law.ContactLaw`: the normal load or the gap there, and the traction."""
        offset = self.offset_force + self.normal_stiffness * displacement[:, 2]
        return replace(
            self,
            normal_load=np.maximum(offset, 0.0),
            gap=np.maximum(-offset, 0.0) / self.normal_stiffness,
            residual_traction=None if memory is None else memory.traction,
        )
