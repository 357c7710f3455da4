"""Reduced structures and their modes, cached on disk: the same mesh, material and nodes are computed once.

The folder is ``$STICKSLIP_CACHE`` ("off": no cache), else ``stickslip`` in the user's cache folder. The name of a file
is a digest of all inputs of the reduction: the matrices, the nodes, and the code of this package. A file with a wrong
seal is not used: a warning names it, and it is computed again. Above ``LARGEST_FOLDER`` the oldest files are removed.
"""

from __future__ import annotations

import hashlib
import os
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import ResultsFileError, StickslipError, StickslipWarning
from stickslip.core.files import remove_abandoned, source_digest, user_cache_folder, whole_file
from stickslip.core.seal import require_seal, seal
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import NodePairs, joined_modes
from stickslip.structure.mesh import IntArray
from stickslip.structure.recovery import Recovery
from stickslip.structure.superelement import Superelement

Arrays = dict[str, FloatArray]

VARIABLE = "STICKSLIP_CACHE"
LARGEST_FOLDER = 1_000_000_000  # bytes


def cached_superelement(
    structure: Structure, boundary_nodes: IntArray, n_modes: int, reduce: Callable[[], Superelement]
) -> Superelement:
    """The superelement ``reduce()`` of these inputs, from the disk if it was computed before.

    If the folder cannot be written, the next run only takes longer.
    """
    made: list[Superelement] = []

    def compute() -> Arrays:
        made.append(reduce())
        new = made[0]
        return {"mass": new.mass, "stiffness": new.stiffness, "modes": new.recovery.modes}

    arrays = cached_arrays("superelement", input_digest(structure, boundary_nodes, np.array([n_modes])), compute)
    if made:
        return made[0]
    return stored_superelement(structure, boundary_nodes, arrays)


def stored_superelement(structure: Structure, boundary_nodes: IntArray, arrays: Arrays) -> Superelement:
    """The superelement of mass, stiffness and fixed-interface modes of a file."""
    recovery = Recovery(structure, boundary_nodes, arrays["modes"])
    return Superelement(arrays["mass"], arrays["stiffness"], boundary_nodes=boundary_nodes, recovery=recovery)


def cached_tied_modes(structure: Structure, pairs: NodePairs, count: int) -> tuple[FloatArray, FloatArray]:
    """:func:`stickslip.structure.joined.joined_modes` of a full structure with tied pairs, cached in the same way."""

    def compute() -> Arrays:
        frequency_hz, modes = joined_modes(structure, pairs, count)
        return {"frequency_hz": frequency_hz, "modes": modes}

    sides = (pairs.first_nodes, pairs.first_weights, pairs.second_nodes, pairs.second_weights)
    arrays = cached_arrays("modes", input_digest(structure, *sides, np.array([count])), compute)
    return arrays["frequency_hz"], arrays["modes"]


def cached_arrays(kind: str, digest: str, compute: Callable[[], Arrays]) -> Arrays:
    """The arrays of a file, or those of ``compute()``, which are then written for the next run."""
    folder = cache_folder()
    if folder is None:
        return compute()
    path = folder / f"{kind}-{digest}.npz"
    arrays = _read(path)
    if arrays is None:
        arrays = compute()
        _write(path, arrays)
    return arrays


def cache_folder() -> Path | None:
    """Folder of reduced structures; None if the user switched the cache off or has no home folder."""
    chosen = os.environ.get(VARIABLE)
    if chosen is not None:
        return None if chosen.strip().lower() in ("", "off") else Path(chosen)
    base = user_cache_folder()
    return None if base is None else base / "stickslip"


def input_digest(structure: Structure, *numbers: NDArray[Any]) -> str:
    """Digest of the matrices and constraints of a structure, of further arrays, and of the code of this package."""
    digest = hashlib.blake2b(_code(), digest_size=16)
    for matrix in (structure.stiffness, structure.mass):
        for array in (matrix.indptr, matrix.indices, matrix.data):
            digest.update(np.ascontiguousarray(array).tobytes())
    tie = structure.constraints
    of_tie = () if tie is None else tuple(getattr(tie.transformation, name) for name in ("indptr", "indices", "data"))
    for numbers_of in (structure.free_unknowns, np.array([structure.mesh.n_nodes]), *of_tie, *numbers):
        digest.update(
            f"{numbers_of.dtype.kind}{numbers_of.shape}".encode() + np.ascontiguousarray(numbers_of).tobytes()
        )
    return digest.hexdigest()


@cache
def _code() -> bytes:
    """Digest of the modules that reduce structures: results of other code are not used."""
    return source_digest(Path(__file__).parent.rglob("*.py")).encode()


def _read(path: Path) -> Arrays | None:
    """The arrays of a file; None if there is none, or, with a warning, if it is damaged."""
    try:
        with path.open("rb") as stream:
            require_seal(stream, path.stem)
            with np.load(stream, allow_pickle=False) as data:
                arrays = {name: data[name] for name in data.files}
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ResultsFileError) as error:
        problem = f"{error.strerror}." if isinstance(error, OSError) else error
        sentence = f'The reduced structure in "{path}" is not used: {problem} It is computed again.'
        warnings.warn(sentence, StickslipWarning, stacklevel=2)
        return None
    with suppress(OSError):  # the folder may be read-only
        os.utime(path)  # the last used file is removed last
    return arrays


def _write(path: Path, arrays: Arrays) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path, "stored structure", StickslipError) as part, part.open("w+b") as stream:
            np.savez(stream, allow_pickle=False, **arrays)
            seal(stream, path.stem)
        _free_space(path.parent)
    except (OSError, StickslipError):
        return


def _free_space(folder: Path) -> None:
    """Remove unfinished files of killed runs, and the least recently used files until the folder is small enough."""
    remove_abandoned(folder)
    files = sorted(folder.glob("*.npz"), key=lambda file: file.stat().st_mtime)
    total = sum(file.stat().st_size for file in files)
    for file in files:
        if total <= LARGEST_FOLDER:
            return
        total -= file.stat().st_size
        file.unlink(missing_ok=True)
