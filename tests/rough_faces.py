"""Faces that the tests of roughness share: material of the tabulated values, and a maker of roughnesses."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.stiffness.fractal import Roughness, StiffnessMode
from stickslip.contact.stiffness.fractal_law import FractalStiffness
from stickslip.contact.stiffness.stiffness_law import Allocation, springs_of_pairs
from stickslip.core.validation import FloatArray

HARDNESS, REDUCED_MODULUS, POISSON, RATIO = 3e9, 108.2417582e9, 0.3, 1.5
NOMINAL_AREA = 182e-6
MINDLIN = 2 * (1 - POISSON) / (2 - POISSON)


def rough(dimension: float = 2.4, scale: float = 1e-8, **changes: float) -> Roughness:
    """A face of the table."""
    given_values = {"hardness": HARDNESS, "reduced_modulus": REDUCED_MODULUS, "poisson_ratio": POISSON} | changes
    return Roughness(dimension, scale, **given_values)


def pair_stiffness(
    roughness: Roughness,
    area: ArrayLike,
    preload: ArrayLike,
    mode: StiffnessMode = "consistent",
    allocation: Allocation = "area",
    face: ArrayLike = 0,
    reference_area: float | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Stiffness of pairs whose faces are their own reference areas, unless one is given."""
    areas, faces = np.asarray(area, dtype=float), np.broadcast_to(face, np.shape(area))
    loads = np.broadcast_to(preload, areas.shape) if np.ndim(preload) == 0 else np.asarray(preload, dtype=float)
    normal, tangential = np.empty(areas.shape), np.empty(areas.shape)
    for each in np.unique(faces):
        members = faces == each
        own_area = float(areas[members].sum()) if reference_area is None else reference_area
        law = FractalStiffness(roughness, own_area, mode)
        own = loads[members] if loads.shape == areas.shape else loads
        normal[members], tangential[members] = springs_of_pairs(law, areas[members], own, allocation)
    return normal, tangential
