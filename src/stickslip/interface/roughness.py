"""The roughness of a joint and the material constants that turn it into contact: ``Roughness``."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

from scipy.optimize import brentq

from stickslip.errors import InputError
from stickslip.validation import finite_array, require_positive

_ADVICE = {
    "fractal_roughness": "G is a length in metres, for example 1e-8.",
    "hardness": "The hardness of the softer body is a pressure in Pa, 2e9 to 4e9 for steels and nickel alloys.",
    "reduced_modulus": "It is a pressure in Pa; reduced_modulus(...) computes it from the two bodies.",
    "sample_length": "The sample length L is the longest wavelength of the face, in metres.",
    "shortest_length": "The shortest length Ls is the cut-off wavelength, in metres.",
}


def checked_number(name: str, value: Any) -> float:
    """Return ``value`` as a float; raises InputError unless it is one finite number."""
    array = finite_array(name, value)
    if array.ndim:
        raise InputError(f"{name} must be one number, but an array of shape {array.shape} was given.")
    return float(array)


def positive_number(name: str, value: Any, advice: str) -> float:
    """Return ``value`` as a float above zero; raises InputError otherwise, the sentence ending with ``advice``."""
    number = checked_number(name, value)
    require_positive(name, finite_array(name, number), advice)
    return number


def check_dimension(value: Any) -> float:
    """Return the fractal dimension D of a SURFACE, 2 < D < 3; raises InputError otherwise."""
    dimension = checked_number("fractal_dimension", value)
    if not 2.0 < dimension < 3.0:
        hint = (
            f" If {dimension:g} is the dimension d of a profile, the surface has D = d + 1 = {dimension + 1.0:g}."
            if 1.0 < dimension < 2.0
            else " Measured faces lie between 2.2 and 2.6."
        )
        raise InputError(
            f"fractal_dimension is {dimension:g}, but the dimension of a surface must lie between 2 and 3 "
            f"(both excluded).{hint}"
        )
    return dimension


def check_ratio(name: str, value: Any) -> float:
    """Return a frequency ratio gamma > 1; raises InputError otherwise."""
    ratio = checked_number(name, value)
    if ratio <= 1.0:
        raise InputError(f"{name} is {ratio:g}, but successive frequencies must grow: take a value above 1, usually 1.5.")
    return ratio


def check_lengths(sample_length: Any, shortest_length: Any) -> tuple[float, float]:
    """Return (L, Ls) with L > Ls > 0, both in metres; raises InputError otherwise."""
    longest = positive_number("sample_length", sample_length, _ADVICE["sample_length"])
    shortest = positive_number("shortest_length", shortest_length, _ADVICE["shortest_length"])
    if shortest >= longest:
        raise InputError(
            f"shortest_length is {shortest:g} m, but it must be below sample_length = {longest:g} m. "
            "Look whether the two were exchanged or one was given in another unit."
        )
    return longest, shortest


@dataclass(frozen=True)
class Roughness:
    """Fractal roughness of a joint (both faces lumped into one) with the constants of its asperities.

    Parameters
    ----------
    fractal_dimension:
        D of the SURFACE, 2 < D < 3. It sets the share of short wavelengths (Hurst exponent 3 - D). At fixed G a larger
        D lowers the height and stiffens the contact.
    fractal_roughness:
        G in metres, > 0: the amplitude scale. A larger G is a higher, rougher and softer face.
    hardness:
        H in Pa, > 0, of the softer body: the mean pressure of a plastic spot.
    reduced_modulus:
        E* in Pa, > 0, ``1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2``; see :func:`reduced_modulus`.
    poisson_ratio:
        -1 < nu <= 0.5, the same for both bodies; it sets K_t / K_n = 2 (1 - nu) / (2 - nu).
    domain_extension:
        psi >= 1 of the size distribution; 1 is the paper's choice, see :func:`domain_extension_factor`.
    frequency_ratio:
        gamma > 1 between successive frequencies of the surface.
    sample_length, shortest_length:
        L and Ls in metres, L > Ls > 0. Optional: with both, the height and slope of the face are checked. Ls also sets
        the smallest spot ``pi (Ls / 2)^2``, which the mode "unloading" of the contact stiffness needs.

    Raises
    ------
    InputError
        for a value outside its range, with the name, what was found and what is allowed.
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
        check_dimension(self.fractal_dimension)
        for name in ("fractal_roughness", "hardness", "reduced_modulus"):
            positive_number(name, getattr(self, name), _ADVICE[name])
        poisson_ratio = checked_number("poisson_ratio", self.poisson_ratio)
        if not -1.0 < poisson_ratio <= 0.5:
            raise InputError(
                f"poisson_ratio is {poisson_ratio:g}, but an elastic solid has -1 < nu <= 0.5; metals lie near 0.3."
            )
        if checked_number("domain_extension", self.domain_extension) < 1.0:
            raise InputError(
                f"domain_extension is {self.domain_extension:g}, but psi must be at least 1. "
                "Take 1, or the value of domain_extension_factor(fractal_dimension)."
            )
        check_ratio("frequency_ratio", self.frequency_ratio)
        if self.sample_length is not None and self.shortest_length is not None:
            check_lengths(self.sample_length, self.shortest_length)
        else:
            for name in ("sample_length", "shortest_length"):
                if getattr(self, name) is not None:
                    positive_number(name, getattr(self, name), _ADVICE[name])
        for field in fields(self):
            if getattr(self, field.name) is not None:
                object.__setattr__(self, field.name, float(getattr(self, field.name)))

    @property
    def profile_dimension(self) -> float:
        """d = D - 1 of a profile of the surface, 1 < d < 2: the exponent that the asperity equations need."""
        return self.fractal_dimension - 1.0

    @property
    def smallest_area(self) -> float:
        """a_s' = pi (Ls / 2)^2 in m2, the area of the smallest spot; 0 where no shortest length is given."""
        return 0.0 if self.shortest_length is None else math.pi * (0.5 * self.shortest_length) ** 2

    @property
    def stiffness_ratio(self) -> float:
        """K_t / K_n = 2 (1 - nu) / (2 - nu) of a circular spot between like materials (Mindlin)."""
        return 2.0 * (1.0 - self.poisson_ratio) / (2.0 - self.poisson_ratio)


def reduced_modulus(young_1: float, poisson_1: float, young_2: float, poisson_2: float) -> float:
    """Reduced modulus E* in Pa of two elastic bodies, ``1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2`` (eq 4).

    Raises InputError unless the moduli (Pa) are positive and -1 < nu <= 0.5.
    """
    compliance = 0.0
    for body, young, poisson in (("1", young_1, poisson_1), ("2", young_2, poisson_2)):
        modulus = positive_number(f"young_{body}", young, "Young's modulus is a pressure in Pa.")
        ratio = checked_number(f"poisson_{body}", poisson)
        if not -1.0 < ratio <= 0.5:
            raise InputError(f"poisson_{body} is {ratio:g}, but an elastic solid has -1 < nu <= 0.5.")
        compliance += (1.0 - ratio**2) / modulus
    return 1.0 / compliance


def domain_extension_factor(fractal_dimension: float) -> float:
    """Domain extension factor psi(D) of Wang and Komvopoulos.

    Root of ``psi^((2 - d) / 2) - (1 + psi^(-d / 2))^(-(2 - d) / d) = (2 - d) / d`` with d = D - 1. It corrects the size
    distribution for the islands that a truncation plane cuts; the paper leaves it at 1.
    """
    profile = check_dimension(fractal_dimension) - 1.0
    power = (2.0 - profile) / profile

    def residual(log_psi: float) -> float:
        lakes = (1.0 + math.exp(-0.5 * profile * log_psi)) ** (-power)
        return math.exp(0.5 * (2.0 - profile) * log_psi) - lakes - power

    # psi falls from 2.62 at d = 1 to 1.71 at d = 2, so the bracket holds for every admissible D.
    return math.exp(float(brentq(residual, 0.0, math.log(10.0), xtol=1e-15)))
