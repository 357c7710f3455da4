"""Whether a change of the code changed any curve: store curves before it, compare after it.

    python benchmarks/unchanged.py store curves.npz
    python benchmarks/unchanged.py compare curves.npz

The curves: the two-blade case, bench blades with 10, 40 and 110 contacts, `examples/own_mesh`, and the two-blade case
with a solved preload whose tractions are kept. Everything runs on one thread without kept structures. The comparison
prints the largest difference of each array relative to its largest value, and ends with code 1 above 1e-9.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from blade_problem import load_blade_problem
from rough_casting import rough_casting

import stickslip as ss

ALLOWED = 1e-9
ARRAYS = ("frequency_hz", "displacement", "dissipated_energy", "normal_work", "input_energy", "viscous_energy")
EXACT = ("contact_state", "iterations")
ROOT = Path(__file__).resolve().parents[1]


def blade(contacts: int) -> ss.ForcedResponse:
    """The curve of a bench blade."""
    problem = load_blade_problem(contacts)
    return ss.forced_response(
        ss.Superelement(problem.mass, problem.stiffness, problem.damping),
        ss.ContactPairs(
            problem.contact_operator(),
            problem.normal_stiffness,
            problem.tangential_stiffness,
            problem.friction_coefficient,
            problem.preload,
        ),
        problem.force_cos,
        problem.force_sin,
        frequency_hz=problem.window_hz,
        harmonics=3,
        samples=128,
        threads=1,
    )


def study(case: ss.Case) -> ss.ForcedResponse:
    """The curve of a study, from geometry on."""
    with tempfile.TemporaryDirectory() as folder:
        return ss.run(case, folder, threads=1).response


def quiet(case: ss.Case) -> ss.Case:
    """The case without pictures."""
    return case.replace({"output.figure_formats": [], "output.mode_shapes": 0, "output.deflected_shape_frames": 0})


CURVES: dict[str, Callable[[], ss.ForcedResponse]] = {
    "two_blades": lambda: study(quiet(rough_casting())),
    "blade_10": lambda: blade(10),
    "blade_40": lambda: blade(40),
    "blade_110": lambda: blade(110),
    "own_mesh": lambda: study(quiet(ss.load_case(ROOT / "examples" / "own_mesh" / "study.toml"))),
    "solved_preload": lambda: study(
        quiet(rough_casting().replace({"preload.method": "solved", "preload.residual_traction": "kept"}))
    ),
}


def arrays_of(response: ss.ForcedResponse) -> dict[str, np.ndarray]:
    """What is compared of a curve."""
    return {name: np.asarray(getattr(response, name)) for name in (*ARRAYS, *EXACT)}


def store(path: Path) -> None:
    """Solve every curve and write one file."""
    data = {}
    for name, solve in CURVES.items():
        data |= {f"{name}/{key}": array for key, array in arrays_of(solve()).items()}
        print(f"{name}: {data[f'{name}/frequency_hz'].size} points", flush=True)
    np.savez(path, **data)


def compare(path: Path) -> int:
    """Solve every curve again; 0 if all agree with the file."""
    worst = 0.0
    with np.load(path) as kept:
        for name, solve in CURVES.items():
            for key, array in arrays_of(solve()).items():
                before = kept[f"{name}/{key}"]
                if before.shape != array.shape:
                    print(f"{name:16s} {key:18s} shape {before.shape} became {array.shape}", flush=True)
                    worst = np.inf
                    continue
                # The work of normal forces is an error of sampling: its size is that of the energies.
                size = kept[f"{name}/input_energy"] if key == "normal_work" else before
                scale = float(np.abs(size).max()) or 1.0
                change = float(np.abs(array.astype(float) - before).max()) / scale
                if key in ARRAYS:
                    worst = max(worst, change)
                print(f"{name:16s} {key:18s} {change:.1e}", flush=True)
    print(f"largest difference {worst:.1e}, allowed {ALLOWED:.0e}")
    return 0 if worst <= ALLOWED else 1


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in ("store", "compare"):
        sys.exit(__doc__)
    one_thread = {"OMP_NUM_THREADS": "1", "STICKSLIP_CACHE": "off"}
    if any(os.environ.get(name) != value for name, value in one_thread.items()):
        # Round-off depends on the number of threads that numpy loads with.
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **one_thread})
    sys.exit(store(Path(sys.argv[2])) if sys.argv[1] == "store" else compare(Path(sys.argv[2])))
