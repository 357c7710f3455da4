"""Fractal contact of a rough face: roughness parameters, size distribution of the spots, load and area in closed form.

Equations and sources: docs/theory_roughness.md. The variable of a spot is its truncated area a' (m2). All integrals
over the spots are of the form "integral of a'^(e-1) da'", and areas are natural logarithms, so that D = 2.5 (e = 0) and
D near 2 (a_c' over hundreds of decades) need no special case.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import exp, expm1, inf, log, log1p, pi

from scipy.optimize import brentq

from stickslip.core.errors import InputError, RoughnessError
from stickslip.core.validation import positive_number, real_number, require_allowed

LOG_LARGEST_NUMBER = 690.0  # exp() of more leaves the range of double precision
SMALLEST_SPREAD = 1e-9  # of ln a' between the smallest and the largest spot; below it round-off decides the result


@dataclass(frozen=True)
class Roughness:
    """Weierstrass-Mandelbrot roughness of a contact face, and the material constants of its spots.

    D determines the distribution of the height over the wavelengths, G its size. At the same G a face with larger D is
    smoother and stiffer; a face with larger G is rougher and softer.

    Parameters
    ----------
    fractal_dimension:
        D of the surface, 2 < D < 3; a profile has D - 1.
    fractal_roughness:
        G in m.
    hardness:
        H in Pa, of the softer face.
    reduced_modulus:
        E* in Pa.
    poisson_ratio:
        of both faces.
    domain_extension:
        psi of the size distribution of the spots; 1 for none.
    frequency_ratio:
        gamma, ratio of successive wave numbers.
    sample_length, shortest_length:
        L and Ls in m, the longest and the shortest wave; None if the law does not require them.

    Raises
    ------
    InputError
        for a value out of range; RoughnessError if the size of the spots is outside of floating-point numbers.
    """

    fractal_dimension: float
    fractal_roughness: float
    hardness: float
    reduced_modulus: float
    poisson_ratio: float
    domain_extension: float = 1.0
    frequency_ratio: float = 1.5
    sample_length: float | None = None
    shortest_length: float | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None or field.default is not None:  # only the two lengths are optional
                object.__setattr__(self, field.name, real_number(field.name, value))
        dimension = self.fractal_dimension
        hint = ""
        if 1 < dimension <= 2:
            hint = f". If {dimension:g} is the dimension of a profile, give {dimension:g} + 1"
        require_surface_dimension(dimension, hint)
        for name, unit in (("fractal_roughness", "m"), ("hardness", "Pa"), ("reduced_modulus", "Pa")):
            positive_number(name, getattr(self, name), unit)
        require_poisson_ratio("poisson_ratio", self.poisson_ratio)
        require_allowed("domain_extension", self.domain_extension, self.domain_extension >= 1, "1 or above")
        require_allowed("frequency_ratio", self.frequency_ratio, self.frequency_ratio > 1, "above 1")
        for name in ("sample_length", "shortest_length"):
            if getattr(self, name) is not None:
                positive_number(name, getattr(self, name), "m")
        longest, shortest = self.sample_length, self.shortest_length
        if longest is not None and shortest is not None and not shortest < longest:
            raise InputError(
                f"shortest_length is {shortest:g} m, but it must be below sample_length, {longest:g} m: the "
                "wavelengths of the surface are between the two.",
                arguments=["shortest_length"],
            )
        if abs(log_critical_area(self)) > LOG_LARGEST_NUMBER:
            raise RoughnessError(
                f"fractal_dimension {dimension:g} with fractal_roughness {self.fractal_roughness:g} m puts the "
                f"critical area of the spots at 1e{log_critical_area(self) / log(10):.0f} m2, which is outside the "
                "range of floating-point numbers. Its exponent is 2 / (D - 2): choose D farther from 2, or check the "
                "unit of G.",
                arguments=["fractal_dimension"],
            )

    @property
    def profile_dimension(self) -> float:
        """d = D - 1, the dimension in the equations of the spots."""
        return self.fractal_dimension - 1.0


def require_surface_dimension(fractal_dimension: float, hint: str = "") -> None:
    """Raise InputError unless 2 < D < 3; the message ends with ``hint``."""
    allowed = f"between 2 and 3: it is D of the surface{hint}"
    require_allowed("fractal_dimension", fractal_dimension, 2 < fractal_dimension < 3, allowed)


def require_poisson_ratio(name: str, ratio: float) -> None:
    """Raise InputError unless -1 < nu <= 0.5."""
    require_allowed(name, ratio, -1 < ratio <= 0.5, "above -1 and at most 0.5")


def elastic_load_factor(roughness: Roughness) -> float:
    """B of F_e = B a'^((3-d)/2), the load of an elastic spot (N, a' in m2); d = D - 1.

    B = 2^((9-2d)/2) / (3 pi^((3-d)/2)) sqrt(ln gamma) G^(d-1) E*: Hertz with R = r'^2 / (2 delta) and
    delta = 2 G^(d-1) sqrt(ln gamma) (2r')^(2-d).
    """
    return exp(_log_elastic_load_factor(roughness))


def _log_elastic_load_factor(roughness: Roughness) -> float:
    d = roughness.profile_dimension
    return (
        0.5 * (9 - 2 * d) * log(2)
        - log(3)
        - 0.5 * (3 - d) * log(pi)
        + 0.5 * log(log(roughness.frequency_ratio))
        + (d - 1) * log(roughness.fractal_roughness)
        + log(roughness.reduced_modulus)
    )


def log_critical_area(roughness: Roughness) -> float:
    """ln a_c' (a_c' in m2) with a_c' = (B/H)^(2/(d-1)): smaller spots are plastic, larger ones elastic (F_e = H a')."""
    log_ratio = _log_elastic_load_factor(roughness) - log(roughness.hardness)
    return 2.0 / (roughness.profile_dimension - 1.0) * log_ratio


def power_integral(log_lower: float, log_upper: float, exponent: float) -> float:
    """Integral of a^(exponent-1) from exp(log_lower) to exp(log_upper), 0 if the upper end is not above the lower.

    expm1 keeps it exact for an exponent near 0, where it becomes the logarithm; log_lower = -inf is allowed for an
    exponent above 0. The end with the larger power is factored out, so nothing overflows.
    """
    if not log_upper > log_lower:
        return 0.0
    if exponent == 0.0:
        return log_upper - log_lower
    anchor = log_upper if exponent > 0 else log_lower
    return exp(exponent * anchor) * -expm1(-abs(exponent) * (log_upper - log_lower)) / abs(exponent)


@dataclass(frozen=True)
class SpotPopulation:
    """The spots n(a') = (d/2) psi^((2-d)/2) a_l'^(d/2) a'^(-d/2-1) per m2 from a_s' to a_l', split at a_c'."""

    roughness: Roughness
    log_smallest: float  # ln a_s', -inf where the waves have no lower end
    log_largest: float  # ln a_l'

    @property
    def scale(self) -> float:
        """C = (d/2) psi^((2-d)/2) a_l'^(d/2): n(a') = C a'^(-d/2-1)."""
        d = self.roughness.profile_dimension
        return 0.5 * d * extension_power(self.roughness) * exp(0.5 * d * self.log_largest)

    @property
    def log_plastic_end(self) -> float:
        """ln m, m = min(a_c', a_l'): the largest plastic spot."""
        return min(log_critical_area(self.roughness), self.log_largest)

    @property
    def log_elastic_start(self) -> float:
        """ln of max(a_c', a_s'): the smallest elastic spot."""
        return max(log_critical_area(self.roughness), self.log_smallest)

    def plastic_moment(self, exponent: float) -> float:
        """C times the integral of a'^(exponent-1) over the plastic spots."""
        return self.scale * power_integral(self.log_smallest, self.log_plastic_end, exponent)

    def elastic_moment(self, exponent: float) -> float:
        """C times the integral of a'^(exponent-1) over the elastic spots."""
        return self.scale * power_integral(self.log_elastic_start, self.log_largest, exponent)

    @property
    def plastic_load(self) -> float:
        """P_p in N: each plastic spot carries H a'."""
        return self.roughness.hardness * self.plastic_moment(_area_exponent(self.roughness))

    @property
    def elastic_load(self) -> float:
        """P_e in N: each elastic spot carries B a'^((3-d)/2)."""
        return elastic_load_factor(self.roughness) * self.elastic_moment(_elastic_load_exponent(self.roughness))

    @property
    def load(self) -> float:
        """P = P_p + P_e in N: plastic spots up to min(a_c', a_l'), elastic ones from max(a_c', a_s') to a_l'."""
        return self.plastic_load + self.elastic_load

    @property
    def real_area(self) -> float:
        """A_r in m2: a' for a plastic spot, a'/2 for an elastic one."""
        exponent = _area_exponent(self.roughness)
        return self.plastic_moment(exponent) + 0.5 * self.elastic_moment(exponent)

    @property
    def log_median_area(self) -> float:
        """ln of the a' that halves the load: spots below it carry as much as spots above it."""
        smaller = 0.5 * self.load
        if smaller <= self.plastic_load:
            exponent, factor, start = _area_exponent(self.roughness), self.roughness.hardness, self.log_smallest
        else:
            exponent = _elastic_load_exponent(self.roughness)
            factor, start = elastic_load_factor(self.roughness), self.log_elastic_start
            smaller -= self.plastic_load
        integral = smaller / (factor * self.scale)
        if start == -inf:
            return log(exponent * integral) / exponent
        reduced = integral * exp(-exponent * start)
        return start + (log1p(exponent * reduced) / exponent if exponent else reduced)


def _area_exponent(roughness: Roughness) -> float:
    """e of the real area and of the plastic load, (2-d)/2."""
    return 0.5 * (2.0 - roughness.profile_dimension)


def _elastic_load_exponent(roughness: Roughness) -> float:
    """e of the elastic load, (3-2d)/2: zero at D = 2.5."""
    return 0.5 * (3.0 - 2.0 * roughness.profile_dimension)


def extension_power(roughness: Roughness) -> float:
    """psi^((2-d)/2), the factor by which the domain extension raises the size distribution."""
    return float(roughness.domain_extension ** _area_exponent(roughness))


def fully_plastic_load(roughness: Roughness) -> float:
    """Load in N up to which every spot is plastic (a_l' = a_c', no smallest spot): H psi^((2-d)/2) d/(2-d) a_c'."""
    d = roughness.profile_dimension
    return roughness.hardness * extension_power(roughness) * d / (2.0 - d) * exp(log_critical_area(roughness))


def spots_under_load(roughness: Roughness, load: float, log_smallest: float = -inf) -> SpotPopulation:
    """The spots that carry ``load`` (N, above 0): P(a_l') = load is solved for ln a_l' by Brent's method.

    P rises strictly with a_l'. Its root is at least the all-plastic value (2-d) F / (d H psi^((2-d)/2)), because no
    spot carries more than H a', and it is that value if it lies below a_c' and a_s' = 0. Raises RoughnessError if the
    load leads beyond the range of floating-point numbers, or is negligible beside that of one smallest spot.
    """
    d = roughness.profile_dimension
    lower = log(load * (2.0 - d) / (d * roughness.hardness * extension_power(roughness)))
    if log_smallest == -inf and lower <= log_critical_area(roughness):
        return SpotPopulation(roughness, log_smallest, lower)
    if log_smallest > -inf:
        _reject_a_single_spot(roughness, load, log_smallest)
        lower = max(lower, log_smallest)

    def excess(log_largest: float) -> float:
        return SpotPopulation(roughness, log_smallest, log_largest).load / load - 1.0

    upper = lower
    while excess(upper) < 0.0:
        upper += log(10.0)
        if upper > LOG_LARGEST_NUMBER:
            raise RoughnessError(
                f"No size of the largest spot carries {load:g} N with fractal_dimension "
                f"{roughness.fractal_dimension:g} and fractal_roughness {roughness.fractal_roughness:g} m. "
                "Check the units of G, H and E*."
            )
    if upper == lower:  # the bound is the root, except for round-off
        return SpotPopulation(roughness, log_smallest, lower)
    return SpotPopulation(roughness, log_smallest, float(brentq(excess, lower, upper, xtol=1e-13, rtol=8.9e-16)))


def _reject_a_single_spot(roughness: Roughness, load: float, log_smallest: float) -> None:
    least = SpotPopulation(roughness, log_smallest, log_smallest + SMALLEST_SPREAD).load
    if load < least:
        raise RoughnessError(
            f"The load, {load:g} N, is far below that of one smallest spot, a_s' = {exp(log_smallest):.3g} m2: the "
            f"contact law requires a range of spot sizes, and more than {least:.3g} N. Raise the load or give a "
            "shorter shortest_length."
        )


def domain_extension_factor(fractal_dimension: float) -> float:
    """psi of Wang and Komvopoulos for a surface of dimension D: psi^((2-d)/2) - (1 + psi^(-d/2))^(-(2-d)/d) = (2-d)/d.

    Raises InputError unless 2 < D < 3.
    """
    fractal_dimension = real_number("fractal_dimension", fractal_dimension)
    require_surface_dimension(fractal_dimension)
    d = fractal_dimension - 1.0

    def residual(log_psi: float) -> float:
        # Both sides minus 1, so that the root keeps its digits where d approaches 2 and each term its limit.
        power = expm1(0.5 * (2 - d) * log_psi) - expm1(-(2 - d) / d * log1p(exp(-0.5 * d * log_psi)))
        return power - (2 - d) / d

    return exp(float(brentq(residual, 0.0, 5.0, xtol=1e-14)))
