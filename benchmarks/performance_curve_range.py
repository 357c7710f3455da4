"""Time of performance curves over that of the frequency curve of the study, and over curves of its range of forces.

python benchmarks/performance_curve_range.py STUDY.toml ... [--curves 5] [--without-range]

By the clock, with the usual number of threads; nothing else should run. A curve of the range has the settings, accuracy
and checks of the study, over frequencies a fifth wider, as the performance curve has. Curves of light dampers that
bounce may take minutes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from threadpoolctl import threadpool_limits

import stickslip as ss
from stickslip.case.case import Case
from stickslip.core.progress import SilentProgress
from stickslip.core.threads import thread_count
from stickslip.model.model import build_model
from stickslip.results.response import ForcedResponse
from stickslip.study.analyses import solve
from stickslip.study.performance_curve import KEY, WIDER, with_given_force, with_performance_curve
from stickslip.study.ridge import CaseFamily


def timed(work: Callable[[], ForcedResponse]) -> tuple[float, ForcedResponse]:
    """Seconds by the clock, and the result."""
    began = time.perf_counter()
    found = work()
    return time.perf_counter() - began, found


def curve_time(case: Case, threads: int) -> float:
    """Seconds of the frequency curve of a case over a wider range of frequencies, without its model."""
    model = build_model(case, threads=threads)
    with threadpool_limits(limits=1):
        return timed(lambda: solve(case, model, threads=threads))[0]


def wider(case: Case) -> Case:
    """The case over the frequencies of its performance curve."""
    low, high = sorted((case.solver.frequency_start, case.solver.frequency_stop))
    return case.replace({"solver.frequency_start": low / WIDER, "solver.frequency_stop": high * WIDER})


def main() -> None:
    """Print both times and their ratio for each study, then the curves of the range."""
    parser = argparse.ArgumentParser()
    parser.add_argument("studies", nargs="+")
    parser.add_argument("--curves", type=int, default=5)
    parser.add_argument("--without-range", action="store_true")
    chosen = parser.parse_args()
    threads, quiet = thread_count(), SilentProgress()
    for name in chosen.studies:
        case = ss.load_case(name).replace({"analysis.performance_curve": True})
        alone = case.replace({"analysis.performance_curve": False})
        model = build_model(case, threads=threads)
        with threadpool_limits(limits=1):
            solve(alone, model, threads=threads)  # loads the kernels
            own, response = timed(lambda: solve(alone, model, threads=threads))  # noqa: B023 (called at once)
            whole, response = timed(lambda: with_performance_curve(case, model, response, quiet, threads))  # noqa: B023
        curve = response.performance_curve
        print(
            f"{name}: frequency curve {own:.2f} s, performance curve {whole:.2f} s, {whole / own:.2f} times; {curve!r}"
        )
        if chosen.without_range or curve is None:
            continue
        family = CaseFamily.of(wider(with_given_force(alone)), KEY)
        forces = float(curve.settings["excitation_force_n"]) * np.geomspace(curve.start, curve.stop, chosen.curves)
        seconds = []
        for force in forces:
            seconds.append(curve_time(family.at(float(force)), threads))
            print(f"  {force:.4g} N: {seconds[-1]:.2f} s", flush=True)
        mean = float(np.mean(seconds))
        print(f"  a curve of the range takes {mean:.2f} s; the performance curve {whole / mean:.2f} times that")


if __name__ == "__main__":
    main()
