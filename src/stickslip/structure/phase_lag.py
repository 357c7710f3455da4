"""Matrices of a sector whose right boundary follows the left one of the next sector, for any phase lag between them.

In the frame of each sector (its own rotated axes) the next sector moves as ``u e^{i phi}``, with ``phi = 2 pi d / N``
for nodal diameter d. Its left boundary is the right one of this sector, so ``u_right = e^{i phi} R u_left`` with the
rotation R of the sector. With ``T = T_here + e^{i phi} T_next`` every matrix becomes

    A(phi) = T^H A T = A_0 + e^{i phi} A_1 + e^{-i phi} A_2,
    A_0 = T_here^T A T_here + T_next^T A T_next,  A_1 = T_here^T A T_next,  A_2 = T_next^T A T_here,

Hermitian if A is symmetric, and skew-Hermitian if it is skew-symmetric (Coriolis forces).

Source: D. L. Thomas, Dynamics of rotationally periodic structures, Int. J. Numer. Methods Eng. 14 (1979) 81-102.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.structure.cyclic_symmetry import IntArray


@dataclass(frozen=True)
class LaggedMatrix:
    """A real matrix of a sector for any phase lag: ``here`` is A_0, ``next`` A_1, ``previous`` A_2, csr (n, n)."""

    here: Any
    next: Any
    previous: Any

    @classmethod
    def of(cls, matrix: Any, here: Any, following: Any) -> LaggedMatrix:
        """From a matrix of the unknowns of a sector and the two parts of T."""
        own = here.T @ matrix @ here + following.T @ matrix @ following
        return cls(own.tocsr(), (here.T @ matrix @ following).tocsr(), (following.T @ matrix @ here).tocsr())

    def at(self, diameter: int, sectors: int) -> Any:
        """The csr matrix (n, n) of a nodal diameter: real where the lag is 0 or half a turn, else complex."""
        if diameter == 0:
            return self.here + self.next + self.previous
        if 2 * diameter == sectors:
            return self.here - self.next - self.previous
        lag = np.exp(2j * np.pi * diameter / sectors)
        return self.here + lag * self.next + np.conj(lag) * self.previous


def lagged_unknowns(size: int, left: IntArray, right: IntArray, rotation: Any) -> tuple[IntArray, Any, Any]:
    """Which of ``size`` unknowns remain (n,), and csr (size, n) T_here and T_next: ``right`` (k,) follow ``left`` (l,)
    by the sparse ``rotation`` (k, l)."""
    remaining = np.setdiff1d(np.arange(size), right)
    column = np.full(size, -1)
    column[remaining] = np.arange(remaining.size)
    one = scipy.sparse.csr_matrix(
        (np.ones(remaining.size), (remaining, np.arange(remaining.size))), shape=(size, remaining.size)
    )
    entries = rotation.tocoo()
    following = scipy.sparse.csr_matrix(
        (entries.data, (right[entries.row], column[left[entries.col]])), shape=(size, remaining.size)
    )
    return remaining, one, following


@dataclass(frozen=True)
class LaggedModel:
    """The matrices of a sector without its right boundary, and the unknowns (n,) of the sector that remain."""

    stiffness: LaggedMatrix
    mass: LaggedMatrix
    damping: LaggedMatrix | None
    remaining: IntArray
    gyroscopic: LaggedMatrix | None = None

    @classmethod
    def of_unknowns(
        cls,
        matrices: tuple[Any, Any, Any],
        left: IntArray,
        right: IntArray,
        rotation: Any = None,
        gyroscopic: Any = None,
    ) -> LaggedModel:
        """From sparse stiffness, mass and damping (or None), with unknowns ``right`` (k,) that follow ``left`` (k,).

        ``rotation`` (k, k), sparse, is that of the sector in these unknowns; None for unknowns that do not rotate.
        ``gyroscopic`` is the skew-symmetric matrix of Coriolis forces; None without them.
        """
        turned = scipy.sparse.identity(left.size) if rotation is None else rotation
        remaining, one, following = lagged_unknowns(matrices[0].shape[0], left, right, turned)
        stiffness, mass, damping, coriolis = (
            None if matrix is None else LaggedMatrix.of(scipy.sparse.csr_matrix(matrix), one, following)
            for matrix in (*matrices, gyroscopic)
        )
        assert stiffness is not None
        assert mass is not None
        return cls(stiffness, mass, damping, remaining, coriolis)

    def at(self, diameter: int, sectors: int) -> tuple[Any, Any, Any]:
        """Stiffness, mass and damping (or None) of a nodal diameter."""
        damping = None if self.damping is None else self.damping.at(diameter, sectors)
        return self.stiffness.at(diameter, sectors), self.mass.at(diameter, sectors), damping

    def gyroscopic_at(self, diameter: int, sectors: int) -> Any:
        """The skew-Hermitian matrix of Coriolis forces of a nodal diameter; None without them."""
        return None if self.gyroscopic is None else self.gyroscopic.at(diameter, sectors)
