"""Normal loads of contact pairs that grow with the square of the speed of rotation."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, real_number, require_allowed


def normal_load_at_speed(at_rest: ArrayLike, mass_times_radius: ArrayLike, speed_rpm: float) -> FloatArray:
    """``N = N_0 + m r W^2`` (n_pairs,) N, normal loads of pairs at a speed W, for ``ContactPairs(normal_load=...)``.

    Parameters
    ----------
    at_rest:
        (n_pairs,) or a number, N, the loads N_0 of assembly.
    mass_times_radius:
        (n_pairs,) or a number, kg m: what the pair carries of the mass of a damper or shroud, times the distance of its
        centre of mass from the axis, times the cosine between the centrifugal force and the normal. Below 0 for a pair
        that the rotation relieves.
    speed_rpm:
        0 or above.

    Raises InputError for a speed below 0, and for a load below 0: such a pair is open, and its gap is no question of
    this law (:func:`static_preload` computes it).
    """
    speed = real_number("speed_rpm", speed_rpm)
    require_allowed("speed_rpm", speed, speed >= 0.0, "0 or above")
    base, growth = finite_array("at_rest", at_rest), finite_array("mass_times_radius", mass_times_radius)
    load = np.atleast_1d(base + growth * (2.0 * math.pi / 60.0 * speed) ** 2)
    if (load < 0.0).any():
        worst = int(load.argmin())
        raise InputError(
            f"the normal load of pair {worst} is {load[worst]:.4g} N at {speed:g} rpm: the rotation opens it. Use "
            "static_preload with the centrifugal load of the structure, which computes its gap.",
            arguments=["mass_times_radius"],
        )
    return load
