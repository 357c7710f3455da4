"""The spectrum of a rough surface: its statistics against those of the discrete surface and against closed forms."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

import stickslip as ss
from rough_faces import HARDNESS, POISSON, REDUCED_MODULUS, rough
from sentences import rejects
from stickslip.contact.stiffness.height_spectrum import HeightSpectrum
from stickslip.contact.stiffness.surface import sdq, sq


def fractal(dimension: float = 2.4) -> HeightSpectrum:
    return HeightSpectrum.of_fractal(rough(dimension, 1e-10, sample_length=1e-2, shortest_length=1e-5))


@pytest.mark.parametrize("dimension", [2.1, 2.4, 2.7])
def test_height_and_slope_are_those_of_the_discrete_surface(dimension: float) -> None:
    spectrum = fractal(dimension)
    assert spectrum.sq == pytest.approx(sq(dimension, 1e-10, 1e-2, 1e-5), rel=1e-12)
    # A wave distributed over its interval has the mean of q^2 over it, which is up to 2 % above the middle.
    assert spectrum.sdq == pytest.approx(sdq(dimension, 1e-10, 1e-2, 1e-5), rel=0.02)


def test_moments_of_a_profile() -> None:
    """Of one wave: m0, m2 = Sdq^2/2 and m4 = 3/8 of variance q^4."""
    q = 2 * pi / 1e-3
    height, slope, curvature = HeightSpectrum(np.array([1e-3]), np.array([4e-12])).profile_moments
    assert (height, slope, curvature) == pytest.approx((4e-12, 0.5 * 4e-12 * q**2, 0.375 * 4e-12 * q**4))


def test_drop_of_a_summit_is_a_parabola_below_the_shortest_wave() -> None:
    spectrum = fractal()
    drop, slope = spectrum.summit_drop(np.array([1e-8, 3e-8]))
    curvature = sqrt(spectrum.profile_moments[2])
    assert drop == pytest.approx(0.5 * curvature * np.array([1e-8, 3e-8]) ** 2, rel=1e-4)
    assert slope == pytest.approx(curvature * np.array([1e-8, 3e-8]), rel=1e-4)


def test_slope_of_the_drop_is_its_derivative() -> None:
    spectrum, at = fractal(), np.geomspace(1e-7, 5e-3, 40)
    step = 1e-4 * at
    difference = (spectrum.summit_drop(at + step)[0] - spectrum.summit_drop(at - step)[0]) / (2 * step)
    assert spectrum.summit_drop(at)[1] == pytest.approx(difference, rel=2e-4, abs=1e-6 * difference.max())


def test_waves_longer_than_the_form_are_not_roughness() -> None:
    spectrum = fractal()
    assert spectrum.up_to(1e-3).wavelength.max() <= 1e-3
    assert spectrum.up_to(1e-3).sq < 0.5 * spectrum.sq
    assert spectrum.up_to(1.0).sq == spectrum.sq
    with rejects(ss.InputError, "longest"):
        spectrum.up_to(1e-7)


def test_a_law_of_the_spectrum_needs_both_ends_of_the_waves() -> None:
    with rejects(ss.InputError, "sample_length", "shortest_length"):
        HeightSpectrum.of_fractal(rough())


def test_values_that_no_spectrum_has() -> None:
    with rejects(ss.InputError, "variance"):
        HeightSpectrum(np.array([1e-3]), np.array([-1.0]))
    with rejects(ss.InputError, "wavelength"):
        HeightSpectrum(np.array([1e-4, 1e-3]), np.array([1e-12, 1e-12]))


@pytest.mark.parametrize(("dimension", "slope"), [(2.2, 0.02), (2.2, 0.07), (2.5, 0.1)])
def test_a_surface_from_measured_height_and_slope_has_both(dimension: float, slope: float) -> None:
    found = ss.roughness_of_heights(1.2e-6, slope, 4e-3, HARDNESS, REDUCED_MODULUS, POISSON, dimension)
    assert found.sample_length is not None
    assert found.shortest_length is not None
    band = found.sample_length, found.shortest_length, found.frequency_ratio
    assert sq(dimension, found.fractal_roughness, *band) == pytest.approx(1.2e-6, rel=1e-9)
    assert sdq(dimension, found.fractal_roughness, *band) == pytest.approx(slope, rel=1e-9)
    assert found.sample_length == 4e-3


def test_a_slope_that_the_height_and_length_exclude() -> None:
    with rejects(ss.InputError, "sdq_slope"):
        ss.roughness_of_heights(1e-6, 1e-4, 4e-3, HARDNESS, REDUCED_MODULUS, POISSON)
    with rejects(ss.InputError, "sdq_slope", "fractal_dimension"):  # waves down to 9 pm
        ss.roughness_of_heights(0.8e-6, 0.12, 4e-3, HARDNESS, REDUCED_MODULUS, POISSON)
    with rejects(ss.InputError, "sq_height"):
        ss.roughness_of_heights(0.0, 0.1, 4e-3, HARDNESS, REDUCED_MODULUS, POISSON)
