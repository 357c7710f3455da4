"""Verdicts on stability against time integration: does a disturbance of 1 % die out? One table, problem by problem.

    python benchmarks/stability_check.py            # all problems, about forty minutes
    python benchmarks/stability_check.py duffing    # those whose name begins so

Points are the neighbours of each bifurcation and some spread over the curve. On the torture set 3 harmonics find the
changes of the verdict, and short curves around some of them, with more harmonics, have the points. One motion starts at
the point, another 1 % too large. After a number of periods that its largest multiplier requires, the disturbance

* "leaves" if the two are farther apart than FAR, or if the motion that starts at the point changes from period to
  period more than REMAINS times as much in the last part of the time, or GREW times as much in any part, as in a part
  before: another motion can be so near that a disturbance of 1 % does not tell them apart;
* "dies out" if the two are closer than NEAR, and closer than ELSEWHERE to the point;
* is on "another motion" if the two are closer than NEAR, but farther than ELSEWHERE from the point, without a growth:
  the point is no motion of the equation, so this says nothing about its stability;
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
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from blade_problem import load_blade_problem
from rough_casting import rough_casting
from torture_problems import make as torture_problem
from torture_problems import modal_damping_matrix, modes_of, with_springs

import stickslip as ss
from stickslip.solve.transient.integrate import TransientResponse

FloatArray = np.ndarray
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
# Periods: a disturbance with the largest multiplier falls to exp(-DECAY) at a stable point and grows by exp(GROWTH) at
# an unstable one. A disturbance of the whole motion may contain a thousandth of the one that grows: with exp(3), none
# seemed to leave two unstable points of high 0. At least LEAST_PERIODS and at most those of the problem.
DECAY, GROWTH, LEAST_PERIODS = 3.0, 8.0, 80
# Random problems: harmonics and samples that find the changes of the verdict, and the range around one in points.
COARSE, BESIDE = (3, 128), 3


@dataclass(frozen=True)
class Problem:
    """A structure with a joint, its force, and how to integrate it."""

    name: str
    superelement: ss.Superelement
    pairs: ss.ContactPairs
    force_cos: FloatArray
    window_hz: tuple[float, float]
    harmonics: int = 7
    samples: int = 256
    force_sin: FloatArray | None = None
    steps: int = 240
    periods: int = 80
    is_random: bool = False  # then only changes of the verdict have points, each on a short curve


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
    grows: bool

    @property
    def outcome(self) -> str:
        """What became of the disturbance."""
        if self.apart > FAR or self.grows:
            return "leaves"
        if self.apart >= NEAR:
            return "unclear"
        return "dies out" if self.away <= ELSEWHERE else "another motion"

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


def oscillator(mass: float, damping: float, stiffness: float) -> ss.Superelement:
    """One degree of freedom."""
    return ss.Superelement(np.array([[mass]]), np.array([[stiffness]]), np.array([[damping]]))


def along(axis: int, size: int = 1, unknown: int = 0) -> FloatArray:
    """The operator (3, size) of one pair between an unknown and the ground, along t1 (0), t2 (1) or n (2)."""
    operator = np.zeros((3, size))
    operator[axis, unknown] = 1.0
    return operator


def _hertz(low: float, high: float) -> tuple[float, float]:
    """Hz of circular frequencies."""
    return low / (2.0 * np.pi), high / (2.0 * np.pi)


def duffing(cubic: float, force: float, window: tuple[float, float], name: str) -> Problem:
    """``x'' + 0.05 x' + x + cubic x^3 = force cos(w t)`` (Nayfeh and Mook 1979, sec. 4.1)."""
    law = ss.CubicSpring(np.array([[1.0, 0.0, 0.0]]), np.array([[cubic, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(along(0), [law])
    return Problem(name, oscillator(1.0, 0.05, 0.0), pairs, np.array([force]), _hertz(*window), samples=128)


def stop(
    stiffness: float, gap: float, force: float, window: tuple[float, float], name: str, two_sided: bool = False
) -> Problem:
    """An oscillator of frequency 1 with an elastic stop (Shaw and Holmes 1983); impacts double the period near twice
    its frequency."""
    law = ss.ElasticStop(np.array([stiffness]), np.array([gap]), two_sided=two_sided)
    pairs = ss.ContactPairs.with_laws(along(2), [law])
    return Problem(name, oscillator(1.0, 0.1, 1.0), pairs, np.array([force]), _hertz(*window), harmonics=15)


def jenkins_with_cubic(force: float, name: str) -> Problem:
    """A hardening oscillator with a friction element of constant limit beside it."""
    laws = [
        ss.CubicSpring(np.array([[1.0, 0.0, 0.0]]), np.array([[0.3, 0.0, 0.0]])),
        ss.JenkinsElement(np.array([[0.6, 0.0]]), np.array([[0.1, 0.1]])),
    ]
    pairs = ss.ContactPairs.with_laws(np.vstack([along(0), along(0)]), laws)
    return Problem(name, oscillator(1.0, 0.02, 0.0), pairs, np.array([force]), _hertz(0.7, 2.2))


def coulomb_with_gap(gap: float, force: float, name: str) -> Problem:
    """A mass that swings along n and t1 against a pair that is open at rest: it hardens where it closes."""
    structure = ss.Superelement(np.eye(2), np.array([[1.0, 0.1], [0.1, 1.3]]), 0.06 * np.eye(2))
    operator = np.array([[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
    pairs = ss.ContactPairs(operator, 2.0, 1.5, 0.3, normal_load=0.0, gap=gap)
    return Problem(name, structure, pairs, np.array([force, 0.0]), _hertz(0.6, 1.9), steps=500, periods=400)


def separating(load: float, force: float, name: str) -> Problem:
    """A mass pressed on a pair that lifts off, with friction across: it softens, and its peak folds to the left."""
    structure = ss.Superelement(np.eye(2), np.array([[0.5, 0.0], [0.0, 0.7]]), 0.04 * np.eye(2))
    operator = np.array([[0.0, 1.0], [0.0, 0.0], [1.0, 0.2]])
    pairs = ss.ContactPairs(operator, 2.0, 1.0, 0.4, normal_load=load)
    return Problem(name, structure, pairs, np.array([force, 0.3 * force]), _hertz(0.9, 2.0), steps=500, periods=400)


def slipping(load: float, name: str) -> Problem:
    """Two masses, one of them on a pair that always stays closed: friction damps and nothing folds."""
    stiffness = np.array([[2.0, -1.0, 0.0], [-1.0, 1.5, 0.0], [0.0, 0.0, 4.0]])
    structure = ss.Superelement(np.diag([1.0, 0.7, 1.0]), stiffness, 0.01 * np.eye(3))
    operator = np.zeros((3, 3))
    operator[0, 1], operator[2, 2] = 1.0, 1.0
    pairs = ss.ContactPairs(operator, 3.0, 2.0, 0.5, normal_load=load)
    force = np.array([0.3, 0.0, 0.2])
    return Problem(name, structure, pairs, force, _hertz(0.6, 2.2), steps=500, periods=400)


def blade(preload: float, force: float, name: str) -> Problem:
    """The bench blade with ten contacts, its preload and force multiplied."""
    data = load_blade_problem(10)
    pairs = ss.ContactPairs(
        data.contact_operator(),
        data.normal_stiffness,
        data.tangential_stiffness,
        data.friction_coefficient,
        preload * data.preload,
    )
    structure = ss.Superelement(data.mass, data.stiffness, data.damping)
    return Problem(
        name, structure, pairs, force * data.force_cos, data.window_hz, 5, 256, force * data.force_sin, 400, 600
    )


def two_blades(name: str) -> Problem:
    """The two blades with the faces of a rough casting, around their folds; the damping of their modes as a matrix."""
    case = rough_casting()
    model, ratio = ss.build_model(case), case.damping.modal_damping_ratio
    structure, pairs = model.superelement, model.pairs
    operator = pairs.operator
    stuck = structure.stiffness + operator.T @ (pairs.resting_stiffness()[:, None] * operator)
    damping = modal_damping_matrix(structure.mass, *modes_of(structure.mass, stuck), ratio)
    force = model.excitation.on(structure, 1).coefficients(1.0)
    return Problem(
        name, ss.Superelement(structure.mass, structure.stiffness, damping), pairs, force[1], (450.0, 458.0), 9, 256,
        force[2], 400, 300,
    )  # fmt: skip


def random_problem(kind: str, seed: int, name: str) -> Problem:
    """A problem of the torture set, with so many harmonics that its points are motions of the equation."""
    made = torture_problem(kind, seed)
    structure, damping = made.structure, made.damping
    if damping is None:
        assert made.modal_damping_ratio is not None
        springs = np.column_stack([made.tangential_stiffness, made.normal_stiffness])
        stuck = modes_of(structure.mass, with_springs(structure, np.where(made.preload[:, None] >= 0.0, springs, 0.0)))
        damping = modal_damping_matrix(structure.mass, *stuck, made.modal_damping_ratio)
    return Problem(
        name, ss.Superelement(structure.mass, structure.stiffness, damping), made.pairs(), made.force_cos,
        made.window_hz, 11, 256, made.force_sin, 480, 400, True,
    )  # fmt: skip


def twins_beside_a_torus(name: str) -> Problem:
    """A random problem around the torus at which its motion with five rattling pairs becomes stable."""
    return replace(random_problem("twins", 0, name), window_hz=(240.5, 243.5), is_random=False)


def rigid_damper(seed: int, name: str) -> Problem:
    """A random rigid damper that friction alone supports: it rattles, and walks on in each cycle."""
    made = torture_problem("damper", seed)
    assert made.damping is not None
    force = made.force_cos[:, 0], made.force_sin[:, 0]
    return Problem(name, made.superelement(), made.pairs(), force[0], made.window_hz, 9, 256, force[1], 480, 200)


RANDOM = (
    ("high", 0), ("high", 10), ("low", 2), ("light", 1), ("narrow", 0), ("narrow", 1), ("narrow", 2), ("twins", 0),
    ("twins", 2), ("multi", 2), ("wide", 0), ("chain", 1), ("beam", 2),
)  # fmt: skip
PROBLEMS: dict[str, Callable[[str], Problem]] = {
    "duffing, hardening": lambda name: duffing(0.4, 0.25, (0.5, 3.0), name),
    "duffing, softening": lambda name: duffing(-0.05, 0.12, (0.4, 1.4), name),
    "duffing, force of 0.5": lambda name: duffing(0.4, 0.5, (0.8, 3.5), name),
    "stop, soft": lambda name: stop(2.0, 1.0, 0.3, (0.6, 2.0), name),
    "stop, stiff": lambda name: stop(20.0, 1.0, 0.5, (1.0, 3.2), name),
    "stop, near twice its frequency": lambda name: stop(4.0, 0.05, 1.0, (1.8, 4.0), name),
    "stop, two-sided": lambda name: stop(3.0, 1.0, 0.3, (0.6, 2.0), name, two_sided=True),
    "friction element beside a cubic spring": lambda name: jenkins_with_cubic(0.25, name),
    "friction element, more force": lambda name: jenkins_with_cubic(0.4, name),
    "coulomb pair with a gap": lambda name: coulomb_with_gap(1.0, 0.2, name),
    "coulomb pair with a gap, more force": lambda name: coulomb_with_gap(1.0, 0.35, name),
    "separating pair": lambda name: separating(1.0, 0.15, name),
    "separating pair, more force": lambda name: separating(1.0, 0.25, name),
    "slipping pair": lambda name: slipping(1.0, name),
    "blade": lambda name: blade(1.0, 1.0, name),
    "blade, half the preload": lambda name: blade(0.5, 1.0, name),
    "two blades": two_blades,
    "torus of twins 0": twins_beside_a_torus,
    "rigid damper 3": lambda name: rigid_damper(3, name),
    "rigid damper 9": lambda name: rigid_damper(9, name),
    **{
        f"{kind} {seed}": lambda name, kind=kind, seed=seed: random_problem(kind, seed, name)  # type: ignore[misc]
        for kind, seed in RANDOM
    },
}


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


def motion_from(problem: Problem, response: ss.ForcedResponse, point: int, disturbance: float) -> TransientResponse:
    """Some periods from a point whose motion starts too large."""
    start = ss.start_from_response(response, point)
    mean = response.displacement[point][:, 0]
    start["initial_displacement"] = mean + (1.0 + disturbance) * (start["initial_displacement"] - mean)
    start["initial_velocity"] = (1.0 + disturbance) * start["initial_velocity"]
    sine = np.zeros_like(problem.force_cos) if problem.force_sin is None else problem.force_sin
    assert response.multipliers is not None
    rate = abs(math.log(max(abs(response.multipliers[point, 0]), 1e-3)))
    assert response.stable is not None
    change = DECAY if response.stable[point] else GROWTH
    periods = min(problem.periods, max(LEAST_PERIODS, math.ceil(change / max(rate, 1e-9))))
    return ss.integrate_to_steady_state(
        problem.superelement, problem.pairs, problem.force_cos, sine, float(response.frequency_hz[point]),
        steps_per_period=problem.steps, max_periods=periods, tolerance=1e-9, **start,
    )  # fmt: skip


def has_grown(changes: FloatArray) -> bool:
    """Whether a motion leaves, by its changes from period to period; entry 0 compares with rest."""
    parts = [changes[1:3], *np.array_split(changes[3:], PARTS)]
    largest = np.maximum([part.max() for part in parts if part.size], SMALLEST_CHANGE)
    rises = largest / np.minimum.accumulate(largest)
    return bool(rises[-1] > REMAINS or rises.max() > GREW)


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
    return size(disturbed - quiet) / size(expected), away / size(expected), has_grown(motions[0].period_change)


def solve(problem: Problem) -> ss.ForcedResponse:
    """The curve of a problem."""
    return ss.forced_response(
        problem.superelement, problem.pairs, problem.force_cos, problem.force_sin, frequency_hz=problem.window_hz,
        harmonics=problem.harmonics, samples=problem.samples,
    )  # fmt: skip


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
                apart, away, grows = distances_after(finer, response, point)
                found = replace(found, apart=apart, away=away, grows=grows)
            yield found


def main() -> None:
    """Print the table and the number of contradictions."""
    wanted = sys.argv[1] if len(sys.argv) > 1 else ""
    every: list[Checked] = []
    print(
        "| problem | beside | Hz | largest multiplier | verdict | apart, % | from the point, % | grows | disturbance |"
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
            grows = "yes" if each.grows else "no"
            print(
                f"| {name} | {each.beside} | {each.frequency_hz:.6g} | {each.multiplier:.4f} | {verdict} | "
                f"{100 * each.apart:.2g} | {100 * each.away:.2g} | {grows} | {each.outcome}{mark} |",
                flush=True,
            )
        print(f"{name}: {time.perf_counter() - began:.0f} s", file=sys.stderr)
    counts = Counter(each.count for each in every)
    print(f"\n{len(every)} points, {counts['contradiction']} contradictions; {dict(counts)}.")


if __name__ == "__main__":
    main()
