"""One sector of a rotating disk, reduced once for all speeds from rest to the highest one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import threadpool_limits

from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray, positive_number, whole_number
from stickslip.structure.craig_bampton import checked_boundary
from stickslip.structure.cyclic_sector import CyclicSector, LaggedMatrices, Matrix
from stickslip.structure.mesh import IntArray
from stickslip.structure.phase_lag import LaggedModel
from stickslip.structure.rotating import RotatingStructure
from stickslip.structure.rotating_superelement import RPM, omega_of_reduction
from stickslip.structure.sector_reduction import (
    checked_diameters,
    folded_load,
    lagged_model,
    require_own_nodes,
)
from stickslip.structure.speed_basis import SpeedMatrices, SpeedReduction, reduced_for_speeds


@dataclass(frozen=True)
class RotatingSector:
    """Matrices of ``M u'' + W G u' + (K + W^2 K_w) u = W^2 f`` of a sector, for each nodal diameter and any speed W.

    One reduction is valid for all speeds up to ``top_speed_rpm``: a sector at a speed (:meth:`at`) is a sum of
    matrices.

    Attributes
    ----------
    at_rest:
        the sector at rest.
    speed_stiffness, coriolis:
        nodal diameter -> (n, n) kg for 1 rad/s, Hermitian (stress stiffness less spin softening) and skew-Hermitian.
    load:
        (n,) N, the centrifugal load f for 1 rad/s in nodal diameter 0, for :func:`static_preload` of
        ``at(speed_rpm).mean_structure()``; None without this diameter.
    top_speed_rpm:
        rpm, the highest speed of the reduction.
    """

    at_rest: CyclicSector
    speed_stiffness: Mapping[int, Matrix]
    coriolis: Mapping[int, Matrix]
    load: FloatArray | None
    top_speed_rpm: float

    def __repr__(self) -> str:
        return f"RotatingSector({self.at_rest!r}, up to {self.top_speed_rpm:g} rpm)"

    def at(self, speed_rpm: float, coriolis: bool = False) -> CyclicSector:
        """The sector at a speed in rpm, with its Coriolis forces if ``coriolis``.

        Raises InputError for a speed below 0 or above that of the reduction.
        """
        omega = self._omega(speed_rpm)

        def spun(diameter: int, rest: LaggedMatrices) -> LaggedMatrices:
            stiffness = rest.stiffness + omega**2 * self.speed_stiffness[diameter]
            whirl = omega * self.coriolis[diameter] if coriolis and omega else None
            return replace(rest, stiffness=stiffness, gyroscopic=whirl)

        every = {diameter: spun(diameter, rest) for diameter, rest in self.at_rest.diameters.items()}
        return replace(self.at_rest, diameters=every)

    def load_at(self, speed_rpm: float) -> FloatArray:
        """(n,) N, the centrifugal load at a speed in rpm. Raises InputError without nodal diameter 0."""
        if self.load is None:
            raise InputError(
                "the sector was reduced without nodal diameter 0, so it has no constant load. Reduce it for this one "
                "too.",
                arguments=["diameters"],
            )
        return np.asarray(self._omega(speed_rpm) ** 2 * self.load)

    def without_recovery(self) -> RotatingSector:
        """Without what only the motion of the mesh requires."""
        return replace(self, at_rest=self.at_rest.without_recovery())

    def _omega(self, speed_rpm: float) -> float:
        return omega_of_reduction(speed_rpm, self.top_speed_rpm, "sector")


def rotating_sector(
    rotor: RotatingStructure,
    boundary_nodes: ArrayLike,
    top_speed_rpm: float,
    *,
    diameters: Sequence[int] | None = None,
    n_modes: int = 30,
    progress: ProgressCallback | None = None,
) -> RotatingSector:
    """Reduce a sector of a rotating disk once for all speeds from 0 to ``top_speed_rpm``.

    The basis of each nodal diameter is that of :func:`rotating_superelement` with the matrices of its phase lag. All
    diameters have one number of unknowns: those with fewer changes of the constraint modes get more modes.

    Parameters
    ----------
    rotor:
        of :func:`rotating` with a symmetry.
    boundary_nodes, diameters, progress:
        as in :func:`cyclic_sector`.
    top_speed_rpm:
        highest speed in rpm.
    n_modes:
        number of fixed-interface modes of each of both ends; parts that they share count once.

    Raises
    ------
    InputError
        for a rotor without symmetry, a speed above the collapse of the stiffness, and all errors of
        :func:`cyclic_sector`.
    """
    symmetry, structure = rotor.symmetry, rotor.structure
    if symmetry is None:
        raise InputError(
            "the rotor is a complete structure. Give one of rotating(..., symmetry=...), or use rotating_superelement.",
            arguments=["rotor"],
        )
    nodes = checked_boundary(boundary_nodes)
    require_own_nodes(symmetry, nodes)
    wanted = checked_diameters(symmetry, diameters)
    rotor.at(positive_number("top_speed_rpm", top_speed_rpm), "top_speed_rpm")
    work = _Work.of(rotor, nodes, RPM * top_speed_rpm, whole_number("n_modes", n_modes, 1))
    report = progress or (lambda fraction, detail: None)
    with threadpool_limits(limits=1):
        parts = dict(work.reduced(wanted, report))
    rest = {diameter: LaggedMatrices(each.mass, each.stiffness, modes=each.modes) for diameter, each in parts.items()}
    load = None
    if 0 in parts:
        load = parts[0].basis.T @ work.alike(rotor.load)
    return RotatingSector(
        CyclicSector(symmetry.sectors, rest, nodes, structure.mesh.points[nodes], symmetry),
        {diameter: each.speed_stiffness for diameter, each in parts.items()},
        {diameter: each.coriolis for diameter, each in parts.items()},
        load,
        top_speed_rpm,
    )


@dataclass(frozen=True)
class _Work:
    """The matrices of a rotating sector for any lag, and what to reduce them to."""

    rotor: RotatingStructure
    rest: LaggedModel
    change: LaggedModel  # its stiffness is that for 1 rad/s
    boundary: IntArray
    interior: IntArray
    top_omega: float
    count: int

    @classmethod
    def of(cls, rotor: RotatingStructure, nodes: IntArray, top_omega: float, count: int) -> _Work:
        """The matrices of both ends. Raises InputError for too many modes."""
        structure, symmetry = rotor.structure, rotor.symmetry
        assert symmetry is not None  # see rotating_sector
        rest = lagged_model(structure, symmetry)
        change = lagged_model(replace(structure, stiffness=rotor.speed_stiffness), symmetry, rotor.coriolis)
        boundary = np.searchsorted(rest.remaining, structure.unknowns_of(nodes).ravel())
        interior = np.setdiff1d(np.arange(rest.remaining.size), boundary)
        if count >= interior.size:
            raise InputError(
                f"n_modes is {count}; with {interior.size} interior unknowns it must be below that.",
                arguments=["n_modes"],
            )
        return cls(rotor, rest, change, boundary, interior, top_omega, count)

    def reduced(self, diameters: Sequence[int], report: ProgressCallback) -> Iterator[tuple[int, SpeedReduction]]:
        """Each diameter and its reduction, all with one number of unknowns."""
        parts = {}
        for place, diameter in enumerate(diameters):
            report(place / len(diameters), f"nodal diameter {diameter}: all speeds")
            parts[diameter] = self._reduced(diameter, self.count)
        most = max(each.modes.shape[1] for each in parts.values())
        for diameter, part in parts.items():
            modes, count = part, self.count
            while modes.modes.shape[1] < most:
                count += most - modes.modes.shape[1]
                if count >= self.interior.size:
                    raise InputError(
                        f"n_modes is {self.count}, too many for {self.interior.size} interior unknowns and both ends "
                        "of the range of speeds. Choose fewer.",
                        arguments=["n_modes"],
                    )
                report(1.0, f"nodal diameter {diameter}: {count} modes")
                modes = self._reduced(diameter, count)
            yield diameter, modes

    def _reduced(self, diameter: int, modes_at_rest: int) -> SpeedReduction:
        sectors = self._sectors
        stiffness, mass, _ = self.rest.at(diameter, sectors)
        matrices = SpeedMatrices(
            stiffness, mass, self.change.stiffness.at(diameter, sectors), self.change.gyroscopic_at(diameter, sectors)
        )
        moved = ~np.isin(self.rest.remaining[self.boundary], self.rotor.unsupported)
        counts = modes_at_rest, self.count
        return reduced_for_speeds(matrices, self.boundary, self.interior, counts, self.top_omega, moved)

    @property
    def _sectors(self) -> int:
        """Number of sectors."""
        assert self.rotor.symmetry is not None
        return self.rotor.symmetry.sectors

    def alike(self, load: FloatArray) -> FloatArray:
        """(n,) N on the unknowns of the model from a load (3 * n_nodes,) N that is alike in all sectors."""
        structure, symmetry = self.rotor.structure, self.rotor.symmetry
        assert symmetry is not None
        return np.asarray(folded_load(structure, symmetry, structure.gather(load))[self.rest.remaining])
