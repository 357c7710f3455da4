"""Faces that the tests of roughness share: material of the tabulated values, and a maker of roughnesses."""

from __future__ import annotations

from stickslip.contact.stiffness.fractal import Roughness

HARDNESS, REDUCED_MODULUS, POISSON, RATIO = 3e9, 108.2417582e9, 0.3, 1.5
NOMINAL_AREA = 182e-6
MINDLIN = 2 * (1 - POISSON) / (2 - POISSON)


def rough(dimension: float = 2.4, scale: float = 1e-8, **changes: float) -> Roughness:
    """A face of the table."""
    given_values = {"hardness": HARDNESS, "reduced_modulus": REDUCED_MODULUS, "poisson_ratio": POISSON} | changes
    return Roughness(dimension, scale, **given_values)
