"""Ansys ``.full`` files (assembled matrices), through the optional package ansys-mapdl-reader."""

from __future__ import annotations

import subprocess
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from stickslip.core.errors import ImportFileError, MissingPackageError
from stickslip.core.processes import python_command
from stickslip.formats.matrices.coordinates import Matrices
from stickslip.formats.matrices.source import file_bytes, numpy_arrays

# -P: the current folder is not in the module search path. The reader is compiled code without checks: a damaged file
# may crash its process or keep it busy for ever.
_SECONDS = 600
_CHILD = """
import sys
import numpy
from ansys.mapdl.reader.full import FullFile
file = FullFile(sys.argv[1])
unknowns, stiffness, mass = file.load_km(sort=False)
constrained = set(map(tuple, file.const.tolist()))  # the reader empties their rows
free = [row for row, unknown in enumerate(unknowns.tolist()) if tuple(unknown) not in constrained]
arrays = {"unknowns": unknowns[free]}
for name, matrix in (("stiffness", stiffness), ("mass", mass)):
    entries = matrix[free][:, free].tocoo()
    arrays |= {f"{name}_row": entries.row, f"{name}_column": entries.col, f"{name}_data": entries.data}
numpy.savez(sys.argv[2], **arrays)
"""


def ansys_full(path: Path) -> Matrices:
    """Matrices ``stiffness`` and ``mass`` of a ``.full`` file, and ``unknowns`` (n, 2): node and direction of each row,
    without constrained displacements.

    The file is read in a process of its own. Raises MissingPackageError without the extra ``stickslip[ansys]``, and
    ImportFileError for a file that is damaged, lumped, unsymmetric or without one of the two matrices.
    """
    import scipy.sparse

    file_bytes(path)
    if find_spec("ansys") is None or find_spec("ansys.mapdl.reader") is None:
        raise MissingPackageError(
            f'"{path}" is an Ansys .full file, which requires the package ansys-mapdl-reader: pip install '
            "'stickslip[ansys]'. Or write the matrices with the command HBMAT (ASCII, with its mapping file)."
        )
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "matrices.npz"
        command = [*python_command(_CHILD), str(path), str(result)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)
        except subprocess.TimeoutExpired as problem:
            raise ImportFileError(f'"{path}" could not be read within {_SECONDS} s; it is damaged.') from problem
        if done.returncode or not result.exists():
            last = (done.stderr.strip().splitlines() or [f"the reader stopped with code {done.returncode}"])[-1]
            raise ImportFileError(f'"{path}" could not be read as an Ansys .full file: {last[:200]}.')
        arrays = numpy_arrays(result)
    unknowns = arrays["unknowns"].astype(np.int64)
    size = len(unknowns)

    def matrix(name: str) -> object:
        row, column, data = (arrays[f"{name}_{part}"] for part in ("row", "column", "data"))
        return scipy.sparse.csr_matrix((data, (row, column)), shape=(size, size))

    return {"stiffness": matrix("stiffness"), "mass": matrix("mass"), "unknowns": unknowns}
