"""Fit measured loops of a banded rotary friction damper at one belt tension, and predict the energy at the other.

``python benchmarks/friction_damper.py FOLDER OUT`` reads ``loops/`` of FOLDER and writes OUT/friction_damper.csv and
OUT/friction_damper.png. Measurement: GitHub ARTS-Laboratory/Dataset-Friction-Damper-with-Backlash, CC BY-SA 4.0; the
files stay in FOLDER. docs/validation.md explains the result.
"""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.constants import inch, lbf

import stickslip as ss

TENSIONS_LB = (20, 35)
# Columns of the data: time (s), displacement (in), force of the damper (kip), velocity, forces of the band (lb).
DISPLACEMENT, FORCE = 1, 2
SHOWN = 20  # every 20th point is in the picture


def fitted(folder: Path, tension_lb: int) -> ss.LoopFit:
    """Fit of the loops at a belt tension, which takes the place of the normal load."""
    path = folder / "loops" / f"dataset1_0.5Hz{tension_lb}lbtension.json"
    data = np.array(json.loads(path.read_text(encoding="utf-8"))["data"])
    return ss.fit_loops(inch * data[:, DISPLACEMENT], 1e3 * lbf * data[:, FORCE], normal_load=tension_lb * lbf)


def main() -> None:
    """Fit both tensions, predict each from the other; print, write and plot."""
    folder, out = Path(sys.argv[1]), Path(sys.argv[2])
    if not (folder / "loops").is_dir():
        raise SystemExit(f"{folder} has no folder loops: nothing to compare with.")
    out.mkdir(parents=True, exist_ok=True)
    fits = {tension: fitted(folder, tension) for tension in TENSIONS_LB}
    rows = []
    for tension, fit in fits.items():
        for name in ("tangential_stiffness", "friction_limit", "backlash"):
            low, high = getattr(fit, f"{name}_interval")
            print(f"{tension} lb: {name} {getattr(fit, name):.4g} ({low:.4g} to {high:.4g})")
        print(f"{tension} lb: misfit {fit.misfit:.3f}, without backlash {fit.misfit_without_backlash:.3f}")
        other = next(each for key, each in fits.items() if key != tension)
        for amplitude, measured, own in zip(fit.cycle_amplitude, fit.cycle_energy, fit.fitted_energy, strict=True):
            predicted = other.energy_per_cycle(float(amplitude), fit.normal_load)
            rows.append([tension, *(f"{x:.4g}" for x in (1e3 * amplitude, measured, own, predicted))])
            rows[-1] += [f"{predicted / measured:.3f}"]
            print(*rows[-1])
    with (out / "friction_damper.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            [
                "tension_lb",
                "amplitude_mm",
                "measured_j",
                "fitted_j",
                "predicted_from_other_tension_j",
                "predicted_over_measured",
            ]
        )
        writer.writerows(rows)
    draw(fits).savefig(out / "friction_damper.png", dpi=110)


def draw(fits: dict[int, ss.LoopFit]) -> Figure:
    """Measured loops and fits."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    for panel, (tension, fit) in zip(figure.subplots(1, len(fits)), fits.items(), strict=True):
        along = 1e3 * fit.displacement
        panel.plot(along[::SHOWN], 1e-3 * fit.force[::SHOWN], ".", ms=3.0, color="#e69f00", label="measured")
        panel.plot(along, 1e-3 * fit.fitted, "-", lw=1.0, color="#0072b2", label="fit with backlash")
        panel.set(title=f"Belt tension {tension} lb", xlabel="Displacement, mm", ylabel="Force, kN, offset removed")
        panel.grid(color="#e8ecf0")
    handles, labels = panel.get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, loc="outside upper center", ncols=2, markerscale=2)
    return figure


if __name__ == "__main__":
    main()
