"""A wanted accuracy in place of a number of harmonics: is the estimated error honest, and what does it cost?

    python benchmarks/accuracy.py [--accuracy 0.005] [--problems gaps:1,chain:1]

For the default two-blade case and 20 problems of the torture set (torture_problems.py) it solves the curve with the
accuracy, and solves some of its points again with 25 harmonics: the distance between both is the true error, in the
measure of the estimate (solve/harmonic/neglected.py). The true error of the peak is that of the amplitude of the
output, against the points with 25 harmonics beside the peak. The best fixed choice is the smallest number of harmonics
with which all tested points have the accuracy. True errors below a fiftieth of the accuracy do not count for the
honesty of the estimate. Seconds are processor time, the least of some runs in turn; compare only those of one call.
Results: docs/performance.md.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rough_casting import rough_casting
from torture_problems import make

import stickslip as ss
from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.model.model import build_model
from stickslip.results.peaks import peaks
from stickslip.results.periodic_amplitude import periodic_amplitude
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.neglected import chord_of, distance, plane_across, resized_plane
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.setting_up import Balances, prepare_balances

REFERENCE = 25  # harmonics
FIXED = (3, 5, 7, 9, 12, 15, 19)
POINTS = 12  # of a curve that are solved again, and its peak and its largest estimate
NEGLIGIBLE = 1 / 50
RUNS = 3  # of the accuracy and of the best fixed choice, in turn
TWO_BLADE = "two-blade:0"
PROBLEMS = (
    f"{TWO_BLADE},"
    "sdof:1,sdof:4,chain:0,chain:1,plate:0,plate:1,twins:1,twins:2,light:0,stiff:3,aniso:1,aniso:3,gaps:1,gaps:2,"
    "gaps:3,multi:1,multi:3,close:2,high:3,low:0"
)


@dataclass(frozen=True)
class Subject:
    """A problem without a resolution."""

    superelement: ss.Superelement
    pairs: ss.ContactPairs
    excitation: ss.Excitation
    window_hz: tuple[float, float]
    modal_damping_ratio: float | None
    samples: int
    output: FloatArray

    @classmethod
    def named(cls, name: str) -> Subject:
        """The default case, or a problem ``kind:seed`` of the torture set with 128 samples."""
        if name == TWO_BLADE:
            case = rough_casting()
            model, solver = build_model(case), case.solver
            window = solver.frequency_start, solver.frequency_stop
            ratio, output = case.damping.modal_damping_ratio, next(iter(model.outputs.values()))
            return cls(model.superelement, model.pairs, model.excitation, window, ratio, solver.samples, output)
        kind, _, seed = name.partition(":")
        problem = make(kind, int(seed))
        return cls(
            problem.superelement(), problem.pairs(), problem.excitation(), problem.window_hz,
            problem.modal_damping_ratio, 128, problem.structure.output,
        )  # fmt: skip

    def solve(self, **resolution: float) -> ss.ForcedResponse:
        """The response with ``harmonics`` or an ``accuracy``."""
        return ss.forced_response(
            self.superelement, self.pairs, self.excitation, frequency_hz=self.window_hz, samples=self.samples,
            modal_damping_ratio=self.modal_damping_ratio, threads=1, **resolution,
        )  # type: ignore[arg-type]  # fmt: skip

    def timed(self, **resolution: float) -> tuple[ss.ForcedResponse, float]:
        """A response, and its processor time in seconds."""
        begin = time.process_time()
        response = self.solve(**resolution)
        return response, time.process_time() - begin


@dataclass(frozen=True)
class Row:
    """The answer for one problem."""

    name: str
    points: int
    harmonics: int  # most of all points
    estimate: float  # largest of the curve
    true: float  # largest of the tested points
    peak_estimate: float
    peak_true: float  # of the amplitude of the output
    honesty: float  # smallest ratio of estimate to true error of tested points; 9 where none counts
    seconds: float
    fixed: int | None  # harmonics of the best fixed choice
    fixed_seconds: float


class Truth:
    """Errors of the points of responses of a problem, against REFERENCE harmonics."""

    def __init__(self, subject: Subject) -> None:
        self._balances: Balances = prepare_balances(
            subject.superelement, subject.pairs, subject.excitation, 2.0 * np.pi * max(subject.window_hz),
            REFERENCE, subject.samples, subject.modal_damping_ratio, "tractrix", lambda words: None,
        )  # fmt: skip
        self._reference = FrequencyCurve(self._balances.with_harmonics(REFERENCE))
        self._own: dict[int, Balance] = {}

    def errors(self, response: ss.ForcedResponse, points: Sequence[int]) -> dict[int, float]:
        """True error of points; those without a solution beside them are left out."""
        solved = {point: self._solved(response, point) for point in points}
        return {point: answer[0] for point, answer in solved.items() if answer is not None}

    def peak(self, response: ss.ForcedResponse, point: int, output: FloatArray) -> float:
        """The peak amplitude of an output with REFERENCE harmonics, from the points beside a peak."""
        solved = [self._solved(response, point + shift) for shift in (-1, 0, 1)]
        trials = [answer[1] for answer in solved if answer is not None]
        motion = self._reference.balance.displacement(trials) @ output
        return peaks([trial.omega for trial in trials], periodic_amplitude(motion))[0].amplitude

    def _trial(self, response: ss.ForcedResponse, point: int) -> Trial:
        """A point, evaluated again with its own harmonics."""
        harmonics = response.harmonics if response.point_harmonics is None else int(response.point_harmonics[point])
        if harmonics not in self._own:
            self._own[harmonics] = self._balances.with_harmonics(harmonics)
        coefficients = response.pair_coefficients(point)[:, :, : 2 * harmonics + 1]
        relative = np.ascontiguousarray(coefficients.reshape(-1, 2 * harmonics + 1).T)
        return self._own[harmonics].evaluate(relative, 2.0 * np.pi * float(response.frequency_hz[point]))

    def _solved(self, response: ss.ForcedResponse, point: int) -> tuple[float, Trial] | None:
        """The true error of a point, and the solution beside it."""
        before, trial, after = (self._trial(response, point + shift) for shift in (-1, 0, 1))
        own = self._own[len(trial.amplitude) // 2]
        plane = resized_plane(plane_across(trial, own, chord_of(before, after)), 2 * REFERENCE + 1)
        start = self._reference.at(with_rows(trial.relative, 2 * REFERENCE + 1), trial.omega)
        solved = Newton(self._reference, NewtonSettings(max_iterations=40)).correct(start, plane)
        if not solved.converged:
            return None
        system = self._reference.linearised(solved.point, plane)
        step = system.solve(np.zeros_like(start.residual), start.conditions, -1.0, 1e-6)
        slope = self._reference.measured_change(solved.point, step)
        change: FloatArray = solved.point.measured - with_rows(trial.amplitude, 2 * REFERENCE)
        along = slope, float(step.parameters[0])
        return distance(trial, own, (change, solved.point.trial.omega - trial.omega), along), solved.point.trial


def tested(response: ss.ForcedResponse, peak: int) -> list[int]:
    """Points to solve again: spread over those where pairs move, the peak, and the largest estimate."""
    moving = np.flatnonzero(response.moving_pairs[1:-1] > 0) + 1
    if not moving.size:
        return []
    spread = moving[np.linspace(0, moving.size - 1, POINTS).round().astype(int)]
    marked = [peak] if response.estimated_error is None else [peak, int(response.estimated_error.argmax())]
    return sorted({*spread.tolist(), *(point for point in marked if 0 < point < response.n_points - 1)})


def measure(name: str, accuracy: float, *, with_cost: bool = True) -> Row:
    """The row of a problem; without cost there is no fixed choice."""
    subject = Subject.named(name)
    truth, output = Truth(subject), subject.output
    response, seconds = subject.timed(accuracy=accuracy)
    estimated = response.estimated_error
    assert estimated is not None
    peak = peaks(response.frequency_hz, response.amplitude(output))[0]
    exact = truth.peak(response, peak.point, output) if 0 < peak.point < response.n_points - 1 else peak.amplitude
    errors = truth.errors(response, tested(response, peak.point))
    ratios = [estimated[i] / error for i, error in errors.items() if error > NEGLIGIBLE * accuracy]
    fixed = _best_fixed(subject, truth, accuracy) if with_cost else None
    fixed_seconds = float("nan")
    if fixed is not None:
        runs = [(subject.timed(accuracy=accuracy)[1], subject.timed(harmonics=fixed)[1]) for _ in range(RUNS)]
        seconds, fixed_seconds = (min(each) for each in zip(*runs, strict=True))
    return Row(
        name + ("" if response.converged else " (early)"),
        response.n_points,
        response.harmonics,
        float(estimated.max()),
        max(errors.values(), default=0.0),
        float(estimated[peak.point]),
        abs(peak.amplitude / exact - 1.0),
        min(ratios, default=9.0),
        seconds,
        fixed,
        fixed_seconds,
    )


def _best_fixed(subject: Subject, truth: Truth, accuracy: float) -> int | None:
    """The smallest number of harmonics with the accuracy; None without one."""
    for harmonics in FIXED:
        if harmonics < subject.excitation.harmonics:
            continue
        response = subject.solve(harmonics=harmonics)
        top = peaks(response.frequency_hz, response.amplitude(subject.output))[0].point
        # The largest errors are usually near the peak.
        points = sorted(tested(response, top), key=lambda point: abs(point - top))
        if all(max(truth.errors(response, [point]).values(), default=0.0) <= accuracy for point in points):
            return harmonics
    return None


def line(row: Row) -> str:
    """A row of the table."""
    percents = (f"{100 * value:.3f}" for value in (row.estimate, row.true, row.peak_estimate, row.peak_true))
    ratio = "-" if row.honesty == 9.0 else f"{row.honesty:.2f}"
    cost = (
        "-" if row.fixed is None else f"{row.fixed} | {row.fixed_seconds:.2f} | {row.seconds / row.fixed_seconds:.2f}"
    )
    cells = (row.name, str(row.points), str(row.harmonics), *percents, ratio, f"{row.seconds:.2f}", cost)
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print one line for each problem, and the sums."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--accuracy", type=float, default=0.005)
    parser.add_argument(
        "--problems", default=PROBLEMS, help="kind:seed with commas; default: two-blade and 20 of the torture set"
    )
    options = parser.parse_args()
    make("sdof", 3).solve()  # compiles, so that no time contains it
    print(
        "| problem | points | most harmonics | estimate, % | true, % | estimate of the peak, % | true, output, % | "
        "least estimate / true | seconds | best fixed | its seconds | ratio |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    rows = []
    for name in options.problems.split(","):
        try:
            rows.append(measure(name, options.accuracy))
        except ss.ConvergenceError as error:
            print(f"| {name} | no answer: {str(error)[:80]} |", flush=True)
            continue
        print(line(rows[-1]), flush=True)
    compared = [row for row in rows if row.fixed is not None]
    cost, fixed = sum(row.seconds for row in compared), sum(row.fixed_seconds for row in compared)
    ratios = [row.seconds / row.fixed_seconds for row in compared]
    print(f"\nSmallest ratio of estimate to true error: {min(row.honesty for row in rows):.2f}.")
    print(
        f"Time over that of the best fixed choice: {cost / fixed:.2f} in sum, {np.median(ratios):.2f} in the median, "
        f"{max(ratios):.2f} at most."
    )


if __name__ == "__main__":
    main()
