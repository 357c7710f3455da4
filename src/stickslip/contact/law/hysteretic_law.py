"""Common parts of hysteretic laws that act along t1 and along t2 one by one, with a normal spring that never opens."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, ClassVar, Self, cast

import numpy as np

from stickslip.contact.law.law import BoolArray, CodeArray, ContactCycle, ContactState, IndexArray, LawPeriod, LawStep
from stickslip.contact.law.traction_at_rest import TractionAtRest
from stickslip.core.errors import InputError
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, per_pair


@lru_cache(maxsize=32)
def _bases(harmonics: int, samples: int) -> tuple[FloatArray, FloatArray]:
    """Synthesis (n, width) and analysis (width, n)."""
    return np.ascontiguousarray(synthesis_matrix(harmonics, samples)), analysis_matrix(harmonics, samples)


@dataclass(frozen=True)
class TangentialStep:
    """The end of a step along t1 and t2: whole force (p, 2) N, slope (p, 2) N/m, whether it slips (p, 2), memory."""

    force: FloatArray
    slope: FloatArray
    slips: BoolArray
    memory: Any

    __repr__ = short_repr


class HystereticLaw(TractionAtRest):
    """A law whose force along a tangent depends on the path along this tangent alone, not on the mean of the path.

    The force at rest is released: it does not depend on the mean displacement, unless a subclass can retain one
    (:meth:`keeping`, :attr:`resting_traction` and :attr:`released`). A subclass has the constants
    ``tangential_stiffness`` (p, 2) N/m of small motions and ``normal_stiffness`` (p,) N/m.
    """

    name: ClassVar[str]

    tangential_stiffness: FloatArray
    normal_stiffness: FloatArray

    @property
    def n_pairs(self) -> int:
        """Number p of pairs."""
        return len(self.normal_stiffness)

    @abstractmethod
    def periods(self, paths: FloatArray) -> tuple[FloatArray, BoolArray, BoolArray, FloatArray]:
        """The periodic state on paths (p, 2, n) m.

        Returns the whole force (p, 2, n) N, whether it deviates from the springs (p, 2), whether it slips in the period
        (p, 2), and the dissipated energy (p,) J.
        """

    @abstractmethod
    def path_tangent(self, paths: FloatArray, synthesis: FloatArray, select: IndexArray) -> FloatArray:
        """Derivative (k, 2, n, width) N/m of the force of the pairs ``select`` by the coefficients of its own path."""

    @abstractmethod
    def memory_at_rest(self) -> Any:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""

    @abstractmethod
    def slide(self, displacement: FloatArray, before: Any) -> TangentialStep:
        """The force after a motion to displacements (p, 2) m along t1 and t2 from the memory ``before``."""

    def keeping(self, memory: Any) -> Self:
        """The law about the state with a memory, its traction retained. Raises InputError unless a subclass has it."""
        raise InputError(
            f'the law {self.name} cannot retain a traction at rest ("kept"). Use the state without friction instead '
            '("released").'
        )

    @property
    def normal_load(self) -> FloatArray:
        """(p,) N: the joint is bonded along n."""
        return np.zeros(self.n_pairs)

    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m along t1, t2, n."""
        return np.column_stack([self.tangential_stiffness, self.normal_stiffness])

    def period(self, coefficients: FloatArray, samples: int) -> LawPeriod:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        synthesis, analysis = _bases(coefficients.shape[2] // 2, samples)
        paths = coefficients[:, :2] @ synthesis.T
        force, deviates, slips, _ = self.periods(paths)
        answer = self.resting_springs()[:, :, None] * coefficients
        if self.released:
            answer[:, :2, 0] = 0.0
        else:
            force = force - self.resting_traction[:, :, None]
        answer[:, :2] = np.where(deviates[:, :, None], force @ analysis.T, answer[:, :2])
        moves = np.column_stack([deviates, np.zeros(self.n_pairs, dtype=bool)])
        return LawPeriod(answer, moves, _states(slips), np.zeros(self.n_pairs), paths)

    def tangent(self, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod) -> FloatArray:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        synthesis, analysis = _bases(coefficients.shape[2] // 2, samples)
        blocks = analysis @ self.path_tangent(period.memory, synthesis, select)
        width = len(analysis)
        tangent = np.zeros((len(select), 3, width, 3, width))
        for axis in range(2):
            tangent[:, axis, :, axis] = blocks[:, axis]
        tangent[:, 2, range(width), 2, range(width)] = self.normal_stiffness[select, None]
        return tangent

    def hidden_springs(self, period: LawPeriod) -> FloatArray:
        """(p, 3) N/m: zero."""
        return np.zeros((self.n_pairs, 3))

    def cycle(self, displacement: FloatArray) -> ContactCycle:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        paths = np.ascontiguousarray(np.moveaxis(displacement[:, :, :2], 0, 2))
        tangential, _, slips, energy = self.periods(paths)
        force = np.empty_like(displacement)
        force[:, :, :2] = np.moveaxis(tangential, 2, 0)
        force[:, :, 2] = self.normal_load + self.normal_stiffness * displacement[:, :, 2]
        springs = np.where(self.tangential_stiffness > 0.0, self.tangential_stiffness, 1.0)
        slider = displacement[:, :, :2] - force[:, :, :2] / springs
        return ContactCycle(force, slider, _states(slips), energy, np.zeros(self.n_pairs))

    def step(self, displacement: FloatArray, before: Any) -> LawStep:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        tangential = self.slide(displacement[:, :2], before)
        normal = self.normal_stiffness * displacement[:, 2]
        derivative = np.zeros((self.n_pairs, 3, 3))
        derivative[:, range(3), range(3)] = np.column_stack([tangential.slope, self.normal_stiffness])
        force = np.column_stack([tangential.force - self.resting_traction, normal])
        return LawStep(force, derivative, _states(tangential.slips), tangential.memory)

    def about(self, displacement: FloatArray, memory: Any) -> Self:
        """See :class:`stickslip.contact.law.law.ContactLaw`; released it has the same tangential force everywhere."""
        law = self if memory is None else self.keeping(memory)
        return law.with_normal_load(self.normal_load + self.normal_stiffness * displacement[:, 2])

    def with_normal_load(self, force: FloatArray) -> Self:
        """The law with a normal force (p,) N at rest, which nothing but :meth:`cycle` shows; here it is not shown."""
        return self


@dataclass(frozen=True)
class RestingNormalForce:
    """Part of a hysteretic law that shows the force of its normal spring in a loaded state at rest.

    rest_normal_force:
        (p,) N along n at rest, above 0 for pressure; 0 unless given. Given by name only.
    """

    rest_normal_force: FloatArray = field(default=cast("FloatArray", 0.0), kw_only=True)

    def _take_normal_force(self, n_pairs: int) -> None:
        object.__setattr__(self, "rest_normal_force", per_pair("rest_normal_force", self.rest_normal_force, n_pairs))

    @property
    def normal_load(self) -> FloatArray:
        """(p,) N along n at rest."""
        return self.rest_normal_force

    def with_normal_load(self, force: FloatArray) -> Self:
        """The law with a normal force (p,) N at rest."""
        return replace(self, rest_normal_force=force)


def _states(slips: BoolArray) -> CodeArray:
    """(p,) stick-slip where either direction slips."""
    return np.where(slips.any(axis=1), ContactState.STICK_SLIP, ContactState.STUCK).astype(np.int8)
