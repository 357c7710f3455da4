"""One Craig-Bampton reduction of a rotating structure for all speeds from rest to the highest one."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number, whole_number
from stickslip.structure.craig_bampton import BLOCK, checked_boundary
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.factor import Backend, Factor, factorize
from stickslip.structure.recovery import Recovery, partition
from stickslip.structure.rotating import RotatingStructure
from stickslip.structure.rotating_superelement import RotatingSuperelement
from stickslip.structure.superelement import Superelement, moves_freely

# chosen: a change of the constraint modes with the speed is in the basis if its energy is above this fraction of the
# energy of the boundary motion that causes it: that of the square of a frequency without it.
LEAST_CHANGE = 1e-8
# chosen: parts of basis vectors below the root of this length squared are the same vector.
SAME_VECTOR = 1e-10
COMPARED = 10  # natural frequencies of mesh and reduction at the highest speed


def rotating_superelement(
    rotor: RotatingStructure,
    boundary_nodes: ArrayLike,
    top_speed_rpm: float,
    *,
    n_modes: int = 30,
    backend: Backend = "superlu",
    threads: int = 1,
) -> RotatingSuperelement:
    """Reduce a rotating structure once for all speeds from 0 to ``top_speed_rpm``.

    The basis is that of :func:`craig_bampton` at rest, and in addition the fixed-interface modes at the highest speed
    and the changes of the constraint modes from rest to there. The projected matrices are polynomials of the speed,
    because those of the mesh are; both ends of the range are as accurate as a reduction at that speed. ``full_hz`` and
    ``reduced_hz`` of the result show the error at the highest speed.

    Parameters
    ----------
    rotor:
        of :func:`rotating`.
    boundary_nodes:
        nodes to keep, in the order of the unknowns, as in :func:`craig_bampton`.
    top_speed_rpm:
        highest speed in rpm.
    n_modes:
        number of fixed-interface modes of each of both ends; parts that they share count once.
    backend, threads:
        as in :func:`craig_bampton`.

    Raises
    ------
    InputError
        for a speed above the collapse of the stiffness, boundary nodes that do not exist, come twice or are fixed, and
        a mode count out of range.
    """
    rotor.require_complete("cyclic_sector")
    nodes = checked_boundary(boundary_nodes)
    structure = rotor.structure
    top = rotor.at(positive_number("top_speed_rpm", top_speed_rpm), "top_speed_rpm")
    boundary, interior = partition(structure, nodes)
    count = whole_number("n_modes", n_modes, 1)
    if count >= len(interior):
        raise InputError(
            f"n_modes is {count}; with {len(interior)} interior unknowns it must be below that.", arguments=["n_modes"]
        )
    with threadpool_limits(limits=1):
        inner_mass = structure.mass[interior][:, interior]
        ends = [
            _End(each.stiffness, inner_mass, boundary, interior, count, backend, threads) for each in (structure, top)
        ]
        change = _changes(ends[0], ends[1], ~np.isin(boundary, rotor.unsupported))
        vectors = np.hstack([ends[0].modes, ends[1].modes, change])
        modes = _ritz_vectors(vectors, ends[0].stiffness_ii, inner_mass)
        basis = np.zeros((structure.stiffness.shape[0], len(boundary) + modes.shape[1]))
        basis[boundary, np.arange(len(boundary))] = 1.0
        basis[interior] = np.hstack([ends[0].constraint, modes])
        mass, stiffness, speed_stiffness, coriolis = (
            _projected(matrix, basis)
            for matrix in (structure.mass, structure.stiffness, rotor.speed_stiffness, rotor.coriolis)
        )
        load = basis.T @ structure.gather(rotor.load)
    recovery = Recovery(structure, nodes, modes, backend, threads, ends[0].factor)
    at_rest = Superelement(
        0.5 * (mass + mass.T), 0.5 * (stiffness + stiffness.T), boundary_nodes=nodes, recovery=recovery,
        positions=structure.mesh.points[nodes],
    )  # fmt: skip
    halves = 0.5 * (speed_stiffness + speed_stiffness.T), 0.5 * (coriolis - coriolis.T)
    unknown = np.empty(0)
    draft = RotatingSuperelement(at_rest, *halves, load, top_speed_rpm, unknown, unknown)
    reduced = draft.at(top_speed_rpm, coriolis=False)
    squares, shapes = scipy.linalg.eigh(reduced.stiffness, reduced.mass)
    rigid = moves_freely(reduced.stiffness, shapes)
    compared = min(COMPARED, count)
    full_hz = natural_frequencies(top.stiffness, top.mass, int(rigid.sum()) + compared)[0][-compared:]
    reduced_hz = np.sqrt(squares[~rigid][:compared]) / (2.0 * np.pi)
    return RotatingSuperelement(at_rest, *halves, load, top_speed_rpm, full_hz, reduced_hz)


class _End:
    """The parts of a Craig-Bampton basis at one end of the range of speeds."""

    def __init__(
        self, stiffness: Any, inner_mass: Any, boundary: Any, interior: Any, count: int, backend: Backend, threads: int
    ) -> None:
        self.stiffness_ii = stiffness[interior][:, interior]
        coupling = stiffness[interior][:, boundary]
        self.factor: Factor = factorize(self.stiffness_ii, backend, threads)
        self.modes = natural_frequencies(self.stiffness_ii, inner_mass, count, shift=0.0, factor=self.factor)[1]
        self.constraint = self.factor.solve(-coupling)
        self.boundary_stiffness = stiffness[boundary][:, boundary].toarray() + coupling.T @ self.constraint


def _changes(rest: _End, top: _End, supported: NDArray[np.bool_]) -> FloatArray:
    """(n_interior, k) combinations of the changes of the constraint modes whose energy is above LEAST_CHANGE.

    ``supported`` (n_boundary,) marks unknowns of bodies that the speed changes.
    """
    if not supported.any():
        return np.zeros((len(rest.modes), 0))
    change = (top.constraint - rest.constraint)[:, supported]
    energy, own = change.T @ (rest.stiffness_ii @ change), rest.boundary_stiffness[np.ix_(supported, supported)]
    size, motions = scipy.linalg.eigh(0.5 * (energy + energy.T), 0.5 * (own + own.T))
    return np.asarray(change @ motions[:, size > LEAST_CHANGE])


def _ritz_vectors(vectors: FloatArray, stiffness: Any, mass: Any) -> FloatArray:
    """(n, k) mass-normalised vectors of the same space that diagonalise mass and stiffness."""
    vectors = vectors / np.sqrt(np.einsum("ij,ij->j", vectors, mass @ vectors))
    lengths, turns = scipy.linalg.eigh(vectors.T @ (mass @ vectors))
    different = lengths > SAME_VECTOR * lengths[-1]
    vectors = vectors @ (turns[:, different] / np.sqrt(lengths[different]))
    # once more, without the round-off of vectors that nearly agree
    _, turns = scipy.linalg.eigh(vectors.T @ (stiffness @ vectors), vectors.T @ (mass @ vectors))
    return np.asarray(vectors @ turns)


def _projected(matrix: Any, basis: FloatArray) -> FloatArray:
    """``T^T A T`` (k, k) of a sparse matrix, a block of columns at a time."""
    size = basis.shape[1]
    answer = np.empty((size, size))
    for start in range(0, size, BLOCK):
        answer[:, start : start + BLOCK] = basis.T @ (matrix @ basis[:, start : start + BLOCK])
    return answer
