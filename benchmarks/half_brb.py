"""Force that a bolted half Brake-Reuss beam needs at eight response levels: an Iwan joint fitted at two of them.

``python benchmarks/half_brb.py FOLDER OUT`` reads ``half_brb/`` of FOLDER and writes OUT/half_brb.csv and
OUT/half_brb.svg. Measurement: M. Acenedese, GitHub mattiacenedese/BRBtesting; Chen et al., Mech. Syst. Signal Process.
166 (2022) 108401; Jin et al., 166 (2022) 108402. The files stay in FOLDER. docs/validation.md explains the result.
"""

from __future__ import annotations

import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import stickslip as ss

FITTED, PREDICTED = (5, 40), (20, 60)
KEPT_BACK = (30, 50, 70, 80)  # m/s2, measured, but not in the folder
KEPT_BACK_FORCES = (0.95, 1.43)  # N
FILES = {5: "response_4.99.csv", 20: "response_20.1.csv", 40: "response_40.1.csv", 60: "response_60.2.csv"}
# Fraction of the modal stiffness in the joint. Far below sliding, the loop depends on R = K_T^2 / (2 F_S) alone, so the
# fraction has no effect; it must exceed the loss of stiffness.
JOINT_FRACTION = 0.3


@dataclass(frozen=True)
class Level:
    """Phase resonance of a measured curve: force (N), acceleration (m/s2), frequency (Hz)."""

    force: float
    acceleration: float
    frequency_hz: float


@dataclass(frozen=True)
class Mode:
    """A mode: mass (kg) at the accelerometer, frequency (Hz) and damping ratio without slip, R (N/m2) of the joint."""

    mass: float
    frequency_hz: float
    damping_ratio: float
    coefficient: float

    def response(self, acceleration: float) -> tuple[float, float]:
        """Force (N) and frequency (Hz) of the phase resonance at a held acceleration, m/s2 0-to-peak."""
        omega = 2.0 * math.pi * self.frequency_hz
        stiffness = self.mass * omega**2
        joint = JOINT_FRACTION * stiffness
        # The resonance is lower than the frequency without slip, so the displacement is larger.
        displacement = acceleration / omega**2
        displacement *= 1.0 + 0.5 * self.coefficient * displacement / stiffness
        pairs = ss.ContactPairs.with_laws(
            [[1.0], [0.0], [0.0]],
            [ss.IwanJoint(np.array([joint]), np.array([0.5 * joint**2 / self.coefficient]), np.zeros(1), np.zeros(1))],
        )
        curve = ss.controlled_response(
            ss.Superelement(
                np.array([[self.mass]]),
                np.array([[stiffness - joint]]),
                np.array([[2.0 * self.damping_ratio * self.mass * omega]]),
            ),
            pairs,
            ss.Excitation.force(np.array([1.0])),
            np.array([1.0]),
            frequency_hz=(0.985 * self.frequency_hz, 1.005 * self.frequency_hz),
            amplitude=displacement,
            harmonics=5,
            continuation=ss.ContinuationSettings(largest_step=0.01),
        )
        if not curve.converged:
            raise SystemExit(curve.message)
        force, frequency = np.abs(curve.load_factor), curve.frequency_hz
        least = int(force.argmin())
        around = slice(max(0, least - 2), least + 3)
        # The square of the force is a parabola of the frequency near its least value.
        shift = frequency[around] - frequency[least]
        parabola = np.polyfit(shift, force[around] ** 2, 2)
        vertex = -0.5 * parabola[1] / parabola[0]
        return math.sqrt(float(np.polyval(parabola, vertex))), float(frequency[least] + vertex)

    def acceleration_at(self, force: float) -> float:
        """m/s2 at the phase resonance under a force, N."""
        low, high = 1.0, 200.0
        for _ in range(12):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if self.response(middle)[0] < force else (low, middle)
        return math.sqrt(low * high)


def read_curve(folder: Path, name: str) -> np.ndarray:
    """Table of a measurement, by column names."""
    return np.genfromtxt(folder / "half_brb" / name, delimiter=",", names=True)


def phase_resonance(table: np.ndarray) -> Level:
    """Where the acceleration lags behind the force by 90 degrees, between the two samples around it."""
    order = np.argsort(-table["phase_rad"])
    at = [np.interp(0.5 * math.pi, -table["phase_rad"][order], table[key][order]) for key in
          ("force_n", "acceleration_m_s2", "frequency_hz")]  # fmt: skip
    return Level(*map(float, at))


def fitted_mode(folder: Path) -> Mode:
    """Mass and frequency from the slope of the lowest level, damping and R from the force of the two fitted levels."""
    table = read_curve(folder, FILES[FITTED[0]])
    ratio = table["force_n"] / table["acceleration_m_s2"] * np.cos(table["phase_rad"])
    square = (2.0 * math.pi * table["frequency_hz"]) ** -2.0
    # The phase is that of the displacement: force / acceleration = k / w^2 - m.
    stiffness, minus_mass = np.polyfit(square, ratio, 1)
    mass = -float(minus_mass)
    low, high = (phase_resonance(read_curve(folder, FILES[level])) for level in FITTED)
    omega = math.sqrt(stiffness / mass)
    loss = [level.force / level.acceleration for level in (low, high)]
    growth = (loss[1] - loss[0]) / (high.acceleration - low.acceleration)
    background = loss[0] - growth * low.acceleration
    # A cycle of amplitude X dissipates 4 R X^3 / 6 (chi = 0), a force F in phase with the velocity pi F X.
    coefficient = 1.5 * math.pi * growth * omega**4
    # Slip has lowered the frequency of the lowest level already: the loop has the stiffness K - R X / 2 in its first
    # harmonic.
    lowered = 0.5 * coefficient * low.acceleration / omega**2
    stuck = math.sqrt(omega**2 + lowered / mass)
    return Mode(mass, stuck / (2.0 * math.pi), 0.5 * background / mass, coefficient)


def main() -> None:
    """Fit, compare, predict; print, write and plot."""
    folder, out = Path(sys.argv[1]), Path(sys.argv[2])
    if not (folder / "half_brb").is_dir():
        raise SystemExit(f"{folder} has no folder half_brb: nothing to compare with.")
    out.mkdir(parents=True, exist_ok=True)
    mode = fitted_mode(folder)
    print(f"{mode.mass:.3f} kg, {mode.frequency_hz:.3f} Hz, {mode.damping_ratio:.2e}, R {mode.coefficient:.3e} N/m2")
    measured = {level: phase_resonance(read_curve(folder, name)) for level, name in FILES.items()}
    rows = []
    for level in sorted([*FILES, *KEPT_BACK]):
        known = measured.get(level)
        force, frequency = mode.response(known.acceleration if known else float(level))
        use = "fitted" if level in FITTED else "compared" if known else "predicted"
        rows.append([level, use, f"{force:.4f}", f"{frequency:.3f}"])
        rows[-1] += (
            [f"{known.force:.4f}", f"{known.frequency_hz:.3f}", f"{force / known.force:.3f}"] if known else [""] * 3
        )
        print(*rows[-1])
    for force in KEPT_BACK_FORCES:
        print(f"{force} N at the phase resonance: {mode.acceleration_at(force):.1f} m/s2")
    with (out / "half_brb.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            [
                "acceleration_m_s2",
                "use",
                "force_n",
                "frequency_hz",
                "measured_force_n",
                "measured_frequency_hz",
                "ratio",
            ]
        )
        writer.writerows(rows)
    draw(rows).savefig(out / "half_brb.svg")


def draw(rows: list[list[object]]) -> Figure:
    """Force and frequency of the phase resonance against the held acceleration."""
    figure = Figure(figsize=(8.5, 3.4), layout="constrained")
    panels = figure.subplots(1, 2)
    level = np.array([float(str(row[0])) for row in rows])
    for panel, column, words in zip(panels, (2, 3), ("Force, N", "Frequency, Hz"), strict=True):
        panel.plot(level, [float(str(row[column])) for row in rows], "-", color="#0072b2", label="computed")
        for use, mark in (("fitted", "s"), ("compared", "o")):
            chosen = [row for row in rows if row[1] == use]
            panel.plot(
                [float(str(row[0])) for row in chosen],
                [float(str(row[column + 2])) for row in chosen],
                mark,
                color="#d55e00",
                label=f"measured, {use}",
            )
        panel.set(xlabel="Acceleration, m/s$^2$, 0-to-peak", ylabel=words)
        panel.ticklabel_format(axis="y", useOffset=False)
        panel.grid(color="#e8ecf0")
    panels[0].legend(frameon=False)
    return figure


if __name__ == "__main__":
    main()
