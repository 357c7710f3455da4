"""Line contact of a cylinder on a flat by Hertz: approach, stiffness and pressure for a force per length.

Two elastic half-planes touch over the width 2 b. The approach of two points, each at the depth d below the surface of
its body, under the force per length q is (K. L. Johnson, Contact Mechanics, Cambridge 1985, eq. 4.45 and 5.55)

    b = sqrt(4 q R / (pi E*)),   delta = sum over both bodies of q (1 - nu^2) / (pi E) (2 ln(2 d / b) - nu / (1 - nu)).

It depends on the depths: the displacement of a half-plane grows with the logarithm of the distance without limit, so a
line contact has no stiffness of its own. Here the finite elements are the bodies beyond, and the depth is the one that
makes elements and contact together the half-plane (:func:`node_radius`).

The stiffness is the derivative d q / d delta, for small motions about the load. Across the axis the tangential
compliance of a line is that along the normal, along the axis it is 1 / (1 - nu) times as large, for the same logarithm.
Mindlin's ratio 2 (1 - nu) / (2 - nu) is the mean of these two compliances, and is used for all directions.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, pi, sqrt

import numpy as np
from scipy.special import lambertw

from stickslip.contact.stiffness.asperities import require_poisson_ratio
from stickslip.contact.stiffness.tangential import tangential_ratio
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number, real_number

# Formulation of the elements -> c and p of the radius c along^p deep^(1-p) on whose circle a half-plane has the
# displacement of a loaded node; computed with half-planes of elements (tests/contact/stiffness/test_hertz_line.py).
# Sides between 1/2 and 2 of each other: within 10 %; Poisson's ratios 0 and 0.45 instead of 0.3: within 30 % (of an
# argument of a logarithm).
NODE_RADIUS = {"incompatible": (0.1026, 0.87), "trilinear": (0.1287, 0.68), "serendipity": (0.0657, 0.56)}


@dataclass(frozen=True)
class LineBody:
    """One of the two bodies: modulus in Pa, Poisson's ratio, and ``depth`` in m of its reference point.

    Raises InputError for a modulus or a depth that is not above zero, and a ratio outside of -1 to 0.5.
    """

    young_modulus: float
    poisson_ratio: float
    depth: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "young_modulus", positive_number("young_modulus", self.young_modulus, "Pa"))
        object.__setattr__(self, "poisson_ratio", real_number("poisson_ratio", self.poisson_ratio))
        require_poisson_ratio("poisson_ratio", self.poisson_ratio)
        object.__setattr__(self, "depth", positive_number("depth", self.depth, "m"))

    @property
    def compliance(self) -> float:
        """(1 - nu^2) / (pi E), m2/N."""
        return (1.0 - self.poisson_ratio**2) / (pi * self.young_modulus)


def node_radius(element: str, along: float, deep: float) -> float:
    """Radius in m of the circle on which a half-plane under a line force has the displacement of the loaded node.

    ``along``, ``deep``: sides in m of the elements at the node, along the surface and into the body. A mesh gives a
    loaded node a finite displacement, although that under a line force is infinite.
    """
    factor, exponent = NODE_RADIUS[element]
    return float(factor * along**exponent * deep ** (1.0 - exponent))


def depth_below_node(radius: float, poisson_ratio: float) -> float:
    """Depth in m at which a half-plane has the displacement of its surface at this distance from a line force.

    With it, elements and contact together have the compliance of the half-plane.
    """
    return radius * exp(0.5 / (1.0 - poisson_ratio))


@dataclass(frozen=True)
class HertzLine:
    """A cylinder of ``radius`` R in m on a flat, two bodies.

    Raises InputError for a radius that is not above zero.
    """

    radius: float
    first: LineBody
    second: LineBody

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", positive_number("radius", self.radius, "m"))

    @property
    def bodies(self) -> tuple[LineBody, LineBody]:
        """Both bodies."""
        return self.first, self.second

    @property
    def reduced_modulus(self) -> float:
        """E* in Pa."""
        return 1.0 / (pi * self._compliance)

    @property
    def _compliance(self) -> float:
        """Sum of (1 - nu^2) / (pi E) of both bodies, m2/N."""
        return self.first.compliance + self.second.compliance

    @property
    def _logarithm(self) -> float:
        """L of the approach q C (L - ln q), C the sum of the compliances."""
        parts = (
            body.compliance
            * (2.0 * log(body.depth) + log(pi * self.reduced_modulus / self.radius) - _strain_part(body.poisson_ratio))
            for body in self.bodies
        )
        return sum(parts) / self._compliance

    @property
    def largest_force(self) -> float:
        """N/m, above which the stiffness would be negative: the contact is as wide as the bodies are deep."""
        return exp(self._logarithm - 1.0)

    def half_width(self, force: float) -> float:
        """b in m under ``force`` in N/m."""
        return sqrt(4.0 * force * self.radius / (pi * self.reduced_modulus))

    def largest_pressure(self, force: float) -> float:
        """p0 = sqrt(q E* / (pi R)) in Pa, in the middle of the contact."""
        return sqrt(force * self.reduced_modulus / (pi * self.radius))

    def approach(self, force: FloatArray) -> FloatArray:
        """delta (k,) in m under forces (k,) in N/m, above zero."""
        force = np.asarray(force, dtype=float)
        return np.asarray(force * self._compliance * (self._logarithm - np.log(force)))

    def stiffness(self, force: FloatArray) -> FloatArray:
        """d q / d delta (k,) in N/m2 under forces (k,) in N/m; 0 from :attr:`largest_force`."""
        force = np.asarray(force, dtype=float)
        with np.errstate(divide="ignore"):
            compliance = self._compliance * (self._logarithm - 1.0 - np.log(force))
        return np.where(compliance > 0.0, 1.0 / np.where(compliance > 0.0, compliance, 1.0), 0.0)

    def force(self, approach: FloatArray) -> FloatArray:
        """q (k,) in N/m for an approach (k,) in m; 0 where the approach is not above zero.

        Raises InputError for an approach that no force below :attr:`largest_force` gives.
        """
        reached = np.maximum(np.asarray(approach, dtype=float), 0.0)
        most = self.largest_force * self._compliance
        if reached.max(initial=0.0) > most:
            raise InputError(
                f"approach is {reached.max():.3g} m, but this line contact allows at most {most:.3g} m: beyond, it is "
                "as wide as its bodies are deep.",
                arguments=["approach"],
            )
        # q (L - ln q) = delta / C with u = L - ln q: -u exp(-u) = -delta / C exp(-L), u from 1 to infinity.
        closed = np.where(reached > 0.0, reached, 1.0)
        argument = np.maximum(-closed / self._compliance * exp(-self._logarithm), -exp(-1.0))
        values = np.exp(self._logarithm + lambertw(argument, k=-1).real)
        return np.where(reached > 0.0, values, 0.0)


def _strain_part(poisson_ratio: float) -> float:
    """nu / (1 - nu) of the approach."""
    return poisson_ratio / (1.0 - poisson_ratio)


@dataclass(frozen=True)
class HertzLineStiffness:
    """The stiffness law of a strip of ``width`` in m around a contact line, over its mean pressure.

    Raises InputError for a width that is not above zero.
    """

    line: HertzLine
    width: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "width", positive_number("width", self.width, "m"))

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return self.line.stiffness(np.asarray(pressure) * self.width) / self.width

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        compliance = sum(
            body.compliance / tangential_ratio("mindlin", body.poisson_ratio) for body in self.line.bodies
        ) / sum(body.compliance for body in self.line.bodies)
        return self.normal(pressure) / compliance

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """A message where the contact is as wide as the mesh is fine."""
        force = float(np.max(pressure)) * self.width
        if force < self.line.largest_force:
            return ()
        return (
            f"under {1e-3 * force:.3g} N/mm the contact is {2e3 * self.line.half_width(force):.3g} mm wide, wider than "
            f"its elements resolve, and Hertz' law for the part below the elements is valid to "
            f"{1e-3 * self.line.largest_force:.3g} N/mm. Use fewer mesh.contact_columns and damper_columns.",
        )

    def describe(self) -> str:
        """The law in one line."""
        depths = " and ".join(f"{1e3 * body.depth:.3g} mm" for body in self.line.bodies)
        return f"Hertz, a cylinder of {1e3 * self.line.radius:.4g} mm on a flat, reference depths {depths}"
