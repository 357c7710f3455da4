"""The Campbell diagram of a rotating structure: natural frequencies of its linear limits at each speed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, whole_number
from stickslip.results.campbell import Campbell
from stickslip.solve.harmonic.compliance import require_one_size
from stickslip.solve.harmonic.damping import stuck_stiffness_matrix
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.structure.rotating_superelement import RotatingSuperelement
from stickslip.structure.superelement import Superelement


def campbell_diagram(
    rotor: RotatingSuperelement,
    pairs: ContactPairs | Callable[[float], ContactPairs] | None,
    speed_rpm: ArrayLike,
    *,
    count: int = 6,
) -> Campbell:
    """Natural frequencies with stuck contact and without contact over the speed, and their crossings with engine
    orders.

    Frequencies are those in the rotating frame, without damping: an excitation that is constant in space has multiples
    of the speed there, its engine orders. Each speed costs two dense eigenvalue problems and no reduction.

    Parameters
    ----------
    rotor:
        of :func:`rotating_superelement`.
    pairs:
        the joint, of which pairs that are closed at rest stick; or a function of the speed in rpm that gives the joint
        in its static state there; None without contact, where both limits are the same.
    speed_rpm:
        (s,) rising speeds, two or more.
    count:
        number of frequencies of each limit.

    Raises
    ------
    InputError
        for speeds that do not rise, or are not those of the reduction, and for pairs of another structure.
    """
    speeds = finite_array("speed_rpm", speed_rpm)
    if speeds.ndim != 1 or speeds.size < 2 or (np.diff(speeds) <= 0.0).any():
        raise InputError(
            "speed_rpm must contain two or more speeds in rising order, such as np.linspace(0, 9000, 31).",
            arguments=["speed_rpm"],
        )
    number = whole_number("count", count, 1)
    stuck, free = np.empty((2, speeds.size, number))
    for place, speed in enumerate(speeds.tolist()):
        superelement = rotor.at(speed)
        free[place] = stuck[place] = _natural_hz(superelement, superelement.stiffness, number)
        if pairs is not None:
            joint = pairs(speed) if callable(pairs) else pairs
            require_one_size(superelement, joint)
            stuck[place] = _natural_hz(superelement, stuck_stiffness_matrix(superelement, joint), number)
    return Campbell(tuple(f"{speed:g} rpm" for speed in speeds), speeds, stuck, free)


def _natural_hz(superelement: Superelement, stiffness: FloatArray, count: int) -> FloatArray:
    """(count,) Hz, NaN beyond the number of unknowns."""
    whirl = np.zeros_like(superelement.mass) if superelement.gyroscopic is None else superelement.gyroscopic
    lowest = LinearLimit.of_matrices(superelement.mass, stiffness, whirl).natural_hz[:count]
    return np.concatenate([lowest, np.full(count - lowest.size, np.nan)])
