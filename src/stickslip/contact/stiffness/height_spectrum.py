"""The spectrum of a rough surface for laws of contact stiffness: the variance of the heights over the wavelengths.

Laws without a population of fractal spots take a surface as independent waves in all directions, so any description of
it serves: D and G, or a measured Sq and Sdq.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.special import j0, j1

from stickslip.contact.stiffness.asperities import Roughness
from stickslip.contact.stiffness.surface import frequency_count, sq
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array, positive_number

STEPS_PER_LOG = 60  # waves in a factor e of the wavelength: twice as many change the laws by less than 0.5 %


@dataclass(frozen=True, eq=False)
class HeightSpectrum:
    """Isotropic surface as independent waves: ``variance`` (k,) m2 of the heights at each ``wavelength`` (k,) m.

    Wavelengths fall. Raises InputError for values that no spectrum has.
    """

    wavelength: FloatArray
    variance: FloatArray

    def __post_init__(self) -> None:
        for name in ("wavelength", "variance"):
            values = finite_array(name, getattr(self, name))
            if values.ndim != 1 or values.size == 0 or not (values > 0.0).all():
                raise InputError(f"{name} must be a list of numbers above 0.", arguments=[name])
            object.__setattr__(self, name, values)
        if self.wavelength.shape != self.variance.shape or not (np.diff(self.wavelength) < 0.0).all():
            raise InputError(
                "wavelength must fall, and variance must have one value for each wavelength.", arguments=["wavelength"]
            )

    @classmethod
    def of_fractal(cls, roughness: Roughness) -> HeightSpectrum:
        """The surface of D and G with waves from ``sample_length`` to ``shortest_length``.

        Each wave of the discrete surface (:func:`stickslip.contact.stiffness.surface.fractal_surface`) is distributed
        over its interval of ``ln lambda``; Sq remains. Raises InputError if one of the two lengths is missing.
        """
        longest, shortest = roughness.sample_length, roughness.shortest_length
        if longest is None or shortest is None:
            raise InputError(
                "this law requires the longest and the shortest wave of the surface. Give sample_length and "
                "shortest_length of the roughness, in m.",
                arguments=["sample_length", "shortest_length"],
            )
        dimension, ratio = roughness.fractal_dimension, roughness.frequency_ratio
        last = longest / ratio ** frequency_count(longest, shortest, ratio)
        height = sq(dimension, roughness.fractal_roughness, longest, shortest, ratio)
        return cls.self_affine(height, dimension, longest * sqrt(ratio), last / sqrt(ratio))

    @classmethod
    def self_affine(cls, sq_height: float, fractal_dimension: float, longest: float, shortest: float) -> HeightSpectrum:
        """Waves of ``longest`` to ``shortest`` m with Sq = ``sq_height``, variance ~ lambda^(2(3-D)) d ln lambda."""
        ends, steps = log(longest / shortest), max(int(STEPS_PER_LOG * log(longest / shortest)), 2)
        wavelength = longest * np.exp(-ends * (np.arange(steps) + 0.5) / steps)
        weight = (wavelength / longest) ** (2.0 * (3.0 - fractal_dimension))
        return cls(wavelength, sq_height**2 * weight / weight.sum())

    def up_to(self, longest: float) -> HeightSpectrum:
        """The waves that are not longer than ``longest`` (m). Raises InputError if there are none."""
        inside = self.wavelength <= positive_number("longest", longest, "m")
        if not inside.any():
            raise InputError(
                f"the longest wave is {longest:g} m, but the surface has only waves from {self.wavelength[-1]:.3g} to "
                f"{self.wavelength[0]:.3g} m.",
                arguments=["longest"],
            )
        return HeightSpectrum(self.wavelength[inside], self.variance[inside])

    @property
    def wave_number(self) -> FloatArray:
        """(k,) 1/m."""
        return np.asarray(2.0 * pi / self.wavelength)

    @property
    def sq(self) -> float:
        """Root mean square height in m."""
        return sqrt(float(self.variance.sum()))

    @property
    def sdq(self) -> float:
        """Root mean square slope."""
        return sqrt(float((self.variance * self.wave_number**2).sum()))

    @property
    def profile_moments(self) -> tuple[float, float, float]:
        """m0 (m2), m2 (1) and m4 (1/m2): variance of height, slope and curvature of a profile (P. R. Nayak, 1971).

        On an isotropic surface the mean squares of cos and cos^2 over the directions give 1/2 and 3/8.
        """
        slope = float((self.variance * self.wave_number**2).sum())
        curvature = float((self.variance * self.wave_number**4).sum())
        return float(self.variance.sum()), 0.5 * slope, 0.375 * curvature

    def summit_drop(self, distance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Root mean square of ``z(p) - [z(p+r) + z(p-r)] / 2`` (m) at distances r (m), and its slope; both (n,).

        The variance is ``S(r) - S(2r)/4`` with the structure function S: it grows with r^(2(3-D)) inside the band of
        waves, and as ``m4 r^4 / 4``, the drop of a parabola, below the shortest wave.
        """
        r = np.asarray(distance, dtype=float)
        phase, q = np.multiply.outer(r, self.wave_number), self.wave_number
        # 1 - J0(x) - [1 - J0(2x)] / 4 is of the order x^4: below x = 0.05 its series keeps the digits.
        exact = 2.0 * (0.75 - j0(phase) + 0.25 * j0(2.0 * phase))
        series = (3.0 / 32.0) * phase**4
        variance = (np.where(phase < 0.05, series, exact) * self.variance).sum(axis=-1)
        exact_slope, series_slope = 2.0 * (j1(phase) - 0.5 * j1(2.0 * phase)), (3.0 / 8.0) * phase**3
        slope = (np.where(phase < 0.05, series_slope, exact_slope) * self.variance * q).sum(axis=-1)
        drop = np.sqrt(variance)
        return drop, np.divide(0.5 * slope, drop, out=np.zeros_like(drop), where=drop > 0.0)
