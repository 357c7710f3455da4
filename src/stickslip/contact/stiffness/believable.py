"""Whether a law of contact stiffness is believable: comparison with the law that boundary elements confirm, and of the
fractal law with one round spot of its real area.

Persson's law with one patch and plastic waves is within a factor 2 of boundary elements in nearly all cases
(docs/theory_stiffness_laws.md). Two methods of measurement differ by 3 on one contact (Mulvihill et al., Exp. Mech. 53
(2013) 1245), so the band about it is 1/3 to 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.stiffness.asperities import fully_plastic_load
from stickslip.contact.stiffness.fractal import Roughness, fractal_contact, one_spot_stiffness
from stickslip.contact.stiffness.persson import PerssonStiffness
from stickslip.contact.stiffness.stiffness_law import StiffnessLaw

BAND = 3.0  # two methods of measurement differ by this factor (Mulvihill et al., Exp. Mech. 53 (2013) 1245)


@dataclass(frozen=True)
class Believable:
    """The stiffness per area of one pressure by a law and by Persson's, N/m3."""

    pressure: float  # Pa
    chosen: float
    persson: float

    @property
    def ratio(self) -> float:
        """The law over Persson's law."""
        return self.chosen / self.persson

    @property
    def band(self) -> tuple[float, float]:
        """The believable band in N/m3."""
        return self.persson / BAND, self.persson * BAND

    @property
    def is_inside(self) -> bool:
        """Whether the law is in the band."""
        return self.band[0] <= self.chosen <= self.band[1]

    def message(self, name: str) -> str:
        """A message on a stiffness outside of the band; ``name`` of the law."""
        if self.chosen == 0.0:
            comparison = "gives no stiffness instead of"
        elif self.ratio >= 1.0:
            comparison = f"gives {1e-9 * self.chosen:.3g} N/mm3, {self.ratio:.3g} times"
        else:
            comparison = f"gives {1e-9 * self.chosen:.3g} N/mm3, {fraction(self.ratio)} of"
        low, high = self.band
        return (
            f"Believable band: under {1e-6 * self.pressure:.3g} MPa {name} {comparison} "
            f"the {1e-9 * self.persson:.3g} N/mm3 of Persson's law, which boundary elements confirm; "
            f"believable are {1e-9 * low:.3g} to {1e-9 * high:.3g} N/mm3. "
            'Choose law = "persson", or give a measured stiffness.'
        )


@dataclass(frozen=True)
class BesideOneSpot:
    """The stiffness per area of one pressure by the fractal law beside that of one round spot of its real area, N/m3.

    The spot is a lower bound (:func:`one_spot_stiffness`). The published sums of elastic spots alone are below it from
    the load up to which all spots are plastic to 7.8 to 8.9 times that load in mode "consistent", and to 3.2 to 5.2
    times in mode "varying-curvature" (docs/theory_roughness.md, section 4; docs/theory_stiffness_laws.md, section 5).
    """

    pressure: float  # Pa
    chosen: float
    one_spot: float
    plastic_pressure: float  # Pa, up to which all spots are plastic

    @property
    def ratio(self) -> float:
        """The law over one round spot."""
        return self.chosen / self.one_spot

    @property
    def is_below(self) -> bool:
        """Whether no contact of this area can be as soft as the law gives it."""
        return self.chosen < self.one_spot

    def message(self, name: str) -> str:
        """A message on a stiffness below that of one round spot; ``name`` of the law."""
        return (
            f"Below one spot: under {1e-6 * self.pressure:.3g} MPa {name} gives {1e-9 * self.chosen:.3g} N/mm3, "
            f"{fraction(self.ratio)} of the {1e-9 * self.one_spot:.3g} N/mm3 of one round spot of its real contact "
            "area, and no contact of that area is softer: the pressure is "
            f"{self.pressure / self.plastic_pressure:.3g} times that up to which all spots are plastic, and the "
            'stiffness of plastic spots is missing in the law. Choose law = "persson" or mode = "unloading", which '
            "include it, or give a measured stiffness."
        )


def fraction(ratio: float) -> str:
    """A ratio below 1 in words: 1/3.2; 1/1 just below 1."""
    return f"1/{1.0 / ratio:.3g}"


def beside_one_spot(roughness: Roughness, law: StiffnessLaw, reference_area: float, pressure: float) -> BesideOneSpot:
    """The fractal law of a face of ``reference_area`` (m2), ``law``, at one pressure in Pa above 0, beside one spot.

    For the modes without a smallest spot: the sum of "unloading" is never below, since it has all spots.
    """
    area = fractal_contact(roughness, pressure * reference_area).real_area
    return BesideOneSpot(
        pressure,
        float(law.normal(np.array([pressure]))[0]),
        one_spot_stiffness(roughness, area) / reference_area,
        fully_plastic_load(roughness) / reference_area,
    )


def compared(law: StiffnessLaw, persson: PerssonStiffness, pressure: float) -> Believable:
    """A law against Persson's at one pressure in Pa."""
    at = np.array([pressure])
    return Believable(pressure, float(law.normal(at)[0]), float(persson.normal(at)[0]))
