"""How time and memory grow with the number of contact pairs: the two-blade model with finer faces, 3 harmonics.

``OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 python benchmarks/growth.py 110 440 990``: each size runs in a process of its
own, so that its peak memory is its own. Seconds are process time of one thread, which other programs on the machine
change less than wall time; ``--reduction`` ends after the reduction. ``--threads=2`` uses so many threads, whose
process times are added; ``... wall s`` is the time by the clock, ``wall s`` that from the mesh to the end.
"""

from __future__ import annotations

import json
import math
import os
import resource
import subprocess
import sys
import time

import numpy as np
from rough_casting import rough_casting

from stickslip.case.case import Case
from stickslip.model.model import build_joint, build_model, build_structure
from stickslip.structure.elasticity import Structure
from stickslip.study.analyses import solve

Times = tuple[float, float]
REDUCTION, THREADS = "--reduction", "--threads="
# Pairs of both faces -> elements up the contact face and along the damper.
# 5032 take 8 to 13 minutes with two threads, and 14 GB: only where they are asked for.
ELEMENTS = {110: (4, 10), 440: (9, 21), 990: (14, 32), 5032: (33, 73)}


def case_with(n_pairs: int) -> Case:
    """The default case with 3 harmonics, 128 samples, and as many nodes on the faces; the shanks stay coarse."""
    columns, chordwise = ELEMENTS[n_pairs]
    return rough_casting().replace(
        {
            "mesh.contact_columns": columns,
            "mesh.chordwise": chordwise,
            "solver.harmonics": 3,
            "solver.samples": 128,
        }
    )


def memory_gb() -> float:
    """Peak memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def times() -> Times:
    """Process time of all threads and time of the clock [s]."""
    return time.process_time(), time.perf_counter()


def part(name: str, begin: Times, end: Times) -> dict[str, float]:
    """The seconds of a part in both."""
    return {f"{name} s": end[0] - begin[0], f"{name} wall s": end[1] - begin[1]}


def measure(n_pairs: int, only_reduction: bool, threads: int = 1) -> dict[str, float]:
    """Process time of each part, points, and peak memory of this process."""
    os.environ["STICKSLIP_CACHE"] = "off"
    case = case_with(n_pairs)
    begin = times()
    structure = build_structure(case)
    assert isinstance(structure, Structure)  # two blades at rest
    joint = build_joint(case, structure)
    assembled = times()
    model = build_model(case, structure, joint, threads=threads)
    reduced = times()
    row = {
        "pairs": model.pairs.n_pairs,
        "mesh unknowns": structure.stiffness.shape[0],
        "reduced unknowns": model.superelement.size,
        **part("mesh", begin, assembled),
        **part("reduction", assembled, reduced),
        "memory after reduction GB": memory_gb(),
        "wall s": reduced[1] - begin[1],
    }
    if only_reduction:
        return row
    first_stage: list[Times] = []
    points: list[Times] = []

    class Clock:
        """Notes when the first point is looked for, and when the branch begins and ends."""

        def update(self, stage: str, fraction: float, detail: str = "") -> None:
            now = times()
            if "first point" in detail and not first_stage:
                first_stage.append(now)
            if "Hz, point" in detail:
                points[1:] = [now]
                points[:1] = points[:1] or [now]

    response = solve(case, model, Clock(), threads=threads, checks=False)
    done = times()
    peak = int(response.amplitude(next(iter(model.outputs.values()))).argmax())
    counts = np.bincount(response.contact_state[peak], minlength=3)
    return row | {
        **part("modes", reduced, first_stage[0]),
        **part("first point", first_stage[0], points[0]),
        **part("curve", points[0], points[-1]),
        **part("measures", points[-1], done),
        "points": response.n_points,
        "iterations": int(response.iterations.sum()),
        "stuck at the peak": int(counts[0]),
        "separating at the peak": int(counts[2]),
        "largest residual": float(response.residual.max()),
        "memory GB": memory_gb(),
        "wall s": done[1] - begin[1],
    }


def main() -> None:
    """One line for each size, and the exponent of the time per point."""
    if sys.argv[1:2] == ["--one"]:
        threads = [int(each.removeprefix(THREADS)) for each in sys.argv if each.startswith(THREADS)]
        print(json.dumps(measure(int(sys.argv[2]), REDUCTION in sys.argv, *threads)))
        return
    before: dict[str, float] | None = None
    options = [argument for argument in sys.argv[1:] if argument.startswith("--")]
    for n_pairs in [int(argument) for argument in sys.argv[1:] if argument not in options] or sorted(ELEMENTS)[:3]:
        command = [sys.executable, __file__, "--one", str(n_pairs), *options]
        answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        row: dict[str, float] = json.loads(answer.splitlines()[-1])
        if REDUCTION in options:
            print(", ".join(f"{name} {value:.4g}" for name, value in row.items()), flush=True)
            continue
        row["ms a point"] = 1e3 * row["curve s"] / row["points"]
        print(", ".join(f"{name} {value:.4g}" for name, value in row.items()), flush=True)
        if before is not None:
            growth = math.log(row["ms a point"] / before["ms a point"]) / math.log(row["pairs"] / before["pairs"])
            print(f"  time a point grows as pairs^{growth:.2f}", flush=True)
        before = row


if __name__ == "__main__":
    main()
