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
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.contact.law.coulomb_step import CoulombMemory, PressedPairs
from stickslip.contact.law.law import BoolArray, ContactCycle, ContactState, IndexArray, LawPeriod, LawStep
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.contact.law.normal_law import SpringLaw
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, per_pair, require_positive


@dataclass(frozen=True)
class CoulombLaw:
    """Contact pairs with 3-D Coulomb friction, variable normal load and separation.

    Parameters
    ----------
    normal_stiffness:
        (p,) N/m, above zero.
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
    states: ClassVar[Mapping[ContactState, str]] = {state: state.label for state in ContactState}

    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    friction_coefficient: FloatArray
    normal_load: FloatArray
    gap: FloatArray
    residual_traction: FloatArray | None = None
    update: Update = "tractrix"

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
        require_positive("normal_stiffness", normal, _ADVICE)
        force = per_pair("preload", preload, n_pairs)
        return cls(
            normal,
            _tangential(tangential_stiffness, n_pairs),
            per_pair("friction_coefficient", friction_coefficient, n_pairs),
            np.maximum(force, 0.0),
            np.maximum(-force, 0.0) / normal,
        )

    def __post_init__(self) -> None:
        n_pairs = int(np.size(self.normal_stiffness))
        for name in ("normal_stiffness", "friction_coefficient", "normal_load", "gap"):
            object.__setattr__(self, name, per_pair(name, getattr(self, name), n_pairs))
        object.__setattr__(self, "tangential_stiffness", _tangential(self.tangential_stiffness, n_pairs))
        require_positive("normal_stiffness", self.normal_stiffness, _ADVICE)
        require_positive("tangential_stiffness", self.tangential_stiffness, _ADVICE)
        require_positive("friction_coefficient", self.friction_coefficient, "Dry metal joints have 0.1 to 0.8.")
        self._require_rest()
        if self.residual_traction is not None:
            object.__setattr__(self, "residual_traction", self._admissible(self.residual_traction))

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

    def _admissible(self, traction: ArrayLike) -> FloatArray:
        """A residual traction (p, 2), reduced to the limit where only round-off exceeds it."""
        residual = finite_array("residual_traction", traction)
        if residual.shape != (self.n_pairs, 2):
            raise InputError(
                f"residual_traction must have shape ({self.n_pairs}, 2), N along t1 and t2 of each pair, but its shape "
                f"is {residual.shape}.",
                arguments=["residual_traction"],
            )
        size, limit = np.hypot(residual[:, 0], residual[:, 1]), self.largest_slip_force
        beyond = np.flatnonzero(size > limit * (1.0 + 1e-6))
        if beyond.size:
            pair = beyond[0]
            raise InputError(
                f"residual_traction[{pair}] is {size[pair]:.4g} N, but friction carries at most {limit[pair]:.4g} N at "
                f"rest (friction_coefficient * preload; {beyond.size} of {self.n_pairs} pairs are above it). Use the "
                "traction of a static solution with friction, for example of static_preload.",
                arguments=["residual_traction"],
            )
        return np.asarray(residual * np.where(size > limit, limit / np.where(size > 0.0, size, 1.0), 1.0)[:, None])

    @property
    def n_pairs(self) -> int:
        """Number of pairs."""
        return int(self.normal_stiffness.shape[0])

    @property
    def largest_slip_force(self) -> FloatArray:
        """(p,) N, ``mu`` times the normal load at rest."""
        return self.friction_coefficient * self.normal_load

    @cached_property
    def offset_force(self) -> FloatArray:
        """(p,) N, the normal force at ``n = 0`` with its sign: the load, or minus the force that closes the gap."""
        return np.where(self.gap > 0.0, -self.normal_stiffness * self.gap, self.normal_load)

    @cached_property
    def tangential_springs(self) -> FloatArray:
        """(p, 2) N/m along t1 and t2, also if one number is the constant of both."""
        if self.tangential_stiffness.ndim == 2:
            return self.tangential_stiffness
        return np.repeat(self.tangential_stiffness[:, None], 2, axis=1)

    @property
    def released(self) -> bool:
        """True if the sliders start at the mean of the motion, so that a traction at rest has no effect."""
        return self.residual_traction is None

    @property
    def resting_traction(self) -> FloatArray:
        """(p, 2) N along t1, t2 at rest: the residual traction; zero if released."""
        return np.zeros((self.n_pairs, 2)) if self.residual_traction is None else self.residual_traction

    @cached_property
    def closed_at_rest(self) -> BoolArray:
        """(p,) True where a normal load presses the pair together."""
        return np.asarray(self.normal_load > 0.0)

    @cached_property
    def open_at_rest(self) -> BoolArray:
        """(p,) True where no normal load presses the pair together."""
        return ~self.closed_at_rest

    def stuck_springs(self) -> FloatArray:
        """(p, 3) N/m: k_t1, k_t2, k_n of a closed and stuck pair."""
        return np.column_stack([self.tangential_springs, self.normal_stiffness])

    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m: those of a stuck pair, zero for a pair that is open at rest."""
        return self.stuck_springs() * self.closed_at_rest[:, None]

    def frictional(self) -> BoolArray:
        """(p, 3) True along t1 and t2."""
        return np.tile([True, True, False], (self.n_pairs, 1))

    def undetermined(self) -> BoolArray:
        """(p, 3) True along t1 and t2 if released."""
        return self.frictional() & self.released

    def walking(self) -> BoolArray:
        """(p, 3) True along t1 and t2 if tractions are retained: the mean is then that which C cycles have reached."""
        return self.frictional() & (not self.released)

    def retaining(self) -> CoulombLaw:
        """The law with its traction retained; a released one has none at rest."""
        return replace(self, residual_traction=self.resting_traction) if self.released else self

    def with_update(self, update: Update) -> CoulombLaw:
        """The law with another return."""
        return self if update == self.update else replace(self, update=update)

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
        walk = np.zeros((self.n_pairs, 2)) if self.released else displacement[:, :, :2].mean(axis=0) / CYCLES
        return coulomb_linear_steps(
            displacement, walk, traction, self.tangential_springs, self.friction_coefficient, self.normal_stiffness,
            self.offset_force, self.update == "tractrix",
        )  # fmt: skip

    def _pressed(self) -> PressedPairs:
        """The pairs whose whole forces a step gives."""
        closes_at = -self.offset_force / self.normal_stiffness
        tractrix = self.update == "tractrix"
        return PressedPairs(
            self.tangential_springs, self.friction_coefficient, SpringLaw(self.normal_stiffness), closes_at, tractrix
        )

    def memory_at_rest(self) -> CoulombMemory:
        """See :class:`stickslip.contact.law.law.ContactLaw`: the traction at rest."""
        return replace(self._pressed().memory_at_rest(), traction=self.resting_traction)

    def step(self, displacement: FloatArray, before: CoulombMemory) -> LawStep:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        whole = self._pressed().step(displacement, before)
        return replace(whole, force=whole.force - np.column_stack([self.resting_traction, self.normal_load]))

    def about(self, displacement: FloatArray, memory: CoulombMemory | None) -> CoulombLaw:
        """See :class:`stickslip.contact.law.law.ContactLaw`: the normal load or the gap there, and the traction."""
        offset = self.offset_force + self.normal_stiffness * displacement[:, 2]
        return replace(
            self,
            normal_load=np.maximum(offset, 0.0),
            gap=np.maximum(-offset, 0.0) / self.normal_stiffness,
            residual_traction=None if memory is None else memory.traction,
        )


_ADVICE = (
    "A pair without stiffness carries no load: remove it from the operator, or check the roughness and the load that "
    "determine the stiffness."
)


def _tangential(stiffness: ArrayLike, n_pairs: int) -> FloatArray:
    """(p,) or (p, 2) N/m."""
    values = finite_array("tangential_stiffness", stiffness)
    return values if values.shape == (n_pairs, 2) else per_pair("tangential_stiffness", values, n_pairs)
