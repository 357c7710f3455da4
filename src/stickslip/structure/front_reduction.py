"""Reduction of a large mesh or boundary by the fronts of :mod:`stickslip.structure.multifrontal`."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.core.errors import InputError, SingularMatrixError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import ROUND_OFF_SHIFT, Structure, mean_ratio, natural_frequencies
from stickslip.structure.factor import PARDISO_SIZE, Factor, checked_solver
from stickslip.structure.floating_parts import floating_message
from stickslip.structure.mesh import IntArray
from stickslip.structure.multifrontal import condensed
from stickslip.structure.reduced_matrices import (
    LARGE_BOUNDARY,
    ReducedMatrices,
    fixed_interface_modes,
    require_modes,
)

# chosen: from this number of interior unknowns on fronts are faster (docs/performance.md).
LARGE_INTERIOR = PARDISO_SIZE


def fronts_pay(boundary: IntArray, interior: IntArray) -> bool:
    """True if the reduction of a mesh to this boundary is faster by fronts than by a factor of the interior."""
    return len(boundary) >= LARGE_BOUNDARY or len(interior) >= LARGE_INTERIOR


def reduced_by_fronts(
    matrices: tuple[Any, Any, Any],
    of_mesh: tuple[IntArray, FloatArray],
    boundary: IntArray,
    interior: IntArray,
    n_modes: int,
    threads: int,
    report: ProgressCallback,
) -> ReducedMatrices:
    """The reduction of stiffness and mass of a mesh with a large boundary, without constraint modes.

    Arguments and errors are those of :func:`stickslip.structure.reduced_matrices.reduced_matrices`; ``of_mesh`` are the
    node of each unknown and the positions of the nodes. See :mod:`stickslip.structure.multifrontal`;
    ``Psi^T M_ii Phi = -K_bi K_ii^-1 M_ii Phi`` of the modes.
    """
    require_modes(n_modes, interior)
    stiffness, mass, _ = matrices
    count = len(boundary)
    report(0.0, f"condensation of {len(interior)} unknowns")
    try:
        fronts, (reduced_stiffness, reduced_mass) = condensed(
            (stiffness, mass), *of_mesh, boundary, interior, n_modes, threads,
            lambda done: report(0.7 * done, f"condensation of {len(interior)} unknowns"),
        )  # fmt: skip
        # not before the elimination: it takes as much memory as the stiffness itself
        inner_stiffness = stiffness[interior][:, interior]
        residual = checked_solver(inner_stiffness, fronts.solve, "multifrontal")
    except SingularMatrixError as error:
        raise InputError(floating_message(stiffness[interior][:, interior], of_mesh[0][interior])) from error
    factor, inner_mass = Factor(len(interior), residual, threads, fronts.solve), mass[interior][:, interior]
    squared, modes = fixed_interface_modes(
        inner_stiffness, inner_mass, factor, n_modes, lambda _, words: report(0.7, words), by_blocks=True
    )
    weighted = inner_mass @ modes
    coupling = mass[boundary][:, interior] @ modes - stiffness[boundary][:, interior] @ factor.solve(weighted)
    reduced_mass[:count, count:], reduced_mass[count:, :count] = coupling, coupling.T
    corner = modes.T @ weighted
    reduced_mass[count:, count:] = 0.5 * (corner + corner.T)
    reduced_stiffness[count:, count:] = np.diag(squared)
    return ReducedMatrices(reduced_mass, reduced_stiffness, None, modes, factor)


def lowest_mesh_modes(
    structure: Structure, stiffness: Any, count: int, threads: int = 1
) -> tuple[FloatArray, FloatArray]:
    """The lowest modes of a mesh with another stiffness (n_free, n_free), such as one with springs.

    Frequencies (count,) in Hz and mass-normalised modes (n_free, count).

    A large mesh is factored by fronts, and the modes come from blocks of vectors. Raises InputError and
    ConvergenceError as :func:`natural_frequencies` does, and SingularMatrixError.
    """
    mass, every = structure.mass, np.arange(structure.stiffness.shape[0])
    none = every[:0]
    if not fronts_pay(none, every):
        return natural_frequencies(stiffness, mass, count)
    shift = -ROUND_OFF_SHIFT * mean_ratio(stiffness, mass)
    shifted = (stiffness - shift * mass).tocsr()
    fronts, _ = condensed((shifted,), structure.node, structure.mesh.points, none, every, 0, threads)
    factor = Factor(len(every), checked_solver(shifted, fronts.solve, "multifrontal"), threads, fronts.solve)
    return natural_frequencies(stiffness, mass, count, shift, factor, by_blocks=True)
