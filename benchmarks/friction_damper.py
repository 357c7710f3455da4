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
TIME, DISPLACEMENT, FORCE = 0, 1, 2
BAND_ENDS = slice(4, 6)
FAST = 0.7  # of the largest speed: the band slides
SHOWN = 20  # every 20th point is in the picture


def measured(folder: Path, tension_lb: int) -> np.ndarray:
    """Rows of the measurement at a belt tension."""
    path = folder / "loops" / f"dataset1_0.5Hz{tension_lb}lbtension.json"
    return np.array(json.loads(path.read_text(encoding="utf-8"))["data"])


def fitted(folder: Path, tension_lb: int) -> ss.LoopFit:
    """Fit of the loops at a belt tension, which takes the place of the normal load."""
    data = measured(folder, tension_lb)
    return ss.fit_loops(inch * data[:, DISPLACEMENT], 1e3 * lbf * data[:, FORCE], normal_load=tension_lb * lbf)


def print_causes(fit: ss.LoopFit, other: ss.LoopFit, tension_lb: int) -> None:
    """Energies predicted from the other tension, over the measured ones, if one constant is that of this tension."""
    given = [other.tangential_stiffness, other.friction_limit * fit.normal_load / other.normal_load, other.backlash]
    for number, name in enumerate(("tangential_stiffness", "friction_limit", "backlash")):
        stiffness, limit, backlash = (getattr(fit, name) if at == number else value for at, value in enumerate(given))
        slip = np.clip(fit.cycle_amplitude - limit / stiffness - 0.5 * backlash, 0.0, None)
        ratio = 4.0 * limit * slip / fit.cycle_energy
        print(f"{tension_lb} lb with its own {name}: {ratio.min():.3f} to {ratio.max():.3f} of the measured energy")


def print_band(data: np.ndarray, tension_lb: int) -> None:
    """Measured forces of both ends of the band while it slides, in both directions."""
    speed = np.gradient(data[:, DISPLACEMENT], data[:, TIME])
    fast = np.abs(speed) > FAST * np.abs(speed).max()
    for sign in (1, -1):
        here = data[fast & (np.sign(speed) == sign)]
        ends = ", ".join(f"{force:.0f}" for force in here[:, BAND_ENDS].mean(axis=0))
        print(
            f"{tension_lb} lb, direction {sign:+d}: ends of the band {ends} lb, damper {here[:, FORCE].mean():.3f} kip"
        )


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
        for amplitude, energy, own in zip(fit.cycle_amplitude, fit.cycle_energy, fit.fitted_energy, strict=True):
            predicted = other.energy_per_cycle(float(amplitude), fit.normal_load)
            rows.append([tension, *(f"{x:.4g}" for x in (1e3 * amplitude, energy, own, predicted))])
            rows[-1] += [f"{predicted / energy:.3f}"]
            print(*rows[-1])
        print_causes(fit, other, tension)
        print_band(measured(folder, tension), tension)
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
