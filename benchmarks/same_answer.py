"""Whether a problem has one answer: swept upward and downward, with one and four threads, with twice the samples.

    python benchmarks/same_answer.py FOLDER [--classes beam,light] [--seeds 0:3] [--residual-traction kept]

Solves problems of the torture set (torture_problems.py), each four times, and compares the curves of the output with
that of the default. FOLDER receives one file for each problem, so an interrupted run resumes. One table by class, and a
line for each difference.

How curves are compared: a point of one curve has a distance to the other one, a polyline, in the plane (frequency over
the range, amplitude over the largest one). Points differ, since each sweep has steps of its own, so only the shape
counts. Left out are the ranges of frequency in which one of the curves folds, with a margin: there a sweep may follow
either of several motions. A difference is a distance above 1 % of the plane; a chord of the default steps is nearer
to its arc (an arc of 0.08 that turns by 15 degrees rises by 0.003). But the mass norm, not this output, measures the
steps, so one curve may pass over a detail of the output where the other one has points. A difference is therefore
compared again: both ways with a quarter of the largest step. If those curves agree, both are one branch, and the
difference counts as one of "steps". With four threads the points must be the same, to
1e-6 of the largest amplitude; where round-off changes a step, the shape counts again.

Kept tractions (``--residual-traction kept``) make a continuum of solutions: a pair that sticks all period may hold any
admissible mean traction, and the branch decides which. A difference counts as "continuum" and not as a contradiction
if, at the places that differ, some pair sticks on both curves and its mean tractions differ by more than 1e-6 of its
friction limit. A released pair that sticks holds no mean traction, so released problems have no such excuse.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, get_args

import numpy as np
from torture import Results, Settings, chosen, class_names, report, seed_range
from torture_problems import KINDS, Problem, ResidualTraction, make
from torture_structures import FloatArray

import stickslip as ss

ALLOWED, SAME_POINT = 1e-2, 1e-6  # distances in the plane
FOLD_MARGIN = 0.02  # of the range, at both ends of a fold
FINER = 4.0  # shorter steps, with which a difference is compared again
SAME_TRACTION = 1e-6  # of the friction limit
WAYS = ("downward", "four threads", "twice the samples")
COUNTED = ("same", "steps", "continuum", "different")
Row = dict[str, Any]
Compare = Callable[[Problem, ss.ForcedResponse, ss.ForcedResponse], "Comparison"]


@dataclass(frozen=True)
class Comparison:
    """How a curve compares with the default one: verdict, largest distance in the plane, and its frequency in Hz."""

    verdict: str  # "same", "steps", "continuum", "different", "not complete", "folds everywhere"
    distance: float
    frequency_hz: float


def folded_ranges(frequency_hz: FloatArray, margin_hz: float) -> list[tuple[float, float]]:
    """Ranges of frequency in which a curve goes back, with a margin."""
    step = np.diff(frequency_hz) * np.sign(frequency_hz[-1] - frequency_hz[0])
    return [
        (float(min(pair)) - margin_hz, float(max(pair)) + margin_hz)
        for pair in zip(frequency_hz[:-1][step < 0.0], frequency_hz[1:][step < 0.0], strict=True)
    ]


def outside(frequency_hz: FloatArray, ranges: Sequence[tuple[float, float]]) -> np.ndarray[Any, Any]:
    """(n,) which frequencies are in none of the ranges."""
    answer = np.ones(frequency_hz.size, dtype=bool)
    for low, high in ranges:
        answer &= (frequency_hz < low) | (frequency_hz > high)
    return answer


def distances(points: FloatArray, line: FloatArray) -> FloatArray:
    """(n,) distances of points (n, 2) to a polyline (m, 2)."""
    starts, chords = line[:-1], np.diff(line, axis=0)
    squares = np.maximum((chords**2).sum(axis=1), 1e-300)
    away = points[:, None, :] - starts
    share = np.clip((away * chords).sum(axis=2) / squares, 0.0, 1.0)
    gaps = away - share[:, :, None] * chords
    return np.asarray(np.sqrt((gaps**2).sum(axis=2)).min(axis=1))


class Plane:
    """The plane of the picture of a problem."""

    def __init__(self, problem: Problem, base: ss.ForcedResponse) -> None:
        self._output = problem.structure.output
        self.low_hz, self.high_hz = sorted(problem.window_hz)
        self._height = float(base.amplitude(self._output).max())

    def line(self, response: ss.ForcedResponse) -> FloatArray:
        """(n, 2) the points of a curve."""
        across = (response.frequency_hz - self.low_hz) / (self.high_hz - self.low_hz)
        return np.column_stack([across, response.amplitude(self._output) / self._height])


def compare(problem: Problem, base: ss.ForcedResponse, other: ss.ForcedResponse) -> Comparison:
    """The comparison of a curve with that of the default; see the head of this file."""
    if not (base.converged and other.converged):
        return Comparison("not complete", float("nan"), float("nan"))
    plane = Plane(problem, base)
    margin_hz = FOLD_MARGIN * (plane.high_hz - plane.low_hz)
    folds = [fold for each in (base, other) for fold in folded_ranges(each.frequency_hz, margin_hz)]
    worst, verdict = (0.0, float("nan")), ""
    for one, two in ((other, base), (base, other)):
        simple = outside(one.frequency_hz, folds)
        if not simple.any():
            continue
        away = distances(plane.line(one)[simple], plane.line(two))
        places = one.frequency_hz[simple]
        verdict = verdict or "same"
        worst = max(worst, (float(away.max()), float(places[away.argmax()])), key=lambda each: each[0])
        if away.max() > ALLOWED and verdict != "different":
            differ = places[away > ALLOWED]
            verdict = "continuum" if all(other_tractions(problem, one, two, hertz) for hertz in differ) else "different"
    return Comparison(verdict or "folds everywhere", *worst)


def other_tractions(problem: Problem, one: ss.ForcedResponse, two: ss.ForcedResponse, hertz: float) -> bool:
    """Whether a pair sticks on both curves at a frequency with other mean tractions."""
    if one.pairs.released:
        return False
    stuck, tractions = [], []
    for each in (one, two):
        point = int(np.abs(each.frequency_hz - hertz).argmin())
        mean = (problem.structure.operator @ each.displacement[point, :, 0]).reshape(-1, 3)[:, :2]
        tractions.append(problem.tangential_stiffness * mean)
        stuck.append(each.contact_state[point] == ss.ContactState.STUCK)
    change = np.linalg.norm(tractions[0] - tractions[1], axis=1)
    limit = problem.friction_coefficient * np.maximum(problem.preload, 0.0)
    return bool((stuck[0] & stuck[1] & (change > SAME_TRACTION * limit)).any())


def compare_threads(problem: Problem, base: ss.ForcedResponse, other: ss.ForcedResponse) -> Comparison:
    """As :func:`compare`, but the points themselves must agree, unless round-off changed a step."""
    plane = Plane(problem, base)
    if base.n_points != other.n_points:
        return compare(problem, base, other)
    away = np.abs(plane.line(base) - plane.line(other)).max(axis=1)
    if away.max() > SAME_POINT:
        return compare(problem, base, other)
    worst = int(away.argmax())
    return Comparison("same", float(away[worst]), float(base.frequency_hz[worst]))


def answers(problem: Problem, settings: Settings) -> dict[str, Comparison]:
    """The comparisons of a problem by the way in which it was solved again."""

    def solve(**options: Any) -> ss.ForcedResponse:
        return problem.solve(settings.residual_traction, harmonics=settings.harmonics, **options)

    base, fine = solve(), cache(lambda: solve(continuation=short_steps()))
    ways: tuple[tuple[str, Compare, dict[str, Any]], ...] = (
        (WAYS[0], compare, {"window_hz": (problem.window_hz[1], problem.window_hz[0])}),
        (WAYS[1], compare_threads, {"threads": 4}),
        (WAYS[2], compare, {"samples": 256}),
    )
    compared = {}
    for way, comparison, options in ways:
        found = comparison(problem, base, solve(**options))
        if found.verdict == "different":
            again = compare(problem, fine(), solve(**options, continuation=short_steps()))
            found = replace(found, verdict="steps") if again.verdict == "same" else found
        compared[way] = found
    return compared


def short_steps() -> ss.ContinuationSettings:
    """Steps with which a difference is compared again."""
    default = ss.ContinuationSettings()
    return replace(default, largest_step=default.largest_step / FINER, first_step=default.first_step / FINER)


def row_of(kind: str, seed: int, settings: Settings) -> Row:
    """The comparisons of a problem as plain data; none if a curve has no first point."""
    begin = time.process_time()
    try:
        compared = {way: asdict(each) for way, each in answers(make(kind, seed), settings).items()}
    except ss.ConvergenceError:
        missing = asdict(Comparison("not complete", float("nan"), float("nan")))
        compared = dict.fromkeys(WAYS, missing)
    return {"kind": kind, "seed": seed, "seconds": time.process_time() - begin} | compared


def table(rows: Sequence[Row]) -> list[str]:
    """Lines of the table by class: for each way the verdicts of the compared, and the largest distance of the same."""
    words = " / ".join(COUNTED)
    head = ["class", "problems", *(f"{way}: {words} (not complete)" for way in WAYS), "largest"]
    lines = [head, ["---"] * len(head)]
    for kind in [*(kind for kind in KINDS if any(row["kind"] == kind for row in rows)), "all"]:
        those = [row for row in rows if kind in (row["kind"], "all")]
        counts = []
        for way in WAYS:
            verdicts = [row[way]["verdict"] for row in those]
            numbers = [verdicts.count(name) for name in COUNTED]
            counts.append(f"{' / '.join(map(str, numbers))} ({len(verdicts) - sum(numbers)})")
        largest = max(
            (row[way]["distance"] for row in those for way in WAYS if row[way]["verdict"] == "same"), default=0
        )
        lines.append([kind, str(len(those)), *counts, f"{largest:.1e}"])
    return ["| " + " | ".join(line) + " |" for line in lines]


def differences(rows: Sequence[Row]) -> list[str]:
    """A line for each difference."""
    return [
        f"{row['kind']} {row['seed']}, {way}: {row[way]['verdict']}, {row[way]['distance']:.2g} of the plane at "
        f"{row[way]['frequency_hz']:.3f} Hz"
        for row in rows
        for way in WAYS
        if row[way]["verdict"] in (*COUNTED[1:], "folds everywhere")
    ]


def main() -> None:
    """Solve, compare, print."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--classes", type=class_names, default=KINDS, help="names with commas; default: all")
    parser.add_argument("--seeds", type=seed_range, help="FIRST:END, for example 0:8; default: all")
    parser.add_argument("--harmonics", type=int, default=3)
    parser.add_argument("--residual-traction", choices=get_args(ResidualTraction), default="released")
    options = parser.parse_args()
    settings = Settings(options.harmonics, options.residual_traction)
    results, problems = Results(options.folder, settings), chosen(options.classes, options.seeds)
    for count, (kind, seed) in enumerate(problems, start=1):
        if results.read(kind, seed) is None:
            row = row_of(kind, seed, settings)
            results.write(row)
            words = ", ".join(row[way]["verdict"] for way in WAYS)
            report(f"{count}/{len(problems)} {kind} {seed}: {words}, {row['seconds']:.1f} s")
    rows = [row for row in (results.read(kind, seed) for kind, seed in problems) if row is not None]
    rows.sort(key=lambda row: (KINDS.index(row["kind"]), row["seed"]))
    print("\n".join([*table(rows), "", *differences(rows)]))
    sys.exit(any(row[way]["verdict"] == "different" for row in rows for way in WAYS))


if __name__ == "__main__":
    main()
