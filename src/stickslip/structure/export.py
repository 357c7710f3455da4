"""Files for ParaView: mode shapes or points in a .vtu, a deflected period as a .pvd series. Complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.files import whole_file, work_folder
from stickslip.core.fourier import synthesis_matrix
from stickslip.core.validation import FloatArray, argument_error, finite_array
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.meshio_cells import complete_meshio


def write_mode_shapes(path: str | Path, mesh: Mesh, modes: FloatArray, frequency_hz: FloatArray) -> Path:
    """Write modes as vector fields ``mode 01, 507.3 Hz`` of one .vtu file; each is scaled to a largest motion of 1.

    Parameters
    ----------
    path:
        file to write; its name must end in ``.vtu``.
    modes:
        (3 * n_nodes, k) displacements of the full mesh (node, then x, y, z).
    frequency_hz:
        (k,)

    Raises
    ------
    InputError
        for shapes that do not fit, a mode of zeros, another suffix, or a folder that cannot be written.
    """
    target = _target(path, ".vtu")
    shapes = _displacement("modes", modes, mesh)
    frequency = finite_array("frequency_hz", frequency_hz)
    if frequency.shape != (shapes.shape[2],):
        raise InputError(
            f"frequency_hz must have shape ({shapes.shape[2]},), one for each mode, but its shape is "
            f"{frequency.shape}.",
            arguments=["frequency_hz"],
        )
    largest = np.linalg.norm(shapes, axis=1).max(axis=0)
    if not largest.all():
        raise InputError(
            f"modes[:, {int(largest.argmin())}] is zero everywhere, so it has no shape to plot.", arguments=["modes"]
        )
    fields = {f"mode {k + 1:02d}, {frequency[k]:.1f} Hz": shapes[:, :, k] / largest[k] for k in range(len(frequency))}
    with whole_file(target, "mode shapes", InputError) as part:
        _write_vtu(part, mesh, fields)
    return target


def write_deflected_period(path: str | Path, mesh: Mesh, coefficients: FloatArray, n_frames: int = 36) -> Path:
    """Write one period of motion as a time series: ``path`` (.pvd) and a folder ``<stem>_frames`` of .vtu files.

    Open the .pvd in ParaView and apply "Warp By Vector" to ``displacement`` (m, with its mean); time runs over the
    period from 0 to 1. The frames are ``u(tau_j) = c_0 + sum_k c_k cos(k tau_j) + s_k sin(k tau_j)``,
    ``tau_j = 2 pi j / n_frames``.

    Parameters
    ----------
    coefficients:
        (3 * n_nodes, 2H + 1) mean, cos 1, sin 1, cos 2, ... of the full mesh, m.

    Raises
    ------
    InputError
        for shapes that do not fit, fewer frames than 2H + 1, another suffix, or a folder that cannot be written.
    """
    target = _target(path, ".pvd")
    series = _displacement("coefficients", coefficients, mesh)
    n_coefficients = series.shape[2]
    if n_coefficients % 2 == 0:
        raise InputError(
            f"coefficients must have 2H + 1 columns (mean, cos 1, sin 1, ...), but there are {n_coefficients}.",
            arguments=["coefficients"],
        )
    if n_frames < n_coefficients:
        raise InputError(
            f"n_frames is {n_frames}; {(n_coefficients - 1) // 2} harmonics require {n_coefficients} frames or more, "
            "and 36 make a smooth animation.",
            arguments=["n_frames"],
        )
    synthesis = synthesis_matrix((n_coefficients - 1) // 2, n_frames)
    frames = target.with_name(f"{target.stem}_frames")
    names = [f"frame_{frame:03d}.vtu" for frame in range(n_frames)]
    entries = "\n".join(
        f'    <DataSet timestep="{frame / n_frames:.6f}" part="0" file="{frames.name}/{name}"/>'
        for frame, name in enumerate(names)
    )
    with work_folder(target, "deflected shape", InputError) as folder:
        (folder / "new").mkdir()
        for name, row in zip(names, synthesis, strict=True):
            _write_vtu(folder / "new" / name, mesh, {"displacement": series @ row})
        (folder / target.name).write_text(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
            f"  <Collection>\n{entries}\n  </Collection>\n</VTKFile>\n",
            encoding="utf-8",
        )
        if frames.exists():
            os.replace(frames, folder / "old")
        os.replace(folder / "new", frames)
        os.replace(folder / target.name, target)
    return target


def write_nodal_fields(
    path: str | Path, mesh: Mesh, node: IntArray, body: IntArray, fields: Mapping[str, FloatArray]
) -> Path:
    """Write fields (p,) on the nodes of each body, such as a stress, as one .vtu file.

    ``node`` and ``body`` (p,) name the rows; a node that bodies share is in the file once for each of them.

    Raises InputError for a field of another length, a node of a body without a row, another suffix, or a folder that
    cannot be written.
    """
    target = _target(path, ".vtu")
    for name, values in fields.items():
        if np.shape(values) != np.shape(node):
            raise InputError(
                f"{name} must have one entry for each of {len(node)} rows, but its shape is {values.shape}."
            )
    key = body * mesh.n_nodes + node
    order = np.argsort(key)
    blocks = []
    for block in mesh.blocks:
        wanted = block.body[:, None] * mesh.n_nodes + block.cells
        at = order[np.searchsorted(key, wanted, sorter=order).clip(0, len(key) - 1)]
        if not np.array_equal(key[at], wanted):
            raise InputError("the rows do not contain every node of every body of the mesh.", arguments=["node"])
        blocks.append((block.kind, at))
    with whole_file(target, "fields of the mesh", InputError) as part:
        _write_cells(part, mesh.points[node], blocks, mesh.body, dict(fields))
    return target


def write_points(path: str | Path, points: FloatArray, fields: Mapping[str, FloatArray]) -> Path:
    """Write points (k, 3) in m with fields (k,) or (k, 3) as one .vtu file of vertices.

    Raises InputError for a field of another length, another suffix, or a folder that cannot be written.
    """
    import meshio

    target = _target(path, ".vtu")
    for name, values in fields.items():
        if len(values) != len(points):
            raise InputError(f"{name} must have one entry for each of {len(points)} points, but it has {len(values)}.")
    vertices = [("vertex", np.arange(len(points))[:, None])]
    with whole_file(target, "points", InputError) as part:
        meshio.Mesh(points, vertices, point_data=dict(fields)).write(part, file_format="vtu")
    return target


def _target(path: str | Path, suffix: str) -> Path:
    target = Path(path)
    if target.suffix != suffix:
        raise InputError(f"{target} must end in {suffix}, the file type that ParaView expects here.")
    return target


def _displacement(name: str, value: FloatArray, mesh: Mesh) -> FloatArray:
    """Return ``value`` (3 * n_nodes, k) as (n_nodes, 3, k); raises InputError for another shape."""
    array = finite_array(name, value)
    if array.ndim != 2 or array.shape[0] != 3 * mesh.n_nodes or not array.shape[1]:
        raise argument_error(
            name,
            f"{name} must have shape ({3 * mesh.n_nodes}, k), three displacements for each of {mesh.n_nodes} nodes, "
            f"but its shape is {array.shape}.",
        )
    return array.reshape(mesh.n_nodes, 3, -1)


def _write_vtu(path: Path, mesh: Mesh, fields: dict[str, FloatArray]) -> None:
    _write_cells(path, mesh.points, mesh.cell_arrays(), mesh.body, fields)


def _write_cells(
    path: Path, points: FloatArray, blocks: list[tuple[str, IntArray]], body: IntArray, fields: dict[str, FloatArray]
) -> None:
    meshio = complete_meshio()
    bodies = np.split(body, np.cumsum([len(cells) for _, cells in blocks])[:-1])
    meshio.Mesh(points, blocks, point_data=fields, cell_data={"body": bodies}).write(path, file_format="vtu")
