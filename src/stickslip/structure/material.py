"""Linear elastic materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number, real_number, require_allowed


def require_strengths(fatigue_limit: float | None, tensile_strength: float | None) -> None:
    """Raise InputError for a fatigue limit above the tensile strength; either may be absent."""
    if fatigue_limit is not None and tensile_strength is not None and fatigue_limit > tensile_strength:
        raise InputError(
            f"fatigue_limit is {1e-6 * fatigue_limit:g} MPa, but tensile_strength is only "
            f"{1e-6 * tensile_strength:g} MPa; no material endures more than its "
            "strength. Steels have about half of it.",
            ("fatigue_limit",),
        )


@dataclass(frozen=True)
class Material:
    """Linear elastic material: Young's modulus in Pa, Poisson's ratio, density in kg/m3.

    The defaults are a blade steel, those of the default two-blade study. ``fatigue_limit`` is the alternating stress
    that the material endures without mean stress (0-to-peak), ``tensile_strength`` its ultimate strength, in Pa; only a
    Goodman check uses them, and it requires both. ``elastic`` (6, 6) Pa, as nested tuples, is the elastic matrix of an
    anisotropic material in x, y, z; modulus and ratio are its averages then, which the contact stiffness uses
    (:func:`stickslip.structure.anisotropy.anisotropic_material`).

    Raises InputError unless modulus, density and strengths are above 0, the ratio lies in (-1, 0.5), and the fatigue
    limit is not above the strength.
    """

    young_modulus: float = 197.0e9
    poisson_ratio: float = 0.3
    density: float = 7800.0
    fatigue_limit: float | None = None
    tensile_strength: float | None = None
    elastic: tuple[tuple[float, ...], ...] | None = None

    def __post_init__(self) -> None:
        for name, unit in (("young_modulus", "Pa"), ("density", "kg/m3")):
            positive_number(name, getattr(self, name), unit)
        for name in ("fatigue_limit", "tensile_strength"):
            if getattr(self, name) is not None:
                positive_number(name, getattr(self, name), "Pa")
        require_strengths(self.fatigue_limit, self.tensile_strength)
        ratio = real_number("poisson_ratio", self.poisson_ratio)
        require_allowed("poisson_ratio", ratio, -1.0 < ratio < 0.5, "between -1 and 0.5 (metals: about 0.3)")

    def elastic_matrix(self) -> FloatArray:
        """(6, 6) Pa, from strain xx, yy, zz, xy, yz, zx (engineering shear) to stress."""
        if self.elastic is not None:
            return np.array(self.elastic)
        shear = self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
        lame = 2.0 * shear * self.poisson_ratio / (1.0 - 2.0 * self.poisson_ratio)
        matrix = np.diag([2.0 * shear] * 3 + [shear] * 3)
        matrix[:3, :3] += lame
        return matrix
