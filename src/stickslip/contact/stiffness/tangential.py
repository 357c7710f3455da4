"""Tangential over normal contact stiffness."""

from __future__ import annotations

from math import pi
from typing import Literal, get_args

from stickslip.contact.stiffness.asperities import require_poisson_ratio
from stickslip.core.validation import real_number, require_choice

TangentialRatio = Literal["mindlin", "sherif-kossa"]


def tangential_ratio(name: TangentialRatio, poisson_ratio: float) -> float:
    """K_t / K_n of two faces of one material.

    mindlin: ``2 (1-nu) / (2-nu)``, contact without slip; the same for any shape of contact that has no preferred
        direction (R. D. Mindlin, J. Appl. Mech. 16 (1949) 259; C. Campana, B. N. J. Persson, M. H. Mueser, J. Phys.:
        Condens. Matter 23 (2011) 085001).
    sherif-kossa: ``pi (1-nu) / (2 (2-nu))``, from ultrasonic waves through rough faces (H. A. Sherif, S. S. Kossa, Wear
        151 (1991) 49).

    Raises InputError for another name or -1 < nu <= 0.5 violated.
    """
    require_choice("tangential_law", name, get_args(TangentialRatio))
    ratio = real_number("poisson_ratio", poisson_ratio)
    require_poisson_ratio("poisson_ratio", ratio)
    factor = 2.0 if name == "mindlin" else 0.5 * pi
    return factor * (1.0 - ratio) / (2.0 - ratio)
