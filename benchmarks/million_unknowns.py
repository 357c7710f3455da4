"""Craig-Bampton reduction of the two-blade model refined to about 1,000,000 unknowns: time of stages, peak memory.

``OPENBLAS_NUM_THREADS=1 python benchmarks/million_unknowns.py [threads]``. Seconds are process time of all threads, in
brackets those by the clock, both from the beginning of the stage before.
"""

from __future__ import annotations

import resource
import sys
import time

from rough_casting import rough_casting

from stickslip.model.model import build_joint, build_structure
from stickslip.structure.craig_bampton import craig_bampton

# Twice the elements along the chord, and more in all other directions; the faces keep their four columns.
FINE = {
    "mesh.chordwise": 20,
    "mesh.shank_columns": 18,
    "mesh.shank_rows": 84,
    "mesh.platform_rows": 22,
    "mesh.airfoil_rows": 291,
    "mesh.inner_columns": 12,
    "mesh.damper_flank_rows": 11,
}
MODES = 10
START = time.perf_counter()


def memory_gb() -> float:
    """Peak memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main() -> None:
    """Build, reduce and report."""
    last = [time.process_time(), time.perf_counter()]

    def report(words: str) -> None:
        now = [time.process_time(), time.perf_counter()]
        used, clock = (each - before for each, before in zip(now, last, strict=True))
        last[:] = now
        print(f"{words}: {used:.0f} s ({clock:.0f} s), {memory_gb():.1f} GB", flush=True)

    case = rough_casting().replace(FINE)
    structure = build_structure(case)
    joint = build_joint(case, structure)
    report(f"mesh and matrices of {structure.stiffness.shape[0]} unknowns, {joint.face_pairs.n_pairs} pairs")
    stages = [""]

    def begin(_: float, stage: str) -> None:
        if stage != stages[-1]:
            if stages[-1]:
                report(stages[-1])
            stages.append(stage)

    threads = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    reduced = craig_bampton(structure, joint.layout.boundary_nodes, MODES, threads=threads, progress=begin)
    report(stages[-1])
    used, clock = time.process_time(), time.perf_counter() - START
    print(f"reduced to {reduced.size} unknowns: {used:.0f} s ({clock:.0f} s), {memory_gb():.1f} GB")


if __name__ == "__main__":
    main()
