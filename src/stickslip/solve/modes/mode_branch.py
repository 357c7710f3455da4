"""The branch of a nonlinear mode: its first point near a linear mode, and its continuation in the amplitude."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from stickslip.contact.law.law import ContactState
from stickslip.core.errors import ConvergenceError
from stickslip.core.resolution import SAMPLES_PER_HARMONIC
from stickslip.solve.curve_result import LARGEST_FRACTION
from stickslip.solve.harmonic.energy import work_per_cycle
from stickslip.solve.harmonic.mode_curve import ModeCurve, ModePoint
from stickslip.solve.modes.linear_mode import LinearMode
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import Accepted, ContinuationSettings, Corner, Retreat
from stickslip.solve.setting_up import Balances, StageReport

# chosen: a backbone over some decades of amplitude has at least 25 points, and one with folds about 130. More are a
# branch that does not find its way among others, as in a symmetric structure.
STEPS = ContinuationSettings(largest_step=0.04, max_points=400)
# chosen: the start moves towards the linear limit by at most so many decades of the amplitude.
DECADES_TO_LIMIT = 12


@dataclass(frozen=True)
class ModeBranch:
    """A branch of a nonlinear mode and its equations."""

    branch: Branch[ModePoint]
    curve: ModeCurve

    @property
    def points(self) -> list[ModePoint]:
        """The points of the branch, in its order."""
        return [each.point for each in self.branch.points]

    def with_harmonics(self, balances: Balances, count: int) -> ModeCurve:
        """The equations with another number of harmonics."""
        samples = max(balances.samples, SAMPLES_PER_HARMONIC * count)
        return self.curve.with_balance(balances.with_harmonics(count, samples))


def follow_mode(
    balances: Balances, start: LinearMode, harmonics: int, ends: tuple[float, float], newton: NewtonSettings,
    steps: ContinuationSettings, report: StageReport,
) -> ModeBranch:  # fmt: skip
    """The branch of the mode that begins as ``start``, between two modal amplitudes, with a number of harmonics.

    It may end early (``branch.complete``, ``branch.message``). Raises ConvergenceError if it has no first point.
    """
    balance = balances.with_harmonics(harmonics)
    curve = ModeCurve(balance, start.load_mode, _own_damping(balances, start.load_mode), start.omega)
    solver = Newton(curve, newton, report.iteration)
    report.stage("first point")
    away = 1.0 if start.limit == "sliding" else -1.0
    point = _first_point(solver, curve, balances, start, math.log10(ends[0]), away)
    branch = Branch(solver, point, math.log10(ends[1]), steps, _follower(ends, report))
    branch.follow()
    return ModeBranch(branch, curve)


def _own_damping(balances: Balances, mode: int) -> float:
    """1/s, the damping of a stuck mode alone."""
    modal = balances.stuck.modal_damping
    return float(modal[mode] if modal.ndim == 1 else modal[mode, mode])


def _first_point(
    solver: Newton[ModePoint], curve: ModeCurve, balances: Balances, start: LinearMode, target: float, away: float
) -> ModePoint:
    """The point at the logarithm ``target`` of the amplitude. Raises ConvergenceError.

    The linear mode is the estimate. Where Newton's method does not converge from it, the amplitude moves ``away`` (1.0
    or -1.0), towards the linear limit, and a branch leads back.
    """
    for decades in range(DECADES_TO_LIMIT + 1):
        reached = target + away * decades
        estimate = _estimate(curve, balances, start, reached)
        correction = solver.correct(estimate, Plane.fixed(estimate.unknowns, reached))
        if correction.converged:
            break
    else:
        raise ConvergenceError(
            f"the solver found no nonlinear mode near the linear {start.limit} mode {start.number} "
            f"({start.omega / (2.0 * math.pi):.3f} Hz): the relative residual is {correction.point.error:.1e} at "
            f"{curve.named(reached)}. Use another mode, or more samples."
        )
    if not decades:
        return correction.point
    branch = Branch(solver, correction.point, target, STEPS)
    branch.follow()
    if not branch.complete:
        raise ConvergenceError(f"the nonlinear mode does not reach {curve.named(target)}. {branch.message}")
    return branch.points[-1].point


def _estimate(curve: ModeCurve, balances: Balances, start: LinearMode, logarithm: float) -> ModePoint:
    """The linear mode with an amplitude, damped by what the pairs and the viscous damping dissipate in it."""
    size = 10.0**logarithm
    viscous = float(curve.balance.compliance.gain.viscous_form(start.motion))
    linear = curve.at(size * start.motion, start.omega, viscous)
    friction = float(work_per_cycle(linear.trial).sum())
    return curve.at(size * start.motion, start.omega, viscous + friction / (math.pi * start.omega * size**2))


def _follower(
    ends: tuple[float, float], report: StageReport
) -> Callable[[Accepted[ModePoint] | Retreat | Corner], None]:
    """A listener that reports the progress of a branch from one amplitude to another."""
    first, last = map(math.log10, ends)

    def on_event(event: Accepted[ModePoint] | Retreat | Corner) -> None:
        if not isinstance(event, Accepted):
            return
        trial, reached = event.point.trial, float(event.point.parameters[0])
        fraction = min(LARGEST_FRACTION, max(0.0, (reached - first) / (last - first)))
        moving = int((trial.contact.state != ContactState.STUCK).sum())
        hertz = trial.omega / (2.0 * math.pi)
        report.stage(
            f"{hertz:.2f} Hz at {10.0**reached:.2g} m kg^0.5, point {event.count}, {moving} pairs moving", fraction
        )

    return on_event
