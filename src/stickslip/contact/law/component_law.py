"""Common parts of laws that act on t1, t2 and n of a pair one by one: sampling, coefficients, defaults."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.law import BoolArray, CodeArray, ContactCycle, ContactState, IndexArray, LawPeriod, LawStep
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.errors import InputError
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.validation import FloatArray, finite_array

# Even number of parts of a step in which the mean slope takes one value each; chosen: a stop then acts to a tenth of a
# step as long as it does.
PARTS_OF_STEP = 10
# t1, t2 and n, along which constants of a law have values.
COMPONENTS = 3


def per_component(name: str, value: ArrayLike, n_pairs: int, count: int = COMPONENTS) -> FloatArray:
    """A constant as (p, count): a number or (p,) applies to all components. Raises InputError for another shape."""
    values = finite_array(name, value)
    if values.ndim <= 1 and values.size in (1, n_pairs):
        values = np.repeat(np.broadcast_to(values, (n_pairs,))[:, None], count, axis=1)
    if values.shape != (n_pairs, count):
        raise InputError(
            f"{name} must be a number, or have shape ({n_pairs},) or ({n_pairs}, {count}), but its shape is "
            f"{values.shape}.",
            (name,),
        )
    return values


def pairs_in(name: str, *values: ArrayLike) -> int:
    """The number of pairs of a law, that is the length of its longest constant. ``name`` is that of the law."""
    lengths = {np.shape(value)[0] for value in values if np.ndim(value)}
    if len(lengths) > 1:
        raise InputError(
            f"the constants of the law {name} are for {sorted(lengths)} pairs; give all for the same number."
        )
    return lengths.pop() if lengths else 1


def require_at_least_zero(name: str, values: FloatArray) -> None:
    """Raise InputError for an entry below zero."""
    if (values < 0.0).any():
        raise InputError(f"the smallest value of {name} is {values.min():g}, but it must be 0 or above.", (name,))


@dataclass(frozen=True)
class ElasticLaw(ABC):
    """A law without memory: the force of each component follows from its own displacement.

    A subclass is a frozen dataclass; it gives :meth:`force_and_slope` and the number of pairs.

    Parameters
    ----------
    rest_displacement:
        displacement of the state at rest from the unloaded one, m: (p, 3) along t1, t2, n; 0 unless given. A static
        load that the pairs carry at rest has displaced them by it. Given by name only.

    Raises
    ------
    InputError
        for a wrong shape or an entry that is not finite.
    """

    name: ClassVar[str]

    rest_displacement: FloatArray = field(default=cast("FloatArray", 0.0), kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "rest_displacement", self._rest)

    @cached_property
    def _rest(self) -> FloatArray:
        """(p, 3) m, also where a subclass checks its own constants alone."""
        return per_component("rest_displacement", self.rest_displacement, self.n_pairs)

    @cached_property
    def _at_rest(self) -> tuple[FloatArray, FloatArray]:
        """(p, 3) N and (p, 3) N/m, whole force and slope at rest."""
        force, slope = self.force_and_slope(self._rest[:, :, None])
        return force[:, :, 0], slope[:, :, 0]

    @property
    @abstractmethod
    def n_pairs(self) -> int:
        """Number p of pairs."""

    @abstractmethod
    def force_and_slope(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Whole force (p, 3, n) N and its derivative (p, 3, n) N/m at displacements (p, 3, n) m.

        Displacements count from the unloaded pair, where there is no force.
        """

    def _from_rest(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force less that at rest and slope at displacements (p, 3, n) from rest."""
        if not self._rest.any():
            return self.force_and_slope(displacement)
        force, slope = self.force_and_slope(self._rest[:, :, None] + displacement)
        return force - self._at_rest[0][:, :, None], slope

    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m: the slopes at rest."""
        return self._at_rest[1]

    @property
    def resting_traction(self) -> FloatArray:
        """(p, 2) N along t1, t2 at rest."""
        return self._at_rest[0][:, :2]

    @property
    def normal_load(self) -> FloatArray:
        """(p,) N along n at rest; zero where no static load has displaced the pairs."""
        return self._at_rest[0][:, 2]

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
        force, slope = self._from_rest(coefficients @ synthesis_matrix(harmonics, samples).T)
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
        force, slope = self.force_and_slope(self._rest[:, :, None] + np.moveaxis(displacement, 0, 2))
        nothing = np.zeros(displacement.shape[1])
        return ContactCycle(
            np.moveaxis(force, 2, 0), displacement[:, :, :2].copy(), self.states_of(slope), nothing, nothing.copy()
        )

    def linear_steps(self, displacement: FloatArray) -> LinearSteps:
        """See :class:`stickslip.contact.law.linear_steps.SteppedLaw`: the mean slope over the two half steps.

        Positions between samples are on straight lines, so that a stop that closes between samples acts in part.
        """
        samples, n_pairs = displacement.shape[:2]
        fraction = (np.arange(PARTS_OF_STEP) + 0.5) / PARTS_OF_STEP
        change = np.roll(displacement, -1, axis=0) - displacement
        between = displacement[:, None] + fraction[:, None, None] * change[:, None]
        path = self._rest[:, :, None] + np.moveaxis(between.reshape(-1, n_pairs, COMPONENTS), 0, 2)
        slope = self.force_and_slope(path)[1].reshape(n_pairs, COMPONENTS, samples, 2, -1).mean(axis=4)
        mean = np.moveaxis(0.5 * (slope[..., 0] + np.roll(slope[..., 1], 1, axis=2)), 2, 0)
        steps = LinearSteps(
            np.zeros((samples, n_pairs, 2, 2)),
            np.zeros((samples, n_pairs, 2, COMPONENTS)),
            np.zeros((samples, n_pairs, 2, COMPONENTS)),
            mean[:, :, 2],
        )
        steps.by_end[:, :, (0, 1), (0, 1)] = mean[:, :, :2]
        return steps

    def memory_at_rest(self) -> Any:
        """None: there is no memory."""
        return None

    def step(self, displacement: FloatArray, before: Any) -> LawStep:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        force, slope = self._from_rest(displacement[:, :, None])
        derivative = np.zeros((len(displacement), COMPONENTS, COMPONENTS))
        derivative[:, range(COMPONENTS), range(COMPONENTS)] = slope[:, :, 0]
        return LawStep(force[:, :, 0], derivative, self.states_of(slope))

    def about(self, displacement: FloatArray, memory: Any) -> Self:
        """See :class:`stickslip.contact.law.law.ContactLaw`; nothing is forgotten, as nothing is remembered.

        Raises InputError for a law whose :meth:`resting_springs` are its own and do not follow the state at rest.
        """
        law = replace(self, rest_displacement=self._rest + displacement)
        if not np.array_equal(law.resting_springs(), law._at_rest[1]):
            raise InputError(
                f"the law {self.name} defines resting_springs, which do not change with a static load. Remove "
                "resting_springs from it: ElasticLaw uses the slope at rest."
            )
        return law
