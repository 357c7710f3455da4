"""Cyclic symmetry of Ansys result files: number of sectors, axis, boundary pairs, and the rotation of displacements.

    python benchmarks/compare_ansys_cyclic.py FOLDER

FOLDER has result files (.rst) of one sector, such as those of the tests of ansys-mapdl-reader (MIT licence); the reader
itself is the extra "ansys". Ansys names the nodes of the two boundaries in the components CYCLIC_M..L and CYCLIC_M..H.
Static solutions have harmonic index 0: there the right boundary moves as the left one, rotated.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from ansys.mapdl import reader
from ansys.mapdl.reader.rst import Result

import stickslip as ss

STATIC = 0  # kind of analysis in the header of a result file


def compare(path: Path) -> str:
    """One row of the table."""
    result: Any = reader.read_binary(str(path))
    header = result._resultheader
    numbers, points = result.mesh.nnum, result.mesh.nodes
    place = {number: at for at, number in enumerate(numbers.tolist())}

    def nodes(end: str) -> np.ndarray:
        components = result.node_components.items()
        named = [each.tolist() for name, each in components if name.startswith("CYCLIC_M") and name[-1] == end]
        return np.array([place[number] for each in named for number in each if number in place], dtype=np.int64)

    left, right = nodes("L"), nodes("H")
    if not left.size:
        return f"{path.stem:<16} names no boundaries"
    symmetry = ss.cyclic_symmetry(points, left, right)
    kind = "static" if int(header["kan"]) == STATIC else f"analysis {int(header['kan'])}"
    worst = 0.0
    for step in range(int(header["nsets"])):
        given, motion = Result.nodal_solution(result, step)
        assert np.array_equal(given, numbers)
        turned = motion[symmetry.left, :3] @ symmetry.rotation().T
        size = float(np.abs(motion[:, :3]).max())
        worst = max(worst, float(np.abs(motion[symmetry.right, :3] - turned).max()) / size)
    axis = ", ".join(f"{each:.3g}" for each in symmetry.direction)
    indices = sorted({int(each) for each in result.harmonic_indices})
    return (
        f"{path.stem:<16} {kind:<10} {int(header['nsets'])} sets, harmonic indices {indices}; "
        f"sectors {symmetry.sectors} (Ansys {int(header['nSector'])}) about ({axis}), {symmetry.left.size} pairs; "
        f"u_right - R u_left {worst:.1e} of the largest displacement"
    )


if __name__ == "__main__":
    for each in sorted(Path(sys.argv[1]).glob("*.rst")):
        print(compare(each))
