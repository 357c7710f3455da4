"""Processor time of the performance curve of the default study over that of its frequency curve.

OMP_NUM_THREADS=1 python benchmarks/performance_curve_cost.py
"""

import time

import stickslip as ss
from stickslip.core.progress import SilentProgress
from stickslip.model.model import build_model
from stickslip.study.analyses import forced_curve
from stickslip.study.performance_curve import performance_curve


def main() -> None:
    """Print both times and their ratio; kernels are compiled before."""
    case = ss.TwoBladeCase().replace(
        {"solver.harmonics": None, "solver.accuracy": "2 %"}
    )  # as "stickslip new" writes it
    quiet = SilentProgress()
    model = build_model(case)
    small = case.replace({"solver.frequency_start": "505 Hz", "solver.frequency_stop": "525 Hz"})
    forced_curve(small, model, quiet, 1)  # loads the kernels
    began = time.process_time()
    response = forced_curve(case, model, quiet, 1)
    curve = time.process_time() - began
    print(f"frequency curve with its checks {curve:.1f} s, {response.n_points} points")
    began = time.process_time()
    forced_curve(case, model, quiet, 1, checks=False)
    alone = time.process_time() - began
    print(f"the same without multipliers and search for missed peaks {alone:.1f} s")
    began = time.process_time()
    ridge = performance_curve(case, model, response, quiet, 1)
    cost = time.process_time() - began
    print(f"performance curve {cost:.1f} s: {cost / curve:.2f} and {cost / alone:.2f} of these; {ridge!r}")


if __name__ == "__main__":
    main()
