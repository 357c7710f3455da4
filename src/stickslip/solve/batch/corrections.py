"""Newton's method for many curves in lockstep: one evaluation of all of them in each tick.

A curve never waits for another one: after its correction it begins the next at once. So each tick evaluates trials of
all curves, those of first, of later and of shortened steps together.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.batch.equations import StackedBalance, StackedTrial, norm
from stickslip.solve.batch.systems import Changes, Planes, steps_and_directions
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray
from stickslip.solve.path.corrector import PATIENCE
from stickslip.solve.path.newton import HALF, ROUND_OFF_STEP, NewtonSettings

SETTINGS = NewtonSettings()


@dataclass(frozen=True)
class Outcome:
    """One tick: the trials of all curves, and whose corrections are complete, have failed, or neither, (B,)."""

    trial: StackedTrial
    converged: BoolArray
    failed: BoolArray


class Corrections:
    """The corrections of B curves; the criteria are those of :class:`stickslip.solve.path.newton.Newton`.

    Every correction has at least one step, because the direction of its curve belongs to its last system.
    """

    def __init__(self, balance: StackedBalance) -> None:
        self.balance = balance
        count, shape = balance.count, balance.springs.shape
        modes = balance.structures.shapes.shape[2], (shape[2] - 1) // 2
        self._state = _State(
            relative=np.zeros(shape),
            omega=np.ones(count),
            base=np.zeros(shape),
            base_omega=np.ones(count),
            step=np.zeros(shape),
            step_omega=np.zeros(count),
            base_error=np.full(count, np.inf),
            fraction=np.zeros(count, dtype=np.int64),
            iteration=np.zeros(count, dtype=np.int64),
            errors=np.zeros((count, SETTINGS.max_iterations + 1)),
            direction=np.zeros(shape),
            direction_amplitude=np.zeros((count, *modes), dtype=complex),
            direction_omega=np.zeros(count),
        )
        self._planes = Planes.fixed(np.ones(count), np.ones(count), shape)

    def begin(self, chosen: IndexArray, relative: FloatArray, omega: FloatArray, planes: Planes) -> None:
        """Begin corrections of some curves (S,) from relative displacements (S, m, W) and frequencies (S,)."""
        state = self._state
        state.relative[chosen], state.omega[chosen] = relative, omega
        state.base_error[chosen], state.iteration[chosen], state.fraction[chosen] = np.inf, 0, 0
        self._planes.put(chosen, planes)

    def direction(self, chosen: IndexArray) -> Changes:
        """The directions of some curves, from the last systems of their corrections."""
        state = self._state
        return Changes(state.direction[chosen], state.direction_amplitude[chosen], state.direction_omega[chosen])

    def iterations(self, chosen: IndexArray) -> IndexArray:
        """(S,) steps of Newton's method in the present corrections of some curves."""
        return self._state.iteration[chosen]

    def take(self, chosen: IndexArray) -> None:
        """Go on with some curves alone."""
        self.balance, self._state = self.balance.take(chosen), self._state.take(chosen)
        self._planes = self._planes.take(chosen)

    def tick(self) -> Outcome:
        """Evaluate all trials, and take a step wherever neither solution nor failure is reached."""
        state = self._state
        trial = self.balance.evaluate(state.relative, state.omega)
        error, last = trial.error, len(SETTINGS.fractions) - 1
        is_first = np.isinf(state.base_error)
        is_taken = (error < state.base_error) | (state.fraction == last) | is_first
        solved = is_taken & ~is_first & (error <= SETTINGS.tolerance)
        converged = solved | (~is_first & self._is_round_off(trial))
        onward = is_taken & ~converged
        state.errors[onward, state.iteration[onward]] = error[onward]
        failed = onward & (~np.isfinite(error) | (state.iteration == SETTINGS.max_iterations) | self._is_stuck())
        self._shorten(np.flatnonzero(~is_taken & ~converged))
        failed |= self._step(trial, np.flatnonzero(onward & ~failed))
        return Outcome(trial, converged, failed)

    def _is_stuck(self) -> BoolArray:
        """(B,) whether the last iterations of a correction did not halve its error, and it is above round-off."""
        state, places = self._state, np.arange(len(self._state.omega))
        now, before = state.errors[places, state.iteration], state.errors[places, state.iteration - PATIENCE]
        floor = SETTINGS.round_off_factor * SETTINGS.tolerance
        return np.asarray((state.iteration >= PATIENCE) & (now > np.maximum(HALF * before, floor)))

    def _is_round_off(self, trial: StackedTrial) -> BoolArray:
        """(B,) whether the error no longer falls although it and the step are as small as round-off."""
        state, near = self._state, SETTINGS.round_off_factor * SETTINGS.tolerance
        answer = (state.base_error <= near) & (trial.error <= near) & (trial.error > 0.5 * state.base_error)
        if answer.any():
            step = norm(self.balance.determined(state.step))
            answer &= step <= ROUND_OFF_STEP * norm(self.balance.determined(trial.relative))
        return np.asarray(answer)

    def _shorten(self, chosen: IndexArray) -> None:
        """Try a smaller fraction of the step, because the last one enlarged the error."""
        state = self._state
        state.fraction[chosen] += 1
        part = np.array(SETTINGS.fractions)[state.fraction[chosen]]
        state.relative[chosen] = state.base[chosen] + part[:, None, None] * state.step[chosen]
        state.omega[chosen] = state.base_omega[chosen] + part * state.step_omega[chosen]

    def _step(self, trial: StackedTrial, chosen: IndexArray) -> BoolArray:
        """Solve the systems of some curves, from their trials; (B,) whose systems have no solution."""
        failed = np.zeros(len(trial.omega), dtype=bool)
        if not chosen.size:
            return failed
        state = self._state
        step, along = steps_and_directions(self.balance, trial, chosen, self._planes.take(chosen))
        good = np.isfinite(step.omega) & np.isfinite(norm(step.relative)) & np.isfinite(norm(along.relative))
        failed[chosen[~good]] = True
        state.base[chosen], state.base_omega[chosen] = trial.relative[chosen], trial.omega[chosen]
        state.base_error[chosen] = trial.error[chosen]
        state.step[chosen], state.step_omega[chosen] = step.relative, step.omega
        state.relative[chosen] = trial.relative[chosen] + step.relative
        state.omega[chosen] = trial.omega[chosen] + step.omega
        state.fraction[chosen], state.iteration[chosen] = 0, state.iteration[chosen] + 1
        state.direction[chosen], state.direction_omega[chosen] = along.relative, along.omega
        state.direction_amplitude[chosen] = along.amplitude
        return failed


@dataclass
class _State:
    """Where the correction of each curve is, (B, ...): trial, last point and step from it, errors so far, direction."""

    relative: FloatArray
    omega: FloatArray
    base: FloatArray
    base_omega: FloatArray
    step: FloatArray
    step_omega: FloatArray
    base_error: FloatArray
    fraction: IndexArray
    iteration: IndexArray
    errors: FloatArray
    direction: FloatArray
    direction_amplitude: ComplexArray
    direction_omega: FloatArray

    def take(self, chosen: IndexArray) -> _State:
        """That of some curves."""
        return _State(**{item.name: getattr(self, item.name)[chosen] for item in fields(self)})
