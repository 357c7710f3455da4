"""How time and memory grow with the number of contact pairs: the two-blade model with finer faces, 3 harmonics.

``python benchmarks/growth.py 110 440 990``: each size runs in a process of its own, so that its peak memory is its own.
"""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
import time

import numpy as np
from rough_casting import rough_casting

from stickslip.case.case import Case
from stickslip.model.model import build_joint, build_model, build_structure
from stickslip.study.analyses import solve

# Pairs of both faces -> elements up the contact face and along the damper.
ELEMENTS = {110: (4, 10), 440: (9, 21), 990: (14, 32)}


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


def measure(n_pairs: int, threads: int = 2) -> dict[str, float]:
    """Seconds of each part, points, and peak memory of this process."""
    case = case_with(n_pairs)
    begin = time.perf_counter()
    structure = build_structure(case)
    joint = build_joint(case, structure)
    model = build_model(case, structure, joint, threads)
    reduced = time.perf_counter()
    first: list[float] = []
    last: list[float] = []

    class Clock:
        """Notes when the branch begins and ends."""

        def update(self, stage: str, fraction: float, detail: str = "") -> None:
            if "point" in detail and not detail.endswith("points"):
                (last if first else first)[:] = [time.perf_counter()]

    response = solve(case, model, Clock(), threads)
    done = time.perf_counter()
    peak = int(response.amplitude(next(iter(model.outputs.values()))).argmax())
    counts = np.bincount(response.contact_state[peak], minlength=3)
    return {
        "pairs": model.pairs.n_pairs,
        "mesh unknowns": structure.stiffness.shape[0],
        "reduced unknowns": model.superelement.size,
        "reduction s": reduced - begin,
        "modes and measures s": (first[0] - reduced) + (done - last[0]),
        "curve s": last[0] - first[0],
        "points": response.n_points,
        "iterations": int(response.iterations.sum()),
        "stuck at the peak": int(counts[0]),
        "separating at the peak": int(counts[2]),
        "largest residual": float(response.residual.max()),
        "memory GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def main() -> None:
    """One line for each size, and the exponent of the time per point."""
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(int(sys.argv[2]))))
        return
    before: dict[str, float] | None = None
    for n_pairs in [int(argument) for argument in sys.argv[1:]] or sorted(ELEMENTS):
        command = [sys.executable, __file__, "--one", str(n_pairs)]
        answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        row: dict[str, float] = json.loads(answer.splitlines()[-1])
        row["ms a point"] = 1e3 * row["curve s"] / row["points"]
        print(", ".join(f"{name} {value:.4g}" for name, value in row.items()), flush=True)
        if before is not None:
            growth = math.log(row["ms a point"] / before["ms a point"]) / math.log(row["pairs"] / before["pairs"])
            print(f"  time a point grows as pairs^{growth:.2f}", flush=True)
        before = row


if __name__ == "__main__":
    main()
