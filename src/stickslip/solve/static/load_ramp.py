"""Load steps of a joint with friction: semismooth Newton on the relative displacements, and a damped approach.

With the springs of all pairs in ``Kbar = K + B^T k B`` the unknowns are the relative displacements ``x``:

    R(x) = x - B Kbar^-1 load + A (f(x) - k x) = 0,   A = B Kbar^-1 B^T,

so open pairs may leave ``K`` nearly singular (a free damper): ``Kbar`` is not. Newton starts from the bonded solution
f = k x and uses the exact derivative of the law.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_kernel import OPEN, SLIP, CodeArray
from stickslip.contact.law.coulomb_step import friction_step
from stickslip.contact.law.normal_law import NormalLaw
from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.compliance import MEAN_RESTRAINT, StaticFactor
from stickslip.structure.superelement import Superelement

TOLERANCE = 1e-10
MAX_ITERATIONS = 40
SMALLEST_INCREMENT = 1e-4  # of the load
# A step this many times longer than the bonded solution and the gaps is a body that flies away.
LARGEST_STEP = 1e6
LARGEST_RESIDUAL = 1e-6
# Damping of the steps that approach a solution which plain Newton misses, as a share of the springs.
FIRST_DAMPING, LAST_DAMPING, DAMPED_STEPS = 1.0, 1e-5, 60
# Without friction: the share of the forces that the restraint may keep once it has been moved along, the share from
# which it is moved along, and the factor by which each move must lower it.
LARGEST_RESTRAINT_SHARE, SMALLEST_RESTRAINT_SHARE, RESTRAINT_DECAY = 1e-3, 1e-10, 0.99


@dataclass(frozen=True)
class StaticState:
    """The joint at rest under a static load.

    Attributes
    ----------
    displacement:
        (n,) m, unknowns of the superelement.
    normal_force, traction:
        (n_pairs,) and (n_pairs, 2) N along t1, t2.
    gap:
        (n_pairs,) m, 0 where closed.
    state:
        (n_pairs,) 0 stuck, 1 slipping (on the friction limit), 2 open; without friction all closed pairs are 1, as they
        are free to slide.
    normal_stiffness, tangential_stiffness:
        (n_pairs,) N/m at rest, for small motions about it.
    residual:
        ``|K u + B^T f - load| / (|load| + |B^T f|)`` with the forces f of this state.
    steps, iterations:
        load steps and Newton iterations of the last ramp.
    message:
        how the solution was reached.
    """

    displacement: FloatArray
    normal_force: FloatArray
    traction: FloatArray
    gap: FloatArray
    state: CodeArray
    normal_stiffness: FloatArray
    tangential_stiffness: FloatArray
    residual: float
    steps: int
    iterations: int
    message: str

    @property
    def preload(self) -> FloatArray:
        """(n_pairs,) N as :class:`ContactPairs` takes it: the normal force, or minus k_n times the gap."""
        return np.where(self.state == OPEN, -self.normal_stiffness * self.gap, self.normal_force)

    def pairs(self, operator: FloatArray, friction_coefficient: ArrayLike, keep_traction: bool) -> ContactPairs:
        """Contact pairs about this state, with the traction at rest kept or released."""
        return ContactPairs(
            operator,
            self.normal_stiffness,
            self.tangential_stiffness,
            friction_coefficient,
            self.preload,
            self.traction if keep_traction else None,
        )


@dataclass(frozen=True)
class _Known:
    """A converged state on the ramp."""

    relative: FloatArray  # (n_pairs, 3) m
    traction: FloatArray  # (n_pairs, 2) N
    limit: FloatArray  # (n_pairs,) N, negative in a gap


@dataclass(frozen=True)
class _Trial:
    """A trial at the end of a load step."""

    relative: FloatArray
    known: _Known
    code: CodeArray
    force: FloatArray  # (n_pairs, 3) N
    derivative: FloatArray  # (n_pairs, 3, 3) N/m
    residual: FloatArray  # (3 n_pairs,) m
    error: float  # norm of the residual over that of the bonded solution and of the gaps


class LoadRamp:
    """Load steps of one joint with given stiffness."""

    def __init__(
        self,
        superelement: Superelement,
        pairs: ContactPairs,
        load: FloatArray,
        law: NormalLaw,
        gap: FloatArray,
        friction: bool,
    ) -> None:
        self._superelement, self._pairs, self._load, self._law, self._gap = superelement, pairs, load, law, gap
        self._friction = friction
        self._springs = pairs.stuck_stiffness().reshape(-1, 3)
        self._factor = StaticFactor.build(superelement, pairs, self._springs)
        self._compliance = pairs.operator @ self._factor.solve(pairs.operator.T)
        self._loaded = pairs.operator @ self._factor.solve(load)
        self._iterations = 0
        self._at_ease = np.zeros((pairs.n_pairs, 2))  # where the restraint without friction is at ease, m along t1, t2

    def run(self, steps: int) -> StaticState:
        """The state under the full load. Raises ConvergenceError."""
        n_pairs = self._pairs.n_pairs
        start, _ = self._law.force(-self._gap)
        known = _Known(np.zeros((n_pairs, 3)), np.zeros((n_pairs, 2)), self._pairs.friction_coefficient * start)
        share, increment, count, damped = 0.0, 1.0 / steps, 0, False
        self._iterations = 0
        self._at_ease = np.zeros((n_pairs, 2))
        trial: _Trial | None = None
        while share < 1.0:
            target = min(1.0, share + increment)
            found = self._newton(self._guess(known, share, target), known, target)
            if found is None and increment <= 0.1 / steps:
                found, damped = self._approach(known, target), True
            if found is None:
                increment *= 0.5
                if increment < SMALLEST_INCREMENT:
                    raise ConvergenceError(
                        f"no equilibrium of the joint was found beyond {100 * share:.2f} % of the static load. If "
                        "contact alone holds a body, check that the load presses it into its contacts and that "
                        "friction can hold it; otherwise lower the contact stiffness."
                    )
                continue
            trial, known = found, _Known(found.relative, found.force[:, :2], self._limit(found))
            share, count = target, count + 1
            increment = min(1.5 * increment, 1.0 / steps)
        assert trial is not None
        if not self._friction:
            trial = self._let_go(trial, known)
        return self._state(trial, count, damped)

    def _limit(self, trial: _Trial) -> FloatArray:
        return self._pairs.friction_coefficient * self._law.force(trial.relative[:, 2] - self._gap)[0]

    def _guess(self, known: _Known, share: float, target: float) -> FloatArray:
        """The bonded solution on the first step, the state in proportion to the load afterwards."""
        if share == 0.0:
            return np.asarray((target * self._loaded).reshape(-1, 3))
        return known.relative * (target / share)

    def _evaluate(
        self, relative: FloatArray, known: _Known, share: float, damping: float, centre: FloatArray
    ) -> _Trial:
        """Contact forces and residual; ``damping`` ties the trial to ``centre`` with that share of the springs."""
        tangential = self._springs[:, :2]
        normal, slope = self._law.force(relative[:, 2] - self._gap)
        force, derivative = np.empty_like(relative), np.zeros((len(relative), 3, 3))
        if self._friction:
            limit_slope = self._pairs.friction_coefficient * slope
            step = friction_step(
                known.traction,
                known.limit,
                tangential * (relative[:, :2] - known.relative[:, :2]),
                self._pairs.friction_coefficient * normal,
            )
            code, force[:, :2] = step.code, step.traction
            derivative[:, :2, :2] = step.by_pull * tangential[:, None, :]
            derivative[:, :2, 2] = step.by_limit * limit_slope[:, None]
        else:
            # A body that only friction would hold gets the restraint of the mean position in dynamics; see _let_go.
            code = np.where(normal > 0.0, SLIP, OPEN).astype(np.int8)
            force[:, :2] = MEAN_RESTRAINT * tangential * (relative[:, :2] - self._at_ease)
            derivative[:, [0, 1], [0, 1]] = MEAN_RESTRAINT * tangential
        closed = normal > 0.0
        force[:, 2] = np.where(closed, normal, 0.0)
        derivative[:, 2, 2] = np.where(closed, slope, 0.0)
        acting = force + damping * self._springs * (relative - centre)
        derivative[:, [0, 1, 2], [0, 1, 2]] += damping * self._springs
        deviation = (acting - self._springs * relative).ravel()
        residual = relative.ravel() - share * self._loaded + self._compliance @ deviation
        error = float(np.linalg.norm(residual)) / self._scale(share)
        return _Trial(relative, known, code, force, derivative, residual, error)

    def _scale(self, share: float) -> float:
        """Size of the displacements, m, of the bonded solution and the gaps.

        Not of the solution itself: a body that flies away would make any residual look small.
        """
        return share * float(np.linalg.norm(self._loaded)) + float(np.linalg.norm(self._gap)) + 1e-300

    def _newton(
        self, guess: FloatArray, known: _Known, share: float, damping: float = 0.0, centre: FloatArray | None = None
    ) -> _Trial | None:
        """A converged trial from ``guess``, or None."""
        fixed = guess if centre is None else centre
        trial = self._evaluate(guess, known, share, damping, fixed)
        for _ in range(MAX_ITERATIONS):
            if trial.error <= TOLERANCE:
                return trial
            self._iterations += 1
            step = self._step(trial)
            if not float(np.abs(step).max()) < LARGEST_STEP * self._scale(share):
                return None  # also where the step is not finite
            best: _Trial | None = None
            for fraction in (1.0, 0.5, 0.25, 0.1, 0.03):
                moved = self._evaluate(trial.relative + fraction * step, known, share, damping, fixed)
                if best is None or moved.error < best.error:
                    best = moved
                if moved.error < trial.error:
                    break
            assert best is not None
            trial = best
        return None

    def _step(self, trial: _Trial) -> FloatArray:
        """Newton's step (n_pairs, 3): ``(I + A D) dx = -R`` on the pairs where D, the change from the springs, acts."""
        n_pairs = len(trial.relative)
        change = trial.derivative.copy()
        change[:, [0, 1, 2], [0, 1, 2]] -= self._springs
        moving = np.flatnonzero(change.any(axis=(1, 2)))
        rows = (3 * moving[:, None] + np.arange(3)).ravel()
        compliance = self._compliance[:, rows].reshape(3 * n_pairs, moving.size, 3)
        product = np.einsum("mpa,pab->mpb", compliance, change[moving]).reshape(3 * n_pairs, rows.size)
        matrix = product[rows]
        matrix[np.diag_indices(rows.size)] += 1.0
        try:
            solved = np.linalg.solve(matrix, -trial.residual[rows])
        except np.linalg.LinAlgError:
            return np.full((n_pairs, 3), np.nan)  # the caller ends this attempt
        step = -trial.residual - product @ solved
        step[rows] = solved
        return np.asarray(step.reshape(-1, 3))

    def _approach(self, known: _Known, share: float) -> _Trial | None:
        """A solution by damped steps: each is tied to the last one, ever more loosely; the last is not tied at all."""
        centre, damping = known.relative, FIRST_DAMPING
        for _ in range(DAMPED_STEPS):
            found = self._newton(centre, known, share, damping, centre)
            if found is None:
                damping *= 4.0
                if damping > 1e3:
                    return None
                continue
            centre = found.relative
            damping *= 0.4
            if damping < LAST_DAMPING:
                break
        return self._newton(centre, known, share)

    def _state(self, trial: _Trial, steps: int, damped: bool) -> StaticState:
        """What the trial under the full load says of the joint."""
        operator, relative = self._pairs.operator, trial.relative
        normal, slope = self._law.force(relative[:, 2] - self._gap)
        deviation = (trial.force - self._springs * relative).ravel()
        displacement = self._factor.solve(self._load - operator.T @ deviation)
        equilibrium = self._unbalanced(displacement, trial.force)
        if equilibrium > LARGEST_RESIDUAL:
            raise ConvergenceError(
                f"the static state is in equilibrium only to {equilibrium:.1e} of its forces (wanted: "
                f"{LARGEST_RESIDUAL:.0e}): contact many orders stiffer than the structure loses digits. Lower the "
                "contact stiffness; a joint a thousand times stiffer than what it joins is rigid."
            )
        force = trial.force if self._friction else trial.force * np.array([0.0, 0.0, 1.0])
        reached = "in damped steps" if damped else "by Newton's method"
        open_pairs, slipping = int((trial.code == OPEN).sum()), int((trial.code == SLIP).sum())
        return StaticState(
            displacement=displacement,
            normal_force=np.maximum(normal, 0.0),
            traction=force[:, :2],
            gap=np.maximum(self._gap - relative[:, 2], 0.0),
            state=trial.code,
            normal_stiffness=slope,
            tangential_stiffness=self._pairs.tangential_springs[:, 0].copy(),
            residual=self._unbalanced(displacement, force),
            steps=steps,
            iterations=self._iterations,
            message=(
                f"Static state in {steps} load steps {reached} ({self._iterations} iterations): {open_pairs} pairs open"
                + (f", {slipping} on the friction limit." if self._friction else ", no friction.")
            ),
        )

    def _unbalanced(self, displacement: FloatArray, force: FloatArray) -> float:
        """``|K u + B^T f - load|`` over the forces."""
        contact = self._pairs.operator.T @ force.ravel()
        unbalanced = self._superelement.stiffness @ displacement + contact - self._load
        return float(np.linalg.norm(unbalanced) / (np.linalg.norm(self._load) + np.linalg.norm(contact)))

    def _let_go(self, trial: _Trial, known: _Known) -> _Trial:
        """The solution without friction whose restraint carries nothing: it is moved along until that is so.

        What the structure or other contacts hold takes the force over, step by step (a proximal point method). Where
        nothing does, the force stays: ConvergenceError unless it is small, when the residual of the state shows it.
        """
        held, share = self._restrained(trial)
        while share > SMALLEST_RESTRAINT_SHARE:
            self._at_ease = trial.relative[:, :2].copy()
            moved = self._newton(trial.relative, known, 1.0)
            before = share
            if moved is not None:
                trial = moved
                held, share = self._restrained(trial)
            if moved is None or share > RESTRAINT_DECAY * before:
                break
        if share > LARGEST_RESTRAINT_SHARE:
            raise ConvergenceError(
                f"without friction the static load pushes a body along a direction in which nothing holds it: an "
                f"artificial restraint carries {held:.3g} N there. Keep the traction of the static solution with "
                'friction (residual_traction = "kept"), or hold the body along that direction.'
            )
        return trial

    def _restrained(self, trial: _Trial) -> tuple[float, float]:
        """What the restraint carries: N, and as a share of the load and the contact forces."""
        transposed = self._pairs.operator.T
        held = float(np.linalg.norm(transposed @ (trial.force * np.array([1.0, 1.0, 0.0])).ravel()))
        contact = float(np.linalg.norm(transposed @ (trial.force * np.array([0.0, 0.0, 1.0])).ravel()))
        return held, held / (float(np.linalg.norm(self._load)) + contact + 1e-300)
