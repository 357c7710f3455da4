"""A circular plate with a free rim, clamped at its bore, from one sector: published numbers and plate theory."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.optimize
import scipy.special

from sectors import annulus
from stickslip.structure.elasticity import Material, assemble
from stickslip.structure.sector_boundaries import cyclic_symmetry
from stickslip.structure.sector_reduction import sector_frequencies

STEEL = Material(200e9, 0.33, 7850.0)
SECTORS, BORE, RIM, THICKNESS = 24, 0.03, 0.3, 0.01
# Hz, nodal diameters 0 to 3: A. W. Leissa, Vibration of Plates, NASA SP-160 (1969).
PUBLISHED = np.array([115.6, 95.05, 150.1, 333.8])


def plate_hz(thickness: float, counts: tuple[int, int, int]) -> Any:
    """(4,) Hz, the lowest of nodal diameters 0 to 3 of 20-node bricks (along the radius, round a sector, through)."""
    mesh = annulus(SECTORS, (BORE, RIM), thickness, counts, of=1).quadratic()
    x, y, _ = mesh.points.T
    angle = np.arctan2(y, x)
    left, right = (np.flatnonzero(np.abs(angle - each) < 1e-9) for each in (0.0, 2.0 * np.pi / SECTORS))
    plate = assemble(mesh, STEEL, "serendipity", np.flatnonzero(np.hypot(x, y) < BORE + 1e-6))
    found = sector_frequencies(plate, cyclic_symmetry(mesh.points, left, right), range(4), 1)
    return np.array([found[diameter][0] for diameter in range(4)])


def theory_hz(diameter: int, thickness: float) -> float:
    """Kirchhoff's plate: ``w = (A J + B Y + C I + D K)(k r) cos(n angle)`` with zero w and w' at the bore, and zero
    moment and Kelvin-Kirchhoff shear force at the rim."""
    ratio, n = STEEL.poisson_ratio, diameter
    special: Any = scipy.special
    functions = [(getattr(special, f"{name}v"), getattr(special, f"{name}vp"), sign)
                 for name, sign in (("j", -1), ("y", -1), ("i", 1), ("k", 1))]  # fmt: skip

    def determinant(number: float) -> float:
        columns = []
        for function, derivative, sign in functions:
            # Derivatives by k r; sign is that of the Laplacian of the function over itself.
            r = number * RIM
            w, slope, bend = function(n, r), derivative(n, r), derivative(n, r, 2)
            moment = bend + ratio * (slope / r - n**2 * w / r**2)
            shear = sign * slope - (1.0 - ratio) * n**2 / r**2 * (slope - w / r)
            columns.append([function(n, number * BORE), derivative(n, number * BORE), moment, shear])
        matrix = np.array(columns).T
        return float(np.linalg.det(matrix / np.abs(matrix).max(axis=0)))

    numbers = np.linspace(1.2 / RIM, 6.0 / RIM, 400)
    values = np.array([determinant(each) for each in numbers])
    first = int(np.flatnonzero(values[:-1] * values[1:] < 0.0)[0])
    wave_number = scipy.optimize.brentq(determinant, numbers[first], numbers[first + 1])
    bending = STEEL.young_modulus * thickness**3 / (12.0 * (1.0 - ratio**2))
    return float(wave_number**2 * np.sqrt(bending / (STEEL.density * thickness)) / (2.0 * np.pi))


@pytest.mark.slow
def test_the_published_numbers_are_those_of_plate_theory() -> None:
    """The published ones have three digits, and that of no nodal diameter is 0.6 % below the closed form."""
    exact = [theory_hz(diameter, THICKNESS) for diameter in range(4)]
    np.testing.assert_allclose(exact, [116.29, 94.98, 150.87, 334.52], rtol=5e-5)
    np.testing.assert_allclose(PUBLISHED, exact, rtol=7e-3)


@pytest.mark.slow
def test_a_plate_has_the_published_frequencies_and_converges_from_above() -> None:
    coarse, middle, fine = (plate_hz(THICKNESS, counts) for counts in ((4, 1, 1), (8, 1, 1), (16, 2, 2)))
    assert (coarse > middle).all()
    assert (middle > fine).all()
    np.testing.assert_allclose(fine, PUBLISHED, rtol=0.01)


@pytest.mark.slow
def test_a_thin_plate_has_the_frequencies_of_plate_theory_from_above() -> None:
    """A quarter of the thickness: shear and rotary inertia, which plate theory does not have, nearly vanish."""
    exact = np.array([theory_hz(diameter, 0.25 * THICKNESS) for diameter in range(4)])
    coarse, fine = (plate_hz(0.25 * THICKNESS, counts) for counts in ((16, 2, 1), (32, 3, 1)))
    assert (coarse > fine).all()
    assert (fine > exact).all()
    np.testing.assert_allclose(fine, exact, rtol=4e-3)
