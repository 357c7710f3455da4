"""A meshed structure that rotates about an axis: its static state, and its matrices at any speed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError, SingularMatrixError
from stickslip.core.validation import FloatArray, argument_error, finite_array, require_choice
from stickslip.structure.body_load import centrifugal_load
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.factor import Backend, factorize, is_positive_definite
from stickslip.structure.floating_parts import unsupported_unknowns
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.rotating_superelement import RPM, checked_speed
from stickslip.structure.rotation_matrices import (
    coriolis_matrix,
    nodal_mass,
    softening_matrix,
    stress_stiffness_matrix,
)
from stickslip.structure.sector_reduction import boundary_unknowns, constant_motion, lagged_model
from stickslip.structure.whirling import whirling_frequencies

FreeBodies = Literal["rejected", "at rest"]
# chosen: static displacement over the diagonal of the bounding box. Without the change of geometry, frequencies of a
# beam that is bent by 2 % of its length differ by up to 0.1 % from those of CalculiX, and by 6 % if it is 20 %.
LARGEST_MOTION = 0.05
SAME_AXIS = 1e-6  # chosen: angle in rad between two directions of one axis
COLLAPSE_ACCURACY = 1e-4  # chosen: of the speed in the message about the collapse of the stiffness


@dataclass(frozen=True)
class RotatingStructure:
    """Sparse matrices of ``M u'' + W G u' + (K + W^2 K_w) u = W^2 f`` for any speed W in rad/s, see :func:`rotating`.

    Attributes
    ----------
    structure:
        the structure at rest, with M and K.
    axis, point:
        (3,) unit vector, and (3,) m on the axis.
    stress_stiffness, softening:
        (n_free, n_free) csr, N/m and kg for 1 rad/s: ``K_w = stress_stiffness - softening``.
    coriolis:
        (n_free, n_free) csr, kg: G for 1 rad/s, skew-symmetric.
    load:
        (3 * n_nodes,) N, the centrifugal load of every node for 1 rad/s.
    displacement:
        (3 * n_nodes,) m, the static displacements under this load by the stiffness at rest, on which the stress of
        ``stress_stiffness`` depends.
    symmetry:
        of a sector; None for a complete structure.
    unsupported:
        (k,) unknowns of bodies that move freely, which have no effects of the speed but their load; empty unless
        :func:`rotating` allows them.
    """

    structure: Structure
    axis: FloatArray
    point: FloatArray
    stress_stiffness: Any
    softening: Any
    coriolis: Any
    load: FloatArray
    displacement: FloatArray
    symmetry: CyclicSymmetry | None = None
    unsupported: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def __repr__(self) -> str:
        axis = ", ".join(f"{each:.4g}" for each in self.axis)
        return f"RotatingStructure({self.structure.stiffness.shape[0]} unknowns about ({axis}))"

    @property
    def speed_stiffness(self) -> Any:
        """csr (n_free, n_free) kg: ``K_w``, the change of the stiffness by 1 (rad/s)^2."""
        return self.stress_stiffness - self.softening

    def at(self, speed_rpm: float, argument: str = "speed_rpm") -> Structure:
        """The structure with its stiffness at a speed, without Coriolis forces; messages name the ``argument``.

        Raises InputError for a negative speed, for one at which the stiffness has collapsed (some pivots of its factor
        are negative), and for one at which static displacements are above 5 % of the size of the structure.
        """
        speed = checked_speed(speed_rpm, np.inf, argument)
        stiffness = self._stiffness(speed)
        if not self._is_stable(stiffness):
            checked_speed(speed, self._collapse_below(speed), argument)
        self._require_small_motion(speed, argument)
        return replace(self.structure, stiffness=stiffness)

    def coriolis_at(self, speed_rpm: float) -> Any:
        """csr (n_free, n_free) N s/m, the gyroscopic matrix at a speed. Raises InputError for a negative speed."""
        return (RPM * checked_speed(speed_rpm, np.inf) * self.coriolis).tocsr()

    def _require_small_motion(self, speed_rpm: float, argument: str) -> None:
        """Raise InputError for a speed at which the static displacements change the geometry."""
        moved = float(np.linalg.norm(self.displacement.reshape(-1, 3), axis=1).max()) * (RPM * speed_rpm) ** 2
        size = float(np.linalg.norm(np.ptp(self.structure.mesh.points, axis=0)))
        if moved > LARGEST_MOTION * size:
            allowed = speed_rpm * np.sqrt(LARGEST_MOTION * size / moved)
            raise argument_error(
                argument,
                f"{argument} is {speed_rpm:g}, but the centrifugal load then moves the structure by "
                f"{1e3 * moved:.4g} mm, {100.0 * moved / size:.3g} % of its size: linear prestress theory is valid up "
                f"to {100.0 * LARGEST_MOTION:g} %, which is {allowed:.6g} rpm. Check the axis, its point and the "
                "support.",
            )

    def _stiffness(self, speed_rpm: float) -> Any:
        return (self.structure.stiffness + (RPM * speed_rpm) ** 2 * self.speed_stiffness).tocsr()

    def _is_stable(self, stiffness: Any) -> bool:
        """Whether a stiffness has only positive eigenvalues, that of a sector in all nodal diameters."""
        supported = np.setdiff1d(np.arange(stiffness.shape[0]), self.unsupported)
        if is_positive_definite(stiffness[supported][:, supported]):
            return True
        if self.symmetry is None:
            return False
        sectors = self.symmetry.sectors
        lagged = lagged_model(replace(self.structure, stiffness=stiffness), self.symmetry)
        here = np.flatnonzero(np.isin(lagged.remaining, supported))
        every = (lagged.stiffness.at(diameter, sectors) for diameter in range(sectors // 2 + 1))
        return all(is_positive_definite(each[here][:, here]) for each in every)

    def require_complete(self, instead: str) -> None:
        """Raise InputError for a sector, which is used ``instead`` in another function."""
        if self.symmetry is not None:
            raise InputError(
                f"the rotating structure is a sector of a disk; give at(speed_rpm) to {instead}, with "
                "gyroscopic=coriolis_at(speed_rpm) for Coriolis forces, or the full ring here.",
                arguments=["rotor"],
            )

    def _collapse_below(self, speed_rpm: float) -> float:
        """rpm where the stiffness collapses, by bisection: its lowest eigenvalue is a concave function of W^2."""
        stable, collapsed = 0.0, speed_rpm
        while collapsed - stable > COLLAPSE_ACCURACY * collapsed:
            middle = 0.5 * (stable + collapsed)
            if self._is_stable(self._stiffness(middle)):
                stable = middle
            else:
                collapsed = middle
        return collapsed

    def static_displacement(self, speed_rpm: float) -> FloatArray:
        """(3 * n_nodes,) m under the centrifugal load, by the stiffness at rest: proportional to the speed squared."""
        return np.asarray((RPM * checked_speed(speed_rpm, np.inf)) ** 2 * self.displacement)

    def natural_frequencies(self, speed_rpm: float, count: int, coriolis: bool = True) -> FloatArray:
        """(count,) Hz of the structure without contact, in the rotating frame.

        With ``coriolis`` they are computed in the ``2 count + 12`` lowest modes without Coriolis forces. Raises
        InputError, see :meth:`at` and :func:`stickslip.structure.elasticity.natural_frequencies`.
        """
        self.require_complete("sector_frequencies")
        structure = self.at(speed_rpm)
        if not coriolis:
            return natural_frequencies(structure.stiffness, structure.mass, count)[0]
        return whirling_frequencies(structure.stiffness, structure.mass, self.coriolis_at(speed_rpm), count)


@dataclass(frozen=True)
class RotatingBodies:
    """Bodies of a mesh at a speed: ``structure`` has the stiffness there, and its Coriolis forces are a matrix of
    their own, csr (n_free, n_free) N s/m, or None.

    With a ``top_speed_rpm``, one reduction of the ``rotor`` is valid for all speeds up to it.
    """

    structure: Structure
    gyroscopic: Any
    rotor: RotatingStructure
    coriolis: bool
    speed_rpm: float
    top_speed_rpm: float | None = None

    @property
    def mesh(self) -> Mesh:
        """The mesh of all bodies."""
        return self.structure.mesh


def rotating(
    structure: Structure,
    axis: ArrayLike,
    point: ArrayLike = (0.0, 0.0, 0.0),
    *,
    symmetry: CyclicSymmetry | None = None,
    backend: Backend = "superlu",
    free_bodies: FreeBodies = "rejected",
    masses: ArrayLike | None = None,
) -> RotatingStructure:
    """A structure in a frame that rotates at a constant speed: linear prestress theory.

    In this theory the static state at a speed is that of the centrifugal load with the stiffness at rest; its stress,
    and so the stress stiffness, is proportional to the speed squared (docs/theory_rotation.md has the equations).
    ``backend`` is that of :func:`stickslip.structure.factor.factorize`.

    Parameters
    ----------
    structure:
        of :func:`assemble`: supported, so that its centrifugal load has a static state.
    axis:
        (3,) direction of the axis, of any length; the rotation is right-handed about it.
    point:
        (3,) m of a point on the axis.
    symmetry:
        for one sector of a disk: its static state is that of the whole disk. ``at(speed_rpm)`` is then a structure for
        :func:`sector_frequencies` and :func:`cyclic_sector`, and ``coriolis_at(speed_rpm)`` its gyroscopic matrix.
    free_bodies:
        bodies that nothing but contact supports, such as dampers: ``"at rest"`` gives them their matrices at rest. They
        have a centrifugal load, but no softening, no Coriolis forces and no stress stiffness, and their contact forces
        do not stress the other bodies. ``"rejected"`` raises InputError for them.
    masses:
        (n_nodes,) kg of mass points at nodes, which the mass matrix of the structure contains beside its cells.

    Raises
    ------
    InputError
        for masses of another shape, an axis of length zero or another one than that of the symmetry, a structure
        without materials, and one with a body that moves freely, unless ``free_bodies`` allows it; for one in which all
        bodies do.

    Sources: G. Genta, Dynamics of Rotating Systems (2005); M. Geradin, D. Rixen, Mechanical Vibrations, 3rd ed. (2015).
    """
    direction, origin = (_vector(name, value) for name, value in (("axis", axis), ("point", point)))
    length = float(np.linalg.norm(direction))
    if not length > 0.0:
        raise argument_error("axis", "axis is zero, but it must have a direction, such as (0, 0, 1).")
    direction = direction / length
    if len(structure.materials) <= int(structure.mesh.body.max()):
        raise InputError(
            "the structure has no materials, so its density is unknown. Make it with assemble or assemble_bodies.",
            arguments=["structure"],
        )
    points = np.zeros(structure.mesh.n_nodes) if masses is None else finite_array("masses", masses)
    if points.shape != (structure.mesh.n_nodes,):
        raise argument_error(
            "masses", f"masses must have shape ({structure.mesh.n_nodes},), but its shape is {points.shape}."
        )
    load = centrifugal_load(structure.mesh, structure.materials, direction, origin, points)
    if symmetry is not None:
        _require_axis_of(symmetry, direction, origin)
    require_choice("free_bodies", free_bodies, get_args(FreeBodies))
    motion, unsupported = _static_motion(structure, symmetry, structure.gather(load), backend, free_bodies)
    displacement = structure.expand(motion)
    mass = nodal_mass(structure.mesh, structure.materials) + scipy.sparse.diags(points)
    stress, softening, coriolis = (
        _of_unknowns(structure, matrix)
        for matrix in (
            stress_stiffness_matrix(structure, displacement),
            softening_matrix(mass, direction),
            coriolis_matrix(mass, direction),
        )
    )
    if unsupported.size:
        rotates = np.ones(motion.size)
        rotates[unsupported] = 0.0
        only = scipy.sparse.diags(rotates)
        stress, softening, coriolis = ((only @ each @ only).tocsr() for each in (stress, softening, coriolis))
    return RotatingStructure(
        structure, direction, origin, stress, softening, coriolis, load, displacement, symmetry, unsupported
    )


def _static_motion(
    structure: Structure, symmetry: CyclicSymmetry | None, load: FloatArray, backend: Backend, free_bodies: FreeBodies
) -> tuple[FloatArray, IntArray]:
    """(n_free,) m under a load (n_free,) N, and the unknowns of bodies that move freely, whose motion is zero.

    Raises InputError, see :func:`rotating`.
    """
    try:
        if symmetry is None:
            return factorize(structure.stiffness, backend).solve(load), np.empty(0, dtype=np.int64)
        return constant_motion(structure, symmetry, load, backend), np.empty(0, dtype=np.int64)
    except SingularMatrixError as error:
        if free_bodies == "rejected":
            raise InputError(
                "the structure has a body that moves freely, so its centrifugal load has no static state. Constrain "
                'it, or tie it to a body that is constrained; free_bodies="at rest" is for dampers that only contact '
                f"supports. ({error})",
                arguments=["structure"],
            ) from error
    if symmetry is None:
        free = unsupported_unknowns(structure.stiffness)
    else:
        model = lagged_model(structure, symmetry)
        alone = np.zeros(load.size, dtype=bool)
        alone[model.remaining[unsupported_unknowns(model.stiffness.at(0, symmetry.sectors))]] = True
        left, right, turned = boundary_unknowns(structure, symmetry)
        alone[right] = (abs(turned) @ alone[left].astype(float)) > 0.0
        free = np.flatnonzero(alone)
    if free.size == load.size:
        raise InputError(
            "no body of the structure is constrained, so its centrifugal load has no static state. Constrain one.",
            arguments=["structure"],
        )
    # A spring to the ground on the bodies that move freely: the others are not connected to them.
    restraint = np.zeros(load.size)
    restraint[free] = structure.stiffness.diagonal().max()
    regular = replace(structure, stiffness=(structure.stiffness + scipy.sparse.diags(restraint)).tocsr())
    without = load.copy()
    without[free] = 0.0
    if symmetry is None:
        return factorize(regular.stiffness, backend).solve(without), free
    return constant_motion(regular, symmetry, without, backend), free


def _require_axis_of(symmetry: CyclicSymmetry, direction: FloatArray, point: FloatArray) -> None:
    """Raise InputError for an axis of rotation that is not that of a symmetry."""
    beside = np.cross(symmetry.direction, point - symmetry.point)
    size = float(np.abs(point - symmetry.point).max())
    wrong = [
        name
        for name, error, scale in (("axis", np.cross(symmetry.direction, direction), 1.0), ("point", beside, size))
        if float(np.linalg.norm(error)) > SAME_AXIS * scale
    ]
    if wrong:
        axis, place = (", ".join(f"{each:.4g}" for each in row) for row in (symmetry.direction, symmetry.point))
        raise InputError(
            f"the axis of rotation is not that of the cyclic symmetry, which is along ({axis}) through ({place}) m. "
            "Give axis=symmetry.direction and point=symmetry.point.",
            arguments=wrong,
        )


def _vector(name: str, value: ArrayLike) -> FloatArray:
    array = finite_array(name, value)
    if array.shape != (3,):
        raise argument_error(name, f"{name} must be three numbers x, y, z, but its shape is {array.shape}.")
    return array


def _of_unknowns(structure: Structure, matrix: Any) -> Any:
    """``T^T A T``: csr (n_free, n_free) from (3 * n_nodes, 3 * n_nodes)."""
    rows = structure.of_unknowns(matrix)
    return structure.of_unknowns(rows.T.tocsr()).T.tocsr()
