"""A roughness from the root mean square height and slope that an instrument reports."""

from __future__ import annotations

from math import exp, log, pi

from scipy.optimize import brentq

from stickslip.contact.stiffness.asperities import Roughness
from stickslip.contact.stiffness.surface import SurfaceWaves, check_surface, sdq, sq
from stickslip.core.errors import InputError
from stickslip.core.validation import positive_number

# D of ground, blasted and worn metal, Hurst exponent 0.8: B. N. J. Persson, Tribol. Lett. 54 (2014) 99.
USUAL_DIMENSION = 2.2
RATIO, SMALLEST_RATIO, LARGEST_RATIO = 1.5, 1.05, 3.0  # of successive waves: the usual one, and chosen limits
MOST_WAVES = 60  # 1.5^60 = 4e10: more than a metre over an atom
SHORTEST_WAVE = 1e-10  # m; atoms of metals are 0.25 nm apart, as in shortest_length of study files


def roughness_of_heights(
    sq_height: float,
    sdq_slope: float,
    sample_length: float,
    hardness: float,
    reduced_modulus: float,
    poisson_ratio: float,
    fractal_dimension: float = USUAL_DIMENSION,
) -> Roughness:
    """The surface with the measured ``sq_height`` (Sq in m) and ``sdq_slope`` (Sdq) over ``sample_length`` (m).

    Its waves are those of :func:`waves_of_heights`. Hardness and reduced modulus in Pa. The result is credible if its
    ``shortest_length`` is about twice the spacing of the measurement; otherwise D is another one. Raises InputError for
    values out of range, and an Sdq that no band of waves from the sample length to the distance of atoms has.
    """
    waves = waves_of_heights(sq_height, sdq_slope, sample_length, fractal_dimension)
    return Roughness(
        waves.fractal_dimension,
        waves.fractal_roughness,
        hardness,
        reduced_modulus,
        poisson_ratio,
        frequency_ratio=waves.ratio,
        sample_length=waves.longest,
        shortest_length=waves.shortest,
    )


def waves_of_heights(
    sq_height: float, sdq_slope: float, sample_length: float, fractal_dimension: float = USUAL_DIMENSION
) -> SurfaceWaves:
    """The waves with the root mean square height Sq = ``sq_height`` (m) and slope Sdq = ``sdq_slope``, both exactly.

    The longest wave is ``sample_length`` (m). The number of waves follows from Sdq at the given D, and G from Sq; the
    ratio of successive waves is adjusted about 1.5. Raises InputError as :func:`roughness_of_heights`.
    """
    height, slope = positive_number("sq_height", sq_height, "m"), positive_number("sdq_slope", sdq_slope, "(a slope)")
    longest = positive_number("sample_length", sample_length, "m")
    check_surface(fractal_dimension, 1.0, longest)

    def excess(ratio: float, waves: int) -> float:
        band = fractal_dimension, longest, longest, longest / ratio ** (waves - 1), ratio
        return log(sdq(*band) / sq(*band) * height / slope)

    for waves in range(2, MOST_WAVES + 1):
        if excess(RATIO, waves) > 0.0 and excess(SMALLEST_RATIO, waves) < 0.0:
            ratio = float(brentq(excess, SMALLEST_RATIO, LARGEST_RATIO, args=(waves,), xtol=1e-13))
            shortest = longest / ratio ** (waves - 1)
            if shortest < SHORTEST_WAVE:
                raise InputError(
                    f"with fractal_dimension = {fractal_dimension:g}, a surface has Sq = {height:g} m and Sdq = "
                    f"{slope:g} only with waves down to {shortest:.2g} m, which is below the distance of atoms. Raise "
                    "fractal_dimension until the shortest wave is twice the spacing of the measurement, or check Sdq.",
                    arguments=["sdq_slope", "fractal_dimension"],
                )
            return SurfaceWaves(fractal_dimension, longest, longest, shortest, ratio).with_sq(height)
    least = 2.0 * pi * height / longest
    raise InputError(
        f"Sdq is {slope:g}, but a surface with Sq = {height:g} m and waves of at most {longest:g} m has a slope "
        f"above {least:.3g}, and below {slope * exp(excess(RATIO, MOST_WAVES)):.3g}. Check Sdq, and the units of Sq "
        "and of the sample length.",
        arguments=["sdq_slope"],
    )
