"""Laws of independent Hertzian summits from the moments of the spectrum: Greenwood-Williamson and Bush-Gibson-Thomas.

Summits are springs side by side, without the coupling by the body that they share. The laws are for comparison.
Derivation and comparison with boundary elements: docs/theory_stiffness_laws.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import ClassVar

import numpy as np

from stickslip.contact.stiffness.height_spectrum import HeightSpectrum
from stickslip.contact.stiffness.tangential import TangentialRatio, tangential_ratio
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, positive_number

# Separations of the table in root mean square heights: the tail of a normal distribution beyond has no points.
SEPARATION = np.linspace(8.0, -3.0, 221)
GAUSS_POINTS = 40  # of each integral over curvature; 80 change the stiffness by less than 0.1 %


@dataclass(frozen=True)
class SummitStiffness(ABC):
    """Normal load and stiffness per area as functions of the separation, for summits that Hertz describes.

    Parameters
    ----------
    spectrum:
        waves of the surface.
    reduced_modulus, poisson_ratio:
        E* in Pa; nu of both faces.
    tangential_law:
        ratio of tangential to normal stiffness, see :func:`tangential_ratio`.

    Raises
    ------
    InputError
        for a value out of range, and a spectrum of a single scale (Nayak's alpha of 1.5 or less), which has no
        distribution of summits.
    """

    spectrum: HeightSpectrum
    reduced_modulus: float
    poisson_ratio: float
    tangential_law: TangentialRatio = "mindlin"

    name: ClassVar[str]

    def __post_init__(self) -> None:
        object.__setattr__(self, "reduced_modulus", positive_number("reduced_modulus", self.reduced_modulus, "Pa"))
        tangential_ratio(self.tangential_law, self.poisson_ratio)
        if self.bandwidth <= 1.5:
            raise InputError(
                f"the waves of the surface are of one length only (alpha = {self.bandwidth:.3g}, above 1.5 is needed), "
                "so it has no distribution of summits. Give a shorter shortest wave.",
                arguments=["spectrum"],
            )

    @property
    def bandwidth(self) -> float:
        """Nayak's alpha = m0 m4 / m2^2."""
        height, slope, curvature = self.spectrum.profile_moments
        return height * curvature / slope**2

    @abstractmethod
    def at_separation(self, separation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pressure (Pa) and normal stiffness (N/m3), (k,) each, at distances (k,) m of the flat from the mean plane."""

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        pressures, stiffness = self._table
        at = np.log(np.asarray(pressure, dtype=float))
        slope = np.gradient(np.log(stiffness), np.log(pressures))
        inside = np.interp(at, np.log(pressures), np.log(stiffness))
        # Beyond the table the last power continues.
        beyond = np.where(at > np.log(pressures[-1]), slope[-1] * (at - np.log(pressures[-1])), 0.0)
        beyond += np.where(at < np.log(pressures[0]), slope[0] * (at - np.log(pressures[0])), 0.0)
        return np.asarray(np.exp(inside + beyond))

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return tangential_ratio(self.tangential_law, self.poisson_ratio) * self.normal(pressure)

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """No message of its own: the comparison with Persson's law covers every pressure."""
        return ()

    def describe(self) -> str:
        """The law in one line."""
        return (
            f"{self.name}, Sq = {self.spectrum.sq:.3g} m, Sdq = {self.spectrum.sdq:.3g}, alpha = {self.bandwidth:.3g}"
        )

    @cached_property
    def _table(self) -> tuple[FloatArray, FloatArray]:
        pressure, stiffness = self.at_separation(self.spectrum.sq * SEPARATION)
        return pressure, stiffness


@dataclass(frozen=True)
class GreenwoodWilliamsonStiffness(SummitStiffness):
    """Summits of one radius with normal heights (Greenwood, Williamson 1966), from the moments by McCool (1986).

    Density ``m4 / (6 pi sqrt(3) m2)``, radius ``(3/8) sqrt(pi / m4)``, variance of the heights
    ``(1 - 0.8968/alpha) m0`` about ``4 sqrt(m0 / (pi alpha))`` above the mean plane (Bush, Gibson, Keogh 1976).
    """

    name: ClassVar[str] = "Greenwood-Williamson"

    def at_separation(self, separation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pressure (Pa) and normal stiffness (N/m3) at distances (k,) in m."""
        height, slope, curvature = self.spectrum.profile_moments
        density, radius = curvature / (6.0 * pi * sqrt(3.0) * slope), 0.375 * sqrt(pi / curvature)
        spread = sqrt((1.0 - 0.8968 / self.bandwidth) * height)
        mean = 4.0 * sqrt(height / (pi * self.bandwidth))
        compression, share = _above(np.asarray(separation, dtype=float), mean, spread)
        stiffness = 2.0 * self.reduced_modulus * sqrt(radius) * np.sqrt(compression)
        pressure = density * (share * stiffness * compression).sum(axis=-1) * 2.0 / 3.0
        return pressure, density * (share * stiffness).sum(axis=-1)


@dataclass(frozen=True)
class BushGibsonThomasStiffness(SummitStiffness):
    """Summits of all heights and both curvatures of an isotropic normal surface (Bush et al., Wear 35 (1975) 87).

    The joint density of height, mean curvature k and difference r of the principal curvatures ``k +- r`` is that of
    Nayak (1971): ``(k^2 - r^2) / (2 pi m2) phi(z, k) 2 r exp(-r^2 / (2 m4/3)) / (2 m4/3)`` over 0 < r < k. Hertz's
    elliptical contact is that of a sphere with the geometric mean of the two curvatures, within 1 to 3 % (J. A.
    Greenwood, Wear 261 (2006) 191).
    """

    name: ClassVar[str] = "Bush-Gibson-Thomas"

    def at_separation(self, separation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pressure (Pa) and normal stiffness (N/m3) at distances (k,) in m."""
        height, slope, curvature = self.spectrum.profile_moments
        spread = sqrt(2.0 * curvature / 3.0)  # of the mean curvature
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        mean_curvature = 4.0 * spread * (nodes + 1.0)  # 0 to 8 standard deviations
        mean_weight = 4.0 * spread * weights * np.exp(-0.5 * (mean_curvature / spread) ** 2) / (spread * sqrt(2.0 * pi))
        # Principal curvatures k + r and k - r with r = k t, 0 < t < 1.
        part, part_weight = 0.5 * (nodes + 1.0), 0.5 * weights
        difference = np.multiply.outer(mean_curvature, part)
        variance = curvature / 3.0
        density = (mean_curvature[:, None] ** 2 - difference**2) / (2.0 * pi * slope)
        density *= difference / variance * np.exp(-(difference**2) / (2.0 * variance))
        density *= mean_curvature[:, None] * part_weight * mean_weight[:, None]
        root_radius = (mean_curvature[:, None] ** 2 - difference**2) ** -0.25  # sqrt of 1 / geometric mean
        by_curvature = (density * root_radius).sum(axis=1)
        # Height of summits of curvature k: normal with mean m2 k / spread^2.
        mean = slope * mean_curvature / spread**2
        rest = sqrt(height - slope**2 / spread**2)
        pressure, stiffness = np.zeros(np.shape(separation)), np.zeros(np.shape(separation))
        for each, share_of_curvature in zip(mean, by_curvature, strict=True):
            compression, share = _above(np.asarray(separation, dtype=float), float(each), rest)
            spring = 2.0 * self.reduced_modulus * np.sqrt(compression)
            pressure += share_of_curvature * (share * spring * compression).sum(axis=-1) * 2.0 / 3.0
            stiffness += share_of_curvature * (share * spring).sum(axis=-1)
        return pressure, stiffness


def _above(separation: FloatArray, mean: float, spread: float) -> tuple[FloatArray, FloatArray]:
    """Compressions (k, n) m of summits with normal heights, and their fractions (k, n), by Gauss quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    low = np.maximum(separation - mean, -8.0 * spread)
    # The tail beyond the flat falls within a few spreads, or within spread^2 / distance far out.
    width = np.minimum(8.0 * spread, np.maximum(8.0 * spread - low, 40.0 * spread**2 / np.maximum(low, spread)))
    width = np.where(low < 0.0, 8.0 * spread - low, width)
    # Steps in the square root of the compression: the integrands have a root of it at the flat.
    root = 0.5 * (nodes + 1.0)
    height = low[:, None] + width[:, None] * root**2
    fraction = width[:, None] * root * weights * np.exp(-0.5 * (height / spread) ** 2) / (spread * sqrt(2.0 * pi))
    return height + mean - separation[:, None], fraction
