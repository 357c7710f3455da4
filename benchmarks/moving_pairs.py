"""A joint that mostly sticks: unknowns of all pairs against those of the pairs that can move.

``OMP_NUM_THREADS=1 python benchmarks/moving_pairs.py 990 120``: the two-blade model of ``growth.py`` with so many pairs
and so many N at one blade, first with ``reduction.pairs = "moving"``, then with all pairs (omit with ``--moving``).
``--threads=2`` uses so many threads. Each runs in a process of its own; seconds are times by the clock.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time

from growth import THREADS, case_with, memory_gb

from stickslip.core.progress import SilentProgress
from stickslip.model.model import build_model
from stickslip.results.peaks import peaks
from stickslip.study.pairs_that_move import solved_with_moving_pairs

ONE, ONLY_MOVING = "--one", "--moving"


def measure(n_pairs: int, force: float, kind: str, threads: int) -> dict[str, float]:
    """Seconds of the model and of the curve (with reductions to more pairs), and the highest peak."""
    os.environ["STICKSLIP_CACHE"] = "off"
    case = case_with(n_pairs).replace({"excitation.amplitude": force, "reduction.pairs": kind})
    begin = time.perf_counter()
    first = build_model(case, threads=threads)
    built = time.perf_counter()
    model, response = solved_with_moving_pairs(case, first, SilentProgress(), threads, checks=False)
    done = time.perf_counter()
    amplitude = response.amplitude(next(iter(model.outputs.values())))
    peak = peaks(response.frequency_hz, amplitude, response.part)[0]
    moving, estimated = (each.reduced.moving for each in (model, first))
    return {
        "pairs that can move": float(n_pairs if moving is None else moving.sum()),
        "estimated": float(n_pairs if estimated is None else estimated.sum()),
        "unknowns": float(model.superelement.size),
        "model s": built - begin,
        "curve s": done - built,
        "points": float(response.n_points),
        "complete": float(response.converged),
        "peak um": 1e6 * peak.amplitude,
        "peak Hz": peak.frequency_hz,
        "largest residual": float(response.residual.max()),
        "memory GB": memory_gb(),
    }


def main() -> None:
    """One line for each reduction."""
    threads = [each.removeprefix(THREADS) for each in sys.argv if each.startswith(THREADS)] or ["1"]
    n_pairs, force = sys.argv[1:3]
    if ONE in sys.argv:
        print(json.dumps(measure(int(n_pairs), float(force), sys.argv[-1], int(threads[0]))))
        return
    for kind in ("moving",) if ONLY_MOVING in sys.argv else ("moving", "all"):
        command = [sys.executable, __file__, n_pairs, force, ONE, f"{THREADS}{threads[0]}", kind]
        answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        row: dict[str, float] = json.loads(answer.splitlines()[-1])
        print(f"{kind}: " + ", ".join(f"{name} {value:.6g}" for name, value in row.items()), flush=True)


if __name__ == "__main__":
    main()
