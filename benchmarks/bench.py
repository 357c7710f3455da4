"""One table: seconds of whole curves in stickslip, beside a plain dense Newton and pyHarm, measured in one run.

``make bench`` runs it; without the extra ``[bench]`` the column of pyHarm stays empty. Take nothing else on the machine
while it runs. ``--quick`` leaves out what takes minutes.

Bench cases: the blade with 10, 40 and 110 contacts, 3 harmonics, 128 samples, whole window. The dense Newton follows
the whole curve, or with ``--quick`` its first points. pyHarm solves a few points on the rise of the same blade with
four times the preload, each from the one before: where contacts open its law is another one and its Newton fails, so
only its time counts here (compare_pyharm.py compares values). "Difference to dense" is the largest change that three
iterations of a dense Newton in all unknowns, with the same friction law, make to our points.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from blade_problem import BladeProblem, FloatArray, load_blade_problem
from dense_newton import DenseBalance
from rough_casting import rough_casting
from threadpoolctl import threadpool_limits

from stickslip import __version__
from stickslip.case.case import Case
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import harmonic_force, harmonic_tangent
from stickslip.model.model import Model, build_joint, build_model, build_structure
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.structure.superelement import Superelement
from stickslip.study.analyses import solve

HARMONICS, SAMPLES = 3, 128
PRELOAD_FACTOR = 4.0  # no contact opens then
PYHARM_POINTS = {10: 12, 40: 4, 110: 2}
CHECKED_POINTS = {10: 1000, 40: 12, 110: 4}
# Amplitudes of the excitation of the two-blade model: at the first all pairs slip at the peak, at the second none.
SLIPPING_NEWTON, STICKING_NEWTON = 300.0, 15.0


def timed(run: Callable[[], ForcedResponse], repeats: int = 3) -> tuple[ForcedResponse, float]:
    """The curve, and the seconds of the fastest of some runs."""
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        curve = run()
        seconds.append(time.perf_counter() - begin)
    return curve, min(seconds)


def contact_pairs(problem: BladeProblem) -> ContactPairs:
    """The contacts of a bench problem."""
    return ContactPairs(
        problem.contact_operator(),
        problem.normal_stiffness,
        problem.tangential_stiffness,
        problem.friction_coefficient,
        problem.preload,
    )


def blade_curve(problem: BladeProblem) -> ForcedResponse:
    """stickslip's curve of a bench problem."""
    return forced_response(
        Superelement(problem.mass, problem.stiffness, problem.damping),
        contact_pairs(problem),
        problem.force_cos,
        problem.force_sin,
        frequency_hz=problem.window_hz,
        harmonics=HARMONICS,
        samples=SAMPLES,
    )


def difference_to_dense(problem: BladeProblem, curve: ForcedResponse) -> float:
    """Largest relative change of points of the curve by a dense Newton in all unknowns with the same friction law."""
    pairs = contact_pairs(problem)

    def law(relative: FloatArray) -> tuple[FloatArray, FloatArray]:
        every = np.arange(problem.n_contacts)
        return harmonic_force(relative, pairs, SAMPLES).force, harmonic_tangent(relative, pairs, SAMPLES, every)

    dense = DenseBalance(problem, HARMONICS, SAMPLES, law=law)
    checked = np.unique(np.linspace(0, curve.n_points - 1, CHECKED_POINTS[problem.n_contacts]).round().astype(int))
    worst = 0.0
    for point in checked:
        ours = curve.displacement[point].T
        reference = dense.refine(2.0 * np.pi * float(curve.frequency_hz[point]), ours).coefficients
        worst = max(worst, float(np.linalg.norm(ours - reference) / np.linalg.norm(reference)))
    return worst


def dense_seconds(problem: BladeProblem, quick: bool) -> float:
    """Seconds for each point of the plain dense Newton, over its whole curve."""
    balance = DenseBalance(problem, HARMONICS, SAMPLES)
    balance.sweep(*problem.window_hz, max_points=2)  # compiles
    begin = time.perf_counter()
    points = balance.sweep(*problem.window_hz, max_points=6 if quick else 400)
    return (time.perf_counter() - begin) / len(points)


def pyharm_seconds(problem: BladeProblem) -> float | None:
    """Seconds for each point of pyHarm up to half the peak of a pressed blade; None without pyHarm."""
    if importlib.util.find_spec("pyHarm") is None:
        return None
    from pyharm_case import PyHarmCase

    problem = replace(problem, preload=PRELOAD_FACTOR * problem.preload)
    curve = blade_curve(problem)
    peer = PyHarmCase(problem, "cone", HARMONICS, SAMPLES)
    count = PYHARM_POINTS[problem.n_contacts]
    amplitude = curve.amplitude(problem.output)
    last = max(int((amplitude > 0.5 * amplitude.max()).argmax()), count + 1)
    solution = curve.displacement[last - count - 1].T
    seconds = []
    for point in range(last - count, last + 1):
        begin = time.perf_counter()
        solution = peer.solve(2.0 * np.pi * float(curve.frequency_hz[point]), solution)
        seconds.append(time.perf_counter() - begin)
    return float(np.mean(seconds[1:]))  # the first one compiles


def blade_row(n_contacts: int, quick: bool) -> list[str]:
    """The cells of one bench problem."""
    problem = load_blade_problem(n_contacts)
    blade_curve(problem)  # compiles
    curve, seconds = timed(lambda: blade_curve(problem))
    ours = seconds / curve.n_points
    dense, peer = dense_seconds(problem, quick), pyharm_seconds(problem)
    peak = int(curve.amplitude(problem.output).argmax())
    return [
        f"blade, {n_contacts} contacts",
        *shared_cells(curve, seconds, peak),
        f"{1e3 * dense:.0f}",
        f"{dense / ours:.0f}",
        "" if peer is None else f"{1e3 * peer:.0f}",
        "" if peer is None else f"{peer / ours:.0f}",
        f"{difference_to_dense(problem, curve):.1e}",
    ]


def shared_cells(curve: ForcedResponse, seconds: float, peak: int) -> list[str]:
    """Cells that every case has."""
    state = curve.contact_state[peak]
    return [
        f"{(state > 0).sum()} / {(state == 2).sum()}",
        f"{curve.n_points}",
        f"{seconds:.2f}",
        f"{1e3 * seconds / curve.n_points:.1f}",
    ]


def two_blade_row(model: Model, case: Case, name: str) -> list[str]:
    """The cells of the two-blade model under one load."""
    curve, seconds = timed(lambda: solve(case, model))
    peak = int(curve.amplitude(next(iter(model.outputs.values()))).argmax())
    return [name, *shared_cells(curve, seconds, peak), "", "", "", "", ""]


def two_blade_rows() -> list[list[str]]:
    """The default case, 5 harmonics and 256 samples, at a load where all pairs slip and at one where few do."""
    rows = []
    case = rough_casting()
    structure = build_structure(case)
    joint = build_joint(case, structure)
    for name, newton in (("all slip", SLIPPING_NEWTON), ("few slip", STICKING_NEWTON)):
        loaded = case.replace({"excitation.amplitude": newton})
        rows.append(two_blade_row(build_model(loaded, structure, joint), loaded, f"two blades, {name} ({newton:g} N)"))
    return rows


def machine() -> str:
    """The processor, and versions that matter for speed."""
    name = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        lines = information.read_text(encoding="utf-8").splitlines()
        name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), name)
    versions = ", ".join(f"{package} {importlib.metadata.version(package)}" for package in ("numpy", "scipy", "numba"))
    return f"{name}, {os.cpu_count()} cores, one thread; Python {platform.python_version()}, {versions}"


def main() -> None:
    """Print the table."""
    quick = "--quick" in sys.argv[1:]
    head = ["case", "slip / open at peak", "points", "curve s", "ms a point"]
    head += ["dense ms", "ratio", "pyHarm ms", "ratio", "difference to dense"]
    print(f"stickslip {__version__}; {machine()}")
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    with threadpool_limits(limits=1):
        for contacts in (10, 40, 110):
            print("| " + " | ".join(blade_row(contacts, quick)) + " |", flush=True)
        for row in two_blade_rows():
            print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
