"""One sector of a tuned disk, reduced for each nodal diameter: the structure that the solver uses for a whole disk."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NoReturn, get_args

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import (
    FloatArray,
    finite_array,
    positive_number,
    require_allowed,
    require_choice,
    skew_matrix,
    symmetric_matrix,
    whole_number,
)
from stickslip.structure.cyclic_symmetry import CyclicSymmetry, IntArray
from stickslip.structure.gyroscopic import gyroscopic_modes
from stickslip.structure.phase_lag import LaggedModel
from stickslip.structure.superelement import PairsOfNodes, Superelement, rayleigh_damping_matrix

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# A wave reaches the next sector after this one, or before it.
Direction = Literal["forward", "backward"]
Matrix = NDArray[Any]  # real or complex
# chosen: largest asymmetry, of the largest entry, that counts as round-off.
SYMMETRIC = 1e-8


@dataclass(frozen=True)
class LaggedMatrices:
    """Dense matrices (n, n) of a sector for one nodal diameter in SI units; real if its lag is 0 or half a turn.

    They are Hermitian, that of Coriolis forces (``gyroscopic``, N s/m) is skew-Hermitian. ``damping`` and
    ``gyroscopic`` may be None; ``modes`` (n_interior, n_modes) are the fixed-interface modes of a reduction.
    """

    mass: Matrix
    stiffness: Matrix
    damping: Matrix | None = None
    modes: Matrix | None = None
    gyroscopic: Matrix | None = None

    def conjugate(self) -> LaggedMatrices:
        """The matrices of the wave that travels in the other direction."""
        damping, modes, gyroscopic = (
            None if each is None else each.conj() for each in (self.damping, self.modes, self.gyroscopic)
        )
        return LaggedMatrices(self.mass.conj(), self.stiffness.conj(), damping, modes, gyroscopic)


@dataclass(frozen=True)
class CyclicSector:
    """One sector of a disk of ``sectors`` equal ones, with matrices for each nodal diameter.

    Unknowns are displacements in the axes of the sector itself: those of the next sector are the same unknowns in axes
    that are rotated by ``2 pi / sectors``. In a wave of nodal diameter d that travels to the next sectors (forward),
    the complex amplitudes of sector s are ``e^{-2 pi i d s / sectors}`` times those of this one.

    Attributes
    ----------
    sectors:
        number N of sectors.
    diameters:
        nodal diameter (0 to N // 2) -> matrices with the lag ``+2 pi d / N`` to the next sector, all of one size n.
    boundary_nodes:
        (n_boundary,) node numbers; node ``boundary_nodes[i]`` owns the unknowns ``3*i, 3*i+1, 3*i+2`` of every
        diameter. The other unknowns are amplitudes of fixed-interface modes, which differ from diameter to diameter.
    positions:
        (n_boundary, 3) m, or None.
    symmetry:
        axis and boundaries, or None for matrices without a mesh.

    Raises InputError for matrices of different size or that are not Hermitian, and diameters that do not exist.
    """

    sectors: int
    diameters: Mapping[int, LaggedMatrices]
    boundary_nodes: IntArray
    positions: FloatArray | None = None
    symmetry: CyclicSymmetry | None = None

    def __post_init__(self) -> None:
        whole_number("sectors", self.sectors, 2)
        if not self.diameters:
            raise InputError("diameters is empty; give at least one nodal diameter.", arguments=["diameters"])
        for diameter in self.diameters:
            require_diameter(diameter, self.sectors)
        sizes = {matrix.shape for each in self.diameters.values() for matrix in (each.mass, each.stiffness)}
        if len(sizes) > 1:
            raise InputError(
                f"the matrices of the nodal diameters have {len(sizes)} different shapes; all must have the same "
                "unknowns: choose one number of modes.",
                arguments=["diameters"],
            )
        for diameter, each in self.diameters.items():
            for name in ("mass", "stiffness", "damping"):
                matrix = getattr(each, name)
                if matrix is not None and (matrix.shape not in sizes or not _is_hermitian(matrix)):
                    raise InputError(
                        f"the {name} matrix of nodal diameter {diameter} is not Hermitian, or not of the shape of the "
                        "others. Give M, C and K with their conjugate transposes.",
                        arguments=["diameters"],
                    )
            whirl = each.gyroscopic
            if whirl is not None and (whirl.shape not in sizes or not _is_hermitian(1j * whirl)):
                raise InputError(
                    f"the gyroscopic matrix of nodal diameter {diameter} is not skew-Hermitian, or not of the shape of "
                    "the others. Give G = -G^H, and the rest of a damping matrix as damping.",
                    arguments=["diameters"],
                )
        if len({each.gyroscopic is None for each in self.diameters.values()}) > 1:
            raise InputError(
                "only some nodal diameters have a gyroscopic matrix. Give it for all of them, or for none.",
                arguments=["diameters"],
            )

    def __repr__(self) -> str:
        given = ", ".join(map(str, sorted(self.diameters)))
        return (
            f"CyclicSector({self.sectors} sectors, {self.size} unknowns: {self.boundary_nodes.size} boundary nodes; "
            f"nodal diameters {given})"
        )

    @classmethod
    def of_matrices(
        cls,
        mass: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike | None = None,
        gyroscopic: ArrayLike | None = None,
        *,
        left: ArrayLike,
        right: ArrayLike,
        sectors: int,
    ) -> CyclicSector:
        """The sector of matrices (n, n) that contain both its boundaries, for all nodal diameters, without reduction.

        Unknown ``right[i]`` is unknown ``left[i]`` of the next sector, and is no unknown of the result; the others
        remain in their order. ``gyroscopic`` is the skew-symmetric matrix of Coriolis forces. Raises InputError.
        """
        whole_number("sectors", sectors, 2)
        elastic, inertial = symmetric_matrix("stiffness", stiffness), symmetric_matrix("mass", mass)
        viscous = None if damping is None else symmetric_matrix("damping", damping)
        whirl = None if gyroscopic is None else skew_matrix("gyroscopic", gyroscopic)
        size = len(elastic)
        first, second = (_unknown_numbers(name, value, size) for name, value in (("left", left), ("right", right)))
        if first.size != second.size or np.intersect1d(first, second).size or not first.size:
            raise InputError(
                f"left has {first.size} unknowns and right {second.size}; both must have the same number, at least "
                "one, and no unknown in common.",
                arguments=["left", "right"],
            )
        model = LaggedModel.of_unknowns((elastic, inertial, viscous), first, second, gyroscopic=whirl)
        dense = {}
        for diameter in range(sectors // 2 + 1):
            stiff, heavy, lossy = model.at(diameter, sectors)
            lossy, turning = (
                None if each is None else each.toarray() for each in (lossy, model.gyroscopic_at(diameter, sectors))
            )
            dense[diameter] = LaggedMatrices(heavy.toarray(), stiff.toarray(), lossy, gyroscopic=turning)
        return cls(sectors, dense, np.empty(0, dtype=np.int64))

    has_all_pairs: ClassVar[bool] = True

    @property
    def size(self) -> int:
        """Number of unknowns n of the sector."""
        return int(next(iter(self.diameters.values())).mass.shape[0])

    @property
    def mass(self) -> FloatArray:
        """A cyclic sector has no single mass matrix: raises InputError, so that no analysis mistakes it for a
        structure."""
        raise self.no_structure()

    @property
    def stiffness(self) -> FloatArray:
        """As :attr:`mass`."""
        raise self.no_structure()

    @property
    def damping(self) -> FloatArray:
        """As :attr:`mass`."""
        raise self.no_structure()

    def no_structure(self) -> InputError:
        """The error of an analysis that requires the matrices of a structure."""
        return InputError(
            "a cyclic sector has other matrices for each nodal diameter, and this analysis is not valid for it: only "
            "forced_response under Excitation.travelling_wave is. For other analyses give the full ring as a "
            "superelement.",
            arguments=["superelement"],
        )

    @property
    def has_coriolis(self) -> bool:
        """Whether it has Coriolis forces."""
        return next(iter(self.diameters.values())).gyroscopic is not None

    @property
    def row_size(self) -> int:
        """Number 2n of entries of a row of an output or a pair: the unknowns of this sector and of the next one."""
        return 2 * self.size

    def mean_structure(self) -> Superelement:
        """The structure of motions that are constant in time and alike in all sectors: nodal diameter 0."""
        matrices = self.lagged(0)
        return Superelement(matrices.mass, matrices.stiffness, matrices.damping, self.boundary_nodes)

    def require_structure(self) -> NoReturn:
        """A sector has no single matrices: raises InputError."""
        raise self.no_structure()

    def require_sector(self) -> CyclicSector:
        """This one: for what only a sector of a disk has."""
        return self

    def with_rayleigh_damping(self, mass_factor: float, stiffness_factor: float) -> CyclicSector:
        """The sector with the damping ``mass_factor M + stiffness_factor K`` for each diameter (1/s and s), beside its
        own. Raises InputError for a factor below zero."""

        def damped(matrices: LaggedMatrices) -> LaggedMatrices:
            new = rayleigh_damping_matrix(matrices, mass_factor, stiffness_factor)
            return replace(matrices, damping=new if matrices.damping is None else new + matrices.damping)

        return replace(self, diameters={diameter: damped(each) for diameter, each in self.diameters.items()})

    def without_recovery(self) -> CyclicSector:
        """Without the fixed-interface modes, which only the motion of the mesh requires."""
        return replace(self, diameters={key: replace(each, modes=None) for key, each in self.diameters.items()})

    def lagged(self, waves: int) -> LaggedMatrices:
        """The matrices with the lag ``+2 pi waves / N`` to the next sector, for any whole number of waves.

        Raises InputError for a nodal diameter that the reduction omitted.
        """
        diameter = folded(waves, self.sectors)
        if diameter not in self.diameters:
            raise InputError(
                f"nodal diameter {diameter} is required, but the sector was reduced for nodal diameters "
                f"{', '.join(map(str, sorted(self.diameters)))} only. Reduce it for this one too.",
                arguments=["diameters"],
            )
        matrices = self.diameters[diameter]
        return matrices if waves % self.sectors == diameter else matrices.conjugate()

    def natural_frequencies(
        self, diameter: int, count: int | None = None, direction: Direction = "forward"
    ) -> FloatArray:
        """(count,) Hz, the lowest natural frequencies of a nodal diameter without contact, all by default.

        With Coriolis forces those of waves in one ``direction`` round the disk, in the rotating frame; without them
        both directions have the same. Raises InputError for a diameter that the reduction omitted.
        """
        matrices = self.lagged(waves_of(diameter, direction))
        if matrices.gyroscopic is None:
            squares = scipy.linalg.eigh(matrices.stiffness, matrices.mass, eigvals_only=True)
            return np.asarray(np.sqrt(np.maximum(squares[:count], 0.0)) / (2.0 * np.pi))
        squares, modes = scipy.linalg.eigh(matrices.stiffness, matrices.mass)
        coupling = modes.conj().T @ matrices.gyroscopic @ modes
        whirling, _ = gyroscopic_modes(np.sqrt(np.maximum(squares, 0.0)), coupling)
        return whirling[:count] / (2.0 * np.pi)

    def plot(self, count: int = 6, speed_rpm: float | None = None) -> Figure:
        """The nodal-diameter diagram: the lowest ``count`` natural frequencies of each diameter without contact.

        Coriolis forces split them: those of backward waves are dotted then. With a speed the line of all engine orders
        is beside them (SAFE diagram). Raises InputError for a count that the sector does not have, and a speed that is
        not above zero.
        """
        from stickslip.structure.nodal_diameter_figure import nodal_diameter_figure

        whole_number("count", count, 1)
        require_allowed("count", count, count <= self.size, f"at most {self.size}, the number of unknowns")
        if speed_rpm is not None:
            positive_number("speed_rpm", speed_rpm, "revolutions per minute")
        forward, backward = (
            {diameter: self.natural_frequencies(diameter, count, direction) for diameter in self.diameters}
            for direction in get_args(Direction)
        )
        return nodal_diameter_figure(forward, self.sectors, speed_rpm, backward if self.has_coriolis else None)

    def unknowns_of(self, node: int) -> IntArray:
        """The three unknowns (x, y, z) of a boundary node with this number in the mesh. Raises InputError."""
        position = np.flatnonzero(self.boundary_nodes == node)
        if position.size != 1:
            raise InputError(
                f"node {node} is not one of the {self.boundary_nodes.size} boundary nodes.", arguments=["node"]
            )
        return np.asarray(3 * position[0] + np.arange(3), dtype=np.int64)

    def operator(self, pairs: PairsOfNodes) -> FloatArray:
        """(3 * n_pairs, 2n) rows t1, t2, n of pairs of this sector, or of this sector and the next one.

        The pairs are those of the mesh, or of :func:`stickslip.with_next_sector` for faces across the boundary. Raises
        InputError for a sector without a mesh, a node that the reduction omitted, and a node two sectors ahead.
        """
        if self.symmetry is None:
            raise InputError("pairs of nodes require a sector with a mesh.", arguments=["pairs"])
        nodes, n_nodes = pairs.nodes, 2 * self.symmetry.n_nodes
        home, ahead = self.symmetry.homes(nodes)
        if ahead.max(initial=0) > 1:
            raise InputError(
                f"node {nodes[ahead.argmax()] - self.symmetry.n_nodes} of the next sector is on its right boundary, "
                "so the pair reaches two sectors ahead. Pair the faces the other way round: that of the next sector at "
                "its left boundary.",
                arguments=["pairs"],
            )
        missing = np.setdiff1d(home, self.boundary_nodes)
        if missing.size:
            raise InputError(
                f"node {missing[0]} of a contact pair is not a boundary node of the sector ({missing.size} of "
                f"{np.unique(home).size} are not); reduce again with own_nodes of the pairs among the boundary_nodes.",
                arguments=["pairs"],
            )
        order = np.argsort(self.boundary_nodes)
        place = order[np.searchsorted(self.boundary_nodes, home, sorter=order)]
        columns = (3 * place + self.size * ahead)[:, None] + np.arange(3)
        of_mesh = pairs.mesh_operator(n_nodes)
        operator = np.zeros((of_mesh.shape[0], 2 * self.size))
        for sector, rotation in enumerate((np.eye(3), self.symmetry.rotation())):
            for node, column in zip(nodes[ahead == sector], columns[ahead == sector], strict=True):
                operator[:, column] += of_mesh[:, 3 * node + np.arange(3)].toarray() @ rotation
        return operator

    def selector(self, node: int, direction: ArrayLike, of_next: bool = False) -> FloatArray:
        """The row (2n,) of the displacement of a boundary node along ``direction`` (x, y, z).

        The first n entries are the unknowns of this sector, the others those of the next one. ``of_next`` gives the
        node of the next sector, along a direction in the axes of this one; it requires a sector with a mesh.
        """
        row = np.zeros(2 * self.size)
        vector = finite_array("direction", direction)
        if of_next:
            if self.symmetry is None:
                raise InputError("of_next requires a sector with a mesh: only that has an axis.", arguments=["of_next"])
            vector = self.symmetry.rotation().T @ vector
        row[self.unknowns_of(node) + (self.size if of_next else 0)] = vector
        return row


def _is_hermitian(matrix: Matrix) -> bool:
    """Whether a matrix is that of a sector, except for round-off."""
    return bool(np.abs(matrix - matrix.conj().T).max(initial=0.0) <= SYMMETRIC * np.abs(matrix).max(initial=0.0))


def waves_of(diameter: int, direction: Direction) -> int:
    """The signed number of waves of a nodal diameter: a forward wave has the lag ``-2 pi d / N`` to the next sector.

    Raises InputError for a direction that does not exist.
    """
    require_choice("direction", direction, get_args(Direction))
    return -diameter if direction == "forward" else diameter


def folded(waves: int, sectors: int) -> int:
    """The nodal diameter (0 to N // 2) of a number of waves round the disk: N sectors see no more (aliasing)."""
    rest = waves % sectors
    return min(rest, sectors - rest)


def nodal_diameters(sectors: int, engine_order: int, harmonics: int | None = None) -> tuple[int, ...]:
    """The nodal diameters that an engine order excites: ``h * engine_order`` for each harmonic h, folded at N/2.

    With the mean (h = 0), up to ``harmonics`` or for all numbers of them. Raises InputError.
    """
    whole_number("sectors", sectors, 2)
    whole_number("engine_order", engine_order, 0)
    highest = sectors // math.gcd(sectors, engine_order) if harmonics is None else harmonics
    return tuple(sorted({folded(order * engine_order, sectors) for order in range(highest + 1)}))


def require_diameter(diameter: int, sectors: int) -> None:
    """Raise InputError for a nodal diameter that a disk with so many sectors does not have."""
    if diameter != int(diameter) or not 0 <= diameter <= sectors // 2:
        raise InputError(
            f"diameters contains {diameter}, but a disk of {sectors} sectors has nodal diameters 0 to {sectors // 2}.",
            arguments=["diameters"],
        )


def _unknown_numbers(name: str, value: ArrayLike, size: int) -> IntArray:
    array = np.atleast_1d(np.asarray(value))
    if not np.issubdtype(array.dtype, np.integer) or array.min(initial=0) < 0 or array.max(initial=0) >= size:
        raise InputError(f"{name} must contain numbers of unknowns from 0 to {size - 1}.", arguments=[name])
    if np.unique(array).size != array.size:
        raise InputError(f"{name} contains an unknown twice; name it once.", arguments=[name])
    return array.astype(np.int64)
