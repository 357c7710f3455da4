"""Contact stiffness of a rough face by Persson's theory, with one patch at small loads and plastic short waves.

Derivation, constants and comparison with boundary elements: docs/theory_stiffness_laws.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import pi, sqrt

import numpy as np
from scipy.special import erf

from stickslip.contact.stiffness.height_spectrum import HeightSpectrum
from stickslip.contact.stiffness.persson_range import messages
from stickslip.contact.stiffness.tangential import TangentialRatio, tangential_ratio
from stickslip.core.validation import FloatArray, positive_number

# Elastic energy over that of complete contact at small loads: 0.4 to 0.5 in C. Yang, B. N. J. Persson, J. Phys.:
# Condens. Matter 20 (2008) 215214.
ENERGY_REDUCTION = 0.4
# E* Sdq over the mean pressure of the real contact: 1.6 in Persson's theory, 2.2 in boundary elements.
SLOPE_OVER_PRESSURE = 2.0
LARGEST_PATCH = 0.25  # radius over longest wave: beyond a quarter of the wave its summit is no longer convex
SMALLEST_EXPONENT = -300.0  # the square of exp(300) is still a number of double precision
HERTZ_END = 1e-6  # radius of the first point of the table over that of the second: no load is below it
ANGLES = (np.arange(200) + 0.5) * (0.5 * pi / 200)


@dataclass(frozen=True)
class PerssonStiffness:
    """Stiffness for a small oscillation about the load, per area: many patches of contact and a single one together.

    Many patches (Persson, Phys. Rev. Lett. 99 (2007) 125502; Yang and Persson 2008), with the waves i = 1 ... k of
    variance v_i and wave number q_i from the longest on, ``s_i^2`` half the square of the slope of the waves up to i:

        1 / kappa = (1/p) sum v_i q_i / (2 sqrt(pi) s_i) [g + 3 (1-g) erf(p / (E* s_i))^2] exp(-(p / (E* s_i))^2)

    For small pressures it is ``kappa = p / (c Sq)``; it grows without bound as the contact becomes complete.
    Single patch (Pastewka et al., Phys. Rev. E 87 (2013) 062809): the highest summit alone carries F = p A,
    ``kappa = 2 E* a(F) / A``, with the radius a of the contact of a smooth punch with the mean shape of the summit.
    Plasticity: the mean pressure of the real contact is ``E* Sdq / 2``, which grows with each shorter wave. From the
    wave at which it reaches H, plastic flow flattens the waves of the many patches. A single patch has the area F / H
    in addition. The stiffness is that of small oscillation, so plastic contacts respond elastically.

    Parameters
    ----------
    spectrum:
        waves of the surface that the mesh does not carry.
    reduced_modulus, poisson_ratio:
        E* in Pa; nu of both faces.
    area:
        of the face, m2.
    hardness:
        H in Pa of the softer face; None for an elastic contact.
    tangential_law:
        ratio of tangential to normal stiffness, see :func:`tangential_ratio`.

    Raises
    ------
    InputError
        for a value out of range.
    """

    spectrum: HeightSpectrum
    reduced_modulus: float
    poisson_ratio: float
    area: float
    hardness: float | None = None
    tangential_law: TangentialRatio = "mindlin"

    def __post_init__(self) -> None:
        for name, unit in (("reduced_modulus", "Pa"), ("area", "m2")):
            object.__setattr__(self, name, positive_number(name, getattr(self, name), unit))
        if self.hardness is not None:
            object.__setattr__(self, "hardness", positive_number("hardness", self.hardness, "Pa"))
        tangential_ratio(self.tangential_law, self.poisson_ratio)

    def normal(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        many, single = self.many_patches(pressure), self.single_patch(pressure)
        # The exponent 2 of this mean was chosen on the set "fit" of the boundary elements.
        return np.asarray(np.hypot(many, single))

    def tangential(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa."""
        return tangential_ratio(self.tangential_law, self.poisson_ratio) * self.normal(pressure)

    def many_patches(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa: Persson's theory of a face without end."""
        p = np.asarray(pressure, dtype=float)[..., None]
        waves, slope = self.elastic_waves, self._partial_slope
        reach = p / (self.reduced_modulus * slope)
        energy = ENERGY_REDUCTION + 3.0 * (1.0 - ENERGY_REDUCTION) * erf(reach) ** 2
        height = waves.variance * waves.wave_number / (2.0 * sqrt(pi) * slope)
        compliance = height * energy * np.exp(np.maximum(-(reach**2), SMALLEST_EXPONENT))
        return np.asarray(p[..., 0] / compliance.sum(axis=-1))

    def single_patch(self, pressure: FloatArray) -> FloatArray:
        """(k,) N/m3 at pressures (k,) in Pa: one patch about the highest summit carries the load of the face."""
        load = np.asarray(pressure, dtype=float) * self.area
        radius, scaled = _summit_punch(self.spectrum)
        elastic = np.exp(np.interp(np.log(load / self.reduced_modulus), np.log(scaled), np.log(radius)))
        plastic = 0.0 if self.hardness is None else np.sqrt(load / (pi * self.hardness))
        return np.asarray(2.0 * self.reduced_modulus * np.hypot(elastic, plastic) / self.area)

    def contact_fraction(self, pressure: FloatArray) -> FloatArray:
        """(k,) real over nominal area at pressures (k,) in Pa, ``erf(sqrt(2) p / (E* Sdq))`` of the elastic waves."""
        slope = self.reduced_modulus * self.elastic_waves.sdq
        return np.asarray(erf(sqrt(2.0) * np.asarray(pressure, dtype=float) / slope))

    def valid(self, pressure: FloatArray) -> tuple[str, ...]:
        """Messages on pressures outside the range in which boundary elements confirm the law, worst first."""
        highest = float(np.max(pressure))
        fraction = float(self.contact_fraction(np.array([highest]))[0])
        return tuple(messages(highest, fraction, self.elastic_waves.sdq, self.hardness))

    def describe(self) -> str:
        """The law in one line."""
        waves = self.spectrum
        return (
            f"Persson, Sq = {waves.sq:.3g} m, Sdq = {waves.sdq:.3g}, waves from {waves.wavelength[-1]:.3g} to "
            f"{waves.wavelength[0]:.3g} m, {1e6 * self.area:.4g} mm2"
        )

    @cached_property
    def elastic_waves(self) -> HeightSpectrum:
        """The waves that the load does not flatten: from the longest on, up to ``E* Sdq = 2 H``."""
        if self.hardness is None:
            return self.spectrum
        waves = self.spectrum
        square = waves.variance * waves.wave_number**2
        before = np.append(0.0, np.cumsum(square)[:-1])
        limit = (SLOPE_OVER_PRESSURE * self.hardness / self.reduced_modulus) ** 2
        # The wave at the limit counts with the fraction of its variance below it.
        fraction = np.clip((limit - before) / square, 0.0, 1.0)
        elastic = fraction > 0.0
        return HeightSpectrum(waves.wavelength[elastic], (fraction * waves.variance)[elastic])

    @cached_property
    def _partial_slope(self) -> FloatArray:
        """(k,) s_i: root mean square slope of the waves up to wave i, over sqrt(2).

        Within a wave the square of s rises evenly from its start to its end, so the mean of 1/s is 2 / (start + end).
        """
        waves = self.elastic_waves
        square = 0.5 * waves.variance * waves.wave_number**2
        end = np.sqrt(np.cumsum(square))
        return np.asarray(0.5 * (end + np.append(0.0, end[:-1])))


@lru_cache(maxsize=64)  # half of the time of a rough face, and faces that share a roughness share its spectrum
def _summit_punch(waves: HeightSpectrum) -> tuple[FloatArray, FloatArray]:
    """Radii a (n,) m and loads over the modulus (n,) m2 of a smooth axisymmetric punch of the shape f of a summit.

    ``F / E* = 2 integral of r^2 f'(r) / sqrt(a^2 - r^2) dr`` from 0 to a (I. N. Sneddon, 1965).
    """
    distance = np.geomspace(waves.wavelength[-1] / 100.0, waves.wavelength[0], 400)
    slope = np.maximum(waves.summit_drop(distance)[1], 0.0)
    radius = np.geomspace(distance[0], LARGEST_PATCH * waves.wavelength[0], 200)
    along = radius[:, None] * np.sin(ANGLES)
    slope_along = np.interp(along, distance, slope)
    in_parabola = along < distance[0]
    slope_along[in_parabola] = slope[0] * along[in_parabola] / distance[0]
    load = pi * radius**2 * (np.sin(ANGLES) ** 2 * slope_along).mean(axis=1)
    # Below the shortest wave the summit is a parabola, F ~ a^3 (Hertz): one point far below continues the table.
    rising = np.maximum.accumulate(load)
    return np.append(HERTZ_END * radius[0], radius), np.append(HERTZ_END**3 * load[0], rising)
