"""The resonance of a mass on one contact, the solver that is asked where its curve is lost, and lost curves made by
hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import stickslip as ss
from stickslip.solve import forced
from stickslip.solve.evidence import Evidence, Settling
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.work import Work
from stickslip.solve.pieces import Pieces


def resonance(settings: ss.ContinuationSettings, newtons: float = 10.0, **options: Any) -> ss.ForcedResponse:
    """A mass on springs and one contact that slips at the peak."""
    force = np.array([newtons, 0.0, 0.0])
    return ss.forced_response(
        ss.Superelement(np.eye(3), 4e6 * np.eye(3)),
        ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 2000.0),
        force,
        frequency_hz=(340.0, 370.0),
        samples=64,
        continuation=settings,
        **({"harmonics": 1, "modal_damping_ratio": 1e-3} | options),
    )


def lost_resonance() -> Settling:
    """The solver that a curve of the resonance would ask where it is lost."""
    found: list[Settling] = []

    class Known(Settling):
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            found.append(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(forced, "Settling", Known)
        resonance(ss.ContinuationSettings())
    return found[0]


SETTLES = Evidence(1.0, 20, 1e-6, 0.02, 1)


def point(hertz: float, motion: float = 1.0) -> Any:
    return SimpleNamespace(
        trial=SimpleNamespace(omega=2.0 * np.pi * hertz, amplitude=np.zeros((6, 1))),
        parameters=[2.0 * np.pi * hertz],
        measured=np.array([motion]),
    )


def branch(points: list[Any], stop: float, complete: bool) -> Any:
    return SimpleNamespace(
        points=[SimpleNamespace(point=each, iterations=1) for each in points],
        complete=complete,
        lost=not complete,
        ran_out=False,
        message=f"toward {stop / (2.0 * np.pi):.0f}",
        retreats=[],
        corners=[],
        crossings=[],
    )


class Solutions(Settling):
    """Knows the frequencies in Hz at which there are solutions, and their motion."""

    def __init__(self, first: float, last: float, motion: float) -> None:
        self._first, self._last, self._motion = first, last, motion
        self.work = Work(most=100.0)

    def solution(self, near: Any, omega: float, ramp: bool) -> Any:
        hertz = omega / (2.0 * np.pi)
        return (point(hertz, self._motion), "by a guess") if self._first <= hertz <= self._last else None

    def evidence(self, point: Any, change: float, thorough: bool = False) -> Evidence:
        return SETTLES

    def evidence_from_rest(self, omega: float, thorough: bool = False) -> Evidence:
        return Evidence(1.0, 20, 0.3, None, None)


def pieces(first: float, last: float, motion: float, lowest: float) -> Pieces[Any]:
    """From 100 to 200 Hz; the branch from 100 ends at 150, others reach down to ``lowest``, with a ``motion``."""

    def part(start: Any, stop: float) -> Any:
        begin, end = start.trial.omega / (2.0 * np.pi), stop / (2.0 * np.pi)
        if begin == 100.0:
            return branch([point(each) for each in (100.0, 125.0, 150.0)], stop, complete=False)
        reached = max(end, lowest) if end < begin else end
        return branch([point(each, motion) for each in (begin, reached)], stop, complete=reached == end)

    window = 2.0 * np.pi * 100.0, 2.0 * np.pi * 200.0
    return Pieces(cast(Any, part), window, Solutions(first, last, motion))


def hertz_of(curve: Pieces[Any]) -> list[float]:
    return [each.point.trial.omega / (2.0 * np.pi) for each in curve.points]


def loses_once(beyond: float, events: list[str]) -> type[Branch[Any]]:
    """A class of branches of which the first is lost beyond a parameter."""

    class LostOnce(Branch[Any]):
        def _advance_to_landmark(self, point: Any, *others: Any) -> Any:
            if not events and point.trial.omega > beyond:
                events.append("lost")
                self.message = "No step."
                return None
            return super()._advance_to_landmark(point, *others)

        def _around_corner(self, point: Any, tangent: Any) -> Any:
            return None if events == ["lost"] else super()._around_corner(point, tangent)

        def _beyond(self) -> Any:
            if events == ["lost"]:
                events.append("goes on elsewhere")
                return None
            return super()._beyond()

    return LostOnce
