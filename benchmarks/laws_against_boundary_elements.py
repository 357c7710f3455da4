"""Every law of contact stiffness against boundary elements: a table for the documentation and a picture.

``python benchmarks/laws_against_boundary_elements.py OUT`` reads ``benchmarks/data/contact_truth.csv`` (written by
``contact_truth.py``), prints the tables of docs/theory_stiffness_laws.md and writes OUT/stiffness_laws.svg.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import log, sqrt
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import stickslip as ss
from stickslip.contact.stiffness.face_stiffness import RoughnessLaw, persson_law
from stickslip.contact.stiffness.fractal import StiffnessMode
from stickslip.contact.stiffness.persson import PerssonStiffness
from stickslip.core.errors import RoughnessError
from stickslip.core.validation import FloatArray

TABLE = Path(__file__).parent / "data" / "contact_truth.csv"
POISSON_RATIO = 0.3
FEWEST_POINTS = 30  # of the contact: below it the grid does not resolve the spots
USUAL_HARDNESS = 3e9  # Pa, for the fractal law in an elastic case: without a hardness its sum over the spots diverges
Row = dict[str, float]


def read(group: str) -> tuple[list[Row], dict[str, int]]:
    """The usable rows of a set, and how many are not usable and why."""
    with TABLE.open(encoding="utf-8", newline="") as stream:
        rows = [
            {key: float(value) for key, value in row.items() if key != "group"}
            for row in csv.DictReader(stream)
            if row["group"] == group
        ]
    lost = {
        "not converged": [row for row in rows if row["contact_points"] == 0],
        "complete contact": [row for row in rows if row["normal"] == np.inf],
        "contact not resolved": [row for row in rows if 0 < row["contact_points"] < FEWEST_POINTS],
    }
    left_out = [row for each in lost.values() for row in each]
    return [row for row in rows if row not in left_out], {name: len(each) for name, each in lost.items()}


def roughness_of(row: Row) -> ss.Roughness:
    """The roughness of a case."""
    hardness = USUAL_HARDNESS if np.isnan(row["hardness"]) else row["hardness"]
    return ss.Roughness(
        row["fractal_dimension"],
        row["fractal_roughness"],
        hardness,
        row["modulus"],
        POISSON_RATIO,
        sample_length=row["longest"],
        shortest_length=row["shortest"],
    )


def area_of(row: Row) -> float:
    """Nominal area in m2."""
    return (row["waves"] * row["longest"]) ** 2


def by_law(law: RoughnessLaw, mode: StiffnessMode | None = None) -> Callable[[Row], float]:
    """Stiffness per area of a case by a law of the package; nan where the law rejects the case."""

    def value(row: Row) -> float:
        area = area_of(row)
        try:
            found = ss.contact_stiffness(roughness_of(row), row["pressure"] * area, mode, area, law)
        except RoughnessError:
            return np.nan
        return found.normal / area

    return value


def persson(row: Row) -> PerssonStiffness:
    """Persson's law of a case."""
    law = persson_law(roughness_of(row), area_of(row))
    return replace(law, hardness=None) if np.isnan(row["hardness"]) else law


def many_patches(row: Row) -> float:
    """Persson's theory of an elastic face without end."""
    return float(replace(persson(row), hardness=None).many_patches(np.array([row["pressure"]]))[0])


def fitted_powers(row: Row) -> float:
    """(p/Sq) max(2.5, 0.14 (p L / (E* Sq))^-0.7) sqrt(max(1, E* Sdq / (1.9 H))), a fit to 129 other cases."""
    reach = row["pressure"] * row["longest"] / (row["modulus"] * row["sq"])
    plastic = 1.0 if np.isnan(row["hardness"]) else row["modulus"] * row["sdq"] / (1.9 * row["hardness"])
    return row["pressure"] / row["sq"] * max(2.5, 0.14 * reach**-0.7) * sqrt(max(1.0, plastic))


LAWS: dict[str, Callable[[Row], float]] = {
    "`persson`": lambda row: float(persson(row).normal(np.array([row["pressure"]]))[0]),
    "Persson, many patches, elastic": many_patches,
    "p / (0.45 Sq)": lambda row: row["pressure"] / (0.45 * row["sq"]),
    "two powers, fitted to other cases": fitted_powers,
    "`greenwood-williamson`": by_law("greenwood-williamson"),
    "`bush-gibson-thomas`": by_law("bush-gibson-thomas"),
    "`fractal`, `consistent`": by_law("fractal"),
    "`fractal`, `varying-curvature`": by_law("fractal", "varying-curvature"),
    "`fractal`, `unloading`": by_law("fractal", "unloading"),
}
SHOWN = ("`persson`", "p / (0.45 Sq)", "`bush-gibson-thomas`", "`fractal`, `consistent`")
COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7")  # Okabe and Ito


def ratios(law: Callable[[Row], float], rows: list[Row]) -> FloatArray:
    """Law over boundary elements."""
    return np.array([law(row) / row["normal"] for row in rows])


def table(rows: list[Row]) -> Iterator[str]:
    """Lines of the table of all laws."""
    yield "| law | zero or none | least | median | largest | within a factor 2 | within 30 % |"
    yield "|---|---|---|---|---|---|---|"
    for name, law in LAWS.items():
        ratio = ratios(law, rows)
        found = ratio[ratio > 0.0]
        off = np.full(ratio.size, np.inf)
        off[ratio > 0.0] = np.abs(np.log(found))
        yield (
            f"| {name} | {ratio.size - found.size} | {found.min():.2g} | {np.median(np.nan_to_num(ratio)):.2g} | "
            f"{found.max():.3g} | {(off < log(2)).sum()} of {ratio.size} ({100 * (off < log(2)).mean():.0f} %) | "
            f"{100 * (off < log(1.3)).mean():.0f} % |"
        )


def parts(rows: list[Row]) -> Iterator[str]:
    """Lines of the table of ``persson`` in parts of the cases."""
    law = LAWS["`persson`"]
    is_plastic = np.array([not np.isnan(row["hardness"]) for row in rows])
    saturated = np.array([row["saturated_fraction"] > 0.5 for row in rows])
    patches = np.array([row["pressure"] * row["longest"] / (row["modulus"] * row["sq"]) for row in rows])
    waves = np.array([row["waves"] for row in rows])
    groups = {
        "all": np.ones(len(rows), dtype=bool),
        "elastic": ~is_plastic,
        "with a hardness": is_plastic,
        "more than half of the contact at the hardness": saturated,
        "p L / (E* Sq) below 0.02": patches < 0.02,
        "0.02 to 0.2": (patches >= 0.02) & (patches < 0.2),
        "above 0.2": patches >= 0.2,
        "1 longest wave along the face": waves == 1,
        "2": waves == 2,
        "4": waves == 4,
    }
    yield "| cases | number | least | median | largest | within a factor 2 | median deviation |"
    yield "|---|---|---|---|---|---|---|"
    ratio = ratios(law, rows)
    for name, members in groups.items():
        if members.any():
            here = ratio[members]
            off = np.abs(np.log(here))
            yield (
                f"| {name} | {here.size} | {here.min():.2f} | {np.median(here):.2f} | {here.max():.2f} | "
                f"{100 * (off < log(2)).mean():.0f} % | factor {np.exp(np.median(off)):.2f} |"
            )


def resolution() -> Iterator[str]:
    """Lines on the change of the stiffness with the number of points."""
    rows, _ = read("resolution")
    cases: dict[int, dict[int, float]] = {}
    for row in rows:
        cases.setdefault(int(row["number"]), {})[int(row["points"])] = row["normal"]
    steps: dict[int, list[float]] = {0: [], 1: []}
    for found in cases.values():
        values = [found[points] for points in sorted(found)]
        if len(values) == 3:
            for step in steps:
                steps[step].append(abs(values[step] / values[2] - 1.0))
    for step, pixels in ((0, 4), (1, 8)):
        if steps[step]:
            yield (
                f"at least {pixels} points to the shortest wave against {16 // pixels} times as many, "
                f"{len(steps[step])} cases: median {100 * np.median(steps[step]):.1f} %, "
                f"largest {100 * max(steps[step]):.0f} %"
            )


def scatter() -> Iterator[str]:
    """Lines on the scatter of the stiffness between surfaces that differ by their seed only."""
    rows, _ = read("seeds")
    kinds: dict[tuple[float, float], list[Row]] = {}
    for row in rows:
        kinds.setdefault((row["waves"], row["pressure"]), []).append(row)
    for (waves, _), members in kinds.items():
        stiffness = np.array([row["normal"] for row in members])
        reach = members[0]["pressure"] * members[0]["longest"] / (members[0]["modulus"] * 2e-6)
        law = LAWS["`persson`"](members[0]) / np.exp(np.log(stiffness).mean())
        yield (
            f"| {waves:g} | {reach:.3g} | {len(members)} | {100 * np.log(stiffness).std(ddof=1):.0f} % | "
            f"{stiffness.max() / stiffness.min():.2f} | {law:.2f} |"
        )


def picture(rows: list[Row]) -> Figure:
    """Law over boundary elements against the reach of the load."""
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    axes = figure.subplots()
    reach = [row["pressure"] * row["longest"] / (row["modulus"] * row["sq"]) for row in rows]
    for name, colour, marker in zip(SHOWN, COLOURS, "osd^", strict=True):
        ratio = ratios(LAWS[name], rows)
        shown = np.clip(np.nan_to_num(ratio), 0.02, None)
        axes.loglog(reach, shown, marker, color=colour, markersize=4.5, label=name.replace("`", ""), alpha=0.85)
    axes.axhspan(0.5, 2.0, color="#9aa5b1", alpha=0.2, label="factor 2")
    axes.axhline(1.0, color="#52606d", linewidth=0.8)
    axes.set_xlabel("p L / (E* Sq): pressure over the pressure that flattens the longest wave (1)")
    axes.set_ylabel("normal stiffness, law over boundary elements (1)")
    axes.set_ylim(bottom=0.015)
    axes.text(0.01, 0.02, "at the lower edge: no stiffness, or less than 0.02", transform=axes.transAxes, fontsize=8)
    axes.legend(loc="upper right", fontsize=8)
    return figure


def main(out: Path) -> None:
    """Print the tables and write the picture."""
    out.mkdir(parents=True, exist_ok=True)
    for group in ("fit", "test", "wide", "again"):
        rows, lost = read(group)
        print(f"\n{group}: {len(rows)} cases; left out: {lost}\n")
        print("\n".join([*table(rows), "", *parts(rows)]))
        tangential = np.array([[row["tangential_x"], row["tangential_y"]] for row in rows])
        over = tangential / np.array([[row["normal"]] for row in rows])
        print(f"\ntangential over normal: {over.min():.3f} to {over.max():.3f}, mean {over.mean():.4f}")
    print("\n" + "\n".join([*resolution(), "", *scatter()]))
    picture(read("test")[0]).savefig(out / "stiffness_laws.svg", metadata={"Date": None})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
