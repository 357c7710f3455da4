"""Craig-Bampton reduction of the two-blade model refined to about 100,000 unknowns, 110 contact pairs, both factors.

``python benchmarks/large_mesh.py [superlu] [pardiso]``: each in a process of its own, whose peak memory it reports.
"""

from __future__ import annotations

import resource
import time

from both_factors import with_each_factor
from rough_casting import rough_casting

from stickslip.model.model import build_joint, build_structure
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.factor import Backend, factor_forecast

# The contact faces keep their 4 x 10 elements; everything else is finer.
FINE = {
    "mesh.shank_columns": 8,
    "mesh.shank_rows": 36,
    "mesh.platform_rows": 10,
    "mesh.airfoil_rows": 106,
    "mesh.inner_columns": 5,
    "mesh.damper_flank_rows": 5,
}


def measure(backend: Backend, threads: int = 2) -> dict[str, float | str]:
    """Unknowns, seconds and peak memory of the reduction."""
    case = rough_casting().replace(FINE)
    structure = build_structure(case)
    joint = build_joint(case, structure)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    stages: list[tuple[float, str]] = []
    begin = time.perf_counter()
    reduced = craig_bampton(
        structure,
        joint.layout.boundary_nodes,
        case.reduction.modes,
        backend,
        threads,
        lambda share, detail: stages.append((time.perf_counter() - begin, detail)),
    )
    seconds = time.perf_counter() - begin
    return {
        "backend": backend,
        "unknowns": structure.stiffness.shape[0],
        "reduced unknowns": reduced.size,
        "pairs": joint.face_pairs.n_pairs,
        "factor s": stages[1][0] - stages[0][0],
        "modes s": next(at for at, detail in stages if "constraint" in detail) - stages[1][0],
        "total s": seconds,
        "memory before GB": before,
        "peak memory GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
        "forecast": factor_forecast(structure.stiffness.shape[0], backend),
    }


if __name__ == "__main__":
    with_each_factor(__file__, measure)
