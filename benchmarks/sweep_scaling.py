"""A sweep of 40 cases with one process and with two: ``python benchmarks/sweep_scaling.py``.

The default two-blade model, 40 values of the centrifugal force. The reduced structure is kept on disk before both, so
that the ratio is that of the solving; each worker has one thread.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from rough_casting import rough_casting

import stickslip as ss

CASES = 40


def seconds(workers: int, values: list[float]) -> float:
    """Time of the whole sweep into an empty folder, page and tables included."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        sweep = ss.sweep(rough_casting(), {"preload.centrifugal_force": values}, out=Path(folder), workers=workers)
        spent = time.perf_counter() - begin
    failed = sum(not row.converged for row in sweep.table.rows)
    print(f"{workers} process(es): {spent:.1f} s, {spent / len(values):.2f} s a case, {failed} of {len(values)} failed")
    return spent


def main() -> None:
    """Print both times and their ratio."""
    values = [float(force) for force in np.geomspace(50.0, 2000.0, CASES).round(3)]
    seconds(1, values[:1])  # compiles, and keeps the reduced structure
    one, two = seconds(1, values), seconds(2, values)
    print(f"two processes are {one / two:.2f} times as fast as one")


if __name__ == "__main__":
    main()
