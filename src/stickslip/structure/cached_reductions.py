"""Reductions of rotating structures and of sectors of disks, cached on disk (:mod:`stickslip.structure.cache`)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.structure.cache import Arrays, cached_arrays, input_digest, stored_superelement
from stickslip.structure.cyclic_sector import CyclicSector, LaggedMatrices
from stickslip.structure.mesh import IntArray
from stickslip.structure.rotating import RotatingStructure
from stickslip.structure.rotating_superelement import RotatingSuperelement
from stickslip.structure.sector_structure import SectorStructure


def cached_rotating_superelement(
    rotor: RotatingStructure,
    nodes: IntArray,
    n_modes: int,
    top_speed_rpm: float,
    reduce: Callable[[], RotatingSuperelement],
) -> RotatingSuperelement:
    """The reduction ``reduce()`` of a rotating structure for all speeds, from the disk if it was computed before."""
    made: list[RotatingSuperelement] = []
    names = ("speed_stiffness", "coriolis", "load", "full_hz", "reduced_hz")

    def compute() -> Arrays:
        made.append(reduce())
        new = made[0]
        rest = {"mass": new.at_rest.mass, "stiffness": new.at_rest.stiffness, "modes": new.at_rest.recovery.modes}
        return rest | {name: getattr(new, name) for name in names}

    matrices = (rotor.speed_stiffness, rotor.coriolis)
    parts = [getattr(matrix, name) for matrix in matrices for name in ("indptr", "indices", "data")]
    settings = np.array([n_modes, top_speed_rpm])
    arrays = cached_arrays("rotating", input_digest(rotor.structure, nodes, *parts, rotor.load, settings), compute)
    if made:
        return made[0]
    at_rest = stored_superelement(rotor.structure, nodes, arrays)
    return RotatingSuperelement(at_rest, top_speed_rpm=top_speed_rpm, **{name: arrays[name] for name in names})


def cached_sector(
    sector: SectorStructure, nodes: IntArray, n_modes: int, reduce: Callable[[], CyclicSector]
) -> CyclicSector:
    """The sector ``reduce()`` for all nodal diameters, from the disk if it was computed before."""
    made: list[CyclicSector] = []
    whirl = sector.gyroscopic
    names = ("mass", "stiffness", "modes", *(() if whirl is None else ("gyroscopic",)))

    def compute() -> Arrays:
        made.append(reduce())
        every = made[0].diameters.items()
        return {f"{name}-{diameter}": getattr(each, name) for diameter, each in every for name in names}

    symmetry = sector.symmetry
    axis = [symmetry.left, symmetry.right, symmetry.direction, symmetry.point]
    if symmetry.is_tied:
        axis += [getattr(symmetry.weights, name) for name in ("indptr", "indices", "data")]
    numbers = np.array([symmetry.sectors, n_modes])
    coriolis = () if whirl is None else (whirl.indptr, whirl.indices, whirl.data)
    arrays = cached_arrays("sector", input_digest(sector.structure, nodes, *axis, numbers, *coriolis), compute)
    if made:
        return made[0]
    stored = {
        diameter: LaggedMatrices(**{name: arrays[f"{name}-{diameter}"] for name in names})
        for diameter in range(symmetry.sectors // 2 + 1)
    }
    return CyclicSector(symmetry.sectors, stored, nodes, sector.mesh.points[nodes], symmetry)
