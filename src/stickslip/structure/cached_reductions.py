"""Reductions of rotating structures and of sectors of disks, cached on disk (:mod:`stickslip.structure.cache`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.structure.cache import Arrays, cached_arrays, input_digest, stored_superelement
from stickslip.structure.cyclic_sector import CyclicSector, LaggedMatrices
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.mesh import IntArray
from stickslip.structure.rotating import RotatingStructure
from stickslip.structure.rotating_sector import RotatingSector
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
    axis = _arrays_of(symmetry)
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


def cached_rotating_sector(
    rotor: RotatingStructure, nodes: IntArray, n_modes: int, top_speed_rpm: float, reduce: Callable[[], RotatingSector]
) -> RotatingSector:
    """The reduction ``reduce()`` of a rotating sector for all speeds and nodal diameters, from the disk if it was
    computed before."""
    made: list[RotatingSector] = []
    symmetry = rotor.symmetry
    assert symmetry is not None  # that of rotating_sector

    def compute() -> Arrays:
        made.append(reduce())
        new = made[0]
        answer = {} if new.load is None else {"load": new.load}
        for diameter, each in new.at_rest.diameters.items():
            answer |= {f"{name}-{diameter}": getattr(each, name) for name in ("mass", "stiffness", "modes")}
            answer[f"speed_stiffness-{diameter}"] = new.speed_stiffness[diameter]
            answer[f"coriolis-{diameter}"] = new.coriolis[diameter]
        return answer

    matrices = (rotor.speed_stiffness, rotor.coriolis)
    parts = [getattr(matrix, name) for matrix in matrices for name in ("indptr", "indices", "data")]
    numbers = np.array([symmetry.sectors, n_modes, top_speed_rpm])
    key = input_digest(rotor.structure, nodes, *_arrays_of(symmetry), *parts, rotor.load, numbers)
    arrays = cached_arrays("rotating-sector", key, compute)
    if made:
        return made[0]
    diameters = range(symmetry.sectors // 2 + 1)
    stored = {
        each: LaggedMatrices(arrays[f"mass-{each}"], arrays[f"stiffness-{each}"], modes=arrays[f"modes-{each}"])
        for each in diameters
    }
    sector = CyclicSector(symmetry.sectors, stored, nodes, rotor.structure.mesh.points[nodes], symmetry)
    return RotatingSector(
        sector,
        {each: arrays[f"speed_stiffness-{each}"] for each in diameters},
        {each: arrays[f"coriolis-{each}"] for each in diameters},
        arrays["load"],
        top_speed_rpm,
    )


def _arrays_of(symmetry: CyclicSymmetry) -> list[NDArray[Any]]:
    """What determines the symmetry of a sector, for a hash."""
    axis = [symmetry.left, symmetry.right, symmetry.direction, symmetry.point]
    if symmetry.is_tied:
        axis += [getattr(symmetry.weights, name) for name in ("indptr", "indices", "data")]
    return axis
