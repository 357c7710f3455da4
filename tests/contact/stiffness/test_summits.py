"""Laws of independent summits: stiffness as the derivative of the load, other integrals, and each other."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

import stickslip as ss
from sentences import rejects
from stickslip.contact.stiffness.height_spectrum import HeightSpectrum
from stickslip.contact.stiffness.summits import (
    BushGibsonThomasStiffness,
    GreenwoodWilliamsonStiffness,
    SummitStiffness,
)

E_STAR = 108e9
LAWS = [GreenwoodWilliamsonStiffness, BushGibsonThomasStiffness]


def face(law: type[SummitStiffness], band: float = 100.0) -> SummitStiffness:
    return law(HeightSpectrum.self_affine(1e-6, 2.3, 1e-3, 1e-3 / band), E_STAR, 0.3)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_stiffness_is_the_derivative_of_the_load(law: type[SummitStiffness]) -> None:
    separation, step = np.array([-0.5e-6, 1e-6, 3e-6]), 1e-11
    closer, farther = (face(law).at_separation(separation + each)[0] for each in (-step, step))
    assert (closer - farther) / (2 * step) == pytest.approx(face(law).at_separation(separation)[1], rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_stiffness_over_pressure_is_that_of_the_separation(law: type[SummitStiffness]) -> None:
    pressure, stiffness = face(law).at_separation(np.array([0.3e-6, 2.1e-6]))
    assert face(law).normal(pressure) == pytest.approx(stiffness, rel=1e-3)
    assert face(law).tangential(pressure) == pytest.approx(1.4 / 1.7 * stiffness, rel=1e-3)
    ends = face(law).normal(np.geomspace(1e-9, 1e12, 50))
    assert (np.diff(ends) > 0).all()


def test_greenwood_williamson_against_its_integral() -> None:
    law = face(GreenwoodWilliamsonStiffness)
    height, slope, curvature = law.spectrum.profile_moments
    alpha = height * curvature / slope**2
    spread, mean = sqrt((1 - 0.8968 / alpha) * height), 4 * sqrt(height / (pi * alpha))
    density, radius = curvature / (6 * pi * sqrt(3) * slope), 0.375 * sqrt(pi / curvature)
    flat = 1.5e-6

    def load(z: float) -> float:
        return float((z - flat) ** 1.5 * norm.pdf(z, mean, spread))

    wanted = 4 / 3 * E_STAR * density * sqrt(radius) * quad(load, flat, flat + 8e-6, epsabs=0, limit=200)[0]
    assert law.at_separation(np.array([flat]))[0][0] == pytest.approx(wanted, rel=1e-4)


@pytest.mark.slow
def test_bush_gibson_thomas_against_random_summits() -> None:
    """Heights and second derivatives drawn from their joint distribution, each weighted by its density of summits."""
    law = face(BushGibsonThomasStiffness)
    height, slope, curvature = law.spectrum.profile_moments
    third = curvature / 3
    covariance = [
        [height, -slope, -slope, 0],
        [-slope, curvature, third, 0],
        [-slope, third, curvature, 0],
        [0, 0, 0, third],
    ]
    z, xx, yy, xy = np.random.default_rng(3).multivariate_normal(np.zeros(4), covariance, 400_000).T
    determinant = xx * yy - xy**2
    is_summit = (determinant > 0) & (xx + yy < 0)
    weight = determinant[is_summit] / (2 * pi * slope) / z.size
    # Nayak's density of summits, m4 / (6 pi sqrt(3) m2), checks the draw itself.
    assert weight.sum() == pytest.approx(curvature / (6 * pi * sqrt(3) * slope), rel=0.02)
    compression = np.maximum(z[is_summit] - 0.5e-6, 0.0)
    load = 4 / 3 * E_STAR * determinant[is_summit] ** -0.25 * compression**1.5
    assert law.at_separation(np.array([0.5e-6]))[0][0] == pytest.approx((weight * load).sum(), rel=0.02)


@pytest.mark.slow
def test_both_agree_on_a_wide_band() -> None:
    pressure = np.geomspace(1e4, 1e7, 5)
    williamson, bush = (
        face(law, 1e4).normal(pressure) for law in (GreenwoodWilliamsonStiffness, BushGibsonThomasStiffness)
    )
    assert bush == pytest.approx(williamson, rel=0.05)


def test_a_single_wave_has_no_distribution_of_summits() -> None:
    with rejects(ss.InputError, "spectrum"):
        GreenwoodWilliamsonStiffness(HeightSpectrum(np.array([1e-3]), np.array([1e-12])), E_STAR, 0.3)
    with rejects(ss.InputError, "reduced_modulus"):
        GreenwoodWilliamsonStiffness(HeightSpectrum.self_affine(1e-6, 2.3, 1e-3, 1e-5), 0.0, 0.3)
    assert "Greenwood-Williamson" in face(GreenwoodWilliamsonStiffness).describe()
