"""Cyclic symmetry of a sector: the axis, the angle, and the pairs of nodes of its two boundaries.

A disk of N equal sectors becomes itself when it rotates by ``2 pi / N`` about its axis. This rotation maps the left
boundary of a sector on its right boundary, where the next sector begins.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike, NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray

IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class CyclicSymmetry:
    """The symmetry of a disk: the boundaries of a sector and the rotation to the next one.

    Parameters
    ----------
    sectors:
        number N of sectors in a full circle.
    point, direction:
        (3,) m a point of the axis, and its direction (unit vector): the next sector is this one rotated by
        ``2 pi / N`` about it in the right-handed sense.
    left, right:
        (k,) nodes of the boundaries: the rotation maps node ``left[i]`` on ``right[i]``. If the boundaries are tied,
        (k,) and (m,) nodes that need not match.
    n_nodes:
        number of nodes of the sector. Larger node numbers are those of the next one (:func:`with_next_sector`).
    weights:
        csr (3 m, 3 k) of tied boundaries: displacements of the nodes ``right`` in the axes of the next sector from
        those of its nodes ``left``; None for boundaries that match.
    """

    sectors: int
    point: FloatArray
    direction: FloatArray
    left: IntArray
    right: IntArray
    n_nodes: int
    weights: Any = None

    def __repr__(self) -> str:
        axis = ", ".join(f"{each:.4g}" for each in self.direction)
        return f"CyclicSymmetry({self.sectors} sectors about ({axis}); {self.boundary_words()})"

    def boundary_words(self) -> str:
        """How the boundaries are connected, for people."""
        if self.weights is None:
            return f"{self.left.size} pairs of boundary nodes"
        return f"{self.right.size} nodes of the right boundary tied to {self.left.size} of the left one"

    @property
    def is_tied(self) -> bool:
        """Whether the nodes of the right boundary follow the sides of the left one, and not its nodes."""
        return self.weights is not None

    def following(self) -> Any:
        """csr (3 m, 3 k): displacements of the right boundary from those of the left one of the next sector, which are
        in its own axes."""
        turned = scipy.sparse.kron(scipy.sparse.identity(self.right.size), self.rotation(), format="csr")
        return turned if self.weights is None else (turned @ self.weights).tocsr()

    def rotation(self, sector: int = 1) -> FloatArray:
        """(3, 3) rotation of this sector on the one that is so many sectors ahead."""
        return rotation_about(self.direction, 2.0 * np.pi * sector / self.sectors)

    def rotated(self, points: FloatArray, sector: int = 1) -> FloatArray:
        """(n, 3) m positions of points of this sector in the one that is so many sectors ahead."""
        return np.asarray((points - self.point) @ self.rotation(sector).T + self.point)

    def homes(self, nodes: ArrayLike) -> tuple[IntArray, IntArray]:
        """Nodes (k,) of this sector and of the next one as (k,) nodes off the right boundary, and (k,) how many sectors
        ahead these are: a node of the right boundary is one of the left boundary of the sector ahead.

        Raises InputError for a node that is neither of this sector nor of the next one, and for one of a tied right
        boundary, which follows a side and no node.
        """
        numbers = np.asarray(nodes, dtype=np.int64)
        if numbers.size and not 0 <= numbers.min() <= numbers.max() < 2 * self.n_nodes:
            raise InputError(
                f"nodes contains {numbers.min()} to {numbers.max()}, but this sector has nodes 0 to {self.n_nodes - 1} "
                f"and the next one nodes {self.n_nodes} to {2 * self.n_nodes - 1}.",
                arguments=["nodes"],
            )
        home, ahead = numbers % self.n_nodes, numbers // self.n_nodes
        if self.is_tied:
            self._require_off_right(home)
            return home, ahead
        partner = np.full(self.n_nodes, -1)
        partner[self.right] = self.left
        follows = partner[home] >= 0
        return np.where(follows, partner[home], home), ahead + follows

    def _require_off_right(self, nodes: IntArray) -> None:
        wrong = np.intersect1d(nodes, self.right)
        if wrong.size:
            raise InputError(
                f"node {wrong[0]} is on the right boundary of the sector ({wrong.size} of {nodes.size} nodes are). "
                "This boundary is tied to the left one: it follows other nodes. Choose nodes off it, or match the "
                "boundaries.",
                arguments=["nodes"],
            )

    def own_nodes(self, nodes: ArrayLike) -> IntArray:
        """The nodes of this sector, each once, that the reduction must keep for nodes of this sector and of the next
        one, such as those of contact pairs. Raises InputError, see :meth:`homes`."""
        return np.unique(self.homes(nodes)[0])


def rotation_about(direction: FloatArray, angle: float) -> FloatArray:
    """(3, 3) rotation by ``angle`` (rad) about a unit vector, in the right-handed sense (Rodrigues)."""
    x, y, z = direction
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross))
