"""Gmsh .msh (1, 2.2, 4.0, 4.1), VTU, legacy VTK and MED through meshio, with their groups as bodies and sets.

Groups of solid cells are bodies if none overlap (a solid in no group is then rejected), else element sets. Groups of
surface cells are face sets, groups of lines and points node sets. In a .vtu or .vtk a group is an array of 0 and 1, of
cells or of points, and the integer cell array ``body`` numbers the bodies.
"""

from __future__ import annotations

import contextlib
import io
import lzma
import os
import tempfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from stickslip.core.errors import ImportFileError
from stickslip.core.input_files import UnpackedCount, UnsuitableFileError, open_hdf5, open_regular, read_regular
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.gmsh_content import readable_content
from stickslip.formats.meshes.raw_model import RawBlock, RawBody, RawModel, RawSides, fail
from stickslip.structure.cell_kinds import CELL_KINDS, IntArray
from stickslip.structure.meshio_cells import complete_meshio

_SURFACES = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
_LINES = ("vertex", "line", "line3")
# Solids of second order with nodes inside faces or the solid, the default of Gmsh for bricks and wedges.
_WITH_INNER_NODES = ("hexahedron27", "hexahedron24", "hexahedron25", "wedge18", "tetra14", "tetra15")
# The mirrored cell: MED numbers solids in the opposite order of VTK, and most programs that write it do so. Programs
# for which the order has no effect write such cells into other formats, too.
_MIRRORED = {
    "tetra": [0, 2, 1, 3],
    "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
    "wedge": [0, 2, 1, 3, 5, 4],
    "wedge15": [0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13],
    "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
    "hexahedron20": [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17],
}
_VTK_LINE = 1000  # bytes of a line of a VTK header, which has at most 256
Members = list[NDArray[np.bool_]]  # of each block of cells


def read_gmsh(source: Path) -> RawModel:
    """The entries of a Gmsh file: physical groups by name, or "group 3" where they have none."""
    with tempfile.TemporaryDirectory() as folder:
        readable = Path(folder) / "model.msh"
        readable.write_bytes(readable_content(source))
        mesh = _parsed(source, "gmsh", readable)
    groups: dict[str, Members] = {}
    names = {(int(number), int(dim)): name for name, (number, dim) in mesh.field_data.items()}
    tags = mesh.cell_data.get("gmsh:physical", [np.zeros(len(block.data), dtype=int) for block in mesh.cells])
    for at, (block, tag) in enumerate(zip(mesh.cells, tags, strict=True)):
        for number in np.unique(tag):
            if number:
                name = names.get((int(number), int(block.dim)), f"group {number}")
                groups.setdefault(name, _no_members(mesh))[at] |= tag == number
    # a cell in several groups: version 4 lists all of them
    for name, members in mesh.cell_sets.items():
        if not name.startswith("gmsh:"):
            for at, indices in enumerate(members):
                groups.setdefault(name, _no_members(mesh))[at][np.asarray(indices, dtype=np.int64)] = True
    return _raw(source, "Gmsh", mesh, groups, {})


def read_vtu(source: Path) -> RawModel:
    """The entries of a VTU file: cell array ``body``, and arrays of 0 and 1 as sets."""
    return _raw_of_arrays(source, "VTU", _parsed(source, "vtu"))


def read_vtk(source: Path) -> RawModel:
    """The entries of a legacy VTK file with an unstructured grid, as those of a VTU file."""
    with tempfile.TemporaryDirectory() as folder:
        mesh = _parsed(source, "vtk", _closed_copy(source, Path(folder)))
    # SCALARS have a second dimension, also with one value for each point or cell
    mesh.point_data = {name: _one_value(array) for name, array in mesh.point_data.items()}
    mesh.cell_data = {name: [_one_value(array) for array in arrays] for name, arrays in mesh.cell_data.items()}
    return _raw_of_arrays(source, "VTK", mesh)


def _closed_copy(source: Path, folder: Path) -> Path | None:
    """A copy whose last line ends, as meshio requires of binary files and Gmsh omits; None if it is not necessary."""
    try:
        content = read_regular(source)
    except OSError:
        return None  # the reader reports it
    if content[-1:] == b"\n":
        return None
    copy = folder / "model.vtk"
    copy.write_bytes(content + b"\n")
    return copy


def _one_value(array: NDArray[Any]) -> NDArray[Any]:
    return array[:, 0] if array.ndim == 2 and array.shape[1] == 1 else array


def _raw_of_arrays(source: Path, form: str, mesh: Any) -> RawModel:
    """The raw model whose groups are arrays of a VTK file."""
    groups: dict[str, Members] = {}
    for name, arrays in mesh.cell_data.items():
        if not arrays or any(array.ndim != 1 for array in arrays):
            continue  # vectors and tensors of a result
        if name == "body":
            in_solids = [(block.type in CELL_KINDS) & np.ones(len(block.data), dtype=bool) for block in mesh.cells]
            numbers = [_whole(source, name, array)[solid] for array, solid in zip(arrays, in_solids, strict=True)]
            for number in np.unique(np.concatenate(numbers)):
                groups[f"body {number}"] = [
                    np.array(solid & (array == number)) for array, solid in zip(arrays, in_solids, strict=True)
                ]
        elif _is_flag(np.concatenate(arrays)):
            groups[name] = [array.astype(bool) for array in arrays]
    nodes = {name: np.flatnonzero(array) for name, array in mesh.point_data.items() if _is_flag(array)}
    return _raw(source, form, mesh, groups, nodes)


def read_med(source: Path) -> RawModel:
    """The entries of a MED file (Salome, code_aster): groups of cells and of nodes."""
    mesh = _parsed(source, "med")
    groups: dict[str, Members] = {}
    for at, families in enumerate(mesh.cell_data.get("cell_tags", [])):
        for family, names in mesh.cell_tags.items():
            for name in names:
                groups.setdefault(name, _no_members(mesh))[at] |= np.asarray(families) == family
    nodes: dict[str, list[IntArray]] = {}
    for family, names in mesh.point_tags.items():
        for name in names:
            tagged = np.flatnonzero(np.asarray(mesh.point_data.get("point_tags", [])) == family)
            nodes.setdefault(name, []).append(tagged)
    return _raw(source, "MED", mesh, groups, {name: np.concatenate(parts) for name, parts in nodes.items()})


def _parsed(source: Path, kind: str, readable: Path | None = None) -> Any:
    """The file as meshio reads it, or its ``readable`` copy, with checks of known defects of meshio.

    Raises ImportFileError.
    """
    reader: Callable[[str], Any] = getattr(complete_meshio(), kind).read
    output = io.StringIO()
    try:
        with contextlib.redirect_stderr(output), contextlib.redirect_stdout(output), _bounded(source, kind):
            mesh = reader(str(readable or source))
    except ImportFileError:
        raise
    except UnsuitableFileError as error:
        fail(source, f"the file cannot be read ({error.strerror}). Give the path of a model file.")
    # A damaged file can end in any error of meshio, NumPy, HDF5 or an XML parser; all mean that it cannot be read.
    except (Exception, SystemExit) as error:
        detail = str(error).splitlines()[0][:200] if str(error).strip() else type(error).__name__
        fail(source, f"the file is damaged, or not a {kind} file ({detail}). Write it again, as text if it is binary.")
    if "not closed" in output.getvalue():
        fail(source, f"the file is damaged or truncated ({' '.join(output.getvalue().split())[:200]}). Write it again.")
    points = np.asarray(mesh.points)
    if points.ndim != 2 or points.shape[1] != 3 or not np.issubdtype(points.dtype, np.floating):
        fail(source, f"the nodes have the shape {points.shape}; each node requires three coordinates.")
    for block in mesh.cells:
        cells = np.asarray(block.data)
        if block.type not in CELL_KINDS and block.type not in _SURFACES and block.type not in _LINES:
            remedy = ""
            if block.type in _WITH_INNER_NODES:
                remedy = " Omit the nodes inside faces and elements, in Gmsh with Mesh.SecondOrderIncomplete = 1."
            fail(source, f"the element type '{block.type}' is unknown; solids are: {', '.join(CELL_KINDS)}.{remedy}")
        if cells.ndim != 2 or (block.type in CELL_KINDS and cells.shape[1] != CELL_KINDS[block.type].n_nodes):
            fail(source, f"{block.type} cells have the shape {cells.shape}.")
        bad = cells[(cells < 0) | (cells >= len(points))]
        if bad.size:
            fail(source, f"a {block.type} names node {bad[0] + 1}, but the file has nodes 1 to {len(points)}.")
    return mesh


@contextlib.contextmanager
def _bounded(source: Path, kind: str) -> Iterator[None]:
    """Let meshio read a file that is regular, has all its data in itself, and unpacks to no more than is plausible.

    Raises OSError or ImportFileError.
    """
    if kind == "med":
        open_hdf5(source).close()
        yield
        return
    with open_regular(source) as stream:
        count = UnpackedCount(source, os.fstat(stream.fileno()).st_size)
        if kind == "vtk":
            _require_unstructured(source, stream)
    if kind != "vtu":
        yield
        return
    from meshio.vtu import _vtu

    # A VTU file may name the same packed data for many arrays, so that only unpacking shows the size.
    _vtu.zlib, _vtu.lzma = _Unpacker(count, zlib.decompressobj), _Unpacker(count, lzma.LZMADecompressor)
    try:
        yield
    finally:
        _vtu.zlib, _vtu.lzma = zlib, lzma


def _require_unstructured(source: Path, stream: BinaryIO) -> None:
    """Raise ImportFileError for another VTK data set: meshio would make points and cells that no limit bounds."""
    if not stream.readline(_VTK_LINE).startswith(b"# vtk DataFile Version"):
        fail(source, "its first line is not that of a legacy VTK file. Write it again, for example as .vtu.")
    stream.readline(_VTK_LINE)  # title
    stream.readline(_VTK_LINE)  # ASCII or BINARY
    words: list[bytes] = []
    while not words and (line := stream.readline(_VTK_LINE)):
        words = line.split()
    if [word.upper() for word in words] != [b"DATASET", b"UNSTRUCTURED_GRID"]:
        fail(
            source,
            f'it begins with "{line[:40].decode("ascii", "replace").strip()}"; stickslip reads DATASET '
            "UNSTRUCTURED_GRID with solid cells. Write the model as an unstructured grid.",
        )


class _Unpacker:
    """Replaces the module zlib or lzma in meshio's reader, and counts the unpacked bytes."""

    def __init__(self, count: UnpackedCount, new: Callable[[], Any]) -> None:
        self._count, self._new = count, new

    def decompress(self, content: bytes) -> bytes:
        """The whole unpacked content. Raises ImportFileError beyond the limit, ValueError where it is cut off."""
        unpacker = self._new()
        unpacked = b"".join(self._count.pieces(unpacker, content))
        if not unpacker.eof:
            raise ValueError("packed data are cut off")
        return unpacked


def _no_members(mesh: Any) -> Members:
    return [np.zeros(len(block.data), dtype=bool) for block in mesh.cells]


def _is_flag(array: NDArray[Any]) -> bool:
    """Whether an array of cells or points holds one whole number each, 0 or 1."""
    kind = np.issubdtype(array.dtype, np.integer) or array.dtype == bool
    return bool(array.ndim == 1 and kind and np.isin(array, (0, 1)).all() and array.any())


def _whole(source: Path, name: str, array: NDArray[Any]) -> NDArray[Any]:
    if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer):
        fail(source, f"the cell array '{name}' must contain one whole number for each cell.")
    return array


def _raw(source: Path, form: str, mesh: Any, groups: dict[str, Members], nodes: dict[str, IntArray]) -> RawModel:
    """The raw model; nodes and cells are labelled from 1 in the order of the file."""
    raw = RawModel(source, form)
    raw.coordinates = np.asarray(mesh.points, dtype=float)
    raw.node_labels = np.arange(1, len(raw.coordinates) + 1)
    raw.node_lines = np.zeros(len(raw.coordinates), dtype=np.int64)
    ends = np.cumsum([len(block.data) for block in mesh.cells])
    labels = [np.arange(end - len(block.data) + 1, end + 1) for block, end in zip(mesh.cells, ends, strict=True)]
    mirrored = 0
    for block, label in zip(mesh.cells, labels, strict=True):
        if block.type in CELL_KINDS and len(block.data):
            cells, turned = _upright(raw.coordinates, block.type, block.data)
            mirrored += turned
            raw.blocks.append(RawBlock(block.type, label, cells + 1, np.zeros(len(label), dtype=np.int64)))
    if mirrored:
        order = "the node order of MED, not that of VTK" if form == "MED" else "the mirrored order of their nodes"
        raw.messages.append(f"{mirrored} elements have {order}; they are converted.")
    for name, members in nodes.items():
        raw.node_sets[name] = np.unique(members) + 1
    for name, of_block in groups.items():
        _add_group(raw, name, mesh, labels, of_block)
    _make_bodies(raw)
    return raw


def _upright(points: FloatArray, name: str, cells: IntArray) -> tuple[IntArray, int]:
    """Cells in VTK order, and the number of reversed ones, which are inverted at every corner."""
    array = np.array(cells, dtype=np.int64)
    wrong = (CELL_KINDS[name].corner_jacobians(points[array]) < 0.0).all(axis=1)
    array[wrong] = array[wrong][:, _MIRRORED[name]]
    return array, int(wrong.sum())


def _add_group(raw: RawModel, name: str, mesh: Any, labels: list[IntArray], members: Members) -> None:
    """A group as an element set, a face set or a node set, depending on its cells."""
    chosen = [
        (block, label[flags], block.data[flags])
        for block, label, flags in zip(mesh.cells, labels, members, strict=True)
    ]
    solids = [label for block, label, _ in chosen if block.type in CELL_KINDS and label.size]
    surfaces = [(block.type, cells) for block, _, cells in chosen if block.type in _SURFACES and len(cells)]
    nodes = [cells.ravel() for block, _, cells in chosen if block.type in _LINES and len(cells)]
    if solids:
        raw.element_sets[name] = np.concatenate(solids)
    for kind, cells in surfaces:
        corners = np.asarray(cells[:, : _SURFACES[kind]], dtype=np.int64) + 1
        raw.face_sets.setdefault(name, []).append(RawSides(0, corners=corners))
    if nodes and not solids and not surfaces:
        raw.node_sets[name] = np.unique(np.concatenate(nodes)) + 1
    if not (solids or surfaces or nodes):
        raw.fail(f"group '{name}' is empty. Give it members, or remove it.")


def _make_bodies(raw: RawModel) -> None:
    """Bodies from the groups of solids that divide the solids among them; a message where they overlap."""
    if not raw.blocks or not raw.element_sets:
        return
    solids = np.concatenate([block.labels for block in raw.blocks])
    count = np.bincount(np.concatenate(list(raw.element_sets.values())), minlength=solids.max() + 1)[solids]
    if (count > 1).any():
        raw.messages.append("groups of solid elements overlap, so the connected parts are the bodies.")
        return
    raw.bodies += [RawBody(name, members, None, 0) for name, members in raw.element_sets.items()]
