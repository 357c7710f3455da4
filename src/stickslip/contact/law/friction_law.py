"""Common parts of laws with Coulomb friction in two directions under a normal force that varies: constants at rest.

    |T| <= mu N,   T = K (s - w)

A subclass defines the normal force N over the closing of a pair (:mod:`coulomb`: a spring and a gap).
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.contact.law.coulomb_step import CoulombMemory, PressedPairs
from stickslip.contact.law.law import BoolArray, IndexArray, LawStep
from stickslip.contact.law.traction_at_rest import TractionAtRest, traction_of_pairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, per_pair, require_positive

STIFFNESS_ADVICE = (
    "A pair without stiffness carries no load: remove it from the operator, or check the roughness and the load that "
    "determine the stiffness."
)


class FrictionLaw(TractionAtRest):
    """The constants that friction has in each of these laws; a subclass is a frozen dataclass with these fields."""

    per_pair: ClassVar[tuple[str, ...]] = ("normal_stiffness", "friction_coefficient", "normal_load")

    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    friction_coefficient: FloatArray
    normal_load: FloatArray
    update: Update

    def __post_init__(self) -> None:
        n_pairs = int(np.size(self.normal_stiffness))
        for name in self.per_pair:
            object.__setattr__(self, name, per_pair(name, getattr(self, name), n_pairs))
        object.__setattr__(self, "tangential_stiffness", tangential_constant(self.tangential_stiffness, n_pairs))
        require_positive("normal_stiffness", self.normal_stiffness, STIFFNESS_ADVICE)
        require_positive("tangential_stiffness", self.tangential_stiffness, STIFFNESS_ADVICE)
        require_positive("friction_coefficient", self.friction_coefficient, "Dry metal joints have 0.1 to 0.8.")
        self._require_rest()
        if self.residual_traction is not None:
            object.__setattr__(self, "residual_traction", self._admissible(self.residual_traction))

    def subset(self, chosen: BoolArray) -> Self:
        """The law of the pairs of a mask (p,)."""
        names = (*self.per_pair, "tangential_stiffness", "residual_traction")
        arrays = {name: getattr(self, name) for name in names}
        return cast(Self, replace(cast(Any, self), **{n: a if a is None else a[chosen] for n, a in arrays.items()}))

    @abstractmethod
    def _require_rest(self) -> None:
        """Raise InputError for a normal load or gap that the law does not have."""

    @abstractmethod
    def _pressed(self) -> PressedPairs:
        """The pairs whose whole forces a step gives."""

    def _admissible(self, traction: ArrayLike) -> FloatArray:
        """A residual traction (p, 2), reduced to the limit where only round-off exceeds it."""
        residual = traction_of_pairs(traction, self.n_pairs)
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
    def tangential_springs(self) -> FloatArray:
        """(p, 2) N/m along t1 and t2, also if one number is the constant of both."""
        if self.tangential_stiffness.ndim == 2:
            return self.tangential_stiffness
        return np.repeat(self.tangential_stiffness[:, None], 2, axis=1)

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

    def walking(self) -> BoolArray:
        """(p, 3) True along t1 and t2 if tractions are retained: the mean is then that which C cycles have reached."""
        return self.frictional() & (not self.released)

    def walk(self, displacement: FloatArray) -> FloatArray:
        """(p, 2) m, the way of one cycle of a motion (n, p, 3): zero if released."""
        return np.zeros((self.n_pairs, 2)) if self.released else displacement[:, :, :2].mean(axis=0) / CYCLES

    def memory_at_rest(self) -> CoulombMemory:
        """See :class:`stickslip.contact.law.law.ContactLaw`: the traction at rest."""
        return replace(self._pressed().memory_at_rest(), traction=self.resting_traction)

    def step(self, displacement: FloatArray, before: CoulombMemory) -> LawStep:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        whole = self._pressed().step(displacement, before)
        return replace(whole, force=whole.force - np.column_stack([self.resting_traction, self.normal_load]))

    def retaining(self) -> Self:
        """The law with its traction retained; a released one has none at rest."""
        return self._with(residual_traction=self.resting_traction) if self.released else self

    def with_update(self, update: Update) -> Self:
        """The law with another return."""
        return self if update == self.update else self._with(update=update)

    def with_traction(self, traction: FloatArray) -> Self:
        """The law with a residual traction (p, 2) N retained. Raises InputError for one beyond the limit."""
        return self._with(residual_traction=traction)

    def of_members(self, members: IndexArray) -> Self:
        """The law of some of its pairs (k,)."""
        arrays = {name: getattr(self, name) for name in (*self.per_pair, "tangential_stiffness", "residual_traction")}
        return self._with(**{name: value[members] for name, value in arrays.items() if value is not None})

    def _with(self, **constants: Any) -> Self:
        return cast("Self", replace(cast("Any", self), **constants))


def tangential_constant(stiffness: ArrayLike, n_pairs: int) -> FloatArray:
    """Tangential stiffness (p,) or (p, 2) N/m."""
    values = finite_array("tangential_stiffness", stiffness)
    return values if values.shape == (n_pairs, 2) else per_pair("tangential_stiffness", values, n_pairs)
