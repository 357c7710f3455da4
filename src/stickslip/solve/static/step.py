"""One load step of a joint as a problem of Newton's method.

With the springs of all pairs in ``Kbar = K + B^T k B`` the unknowns are the relative displacements ``x``:

    R(x) = x - load B Kbar^-1 F + A (f(x) - k x) = 0,   A = B Kbar^-1 B^T,

so open pairs may leave ``K`` nearly singular (a free damper): ``Kbar`` is not. The derivative of the law is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_step import PressedPairs
from stickslip.contact.law.joined_laws import Stepping, joined_step
from stickslip.contact.law.law import BoolArray, ContactState, LawStep
from stickslip.contact.law.normal_law import NormalLaw, SpringLaw
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.support import MEAN_RESTRAINT, StaticFactor
from stickslip.solve.joint_step import JointStep
from stickslip.structure.superelement import Superelement

# chosen: a step longer than this multiple of the bonded solution and the gaps is a body without support.
LARGEST_STEP = 1e6


@dataclass(frozen=True)
class RestingJoint:
    """A joint with constant stiffness under a static load, and the response of its structure.

    ``gap`` (n_pairs,) m, negative for an interference, is that of the Coulomb pairs, the whole normal force of which
    counts; pairs of other laws follow :meth:`ContactLaw.step`. Without ``friction`` whatever slip can release slides
    freely.
    """

    superelement: Superelement
    pairs: ContactPairs
    load: FloatArray  # (n,) N
    gap: FloatArray
    friction: bool
    laws: tuple[Stepping, ...]
    memories: tuple[Any, ...]  # of each law before the load
    frictional: BoolArray  # (n_pairs, 3)
    springs: FloatArray  # (n_pairs, 3) N/m
    factor: StaticFactor
    compliance: FloatArray  # (3 n_pairs, 3 n_pairs) m/N
    bonded: FloatArray  # (3 n_pairs,) m, relative displacement with every pair bonded

    @classmethod
    def build(
        cls,
        superelement: Superelement,
        pairs: ContactPairs,
        load: FloatArray,
        law: NormalLaw | None,
        gap: FloatArray,
        friction: bool,
    ) -> RestingJoint:
        """The joint of a structure; ``law`` is the normal law of its Coulomb pairs, None for their springs.

        Raises InputError where the structure is singular with all pairs bonded.
        """
        springs = pairs.stuck_stiffness().reshape(-1, 3)
        factor = StaticFactor.build(superelement, pairs, springs)
        compliance = pairs.operator @ factor.solve(pairs.operator.T)
        bonded = pairs.operator @ factor.solve(load)
        laws: list[Stepping] = []
        memories = []
        for each, members in zip(pairs.laws, pairs.members, strict=True):
            if isinstance(each, CoulombLaw):
                normal = law or SpringLaw(each.normal_stiffness)
                pressed = PressedPairs(each.tangential_springs, each.friction_coefficient, normal, gap[members])
                laws.append(pressed)
                memories.append(pressed.memory_at_rest())
            else:
                laws.append(each)
                memories.append(each.memory_at_rest())
        answers = (springs, factor, compliance, bonded)
        return cls(superelement, pairs, load, gap, friction, tuple(laws), tuple(memories), pairs.frictional(), *answers)

    def scale(self, load: float) -> float:
        """Size of the displacements, m, of the bonded solution and the gaps under a fraction ``load``.

        Not of the solution itself: a body without support would make any residual look small.
        """
        return load * float(np.linalg.norm(self.bonded)) + float(np.linalg.norm(self.gap)) + 1e-300

    def forces(self, relative: FloatArray, before: tuple[Any, ...], slider_position: FloatArray) -> LawStep:
        """Contact forces after a step; ``slider_position`` (n_pairs, 3) m is where a restraint carries nothing."""
        step = joined_step(self.laws, self.pairs.members, relative, before)
        if self.friction:
            return step
        # A body that only friction would support gets the restraint of the mean position in dynamics.
        restraint = MEAN_RESTRAINT * self.springs
        force = np.where(self.frictional, restraint * (relative - slider_position), step.force)
        derivative = np.where(self.frictional[:, :, None], restraint[:, :, None] * np.eye(3), step.derivative)
        slides = self.frictional.any(axis=1) & (step.state != ContactState.SEPARATING)
        state = np.where(slides, ContactState.STICK_SLIP, step.state).astype(np.int8)
        return LawStep(force, derivative, state, step.memory)

    def step(
        self,
        before: tuple[Any, ...],
        load: float,
        slider_position: FloatArray,
        damping: float = 0.0,
        centre: FloatArray | None = None,
    ) -> JointStep:
        """The step from the memories ``before`` to a fraction ``load`` of the static load.

        ``damping`` ties the solution to ``centre`` with that fraction of the springs, for an approach in small steps.
        """
        scale = self.scale(load)
        return JointStep(
            forces=lambda relative: self.forces(relative, before, slider_position),
            springs=self.springs,
            compliance=self.compliance,
            linear=load * self.bonded,
            scale=scale,
            largest_step=LARGEST_STEP * scale,
            tie=None if centre is None else (damping * self.springs, centre),
            name=f"{100.0 * load:.4g} % of the static load",
        )
