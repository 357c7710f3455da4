"""One Craig-Bampton reduction of a rotating structure for all speeds from rest to the highest one."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError
from stickslip.core.validation import positive_number, whole_number
from stickslip.structure.craig_bampton import checked_boundary
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.factor import Backend
from stickslip.structure.recovery import Recovery, partition
from stickslip.structure.rotating import RotatingStructure
from stickslip.structure.rotating_superelement import RPM, RotatingSuperelement
from stickslip.structure.speed_basis import SpeedMatrices, reduced_for_speeds
from stickslip.structure.superelement import Superelement, moves_freely

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
    matrices = SpeedMatrices(structure.stiffness, structure.mass, rotor.speed_stiffness, rotor.coriolis)
    moved = ~np.isin(boundary, rotor.unsupported)
    with threadpool_limits(limits=1):
        parts = reduced_for_speeds(
            matrices, boundary, interior, (count, count), RPM * top_speed_rpm, moved, backend, threads
        )
        load = parts.basis.T @ structure.gather(rotor.load)
    recovery = Recovery(structure, nodes, parts.modes, backend, threads, parts.factor)
    at_rest = Superelement(
        parts.mass, parts.stiffness, boundary_nodes=nodes, recovery=recovery, positions=structure.mesh.points[nodes]
    )
    halves = parts.speed_stiffness, parts.coriolis
    unknown = np.empty(0)
    draft = RotatingSuperelement(at_rest, *halves, load, top_speed_rpm, unknown, unknown)
    reduced = draft.at(top_speed_rpm, coriolis=False)
    squares, shapes = scipy.linalg.eigh(reduced.stiffness, reduced.mass)
    rigid = moves_freely(reduced.stiffness, shapes)
    compared = min(COMPARED, count)
    full_hz = natural_frequencies(top.stiffness, top.mass, int(rigid.sum()) + compared)[0][-compared:]
    reduced_hz = np.sqrt(squares[~rigid][:compared]) / (2.0 * np.pi)
    return RotatingSuperelement(at_rest, *halves, load, top_speed_rpm, full_hz, reduced_hz)
