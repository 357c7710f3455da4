"""Common parts of laws that act on t1, t2 and n of a pair one by one: sampling, coefficients, defaults."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.law import BoolArray, CodeArray, ContactCycle, ContactState, IndexArray, LawPeriod
from stickslip.core.errors import InputError
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.validation import FloatArray, finite_array

# t1, t2 and n, along which constants of a law have values.
COMPONENTS = 3


def per_component(name: str, value: ArrayLike, n_pairs: int, count: int = COMPONENTS) -> FloatArray:
    """A constant as (p, count): a number or (p,) applies to all components. Raises InputError for another shape."""
    values = finite_array(name, value)
    if values.ndim <= 1 and values.size in (1, n_pairs):
        values = np.repeat(np.broadcast_to(values, (n_pairs,))[:, None], count, axis=1)
    if values.shape != (n_pairs, count):
        raise InputError(
            f"{name} must be a number, or have shape ({n_pairs},) or ({n_pairs}, {count}); found {values.shape}.",
            (name,),
        )
    return values


def pairs_in(name: str, *values: ArrayLike) -> int:
    """The number of pairs of a law, that is the length of its longest constant. ``name`` is that of the law."""
    lengths = {np.shape(value)[0] for value in values if np.ndim(value)}
    if len(lengths) > 1:
        raise InputError(f"the constants of the law {name} are for {sorted(lengths)} pairs; give all for one number.")
    return lengths.pop() if lengths else 1


def require_at_least_zero(name: str, values: FloatArray) -> None:
    """Raise InputError for an entry below zero."""
    if (values < 0.0).any():
        raise InputError(f"{name} is {values.min():g} somewhere, but it must be 0 or above.", (name,))


class ElasticLaw(ABC):
    """A law without memory: the force of each component follows from its own displacement.

    A subclass gives :meth:`force_and_slope` and :meth:`resting_springs`, and the number of pairs.
    """

    @property
    @abstractmethod
    def n_pairs(self) -> int:
        """Number p of pairs."""

    @abstractmethod
    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m."""

    @abstractmethod
    def force_and_slope(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force (p, 3, n) N and its derivative (p, 3, n) N/m at displacements (p, 3, n) m; no force at rest."""

    @property
    def normal_load(self) -> FloatArray:
        """(p,) N: zero, the law needs none."""
        return np.zeros(self.n_pairs)

    @property
    def largest_slip_force(self) -> FloatArray:
        """(p,) N: nothing slips."""
        return np.zeros(self.n_pairs)

    def frictional(self) -> BoolArray:
        """(p, 3) nothing slips."""
        return np.zeros((self.n_pairs, COMPONENTS), dtype=bool)

    def undetermined(self) -> BoolArray:
        """(p, 3) the force depends on every mean."""
        return np.zeros((self.n_pairs, COMPONENTS), dtype=bool)

    def states_of(self, slope: FloatArray) -> CodeArray:
        """(p,) codes of :class:`ContactState` from the slopes (p, 3, n) over a period; stuck unless a subclass says."""
        return np.full(len(slope), ContactState.STUCK, dtype=np.int8)

    def period(self, coefficients: FloatArray, samples: int) -> LawPeriod:
        """See :class:`stickslip.contact.law.law.ContactLaw`; the memory contains the slopes (p, 3, n)."""
        harmonics = coefficients.shape[2] // 2
        force, slope = self.force_and_slope(coefficients @ synthesis_matrix(harmonics, samples).T)
        moves = (slope != self.resting_springs()[:, :, None]).any(axis=2)
        springs = self.resting_springs()[:, :, None] * coefficients
        answer = np.where(moves[:, :, None], force @ analysis_matrix(harmonics, samples).T, springs)
        return LawPeriod(answer, moves, self.states_of(slope), np.zeros(len(force)), slope)

    def tangent(self, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod) -> FloatArray:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        harmonics = coefficients.shape[2] // 2
        synthesis, analysis = synthesis_matrix(harmonics, samples), analysis_matrix(harmonics, samples)
        blocks = np.einsum("pj,kaj,jq->kapq", analysis, period.memory[select], synthesis, optimize=True)
        tangent = np.zeros((len(select), COMPONENTS, len(analysis), COMPONENTS, len(analysis)))
        for axis in range(COMPONENTS):
            tangent[:, axis, :, axis] = blocks[:, axis]
        return tangent

    def hidden_springs(self, period: LawPeriod) -> FloatArray:
        """(p, 3) N/m, excess of the largest slope of the period over the resting spring."""
        return np.asarray(np.maximum(period.memory.max(axis=2) - self.resting_springs(), 0.0))

    def cycle(self, displacement: FloatArray) -> ContactCycle:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        force, slope = self.force_and_slope(np.moveaxis(displacement, 0, 2))
        nothing = np.zeros(displacement.shape[1])
        return ContactCycle(
            np.moveaxis(force, 2, 0), displacement[:, :, :2].copy(), self.states_of(slope), nothing, nothing.copy()
        )
