"""A branch knows where it has been: points near its last chord, loops beside it, and its own way back."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from stickslip.case.case import Case
from stickslip.model.model import build_model, load_joint, set_up
from stickslip.results.measures import Peak, summary
from stickslip.results.response import ForcedResponse
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.path.continuation import POINTS_BACK, Branch, ContinuationSettings
from stickslip.solve.path.newton import Constraint, Correction, Newton
from stickslip.solve.path.visited import Visited
from stickslip.study.run import solve
from sweep_cases import COARSE_MESH


def planar(x: float, omega: float, error: float = 0.0) -> Trial:
    """A trial of one unknown that is its own modal amplitude."""
    one = np.array([[x]])
    return Trial(omega, 1.0, one, one, cast(Any, None), one, np.array([[error]]), abs(error))


def visited(points: list[tuple[float, float]]) -> Visited:
    been = Visited()
    for x, omega in points:
        been.add(planar(x, omega))
    return been


def test_the_chord_of_a_circle_passes_the_first_point_again_after_one_turn() -> None:
    angle = 2.0 * np.pi * np.arange(0, 21) / 20.5
    been = visited([(np.sin(a), np.cos(a)) for a in angle])
    found = list(been.near_last_chord(1.0, 1.0))
    assert found == []
    been.add(planar(float(np.sin(0.1)), float(np.cos(0.1))))
    ((index, share),) = been.near_last_chord(1.0, 1.0)
    # Between the point at -pi / 20.5 (the last of the turn) and that at 0.1 lies the first one, at 0.
    assert index == 0
    assert share == pytest.approx((np.pi / 20.5) / (np.pi / 20.5 + 0.1), abs=0.01)


@pytest.mark.parametrize(("away", "near"), [(0.19, True), (0.21, False)])
def test_near_means_a_fifth_of_the_chord_in_the_scales_of_the_picture(away: float, near: bool) -> None:
    scale_u, scale_w = 1e-6, 600.0
    points = [(away * scale_u, 0.5), (5, 5), (5, 6), (5, 7), (5, 8), (0.0, 0.0), (0.0, 1.0)]
    been = visited([(x * (1.0 if x < 1 else scale_u), w * scale_w) for x, w in points])
    found = list(been.near_last_chord(scale_u, scale_w))
    assert [index for index, _ in found] == ([0] if near else [])


def test_neighbours_are_not_met_and_forgotten_points_neither() -> None:
    been = visited([(0.0, float(k)) for k in range(4)] + [(0.0, 2.9)])
    assert [index for index, _ in been.near_last_chord(1.0, 1.0)] == []
    been = visited([(0.0, 0.0), *((1.0, float(k)) for k in range(4)), (0.0, -0.5), (0.0, 0.5)])
    assert [index for index, _ in been.near_last_chord(1.0, 1.0)] == [0]
    been.keep(3)
    assert len(been.trials) == 3
    assert list(been.near_last_chord(1.0, 1.0)) == []


@dataclass(frozen=True)
class Planar:
    """The curve f(x, omega) = 0 in the plane, with what a branch asks of a balance and of Newton's method.

    f = y ((y - c)^2 / a^2 + (omega - m)^2 / b^2 - 1) with y = x - 1 - s (omega - m): the branch is the line y = 0, and
    an ellipse lies close beside it.
    """

    centre: float = 0.021
    half_y: float = 0.02
    half_w: float = 0.04
    middle: float = 10.5
    slope: float = 0.2

    def line(self, omega: float) -> float:
        """x of the branch."""
        return 1.0 + self.slope * (omega - self.middle)

    @property
    def compliance(self) -> Any:
        return SimpleNamespace(amplitude=lambda omega, load, deviation: deviation)

    @property
    def balance(self) -> Planar:
        return self

    def acting(self, relative: Any) -> Any:
        return relative.copy()

    def amplitude_slope(self, trial: Trial) -> Any:
        return np.zeros((1, 1))

    def evaluate(self, relative: Any, omega: float, load: float = 1.0) -> Trial:
        x = float(relative[0, 0])
        y = x - self.line(omega)
        return planar(x, omega, y * self.ellipse(y, omega))

    def ellipse(self, y: float, omega: float) -> float:
        return ((y - self.centre) / self.half_y) ** 2 + ((omega - self.middle) / self.half_w) ** 2 - 1.0

    def slopes(self, trial: Trial) -> tuple[float, float]:
        y, omega = float(trial.relative[0, 0]) - self.line(trial.omega), trial.omega
        by_y = self.ellipse(y, omega) + 2.0 * y * (y - self.centre) / self.half_y**2
        return by_y, 2.0 * y * (omega - self.middle) / self.half_w**2 - self.slope * by_y

    def border(self, trial: Trial, constraint: Constraint) -> Any:
        rows = np.array([self.slopes(trial), (float(constraint.weights[0, 0]), constraint.weight)])

        def solve(residual: Any, defect: float, tolerance: float) -> Any:
            dx, dw = np.linalg.solve(rows, [-float(residual[0, 0]), defect])
            return SimpleNamespace(relative=np.array([[dx]]), deviation=np.array([[dx]]), omega=float(dw))

        return SimpleNamespace(solve=solve)

    def correct(self, start: Trial, constraint: Constraint) -> Correction:
        trial = start
        for iteration in range(12):
            defect = constraint.defect(trial.relative, trial.omega)
            if trial.error < 1e-12 and abs(defect) < 1e-12:
                return Correction(trial, True, iteration, None)
            step = self.border(trial, constraint).solve(trial.residual, -defect, 0.0)
            trial = self.evaluate(trial.relative + step.relative, trial.omega + step.omega)
        return Correction(trial, False, 12, None)


def test_a_branch_beside_a_loop_is_followed_to_its_end() -> None:
    branch = Branch(cast(Newton, Planar()), planar(Planar().line(10.0), 10.0), 11.0, ContinuationSettings())
    points = list(branch)
    assert branch.complete
    assert points == branch.points
    assert branch.retreats == []


class Astray(Branch):
    """A branch that comes down on the ellipse once, as a long step may."""

    astray = False

    def _advance(self, point: Trial, tangent: Any, bend: Any, step: float) -> Any:
        if not self.astray and point.omega > Planar().middle - 0.03:
            self.astray = True
            curve = Planar()
            low = curve.evaluate(np.array([[1.0 + curve.centre - curve.half_y]]), curve.middle)
            constraint = self._constraint(low, tangent, 0.0)
            turned = self._direction_of(low, curve.border(low, constraint), 1.0)
            return Correction(low, True, 1, None), self._measure(low).unit(turned), 0.01, 0.01
        return super()._advance(point, tangent, bend, step)


def test_a_step_onto_a_loop_is_taken_back_after_one_turn() -> None:
    curve = Planar()
    branch = Astray(
        cast(Newton, curve), planar(Planar().line(10.0), 10.0), 11.0, ContinuationSettings(largest_step=0.02)
    )
    walked = sum(1 for _ in branch)
    assert branch.complete, branch.message
    assert len(branch.retreats) == 1
    assert branch.retreats[0] == pytest.approx(curve.middle / (2.0 * np.pi), rel=0.01)
    assert walked > len(branch.points) + 8  # the loop was walked, and is no part of the branch
    away = [float(point.trial.relative[0, 0]) - curve.line(point.trial.omega) for point in branch.points]
    assert max(map(abs, away)) < 1e-9
    omega = [point.trial.omega for point in branch.points]
    assert omega == sorted(omega)


class TurnedRound(Branch):
    """A branch that is turned round once, as at a corner finer than its steps."""

    turned = False

    def _advance(self, point: Trial, tangent: Any, bend: Any, step: float) -> Any:
        if not self.turned and point.omega > 10.6:
            self.turned = True
            tangent, bend = tangent.times(-1.0), bend.times(0.0)
        return super()._advance(point, tangent, bend, step)


def test_a_branch_that_turned_round_goes_on_where_it_did() -> None:
    settings = ContinuationSettings(largest_step=0.03)
    branch = TurnedRound(cast(Newton, Planar()), planar(Planar().line(10.0), 10.0), 11.0, settings)
    walked = sum(1 for _ in branch)
    assert branch.complete, branch.message
    assert len(branch.retreats) == 1
    assert branch.retreats[0] * 2.0 * np.pi == pytest.approx(10.6, abs=0.1)
    assert walked >= len(branch.points) + POINTS_BACK
    omega = [point.trial.omega for point in branch.points]
    assert omega == sorted(omega)


def solved(case: Case) -> tuple[ForcedResponse, Peak]:
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    model = build_model(case, setup.assemble(), joint)
    response = solve(case, model, threads=1)
    assert response.converged, response.message
    return response, summary(response, next(iter(model.outputs.values()))).peak


def test_a_corner_that_turns_back_does_not_lose_the_branch() -> None:
    """At 469.89 Hz the branch turns by 160 degrees, over less than 3e-4 of the window; shorter steps fail there."""
    case = Case().replace(
        {
            **COARSE_MESH,
            "preload.method": "solved",
            "preload.residual_traction": "kept",
            "geometry.excitation_height": "9 mm",
            "excitation.amplitude": "60 N",
            "roughness.fractal_roughness": "1e-9 m",
            "solver.harmonics": 3,
            "solver.samples": 256,
        }
    )
    response, found = solved(case)
    assert response.frequency_hz.size < 400
    assert found.amplitude == pytest.approx(102.71e-6, rel=1e-3)  # with 128 and 512 samples, which meet no such corner


def test_residual_tractions_make_loops_that_the_curve_of_two_blades_leaves_again() -> None:
    """Without a memory of where it was this curve ran round a loop at 455.9 Hz, beside pairs that stick, for ever."""
    case = Case().replace(
        {
            "solver.frequency_start": "405 Hz",
            "solver.frequency_stop": "535 Hz",
            "excitation.mode": "single",
            "excitation.amplitude": 5.0,
            "geometry.excitation_height": "18.35 mm",
            "preload.centrifugal_force": 50.0,
            "roughness.fractal_dimension": 2.35,
            "roughness.fractal_roughness": "1e-9 m",
            "friction.coefficient": 0.5,
        }
    )
    response, found = solved(case)
    assert response.frequency_hz.size < 400
    assert any("came back to where it had been" in sentence for sentence in response.warnings)
    assert found.amplitude == pytest.approx(59.87e-6, rel=1e-3)  # with 512 and 1024 samples, which meet no loop
    assert found.frequency_hz == pytest.approx(430.86, abs=0.02)
