"""What curves of small joints cost alone and in a batch, in process time of one thread, in one run.

``OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 python benchmarks/batch_of_curves.py`` prints the table of docs/scaling.md:
random preloads and forces on one structure, 3 harmonics, 64 samples. The structures are a row of 1 or 3 masses with a
pair each, and the blade with 10 and 40 contacts of ``data/``. ``--quick`` omits the batches of 128 curves. The script
fails if the peaks of a batch differ from those of the ordinary curves.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from blade_problem import load_blade_problem
from numpy.typing import NDArray

import stickslip as ss

FloatArray = NDArray[np.float64]

BATCHES = (1, 16, 128)
PAIRS = (1, 3, 10, 40)
MOST_ALONE = 16  # ordinary curves of which the mean counts
# chosen: the batch has a point at the maximum, the ordinary curve beside it: 0.6 % below in a curve whose dense points
# have the maximum of the batch. Another peak or branch would differ by more than this.
LARGEST_DIFFERENCE = 2e-2


@dataclass(frozen=True)
class Problem:
    """A structure under a force (n,) N in phase, its pairs for any preload (n_pairs,) N, and its output."""

    superelement: ss.Superelement
    pairs: Callable[[FloatArray], ss.ContactPairs]
    preload: FloatArray
    force_cos: FloatArray
    force_sin: FloatArray
    output: FloatArray
    window_hz: tuple[float, float]
    modal_damping_ratio: float | None = None

    def inputs(self, count: int) -> list[ss.SolverInput]:
        """So many curves with preloads and forces up to a factor of 1.5 from those of the problem."""
        random = np.random.default_rng(0)
        loads = np.exp(random.uniform(-0.4, 0.4, (count, 2)))
        scatter = np.exp(random.uniform(-0.2, 0.2, (count, self.preload.size)))
        return [
            ss.SolverInput(
                self.superelement,
                self.pairs(load * own * self.preload),
                ss.Excitation.force(force * self.force_cos, force * self.force_sin),
                self.output,
                self.modal_damping_ratio,
            )
            for (load, force), own in zip(loads, scatter, strict=True)
        ]


def row_of_masses(n_pairs: int) -> Problem:
    """Masses of 1 kg in a row, each on springs to its neighbours and to the ground, with a pair to the ground."""
    stiffness = np.diag(np.full(n_pairs, 1.0)) + 0.5 * np.diff(np.eye(n_pairs), axis=0).T @ np.diff(
        np.eye(n_pairs), axis=0
    )
    matrix = np.kron(stiffness, np.diag([1.0e6, 2.0e6, 4.0e6]))
    force = np.zeros(3 * n_pairs)
    force[:3] = 10.0, 3.0, 2.0

    def pairs(preload: FloatArray) -> ss.ContactPairs:
        return ss.ContactPairs(np.eye(3 * n_pairs), 1.0e6, 5.0e5, 0.3, preload)

    output = np.eye(3 * n_pairs)[0]
    return Problem(
        ss.Superelement(np.eye(3 * n_pairs), matrix), pairs, np.full(n_pairs, 60.0), force, 0.0 * force, output,
        (120.0, 240.0), 0.004,
    )  # fmt: skip


def blade(n_pairs: int) -> Problem:
    """The blade with 10 or 40 contacts."""
    given = load_blade_problem(n_pairs)

    def pairs(preload: FloatArray) -> ss.ContactPairs:
        return ss.ContactPairs(
            given.contact_operator(),
            given.normal_stiffness,
            given.tangential_stiffness,
            given.friction_coefficient,
            preload,
        )

    return Problem(
        ss.Superelement(given.mass, given.stiffness, given.damping),
        pairs,
        given.preload,
        given.force_cos,
        given.force_sin,
        given.output,
        given.window_hz,
    )


def problem_with(n_pairs: int) -> Problem:
    """The problem with a number of pairs."""
    return row_of_masses(n_pairs) if n_pairs < 10 else blade(n_pairs)


def seconds(work: Callable[[], object]) -> float:
    """Process time."""
    began = time.process_time()
    work()
    return time.process_time() - began


def row(n_pairs: int, batches: Sequence[int]) -> list[str]:
    """The cells of the table for a number of pairs. Raises AssertionError if peaks differ."""
    problem = problem_with(n_pairs)
    inputs = problem.inputs(max(batches))

    def ordinary(each: ss.SolverInput) -> ss.ForcedResponse:
        return ss.forced_response(
            each.superelement,
            each.pairs,
            each.excitation,
            frequency_hz=problem.window_hz,
            harmonics=3,
            samples=64,
            modal_damping_ratio=each.modal_damping_ratio,
            checks=False,
            threads=1,
        )

    def batch(count: int) -> ss.BatchResponse:
        return ss.batch_response(inputs[:count], frequency_hz=problem.window_hz, harmonics=3, samples=64, threads=1)

    ordinary(inputs[0])  # compiles
    batch(2)
    few = inputs[:MOST_ALONE]
    responses: list[ss.ForcedResponse] = []
    alone = seconds(lambda: responses.extend(map(ordinary, few))) / len(few)
    cells = [str(n_pairs), f"{1e3 * alone:.0f} ms"]
    for count in batches:
        times = seconds(lambda count=count: batch(count)) / count  # type: ignore[misc]
        cells.append(f"{1e3 * times:.0f} ms, {alone / times:.1f}")
    result = batch(len(few))
    heights = np.array([each.amplitude(problem.output).max() for each in responses])
    differences = result.peak_amplitude / heights - 1.0
    assert np.abs(differences).max() < LARGEST_DIFFERENCE, differences
    lost = sum(bool(curve.alone) for curve in result.curves)
    return [*cells, f"{differences.min():.0e} to {differences.max():.0e}", str(lost)]


def main() -> None:
    """Print the table."""
    batches = BATCHES[:-1] if "--quick" in sys.argv else BATCHES
    names = [f"batch of {count}: each curve, ratio" for count in batches]
    print(" | ".join(["pairs", "ordinary curve", *names, "difference of peaks", "solved alone"]))
    for n_pairs in PAIRS:
        print(" | ".join(row(n_pairs, batches)), flush=True)


if __name__ == "__main__":
    main()
