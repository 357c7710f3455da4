"""Time of the multipliers of all points against that of the rest of the curve: process time, fastest of three runs.

OMP_NUM_THREADS=1 python benchmarks/stability_cost.py
"""

from __future__ import annotations

import time
from typing import Any

from blade_problem import load_blade_problem
from rough_casting import rough_casting

import stickslip as ss
from stickslip.solve.setting_up import Balances


class Stopwatch:
    """Adds up the process time of a function."""

    def __init__(self, function: Any) -> None:
        self.function, self.seconds = function, 0.0

    def __call__(self, *arguments: Any) -> Any:
        """Call the function."""
        began = time.process_time()
        answer = self.function(*arguments)
        self.seconds += time.process_time() - began
        return answer


def blade(contacts: int) -> dict[str, Any]:
    """Arguments for the curve of a benchmark blade."""
    data = load_blade_problem(contacts)
    pairs = ss.ContactPairs(
        data.contact_operator(),
        data.normal_stiffness,
        data.tangential_stiffness,
        data.friction_coefficient,
        data.preload,
    )
    structure = ss.Superelement(data.mass, data.stiffness, data.damping)
    force = ss.Excitation.force(data.force_cos, data.force_sin)
    return {"superelement": structure, "pairs": pairs, "excitation": force, "frequency_hz": data.window_hz}


def two_blades() -> dict[str, Any]:
    """Arguments for the curve of the default two-blade case."""
    case = rough_casting()
    model, solver = ss.build_model(case), case.solver
    return {
        "superelement": model.superelement,
        "pairs": model.pairs,
        "excitation": model.excitation,
        "frequency_hz": (solver.frequency_start, solver.frequency_stop),
        "modal_damping_ratio": case.damping.modal_damping_ratio,
    }


def main() -> None:
    """Print one row for each curve."""
    stability = Stopwatch(Balances.stability)
    Balances.stability = lambda *arguments: stability(*arguments)  # type: ignore[method-assign]
    print("| case | harmonics | points | curve without, s | multipliers, s | ratio |\n|---|---|---|---|---|---|")
    cases = {f"blade, {count} contacts": blade(count) for count in (10, 40, 110)} | {"two blades": two_blades()}
    for name, arguments in cases.items():
        for harmonics, samples in ((3, 128), (5, 256)):
            rows = []
            for _ in range(3):
                stability.seconds, began = 0.0, time.process_time()
                response = ss.forced_response(**arguments, harmonics=harmonics, samples=samples, threads=1)
                rows.append((time.process_time() - began - stability.seconds, stability.seconds))
            curve, extra = (min(column) for column in zip(*rows, strict=True))
            cells = (f"{curve:.2f}", f"{extra:.2f}", f"{extra / curve:.2f}")
            print(f"| {name} | {harmonics} | {response.n_points} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
