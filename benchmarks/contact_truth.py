"""Contact stiffness of rough faces by boundary elements, case by case, into a table.

Run ``python benchmarks/contact_truth.py SET FIRST LAST``; it appends rows to ``benchmarks/data/contact_truth.csv`` and
omits those that are there. Requires the extra ``bench``. Sets:

* ``fit``: the constants of the laws were chosen with these;
* ``test``: the same ranges, drawn again with other seeds; no constant saw them;
* ``wide``: beyond the ranges of both;
* ``again``: the ranges of ``test`` once more, drawn after all laws and tables were final;
* ``seeds``: ten seeds of the same surface;
* ``resolution``: cases of ``test`` with half and twice as many points.
"""

from __future__ import annotations

import csv
import sys
import time
from dataclasses import asdict, dataclass, replace
from math import nan
from pathlib import Path

import numpy as np
from rough_half_space import RATIO, RoughSquare, pressed, small_oscillation

from stickslip.contact.stiffness.surface import fractal_roughness_from_sq

TABLE = Path(__file__).parent / "data" / "contact_truth.csv"
POISSON_RATIO = 0.3
PIXELS = 8  # to the shortest wave
MOST_POINTS = 512


@dataclass(frozen=True)
class TruthCase:
    """One computation; lengths in m, pressures in Pa; ``hardness`` nan for an elastic contact."""

    group: str
    number: int
    points: int
    fractal_dimension: float
    fractal_roughness: float
    longest: float
    shortest: float
    waves: int
    seed: int
    modulus: float
    hardness: float
    pressure: float


@dataclass(frozen=True)
class Truth:
    """What boundary elements give: heights, contact, stiffness per area in N/m3."""

    sq: float
    sdq: float
    contact_points: int
    contact_fraction: float
    saturated_fraction: float  # of the contact, at the hardness
    normal: float
    tangential_x: float
    tangential_y: float
    seconds: float


NOT_CONVERGED = Truth(nan, nan, 0, nan, nan, nan, nan, nan, nan)


SEEDS = {"fit": 11, "test": 2026, "wide": 77, "again": 150015}


def drawn(group: str, number: int) -> TruthCase:
    """Case ``number`` of a set: D 2.1 to 2.6, Sq 0.2 to 20 um, 0.3 to 100 MPa, waves over a factor 8 to 64.

    ``wide``: D 2.1 to 2.8, waves over a factor 128 for one longest wave along the face and 64 for two.
    """
    rng = np.random.default_rng([SEEDS[group], number])
    dimension = float(rng.uniform(2.1, 2.8 if group == "wide" else 2.6))
    height, pressure = (float(np.exp(rng.uniform(*np.log(ends)))) for ends in ((0.2e-6, 20e-6), (0.3e6, 100e6)))
    # Sq over the longest wave from 1/2000 to 1/60: ground to coarsely milled faces.
    longest = height * float(np.exp(rng.uniform(*np.log((60.0, 2000.0)))))
    band, waves = float(np.exp(rng.uniform(*np.log((8.0, 64.0))))), int(rng.choice([1, 2, 4]))
    most = MOST_POINTS
    if group == "wide":
        most, waves, band = 2 * MOST_POINTS, min(waves, 2), np.inf
    band = min(band, most / (PIXELS * waves))
    modulus = float(rng.choice([108.24e9, 113e9, 60e9]))
    hardness = float(np.exp(rng.uniform(*np.log((1e9, 6e9))))) if rng.random() < 0.6 else nan
    shortest = longest / band
    scale = fractal_roughness_from_sq(height, dimension, longest, shortest, RATIO)
    points = min(2 ** int(np.ceil(np.log2(PIXELS * waves * band))), most)
    seed = 1000 * (1 + list(SEEDS).index(group)) + number
    return TruthCase(
        group, number, points, dimension, scale, longest, shortest, waves, seed, modulus, hardness, pressure
    )


def repeated(number: int) -> TruthCase:
    """Case ``number`` of ``seeds``: D = 2.3, waves over a factor 16, elastic; ten seeds of six faces and loads."""
    kind, seed = divmod(number - 1, 10)
    waves, reach = (1, 2, 4)[kind // 2], (0.005, 0.1)[kind % 2]  # reach: p L / (E* Sq)
    height, longest, modulus = 2e-6, 2e-3, 108e9
    scale = fractal_roughness_from_sq(height, 2.3, longest, longest / 16.0, RATIO)
    pressure = reach * modulus * height / longest
    return TruthCase(
        "seeds", number, max(256, 128 * waves), 2.3, scale, longest, longest / 16.0, waves, seed, modulus, nan, pressure
    )


def cases(group: str, first: int, last: int) -> list[TruthCase]:
    """The cases ``first`` to ``last`` of a set."""
    if group == "seeds":
        return [repeated(number) for number in range(first, last + 1)]
    if group != "resolution":
        return [drawn(group, number) for number in range(first, last + 1)]
    chosen = [drawn("test", number) for number in range(first, last + 1)]
    return [
        replace(each, group=group, points=points)
        for each in chosen
        if each.points < MOST_POINTS
        for points in (each.points // 2, each.points, 2 * each.points)
    ]


def truth(case: TruthCase) -> Truth:
    """Boundary elements on one case."""
    start = time.process_time()
    square = RoughSquare(
        case.fractal_dimension, case.fractal_roughness, case.longest, case.shortest, case.waves, case.seed
    )
    heights = square.heights(case.points)
    hardness = None if np.isnan(case.hardness) else case.hardness
    state = pressed(heights, square.side, case.modulus, case.pressure, hardness)
    saturated = 0.0 if hardness is None else float((state.pressure[state.contact] > 0.999 * hardness).mean())
    stiffness = (np.inf,) * 3
    if not state.contact.all():
        stiffness = small_oscillation(state.contact, square.side, case.modulus, POISSON_RATIO)
    step = square.side / case.points
    slope = [(np.roll(heights, -1, axis) - heights) / step for axis in (0, 1)]
    return Truth(
        float(heights.std()),
        float(np.sqrt((slope[0] ** 2 + slope[1] ** 2).mean())),
        int(state.contact.sum()),
        float(state.contact.mean()),
        saturated,
        *stiffness,
        time.process_time() - start,
    )


def main(group: str, first: int, last: int) -> None:
    """Compute the cases that the table does not have yet."""
    done = set()
    if TABLE.exists():
        with TABLE.open(encoding="utf-8", newline="") as stream:
            done = {(row["group"], int(row["number"]), int(row["points"])) for row in csv.DictReader(stream)}
    for case in cases(group, first, last):
        if (case.group, case.number, case.points) in done:
            continue
        try:
            found = truth(case)
        except RuntimeError as error:
            print(f"{case.group} {case.number}: {error}", flush=True)
            found = NOT_CONVERGED
        row = asdict(case) | asdict(found)
        new = not TABLE.exists()
        with TABLE.open("a", encoding="utf-8", newline="") as stream:
            table = csv.DictWriter(stream, fieldnames=list(row), lineterminator="\n")
            if new:
                table.writeheader()
            table.writerow({key: f"{value:.8g}" if isinstance(value, float) else value for key, value in row.items()})
        print(f"{case.group} {case.number}: {row['normal']:.4g} N/m3, {row['seconds']:.1f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
