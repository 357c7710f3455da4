"""The two-blade model with uniform and with solved preload, against the centrifugal force: table and pictures.

``python benchmarks/solved_preload.py`` prints the table of docs/solved_preload.md and writes its two pictures beside it
(docs/images). Some two minutes on one core.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from rough_casting import rough_casting

from stickslip.case.case import Case
from stickslip.core.errors import ConvergenceError
from stickslip.core.validation import FloatArray
from stickslip.model.model import ReducedModel, ReducedStructure, connect, load_joint, reduce_structure, set_up
from stickslip.results.measures import Summary, summary
from stickslip.study.analyses import solve

FORCES_N = (20, 50, 100, 200, 500, 1000)
VARIANTS = ("uniform", "released", "kept")
STYLES = {"uniform": ("o-", "#1b1f24"), "released": ("s--", "#0072b2"), "kept": ("^:", "#d55e00")}
BASE = {
    "geometry.excitation_height": "18.35 mm",
    "excitation.amplitude": "20 N",
    "roughness.fractal_dimension": 2.4,
    "roughness.fractal_roughness": "1e-9 m",
    "solver.frequency_start": "405 Hz",
    "solver.frequency_stop": "535 Hz",
}


@dataclass(frozen=True)
class Row:
    """One case of the table."""

    force: int
    variant: str
    model: ReducedModel
    measures: Summary | None
    message: str

    @property
    def pressure_mpa(self) -> FloatArray:
        """(n_pairs,) at rest."""
        return np.maximum(self.model.joint.preload, 0.0) / self.model.joint.face_pairs.area * 1e-6

    @property
    def open_pairs(self) -> int:
        """Number of pairs that are open at rest."""
        return int((~self.model.pairs.closed_at_rest).sum())


def case_of(force: int, variant: str) -> Case:
    """The case of one row."""
    preload: dict[str, object] = {"preload.centrifugal_force": f"{force} N"}
    if variant != "uniform":
        preload |= {"preload.method": "solved", "preload.residual_traction": variant}
    return rough_casting().replace(BASE | preload)


def computed() -> list[Row]:
    """All rows; the structure is reduced once for each kind of preload."""
    rows, structures = [], {}
    for force in FORCES_N:
        for variant in VARIANTS:
            case = case_of(force, variant)
            setup = set_up(case)
            kind = case.preload.method
            if kind not in structures:
                structures[kind] = reduce_structure(case, setup.assemble(), setup.layout)
            rows.append(_row(force, variant, case, structures[kind]))
            print(_line(rows[-1]), flush=True)
    return rows


def _row(force: int, variant: str, case: Case, reduced: ReducedStructure) -> Row:
    model = connect(case, reduced, load_joint(case, set_up(case).layout))
    try:
        response = solve(case, model)
    except ConvergenceError as error:
        return Row(force, variant, model, None, str(error))
    found = summary(response, model.outputs["blade tip A"])
    return Row(force, variant, model, found, "" if response.converged else response.message)


def _line(row: Row) -> str:
    rest = f"| {row.force} | {row.variant} | {row.open_pairs} | {row.pressure_mpa.max():.2f} "
    if row.measures is None:
        return f"{rest}| no curve: {row.message} | | | | |"
    found = row.measures
    states = " / ".join(map(str, found.state_counts))
    return (
        f"{rest}| {1e6 * found.peak.amplitude:.2f} | {found.peak.frequency_hz:.2f} | {states} | "
        f"{1e6 * found.friction_energy:.3f} | {row.message or 'whole'} |"
    )


def draw_curves(rows: list[Row], target: Path) -> None:
    """Peak, energy and open pairs against the centrifugal force."""
    figure, panels = plt.subplots(1, 3, figsize=(10.0, 3.2), layout="constrained")
    for variant in VARIANTS:
        marker, colour = STYLES[variant]
        mine = [row for row in rows if row.variant == variant and row.measures is not None]
        force = [row.force for row in mine]
        label = "uniform" if variant == "uniform" else f"solved, tractions {variant}"
        found = [row.measures for row in mine if row.measures is not None]
        panels[0].semilogx(force, [1e6 * f.peak.amplitude for f in found], marker, color=colour, label=label)
        panels[1].semilogx(force, [1e6 * f.friction_energy for f in found], marker, color=colour)
        panels[2].semilogx(force, [row.open_pairs for row in mine], marker, color=colour)
    labels = ("Peak at A, 0-to-peak, µm", "Friction energy at the peak, µJ per cycle", "Pairs open at rest, of 110")
    for axes, words in zip(panels, labels, strict=True):
        axes.set(xlabel="Centrifugal force, N", ylabel=words, ylim=(0.0, None))
        axes.grid(color="#e8ecf0")
    panels[0].legend(frameon=False)
    figure.savefig(target)


def draw_maps(rows: list[Row], target: Path) -> None:
    """Pressure at rest on the left face under the smallest and the largest force."""
    shown = [row for row in rows if row.force in (FORCES_N[0], FORCES_N[-1]) and row.variant != "uniform"]
    figure, panels = plt.subplots(2, 2, figsize=(10.0, 4.2), layout="constrained", sharex=True, sharey=True)
    for axes, row in zip(panels.ravel(), shown, strict=True):
        pairs = row.model.joint.face_pairs
        face = pairs.face == 0
        across, along = 1e3 * pairs.face_position[face].T
        closed = row.model.pairs.closed_at_rest[face]
        axes.scatter(along[~closed], across[~closed], marker="s", s=60, facecolor="none", edgecolor="#6b7785")
        pressure = row.pressure_mpa[face][closed]
        dots = axes.scatter(along[closed], across[closed], c=pressure, marker="s", s=70, cmap="cividis", vmin=0.0)
        figure.colorbar(dots, ax=axes, label="MPa")
        axes.set_title(f"{row.force} N, tractions {row.variant}", fontsize=10)
    for axes in panels[1]:
        axes.set_xlabel("Along the damper, mm")
    for axes in panels[:, 0]:
        axes.set_ylabel("Up the slope, mm")
    figure.savefig(target)


def main() -> None:
    """Table on the terminal, pictures into docs/images."""
    images = Path(__file__).parents[1] / "docs" / "images"
    print(
        "| F_N, N | preload | open at rest | largest pressure, MPa | peak, um | Hz | states at the peak | uJ | curve |"
    )
    rows = computed()
    draw_curves(rows, images / "solved_preload.svg")
    draw_maps(rows, images / "solved_pressure.svg")


if __name__ == "__main__":
    sys.exit(main())
