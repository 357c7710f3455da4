"""Our elements beside those of CalculiX on the reference mesh of the two blades; needs ``ccx`` on the path.

``python benchmarks/compare_calculix.py [C3D8I ...]``: frequencies of both programs, and the matrices that CalculiX
stores against ours. All five elements take a few minutes.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from calculix import ELEMENTS, blades, frequencies, our_structure, run_calculix, tied
from stickslip.formats.matrices.read import read_matrices

COUNT = 10


def compare(element: str) -> None:
    """Print one element's frequencies and largest relative differences."""
    kind, ours = ELEMENTS[element]
    mesh, pairs = blades(kind, elements=None)
    stiffness, mass, kept = tied(our_structure(mesh, ours), pairs)
    own = frequencies(stiffness, mass, COUNT)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        printed = run_calculix(folder, mesh, element, pairs, COUNT)
        model = read_matrices(folder / "matrices.sti", folder / "matrices.mas")
    solved = frequencies(model.stiffness, model.mass, COUNT)
    # C3D8I has inner unknowns, which are condensed in our element: its stiffness has no entries to compare.
    order = np.argsort(3 * (model.node - 1) + model.direction)[: len(kept)]
    entries = [
        abs(found[order][:, order] - matrix).max() / abs(matrix).max()
        for found, matrix in ((model.stiffness, stiffness), (model.mass, mass))
    ]
    print(f"{element}: {len(kept)} unknowns in the mesh, {model.size} in CalculiX")
    print("  CalculiX Hz:", *(f"{value:.2f}" for value in printed))
    print("  ours Hz:    ", *(f"{value:.2f}" for value in own))
    print(f"  ours / CalculiX - 1: {np.abs(own / printed - 1).max():.1e}")
    print(f"  its matrices solved by us / its print - 1: {np.abs(solved / printed - 1).max():.1e}")
    print("  entries of K and M:", *(f"{value:.1e}" for value in entries))


if __name__ == "__main__":
    for chosen in sys.argv[1:] or ELEMENTS:
        compare(chosen)
