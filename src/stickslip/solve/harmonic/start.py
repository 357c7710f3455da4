"""The first point of a curve: directly, by an amplitude ramp, with fewer harmonics, or from outside the window."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Constraint, Correction, Newton


def first_point(
    newton: Newton,
    omega: float,
    simpler: Callable[[int], Balance] | None = None,
    walk: Callable[[Trial], Branch] | None = None,
) -> tuple[Trial, str]:
    """A converged solution at ``omega`` (rad/s) under the full load, and a sentence on how it was reached.

    ``simpler(h)`` gives the same balance with ``h`` harmonics, ``walk(trial)`` the branch from a solution at another
    frequency to ``omega``; None leaves that way out. Raises ConvergenceError with
    the relative residual of each attempt when none succeeds.
    """
    attempts = []
    balance = newton.balance
    direct = _at(newton, balance.linear(omega), omega, 1.0)
    if direct.converged:
        return direct.trial, "The first point converged from the linear stuck response."
    attempts.append(f"from the linear stuck response: relative residual {direct.trial.error:.1e}")
    ramped, reached = _amplitude_ramp(newton, omega)
    if ramped is not None:
        return ramped, "The first point was reached by an amplitude ramp."
    attempts.append(f"amplitude ramp: stopped at {100 * reached:.1f} % of the force")
    if simpler is not None:
        for harmonics in (1, 3):
            if harmonics >= balance.harmonics:
                break
            start = _few_harmonics(newton, simpler(harmonics), omega)
            if start.converged:
                return start.trial, f"The first point was reached from a solution with {harmonics} harmonic(s)."
            attempts.append(f"from {harmonics} harmonic(s): relative residual {start.trial.error:.1e}")
    if walk is not None:
        for share in (0.97, 1.03, 0.9, 1.1):
            outside = _at(newton, balance.linear(share * omega), share * omega, 1.0)
            if not outside.converged:
                attempts.append(f"from {_hz(share * omega):.2f} Hz: relative residual {outside.trial.error:.1e}")
                continue
            branch = walk(outside.trial)
            for _ in branch:
                pass
            if branch.complete:
                return branch.points[
                    -1
                ].trial, f"The first point was reached from {_hz(share * omega):.2f} Hz, where it converged."
            attempts.append(f"from {_hz(share * omega):.2f} Hz: {branch.message}")
    raise ConvergenceError(
        f"no solution was found at the first frequency, {_hz(omega):.3f} Hz ({'; '.join(attempts)}). "
        "Start farther from the resonance, take more samples or fewer harmonics, or lower the force: contact that "
        "opens and shuts hard may have no simple periodic motion."
    )


def _at(newton: Newton, guess: FloatArray, omega: float, load: float) -> Correction:
    """Newton at fixed frequency and load."""
    start = newton.balance.evaluate(guess, omega, load)
    return newton.correct(start, Constraint.fixed(guess, omega))


def _amplitude_ramp(newton: Newton, omega: float) -> tuple[Trial | None, float]:
    """Raise the force from a hundredth in adaptive steps: solution at full force or None, and the share reached."""
    load, increment = 0.01, 0.09
    point = _at(newton, newton.balance.linear(omega, load), omega, load)
    if not point.converged:
        return None, 0.0
    current = point.trial
    while load < 1.0:
        if increment < 1e-4:
            return None, load
        target = min(1.0, load + increment)
        correction = _at(newton, current.relative * (target / load), omega, target)
        if correction.converged:
            current, load = correction.trial, target
            increment *= 1.6
        else:
            increment *= 0.5
    return current, 1.0


def _few_harmonics(newton: Newton, simple: Balance, omega: float) -> Correction:
    """Solve with fewer harmonics, then correct with all of them from there."""
    balance = newton.balance
    coarse = _at(Newton(simple, newton.settings, newton.told), simple.linear(omega), omega, 1.0)
    guess = np.zeros((2 * balance.harmonics + 1, balance.rows))
    guess[: coarse.trial.relative.shape[0]] = coarse.trial.relative
    return _at(newton, guess, omega, 1.0)


def _hz(omega: float) -> float:
    return omega / (2.0 * math.pi)
