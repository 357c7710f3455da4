"""Shared by the tests of matrix files: a small free model, and the same matrices in every kind of file."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
import scipy.sparse

from stickslip.structure.elasticity import Material, assemble

NODES = np.array([3, 5, 8, 12, 20, 21, 40, 41, 50, 51, 60, 77])


def small_model(make_block: Callable[..., Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness and mass (36, 36) of two free bricks, and the positions of their nodes, which have the labels NODES."""
    structure = assemble(make_block((2, 1, 1), (2.0, 1.0, 1.0)), Material())
    return structure.stiffness.toarray(), structure.mass.toarray(), structure.mesh.points


def unknown_rows() -> list[tuple[int, int]]:
    """Node and direction (from 1) of each row."""
    return [(int(node), axis) for node in NODES for axis in (1, 2, 3)]


def coordinates(matrix: np.ndarray, upper: bool = True) -> list[tuple[int, int, float]]:
    """Entries of one triangle, counted from 1; all diagonals."""
    pairs = [(i, j) for j in range(len(matrix)) for i in range(j + 1) if i == j or matrix[i, j]]
    return [(i + 1, j + 1, matrix[i, j]) if upper else (j + 1, i + 1, matrix[i, j]) for i, j in pairs]


def write_calculix(path: Path, matrix: np.ndarray) -> None:
    path.write_text("".join(f"{i} {j} {value:.13e}\n" for i, j, value in coordinates(matrix)))


def write_market(path: Path, matrix: np.ndarray) -> None:
    scipy.io.mmwrite(path, scipy.sparse.coo_matrix(matrix), symmetry="symmetric", precision=17)


def write_market_array(path: Path, matrix: np.ndarray) -> None:
    scipy.io.mmwrite(path, matrix, symmetry="symmetric", precision=17)


def write_npy(path: Path, matrix: np.ndarray) -> None:
    np.save(path, matrix)


def write_sparse_npz(path: Path, matrix: np.ndarray) -> None:
    scipy.sparse.save_npz(path, scipy.sparse.csr_matrix(matrix))


def write_mat(path: Path, matrix: np.ndarray) -> None:
    scipy.io.savemat(path, {"reduced": scipy.sparse.csc_matrix(matrix), "title": "a word"})


def write_mat_73(path: Path, matrix: np.ndarray) -> None:
    sparse = scipy.sparse.csc_matrix(matrix)
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("reduced")
        group.attrs["MATLAB_sparse"] = np.uint64(len(matrix))
        for name, part in (("data", sparse.data), ("ir", sparse.indices), ("jc", sparse.indptr)):
            group[name] = part


def write_harwell_boeing(path: Path, matrix: np.ndarray, kind: str = "RSA", width: int = 25) -> None:
    """Fixed columns as HBMAT writes them, with a right-hand side behind the matrix."""
    sparse = scipy.sparse.csc_matrix(np.tril(matrix) if kind == "RSA" else matrix)
    lines: list[str] = []

    def block(numbers: np.ndarray, per_line: int, form: str) -> int:
        words = [format(number, form) for number in numbers]
        new = ["".join(words[at : at + per_line]) for at in range(0, len(words), per_line)]
        lines.extend(new)
        return len(new)

    counts = [
        block(sparse.indptr + 1, 8, "10d"),
        block(sparse.indices + 1, 8, "10d"),
        block(sparse.data, 3, f"{width}.16e"),
        block(np.zeros(len(matrix)), 3, f"{width}.16e"),
    ]
    sizes = [sum(counts), *counts]
    head = [
        f"{'stiffness':<72}{'K':<8}",
        "".join(f"{count:14d}" for count in sizes),
        f"{kind:<14}" + "".join(f"{count:14d}" for count in (*matrix.shape, sparse.nnz, 0)),
        f"{'(8I10)':<16}{'(8I10)':<16}{f'(3E{width}.16)':<20}{f'(3E{width}.16)':<20}",
        f"{'F':<14}{1:14d}{0:14d}",
    ]
    path.write_text("\n".join([*head, *lines]) + "\n")


def write_op4_text(path: Path, matrix: np.ndarray, name: str = "KRED") -> None:
    size = len(matrix)
    lines = [f"{size:8d}{size:8d}{6:8d}{2:8d}{name:<8}1P,3E23.16"]
    for column in range(size):
        lines.append(f"{column + 1:8d}{1:8d}{size:8d}")
        words = [f"{value:23.16E}" for value in matrix[:, column]]
        lines += ["".join(words[at : at + 3]) for at in range(0, size, 3)]
    lines += [f"{size + 1:8d}{1:8d}{1:8d}", f"{1.0:23.16E}"]
    path.write_text("\n".join(lines) + "\n")


def write_op4_sparse_text(path: Path, matrix: np.ndarray, name: str = "KRED", long_strings: bool = False) -> None:
    size = len(matrix)
    lines = [f"{size:8d}{-size if long_strings else size:8d}{6:8d}{2:8d}{name:<8}1P,3E23.16"]
    for column in range(size):
        runs = _runs(matrix[:, column])
        head = 2 if long_strings else 1
        lines.append(f"{column + 1:8d}{0:8d}{sum(head + 2 * len(values) for _, values in runs):8d}")
        for row, values in runs:
            length = 2 * len(values) + 1
            lines.append(f"{length:8d}{row + 1:8d}" if long_strings else f"{row + 1 + 65536 * length:12d}")
            words = [f"{value:23.16E}" for value in values]
            lines += ["".join(words[at : at + 3]) for at in range(0, len(words), 3)]
    lines += [f"{size + 1:8d}{1:8d}{1:8d}", f"{1.0:23.16E}"]
    path.write_text("\n".join(lines) + "\n")


def write_op4_binary(path: Path, matrix: np.ndarray, name: str = "KRED", order: str = "<", word: int = 4) -> None:
    """Dense columns; words of 8 bytes hold a double as "single precision" (type 1)."""
    size, integer = len(matrix), {4: "i", 8: "q"}[word]

    def record(content: bytes) -> bytes:
        mark = struct.pack(f"{order}i", len(content))
        return mark + content + mark

    kind = 2 if word == 4 else 1
    title = name.ljust(2 * word).encode()
    parts = [record(struct.pack(f"{order}4{integer}", size, size, 6, kind) + title)]
    for column in range(size):
        head = struct.pack(f"{order}3{integer}", column + 1, 1, kind * size)
        parts.append(record(head + matrix[:, column].astype(f"{order}f8").tobytes()))
    parts.append(record(struct.pack(f"{order}3{integer}", size + 1, 1, 1) + np.ones(1, f"{order}f8").tobytes()))
    path.write_bytes(b"".join(parts))


def _runs(column: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Strings of entries that are not zero: first row and values."""
    rows = np.flatnonzero(column)
    return [(int(run[0]), column[run]) for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)]


WRITERS: dict[str, tuple[str, Callable[[Path, np.ndarray], None]]] = {
    "Matrix Market": (".mtx", write_market),
    "Matrix Market array": (".mtx", write_market_array),
    "npy": (".npy", write_npy),
    "sparse npz": (".npz", write_sparse_npz),
    "mat": (".mat", write_mat),
    "mat 7.3": (".mat", write_mat_73),
    "CalculiX": (".sti", write_calculix),
    "RSA": (".matrix", write_harwell_boeing),
    "RUA": (".hb", lambda path, matrix: write_harwell_boeing(path, matrix, "RUA")),
    "OUTPUT4 text": (".op4", write_op4_text),
    "OUTPUT4 sparse text": (".op4", write_op4_sparse_text),
    "OUTPUT4 long strings": (".op4", lambda path, matrix: write_op4_sparse_text(path, matrix, long_strings=True)),
    "OUTPUT4 binary": (".op4", write_op4_binary),
    "OUTPUT4 big-endian": (".op4", lambda path, matrix: write_op4_binary(path, matrix, order=">")),
    "OUTPUT4 64 bits": (".op4", lambda path, matrix: write_op4_binary(path, matrix, word=8)),
}
MAPS: dict[str, Callable[[], str]] = {
    "map.dof": lambda: "".join(f"{node}.{axis}\n" for node, axis in unknown_rows()),
    "map.mapping": lambda: (
        "   Matrix Eqn      Node     DOF\n"
        + "".join(f"{i:10d}{node:10d}     U{'XYZ'[axis - 1]}\n" for i, (node, axis) in enumerate(unknown_rows(), 1))
    ),
    "map.csv": lambda: "node,direction\n" + "".join(f"{node}, {'xyz'[axis - 1]}\n" for node, axis in unknown_rows()),
}
