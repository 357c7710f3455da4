"""Linear equations between displacements: the rows of ties, rigid bodies and couplings, before any is eliminated.

Unknowns are the 3 * n_nodes displacements of a mesh (node, then x, y, z) and further ones that no element has: the
displacements of reference nodes and the rotations of rigid and distributing couplings.

A *rigid* row is ``u_i = u_r + theta x (x_i - x_r)`` along one direction. A *distributing* coupling makes the reference
node follow its nodes: ``u_r = u_c + theta x (x_r - x_c)`` with the weighted mean ``u_c`` at the weighted centre
``x_c`` and the rotation of least squares, ``J theta = sum w_i (x_i - x_c) x u_i`` with ``J = sum w_i (|r|^2 I - r
r^T)``. A force at the reference node then acts on each node in proportion to its weight (the RBE3 element, R. H.
MacNeal, Finite Elements: Their Design and Performance, 1994).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.mesh import IntArray

Key = tuple[int, int]  # label of a node, and direction: 0 to 2 displacements, 3 to 5 rotations
_ON_ONE_LINE = 1e-10  # smallest over largest moment of inertia of nodes that are on one line


class Equation(NamedTuple):
    """``sum coefficient * unknown = 0``: terms by unknown, the unknown that the file makes dependent (-1: none), and
    the number of the name of what wrote it."""

    terms: dict[int, float]
    dependent: int
    owner: int


@dataclass
class Equations:
    """Equations of one mesh, written one after the other.

    Parameters
    ----------
    n_nodes:
        nodes of the mesh.
    names:
        what wrote each equation, for messages: "*TIE in line 12".
    rows:
        the equations.
    further:
        key of a further unknown, such as (node label, direction) -> its number from 3 * n_nodes on.
    lengths:
        (n_further,) m that compare a rotation in rad with displacements; 1 for a displacement.
    fixed:
        numbers of further unknowns that are zero.
    places:
        label of a reference node -> its position (3,) m.
    """

    n_nodes: int
    names: list[str] = field(default_factory=list)
    rows: list[Equation] = field(default_factory=list)
    further: dict[Key, int] = field(default_factory=dict)
    lengths: list[float] = field(default_factory=list)
    fixed: set[int] = field(default_factory=set)
    places: dict[int, FloatArray] = field(default_factory=dict)
    _dependent: dict[int, int] = field(default_factory=dict)

    def copied(self) -> Equations:
        """The same equations, to which others can be added."""
        return Equations(
            self.n_nodes, [*self.names], [*self.rows], {**self.further}, [*self.lengths], {*self.fixed},
            {**self.places}, {**self._dependent},
        )  # fmt: skip

    def unknown(self, key: Key, length: float = 1.0) -> int:
        """The number of a further unknown; the first use of its key makes it."""
        if key not in self.further:
            self.further[key] = 3 * self.n_nodes + len(self.further)
            self.lengths.append(length)
        number = self.further[key]
        at = number - 3 * self.n_nodes
        self.lengths[at] = max(self.lengths[at], length)
        return number

    def owner(self, name: str) -> int:
        """The number of a new name."""
        self.names.append(name)
        return len(self.names) - 1

    def add(self, terms: Iterable[tuple[int, float]], dependent: int, owner: int) -> None:
        """One equation. Raises InputError where its dependent unknown already depends on others."""
        row: dict[int, float] = {}
        for unknown, coefficient in terms:
            row[unknown] = row.get(unknown, 0.0) + coefficient
        if dependent >= 0:
            if dependent in self._dependent:
                raise DependsTwice(dependent, self.names[self._dependent[dependent]], self.names[owner])
            self._dependent[dependent] = owner
        self.rows.append(Equation(row, dependent, owner))

    def depends(self, unknown: int) -> bool:
        """Whether an equation already makes this unknown dependent."""
        return unknown in self._dependent


class DependsTwice(InputError):
    """An unknown that two equations make dependent; ``unknown`` is its number."""

    def __init__(self, unknown: int, first: str, second: str) -> None:
        super().__init__(f"unknown {unknown} depends on others in {first} and again in {second}.")
        self.unknown, self.first, self.second = unknown, first, second


def rotation_arm(arm: FloatArray, direction: FloatArray) -> FloatArray:
    """(3,) coefficients of ``theta`` in ``direction . (theta x arm)``."""
    return np.cross(arm, direction)


def spread_order(points: FloatArray) -> IntArray:
    """Order of points (k, 3) that begins with three far apart and not on one line, so that they fix a rigid body."""
    chosen = [int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
    chosen.append(int(np.linalg.norm(points - points[chosen[0]], axis=1).argmax()))
    along = points[chosen[1]] - points[chosen[0]]
    chosen.append(int(np.linalg.norm(np.cross(points - points[chosen[0]], along), axis=1).argmax()))
    first = list(dict.fromkeys(chosen))
    return np.array(first + [at for at in range(len(points)) if at not in set(first)], dtype=np.int64)


def add_rigid(
    equations: Equations,
    owner: int,
    unknowns: IntArray,
    points: FloatArray,
    reference: tuple[FloatArray, IntArray, IntArray],
    directions: FloatArray,
) -> None:
    """Nodes with displacements ``unknowns`` (k, 3) at points (k, 3) follow a rigid body along unit vectors (d, 3).

    ``reference`` is the position (3,) of its reference node, and the unknowns of its displacement (3,) and rotation
    (3,).
    """
    origin, moved, turned = reference
    along_axes = np.abs(directions).max(axis=1) > 1.0 - 1e-12
    for at in spread_order(points):
        for direction, is_axis in zip(directions, along_axes, strict=True):
            axis = int(np.abs(direction).argmax())
            arm = rotation_arm(points[at] - origin, direction)
            terms = [(int(unknowns[at, each]), direction[each]) for each in range(3) if direction[each] != 0.0]
            terms += [(int(moved[each]), -direction[each]) for each in range(3) if direction[each] != 0.0]
            terms += [(int(turned[each]), -arm[each]) for each in range(3) if arm[each] != 0.0]
            equations.add(terms, int(unknowns[at, axis]) if is_axis else -1, owner)


def add_distributing(
    equations: Equations,
    owner: int,
    unknowns: IntArray,
    points: FloatArray,
    weights: FloatArray,
    reference: tuple[FloatArray, IntArray, IntArray],
    components: Iterable[int] = range(6),
) -> None:
    """The reference node follows nodes with displacements ``unknowns`` (k, 3) at points (k, 3), weights (k,), in the
    mean, along ``components`` 0 to 5.

    ``reference`` is as in :func:`add_rigid`. Raises InputError for weights that do not sum to a positive number, and
    for nodes on one line, which define no rotation about it.
    """
    origin, moved, turned = reference
    total = float(weights.sum())
    if not total > 0.0:
        raise InputError(f"the weights of its {len(points)} nodes sum to {total:g}; the sum must be above 0.")
    share = weights / total
    centre = share @ points
    arms = points - centre
    inertia = np.einsum("i,ij,ij->", share, arms, arms) * np.eye(3) - np.einsum("i,ij,ik->jk", share, arms, arms)
    moments = np.linalg.eigvalsh(inertia)
    if not moments[0] > _ON_ONE_LINE * max(moments[-1], 1e-300):
        raise InputError(
            f"its {len(points)} nodes are on one line or at one point, so they define no rotation about it. Give nodes "
            "of a face."
        )
    inverse = np.linalg.inv(inertia)
    # theta = J^-1 sum w r x u
    of_rotation = np.einsum("ab,ibc,i->iac", inverse, _cross_matrices(arms), share)
    lever = _cross_matrices((centre - origin)[None])[0]  # theta x (x_r - x_c) = (x_c - x_r) x theta
    of_motion = share[:, None, None] * np.eye(3) + np.einsum("ab,ibc->iac", lever, of_rotation)
    for component in components:
        coefficients = (of_motion if component < 3 else of_rotation)[:, component % 3]
        unknown = int((moved if component < 3 else turned)[component % 3])
        used = coefficients != 0.0
        terms = [(unknown, -1.0), *zip(unknowns[used].tolist(), coefficients[used].tolist(), strict=True)]
        equations.add(terms, -1, owner)  # an equation may make the reference node follow something else


def _cross_matrices(arms: FloatArray) -> FloatArray:
    """(k, 3, 3) matrices with ``matrix @ v = arm x v``."""
    x, y, z = arms.T
    zero = np.zeros(len(arms))
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
