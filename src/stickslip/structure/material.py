"""Linear elastic materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number, real_number, require_allowed

# Relative difference of averages that are the same: round-off of an inverse.
SAME_AVERAGE = 1e-9


def require_strengths(fatigue_limit: float | None, tensile_strength: float | None) -> None:
    """Raise InputError for a fatigue limit above the tensile strength; either may be absent."""
    if fatigue_limit is not None and tensile_strength is not None and fatigue_limit > tensile_strength:
        raise InputError(
            f"fatigue_limit is {1e-6 * fatigue_limit:g} MPa, but tensile_strength is only "
            f"{1e-6 * tensile_strength:g} MPa; no material endures more than its "
            "strength. Steels have about half of it.",
            ("fatigue_limit",),
        )


def isotropic_averages(elastic: FloatArray) -> tuple[float, float]:
    """Young's modulus in Pa and Poisson's ratio of an elastic matrix (6, 6) Pa over all directions.

    Averages of Voigt and Reuss (Hill): half the sum of the isotropic moduli of the averaged stiffness and of the
    averaged compliance. Source: R. Hill, The elastic behaviour of a crystalline aggregate, Proc. Phys. Soc. A 65 (1952)
    349-354.
    """
    compliance = np.linalg.inv(elastic)
    bulk = 0.5 * (elastic[:3, :3].sum() / 9.0 + 1.0 / compliance[:3, :3].sum())
    voigt = (3.0 * np.trace(elastic[:3, :3]) - elastic[:3, :3].sum()) / 30.0 + np.trace(elastic[3:, 3:]) / 5.0
    reuss = 15.0 / (
        2.0 * (3.0 * np.trace(compliance[:3, :3]) - compliance[:3, :3].sum()) + 3.0 * np.trace(compliance[3:, 3:])
    )
    shear = 0.5 * (voigt + reuss)
    young = 9.0 * bulk * shear / (3.0 * bulk + shear)
    return float(young), float((3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear)))


@dataclass(frozen=True)
class Material:
    """Linear elastic material: Young's modulus in Pa, Poisson's ratio, density in kg/m3.

    The defaults are a blade steel, those of the default two-blade study. ``fatigue_limit`` is the alternating stress
    that the material endures without mean stress (0-to-peak), ``tensile_strength`` its ultimate strength, in Pa; only a
    Goodman check uses them, and it requires both. ``elastic`` (6, 6) Pa, as nested tuples, is the elastic matrix of an
    anisotropic material in x, y, z; modulus and ratio are its averages then, which the contact stiffness uses
    (:func:`stickslip.structure.anisotropy.anisotropic_material`).

    Raises InputError unless modulus, density and strengths are above 0, the ratio lies in (-1, 0.5), the fatigue limit
    is not above the strength, and modulus and ratio are the averages of ``elastic``.
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
        if self.elastic is not None and not np.allclose(
            (self.young_modulus, ratio), isotropic_averages(np.array(self.elastic)), rtol=SAME_AVERAGE, atol=0.0
        ):
            raise InputError(
                f"young_modulus {1e-9 * self.young_modulus:g} GPa and poisson_ratio {ratio:g} are not the averages of "
                "the elastic matrix of this anisotropic material, so one of them would have no effect. Change the "
                "matrix, with anisotropic_material.",
                ("young_modulus", "elastic"),
            )

    def elastic_matrix(self) -> FloatArray:
        """(6, 6) Pa, from strain xx, yy, zz, xy, yz, zx (engineering shear) to stress."""
        if self.elastic is not None:
            return np.array(self.elastic)
        shear = self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
        lame = 2.0 * shear * self.poisson_ratio / (1.0 - 2.0 * self.poisson_ratio)
        matrix = np.diag([2.0 * shear] * 3 + [shear] * 3)
        matrix[:3, :3] += lame
        return matrix
