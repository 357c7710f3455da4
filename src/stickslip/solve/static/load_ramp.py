"""A static load that grows from zero in steps, so that friction follows its history.

Newton's method solves each step from the last state; where it fails, the step is shortened or approached in damped
steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_step import PressedPairs
from stickslip.contact.law.law import CodeArray, ContactState
from stickslip.contact.law.normal_law import NormalLaw
from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.support import StaticFactor
from stickslip.solve.joint_step import StepPoint
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.static.state import StaticState
from stickslip.solve.static.step import RestingJoint
from stickslip.structure.superelement import Superelement

# Newton's method of a load step: a direct solution has little round-off (round_off_factor 0), and a law with kinks
# needs short steps.
NEWTON = NewtonSettings(tolerance=1e-10, max_iterations=40, round_off_factor=0.0, fractions=(1.0, 0.5, 0.25, 0.1, 0.03))
SMALLEST_INCREMENT = 1e-4  # of the load
INCREMENT_GROWTH = 1.5  # of the next load step, up to the first one
# chosen: below this fraction of the first load step damped steps are an additional attempt.
APPROACH_BELOW = 0.1
LARGEST_RESIDUAL = 1e-6  # of the forces; chosen: the limit of curve_warnings.LARGEST_RESIDUAL
# chosen: damping of the steps towards a solution that plain Newton misses, as a fraction of the springs; the factor is
# DAMPING_DECAY after a success and DAMPING_GROWTH after a failure, up to LARGEST_DAMPING.
FIRST_DAMPING, LAST_DAMPING, LARGEST_DAMPING, DAMPED_STEPS = 1.0, 1e-5, 1e3, 60
DAMPING_DECAY, DAMPING_GROWTH = 0.4, 4.0
# Without friction: the fraction of the forces that the restraint may carry at the end, the fraction above which it is
# moved, and the factor by which each move must lower it.
LARGEST_RESTRAINT_FRACTION, SMALLEST_RESTRAINT_FRACTION, RESTRAINT_DECAY = 1e-3, 1e-10, 0.99


@dataclass(frozen=True)
class History:
    """A converged state on the ramp, from which the next step starts."""

    relative: FloatArray  # (n_pairs, 3) m
    memories: tuple[Any, ...]  # of each law


class LoadRamp:
    """Load steps of one joint with given stiffness."""

    def __init__(
        self,
        superelement: Superelement,
        pairs: ContactPairs,
        load: FloatArray,
        law: NormalLaw | None,
        gap: FloatArray,
        friction: bool,
    ) -> None:
        self._joint = RestingJoint.build(superelement, pairs, load, law, gap, friction)
        self._iterations = 0
        self._slider_position = np.zeros((pairs.n_pairs, 3))

    def run(self, steps: int) -> StaticState:
        """The state under the full load. Raises ConvergenceError."""
        joint, n_pairs = self._joint, self._joint.pairs.n_pairs
        history = History(np.zeros((n_pairs, 3)), joint.memories)
        reached, increment, count, damped = 0.0, 1.0 / steps, 0, False
        self._iterations = 0
        self._slider_position = np.zeros((n_pairs, 3))
        point: StepPoint | None = None
        while reached < 1.0:
            target = min(1.0, reached + increment)
            solution = self._newton(self._guess(history, reached, target), history, target)
            if solution is None and increment <= APPROACH_BELOW / steps:
                solution, damped = self._approach(history, target), True
            if solution is None:
                increment *= 0.5
                if increment < SMALLEST_INCREMENT:
                    raise ConvergenceError(
                        f"the solver found no equilibrium of the joint beyond {100 * reached:.2f} % of the static "
                        "load. If contact alone supports a body, check that the load presses it into its contacts and "
                        "that friction can support it; otherwise lower the contact stiffness."
                    )
                continue
            point, history = solution, History(solution.unknowns, solution.memory)
            reached, count = target, count + 1
            increment = min(INCREMENT_GROWTH * increment, 1.0 / steps)
        assert point is not None
        if not joint.friction:
            point = self._release_restraint(point, history)
        return self._state(point, count, damped)

    def _guess(self, history: History, reached: float, target: float) -> FloatArray:
        """The bonded solution in the first step, later the state in proportion to the load."""
        if reached == 0.0:
            return np.asarray((target * self._joint.bonded).reshape(-1, 3))
        return history.relative * (target / reached)

    def _newton(
        self, guess: FloatArray, history: History, load: float, damping: float = 0.0, centre: FloatArray | None = None
    ) -> StepPoint | None:
        """A converged point from ``guess``, or None."""
        problem = self._joint.step(history.memories, load, self._slider_position, damping, centre)
        correction = Newton(problem, NEWTON, self._count).correct(problem.evaluate(guess))
        return correction.point if correction.converged else None

    def _count(self, iteration: int, error: float) -> None:
        self._iterations += 1

    def _approach(self, history: History, load: float) -> StepPoint | None:
        """A solution by damped steps: springs tie each to the last one, weaker in each step; the last has no ties."""
        centre, damping = history.relative, FIRST_DAMPING
        for _ in range(DAMPED_STEPS):
            solution = self._newton(centre, history, load, damping, centre)
            if solution is None:
                damping *= DAMPING_GROWTH
                if damping > LARGEST_DAMPING:
                    return None
                continue
            centre = solution.unknowns
            damping *= DAMPING_DECAY
            if damping < LAST_DAMPING:
                break
        return self._newton(centre, history, load)

    def _state(self, point: StepPoint, steps: int, damped: bool) -> StaticState:
        """The state of the joint at the point under the full load."""
        joint, relative = self._joint, point.unknowns
        operator = joint.pairs.operator
        deviation = (point.force - joint.springs * relative).ravel()
        displacement = joint.factor.solve(joint.load - operator.T @ deviation)
        equilibrium = self._unbalanced(displacement, point.force)
        if equilibrium > LARGEST_RESIDUAL:
            raise ConvergenceError(
                f"the static state is in equilibrium only to {equilibrium:.1e} of its forces (required: "
                f"{LARGEST_RESIDUAL:.0e}): contact many orders stiffer than the structure loses digits. Lower the "
                "contact stiffness; a joint a thousand times stiffer than the parts that it connects is rigid."
            )
        self._require_stable(point)
        force = point.force if joint.friction else np.where(joint.frictional, 0.0, point.force)
        normal, slope = self._normal(point, force)
        whole = self._at_rest_before() + force
        reached = "in damped steps" if damped else "by Newton's method"
        return StaticState(
            displacement=displacement,
            normal_force=normal,
            traction=whole[:, :2],
            gap=np.maximum(joint.gap - relative[:, 2], 0.0),
            state=point.code,
            normal_stiffness=slope,
            tangential_stiffness=joint.pairs.tangential_springs[:, 0].copy(),
            residual=self._unbalanced(displacement, force),
            steps=steps,
            iterations=self._iterations,
            message=(
                f"Static state in {steps} load steps {reached} ({self._iterations} iterations): "
                f"{self._states_in_words(point.code)}."
            ),
            memory=point.memory if joint.friction else None,
        )

    def _require_stable(self, point: StepPoint) -> None:
        """Raise ConvergenceError where springs that soften leave the joint without a stable state."""
        joint, slope = self._joint, np.einsum("paa->pa", point.forces.derivative)
        softened = (slope < 0.0) & ~joint.frictional
        springs = np.where(softened, slope, joint.springs)
        if softened.any() and StaticFactor.attempt(joint.superelement, joint.pairs, springs) is None:
            raise ConvergenceError(
                f"the static state is unstable: the springs of {int(softened.any(axis=1).sum())} pairs soften by more "
                "than the stiffness of the structure, so the joint jumps on the way to the static load. Lower the "
                "load, or check the softening constants."
            )

    def _at_rest_before(self) -> FloatArray:
        """(n_pairs, 3) N that pairs of other laws carried before the load; the forces of Coulomb pairs are whole."""
        pairs = self._joint.pairs
        others = [not isinstance(law, PressedPairs) for law in self._joint.laws]
        whole = np.column_stack([pairs.resting_traction, pairs.normal_load])
        for law_is_other, members in zip(others, pairs.members, strict=True):
            if not law_is_other:
                whole[members] = 0.0
        return whole

    def _normal(self, point: StepPoint, force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Whole normal forces (n_pairs,) N and their stiffness (n_pairs,) N/m, also of open Coulomb pairs."""
        joint = self._joint
        normal, slope = self._at_rest_before()[:, 2] + force[:, 2], point.forces.derivative[:, 2, 2].copy()
        for law, members in zip(joint.laws, joint.pairs.members, strict=True):
            if isinstance(law, PressedPairs):
                value, slope[members] = law.law.force(point.unknowns[members, 2] - law.gap)
                normal[members] = np.maximum(value, 0.0)
        return normal, slope

    def _states_in_words(self, code: CodeArray) -> str:
        """The number of pairs in each state, by law."""
        joint, parts = self._joint, []
        for law, members in zip(joint.pairs.laws, joint.pairs.members, strict=True):
            count = {state: int((code[members] == state).sum()) for state in ContactState}
            if isinstance(law, CoulombLaw):
                limit = f", {count[ContactState.STICK_SLIP]} on the friction limit" if joint.friction else ""
                parts.append(f"{count[ContactState.SEPARATING]} pairs open{limit}")
            elif not joint.friction and law.frictional().any():
                parts.append(f"{law.name} free to slide")  # codes of states with friction say nothing here
            else:
                words = [f"{count[state]} {name}" for state, name in law.states.items() if count[state]]
                parts.append(f"{law.name} {', '.join(words)}")
        return "; ".join(parts) + ("" if joint.friction else ", no friction")

    def _unbalanced(self, displacement: FloatArray, force: FloatArray) -> float:
        """``|K u + B^T f - load|`` over the forces."""
        contact = self._joint.pairs.operator.T @ force.ravel()
        unbalanced = self._joint.superelement.stiffness @ displacement + contact - self._joint.load
        size = float(np.linalg.norm(self._joint.load) + np.linalg.norm(contact))
        return float(np.linalg.norm(unbalanced)) / max(size, 1e-300)  # 0 N where no unknown moves along a normal

    def _release_restraint(self, point: StepPoint, history: History) -> StepPoint:
        """The solution without friction and without a force of the restraint, which is moved until it carries none.

        The structure or other contacts take over the force, step by step (a proximal point method). Where nothing does,
        the force stays: ConvergenceError unless it is small; then it is part of the residual of the state.
        """
        force, share = self._restrained(point)
        while share > SMALLEST_RESTRAINT_FRACTION:
            self._slider_position = point.unknowns.copy()
            moved = self._newton(point.unknowns, history, 1.0)
            before = share
            if moved is not None:
                point = moved
                force, share = self._restrained(point)
            if moved is None or share > RESTRAINT_DECAY * before:
                break
        if share > LARGEST_RESTRAINT_FRACTION:
            raise ConvergenceError(
                "without friction the static load pushes a body along a direction without support: an artificial "
                f"restraint carries {force:.3g} N there. Retain the traction of the static solution with friction "
                '(residual_traction = "kept"), or constrain the body along that direction.'
            )
        return point

    def _restrained(self, point: StepPoint) -> tuple[float, float]:
        """Force of the restraint: N, and as a fraction of the load and the contact forces."""
        transposed, frictional = self._joint.pairs.operator.T, self._joint.frictional
        force = float(np.linalg.norm(transposed @ np.where(frictional, point.force, 0.0).ravel()))
        contact = float(np.linalg.norm(transposed @ np.where(frictional, 0.0, point.force).ravel()))
        return force, force / (float(np.linalg.norm(self._joint.load)) + contact + 1e-300)
