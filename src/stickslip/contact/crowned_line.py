"""Forces along a contact line whose cylinder is crowned: slices with one common approach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from stickslip.contact.stiffness.hertz_line import HertzLine
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, positive_number, require_positive


def crowned_forces(line: HertzLine, total: float, length: ArrayLike, drop: ArrayLike) -> FloatArray:
    """Forces (k,) in N of the slices of a contact line under ``total`` N; below zero it is the gap of an open slice.

    The slicing technique of roller bearings (T. A. Harris, Rolling Bearing Analysis; ISO/TS 16281): the bodies approach
    by one distance delta, and a slice of the length l_i whose profile drops by d_i carries the force of a straight
    cylinder, l_i q(delta - d_i); the slices do not support each other. delta follows from the sum of the forces. The
    gap of an open slice is written as the force that the spring of the mean force would need to close it.

    ``length`` (k,) and ``drop`` (k,) of the slices in m. Raises InputError for a force that is not above zero, or that
    is larger than a line contact of this mesh carries.
    """
    force = positive_number("total", total, "N")
    lengths, drops = finite_array("length", length), finite_array("drop", drop)
    require_positive("length", lengths, "Each slice of the line has a length.")
    lowest, largest = float(drops.min()), float(line.approach(np.array([line.largest_force]))[0])
    if force >= float(lengths @ line.force(np.maximum(lowest + largest * (1.0 - 1e-9) - drops, 0.0))):
        raise InputError(
            f"the force on a line of {1e3 * lengths.sum():.4g} mm is {force:.4g} N, but Hertz' law for the part below "
            f"the elements is valid to {1e-3 * line.largest_force:.4g} N/mm: beyond, the contact is wider than they "
            "resolve. Use a smaller force, a smaller radius or fewer elements.",
            arguments=["total"],
        )

    def excess(approach: float) -> float:
        return float(lengths @ line.force(approach - drops)) - force

    approach = brentq(excess, lowest, lowest + largest * (1.0 - 1e-9), xtol=1e-18, rtol=1e-14)
    forces = lengths * line.force(approach - drops)
    forces *= force / forces.sum()  # round-off of the root
    mean = float(line.stiffness(np.array([force / lengths.sum()]))[0])
    return np.where(approach > drops, forces, mean * lengths * (approach - drops))
