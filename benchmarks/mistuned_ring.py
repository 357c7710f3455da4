"""The curve of a whole mistuned disk with friction: examples/bladed_disk.toml with finer contact faces, one pattern.

``OMP_NUM_THREADS=1 python benchmarks/mistuned_ring.py 24 110``: sectors and pairs of each sector (12, 56 or 110).
``--range 585 590`` Hz; ``--profile`` adds the functions that take most of the time. Seconds are process time.
"""

from __future__ import annotations

import argparse
import cProfile
import os
import pstats
import resource
import time
from pathlib import Path

import numpy as np

import stickslip as ss
from stickslip.model.kinds.mistuning import deviations
from stickslip.model.model import build_model
from stickslip.solve.cyclic.mistuned_response import MistunedResponse

# Pairs of a sector, on the two faces of its wedge -> elements along and across a face.
ELEMENTS = {12: (2, 1), 56: (6, 3), 110: (10, 4)}


def disk(sectors: int, n_pairs: int, modes: int, harmonics: int) -> ss.Case:
    """The case: one random pattern, blades with a standard deviation of 1 %."""
    columns, rows = ELEMENTS[n_pairs]
    example = ss.load_case(Path(__file__).resolve().parents[1] / "examples" / "bladed_disk.toml")
    return example.replace(
        {
            "structure.sectors": sectors,
            "structure.contact_columns": columns,
            "structure.contact_rows": rows,
            "reduction.modes": modes,
            "solver.accuracy": None,
            "solver.harmonics": harmonics,
            "solver.samples": 128,
            "mistuning.standard_deviation": "1 %",
            "mistuning.patterns": 1,
            "mistuning.seed": 7,
        }
    )


def memory_gb() -> float:
    """Peak memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main() -> None:
    """Measure one disk."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sectors", type=int)
    parser.add_argument("pairs", type=int, choices=sorted(ELEMENTS))
    parser.add_argument("--range", type=float, nargs=2, default=(560.0, 610.0))
    parser.add_argument("--modes", type=int, default=30)
    parser.add_argument("--harmonics", type=int, default=1)
    parser.add_argument("--max-points", type=int, default=2000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--profile", action="store_true")
    parser.add_argument("--save", type=Path)
    given = parser.parse_args()
    os.environ["STICKSLIP_CACHE"] = "off"
    begin = time.process_time()
    case = disk(given.sectors, given.pairs, given.modes, given.harmonics)
    model = build_model(case)
    sector, blade = model.substructure.require_sector(), model.reduced.blade
    assert blade is not None
    pattern = deviations(case.mistuning, given.sectors)[0]
    print(
        f"{sector}, {model.pairs.n_pairs} pairs: {time.process_time() - begin:.1f} s, {memory_gb():.2f} GB", flush=True
    )
    stages: list[tuple[float, str]] = []

    def listen(fraction: float, detail: str) -> None:
        if "iteration" not in detail:
            stages.append((time.process_time(), detail))
            if len(stages) % 20 == 0:
                print(f"  {len(stages)} stages, {time.process_time() - begin:.1f} s, {detail}", flush=True)

    profiler = cProfile.Profile()
    if given.profile:
        profiler.enable()
    start, wall = time.process_time(), time.time()
    curve: MistunedResponse = ss.mistuned_response(
        sector, blade, pattern, model.pairs, model.excitation, next(iter(model.outputs.values())),
        frequency_hz=tuple(given.range), modal_damping_ratio=case.damping.modal_damping_ratio,
        harmonics=given.harmonics, samples=128, threads=given.threads, progress=listen,
        continuation=ss.ContinuationSettings(max_points=given.max_points),
    )  # fmt: skip
    seconds, wall = time.process_time() - start, time.time() - wall
    profiler.disable()
    points = len(curve.frequency_hz)
    first = next((at for at, detail in stages if "Hz" in detail), start) - start
    print(
        f"curve {seconds:.1f} s (process), {wall:.1f} s (wall), to the first point {first:.1f} s, {points} points, "
        f"{1e3 * (seconds - first) / points:.0f} ms a point, {curve.iterations} iterations, {memory_gb():.2f} GB\n"
        f"{curve.message}\nhighest amplitude of each sector, um: {np.round(1e6 * curve.amplitude.max(axis=0), 1)}"
    )
    for words in curve.warnings:
        print(f"warning: {words}")
    if given.save:
        np.savez(given.save, frequency_hz=curve.frequency_hz, amplitude=curve.amplitude)
    if given.profile:
        pstats.Stats(profiler).sort_stats("tottime").print_stats(30)


if __name__ == "__main__":
    main()
