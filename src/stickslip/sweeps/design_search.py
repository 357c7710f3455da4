"""The search of a design: samples of the box, descents from the best of them, and the neighbourhood of the optimum."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.results.design import (
    COST,
    SAME_PLACE,
    SAME_VALUE,
    Evaluation,
    Sharpness,
    StartResult,
    crossing,
    shape_of,
)
from stickslip.sweeps.design_cases import DesignCases, Request
from stickslip.sweeps.design_functions import DesignFunctions
from stickslip.sweeps.minimax import Descent, descend, in_step

FIRST_DISTANCE = 1.0 / 64.0  # chosen: of the range of a key; each further one is twice as far
STARTS_APART = 0.1  # chosen: of the diagonal of the box
LOWER_BY = 1e-3  # a design beside the optimum that is lower by this fraction starts another descent
MOST_ROUNDS = 3  # chosen: descents from a better design beside the optimum


def search(cases: DesignCases, samples: int, starts: int) -> tuple[list[StartResult], list[Sharpness]]:
    """Samples, descents, and the neighbourhood of the best design; none of the latter without an allowed design."""
    space = cases.space
    points = list(space.samples(samples))
    if space.start is not None:
        points.insert(0, space.start)
    evaluations = cases.evaluate([Request(point, "sample") for point in points])
    descents = _descents(cases, _chosen_starts(evaluations, starts))
    sharpness: list[Sharpness] = []
    for _ in range(MOST_ROUNDS):
        best = _best(cases.evaluations)
        if best is None:
            break
        sharpness = _neighbourhood(cases, best)
        lower = _best(cases.evaluations)
        assert lower is not None  # at least ``best``
        if lower.objective > best.objective * (1.0 - LOWER_BY):
            break
        descents += _descents(cases, [lower], len(descents))
    return _results(cases.evaluations, descents), sharpness


def _best(evaluations: Sequence[Evaluation]) -> Evaluation | None:
    """The best design that satisfies all limits."""
    allowed = [each for each in evaluations if each.is_allowed]
    return min(allowed, key=lambda each: each.objective, default=None)


def best_place(evaluations: Sequence[Evaluation]) -> int | None:
    """The position of the optimum among all evaluations."""
    best = _best(evaluations)
    return None if best is None else best.number - 1


def _chosen_starts(evaluations: Sequence[Evaluation], count: int) -> list[Evaluation]:
    """The best samples that are apart from each other."""
    chosen: list[Evaluation] = []
    for each in sorted((one for one in evaluations if not one.failure), key=lambda one: one.rank):
        at = np.array(each.coordinates)
        apart = STARTS_APART * np.sqrt(at.size)
        if len(chosen) < count and all(np.linalg.norm(at - other.coordinates) >= apart for other in chosen):
            chosen.append(each)
    return chosen


def _descents(
    cases: DesignCases, starts: Sequence[Evaluation], before: int = 0
) -> list[tuple[Evaluation, list[Evaluation], Descent]]:
    """Descents from evaluated designs, all at a time; their visited designs and ends."""

    def task(number: int, start: Evaluation, ask: Any) -> tuple[Evaluation, list[Evaluation], Descent]:
        functions = DesignFunctions(cases, ask, f"start {number}")
        descent = descend(np.array(start.coordinates), functions.values, functions.slopes)
        return start, functions.visited, descent

    def answer(requests: list[list[Request]]) -> list[list[Evaluation]]:
        flat = iter(cases.evaluate([each for row in requests for each in row]))
        return [[next(flat) for _ in row] for row in requests]

    tasks = [partial(task, before + place + 1, start) for place, start in enumerate(starts)]
    return in_step(tasks, answer)


def _results(
    evaluations: Sequence[Evaluation], descents: Sequence[tuple[Evaluation, list[Evaluation], Descent]]
) -> list[StartResult]:
    """The ends of the descents beside the best one."""
    ends = [min(visited, key=lambda each: each.rank) for _, visited, _ in descents]
    best = min(ends, key=lambda each: each.rank, default=None)
    results = []
    for (start, _, descent), end in zip(descents, ends, strict=True):
        assert best is not None
        same_value = end.excess == best.excess == 0.0 and end.objective <= best.objective * (1.0 + SAME_VALUE)
        apart = np.abs(np.subtract(end.coordinates, best.coordinates)).max()
        same_place = bool(same_value and apart <= SAME_PLACE)
        results.append(StartResult(start.number - 1, end.number - 1, descent.message, bool(same_value), same_place))
    return results


def _neighbourhood(cases: DesignCases, best: Evaluation) -> list[Sharpness]:
    """The objective along each key on both sides of the optimum, until it is 5 % higher or the range ends."""
    sides = {(place, sign): _Side(best, place, sign) for place in range(len(cases.space.keys)) for sign in (-1.0, 1.0)}
    while open_sides := [side for side in sides.values() if side.next_point() is not None]:
        points = [side.next_point() for side in open_sides]
        evaluations = cases.evaluate([Request(point, "sharpness") for point in points if point is not None])
        for side, evaluation in zip(open_sides, evaluations, strict=True):
            side.rows.append(evaluation)
    return [_sharpness(cases, best, sides[place, -1.0], sides[place, 1.0]) for place in range(len(cases.space.keys))]


class _Side:
    """Designs to one side of the optimum along a key, each twice as far as the one before."""

    def __init__(self, best: Evaluation, place: int, sign: float) -> None:
        self._best, self.place, self._sign = best, place, sign
        self.rows: list[Evaluation] = []

    def next_point(self) -> FloatArray | None:
        """The next design; None if the objective is 5 % higher, the design failed, or the range ends."""
        at = self._best.coordinates[self.place]
        room = at if self._sign < 0.0 else 1.0 - at
        if self.rows:
            last = self.rows[-1]
            is_enough = len(self.rows) > 1  # two, for the shape
            reached = abs(last.coordinates[self.place] - at)
            if last.failure or reached >= room - 1e-9 or (is_enough and last.objective >= COST * self._best.objective):
                return None
        if room <= 1e-9:
            return None
        point = np.array(self._best.coordinates)
        point[self.place] = at + self._sign * min(room, FIRST_DISTANCE * 2.0 ** len(self.rows))
        return point

    def crossing(self) -> float | None:
        """The distance in coordinates at which the objective is 5 % higher."""
        at = self._best.coordinates[self.place]
        distance = [abs(each.coordinates[self.place] - at) for each in self.rows]
        return crossing(distance, [each.objective / self._best.objective for each in self.rows])


def _sharpness(cases: DesignCases, best: Evaluation, below: _Side, above: _Side) -> Sharpness:
    place = below.place
    key = cases.space.keys[place]
    rows = [*reversed(below.rows), best, *above.rows]
    at = np.array([each.coordinates[place] for each in rows])
    objective = np.array([each.objective for each in rows])
    optimum = best.coordinates[place]
    lower, upper = below.crossing(), above.crossing()
    return Sharpness(
        key.name,
        np.array([each.values[place] for each in rows]),
        objective,
        np.array([each.excess for each in rows]),
        None if lower is None else key.at(optimum - lower),
        None if upper is None else key.at(optimum + upper),
        shape_of(key, optimum, at, objective / best.objective),
    )
