"""Craig-Bampton reduction of the two-blade model refined to about 1,000,000 unknowns: time of stages, peak memory.

``OPENBLAS_NUM_THREADS=1 python benchmarks/million_unknowns.py [threads]``. Seconds are process time of all threads.
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


def memory_gb() -> float:
    """Peak memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main() -> None:
    """Build, reduce and report."""
    case = rough_casting().replace(FINE)
    structure = build_structure(case)
    joint = build_joint(case, structure)
    size = structure.stiffness.shape[0]
    print(
        f"{size} unknowns, {joint.face_pairs.n_pairs} pairs, {time.process_time():.0f} s, {memory_gb():.1f} GB",
        flush=True,
    )
    begin, stages = time.process_time(), [""]

    def report(done: float, stage: str) -> None:
        if stage != stages[-1] or done >= 0.7:
            stages.append(stage)
            print(f"{stage} from {time.process_time() - begin:.0f} s on, {memory_gb():.1f} GB", flush=True)

    threads = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    reduced = craig_bampton(structure, joint.layout.boundary_nodes, MODES, threads=threads, progress=report)
    print(f"{reduced.size} unknowns after {time.process_time() - begin:.0f} s, {memory_gb():.1f} GB")


if __name__ == "__main__":
    main()
