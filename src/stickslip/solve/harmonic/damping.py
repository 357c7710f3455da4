"""Viscous damping: modal ratios or a full matrix, and which of them the stuck modes diagonalise."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse.csgraph
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.operator_products import with_springs
from stickslip.structure.superelement import Superelement

# chosen: modal damping ratios apply up to this multiple of the highest excitation frequency, which includes the excited
# modes and their harmonics but not modes that only deform the joint.
DAMPED_RANGE = 20.0
# chosen: coupling of two modes by springs, over the roots of their own stiffnesses, that is round-off: those of the two
# blades are 1e-12 to 1e-10 where the symmetry forbids them. Without it, squares of n modes change by n times this.
UNCOUPLED = 1e-10


def stuck_stiffness_matrix(superelement: Superelement, pairs: ContactPairs) -> FloatArray:
    """``K + B^T diag(k_t1, k_t2, k_n) B`` (n, n): every pair that is closed at rest is stuck, the others are open."""
    return superelement.stiffness + with_springs(pairs.operator, pairs.resting_stiffness())


def modal_basis(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """All modes of ``(K - w^2 M) phi = 0``: ``w`` (n,) rad/s ascending and mass-normalised ``phi`` (n, n).

    The matrices are symmetric, or complex and Hermitian.
    Slightly negative eigenvalues of rigid-body modes (round-off) become zero. Raises InputError for a mass matrix that
    is not positive definite, or a stiffness matrix with a clearly negative eigenvalue.
    """
    try:
        squares, modes = scipy.linalg.eigh(stiffness, mass)
    except scipy.linalg.LinAlgError as error:
        raise InputError(
            "the mass matrix is not positive definite, so the structure has no vibration modes. Check for unknowns "
            "without mass and condense them, or for a wrong sign."
        ) from error
    largest = float(np.abs(squares).max())
    if squares[0] < -1e-8 * largest:
        raise InputError(
            f"the stiffness matrix has the negative eigenvalue {squares[0]:.3g} (rad/s)^2; a structure at rest must be "
            "positive semi-definite. Check for a wrong sign or for unknowns in another order than in the mass matrix."
        )
    return np.sqrt(np.maximum(squares, 0.0)), modes


def changed_basis(
    circular_frequency: FloatArray, modes: FloatArray, contact_modes: FloatArray, springs: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The same as :func:`modal_basis` for springs of the pairs that are larger by ``springs`` (m,) N/m than those of
    known modes: frequencies (n,) rad/s, modes (n, n) and their relative displacements (m, n).

    In the known modes the mass matrix is that of unity, so that the problem is a standard one, a fifth cheaper. Modes
    that the springs do not couple, as symmetric and antisymmetric ones of two equal blades, are problems of their own.
    """
    stiffness = contact_modes.T @ (springs[:, None] * contact_modes)
    np.fill_diagonal(stiffness, stiffness.diagonal() + circular_frequency**2)
    squares, changed, blocks = np.empty(len(stiffness)), np.empty_like(modes), _uncoupled(stiffness)
    ends = np.cumsum([block.size for block in blocks])

    def solve(start: int, stop: int) -> None:
        for block, end in zip(blocks[start:stop], ends[start:stop], strict=True):
            own = slice(end - block.size, end)
            squares[own], shapes = np.linalg.eigh(stiffness[np.ix_(block, block)])  # releases the lock, unlike scipy's
            changed[:, own] = modes[:, block] @ shapes

    in_shares(solve, len(blocks), 1)
    order = np.argsort(squares, kind="stable")
    return np.sqrt(np.maximum(squares[order], 0.0)), changed[:, order]


def _uncoupled(stiffness: FloatArray) -> list[NDArray[np.intp]]:
    """Positions of the unknowns of a positive semi-definite matrix that other blocks do not change."""
    size = np.sqrt(np.abs(stiffness.diagonal()))
    coupled = np.abs(stiffness) > UNCOUPLED * size[:, None] * size
    left, blocks = np.ones(size.size, dtype=np.bool_), []
    while left.any():
        block, added = np.zeros_like(left), np.zeros_like(left)
        added[np.argmax(left)] = True
        while added.any():
            block |= added
            added = coupled[added].any(axis=0) & ~block
        left &= ~block
        blocks.append(np.flatnonzero(block))
    return blocks


def modal_damping(circular_frequency: FloatArray, ratio: float, highest_omega: float) -> FloatArray:
    """``2 ratio w`` (n,) for the stuck modes up to DAMPED_RANGE times the highest excitation, zero above.

    Modes far above the excitation only deform the joint and its surroundings. Damping them would put a dashpot across
    the joint that also works while it slips or is open, and that grows with the contact stiffness.
    """
    return np.where(circular_frequency <= DAMPED_RANGE * highest_omega, 2.0 * ratio * circular_frequency, 0.0)


def modal_damping_change(
    circular_frequency: FloatArray,
    ratio: float,
    highest_omega: float,
    stiffness: FloatArray | None = None,
    mass: FloatArray | None = None,
) -> FloatArray:
    """(n, n) derivative of the damping of modal ratios, in the stuck modes, from those of the matrices there (n, n).

    ``C = M phi diag(g) phi^T M`` with ``g_j`` of :func:`modal_damping` follows the modes. With ``K' = phi^T Kbar' phi``
    and ``M' = phi^T M' phi``, each zero where it is None, its derivative is, entry by entry,

        C'_ij = K'_ij (g_i - g_j) / (l_i - l_j) + M'_ij (g_j l_i - g_i l_j) / (l_i - l_j),   l = w^2.
    """
    omega = circular_frequency
    damped = omega <= DAMPED_RANGE * highest_omega
    total = omega[:, None] + omega
    inverse = np.divide(2.0 * ratio, total, out=np.zeros_like(total), where=total > 0.0)
    by_stiffness, by_mass = inverse, inverse * np.outer(omega, omega)
    damping, squares = modal_damping(omega, ratio, highest_omega), omega**2
    mixed = damped[:, None] != damped
    gaps = np.where(mixed, squares[:, None] - squares, 1.0)
    crossed = (damping * squares[:, None] - damping[:, None] * squares) / gaps
    by_stiffness = np.where(mixed, (damping[:, None] - damping) / gaps, by_stiffness)
    by_mass = np.where(mixed, crossed, by_mass)
    neither = ~(damped[:, None] | damped)
    change = np.zeros_like(total)
    for form, factor in ((stiffness, by_stiffness), (mass, by_mass)):
        if form is not None:
            change += np.where(neither, 0.0, factor) * form
    return change


def modal_damping_matrix(mass: FloatArray, modes: FloatArray, modal: FloatArray) -> FloatArray:
    """``C = M phi diag(modal) phi^T M`` (n, n) N s/m for mass-normalised ``phi``."""
    root = damping_root(mass, modes, modal)
    return np.asarray(root @ root.conj().T)


def damping_root(mass: FloatArray, modes: FloatArray, modal: FloatArray) -> FloatArray:
    """R (n, p) with ``R R^H = M phi diag(modal) phi^T M`` of the p modes that have damping.

    They are few: modes far above the excitation have none.
    """
    damped = np.flatnonzero(modal)
    return np.asarray(mass @ modes[:, damped] * np.sqrt(modal[damped]))


def diagonal_modal_damping(damping: FloatArray, modes: FloatArray, tolerance: float = 1e-9) -> FloatArray | None:
    """Diagonal (n,) of ``phi^T C phi``, or None if the modes do not diagonalise ``damping`` to ``tolerance``."""
    projected = modes.conj().T @ damping @ modes
    diagonal = np.diag(projected).real.copy()
    scale = np.sqrt(np.outer(np.abs(diagonal), np.abs(diagonal))) + np.abs(diagonal).max(initial=0.0) * 1e-12
    coupling = np.abs(projected - np.diag(diagonal))
    if (coupling <= tolerance * scale + 1e-300).all():
        return diagonal
    return None
