"""The motion and the stress at the peak of a study as a result file of CalculiX."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.frd import FrdStep, write_frd
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.study.stress import StressAtPeak


def write_peak_frd(path: Path, stress: StressAtPeak, file_numbers: tuple[IntArray, IntArray] | None = None) -> Path:
    """Write displacement and stress at the peak: a static step with their means, then a step for each harmonic.

    The mean contains the state at rest. A harmonic ``c cos(k w t) + s sin(k w t)`` has the real part c, the imaginary
    part -s and the frequency k f. Harmonics without motion are not included. A node that bodies share is in the file
    once for each of them, because the stress jumps there; the numbers of the further nodes follow the largest one.
    ``file_numbers`` are those of the nodes and cells of the mesh, by default from 1. Raises InputError if the file
    cannot be written.
    """
    mesh, rows = _with_own_nodes(stress)
    nodes = stress.nodal.node[rows]
    displacement = stress.displacement.reshape(stress.mesh.n_nodes, 3, -1)[nodes]
    tensor = stress.nodal.stress[rows]
    steps = [FrdStep(None, {"DISP": displacement[:, :, 0], "STRESS": tensor[:, :, 0]})]
    for harmonic in range(1, displacement.shape[2] // 2 + 1):
        cosine, sine = 2 * harmonic - 1, 2 * harmonic
        if displacement[:, :, cosine : sine + 1].any():
            fields: dict[str, FloatArray] = {
                "DISP": displacement[:, :, cosine],
                "STRESS": tensor[:, :, cosine],
                "DISPI": -displacement[:, :, sine],
                "STRESSI": -tensor[:, :, sine],
            }
            steps.append(FrdStep(harmonic * stress.frequency_hz, fields))
    if file_numbers is None:
        return write_frd(path, mesh, steps)
    numbers, cells = file_numbers
    further = numbers.max() + 1 + np.arange(mesh.n_nodes - stress.mesh.n_nodes)
    return write_frd(path, mesh, steps, np.concatenate([numbers, further]), cells)


def _with_own_nodes(stress: StressAtPeak) -> tuple[Mesh, IntArray]:
    """The mesh with nodes of its own for each body, and the row (n_nodes,) of the stress of each node.

    The first body at a node keeps its number.
    """
    mesh, node, body = stress.mesh, stress.nodal.node, stress.nodal.body
    order = np.lexsort((body, node))
    first = np.append(True, np.diff(node[order]) > 0)
    rows = np.concatenate([order[first], order[~first]])
    number = np.empty(len(rows), dtype=np.int64)
    number[rows] = np.arange(len(rows))
    key = body * mesh.n_nodes + node
    sorted_rows = np.argsort(key)
    cells = []
    for block in mesh.blocks:
        wanted = block.body[:, None] * mesh.n_nodes + block.cells
        cells.append(number[sorted_rows[np.searchsorted(key, wanted, sorter=sorted_rows)]])
    return Mesh(mesh.points[node[rows]], tuple(cells), mesh.body, body_names=mesh.body_names), rows
