"""CalculiX' own test decks with cyclic symmetry: frequencies of each nodal diameter against its reference results.

    python benchmarks/cyclic_decks.py FOLDER

FOLDER has the decks and the results (.dat.ref) of the Debian package calculix-ccx-test (examples/test, also
compressed). Decks of one sector with boundaries Nleft and Nright and steps *FREQUENCY are compared, but motions as a
rigid body.
"""

from __future__ import annotations

import gzip
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

import stickslip as ss
from stickslip.core.errors import StickslipError
from stickslip.formats.meshes.read import read_model

DECKS = ("fullseg", "segment", "segmentface", "segmenttet")
TYPES = {"C3D20R": "C3D20"}  # stickslip integrates completely
RIGID_PART = 1e-2  # of the highest frequency of a list, below which a motion is rigid by round-off
PLACES = re.compile(r"\*CYCLIC SYMMETRY MODEL.*\n([^*\n]*)", re.IGNORECASE)
ROW = re.compile(r"^\s+(\d+)\s+\d+" + 4 * r"\s+(-?\d\.\d+E[+-]\d+)" + r"\s*$", re.MULTILINE)


def text_of(folder: Path, name: str) -> str:
    """The text of a file, compressed or not."""
    plain, packed = folder / name, folder / f"{name}.gz"
    return plain.read_text("latin-1") if plain.exists() else gzip.decompress(packed.read_bytes()).decode("latin-1")


def compare(folder: Path, name: str) -> None:
    """Print the largest difference of each nodal diameter of a deck."""
    deck, results = text_of(folder, f"{name}.inp"), text_of(folder, f"{name}.dat.ref")
    for other, kind in TYPES.items():
        deck = deck.replace(other, kind)
    with tempfile.TemporaryDirectory() as temporary:
        path = Path(temporary) / f"{name}.inp"
        path.write_text(re.split(r"(?im)^\*TIE", deck)[0])
        model = read_model(path, "m")
    mesh = model.mesh
    found = PLACES.search(deck)
    assert found is not None
    ends = np.array([float(each) for each in found[1].split(",") if each.strip()]).reshape(2, 3)
    structure = model.assemble()
    axis = ends[0], ends[1] - ends[0]
    left, right = (mesh.node_set(each) for each in ("Nleft", "Nright"))
    if left.size == right.size:
        symmetry = ss.cyclic_symmetry(mesh.points, left, right, axis=axis)
    else:
        symmetry = ss.tied_symmetry(mesh, "Nleft", "Nright", axis=axis)
    rows = [(int(each[0]), float(each[3])) for each in ROW.findall(results)]
    for diameter in sorted({each[0] for each in rows}):
        theirs = np.sort([hertz for number, hertz in rows if number == diameter])
        elastic = theirs[theirs > RIGID_PART * theirs.max()]
        count = len(theirs)
        own = ss.sector_frequencies(structure, symmetry, [diameter], count)[diameter]
        single = diameter == 0 or 2 * diameter == symmetry.sectors
        own = np.sort(own if single else np.repeat(own, 2))
        own = own[own > RIGID_PART * theirs.max()][: elastic.size]
        worst = 100.0 * float(np.abs(own / elastic[: own.size] - 1.0).max())
        print(f"{name:<12} {symmetry.sectors} sectors, nodal diameter {diameter}: {own.size} frequencies from "
              f"{elastic[0]:.5g}, largest difference {worst:.2e} %")  # fmt: skip


if __name__ == "__main__":
    for each in DECKS:
        try:
            compare(Path(sys.argv[1]), each)
        except StickslipError as error:
            print(f"{each:<12} {error}")
