"""A branch knows where it has been: points near its last chord, loops beside it, and its own way back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from plane_curves import PlaneCurve, PlanePoint, circle, corner, lemniscate, line_beside_an_ellipse, s_curve, step

from castings import casting_case
from sentences import printed_sentence
from stickslip.case.case import Case
from stickslip.model.model import build_model, load_joint, set_up
from stickslip.results.measures import summary
from stickslip.results.peaks import Peak
from stickslip.results.response import ForcedResponse
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Correction, Newton, NewtonSettings
from stickslip.solve.path.retreats import POINTS_BACK, Crossing, crossing_of
from stickslip.solve.path.stepping import Accepted, ContinuationSettings, Corner, Retreat
from stickslip.solve.path.visited import Visited
from stickslip.study.analyses import solve
from sweep_cases import COARSE_MESH


def visited(points: list[tuple[float, float]]) -> Visited[PlanePoint]:
    been: Visited[PlanePoint] = Visited()
    for x, y in points:
        been.add(PlanePoint(x, y, 0.0))
    return been


def test_the_chord_of_a_circle_passes_the_first_point_again_after_one_turn() -> None:
    angle = 2.0 * np.pi * np.arange(0, 21) / 20.5
    been = visited([(np.sin(a), np.cos(a)) for a in angle])
    actual = list(been.near_last_chord(1.0, 1.0))
    assert actual == []
    been.add(PlanePoint(float(np.sin(0.1)), float(np.cos(0.1)), 0.0))
    ((index, share),) = been.near_last_chord(1.0, 1.0)
    # Between the point at -pi / 20.5 (the last of the turn) and that at 0.1 lies the first one, at 0.
    assert index == 0
    assert share == pytest.approx((np.pi / 20.5) / (np.pi / 20.5 + 0.1), abs=0.01)


@pytest.mark.parametrize(("away", "near"), [(0.19, True), (0.21, False)])
def test_near_means_a_fifth_of_the_chord_in_the_scales_of_the_picture(away: float, near: bool) -> None:
    scale_u, scale_w = 1e-6, 600.0
    points = [(away * scale_u, 0.5), (5, 5), (5, 6), (5, 7), (5, 8), (0.0, 0.0), (0.0, 1.0)]
    been = visited([(x * (1.0 if x < 1 else scale_u), w * scale_w) for x, w in points])
    actual = list(been.near_last_chord(scale_u, scale_w))
    assert [index for index, _ in actual] == ([0] if near else [])


def test_neighbours_are_not_met_and_forgotten_points_neither() -> None:
    been = visited([(0.0, float(k)) for k in range(4)] + [(0.0, 2.9)])
    assert [index for index, _ in been.near_last_chord(1.0, 1.0)] == []
    been = visited([(0.0, 0.0), *((1.0, float(k)) for k in range(4)), (0.0, -0.5), (0.0, 0.5)])
    assert [index for index, _ in been.near_last_chord(1.0, 1.0)] == [0]
    been.truncate(3)
    assert len(been.points) == 3
    assert list(been.near_last_chord(1.0, 1.0)) == []


def branch_of(
    curve: PlaneCurve, start: PlanePoint, stop: float, settings: ContinuationSettings | None = None
) -> tuple[Branch[PlanePoint], list[Any]]:
    """A branch and the events of its walk, which follow."""
    events: list[Any] = []
    newton = Newton(curve, NewtonSettings(1e-12))
    return Branch(newton, start, stop, settings or ContinuationSettings(), events.append), events


def test_a_branch_passes_its_folds() -> None:
    branch, events = branch_of(s_curve(), s_curve().at(-2.0, -6.0), 6.0)
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    assert points[-1].y == 6.0
    assert points[-1].x == pytest.approx(2.0, abs=1e-9)
    assert [point.x for point in points] == sorted(point.x for point in points)
    assert max(abs(point.value) for point in points) <= 1e-10
    turns = [point.x for before, point, after in zip(points, points[1:], points[2:], strict=False)
             if (point.y - before.y) * (after.y - point.y) < 0]  # fmt: skip
    assert turns == pytest.approx([-1.0 / np.sqrt(3.0), 1.0 / np.sqrt(3.0)], abs=0.1)
    assert all(isinstance(event, Accepted) for event in events)
    assert events[-1].count == len(points)


def test_a_circle_leaves_through_its_start() -> None:
    branch, _ = branch_of(circle(), circle().at(0.6, 0.8), 2.0)
    points = [point.point for point in branch.follow()]
    assert not branch.complete
    printed_sentence(branch.message)
    # Half the circle above the start, in the order of the angle.
    angle = np.unwrap([np.arctan2(point.y, point.x) for point in points])
    assert (np.diff(angle) > 0).all()
    assert np.hypot([p.x for p in points], [p.y for p in points]) == pytest.approx(np.ones(len(points)), abs=1e-9)


def test_a_branch_that_starts_between_two_folds_comes_back() -> None:
    """It folds, leaves the range through its start, folds again and goes on to the stop."""
    curve = PlaneCurve(lambda x, y: x**3 - x - (y - 10.0), lambda x, y: (3.0 * x * x - 1.0, -1.0))
    branch, _ = branch_of(curve, curve.at(-1.0, 10.0), 11.0)
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    assert min(point.y for point in points) == pytest.approx(10.0 - 2.0 / 3.0**1.5, abs=0.02)
    assert [point.x for point in points] == sorted(point.x for point in points)
    assert points[-1].y == 11.0


def test_a_lemniscate_is_crossed_at_its_node() -> None:
    """At the node two branches cross; the one that goes straight on is followed, into the other leaf."""
    x = -0.3
    y = np.sqrt((-(2 * x * x - 1) + np.sqrt((2 * x * x - 1) ** 2 - 4 * (x**4 + x * x))) / 2)
    branch, _ = branch_of(lemniscate(), lemniscate().at(x, float(y)), -0.9)
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    assert points[-1].y == -0.9
    assert max(abs(point.value) for point in points) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("slope", [-8.0, -0.5, 0.2, 3.0, 30.0])
def test_corners_are_passed(slope: float) -> None:
    branch, _ = branch_of(corner(slope), corner(slope).at(0.0, 0.0), 1.0)
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    assert points[-1].x == pytest.approx(0.5 + 0.5 * slope)


class Lost(Branch[PlanePoint]):
    """A branch that no step takes on beyond y = 0.49 before it is found again."""

    def _advance(self, point: PlanePoint, tangent: Any, bend: Any, step: float, landmark: float | None = None) -> Any:
        return super()._advance(point, tangent, bend, step, landmark) if self._has_passed(point) else None

    def _around_corner(self, point: PlanePoint, tangent: Any) -> Any:
        return super()._around_corner(point, tangent) if self._has_passed(point) else None

    def _has_passed(self, point: PlanePoint) -> bool:
        self.message = "No step."
        return point.y < 0.49 or bool(self.crossings)


@pytest.mark.parametrize("height", [0.014, -0.014])
def test_a_branch_goes_on_close_beyond_a_place_that_no_step_passes(height: float) -> None:
    curve = step(0.55, height)
    branch = Lost(Newton(curve, NewtonSettings(1e-12)), curve.at(1.0, 0.0), 1.0, ContinuationSettings())
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    assert points[-1].x == pytest.approx(2.0 + height)
    (crossing,) = branch.crossings
    assert 0.49 < crossing.before < crossing.after < crossing.before + 0.01
    assert crossing.motion < 0.01
    assert crossing.left_out is None


def test_a_branch_does_not_go_on_far_beyond() -> None:
    curve = step(0.490001, 0.1)
    branch = Lost(Newton(curve, NewtonSettings(1e-12)), curve.at(1.49, 0.49), 1.0, ContinuationSettings())
    branch.follow()
    assert not branch.complete
    assert not branch.crossings
    assert branch.message == "No step."


def test_a_part_that_is_left_out_is_measured() -> None:
    points = [PlanePoint(x, y, 0.0) for x, y in ((1.0, 0.5), (1.5, 0.4), (1.2, 0.3), (1.01, 0.51))]
    crossing = crossing_of(points[:3], points[3])
    assert crossing == Crossing(0.5, 0.51, pytest.approx(0.01), 0.3, 1.5)  # type: ignore[arg-type]


def test_a_branch_beside_a_loop_is_followed_to_its_end() -> None:
    curve = line_beside_an_ellipse()
    branch, events = branch_of(curve, curve.at(0.9, 10.0), 11.0)
    points = branch.follow()
    assert branch.complete
    assert points == branch.points
    assert branch.retreats == []
    assert not any(isinstance(event, Retreat | Corner) for event in events)


class Astray(Branch[PlanePoint]):
    """A branch that comes down on the ellipse once, as a long step may."""

    astray = False

    def _advance(self, point: PlanePoint, tangent: Any, bend: Any, step: float, landmark: float | None = None) -> Any:
        if not self.astray and point.y > 10.47:
            self.astray = True
            low = line_beside_an_ellipse().at(1.0 + 0.021 - 0.02, 10.5)
            system = self._problem.linearised(low, self._corrector.plane(low, tangent, 0.0))
            turned = self._corrector.direction_of(low, system, 1.0)
            return Correction(low, True, 1, None), self._corrector.measure(low).unit(turned), 0.01, 0.01
        return super()._advance(point, tangent, bend, step, landmark)


def test_a_step_onto_a_loop_is_taken_back_after_one_turn() -> None:
    events: list[Any] = []
    curve = line_beside_an_ellipse()
    newton = Newton(curve, NewtonSettings(1e-12))
    settings = ContinuationSettings(largest_step=0.02)
    branch = Astray(newton, curve.at(0.9, 10.0), 11.0, settings, events.append)
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    (retreat,) = [event for event in events if isinstance(event, Retreat)]
    assert branch.retreats == [retreat.parameter]
    assert retreat.parameter == pytest.approx(10.5, rel=0.01)
    advance = sum(isinstance(event, Accepted) for event in events)
    assert advance > len(points) + 8  # the loop was walked, and is no part of the branch
    assert max(abs(point.x - 1.0 - 0.2 * (point.y - 10.5)) for point in points) < 1e-9
    assert [point.y for point in points] == sorted(point.y for point in points)


class TurnedRound(Branch[PlanePoint]):
    """A branch that is turned round once, as at a corner finer than its steps."""

    turned = False

    def _advance(self, point: PlanePoint, tangent: Any, bend: Any, step: float, landmark: float | None = None) -> Any:
        if not self.turned and point.y > 10.6:
            self.turned = True
            tangent, bend = tangent.times(-1.0), bend.times(0.0)
        return super()._advance(point, tangent, bend, step, landmark)


def test_a_branch_that_turned_round_continues_where_it_did() -> None:
    events: list[Any] = []
    curve = line_beside_an_ellipse()
    newton = Newton(curve, NewtonSettings(1e-12))
    settings = ContinuationSettings(largest_step=0.03)
    branch = TurnedRound(newton, curve.at(0.9, 10.0), 11.0, settings, events.append)
    points = [point.point for point in branch.follow()]
    assert branch.complete, branch.message
    assert len(branch.retreats) == 1
    assert branch.retreats[0] == pytest.approx(10.6, abs=0.1)
    assert sum(isinstance(event, Accepted) for event in events) >= len(points) + POINTS_BACK
    assert [point.y for point in points] == sorted(point.y for point in points)


def solved(case: Case) -> tuple[ForcedResponse, Peak]:
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    model = build_model(case, setup.assemble(), joint)
    response = solve(case, model, threads=1)
    assert response.converged, response.message
    return response, summary(response, next(iter(model.outputs.values()))).peak


@pytest.mark.long
def test_a_corner_that_turns_back_does_not_lose_the_branch() -> None:
    """At 469.89 Hz the branch turns by 160 degrees, over less than 3e-4 of the window; shorter steps fail there."""
    case = casting_case().replace(
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
    response, actual = solved(case)
    assert response.frequency_hz.size < 400
    assert actual.amplitude == pytest.approx(102.71e-6, rel=1e-3)  # with 128 and 512 samples, which meet no such corner


@pytest.mark.long
def test_a_curve_of_two_blades_with_loops_beside_it_is_complete() -> None:
    """Residual tractions make a loop at 455.9 Hz, beside pairs that stick; long steps run round it or pass it by."""
    case = casting_case().replace(
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
            "solver.harmonics": 3,
        }
    )
    response, actual = solved(case)
    assert response.frequency_hz.size < 400
    assert actual.amplitude == pytest.approx(61.40e-6, rel=1e-3)  # with 512 and 1024 samples, which meet no loop
    assert actual.frequency_hz == pytest.approx(430.74, abs=0.02)
