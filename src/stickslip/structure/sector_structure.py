"""One sector of a disk before its reduction, and the motion of its mesh from the reduced unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse

from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.blade_modes import BLADE_MODES, blade_alone, fixed_root_modes
from stickslip.structure.cyclic_sector import CyclicSector, folded
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.factor import factorize
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.phase_lag import LaggedModel, lagged_unknowns
from stickslip.structure.rotating import RotatingStructure
from stickslip.structure.sector_reduction import boundary_unknowns, cyclic_sector, lagged_model
from stickslip.structure.superelement import PairsOfNodes


@dataclass(frozen=True)
class RangeOfSpeeds:
    """All speeds up to ``top_rpm`` of a rotating sector, of which ``speed_rpm`` is that of the study."""

    rotor: RotatingStructure
    top_rpm: float
    speed_rpm: float
    coriolis: bool


@dataclass(frozen=True)
class SectorStructure:
    """The structure of one sector with both its boundaries, and how it continues in the next sector.

    ``gyroscopic`` csr (n_free, n_free) N s/m are its Coriolis forces, or None. ``speeds`` are those of one reduction,
    whose constraint modes are those of the structure at rest; None for a reduction of this structure alone.
    """

    structure: Structure
    symmetry: CyclicSymmetry
    gyroscopic: Any = None
    speeds: RangeOfSpeeds | None = None

    @property
    def mesh(self) -> Mesh:
        """The mesh of the sector."""
        return self.structure.mesh

    @cached_property
    def model(self) -> LaggedModel:
        """The matrices for any phase lag. Raises InputError, see :func:`lagged_model`."""
        return lagged_model(self.structure, self.symmetry, self.gyroscopic)

    @cached_property
    def _reduced_model(self) -> LaggedModel:
        """The matrices whose constraint modes the reduction has."""
        return self.model if self.speeds is None else lagged_model(self.speeds.rotor.structure, self.symmetry)

    def reduced(
        self, nodes: IntArray, n_modes: int, threads: int = 1, progress: ProgressCallback | None = None
    ) -> CyclicSector:
        """The sector in the unknowns of nodes, for all nodal diameters. See :func:`cyclic_sector`."""
        return cyclic_sector(
            self.structure, self.symmetry, nodes, n_modes=n_modes, gyroscopic=self.gyroscopic, threads=threads,
            progress=progress,
        )  # fmt: skip

    def blade_frequencies(self, nodes: IntArray) -> FloatArray:
        """Hz of the blade alone, whose nodes these are, with its root fixed. Raises InputError, see
        :func:`stickslip.blade_alone`."""
        return fixed_root_modes(self.structure, self.symmetry, self.model, nodes, BLADE_MODES)[1]

    def blade(self, sector: CyclicSector, nodes: IntArray) -> BladeAlone:
        """The blade alone for mistuning, see :func:`stickslip.blade_alone`."""
        return blade_alone(self.structure, sector, nodes)

    def stuck_frequencies(self, pairs: PairsOfNodes, springs: FloatArray, diameter: int, count: int) -> FloatArray:
        """(count,) Hz, the lowest natural frequencies of a nodal diameter with stuck pairs.

        ``springs`` (3 * n_pairs,) N/m are those of the pairs; a body that moves freely has frequencies near 0 Hz.
        Without Coriolis forces.
        """
        stiffness, mass, _ = self.model.at(diameter, self.symmetry.sectors)
        lag = self._lag(diameter)
        here = self._displacements(lag)
        rotation = scipy.sparse.kron(scipy.sparse.identity(self.mesh.n_nodes), self.symmetry.rotation(), format="csr")
        both = scipy.sparse.vstack([here, lag * (rotation @ here)], format="csr")
        operator = pairs.mesh_operator(2 * self.mesh.n_nodes) @ both
        joined = stiffness + operator.conj().T @ (scipy.sparse.diags(springs) @ operator)
        return np.asarray(natural_frequencies(joined.tocsr(), mass, count)[0])

    def motion(self, sector: CyclicSector, coefficients: FloatArray, waves: Sequence[int]) -> FloatArray:
        """Displacements (3 * n_nodes, 2H+1) m of the mesh from coefficients (n, 2H+1) of the unknowns of ``sector``.

        ``waves`` are the signed numbers of waves round the disk of the harmonics 1 to H
        (:meth:`stickslip.solve.excitation.TravellingWave.waves`). Interior displacements are
        ``Phi_d q - K_ii^-1 K_ib u_b`` of the nodal diameter d of each harmonic.
        """
        answer = np.zeros((3 * self.mesh.n_nodes, coefficients.shape[1]))
        answer[:, 0] = self._recovered(sector, coefficients[:, 0], 0).real
        for order, number in enumerate(waves, start=1):
            amplitude = coefficients[:, 2 * order - 1] - 1j * coefficients[:, 2 * order]
            moved = self._recovered(sector, amplitude, number)
            answer[:, 2 * order - 1], answer[:, 2 * order] = moved.real, -moved.imag
        return answer

    def reduced_load(self, sector: CyclicSector, load: FloatArray) -> FloatArray:
        """Forces (n, k) on the unknowns of ``sector`` in motions alike in all sectors, from those (3 * n_nodes, k) N on
        the nodes of this one: ``T^T load`` of nodal diameter 0.

        Raises InputError for a sector without fixed-interface modes.
        """
        modes = sector.diameters[0].modes
        if modes is None:
            raise InputError("a load requires a sector with fixed-interface modes.", arguments=["sector"])
        stiffness, (boundary, interior) = self._reduced_model.at(0, sector.sectors)[0], self._partition(sector)
        free = self._displacements(1.0).real.T @ load
        static = factorize(stiffness[interior][:, interior]).solve(free[interior])
        return np.vstack([free[boundary] - stiffness[boundary][:, interior] @ static, modes.T @ free[interior]])

    def _partition(self, sector: CyclicSector) -> tuple[IntArray, IntArray]:
        """Positions among the unknowns of :attr:`model` of those of the boundary nodes, in their order, and others."""
        boundary = np.searchsorted(self.model.remaining, self.structure.unknowns_of(sector.boundary_nodes).ravel())
        return boundary, np.setdiff1d(np.arange(self.model.remaining.size), boundary)

    def _recovered(self, sector: CyclicSector, unknowns: Any, waves: int) -> Any:
        """(3 * n_nodes,) complex displacements of unknowns (n,) in a wave; the other direction is the conjugate one."""
        diameter = folded(waves, sector.sectors)
        if waves % sector.sectors != diameter:
            return self._recovered(sector, unknowns.conj(), diameter).conj()
        modes = sector.diameters[diameter].modes
        if modes is None:
            raise InputError(
                "the motion of the mesh requires a sector with fixed-interface modes, such as that of cyclic_sector.",
                arguments=["sector"],
            )
        stiffness = self._reduced_model.at(diameter, sector.sectors)[0]
        boundary, interior = self._partition(sector)
        free = np.zeros(self.model.remaining.size, dtype=complex)
        free[boundary] = unknowns[: boundary.size]
        factor = factorize(stiffness[interior][:, interior])
        load = stiffness[interior][:, boundary] @ free[boundary]
        # The matrices of diameters 0 and N / 2 are real.
        static = (
            factor.solve(load) if factor.dtype is complex else factor.solve(load.real) + 1j * factor.solve(load.imag)
        )
        free[interior] = modes @ unknowns[boundary.size :] - static
        return self._displacements(self._lag(diameter)) @ free

    def _lag(self, waves: int) -> complex:
        return complex(np.exp(2j * np.pi * waves / self.symmetry.sectors))

    def _displacements(self, lag: complex) -> Any:
        """csr (3 * n_nodes, n) complex: displacements of the mesh from the unknowns of the model, with the lag to the
        next sector. The right boundary is ``lag`` times what it follows on the left one."""
        structure = self.structure
        _, here, ahead = lagged_unknowns(structure.stiffness.shape[0], *boundary_unknowns(structure, self.symmetry))
        every = structure.of_unknowns(scipy.sparse.identity(structure.full_size, format="csr"))
        return (every @ (here + lag * ahead)).tocsr()
