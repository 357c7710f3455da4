"""How many harmonics, samples and modes: the error of the peak of the two-blade model, and what each costs.

``python benchmarks/error_curves.py OUT`` writes OUT/error_curves.csv and OUT/error_curves.svg. The reference has 13
harmonics, 512 samples and 80 modes; one number is lowered at a time. 300 N of excitation, two centrifugal forces:
the default of 500 N, and 150 N, where the damper bounces harder.
"""

from __future__ import annotations

import csv
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rough_casting import rough_casting

from stickslip.model.model import Model, build_joint, build_model, build_structure
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.path.stepping import ContinuationSettings

REFERENCE = {"harmonics": 13, "samples": 512, "modes": 80}
TRIED = {
    "harmonics": (1, 2, 3, 5, 7, 9),
    "samples": (32, 64, 128, 256),
    "modes": (0, 5, 10, 20, 30, 50),
}
PRESSING_NEWTON = (500.0, 150.0)
# Points so close that the height between them does not matter.
CLOSE = ContinuationSettings(wanted_angle_deg=6.0, largest_step=0.04)


class Problem:
    """The default two-blade model under one centrifugal force; models of each number of modes are built once."""

    def __init__(self, newton: float) -> None:
        self.case = rough_casting().replace({"preload.centrifugal_force": newton})
        self._structure = build_structure(self.case)
        self._joint = build_joint(self.case, self._structure)
        self._models: dict[int, Model] = {}

    def model(self, modes: int) -> Model:
        """The model with a number of fixed-interface modes."""
        if modes not in self._models:
            case = self.case.replace({"reduction.modes": modes})
            self._models[modes] = build_model(case, self._structure, self._joint)
        return self._models[modes]

    def solve(self, harmonics: int, samples: int, modes: int) -> tuple[ForcedResponse, float, float, float]:
        """Curve, peak amplitude (m), its frequency (Hz), and seconds for each point."""
        model = self.model(modes)
        begin = time.perf_counter()
        curve = forced_response(
            model.superelement,
            model.pairs,
            model.excitation,
            frequency_hz=(425.0, 462.0),
            harmonics=harmonics,
            samples=samples,
            modal_damping_ratio=self.case.damping.modal_damping_ratio,
            continuation=CLOSE,
            threads=1,
        )
        seconds = (time.perf_counter() - begin) / curve.n_points
        amplitude = curve.amplitude(next(iter(model.outputs.values())))
        peak = int(amplitude.argmax())
        return curve, float(amplitude[peak]), float(curve.frequency_hz[peak]), seconds


def main() -> None:
    """Solve all cases, print and write them."""
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    for newton in PRESSING_NEWTON:
        problem = Problem(newton)
        curve, height, place, seconds = problem.solve(**REFERENCE)
        state = np.bincount(curve.contact_state[int(np.abs(curve.frequency_hz - place).argmin())], minlength=3)
        print(f"{newton:g} N: peak {1e6 * height:.4f} um at {place:.4f} Hz, states {state}, {seconds:.3f} s a point")
        for name, values in TRIED.items():
            for value in values:
                curve, amplitude, frequency, seconds = problem.solve(**{**REFERENCE, name: value})
                rows.append(
                    {
                        "centrifugal_force_newton": newton,
                        "varied": name,
                        "value": value,
                        "peak_error_percent": 100.0 * abs(amplitude / height - 1.0),
                        "frequency_error_percent": 100.0 * abs(frequency / place - 1.0),
                        "ms_a_point": 1e3 * seconds,
                        "converged": curve.converged,
                    }
                )
                print(", ".join(f"{key} {cell:.3g}" if key != "varied" else cell for key, cell in rows[-1].items()))
    with (out / "error_curves.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    draw(rows).savefig(out / "error_curves.svg")


def draw(rows: list[dict[str, Any]]) -> Figure:
    """Error of the peak's height against harmonics, samples and modes, a line for each centrifugal force."""
    figure = Figure(figsize=(9.0, 3.0), layout="constrained")
    panels = figure.subplots(1, 3, sharey=True)
    for panel, name in zip(panels, TRIED, strict=True):
        for newton, colour, mark in zip(PRESSING_NEWTON, ("#0072b2", "#d55e00"), "os", strict=True):
            chosen = [row for row in rows if row["varied"] == name and row["centrifugal_force_newton"] == newton]
            heights = [max(row["peak_error_percent"], 1e-4) for row in chosen]
            panel.semilogy(
                [row["value"] for row in chosen], heights, mark + "-", color=colour, label=f"$F_N$ = {newton:g} N"
            )
        panel.set(xlabel={"modes": "Fixed-interface modes"}.get(name, name.capitalize()))
        panel.grid(color="#e8ecf0")
    panels[1].set_xscale("log", base=2)
    panels[0].set_ylabel("Error of the peak amplitude, %")
    panels[0].legend(frameon=False)
    return figure


if __name__ == "__main__":
    main()
