"""Stress of stickslip beside that of CalculiX on the default two blades; needs ``ccx`` on the path.

``python benchmarks/compare_calculix_stress.py``: both programs have the same displacements of all nodes, those of the
first tied mode. It takes less than a minute.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from calculix import blades, our_structure, tied
from calculix_stress import calculix_stress, our_stress, rounded
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.stress_cycle import von_mises


def main() -> None:
    """Print the largest and the median difference of both bricks with eight nodes."""
    mesh, pairs = blades("hexahedron", elements=None)
    stiffness, mass, kept = tied(our_structure(mesh, "incompatible"), pairs)
    motion = np.zeros(3 * mesh.n_nodes)
    motion[kept] = natural_frequencies(stiffness, mass, 1)[1][:, 0]
    of_node = motion.reshape(-1, 3)
    of_node[pairs.second_node] = of_node[pairs.first_node]
    displacement = rounded(2e-4 * motion / np.abs(motion).max())
    for element, ours in (("C3D8", "trilinear"), ("C3D8I", "incompatible")):
        with tempfile.TemporaryDirectory() as folder:
            theirs, _ = calculix_stress(Path(folder), mesh, element, displacement)
        own = our_stress(our_structure(mesh, ours), displacement)
        difference = np.abs(own - theirs).max(axis=(1, 2)) / np.abs(theirs).max()
        highest = von_mises(own).max() / von_mises(theirs).max() - 1.0
        print(f"{element}, differences over the largest stress:")
        print(f"  largest {difference.max():.1e}, median of the cells {np.median(difference):.1e}")
        print(f"  largest von Mises stress {highest:+.1e}")


if __name__ == "__main__":
    main()
