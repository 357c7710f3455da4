"""Craig-Bampton reduction: boundary nodes stay, constraint modes and fixed-interface modes represent the interior."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.structure.cache import cached_tied_modes
from stickslip.structure.elasticity import Structure
from stickslip.structure.factor import Backend
from stickslip.structure.front_reduction import fronts_pay, reduced_by_fronts
from stickslip.structure.joined import NodePairs, joined_modes
from stickslip.structure.mesh import IntArray
from stickslip.structure.recovery import FullModel, Recovery, partition
from stickslip.structure.reduced_matrices import reduced_matrices
from stickslip.structure.superelement import Superelement


def craig_bampton(
    structure: FullModel,
    boundary_nodes: ArrayLike,
    n_modes: int = 30,
    backend: Backend = "superlu",
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Superelement:
    """Reduce a structure to its boundary nodes and ``n_modes`` fixed-interface modes.

    ``u_i = Psi u_b + Phi q`` with the constraint modes ``Psi = -K_ii^-1 K_ib`` and the modes
    ``K_ii Phi = M_ii Phi Lambda`` (mass-normalised). Reduced stiffness ``diag(K_bb + K_bi Psi, Lambda)``, reduced mass
    with ``M_bq = Psi^T M_ii Phi + M_bi Phi`` and ``M_qq = I``; a damping matrix is projected as the mass is.

    Parameters
    ----------
    structure:
        a structure, or the matrices of another program (:class:`MatrixModel`).
    boundary_nodes:
        nodes to keep, in the order of the unknowns: node ``boundary_nodes[i]`` owns unknowns 3i, 3i + 1, 3i + 2.
    n_modes:
        number of fixed-interface modes; their amplitudes are the last unknowns. 0 gives the Guyan reduction.
    backend, threads:
        how to factor, and how many blocks of columns to work on at a time
        (:func:`stickslip.structure.factor.factorize`). ``"superlu"``: where that is faster and there is no damping
        matrix, a mesh is eliminated by fronts instead; the numbers are the same for any ``threads``.
    progress:
        called with the finished fraction and a sentence, for a large mesh with the expected time of its factor.

    Returns
    -------
    Superelement
        with 3 * n_boundary + n_modes unknowns and a ``recovery`` of shape (full_size, n) to the full model.

    Raises
    ------
    InputError
        for an empty boundary, a node that is repeated, fixed or does not exist, a mode count out of range, and a
        boundary that leaves a body free to move (singular ``K_ii``): the message names the unsupported part.

    Source: R. R. Craig, M. C. C. Bampton, Coupling of substructures for dynamic analyses, AIAA J. 6 (1968) 1313-1319.
    """
    # The last digits of a matrix product depend on the threads of the linear algebra, and a curve that folds amplifies
    # them to 1e-6. Therefore each product has one thread, and several products run at a time.
    with threadpool_limits(limits=1):
        return _reduced(structure, boundary_nodes, n_modes, backend, threads, progress)


def _reduced(
    structure: FullModel,
    boundary_nodes: ArrayLike,
    n_modes: int,
    backend: Backend,
    threads: int,
    progress: ProgressCallback | None,
) -> Superelement:
    """:func:`craig_bampton` with one thread for each product of the linear algebra."""
    nodes = checked_boundary(boundary_nodes)
    boundary, interior = partition(structure, nodes)
    report = progress or (lambda fraction, detail: None)
    damping, mesh = getattr(structure, "damping", None), getattr(structure, "mesh", None)
    matrices = (structure.stiffness, structure.mass, damping)
    if backend == "superlu" and damping is None and mesh is not None and fronts_pay(boundary, interior):
        of_mesh = structure.node, mesh.points
        reduced = reduced_by_fronts(matrices, of_mesh, boundary, interior, n_modes, threads, report)
    else:
        reduced = reduced_matrices(matrices, structure.node, boundary, interior, n_modes, backend, threads, report)
    recovery = Recovery(structure, nodes, reduced.modes, backend, threads, reduced.factor)
    return Superelement(reduced.mass, reduced.stiffness, reduced.damping, boundary_nodes=nodes, recovery=recovery)


def checked_boundary(boundary_nodes: ArrayLike) -> IntArray:
    """Boundary nodes as integers after checking that they come once; raises InputError."""
    nodes = np.asarray(boundary_nodes).ravel()
    if not nodes.size or not np.issubdtype(nodes.dtype, np.integer):
        raise InputError(
            "boundary_nodes must be node numbers (integers), and at least one.", arguments=["boundary_nodes"]
        )
    unique, count = np.unique(nodes, return_counts=True)
    if count.max() > 1:
        raise InputError(
            f"boundary_nodes names node {unique[count.argmax()]} {count.max()} times; name it once.",
            arguments=["boundary_nodes"],
        )
    return nodes.astype(np.int64)


@dataclass(frozen=True)
class ReductionRow:
    """One mode before and after reduction.

    Difference and modal assurance are not a number for a body that moves freely: its frequency is 0 Hz, and its
    modes are any combination of its motions.
    """

    mode: int
    full_hz: float
    reduced_hz: float
    difference_percent: float
    mac: float


def reduction_table(
    structure: Structure,
    superelement: Superelement,
    pairs: NodePairs,
    count: int = 10,
    springs: FloatArray | None = None,
) -> tuple[ReductionRow, ...]:
    """Frequencies of the full and the reduced model with tied contact, or stuck contact when ``springs`` are given.

    ``springs`` (3 * n_pairs,) N/m, t1, t2, n of each pair; 0 for a pair that is open. The difference is
    ``100 (reduced / full - 1)`` and the modal assurance criterion ``|a.b|^2 / (a.a b.b)`` compares the modes on the
    full mesh; neither is a number for rigid-body modes. Raises InputError for a superelement without recovery.
    """
    if superelement.recovery is None:
        raise InputError("reduction_table requires a superelement with a recovery, such as that of craig_bampton.")
    if springs is None:
        full_hz, full = cached_tied_modes(structure, pairs, count)
    else:
        full_hz, full = joined_modes(structure, pairs, count, springs)
    reduced_hz, reduced = joined_modes(superelement, pairs, count, springs)
    product = np.einsum("ij,ij->j", full, reduced)
    mac = product**2 / (np.einsum("ij,ij->j", full, full) * np.einsum("ij,ij->j", reduced, reduced))
    elastic = np.minimum(full_hz, reduced_hz) > 0.0
    mac[~elastic] = np.nan
    difference = np.full(count, np.nan)
    difference[elastic] = 100.0 * (reduced_hz[elastic] / full_hz[elastic] - 1.0)
    columns = zip(full_hz, reduced_hz, difference, mac, strict=True)
    return tuple(ReductionRow(place + 1, *map(float, cells)) for place, cells in enumerate(columns))
