"""The first point of a curve: directly, by an amplitude ramp, with fewer harmonics, or from outside the window."""

from __future__ import annotations

import math
from collections.abc import Callable

from stickslip.core.errors import ConvergenceError
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve, LoadCurve
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Correction, Newton
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings

# chosen: load at the beginning of the ramp, at which few pairs slip, and the steps of the ramp, which may be long.
FIRST_LOAD = 0.01
RAMP = ContinuationSettings(largest_step=0.3, first_step=0.05, max_points=500)
# chosen: iterations of all ramps of a curve that do not reach the full force, after which no other one begins. Of those
# of the torture set that reach it none takes more than 1,058, and those of the same curve before it 781 at most.
MOST_IN_RAMPS = 2000.0
# chosen: harmonics of simpler balances, and multiples of the first frequency (nearest first, on both sides), in the
# order of the attempts.
SIMPLER_HARMONICS = (1, 3)
OUTSIDE = (0.97, 1.03, 0.9, 1.1)


def first_point(
    newton: Newton[BalancePoint],
    curve: FrequencyCurve,
    omega: float,
    simpler: Callable[[int], Balance] | None = None,
    walk: Callable[[BalancePoint], Branch[BalancePoint]] | None = None,
) -> tuple[BalancePoint, str]:
    """A converged solution of ``curve`` at ``omega`` (rad/s), and a sentence on the way to it.

    ``newton`` solves ``curve``. ``simpler(h)`` gives the same balance with ``h`` harmonics, ``walk(point)`` the branch
    from a solution at another frequency to ``omega``; None skips that attempt. Raises ConvergenceError with the
    relative residual of each attempt if none succeeds.
    """
    attempts = []
    balance = curve.balance
    direct = at_frequency(newton, curve, balance.linear(omega, curve.load), omega)
    if direct.converged:
        return direct.point, "The first point converged from the linear stuck response."
    attempts.append(f"from the linear stuck response: relative residual {direct.point.error:.1e}")
    ramped, message = amplitude_ramp(newton, curve, omega)
    if ramped is not None:
        return ramped, "The first point converged after an amplitude ramp."
    attempts.append(f"amplitude ramp: {message}")
    if simpler is not None:
        for harmonics in SIMPLER_HARMONICS:
            if harmonics >= balance.harmonics:
                break
            start = _few_harmonics(newton, curve, simpler(harmonics), omega)
            if start.converged:
                return start.point, f"The first point converged from a solution with {harmonics} harmonic(s)."
            attempts.append(f"from {harmonics} harmonic(s): relative residual {start.point.error:.1e}")
    if walk is not None:
        for multiple in OUTSIDE:
            place = f"from {_hz(multiple * omega):.2f} Hz"
            outside = at_frequency(newton, curve, balance.linear(multiple * omega, curve.load), multiple * omega)
            if not outside.converged:
                attempts.append(f"{place}: relative residual {outside.point.error:.1e}")
                continue
            branch = walk(outside.point)
            branch.follow()
            if branch.complete:
                return branch.points[-1].point, f"Continuation {place} reached the first point."
            attempts.append(f"{place}: {branch.message}")
    raise ConvergenceError(
        f"the solver found no solution at the first frequency, {_hz(omega):.3f} Hz ({'; '.join(attempts)}). Start "
        "farther from the resonance, use more samples or fewer harmonics, or lower the force: contact that opens and "
        "closes abruptly may have no simple periodic motion, and contact many orders stiffer than the structure leaves "
        "no digits."
    )


def at_frequency(
    newton: Newton[BalancePoint], curve: FrequencyCurve, guess: FloatArray, omega: float
) -> Correction[BalancePoint]:
    """Newton at a fixed frequency."""
    return newton.correct(curve.at(guess, omega), Plane.fixed(guess, omega))


def amplitude_ramp(
    newton: Newton[BalancePoint], curve: FrequencyCurve, omega: float
) -> tuple[BalancePoint | None, str]:
    """Follow the solution from a hundredth of the force, through folds: that at full force or None, and a message."""
    work = curve.work
    if work.in_ramps >= MOST_IN_RAMPS:
        return None, f"earlier ones took {work.in_ramps:.0f} iterations and did not reach the full force"
    before = work.newton
    point, message = _ramped(newton, curve, omega)
    if point is None:
        work.in_ramps += work.newton - before
    return point, message


def _ramped(newton: Newton[BalancePoint], curve: FrequencyCurve, omega: float) -> tuple[BalancePoint | None, str]:
    """See :func:`amplitude_ramp`."""
    ramp = LoadCurve(curve.balance, omega, curve.work)
    ramp_newton = Newton(ramp, newton.settings, newton.on_iteration)
    guess = curve.balance.linear(omega, FIRST_LOAD * curve.load)
    first = ramp_newton.correct(ramp.at(guess, FIRST_LOAD * curve.load), Plane.fixed(guess, FIRST_LOAD * curve.load))
    if not first.converged:
        return None, f"no solution at {100 * FIRST_LOAD:g} % of the force"
    branch = Branch(ramp_newton, first.point, curve.load, RAMP, work=curve.work)
    branch.follow()
    if not branch.complete:
        return None, branch.message
    full = at_frequency(newton, curve, branch.points[-1].point.unknowns, omega)
    if not full.converged:
        return None, f"near the full force, but there Newton stopped at a relative residual of {full.point.error:.1e}"
    return full.point, branch.message


def _few_harmonics(
    newton: Newton[BalancePoint], curve: FrequencyCurve, simple: Balance, omega: float
) -> Correction[BalancePoint]:
    """Solve with fewer harmonics, then correct with all of them from there."""
    few = FrequencyCurve(simple, curve.load, work=curve.work)
    few_newton = Newton(few, newton.settings, newton.on_iteration)
    coarse = at_frequency(few_newton, few, simple.linear(omega, curve.load), omega).point
    guess = with_rows(coarse.unknowns, 2 * curve.balance.harmonics + 1)
    return at_frequency(newton, curve, guess, omega)


def _hz(omega: float) -> float:
    return omega / (2.0 * math.pi)
