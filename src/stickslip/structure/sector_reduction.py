"""Reduction of one sector of a disk for each nodal diameter: Craig-Bampton with phase lag between its boundaries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.structure.constraints import Constraints
from stickslip.structure.craig_bampton import checked_boundary
from stickslip.structure.cyclic_sector import (
    SYMMETRIC,
    CyclicSector,
    Direction,
    LaggedMatrices,
    Matrix,
    require_diameter,
    waves_of,
)
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.factor import Backend, factorize
from stickslip.structure.mesh import IntArray
from stickslip.structure.phase_lag import LaggedModel
from stickslip.structure.recovery import FullModel
from stickslip.structure.reduced_matrices import ReducedMatrices, reduced_matrices
from stickslip.structure.sector_boundaries import require_mesh_of
from stickslip.structure.whirling import whirling_frequencies

# chosen: a constraint on the right boundary is that of the left one, rotated, if their entries differ by less.
SAME_CONSTRAINT = 1e-9


def cyclic_sector(
    structure: Structure,
    symmetry: CyclicSymmetry,
    boundary_nodes: ArrayLike,
    *,
    diameters: Sequence[int] | None = None,
    n_modes: int = 30,
    gyroscopic: Any = None,
    backend: Backend = "superlu",
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> CyclicSector:
    """Reduce one sector of a disk for nodal diameters: Craig-Bampton with phase lag between the boundaries.

    For each diameter the right boundary follows the left one of the next sector (:mod:`stickslip.structure.phase_lag`);
    ``boundary_nodes`` and ``n_modes`` modes with these nodes fixed remain, as in :func:`craig_bampton`.

    Parameters
    ----------
    structure:
        the sector with both its boundaries (:func:`assemble`).
    symmetry:
        axis and boundaries (:func:`cyclic_symmetry`) of the mesh of the structure.
    boundary_nodes:
        nodes to keep, of contact, force and output, off the right boundary: :meth:`CyclicSymmetry.own_nodes` gives
        those of pairs.
    diameters:
        nodal diameters 0 to N // 2; None for all. :func:`nodal_diameters` gives those of an engine order.
    n_modes:
        fixed-interface modes of each diameter.
    gyroscopic:
        sparse (n_free, n_free) N s/m, the skew-symmetric matrix of Coriolis forces in the unknowns of the structure,
        such as that of :meth:`stickslip.structure.rotating.RotatingStructure.coriolis_at`; None without them.
    backend, threads, progress:
        as in :func:`craig_bampton`. SuperLU factors the complex matrices of most diameters with any backend.

    Raises
    ------
    InputError
        for a symmetry of another mesh, constraints that differ between the boundaries, a boundary node on the right
        boundary, a nodal diameter that does not exist, a gyroscopic matrix that is not skew-symmetric or of another
        size, and all errors of :func:`craig_bampton`.
    """
    nodes = checked_boundary(boundary_nodes)
    require_mesh_of(structure.mesh, symmetry)
    require_own_nodes(symmetry, nodes)
    wanted = checked_diameters(symmetry, diameters)
    model = lagged_model(structure, symmetry, gyroscopic)
    boundary = np.searchsorted(model.remaining, structure.unknowns_of(nodes).ravel())
    interior = np.setdiff1d(np.arange(model.remaining.size), boundary)
    report = progress or (lambda fraction, detail: None)
    reduced = {}
    with threadpool_limits(limits=1):
        for place, diameter in enumerate(wanted):
            listener = _part_of_progress(report, place, len(wanted), diameter)
            matrices = model.at(diameter, symmetry.sectors)
            node_of = structure.node[model.remaining]
            whirl = model.gyroscopic_at(diameter, symmetry.sectors)
            part = reduced_matrices(matrices, node_of, boundary, interior, n_modes, backend, threads, listener, whirl)
            reduced[diameter] = _hermitian(part)
    return CyclicSector(symmetry.sectors, reduced, nodes, structure.mesh.points[nodes], symmetry)


def require_own_nodes(symmetry: CyclicSymmetry, nodes: IntArray) -> None:
    """Raise InputError for boundary nodes of a reduction on the right boundary of the sector."""
    followers = np.isin(nodes, symmetry.right)
    if followers.any():
        node = int(nodes[followers][0])
        symmetry.homes(nodes)  # of tied boundaries it has no partner
        partner = int(symmetry.left[symmetry.right == node][0])
        raise InputError(
            f"boundary_nodes names node {node} of the right boundary ({int(followers.sum())} such nodes), which is "
            f"node {partner} of the left boundary in the next sector. Name node {partner}, or faces off the boundary.",
            arguments=["boundary_nodes"],
        )


def checked_diameters(symmetry: CyclicSymmetry, diameters: Sequence[int] | None) -> Sequence[int]:
    """The nodal diameters of a reduction, rising; all by default. Raises InputError for one that does not exist."""
    wanted = range(symmetry.sectors // 2 + 1) if diameters is None else sorted(set(diameters))
    for diameter in wanted:
        require_diameter(diameter, symmetry.sectors)
    return wanted


def sector_frequencies(
    structure: Structure,
    symmetry: CyclicSymmetry,
    diameters: Sequence[int],
    count: int,
    gyroscopic: Any = None,
    direction: Direction = "forward",
) -> dict[int, FloatArray]:
    """Nodal diameter -> (count,) Hz, the lowest natural frequencies of the unreduced disk without contact.

    ``structure``, ``symmetry`` and ``gyroscopic`` are those of :func:`cyclic_sector`; ``diameters`` are numbers from 0
    to N // 2. Coriolis forces split the frequencies, and those of the waves in one ``direction`` round the disk result;
    they are computed in the ``2 count + 12`` lowest modes without these forces. Raises InputError for a nodal diameter
    or a direction that does not exist, and for a symmetry or a gyroscopic matrix of another mesh.
    """
    turn = waves_of(1, direction)
    model = lagged_model(structure, symmetry, gyroscopic)
    answer = {}
    for diameter in diameters:
        require_diameter(diameter, symmetry.sectors)
        stiffness, mass, _ = model.at(diameter, symmetry.sectors)
        whirl = model.gyroscopic_at(diameter, symmetry.sectors)
        if whirl is None:
            answer[diameter] = natural_frequencies(stiffness, mass, count)[0]
        else:
            stiffness, mass, whirl = (each if turn > 0 else each.conj() for each in (stiffness, mass, whirl))
            answer[diameter] = whirling_frequencies(stiffness, mass, whirl, count)
    return answer


def _hermitian(part: ReducedMatrices) -> LaggedMatrices:
    """The matrices without the round-off of the reduction."""

    def mended(matrix: Matrix) -> Matrix:
        return np.asarray(0.5 * (matrix + matrix.conj().T))

    damping = None if part.damping is None else mended(part.damping)
    whirl = None if part.gyroscopic is None else 0.5 * (part.gyroscopic - part.gyroscopic.conj().T)
    return LaggedMatrices(mended(part.mass), mended(part.stiffness), damping, part.modes, whirl)


def _part_of_progress(report: ProgressCallback, place: int, count: int, diameter: int) -> Callable[[float, str], None]:
    """Progress of one of ``count`` diameters."""
    return lambda fraction, words: report((place + fraction) / count, f"nodal diameter {diameter}: {words}")


def constant_motion(
    structure: Structure, symmetry: CyclicSymmetry, load: FloatArray, backend: Backend = "superlu"
) -> FloatArray:
    """(n_free,) m static displacements under a load (n_free,) N that is the same in each sector: nodal diameter 0.

    ``load`` is that of the cells of this sector. Raises InputError, see :func:`lagged_model`, and SingularMatrixError.
    """
    require_mesh_of(structure.mesh, symmetry)
    model = lagged_model(structure, symmetry)
    left, right, rotation = boundary_unknowns(structure, symmetry)
    motion = np.zeros(load.shape)
    stiffness = model.stiffness.at(0, symmetry.sectors)
    motion[model.remaining] = factorize(stiffness, backend).solve(
        folded_load(structure, symmetry, load)[model.remaining]
    )
    motion[right] = rotation @ motion[left]
    return motion


def folded_load(structure: FullModel, symmetry: CyclicSymmetry, load: FloatArray) -> FloatArray:
    """(n_free, ...) N of a load (n_free, ...) that is alike in all sectors, with that of the right boundary on the left
    one. Raises InputError, see :func:`lagged_model`."""
    left, right, rotation = boundary_unknowns(structure, symmetry)
    folded = load.copy()
    folded[left] += rotation.T @ load[right]
    return folded


def lagged_model(structure: FullModel, symmetry: CyclicSymmetry, gyroscopic: Any = None) -> LaggedModel:
    """From the matrices of a sector with both its boundaries, and its sparse gyroscopic matrix or None.

    Raises InputError for a gyroscopic matrix that is not skew-symmetric or of another size, for a node that is
    constrained on one boundary and not in the same way on the other, and for ties, rigid bodies and other equations in
    which the nodes of a boundary follow others than their partners on the other boundary do.
    """
    if gyroscopic is not None:
        _require_skew(gyroscopic, structure.stiffness.shape)
    left, right, rotation = boundary_unknowns(structure, symmetry)
    matrices = (structure.stiffness, structure.mass, getattr(structure, "damping", None))
    return LaggedModel.of_unknowns(matrices, left, right, rotation, gyroscopic)


def _require_ties_that_repeat(
    ties: Constraints, symmetry: CyclicSymmetry, left: IntArray, right: IntArray, rotation: Any
) -> None:
    """Raise InputError unless ``u_right = e^{i phi} F u_left`` for any motion of the independent unknowns and any lag.

    ``left`` and ``right`` are the independent ones of both boundaries, and ``rotation`` is F between them.
    """
    here, ahead = (
        ties.transformation[(3 * nodes[:, None] + np.arange(3)).ravel()] for nodes in (symmetry.left, symmetry.right)
    )
    expected = (symmetry.following() @ here).tocsc()
    found = ahead.tocsc()
    others = np.setdiff1d(np.arange(found.shape[1]), right), np.setdiff1d(np.arange(found.shape[1]), left)
    differences = (found[:, right] @ rotation - expected[:, left], found[:, others[0]], expected[:, others[1]])
    error = sum(np.asarray(abs(each).sum(axis=1)).ravel() for each in differences)
    wrong = np.flatnonzero(error > SAME_CONSTRAINT)
    if wrong.size:
        raise InputError(
            f"node {symmetry.right[wrong[0] // 3]} of the right boundary and its partner on the left one are not "
            f"constrained alike, or do not follow other nodes alike by ties, rigid bodies or equations ({wrong.size} "
            "displacements differ). End tied faces off the boundaries, or let nodes of each boundary follow nodes of "
            "this boundary alone.",
            arguments=["structure"],
        )


def _require_skew(matrix: Any, shape: tuple[int, int]) -> None:
    """Raise InputError for a gyroscopic matrix of another shape, or that is not skew-symmetric."""
    if matrix.shape != shape:
        raise InputError(
            f"gyroscopic has shape {matrix.shape}, but the structure has {shape[0]} free unknowns. Give coriolis_at of "
            "the rotating structure of this mesh.",
            arguments=["gyroscopic"],
        )
    if float(abs(matrix + matrix.T).max()) > SYMMETRIC * float(abs(matrix).max()):
        raise InputError(
            "gyroscopic is not skew-symmetric, but Coriolis forces do no work. Give G = -G^T.",
            arguments=["gyroscopic"],
        )


def boundary_unknowns(structure: FullModel, symmetry: CyclicSymmetry) -> tuple[IntArray, IntArray, Any]:
    """The free unknowns of both boundaries and the rotation between them."""
    position = np.full(structure.full_size, -1)
    position[structure.free_unknowns] = np.arange(structure.free_unknowns.size)
    left, right = (position[3 * nodes[:, None] + np.arange(3)].ravel() for nodes in (symmetry.left, symmetry.right))
    follows = symmetry.following()
    unknowns = left[left >= 0], right[right >= 0], follows[right >= 0][:, left >= 0]
    ties = getattr(structure, "constraints", None)
    if ties is not None:
        _require_ties_that_repeat(ties, symmetry, *unknowns)
    elif symmetry.is_tied:
        _require_constraints_that_follow(left >= 0, right >= 0, symmetry, follows)
    else:
        _require_same_constraints(left >= 0, right >= 0, symmetry)
    return unknowns


def _require_constraints_that_follow(left_free: Any, right_free: Any, symmetry: CyclicSymmetry, follows: Any) -> None:
    """Raise InputError unless constrained displacements of a tied right boundary follow constrained ones alone, and
    free ones at least one that is free."""
    moved = np.asarray(abs(follows[:, left_free]).sum(axis=1)).ravel() > SAME_CONSTRAINT
    wrong = np.flatnonzero(moved != right_free)
    if wrong.size:
        node, axis = symmetry.right[wrong[0] // 3], "xyz"[wrong[0] % 3]
        says, other = ("free", "constrained") if right_free[wrong[0]] else ("constrained", "free")
        raise InputError(
            f"node {node} of the right boundary is {says} along {axis}, but the node that it follows on the left "
            f"one is {other} ({wrong.size} displacements differ): a constraint of one boundary must be that of the "
            "other one, rotated. Constrain both, or none.",
            arguments=["left", "right"],
        )


def _require_same_constraints(left_free: Any, right_free: Any, symmetry: CyclicSymmetry) -> None:
    """Raise InputError unless the rotation maps the free directions of each left node on those of its right one."""
    rotation = symmetry.rotation()
    free, expected = right_free.reshape(-1, 3), left_free.reshape(-1, 3)
    rotated = np.einsum("ij,kj,lj->kil", rotation, expected.astype(float), rotation)
    wanted = np.einsum("kj,ij->kij", free.astype(float), np.eye(3))
    wrong = np.flatnonzero(np.abs(rotated - wanted).max(axis=(1, 2)) > SAME_CONSTRAINT)
    if wrong.size:
        first = int(wrong[0])

        def words(flags: Any) -> str:
            return "free" if flags.all() else f"constrained along {', '.join(np.array(list('xyz'))[~flags])}"

        raise InputError(
            f"node {symmetry.left[first]} of the left boundary is {words(expected[first])}, but its partner "
            f"{symmetry.right[first]} on the right is {words(free[first])} ({wrong.size} of {symmetry.left.size} pairs "
            "differ): a constraint of one boundary must be that of the other one, rotated. Constrain both, or none.",
            arguments=["left", "right"],
        )
