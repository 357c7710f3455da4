"""Measured frequency and damping of a bolted two-beam structure against computed nonlinear modes.

``python benchmarks/two_beam.py FOLDER OUT`` reads ``two_beam/`` of FOLDER and writes OUT/two_beam.csv and
OUT/two_beam.svg. Measurement and matrices: N. N. Balaji, GitHub Nidish96/Computational-Work-For-ASB-Project (2020);
both stay in FOLDER. docs/validation.md explains the model and the result.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.linalg
import scipy.optimize
from matplotlib.figure import Figure

import stickslip as ss

# 20 Nm on a bolt with 5/16-inch thread; the force is in the matrix files' description.
BOLT_FORCE_N = 11_580.0
# m, the cone of compressed material at the interface (VDI 2230:2015): head 12.7 mm across flats, 12.7 mm of steel
# below it, tan(phi) = 0.362 + 0.032 ln(1) + 0.153 ln(2).
CONE_RADIUS_M = 0.0123
POISSON = 0.29
TANGENTIAL_RATIO = 2.0 * (1.0 - POISSON) / (2.0 - POISSON)
# Pairs at one position: asperities of one stiffness, with the exponential distribution of loads of Greenwood and
# Williamson.
ASPERITIES = 8
FRICTION_BAND = (0.2, 0.4, 0.6)
POINTS_PER_DECADE = 16
# The mode of each configuration, from 1 in the order of the stuck frequencies.
MODES = {"CD1": 1, "C1": 1, "C2": 2, "C4": 2}
# Configurations whose normal forces change so much that only the nonlinear mode is valid.
PERIODIC = ("CD1",)
# Measurements that are not in the folder: modes and amplitudes of predictions, with the stiffness of C1 and C2.
PREDICTED = {"C3": ((1, 2), (8e-6, 1e-4)), "C4a": ((1, 2), (1e-6, 1.35e-5))}
# Other assumptions on CD1: radius of the cone of pressure, m.
OTHER_RADII_M = (0.011,)
# m, bolts from the centre of the interface.
_SQUARE = 0.010922 * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
_LAP = 0.03 * np.array([(-1, 0), (0, 0), (1, 0)])


@dataclass(frozen=True)
class TwoBeam:
    """A configuration: superelement, and the elements of its interface.

    ``motion`` (n, 3, n_unknowns) are t1, t2, n of the relative motion at the centre of each element, ``area`` (n,) m2,
    ``pressure`` (n,) Pa from the bolts.
    """

    superelement: ss.Superelement
    motion: np.ndarray
    area: np.ndarray
    pressure: np.ndarray

    def pairs(self, stiffness_n_m3: float, friction: float) -> ss.ContactPairs:
        """Contact pairs where the bolts press, ASPERITIES at each position."""
        pressed = self.pressure > 0.0
        area, load = self.area[pressed], (self.pressure * self.area)[pressed]
        spring = np.repeat(stiffness_n_m3 * area / ASPERITIES, ASPERITIES)
        loads = np.outer(load, exponential_loads(ASPERITIES) / ASPERITIES).ravel()
        rows = np.repeat(self.motion[pressed], ASPERITIES, axis=0)
        return ss.ContactPairs(
            rows.reshape(-1, rows.shape[2]), spring, TANGENTIAL_RATIO * spring, friction, normal_load=loads
        )

    def stuck_frequency(self, stiffness_n_m3: float, mode: int) -> float:
        """Hz."""
        pressed = self.pressure > 0.0
        springs = stiffness_n_m3 * np.outer(self.area[pressed], [TANGENTIAL_RATIO, TANGENTIAL_RATIO, 1.0])
        joint = np.einsum("psi,ps,psj->ij", self.motion[pressed], springs, self.motion[pressed], optimize=True)
        square = scipy.linalg.eigvalsh(self.superelement.stiffness + joint, self.superelement.mass)
        return math.sqrt(square[mode - 1]) / (2.0 * math.pi)

    def stiffness_for(self, frequency_hz: float, mode: int) -> float:
        """N/m3, with which a stuck mode has a frequency."""
        root = scipy.optimize.brentq(
            lambda logarithm: self.stuck_frequency(math.exp(logarithm), mode) - frequency_hz,
            math.log(1e9),
            math.log(1e15),
        )
        return math.exp(root)


def exponential_loads(count: int) -> np.ndarray:
    """(count,) means of an exponential distribution of mean 1 in equally probable intervals."""
    edges = -np.log1p(-np.arange(count) / count)
    beyond = np.append((edges + 1.0) * np.exp(-edges), 0.0)
    return -count * np.diff(beyond)


def read_two_beam(folder: Path, name: str, radius_m: float = CONE_RADIUS_M) -> TwoBeam:
    """Configuration ``name`` ("CD1", "C1", ...) of the folder."""
    raw = scipy.io.loadmat(folder / "two_beam" / f"MAT_NULLRED_{name}.mat", squeeze_me=True)
    patches = int(raw["Npatches"])
    rows = slice(0, 6 * patches)
    # The file's patches hang on the faces by springs of `cnum` N/m3: numerical aids, 30 times softer than the contact.
    # Without them the mean motion of each face patch (transposed LamT) is the only motion of the joint.
    aid = raw["L"][rows] - raw["LamT"].T
    stiffness = raw["K"] - float(raw["cnum"]) * aid.T @ _dense(raw["GTG"]) @ aid
    mesh = raw["MESH"][()]
    nodes, quads = np.asarray(_plain(mesh["Nds"]), float), np.asarray(_plain(mesh["Quad"]), int)[:, 1:] - 1
    motion, area, centre = [], [], []
    for patch in range(patches):
        corners = nodes[quads[np.asarray(raw["Pels"][patch], int) - 1]]
        position, size = corners.mean(axis=1), _areas(corners)
        arm = position - np.average(position, axis=0, weights=size)
        motion.append(rigid_rows(arm) @ raw["LamT"][:, 6 * patch : 6 * patch + 6].T)
        area.append(size)
        centre.append(position)
    areas = np.concatenate(area)
    middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))[:2]
    bolts = middle + (_LAP if name.startswith("CD") else _SQUARE)
    return TwoBeam(
        ss.Superelement(raw["M"], 0.5 * (stiffness + stiffness.T)),
        np.concatenate(motion),
        areas,
        bolt_pressure(np.concatenate(centre), areas, bolts, radius_m),
    )


def bolt_pressure(position: np.ndarray, area: np.ndarray, bolts: np.ndarray, radius_m: float) -> np.ndarray:
    """(n,) Pa: a paraboloid below each bolt that ends at the cone and carries the force of the bolt."""
    distance = np.linalg.norm(position[:, None, :2] - bolts, axis=2)
    shape = np.clip(1.0 - (distance / radius_m) ** 2, 0.0, None)
    return (shape * (BOLT_FORCE_N / (area @ shape))).sum(axis=1)


def _plain(value: Any) -> Any:
    return value.item() if getattr(value, "shape", None) == () else value


def _dense(value: Any) -> np.ndarray:
    value = _plain(value)
    return np.asarray(value.toarray() if hasattr(value, "toarray") else value)


def _areas(corners: np.ndarray) -> np.ndarray:
    """(n,) m2 of flat quadrilaterals (n, 4, 3) with normal z."""
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


def rigid_rows(arm: np.ndarray) -> np.ndarray:
    """(n, 3, 6) displacement at ``arm`` (n, 3) m from three translations and three rotations."""
    result = np.zeros((len(arm), 3, 6))
    result[:, range(3), range(3)] = 1.0
    x, y, z = arm.T
    result[:, 0, 4], result[:, 0, 5] = z, -y
    result[:, 1, 3], result[:, 1, 5] = -z, x
    result[:, 2, 3], result[:, 2, 4] = y, -x
    return result


@dataclass(frozen=True)
class Backbone:
    """Frequency (Hz) and damping ratio of friction against modal amplitude, m kg^0.5."""

    stiffness_n_m3: float
    friction: float
    amplitude: np.ndarray
    frequency_hz: np.ndarray
    damping_ratio: np.ndarray


def backbone(
    beam: TwoBeam, mode: int, stiffness_n_m3: float, friction: float, amplitude: tuple[float, float]
) -> Backbone:
    """The mode with one stiffness and friction coefficient, as a quasi-static estimate."""
    result = ss.quasi_static_mode(
        beam.superelement, beam.pairs(stiffness_n_m3, friction), mode, amplitude, points_per_decade=POINTS_PER_DECADE
    )
    return _backbone(result, stiffness_n_m3, friction)


def periodic_backbone(
    beam: TwoBeam, mode: int, stiffness_n_m3: float, friction: float, amplitude: tuple[float, float]
) -> Backbone:
    """The same as a nonlinear mode: valid where normal forces change and pairs open, and much slower."""
    result = ss.nonlinear_mode(
        beam.superelement,
        beam.pairs(stiffness_n_m3, friction),
        mode,
        amplitude,
        harmonics=3,
        samples=128,
        continuation=ss.ContinuationSettings(largest_step=0.08),
    )
    return _backbone(result, stiffness_n_m3, friction)


def _backbone(result: ss.NonlinearMode | ss.QuasiStaticMode, stiffness_n_m3: float, friction: float) -> Backbone:
    if not result.converged:
        raise SystemExit(result.message)
    return Backbone(stiffness_n_m3, friction, result.modal_amplitude, result.frequency_hz, result.damping_ratio)


Solve = Callable[[TwoBeam, int, float, float, tuple[float, float]], Backbone]


def calibrated(
    beam: TwoBeam, mode: int, frequency_hz: float, friction: float, amplitude: tuple[float, float], solve: Solve
) -> Backbone:
    """The mode with the stiffness that gives ``frequency_hz`` at the lowest amplitude: pairs slip there already."""
    target = frequency_hz
    for _ in range(3):
        curve = solve(beam, mode, beam.stiffness_for(target, mode), friction, amplitude)
        error = frequency_hz / curve.frequency_hz[0]
        if abs(error - 1.0) < 2e-5:
            break
        target *= error
    return curve


def measured(folder: Path, name: str) -> np.ndarray:
    """Table of the measurement, by column names."""
    return np.genfromtxt(folder / "two_beam" / f"two_beam_{name}.csv", delimiter=",", names=True)


def compare(folder: Path, name: str, radius_m: float = CONE_RADIUS_M) -> tuple[np.ndarray, list[Backbone]]:
    """Measurement of a configuration, and its computed modes over the friction band."""
    table, beam = measured(folder, name), read_two_beam(folder, name, radius_m)
    amplitude = (float(table["modal_amplitude"][0]), float(table["modal_amplitude"][-1]))
    lowest = float(table["frequency_hz"][0])
    solve = periodic_backbone if name in PERIODIC else backbone
    return table, [calibrated(beam, MODES[name], lowest, friction, amplitude, solve) for friction in FRICTION_BAND]


def total_damping(table: np.ndarray, curve: Backbone) -> np.ndarray:
    """Damping ratio of friction, and a background that makes the lowest amplitude agree (not below zero)."""
    return curve.damping_ratio + max(0.0, float(table["damping_ratio"][0] - curve.damping_ratio[0]))


TICKS = (0.5, 1, 2, 5, 10, 20, 50, 100)
COLUMNS = (
    "configuration", "cone_radius_m", "friction", "stiffness_n_m3", "modal_amplitude", "frequency_hz", "damping_ratio",
    "measured_frequency_hz", "measured_damping_ratio",
)  # fmt: skip


def table_rows(name: str, radius_m: float, table: np.ndarray, curve: Backbone) -> list[dict[str, Any]]:
    """Computed and measured values at the measured amplitudes."""
    at, place = np.log(table["modal_amplitude"]), np.log(curve.amplitude)
    columns = (
        table["modal_amplitude"],
        np.interp(at, place, curve.frequency_hz),
        np.interp(at, place, total_damping(table, curve)),
        table["frequency_hz"],
        table["damping_ratio"],
    )
    given = [name, radius_m, curve.friction, f"{curve.stiffness_n_m3:.3e}"]
    return [
        dict(zip(COLUMNS, [*given, *(f"{value:.6g}" for value in row)], strict=True))
        for row in zip(*columns, strict=True)
    ]


def summary(rows: list[dict[str, Any]]) -> str:
    """One line on a curve: shift and damping, computed and measured."""
    column = {key: np.array([float(row[key]) for row in rows]) for key in COLUMNS[4:]}
    shift, true = (
        100.0 * (column[key][-1] / column[key][0] - 1.0) for key in ("frequency_hz", "measured_frequency_hz")
    )
    damping, known = column["damping_ratio"], column["measured_damping_ratio"]
    ratio = damping / known
    head = ", ".join(f"{key} {rows[0][key]}" for key in COLUMNS[:4])
    return (
        f"{head}: shift {shift:.3f} % (measured {true:.3f} %), damping {damping[0]:.2e} to {damping[-1]:.2e} "
        f"(measured {known[0]:.2e} to {known[-1]:.2e}), computed over measured {ratio.min():.2f} to {ratio.max():.2f}"
    )


def predictions(folder: Path, stiffness_n_m3: float) -> list[dict[str, Any]]:
    """Frequency and friction damping of configurations without a measurement in the folder."""
    rows = []
    for name, (modes, amplitude) in PREDICTED.items():
        beam = read_two_beam(folder, name)
        for mode in modes:
            for friction in FRICTION_BAND:
                curve = backbone(beam, mode, stiffness_n_m3, friction, amplitude)
                for at in np.geomspace(*amplitude, 5):
                    values = [
                        np.interp(np.log(at), np.log(curve.amplitude), each)
                        for each in (curve.frequency_hz, curve.damping_ratio)
                    ]
                    rows.append(
                        {
                            "configuration": name,
                            "mode": mode,
                            "friction": friction,
                            "stiffness_n_m3": f"{stiffness_n_m3:.3e}",
                            "modal_amplitude": f"{at:.3e}",
                            "frequency_hz": f"{values[0]:.4f}",
                            "friction_damping_ratio": f"{values[1]:.2e}",
                        }
                    )
    return rows


def write_table(path: Path, rows: list[dict[str, Any]]) -> None:
    """A CSV file of rows with the same keys."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    """Solve all configurations, print, write and plot them."""
    folder, out = Path(sys.argv[1]), Path(sys.argv[2])
    if not (folder / "two_beam").is_dir():
        raise SystemExit(f"{folder} has no folder two_beam: nothing to compare with.")
    out.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    fitted = []
    for name, radius in [*((name, CONE_RADIUS_M) for name in MODES), *(("CD1", radius) for radius in OTHER_RADII_M)]:
        table, curves = compare(folder, name, radius)
        if name in ("C1", "C2"):
            fitted.append(curves[1].stiffness_n_m3)
        for curve in curves:
            rows += (block := table_rows(name, radius, table, curve))
            print(summary(block), flush=True)
    write_table(out / "two_beam.csv", rows)
    draw(rows).savefig(out / "two_beam.svg")
    write_table(out / "two_beam_predictions.csv", predictions(folder, math.sqrt(fitted[0] * fitted[1])))


def draw(rows: list[dict[str, Any]]) -> Figure:
    """Change of frequency, and damping, of each configuration: measurement as points, friction band as area."""
    figure = Figure(figsize=(10.0, 5.4), layout="constrained")
    panels = figure.subplots(2, len(MODES), sharey="row", sharex="col")
    for name, column in zip(MODES, panels.T, strict=True):
        chosen = [row for row in rows if row["configuration"] == name and float(row["cone_radius_m"]) == CONE_RADIUS_M]
        curves = [[row for row in chosen if float(row["friction"]) == friction] for friction in FRICTION_BAND]
        at = 1e6 * _column(curves[0], "modal_amplitude")
        for panel, key in zip(column, ("frequency_hz", "damping_ratio"), strict=True):
            lines = [_percent(curve, key) for curve in curves]
            panel.fill_between(at, np.min(lines, axis=0), np.max(lines, axis=0), color="#0072b2", alpha=0.25, lw=0)
            for friction, line, style in zip(FRICTION_BAND, lines, ("--", "-", ":"), strict=True):
                panel.semilogx(at, line, style, color="#0072b2", label=f"computed, friction {friction:g}")
            panel.semilogx(at, _percent(curves[0], f"measured_{key}"), "o", ms=4, color="#d55e00", label="measured")
            panel.grid(color="#e8ecf0")
            ticks = [tick for tick in TICKS if at[0] <= tick <= at[-1]]
            panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
            panel.set_xticks([], minor=True)
        column[0].set_title(f"{name}, mode at {float(chosen[0]['measured_frequency_hz']):.2f} Hz", fontsize=10)
    panels[0, 0].set_ylabel("Change of frequency, %")
    panels[1, 0].set_ylabel("Damping ratio, %")
    panels[1, 0].set_ylim(0.0, None)
    figure.supxlabel("Modal amplitude, 10$^{-6}$ m kg$^{1/2}$", fontsize=10)
    panels[0, -1].legend(frameon=False, fontsize="small", loc="lower left")
    return figure


def _column(rows: list[dict[str, Any]], key: str) -> np.ndarray:
    return np.array([float(row[key]) for row in rows])


def _percent(rows: list[dict[str, Any]], key: str) -> np.ndarray:
    """Damping ratio, or the change of a frequency from the lowest amplitude, in percent."""
    values = _column(rows, key)
    return 100.0 * (values if "damping" in key else values / values[0] - 1.0)


if __name__ == "__main__":
    main()
