"""Derivatives of the peak of a coarse two-blade case by every input, beside differences of models that are built again.

Run ``python benchmarks/gradients.py [modes]``. For each input it prints the relative derivatives of amplitude,
frequency and friction energy (input over value times derivative) and the errors of these three. Differences of reduced
models contain the change of their truncation error: with more modes, they approach the derivatives of the full mesh.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import stickslip as ss

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from peak_differences import SolvedPeak, built_again, solver_input
from sweep_cases import quick_case

# Relative steps: the stiffness grows with about the tenth power of D.
STEPS = {"roughness.fractal_dimension": 1e-5}


def main(modes: int) -> None:
    """Print the table."""
    case = quick_case().replace({"reduction.modes": modes})
    peak = SolvedPeak.of(solver_input(case), (400.0, 500.0), 1, 64, 3e-4)
    values = peak.sensitivity.values
    print(f"{'input':<42}{'relative derivatives':^36}{'errors':^30}")
    for parameter in ss.case_parameters(case, ss.build_model(case)):
        try:
            found = peak.gradient(parameter) * parameter.value / values
        except ss.InputError as error:
            print(f"{parameter.name:<42}{error}")
            continue
        again = peak.differences(built_again(case, parameter.name), STEPS.get(parameter.name, 1e-4)) / values
        numbers = "".join(f"{each:>12.5f}" for each in found) + "".join(f"{each:>10.0e}" for each in found - again)
        print(f"{parameter.name:<42}{numbers}", flush=True)


if __name__ == "__main__":
    np.seterr(all="raise")
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
