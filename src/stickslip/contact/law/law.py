"""The contact law: the force of contact pairs over a period of their relative motion, with its derivative.

A law is an object with the constants of a group of pairs. The harmonic balance takes from it the springs for small
motions, the force over a period, and the derivative of that force. Time integration and static loads take the force
after a step from a given state; pages take the names of its states.
A new law is one file with one class and one entry in ``registry.py``; docs/extending.md shows one from start to end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray

BoolArray = NDArray[np.bool_]
CodeArray = NDArray[np.int8]
IndexArray = NDArray[np.int64]


class ContactState(IntEnum):
    """State of a pair over a period; the codes of every ``contact_state``.

    STUCK (0): closed throughout, without slip. STICK_SLIP (1): closed throughout, with slip in a part of the period.
    SEPARATING (2): open in a part of the period or throughout. A law gives them its own names
    (``ContactLaw.states``).
    """

    STUCK = 0
    STICK_SLIP = 1
    SEPARATING = 2

    @property
    def label(self) -> str:
        """The name in words."""
        return self.name.lower().replace("_", "-")


@dataclass(frozen=True)
class LawPeriod:
    """The force of a group of p pairs over one period, in its periodic state.

    Coefficients are (2H+1) in the order mean, cos 1, sin 1, ...

    Attributes
    ----------
    force:
        (p, 3, 2H+1) N along t1, t2, n, less its value at rest.
    moves:
        (p, 3) False exactly where force and derivative are those of the springs of the law
        (:meth:`ContactLaw.resting_springs`).
    state:
        (p,) codes of :class:`ContactState`.
    closure:
        (p,) relative distance between the start and the end of the period; 0 for a law without memory.
    memory:
        data for :meth:`ContactLaw.tangent`.
    """

    force: FloatArray
    moves: BoolArray
    state: CodeArray
    closure: FloatArray
    memory: Any = None

    __repr__ = short_repr


@dataclass(frozen=True)
class LawStep:
    """The force of a group of p pairs at the end of one quasi-static step.

    Attributes
    ----------
    force:
        (p, 3) N along t1, t2, n, less its value at rest.
    derivative:
        (p, 3, 3) N/m: entry [i, a, b] is that of the force in direction a by the displacement in direction b.
    state:
        (p,) codes of :class:`ContactState` at the end of the step.
    memory:
        what the next step starts from; None for a law without memory.
    """

    force: FloatArray
    derivative: FloatArray
    state: CodeArray
    memory: Any = None

    __repr__ = short_repr


@dataclass(frozen=True)
class ContactCycle:
    """The converged period of contact pairs under an imposed motion.

    Attributes
    ----------
    force:
        (n_samples, n_pairs, 3) N along t1, t2, n; the whole normal force, not that less the preload. A law that is
        bonded along n and knows no normal load at rest counts it from there.
    slider:
        (n_samples, n_pairs, 2) m: slider position w = s - T / k along t1, t2; it follows s while the pair is open, and
        always for a law without a slider.
    state:
        (n_pairs,) codes of :class:`ContactState`.
    dissipated_energy:
        (n_pairs,) J per period, never negative, exactly 0 for a stuck pair.
    closure:
        (n_pairs,) relative distance between the start and the end of the last period.
    """

    force: FloatArray
    slider: FloatArray
    state: CodeArray
    dissipated_energy: FloatArray
    closure: FloatArray

    __repr__ = short_repr


@runtime_checkable
class ContactLaw(Protocol):
    """The law of a group of p pairs; a frozen dataclass whose fields are its constants.

    Displacements are those of a pair, t1, t2, n > 0 closing, m, relative to the state at rest; forces act on the
    left-hand side of the equation of motion. ``name`` is that in a study file; ``states`` maps the states that a pair
    can have to their names in results and on pages.
    """

    name: ClassVar[str]
    states: ClassVar[Mapping[ContactState, str]]  # names for results and pages; states that it can have

    @property
    def n_pairs(self) -> int:
        """Number p of pairs."""

    @property
    def normal_load(self) -> FloatArray:
        """(p,) N, the normal force at rest; zero for a law without normal load."""

    @property
    def largest_slip_force(self) -> FloatArray:
        """(p,) N, the largest tangential force at rest that slip can release; zero for an elastic law."""

    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m, the springs along t1, t2, n that act on small motions about the rest."""

    def frictional(self) -> BoolArray:
        """(p, 3) True for the springs that slip can release, so that they do not reliably support a body."""

    def undetermined(self) -> BoolArray:
        """(p, 3) True for mean displacements that the force does not depend on; their springs carry no mean."""

    def period(self, coefficients: FloatArray, samples: int) -> LawPeriod:
        """The force for displacement coefficients (p, 3, 2H+1), with ``samples`` samples of the period."""

    def tangent(self, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod) -> FloatArray:
        """Derivative (k, 3, 2H+1, 3, 2H+1) N/m of the force of the pairs ``select`` (k,) by the displacement.

        Entry [i, a, p, b, q] is that of coefficient p in direction a by coefficient q in direction b; ``period`` is
        that of the same coefficients.
        """

    def hidden_springs(self, period: LawPeriod) -> FloatArray:
        """(p, 3) N/m that act in this period and are not among the resting springs, such as those of a closed gap."""

    def cycle(self, displacement: FloatArray) -> ContactCycle:
        """The periodic state under a motion (n_samples, p, 3) m."""

    def memory_at_rest(self) -> Any:
        """The memory with which the first step starts: displacements and forces of the state at rest."""

    def step(self, displacement: FloatArray, before: Any) -> LawStep:
        """The force after a straight motion to a displacement (p, 3) m, from the state with the memory ``before``.

        Quasi-static: the force depends on the path, not on its speed. ``before`` does not change.
        """

    def about(self, displacement: FloatArray, memory: Any) -> ContactLaw:
        """The law about another state at rest, at a displacement (p, 3) m with a memory that :meth:`step` gave there.

        Displacements and forces of the new law count from that state. With a memory, friction retains its traction
        there ("kept"); with None the traction has no effect ("released"). Raises InputError if the law has no form for
        such a state.
        """
