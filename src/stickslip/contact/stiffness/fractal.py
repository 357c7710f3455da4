"""Contact stiffness of a rough face from its roughness and load, and its distribution over the contact pairs.

Equations and sources: docs/theory_roughness.md. The population of contact spots is in asperities.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from enum import StrEnum
from math import exp, inf, log, pi, sqrt
from typing import Literal, get_args

from stickslip.contact.stiffness.asperities import (
    LOG_LARGEST_NUMBER,
    Roughness,
    SpotPopulation,
    fully_plastic_load,
    log_critical_area,
    require_poisson_ratio,
    spots_under_load,
)
from stickslip.contact.stiffness.surface import surface_statistics
from stickslip.contact.stiffness.tangential import tangential_ratio
from stickslip.core.errors import InputError
from stickslip.core.validation import positive_number, real_number, require_choice

__all__ = [
    "ContactStatus",
    "ContactStiffness",
    "Roughness",
    "elastic_limits",
    "fractal_contact",
    "one_spot_stiffness",
    "published_contact",
    "reduced_modulus",
]

StiffnessMode = Literal["consistent", "varying-curvature", "unloading"]

LARGEST_AREA_RATIO = 0.1  # real over nominal area above which spots touch each other
LARGEST_ASPERITY_SLOPE = 0.1  # interference over radius above which Hertz's assumption of small strain fails
NEAR_LIMIT = 0.05  # chosen: distance of D from 2 or 3 below which the exponents 2/(D-2) or 1/(3-D) exceed 40 or 20


class ContactStatus(StrEnum):
    """Whether the fractal contact law can be trusted; the order of the names is from worst to best."""

    NO_CONTACT = "no contact"
    FULLY_PLASTIC = "fully plastic"
    REAL_AREA_ABOVE_NOMINAL = "real area above nominal"
    LARGEST_AREA_ABOVE_NOMINAL = "largest spot above nominal area"
    SHORTEST_WAVE_BELOW_ROUGHNESS = "shortest wave below fractal roughness"
    STEEP_SURFACE = "steep surface"
    STEEP_ASPERITIES = "steep asperities"
    LARGE_REAL_AREA = "large real area"
    NO_PLASTIC_SPOTS = "no plastic spots"
    DIMENSION_NEAR_LIMIT = "dimension near its limit"
    VALID = "valid"


WORST_FIRST = tuple(ContactStatus)
Finding = tuple[ContactStatus, str]  # the status, and a message with numbers


@dataclass(frozen=True)
class FaceStiffness:
    """Stiffness of a whole rough face under one load, with the messages of its law."""

    normal: float  # N/m
    tangential: float  # N/m
    messages: tuple[str, ...]  # worst first


@dataclass(frozen=True)
class ContactStiffness(FaceStiffness):
    """Stiffness of a whole rough face by the fractal law, with its spots; one message for each finding."""

    critical_area: float  # a_c' in m2: smaller spots are plastic
    largest_area: float  # a_l' in m2
    real_area: float  # A_r in m2
    plastic_load_share: float  # load on plastic spots over the whole load
    status: ContactStatus  # the worst of all findings
    is_least: bool = False  # the stiffness is the least of a contact with the area A_r, because all spots are plastic


def reduced_modulus(
    first_young_modulus: float, first_poisson_ratio: float, second_young_modulus: float, second_poisson_ratio: float
) -> float:
    """E* = [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]^-1 in Pa. Raises InputError for values out of range.

    Source: H. Hertz (1882); K. L. Johnson, Contact Mechanics (1985), chapter 4.
    """
    compliance = 0.0
    for number, modulus, ratio in (
        ("first", first_young_modulus, first_poisson_ratio),
        ("second", second_young_modulus, second_poisson_ratio),
    ):
        modulus = positive_number(f"{number}_young_modulus", modulus, "Pa")
        ratio = real_number(f"{number}_poisson_ratio", ratio)
        require_poisson_ratio(f"{number}_poisson_ratio", ratio)
        compliance += (1.0 - ratio**2) / modulus
    return 1.0 / compliance


def fractal_contact(
    roughness: Roughness, load: float, mode: StiffnessMode = "consistent", area: float | None = None
) -> ContactStiffness:
    """The fractal contact of a face under ``load`` (N), with its stiffness (N/m); all zero for a load <= 0.

    The stiffness is that of :func:`published_contact`, except for a face whose spots are all plastic, where the
    published sums are zero: plastic spots respond elastically to a small oscillation, and no contact of the real area
    A_r is softer than one round spot of it,
        K_n = 2 E* sqrt(A_r/pi),   K_t = K_n 2(1-nu)/(2-nu).
    Its message says so. Where the first elastic spots begin, K_n therefore falls to the published sum, which begins at
    zero there (docs/theory_roughness.md, section 4).

    ``area`` in m2, the nominal one, is optional, for comparison with the real area. Raises InputError for values that
    are not usable.
    """
    found = published_contact(roughness, load, mode, area)
    if mode == "unloading" or found.status is not ContactStatus.FULLY_PLASTIC:
        return found
    normal = one_spot_stiffness(roughness, found.real_area)
    message = (
        f"{found.messages[0]} The stiffness, {normal:.3g} N/m, is that of one round spot of the real area, "
        "2 E* sqrt(A_r/pi): plastic spots respond elastically to a small oscillation, and no contact of this area is "
        'softer, but it can be stiffer. law = "persson" and mode = "unloading" compute it from the waves.'
    )
    return replace(
        found,
        normal=normal,
        tangential=tangential_ratio("mindlin", roughness.poisson_ratio) * normal,
        messages=(message, *found.messages[1:]),
        is_least=True,
    )


def one_spot_stiffness(roughness: Roughness, area: float) -> float:
    """K_n = 2 E* sqrt(A/pi) in N/m of one round spot of ``area`` (m2): no contact of this area is softer.

    Of all contacts with one area the round one has the least capacity, to which the stiffness of a small oscillation is
    proportional (G. Polya, G. Szego, Isoperimetric Inequalities in Mathematical Physics, Princeton 1951).
    """
    return 2.0 * roughness.reduced_modulus * sqrt(area / pi)


def published_contact(
    roughness: Roughness, load: float, mode: StiffnessMode = "consistent", area: float | None = None
) -> ContactStiffness:
    """The spots of a face and the stiffness (N/m) that the published sums give them; see :func:`fractal_contact`.

    consistent: K_n is the sum of dF/ddelta = 2 E* r over the elastic spots alone, at fixed curvature (Hertz),
        K_n = sqrt(2/pi) E* b,   b = psi^((2-d)/2) d/(d-1) [a_l'^(d/2) a_c'^((1-d)/2) - a_l'^(1/2)],   d = D - 1.
    varying-curvature: K_n is the sum of (dF_e/dr') / (ddelta/dr') along the family of spots, whose curvature varies
        with their size: the above times 2(3-d) / (3(2-d)). No single spot has this stiffness.
    unloading: plastic spots respond elastically to small oscillation too, 2 E* sqrt(a'/pi) each. It needs a smallest
        spot, a_s' = pi (Ls/2)^2 with Ls = roughness.shortest_length, which then also bounds load and area from below.
    K_t = K_n(fixed curvature) 2(1-nu)/(2-nu) (Mindlin, equal materials) in all modes.
    Derivation and sources: docs/theory_roughness.md, sections 2 to 4.

    A pressed face whose spots are all plastic has zero stiffness in the first two modes. Raises InputError for values
    that are not usable.
    """
    require_choice("mode", mode, get_args(StiffnessMode))
    load = real_number("load", load)
    if area is not None:
        area = positive_number("area", area, "m2")
    log_smallest = _log_smallest_area(roughness, mode)
    critical_area = exp(log_critical_area(roughness))
    if load <= 0:
        message = f"The load is {load:g} N: the face is not pressed, so it has no contact stiffness."
        return ContactStiffness(0.0, 0.0, (message,), critical_area, 0.0, 0.0, 0.0, ContactStatus.NO_CONTACT)
    spots = spots_under_load(roughness, load, log_smallest)
    normal, tangential = _spot_stiffness(spots, mode)
    findings = sorted(_findings(spots, load, mode, area), key=lambda finding: WORST_FIRST.index(finding[0]))
    return ContactStiffness(
        normal=normal,
        tangential=tangential,
        messages=tuple(message for _, message in findings),
        critical_area=critical_area,
        largest_area=exp(spots.log_largest),
        real_area=spots.real_area,
        plastic_load_share=spots.plastic_load / spots.load,
        status=findings[0][0] if findings else ContactStatus.VALID,
    )


def _log_smallest_area(roughness: Roughness, mode: StiffnessMode) -> float:
    """ln a_s' for the mode: no lower end except in "unloading", whose sum over plastic spots would diverge."""
    if mode != "unloading":
        return -inf
    if roughness.shortest_length is None:
        raise InputError(
            'mode "unloading" requires roughness.shortest_length (m), which sets the smallest contact spot, a_s\' = '
            "pi (Ls/2)^2; without it the stiffness of the plastic spots has no bound. Give the shortest wave of the "
            "surface, for example 1e-6 m.",
            arguments=["mode"],
        )
    return _log_disc(roughness.shortest_length)


def _log_disc(diameter: float) -> float:
    return log(pi) + 2.0 * log(0.5 * diameter)


def _spot_stiffness(spots: SpotPopulation, mode: StiffnessMode) -> tuple[float, float]:
    """K_n and K_t in N/m of a population of spots."""
    roughness, d = spots.roughness, spots.roughness.profile_dimension
    exponent = 0.5 * (1.0 - d)
    fixed_curvature = sqrt(2.0 / pi) * roughness.reduced_modulus * spots.elastic_moment(exponent)
    if mode == "unloading":
        fixed_curvature += 2.0 / sqrt(pi) * roughness.reduced_modulus * spots.plastic_moment(exponent)
    along_family = 2.0 * (3.0 - d) / (3.0 * (2.0 - d)) if mode == "varying-curvature" else 1.0
    return along_family * fixed_curvature, tangential_ratio("mindlin", roughness.poisson_ratio) * fixed_curvature


def _findings(spots: SpotPopulation, load: float, mode: StiffnessMode, area: float | None) -> Iterator[Finding]:
    """Every regime in which the contact law is not reliable."""
    yield from _plasticity_findings(spots, load, mode)
    if area is not None:
        yield from _area_findings(spots, area)
    yield from _wave_findings(spots.roughness)
    slope, dimension = _asperity_slope(spots), spots.roughness.fractal_dimension
    if slope > LARGEST_ASPERITY_SLOPE:
        yield (
            ContactStatus.STEEP_ASPERITIES,
            f"Spots whose interference is {slope:.2g} of their radius or more (Hertz: at most "
            f"{LARGEST_ASPERITY_SLOPE:g}) carry half of the load: small strain is only an approximation there. A "
            "smaller G reduces the ratio; it is smallest for a D between 2.4 and 2.7.",
        )
    if min(dimension - 2.0, 3.0 - dimension) < NEAR_LIMIT:
        yield (
            ContactStatus.DIMENSION_NEAR_LIMIT,
            f"D = {dimension:g} is within {NEAR_LIMIT:g} of its limit {round(dimension)}, where the law has the "
            "factors 2/(D-2) and 1/(3-D): small changes of D, H or E* change the stiffness by orders of magnitude.",
        )


def _plasticity_findings(spots: SpotPopulation, load: float, mode: StiffnessMode) -> Iterator[Finding]:
    log_critical, shortest = log_critical_area(spots.roughness), spots.roughness.shortest_length
    if spots.log_largest <= log_critical:
        if mode != "unloading":
            enough, finer = elastic_limits(spots.roughness, load)
            consequence = (
                f"Elastic spots require a load above {enough} N, or G below {finer} m. If G is from a publication, "
                "check its unit: m and mm differ by a factor of 1000."
            )
        else:
            consequence = "Only plastic spots in unloading give stiffness, and the shortest wave determines it."
        yield (
            ContactStatus.FULLY_PLASTIC,
            f"Fully plastic: under {load:g} N the largest contact spot, {exp(spots.log_largest):.3g} m2, is not above "
            f"the critical area, {exp(log_critical):.3g} m2, so no spot is elastic. {consequence}",
        )
    if shortest is not None and _log_disc(shortest) >= log_critical:
        yield (
            ContactStatus.NO_PLASTIC_SPOTS,
            f"The smallest spot of the surface, pi (Ls/2)^2 = {exp(_log_disc(shortest)):.3g} m2 with Ls = {shortest:g} "
            f"m, is not below the critical area, {exp(log_critical):.3g} m2: no spot is plastic, and the stiffness "
            'depends on the shortest wave. Mode "unloading" truncates the spots there; the other modes include smaller '
            "ones.",
        )


def _area_findings(spots: SpotPopulation, area: float) -> Iterator[Finding]:
    share, largest = spots.real_area / area, exp(spots.log_largest)
    if share > 1.0:
        yield (
            ContactStatus.REAL_AREA_ABOVE_NOMINAL,
            f"The real contact area, {spots.real_area:.3g} m2, is above the nominal area, {area:.3g} m2: this "
            "load is beyond the contact law.",
        )
    elif share > LARGEST_AREA_RATIO:
        yield (
            ContactStatus.LARGE_REAL_AREA,
            f"The real contact area is {100 * share:.3g} % of the nominal area; above {100 * LARGEST_AREA_RATIO:g} % "
            "neighbouring spots merge, which the contact law neglects.",
        )
    if largest > area:
        yield (
            ContactStatus.LARGEST_AREA_ABOVE_NOMINAL,
            f"The largest contact spot, {largest:.3g} m2, does not fit on the nominal area, {area:.3g} m2.",
        )


def _wave_findings(roughness: Roughness) -> Iterator[Finding]:
    longest, shortest, scale = roughness.sample_length, roughness.shortest_length, roughness.fractal_roughness
    if shortest is None:
        return
    if shortest <= scale:
        yield (
            ContactStatus.SHORTEST_WAVE_BELOW_ROUGHNESS,
            f"The shortest wave, {shortest:g} m, is not above the fractal roughness, G = {scale:g} m: waves shorter "
            "than G are steeper than 1. Give a longer shortest_length, or check the unit of G.",
        )
    if longest is None:
        return
    slope = surface_statistics(roughness, longest, shortest).sdq
    if slope > 1.0:
        yield (
            ContactStatus.STEEP_SURFACE,
            f"The root mean square slope of the surface is Sdq = {slope:.3g}; above 1 it is not a machined face, and a "
            "contact law for small slopes is not valid. A smaller G or a larger D makes a smoother face.",
        )


def _asperity_slope(spots: SpotPopulation) -> float:
    """delta / r' = 2 G^(d-1) sqrt(ln gamma) 2^(2-d) r'^(1-d) of the spot that halves the load."""
    roughness, d = spots.roughness, spots.roughness.profile_dimension
    log_radius = 0.5 * (spots.log_median_area - log(pi))
    waves = sqrt(log(roughness.frequency_ratio)) * 2.0 ** (3.0 - d)
    log_slope = log(waves) + (d - 1.0) * (log(roughness.fractal_roughness) - log_radius)
    # As D approaches 3 half of the load moves to spots smaller than the smallest floating-point number.
    return exp(log_slope) if log_slope < LOG_LARGEST_NUMBER else inf


def elastic_limits(roughness: Roughness, load: float) -> tuple[str, str]:
    """The load in N above which a face has elastic spots, and the G in m below which it has them under ``load`` (N)."""
    needed = fully_plastic_load(roughness)
    finer = roughness.fractal_roughness * sqrt(load / needed)
    return _rounded(needed, 4, ROUND_CEILING), _rounded(finer, 3, ROUND_FLOOR)


def _rounded(value: float, digits: int, direction: str) -> str:
    """``value`` with ``digits`` significant digits, rounded in one direction, so that the text still satisfies a
    bound."""
    return f"{float(Context(prec=digits, rounding=direction).create_decimal(value)):g}"
