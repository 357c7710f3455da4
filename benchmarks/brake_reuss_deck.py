"""Frequencies of the Brake-Reuss beam from its Abaqus deck, against three published computations.

    python benchmarks/brake_reuss_deck.py FOLDER

reads ``brb_model/octavejim_BRB_MATEX.inp`` of FOLDER (N. N. Balaji, GitHub Nidish96/octave-jim; the file stays there):
14 bodies, twelve ``*TIE``, six distributing ``*COUPLING``, fifteen ``*EQUATION`` between their reference nodes. The
published frequencies are those of E = 200 GPa, 7800 kg/m3 (the deck has 192.85 GPa, 7857.8 kg/m3):

1. without contact between the two halves,
2. Abaqus, after bolt prestress with frictionless contact,
3. MATLAB, springs of 5e6 N/m normal to each of 600 elements of the interface, 12 kN a bolt.

The state under the bolts is that of frictionless pairs on the nodes of one face, with the springs of source 3, or for
source 2 with a thousand times these.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.contact.pairing.pairing import pair_surfaces
from stickslip.formats.meshes.read import read_model
from stickslip.structure.constraints import Constraints, eliminate
from stickslip.structure.elasticity import Material, Structure, assemble_bodies, natural_frequencies
from stickslip.structure.factor import factorize

STEEL = Material(2e11, 0.29, 7800.0)
PUBLISHED = {
    "1 no contact": (70.323, 151.26, 609.25),
    "2 Abaqus, frictionless": (141.10, 152.42, 570.33, 643.49),
    "3 MATLAB, springs": (143.74, 151.3, 575.08, 642.81, 870.59, 945.37),
}
SPRINGS = 600 * 5e6  # N/m, normal, of the whole interface
HARD = 1e3  # times these springs: nearly rigid
BOLT = 12e3  # N
HEADS, NUTS = (39227, 39228, 39229), (39230, 39231, 39232)  # reference nodes of the shanks
_SHIFT = (2.0 * np.pi * 1.0) ** 2  # (rad/s)^2, makes the free beam regular


def main() -> None:
    """Print the frequencies of the three models and their differences."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    deck = parser.parse_args().folder / "brb_model" / "octavejim_BRB_MATEX.inp"
    if not deck.exists():
        sys.exit(f"{deck} does not exist; the deck is not part of the project.")
    start = time.perf_counter()
    model = read_model(deck, "m")
    assert model.equations is not None
    tied = eliminate(model.equations, model.fixed_unknowns)
    structure = assemble_bodies(model.mesh, [STEEL] * len(model.mesh.body_names), constraints=tied)
    print(f"{model.mesh}\n{tied.dependent_unknowns.size} dependent displacements; {time.perf_counter() - start:.0f} s")
    free_hz = elastic(structure, structure.stiffness)
    report("1 no contact", free_hz)
    pairs = pair_surfaces(model.mesh, "BOTS", "TOPS", adjust="closed").pairs
    normal = structure.of_unknowns(pairs.mesh_operator(model.mesh.n_nodes)[2::3])
    spring = SPRINGS * pairs.area / pairs.area.sum()
    openings = openings_under(structure, normal, bolt_load(tied))
    for name, factor in (("2 Abaqus, frictionless", HARD), ("3 MATLAB, springs", 1.0)):
        spring = factor * SPRINGS * pairs.area / pairs.area.sum()
        closed = closed_pairs(*openings, spring)
        print(f"{int(closed.sum())} of {len(closed)} pairs are closed under the bolts")
        active = scipy.sparse.diags(np.where(closed, spring, 0.0))
        report(name, elastic(structure, structure.stiffness + normal.T @ active @ normal))
    print(f"{time.perf_counter() - start:.0f} s")


def bolt_load(tied: Constraints) -> np.ndarray:
    """(3 * n_nodes,) N of the bolts: each head is pulled, its nut is pressed against it."""
    rows = [tied.reference[[tied.further[label, 2]]].toarray()[0] for label in (*HEADS, *NUTS)]
    return BOLT * (sum(rows[:3]) - sum(rows[3:]))


def openings_under(structure: Structure, normal: Any, load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compliance (n_pairs, n_pairs) of the normal motions of the pairs, and their closure (n_pairs,) under a load.

    ``normal`` are rows (n_pairs, n). Exact but for 1 Hz of the free motions.
    """
    factor = factorize(structure.stiffness + _SHIFT * structure.mass)
    solved = factor.solve(np.column_stack([normal.T.toarray(), structure.gather(load)]))
    moved = normal @ solved[:, -1]
    return normal @ solved[:, :-1], np.sign(moved.mean()) * moved  # the bolts press the faces together


def closed_pairs(compliance: np.ndarray, closure: np.ndarray, spring: np.ndarray) -> np.ndarray:
    """(n_pairs,) whether each pair carries pressure; the set of closed pairs is iterated."""
    closed = np.ones(len(spring), dtype=bool)
    for _ in range(200):
        inside = np.flatnonzero(closed)
        matrix = compliance[np.ix_(inside, inside)] + np.diag(1.0 / spring[inside])
        force = np.zeros(len(spring))
        force[inside] = np.linalg.solve(matrix, closure[inside])
        gap = compliance @ force - closure  # above 0: apart
        new = np.where(closed, force > 0.0, gap < 0.0)
        if (new == closed).all():
            return closed
        closed = new
    sys.exit("the set of closed pairs does not settle.")


def elastic(structure: Structure, stiffness: Any) -> np.ndarray:
    """Hz, without motions of rigid parts."""
    frequency_hz, _ = natural_frequencies(stiffness, structure.mass, 16)
    return frequency_hz[frequency_hz > 1.0]


def report(name: str, frequency_hz: np.ndarray) -> None:
    """Print the frequencies beside the published ones."""
    for number, published in enumerate(PUBLISHED[name]):
        own = frequency_hz[number]
        off = 100.0 * (own / published - 1.0)
        print(f"{name:24s} mode {number + 1}: {own:8.2f} Hz, published {published:8.2f}, {off:+.2f} %")


if __name__ == "__main__":
    main()
