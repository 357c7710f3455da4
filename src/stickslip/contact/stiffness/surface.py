"""Weierstrass-Mandelbrot rough surface: heights, statistics and structure function.

z(x, y) = A sum_{m=1..M} sum_{n=0..n_max} gamma^((D-3)n) { cos phi_mn - cos[k_n e_m.(x, y) + phi_mn] }
with the directions e_m = (cos(pi m/M), sin(pi m/M)), k_n = 2 pi gamma^n / L and A = L (G/L)^(D-2) sqrt(ln gamma / M).
Source: Ausloos and Berry (1985), in the form of Yan and Komvopoulos (1998); D is the dimension of the surface. Some
publications print sqrt(x^2+y^2) cos(atan(y/x) - pi m/M) in place of the dot product, which is wrong for x < 0. See
docs/theory_roughness.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1, floor, gamma, log, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.stiffness.asperities import Roughness, require_surface_dimension
from stickslip.core.compiled import njit
from stickslip.core.errors import InputError
from stickslip.core.validation import (
    FloatArray,
    finite_array,
    positive_number,
    real_number,
    require_allowed,
    whole_number,
)


def fractal_surface(
    x: ArrayLike,
    y: ArrayLike,
    fractal_dimension: float,
    fractal_roughness: float,
    length: float,
    ridges: int,
    phases: ArrayLike,
    ratio: float = 1.5,
) -> FloatArray:
    """Heights in m at the points ``x``, ``y`` (m, same shape); the height at (0, 0) is exactly 0.

    ``fractal_dimension`` D, 2 < D < 3; ``fractal_roughness`` G in m; ``length`` L in m, the longest wave; ``ridges`` M
    directions; ``phases`` (ridges, n_max + 1) in rad, see ``draw_phases``; ``ratio`` gamma of successive wave numbers.
    The sum of each point has a fixed order, so its height does not depend on the other points of the call. Raises
    InputError for shapes that do not match or values out of range.
    """
    check_surface(fractal_dimension, fractal_roughness, length, ratio)
    whole_number("ridges", ridges, 1)
    x_points, y_points, angles = finite_array("x", x), finite_array("y", y), finite_array("phases", phases)
    if x_points.shape != y_points.shape:
        raise InputError(
            f"x and y must have the same shape, but they have {x_points.shape} and {y_points.shape}.",
            arguments=["x", "y"],
        )
    if angles.ndim != 2 or angles.shape[0] != ridges or angles.shape[1] == 0:
        raise InputError(
            f"phases must have the shape (ridges, n_max + 1) = ({ridges}, ...), but it has {angles.shape}; "
            "draw_phases(seed, ridges, n_max) makes them.",
            arguments=["phases"],
        )
    direction = pi * np.arange(1, ridges + 1) / ridges
    growth = np.asarray(float(ratio) ** np.arange(angles.shape[1]), dtype=float)
    wave_number = 2.0 * pi / length * growth
    amplitude = length * (fractal_roughness / length) ** (fractal_dimension - 2.0) * np.sqrt(log(ratio) / ridges)
    weight = amplitude * growth ** (fractal_dimension - 3.0)
    heights = _heights(
        x_points.ravel(), y_points.ravel(), np.cos(direction), np.sin(direction), wave_number, weight, angles
    )
    return np.asarray(heights.reshape(x_points.shape))


@njit(cache=True, nogil=True)
def _heights(
    x: FloatArray,
    y: FloatArray,
    cosine: FloatArray,
    sine: FloatArray,
    wave_number: FloatArray,
    weight: FloatArray,
    phases: FloatArray,
) -> FloatArray:
    """Sum of the waves, one point after the other (array functions may round differently at the end of an array)."""
    heights = np.zeros(x.size)
    for point in range(x.size):
        total = 0.0
        for m in range(cosine.size):
            distance = x[point] * cosine[m] + y[point] * sine[m]
            for n in range(wave_number.size):
                phase = phases[m, n]
                total += weight[n] * (np.cos(phase) - np.cos(wave_number[n] * distance + phase))
        heights[point] = total
    return heights


def draw_phases(seed: int, ridges: int, n_max: int) -> FloatArray:
    """Independent phases (ridges, n_max + 1) in rad, uniform over [0, 2 pi); the same seed gives the same phases."""
    whole_number("seed", seed, 0)
    whole_number("ridges", ridges, 1)
    whole_number("n_max", n_max, 0)
    return np.random.default_rng(seed).uniform(0.0, 2.0 * pi, (ridges, n_max + 1))


def frequency_count(length: float, shortest_length: float, ratio: float = 1.5) -> int:
    """n_max = int[ln(L / Ls) / ln gamma]: each ridge has the n_max + 1 waves L, L/gamma ... down to Ls.

    Raises InputError unless L > Ls > 0 and gamma > 1.
    """
    ratio, length = real_number("frequency ratio", ratio), real_number("length", length)
    shortest_length = positive_number("shortest_length", shortest_length, "m")
    require_allowed("frequency ratio", ratio, ratio > 1, "above 1")
    require_allowed("length", length, length > shortest_length, f"above the shortest length, {shortest_length:g} m")
    # L / Ls is often a whole power of gamma in tests and tables; round-off must not drop that last wave.
    return floor(log(length / shortest_length) / log(ratio) + 1e-9)


def sq(
    fractal_dimension: float, fractal_roughness: float, length: float, shortest_length: float, ratio: float = 1.5
) -> float:
    """Root mean square height Sq in m (ISO 25178), mean over random phases, mean height removed.

    Sq^2 = (L^2/2) (G/L)^(2(D-2)) ln gamma (1 - q^(n_max+1)) / (1 - q), q = gamma^(2(D-3)).
    """
    check_surface(fractal_dimension, fractal_roughness, length, ratio)
    n_max = frequency_count(length, shortest_length, ratio)
    series = _geometric_sum(2.0 * (fractal_dimension - 3.0) * log(ratio), n_max + 1)
    return float(
        length * (fractal_roughness / length) ** (fractal_dimension - 2.0) * np.sqrt(0.5 * log(ratio) * series)
    )


def sdq(
    fractal_dimension: float, fractal_roughness: float, length: float, shortest_length: float, ratio: float = 1.5
) -> float:
    """Root mean square slope Sdq = rms |grad z| (ISO 25178), mean over random phases.

    Sdq^2 = (2 pi)^2 (G/L)^(2(D-2)) (ln gamma / 2) (Q^(n_max+1) - 1) / (Q - 1), Q = gamma^(2(D-2)).
    """
    check_surface(fractal_dimension, fractal_roughness, length, ratio)
    n_max = frequency_count(length, shortest_length, ratio)
    series = _geometric_sum(2.0 * (fractal_dimension - 2.0) * log(ratio), n_max + 1)
    slope = (fractal_roughness / length) ** (fractal_dimension - 2.0) * np.sqrt(0.5 * log(ratio) * series)
    return float(2.0 * pi * slope)


def structure_function(
    distance: ArrayLike,
    direction: float,
    fractal_dimension: float,
    fractal_roughness: float,
    length: float,
    ridges: int,
    n_max: int,
    ratio: float = 1.5,
) -> FloatArray:
    """S = mean of (z(p + tau) - z(p))^2 in m2 over random phases, exact for the finite set of waves.

    S = L^2 (G/L)^(2(D-2)) ln gamma sum_n gamma^(2(D-3)n) (1/M) sum_m [1 - cos(k_n tau cos(theta - pi m/M))]
    ``distance`` tau in m, any shape (the shape of the answer); ``direction`` theta in rad.
    """
    check_surface(fractal_dimension, fractal_roughness, length, ratio)
    whole_number("ridges", ridges, 1)
    whole_number("n_max", n_max, 0)
    tau = finite_array("distance", distance)
    order = np.arange(n_max + 1)
    projection = np.cos(direction - pi * np.arange(1, ridges + 1) / ridges)
    wave = 2.0 * pi / length * np.multiply.outer(float(ratio) ** order, projection)
    weight = float(ratio) ** (2.0 * (fractal_dimension - 3.0) * order) / ridges
    # 1 - cos(a) as 2 sin(a/2)^2 keeps its digits at short distances.
    series = np.einsum("n,...nm->...", weight, 2.0 * np.sin(0.5 * np.multiply.outer(tau, wave)) ** 2)
    scale = length**2 * (fractal_roughness / length) ** (2.0 * (fractal_dimension - 2.0)) * log(ratio)
    return np.asarray(scale * series)


def structure_function_limit(distance: ArrayLike, fractal_dimension: float, fractal_roughness: float) -> FloatArray:
    """Structure function in m2 for unbounded waves, gamma -> 1 and many ridges: independent of L, gamma and M.

    S = G^(2(D-2)) (pi tau)^(2 Hq) Gamma(1 - Hq) / (2 Hq Gamma(1 + Hq)), Hq = 3 - D; ``distance`` tau in m.
    """
    check_surface(fractal_dimension, fractal_roughness)
    hurst = 3.0 - fractal_dimension
    tau = finite_array("distance", distance)
    factor = gamma(1.0 - hurst) / (2.0 * hurst * gamma(1.0 + hurst))
    return np.asarray(fractal_roughness ** (2.0 * (fractal_dimension - 2.0)) * (pi * tau) ** (2.0 * hurst) * factor)


def fractal_roughness_from_sq(
    sq_height: float, fractal_dimension: float, length: float, shortest_length: float, ratio: float = 1.5
) -> float:
    """G in m of the surface that has the root mean square height ``sq_height`` (m) between Ls and L: Sq ~ G^(D-2).

    A measured Sq belongs to an evaluation length and a cut-off, which are L and Ls here. Raises InputError for values
    out of range.
    """
    sq_height = positive_number("sq_height", sq_height, "m")
    log_ratio = log(sq_height / sq(fractal_dimension, length, length, shortest_length, ratio))  # Sq where G = L
    return float(length * np.exp(log_ratio / (fractal_dimension - 2.0)))


class SurfaceWaves(NamedTuple):
    """D, G and the band of waves of a surface, in the order of the arguments of :func:`sq` and :func:`sdq`."""

    fractal_dimension: float
    fractal_roughness: float  # m
    longest: float  # m
    shortest: float  # m
    ratio: float = 1.5  # of successive wave numbers

    def with_sq(self, sq_height: float) -> SurfaceWaves:
        """The same waves with the root mean square height ``sq_height`` (m). Raises InputError."""
        scale = fractal_roughness_from_sq(sq_height, self.fractal_dimension, self.longest, self.shortest, self.ratio)
        return self._replace(fractal_roughness=scale)


@dataclass(frozen=True)
class SurfaceStatistics:
    """Statistics of the surface between its longest and shortest wave, as a profilometer measures them."""

    sq: float  # root mean square height, m
    sdq: float  # root mean square slope, pure number
    n_max: int  # number of the last wave of each ridge
    sample_length: float  # L in m
    shortest_length: float  # Ls in m


def surface_statistics(roughness: Roughness, sample_length: float, shortest_length: float) -> SurfaceStatistics:
    """Sq and Sdq of the waves from ``shortest_length`` to ``sample_length`` (m).

    Raises InputError unless L > Ls > 0.
    """
    dimension, scale, ratio = roughness.fractal_dimension, roughness.fractal_roughness, roughness.frequency_ratio
    return SurfaceStatistics(
        sq(dimension, scale, sample_length, shortest_length, ratio),
        sdq(dimension, scale, sample_length, shortest_length, ratio),
        frequency_count(sample_length, shortest_length, ratio),
        sample_length,
        shortest_length,
    )


def check_surface(fractal_dimension: float, fractal_roughness: float, length: float = 1.0, ratio: float = 1.5) -> None:
    """Raise InputError unless 2 < D < 3, G > 0, L > 0 and gamma > 1, all finite."""
    require_surface_dimension(real_number("fractal_dimension", fractal_dimension))
    positive_number("fractal_roughness", fractal_roughness, "m")
    positive_number("length", length, "m")
    ratio = real_number("ratio", ratio)
    require_allowed("ratio", ratio, ratio > 1, "above 1: it is the ratio of successive wave numbers")


def _geometric_sum(log_factor: float, terms: int) -> float:
    """1 + q + ... + q^(terms-1) with q = exp(log_factor) other than 1."""
    return expm1(terms * log_factor) / expm1(log_factor)
