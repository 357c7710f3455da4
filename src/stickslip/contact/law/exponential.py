"""Friction under a contact stiffness that follows the momentary pressure: exponential pressure over the gap.

    N = N0 exp(n / lambda),   dN/dn = N / lambda,   |T| <= mu N,   T = K (s - w)

Closed forms, and why K does not follow the pressure: docs/theory_friction.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update, friction_cycle, friction_force, friction_tangent
from stickslip.contact.law.coulomb_linear import coulomb_linear_steps
from stickslip.contact.law.coulomb_step import CoulombMemory, PressedPairs
from stickslip.contact.law.friction_law import FrictionLaw
from stickslip.contact.law.law import (
    CodeArray,
    ContactCycle,
    ContactState,
    IndexArray,
    LawPeriod,
)
from stickslip.contact.law.linear_steps import LinearSteps
from stickslip.core.errors import InputError
from stickslip.core.fourier import analysis_matrix, synthesis_matrix
from stickslip.core.short_repr import short_repr
from stickslip.core.validation import FloatArray, set_fields

# chosen: a pair whose normal force falls below this fraction of that at rest counts as separating. It never opens.
NEARLY_OPEN = 0.01


@dataclass(frozen=True)
class ExponentialNormalLaw:
    """``N = N0 exp(closure / length)``: ``load`` (p,) N at closure 0, ``length`` (p,) m."""

    load: FloatArray
    length: FloatArray

    def force(self, closure: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and stiffness at closures (p,) or (..., p). An iteration that closes far too much gives infinity."""
        with np.errstate(over="ignore"):
            force = self.load * np.exp(closure / self.length)
            return force, force / self.length


@dataclass(frozen=True)
class ExponentialContact(FrictionLaw):
    """Coulomb friction in two directions; the normal stiffness is proportional to the momentary normal force.

    ``N = N0 exp(n / lambda)`` with the length ``lambda = N0 / k_n``, so at rest the stiffness is ``k_n``. A rough face
    has ``K = p / lambda`` in Persson's theory, with ``lambda`` about 0.45 times its rms height (B. N. J. Persson, Phys.
    Rev. Lett. 99 (2007) 125502). The pair never opens completely. Normal force and closing have a potential, and the
    tangential springs ``k_t`` remain those at rest, so all energy that a cycle loses is work of friction.

    Parameters
    ----------
    normal_stiffness:
        (p,) N/m at rest, above zero.
    tangential_stiffness:
        (p,) N/m, above zero, or (p, 2) for different stiffness along t1 and t2.
    friction_coefficient:
        (p,), above zero.
    normal_load:
        (p,) N at rest, above zero.
    residual_traction:
        as in :class:`stickslip.CoulombLaw`.
    update:
        "tractrix" (second order) or "radial" return.

    Raises
    ------
    InputError
        for a wrong shape, an entry that is not finite, zero stiffness, a friction coefficient or a normal load that is
        not positive, or a residual traction beyond the friction limit.
    """

    name: ClassVar[str] = "exponential"
    states: ClassVar[Mapping[ContactState, str]] = {
        ContactState.STUCK: "stuck",
        ContactState.STICK_SLIP: "stick-slip",
        ContactState.SEPARATING: "nearly open",
    }

    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    friction_coefficient: FloatArray
    normal_load: FloatArray
    residual_traction: FloatArray | None = None
    update: Update = "tractrix"

    __repr__ = short_repr

    def __init__(
        self,
        normal_stiffness: ArrayLike,
        tangential_stiffness: ArrayLike,
        friction_coefficient: ArrayLike,
        normal_load: ArrayLike,
        residual_traction: ArrayLike | None = None,
        update: Update = "tractrix",
    ) -> None:
        set_fields(
            self,
            normal_stiffness=normal_stiffness,
            tangential_stiffness=tangential_stiffness,
            friction_coefficient=friction_coefficient,
            normal_load=normal_load,
            residual_traction=residual_traction,
            update=update,
        )
        self.__post_init__()

    def _require_rest(self) -> None:
        unloaded = np.flatnonzero(self.normal_load <= 0.0)
        if unloaded.size:
            raise InputError(
                f"normal_load[{unloaded[0]}] is {self.normal_load[unloaded[0]]:g} N ({unloaded.size} of {self.n_pairs} "
                f'pairs have none), but the law "{self.name}" requires a load above 0 at each pair: its stiffness is '
                'proportional to the load. Use the law "coulomb" for faces with open pairs.',
                ("normal_load",),
            )

    @cached_property
    def length(self) -> FloatArray:
        """(p,) m, closing by which the normal force grows by the factor e."""
        return np.asarray(self.normal_load / self.normal_stiffness)

    @cached_property
    def normal_law(self) -> ExponentialNormalLaw:
        """The normal force over the closing from rest."""
        return ExponentialNormalLaw(self.normal_load, self.length)

    def with_constant_stiffness(self) -> CoulombLaw:
        """The Coulomb law with the loads, springs and tractions at rest."""
        return CoulombLaw(
            self.normal_stiffness,
            self.tangential_stiffness,
            self.friction_coefficient,
            self.normal_load,
            np.zeros(self.n_pairs),
            self.residual_traction,
            self.update,
        )

    def resting_springs(self) -> FloatArray:
        """(p, 3) N/m: those of a stuck pair under its load at rest."""
        return self.stuck_springs()

    def _loads(self, coefficients: FloatArray, samples: int) -> tuple[FloatArray, FloatArray]:
        """Normal force (p, n) N and stiffness (p, n) N/m at the samples."""
        closing = synthesis_matrix(coefficients.shape[2] // 2, samples) @ coefficients[:, 2].T
        force, slope = self.normal_law.force(closing)
        return np.ascontiguousarray(force.T), np.ascontiguousarray(slope.T)

    def _states(self, states: CodeArray, force: FloatArray) -> CodeArray:
        """(p,) codes; ``force`` (p, n) N."""
        nearly_open = force.min(axis=1) < NEARLY_OPEN * self.normal_load
        return np.where(nearly_open, ContactState.SEPARATING, states).astype(np.int8)

    def period(self, coefficients: FloatArray, samples: int) -> LawPeriod:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        load, _ = self._loads(coefficients, samples)
        friction = friction_force(coefficients, self.friction_coefficient[:, None] * load, self, self.update)
        moves = np.column_stack([friction.deviates, friction.deviates, coefficients[:, 2].any(axis=1)])
        analysis = analysis_matrix(coefficients.shape[2] // 2, samples)
        with np.errstate(invalid="ignore"):  # an iteration with an infinite force is no solution
            friction.force[:, 2] = (load - self.normal_load[:, None]) @ analysis.T
        states = self._states(friction.state, load)
        return LawPeriod(friction.force, moves, states, friction.closure, friction.period_start)

    def tangent(self, coefficients: FloatArray, samples: int, select: IndexArray, period: LawPeriod) -> FloatArray:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        harmonics, width = coefficients.shape[2] // 2, coefficients.shape[2]
        load, slope = self._loads(coefficients, samples)
        synthesis, analysis = synthesis_matrix(harmonics, samples), analysis_matrix(harmonics, samples)
        friction = self.friction_coefficient[:, None]
        tangent = np.zeros((len(select), 3, width, 3, width))
        friction_tangent(
            coefficients, friction * load, friction * slope, self, select, self.update, period.memory, tangent
        )
        tangent[:, 2, :, 2] = (analysis * slope[select][:, None]) @ synthesis
        return tangent

    def hidden_springs(self, period: LawPeriod) -> FloatArray:
        """(p, 3) N/m: zero, as a spring at rest acts in every pair."""
        return np.zeros((self.n_pairs, 3))

    def cycle(self, displacement: FloatArray) -> ContactCycle:
        """See :class:`stickslip.contact.law.law.ContactLaw`."""
        load, _ = self.normal_law.force(displacement[:, :, 2])
        cycle = friction_cycle(displacement, load, self, self.update)
        return replace(cycle, state=self._states(cycle.state, load.T))

    def linear_steps(self, displacement: FloatArray) -> LinearSteps:
        """See :class:`stickslip.contact.law.linear_steps.SteppedLaw`."""
        load, slope = self.normal_law.force(displacement[:, :, 2])
        return coulomb_linear_steps(
            displacement, self.walk(displacement), self.cycle(displacement).force[:, :, :2], self.tangential_springs,
            self.friction_coefficient, load, slope, self.update == "tractrix",
        )  # fmt: skip

    def _pressed(self) -> PressedPairs:
        """The pairs whose whole forces a step gives."""
        return PressedPairs(
            self.tangential_springs,
            self.friction_coefficient,
            self.normal_law,
            np.zeros(self.n_pairs),
            self.update == "tractrix",
        )

    def about(self, displacement: FloatArray, memory: CoulombMemory | None) -> ExponentialContact:
        """See :class:`stickslip.contact.law.law.ContactLaw`: load and stiffness there, with the same length."""
        load, slope = self.normal_law.force(displacement[:, 2])
        open_pairs = np.flatnonzero(load < NEARLY_OPEN * self.normal_load)
        if open_pairs.size:
            raise InputError(
                f"pairs: {open_pairs.size} of {self.n_pairs} pairs nearly open in this state, the first one is pair "
                f'{open_pairs[0]} with {load[open_pairs[0]]:.3g} N. The law "{self.name}" retains their tangential '
                'springs, which would carry load. Use the law "coulomb".',
                arguments=["pairs"],
            )
        return replace(
            self,
            normal_load=load,
            normal_stiffness=slope,
            residual_traction=None if memory is None else memory.traction,
        )
