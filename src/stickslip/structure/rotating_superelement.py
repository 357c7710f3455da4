"""The reduced matrices of a rotating structure as polynomials of its speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.linalg

from stickslip.core.errors import InputError
from stickslip.core.validation import (
    FloatArray,
    argument_error,
    finite_array,
    positive_number,
    real_number,
    require_allowed,
    skew_matrix,
    symmetric_matrix,
)
from stickslip.structure.superelement import Superelement, moves_freely

RPM = 2.0 * np.pi / 60.0  # rad/s of one revolution in a minute
# chosen: entries of the forces of K_w on a free motion that are round-off, over the product of both largest entries
NO_ACTION = 1e-8


@dataclass(frozen=True)
class RotatingSuperelement:
    """Dense matrices of ``M u'' + W G u' + (K + W^2 K_w) u = W^2 f`` in the rotating frame, for any speed W in rad/s.

    One reduction is valid for all speeds up to ``top_speed_rpm``: a superelement of a speed (:meth:`at`) is a sum of
    matrices.

    Parameters
    ----------
    at_rest:
        M and K, with the boundary nodes and the recovery of the displacements of the mesh.
    speed_stiffness:
        (n, n) kg, K_w: stress stiffness less spin softening for 1 rad/s.
    coriolis:
        (n, n) kg, G for 1 rad/s, skew-symmetric.
    load:
        (n,) N, the centrifugal load f for 1 rad/s.
    top_speed_rpm:
        rpm, the highest speed of the reduction.
    full_hz, reduced_hz:
        (k,) Hz, the lowest natural frequencies without contact at the highest speed of the mesh and of this reduction;
        empty if unknown.

    Raises
    ------
    InputError
        for matrices of another size, or without their symmetry, and a highest speed that is not above 0 or at which
        the stiffness has collapsed.
    """

    at_rest: Superelement
    speed_stiffness: FloatArray
    coriolis: FloatArray
    load: FloatArray
    top_speed_rpm: float
    full_hz: FloatArray
    reduced_hz: FloatArray

    def __post_init__(self) -> None:
        size = self.at_rest.size
        for name, check in (("speed_stiffness", symmetric_matrix), ("coriolis", skew_matrix), ("load", finite_array)):
            array = check(name, getattr(self, name))
            expected = (size,) if name == "load" else (size, size)
            if array.shape != expected:
                raise argument_error(
                    name, f"{name} has shape {array.shape}, but the superelement at rest has {size} unknowns."
                )
            object.__setattr__(self, name, array)
        top = positive_number("top_speed_rpm", self.top_speed_rpm)
        checked_speed(top, self.collapse_speed_rpm, "top_speed_rpm")

    def __repr__(self) -> str:
        return f"RotatingSuperelement({self.at_rest.size} unknowns, up to {self.top_speed_rpm:g} rpm)"

    @property
    def collapse_speed_rpm(self) -> float:
        """The lowest speed in rpm at which the stiffness without contact is singular, because spin softening exceeds
        it; infinite if none."""
        return collapse_speed(self.at_rest.stiffness, self.speed_stiffness, self.at_rest.mass)

    @property
    def difference_percent(self) -> FloatArray:
        """(k,) ``100 (reduced / full - 1)`` of the natural frequencies at the highest speed."""
        return np.asarray(100.0 * (self.reduced_hz / self.full_hz - 1.0))

    def at(self, speed_rpm: float, coriolis: bool = True) -> Superelement:
        """The superelement at a speed in rpm; ``coriolis`` False omits its gyroscopic matrix.

        Its damping is that at rest. Raises InputError for a speed below 0 or above that of the reduction.
        """
        omega = self._omega(speed_rpm)
        rest = self.at_rest
        return Superelement(
            rest.mass,
            rest.stiffness + omega**2 * self.speed_stiffness,
            rest.damping,
            boundary_nodes=rest.boundary_nodes,
            recovery=rest.recovery,
            positions=rest.positions,
            node_sets=rest.node_sets,
            gyroscopic=omega * self.coriolis if coriolis and omega else None,
        )

    def without_recovery(self) -> RotatingSuperelement:
        """Without what only the motion of the mesh requires."""
        return replace(self, at_rest=self.at_rest.without_recovery())

    def load_at(self, speed_rpm: float) -> FloatArray:
        """(n,) N, the centrifugal load at a speed in rpm, for :func:`static_preload`."""
        return np.asarray(self._omega(speed_rpm) ** 2 * self.load)

    def _omega(self, speed_rpm: float) -> float:
        return omega_of_reduction(speed_rpm, self.top_speed_rpm, "structure")


def omega_of_reduction(speed_rpm: float, top_speed_rpm: float, reduced: str) -> float:
    """rad/s of a speed of a reduction for several speeds. Raises InputError for one below 0 or above the highest."""
    speed = checked_speed(speed_rpm, np.inf)
    if speed > top_speed_rpm:
        raise InputError(
            f"speed_rpm is {speed:g}, but the reduction is for speeds up to {top_speed_rpm:g} rpm. Reduce the "
            f"{reduced} again with a higher top_speed_rpm.",
            arguments=["speed_rpm"],
        )
    return RPM * speed


def collapse_speed(stiffness: FloatArray, speed_stiffness: FloatArray, mass: FloatArray) -> float:
    """The lowest speed in rpm at which ``K + W^2 K_w`` (dense, n x n) is singular; infinite if none.

    Motions of free bodies, on which K_w does not act, do not count. Raises InputError for another stiffness at rest
    that is not positive definite.
    """
    size = len(stiffness)
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    rigid = moves_freely(stiffness, modes)
    free = modes[:, rigid]
    acting = np.abs(speed_stiffness @ free).max(initial=0.0)
    allowed = NO_ACTION * np.abs(speed_stiffness).max(initial=0.0) * np.abs(free).max(initial=0.0)
    if acting > allowed or (squares[~rigid] <= 0.0).any():
        raise InputError(
            "the stiffness at rest is not positive definite: a body moves freely, and at any speed the centrifugal "
            "force would throw it off. Constrain it, or tie it to a body that is constrained."
        )
    if rigid.any():  # a spring along each free motion, which the speed does not change
        carried = mass @ free
        stiffness = stiffness + float(squares[~rigid].min()) * carried @ carried.T
    largest = float(scipy.linalg.eigvalsh(-speed_stiffness, stiffness, subset_by_index=(size - 1, size - 1))[0])
    return 1.0 / (RPM * float(np.sqrt(largest))) if largest > 0.0 else np.inf


def checked_speed(speed_rpm: Any, collapse_rpm: float, name: str = "speed_rpm") -> float:
    """The speed as a number. Raises InputError unless it is 0 or above, and below that of collapse."""
    speed = real_number(name, speed_rpm)
    require_allowed(name, speed, speed >= 0.0, "0 or above; the axis gives the sense of rotation")
    if speed >= collapse_rpm:
        raise argument_error(
            name,
            f"{name} is {speed:g}, but the stiffness collapses at {collapse_rpm:.5g} rpm: from there on, spin "
            "softening exceeds it, and the structure has no stable state. Give a lower speed, or a stiffer support.",
        )
    return speed
