"""Verdicts on stability against time integration: does a disturbance of 1 % die out? One table, problem by problem.

    python benchmarks/stability_check.py            # all problems, about forty minutes
    python benchmarks/stability_check.py duffing    # those whose name begins so

Points are the neighbours of each bifurcation and some spread over the curve. On the torture set 3 harmonics find the
changes of the verdict, and short curves around some of them, with more harmonics, have the points. One motion starts at
the point, another 1 % too large, for as many periods as a disturbance with the largest multiplier requires to grow
or decay by the factor GROWTH: ``log(GROWTH) / |log |multiplier||``, at least LEAST_PERIODS and at most MOST_PERIODS.
The verdict does not enter, so a wrong one gets no time that suits it. Then the disturbance

* "leaves" if the two are farther apart than FAR, or if the motion that starts at the point changes from period to
  period more than REMAINS times as much in the last part of the time, or GREW times as much in any part, as in a part
  before: another motion can be so near that a disturbance of 1 % does not tell them apart; or if this motion never
  repeats: in the last part of the time it changes by more than NEAR from each period to the next;
* is on "another motion" if the two are closer than NEAR, but farther than ELSEWHERE from the point, without a growth:
  the point is no motion of the equation, so this says nothing about its stability;
* "cannot tell" if the multiplier requires more than MOST_PERIODS: what has not left until then may leave later;
* "dies out" if the two are closer than NEAR, and closer than ELSEWHERE to the point;
* is "unclear" else.

A contradiction is a stable point that leaves, or an unstable one where the disturbance dies out, also with FINER times
the steps of a period (the numerical dissipation of the scheme damps chatter with few steps). Points whose verdict
the program calls doubtful are counted apart, with what became of them.
"""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from stability_problems import PROBLEMS, FloatArray, Problem, solve

import stickslip as ss
from stickslip.solve.transient.integrate import TransientResponse

DISTURBANCE = 0.01
# Distances over the size of the motion. What remains between the two motions is the shift of tractions that stuck pairs
# keep from the disturbance, up to about its size. From the point both differ by the error of the balance, up to 4 %
# beside the folds of the blade with half its preload; other stable motions are farther than 25 % away.
NEAR, FAR, ELSEWHERE = 0.006, 0.02, 0.1
# The largest changes are compared: the first two, then in PARTS of the time. At stable points of twins 0 they grow by
# up to 5 before they decay. Beside its torus they fall at first and then grow, to less than at first. Changes below the
# third number are an error of the time steps.
REMAINS, GREW, SMALLEST_CHANGE, PARTS = 3.0, 10.0, 1e-5, 8
FINER = 4
MOST_CHANGES = 3
SPREAD = 3  # points of a curve beside those at its bifurcations
# A disturbance of the whole motion may contain a thousandth of the one that grows: with a growth of 20, none seemed to
# leave two unstable points of high 0. chosen: the largest number of periods reaches multipliers that differ from 1 by
# 0.0004 and takes half a minute of processor time for each motion of ten unknowns.
GROWTH, LEAST_PERIODS, MOST_PERIODS = 3000.0, 80, 20_000
# chosen: near round-off. A larger one takes a slow departure for a motion that repeats.
SETTLED = 1e-12
# Random problems: harmonics and samples that find the changes of the verdict, and the range around one in points.
COARSE, BESIDE = (3, 128), 3


@dataclass(frozen=True)
class Checked:
    """A point: what the multipliers say, and what happened in time."""

    problem: str
    beside: str  # kind of the nearest change of the number of multipliers outside of the circle
    frequency_hz: float
    multiplier: complex
    stable: bool
    doubtful: bool
    apart: float
    away: float
    leaves: bool

    @property
    def outcome(self) -> str:
        """What became of the disturbance."""
        if self.apart > FAR or self.leaves:
            return "leaves"
        if self.apart < NEAR and self.away > ELSEWHERE:
            return "another motion"
        if periods_required(self.multiplier) > MOST_PERIODS:
            return "cannot tell"
        return "dies out" if self.apart < NEAR else "unclear"

    @property
    def contradicts(self) -> bool:
        """Whether time integration shows the opposite of a verdict that the program does not call doubtful."""
        return not self.doubtful and self.outcome == ("leaves" if self.stable else "dies out")

    @property
    def count(self) -> str:
        """The column of the table of counts."""
        if self.doubtful:
            return "doubtful"
        if self.contradicts:
            return "contradiction"
        return "agreement" if self.outcome in ("leaves", "dies out") else self.outcome


def chosen_points(response: ss.ForcedResponse) -> list[int]:
    """Both neighbours of each bifurcation, two points farther away, and some spread over the curve."""
    last = response.n_points - 1
    points = set(np.linspace(0.15 * last, 0.85 * last, SPREAD).round().astype(int).tolist())
    for each in response.bifurcations:
        points |= {max(0, int(each.position) - 2), min(last, int(each.position) + 3)}
    return sorted(points)


def points_beside_a_change(response: ss.ForcedResponse) -> list[int]:
    """The middle ones of the parts with one verdict before and after a change, that between the longest parts."""
    assert response.stable is not None
    ends = np.flatnonzero(response.stable[1:] != response.stable[:-1]) + 1
    parts = np.split(np.arange(response.n_points), ends)
    if len(parts) == 1:
        return [response.n_points // 2]
    first = max(range(len(parts) - 1), key=lambda each: min(parts[each].size, parts[each + 1].size))
    return [int(parts[each][parts[each].size // 2]) for each in (first, first + 1)]


def kind_beside(response: ss.ForcedResponse, point: int) -> str:
    """The kind of the bifurcation nearest to a point along the curve."""
    nearest = sorted(response.bifurcations, key=lambda each: abs(each.position - point))
    return nearest[0].kind if nearest else ""


def parts_of(problem: Problem) -> Iterator[tuple[ss.ForcedResponse, list[int]]]:
    """The curve of a problem with its chosen points; of a random one short curves around changes of the verdict."""
    if not problem.is_random:
        response = solve(problem)
        yield response, chosen_points(response)
        return
    coarse = solve(replace(problem, harmonics=COARSE[0], samples=COARSE[1]))
    assert coarse.stable is not None
    changes, last = np.flatnonzero(coarse.stable[1:] != coarse.stable[:-1]), coarse.n_points - 1
    if not changes.size:
        changes = np.array([int(coarse.amplitude(np.eye(coarse.n_unknowns)[0]).argmax())])
    for change in changes[np.linspace(0, changes.size - 1, min(changes.size, MOST_CHANGES)).round().astype(int)]:
        hertz = coarse.frequency_hz[max(0, change - BESIDE) : min(last, change + BESIDE) + 1]
        window = (float(hertz.min()), float(hertz.max()))
        response = solve(replace(problem, window_hz=window if hertz[0] < hertz[-1] else window[::-1]))
        yield response, points_beside_a_change(response)


def periods_required(multiplier: complex) -> int:
    """In which a disturbance grows or decays by GROWTH; the same for a multiplier and its inverse."""
    rate = abs(math.log(max(abs(multiplier), 1e-3)))
    return max(LEAST_PERIODS, math.ceil(math.log(GROWTH) / max(rate, 1e-9)))


def motion_from(problem: Problem, response: ss.ForcedResponse, point: int, disturbance: float) -> TransientResponse:
    """Some periods from a point whose motion starts too large."""
    start = ss.start_from_response(response, point)
    mean = response.displacement[point][:, 0]
    start["initial_displacement"] = mean + (1.0 + disturbance) * (start["initial_displacement"] - mean)
    start["initial_velocity"] = (1.0 + disturbance) * start["initial_velocity"]
    sine = np.zeros_like(problem.force_cos) if problem.force_sin is None else problem.force_sin
    assert response.multipliers is not None
    periods = min(MOST_PERIODS, periods_required(complex(response.multipliers[point, 0])))
    return ss.integrate_to_steady_state(
        problem.superelement, problem.pairs, problem.force_cos, sine, float(response.frequency_hz[point]),
        steps_per_period=problem.steps, max_periods=periods, tolerance=SETTLED, **start,
    )  # fmt: skip


def has_left(changes: FloatArray, walks: bool = False) -> bool:
    """Whether a motion leaves, by its changes from period to period; entry 0 compares with rest. A body that ``walks``
    changes its place in each period by as much as in the first ones."""
    parts = [changes[1:3], *(part for part in np.array_split(changes[3:], PARTS) if part.size)]
    largest = np.maximum([part.max() for part in parts], SMALLEST_CHANGE)
    rises = largest / np.minimum.accumulate(largest)
    repeats = NEAR + (parts[0].max() if walks else 0.0)
    return bool(rises[-1] > REMAINS or rises.max() > GREW or parts[-1].min() > repeats)


def distances_after(problem: Problem, response: ss.ForcedResponse, point: int) -> tuple[float, float, bool]:
    """Distance of the two motions after some periods, and of the farther one from the point, over its size;
    whether the first one leaves the point."""
    expected = np.array([response.signal(row, point, problem.steps) for row in np.eye(response.n_unknowns)]).T
    motions = [motion_from(problem, response, point, size) for size in (0.0, DISTURBANCE)]
    quiet, disturbed = (motion.displacement for motion in motions)

    # Where a body comes to rest, or walks to, is not determined if friction alone supports it; the swing is.
    times = np.linspace(0.0, 1.0, problem.steps, endpoint=False)
    still = np.vander(times, 1 if response.walk is None else 2)
    swing = np.eye(problem.steps) - still @ np.linalg.pinv(still)

    def size(motion: FloatArray) -> float:
        return float(np.linalg.norm(swing @ motion))

    away = max(size(quiet - expected), size(disturbed - expected))
    leaves = has_left(motions[0].period_change, walks=response.walk is not None)
    return size(disturbed - quiet) / size(expected), away / size(expected), leaves


def check(problem: Problem, points: Sequence[int] | None = None) -> Iterator[Checked]:
    """The chosen points of a problem, or those given of its curve."""
    for response, chosen in parts_of(problem) if points is None else [(solve(problem), points)]:
        assert response.stable is not None, response.stability_message
        assert response.multipliers is not None
        assert response.doubtful is not None
        for point in chosen:
            found = Checked(
                problem.name,
                kind_beside(response, point),
                float(response.frequency_hz[point]),
                complex(response.multipliers[point, 0]),
                bool(response.stable[point]),
                bool(response.doubtful[point]),
                *distances_after(problem, response, point),
            )
            if found.contradicts:
                finer = replace(problem, steps=FINER * problem.steps)
                apart, away, leaves = distances_after(finer, response, point)
                found = replace(found, apart=apart, away=away, leaves=leaves)
            yield found


def main() -> None:
    """Print the table and the number of contradictions."""
    wanted = sys.argv[1] if len(sys.argv) > 1 else ""
    every: list[Checked] = []
    print(
        "| problem | beside | Hz | largest multiplier | verdict | apart, % | from the point, % | leaves | disturbance |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name, make in PROBLEMS.items():
        if not name.startswith(wanted):
            continue
        began = time.perf_counter()
        for each in check(make(name)):
            every.append(each)
            verdict = ("doubtful, " if each.doubtful else "") + ("stable" if each.stable else "unstable")
            mark = " (CONTRADICTION)" if each.contradicts else ""
            leaves = "yes" if each.leaves else "no"
            print(
                f"| {name} | {each.beside} | {each.frequency_hz:.6g} | {each.multiplier:.4f} | {verdict} | "
                f"{100 * each.apart:.2g} | {100 * each.away:.2g} | {leaves} | {each.outcome}{mark} |",
                flush=True,
            )
        print(f"{name}: {time.perf_counter() - began:.0f} s", file=sys.stderr)
    counts = Counter(each.count for each in every)
    print(f"\n{len(every)} points, {counts['contradiction']} contradictions; {dict(counts)}.")


if __name__ == "__main__":
    main()
