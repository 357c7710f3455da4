"""stickslip beside pyHarm on the blade with 10 contacts, at the same frequencies of a whole resonance curve.

Needs the extra ``[bench]``: ``pip install stickslip[bench]``, then ``python benchmarks/compare_pyharm.py``.

line    friction along t2 only, constant normal load. The motion has no mean, and a slider forgets its start at its
        first slip, so that two or three periods are enough: both programs solve the same equations.
cone    3-D friction with varying normal load, preload raised so that no contact opens. Here the programs differ in the
        slider of a pair that sticks (pyHarm starts it at zero, stickslip at the mean position, so that a stuck pair
        has no mean traction: both are steady states) and in its periodicity (pyHarm takes the third period, stickslip
        the converged one). The dense Newton reference with pyHarm's two choices separates them from all else.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from blade_problem import BladeProblem, FloatArray, load_blade_problem
from dense_newton import DenseBalance
from pyharm_case import PyHarmCase, one_direction_stiffness

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.structure.superelement import Superelement

HARMONICS, SAMPLES = 5, 128
PRELOAD_FACTOR = 4.0  # of the cone variant: the normal force stays above zero
SHOWN_POINTS = 9


def stickslip_curve(problem: BladeProblem, variant: str) -> ForcedResponse:
    """The curve over the window of the bench problem, friction by radial return as pyHarm has it."""
    stiffness, operator = problem.stiffness, problem.contact_operator()
    if variant == "line":
        stiffness = one_direction_stiffness(problem)
        operator[0::3] = operator[2::3] = 0.0  # no motion along t1 and n: one direction, constant load
    pairs = ContactPairs(
        operator,
        problem.normal_stiffness,
        problem.tangential_stiffness,
        problem.friction_coefficient,
        problem.preload,
    )
    return forced_response(
        Superelement(problem.mass, stiffness, problem.damping),
        pairs,
        problem.force_cos,
        problem.force_sin,
        frequency_hz=problem.window_hz,
        harmonics=HARMONICS,
        samples=SAMPLES,
        update="radial",
    )


def relative_difference(first: FloatArray, second: FloatArray) -> float:
    """Largest difference of two sets of coefficients over the largest coefficient."""
    return float(np.abs(first - second).max() / np.abs(second).max())


def compare(problem: BladeProblem, variant: str) -> list[float]:
    """Print the table of one variant; returns the relative differences to pyHarm of all points of the curve."""
    begin = time.perf_counter()
    curve = stickslip_curve(problem, variant)
    ours_seconds = (time.perf_counter() - begin) / curve.frequency_hz.size
    peer = PyHarmCase(problem, variant, HARMONICS, SAMPLES)
    dense = DenseBalance(problem, HARMONICS, SAMPLES, cycles=3) if variant == "cone" else None

    count = curve.frequency_hz.size
    shown = {int(i) for i in np.linspace(0, count - 1, SHOWN_POINTS)} | {int(curve.amplitude(problem.output).argmax())}
    opened = any(float(curve.pair_cycle(i).force[:, :, 2].min()) <= 0.0 for i in range(count))
    print(f"\n{variant}: {HARMONICS} harmonics, {SAMPLES} samples, {count} points, opens: {'yes' if opened else 'no'}")
    head = "frequency Hz   stickslip um      pyHarm um   difference   slip"
    print(head + ("   dense, 3 periods - pyHarm" if dense else ""))
    differences, seconds = [], 0.0
    solution: FloatArray | None = None
    for i, frequency_hz in enumerate(curve.frequency_hz):
        omega = 2.0 * np.pi * float(frequency_hz)
        begin = time.perf_counter()
        solution = peer.solve(omega, solution)
        seconds += time.perf_counter() - begin
        ours = curve.displacement[i].T
        differences.append(relative_difference(ours, solution))
        if i in shown:
            tip = [1e6 * float(np.hypot(*(c[1:3] @ problem.output))) for c in (ours, solution)]
            slipping = int((curve.contact_state[i] > 0).sum())
            line = f"{frequency_hz:12.4f} {tip[0]:14.7f} {tip[1]:14.7f}   {differences[-1]:10.1e}   {slipping:4d}"
            if dense:
                line += f"   {relative_difference(dense.solve(omega, ours.ravel()).coefficients, solution):10.1e}"
            print(line)
    print(f"largest difference of all points {max(differences):.1e}")
    print(f"seconds a point: stickslip {ours_seconds:.4f} (arc length), pyHarm {seconds / count:.4f} (fixed frequency)")
    return differences


def main() -> None:
    """Both variants."""
    problem = load_blade_problem(10)
    compare(problem, "line")
    compare(replace(problem, preload=PRELOAD_FACTOR * problem.preload), "cone")


if __name__ == "__main__":
    main()
