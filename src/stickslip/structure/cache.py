"""Reduced structures kept on disk: the same mesh, material and boundary nodes are reduced once.

The folder is ``$STICKSLIP_CACHE`` ("off" keeps nothing), else ``stickslip`` in the user's cache folder. The name of a
file is a digest of all that the reduction depends on: the matrices, the nodes, and the code of this package. A file
that cannot be read is computed again; the oldest files give way beyond ``LARGEST_FOLDER``.
"""

from __future__ import annotations

import hashlib
import os
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, StickslipError
from stickslip.files import whole_file
from stickslip.structure.elasticity import Structure
from stickslip.structure.recovery import Recovery
from stickslip.structure.superelement import Superelement

VARIABLE = "STICKSLIP_CACHE"
LARGEST_FOLDER = 1_000_000_000  # bytes


def cached_superelement(
    structure: Structure, boundary_nodes: NDArray[np.int64], n_modes: int, reduce: Callable[[], Superelement]
) -> Superelement:
    """The superelement that ``reduce()`` gives for these inputs, from the disk if it was computed before.

    A folder that cannot be written only costs the time of the next run; nothing else depends on it.
    """
    folder = cache_folder()
    if folder is None:
        return reduce()
    path = folder / f"superelement-{_key(structure, boundary_nodes, n_modes)}.npz"
    kept = _read(path, structure)
    if kept is not None:
        return kept
    superelement = reduce()
    _write(path, superelement)
    return superelement


def cache_folder() -> Path | None:
    """Where reduced structures are kept; None if the user wants none."""
    chosen = os.environ.get(VARIABLE)
    if chosen is not None:
        return None if chosen.strip().lower() in ("", "off") else Path(chosen)
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(base) if base else Path.home() / ".cache") / "stickslip"


def _key(structure: Structure, boundary_nodes: NDArray[np.int64], n_modes: int) -> str:
    digest = hashlib.blake2b(_code(), digest_size=16)
    for matrix in (structure.stiffness, structure.mass):
        for array in (matrix.indptr, matrix.indices, matrix.data):
            digest.update(np.ascontiguousarray(array).tobytes())
    for array in (structure.free_unknowns, boundary_nodes, np.array([structure.mesh.n_nodes, n_modes])):
        digest.update(np.asarray(array, dtype=np.int64).tobytes())
    return digest.hexdigest()


@cache
def _code() -> bytes:
    """Digest of the modules that make superelements: results of an older version are never taken."""
    digest = hashlib.blake2b()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.digest()


def _read(path: Path, structure: Structure) -> Superelement | None:
    """The superelement of a file; None if there is none, or if it is damaged."""
    try:
        with path.open("rb") as stream, np.load(stream) as data:
            nodes = data["boundary_nodes"]
            kept = Superelement(
                mass=data["mass"],
                stiffness=data["stiffness"],
                boundary_nodes=nodes,
                recovery=Recovery(structure, nodes, data["modes"]),
            )
        os.utime(path)  # the file used last is the last to go
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile, InputError):
        return None
    return kept


def _write(path: Path, superelement: Superelement) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path, "reduced structure", StickslipError) as part, part.open("wb") as stream:
            np.savez(
                stream,
                mass=superelement.mass,
                stiffness=superelement.stiffness,
                boundary_nodes=superelement.boundary_nodes,
                modes=superelement.recovery.modes,
            )
        _make_room(path.parent)
    except (OSError, StickslipError):
        return


def _make_room(folder: Path) -> None:
    """Remove the files that were not used for longest until the folder is small enough."""
    files = sorted(folder.glob("superelement-*.npz"), key=lambda file: file.stat().st_mtime)
    total = sum(file.stat().st_size for file in files)
    for file in files:
        if total <= LARGEST_FOLDER:
            return
        total -= file.stat().st_size
        file.unlink(missing_ok=True)
