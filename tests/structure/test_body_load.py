"""Centrifugal loads: their resultants follow from mass and centre of mass alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from stickslip.structure.body_load import centrifugal_load
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh


def test_resultant_is_mass_times_distance_of_its_centre(make_block: Callable[..., Mesh]) -> None:
    brick = make_block((4, 3, 2), (0.04, 0.03, 0.01), 0.1)
    body = (np.arange(len(brick.cells)) >= 12).astype(np.int64)
    mesh = Mesh(brick.points, brick.cells, body, body_names=("light", "heavy"))
    axis, point = np.array([0.0, 0.6, 0.8]), np.array([-0.2, 0.05, 0.01])
    materials = (Material(density=1000.0), Material(density=8000.0))
    load = centrifugal_load(mesh, materials, axis, point).reshape(-1, 3)
    # mass and first moment by the one-material load of an axis far away: f = M (r - axis part), M r = first moment
    total = np.zeros(3)
    for number, material in enumerate(materials):
        mass, centre = _mass_and_centre(brick.points[brick.cells[body == number]], material.density)
        arm = centre - point
        total += mass * (arm - (arm @ axis) * axis)
    assert load.sum(axis=0) == pytest.approx(total, rel=1e-9)
    assert load @ axis == pytest.approx(np.zeros(len(load)), abs=1e-12)


def _mass_and_centre(corners: np.ndarray, density: float) -> tuple[float, np.ndarray]:
    """By splitting every brick into many small ones with trilinear maps: Gauss points of order 3."""
    from stickslip.structure.shapes import gauss_points, shape_functions

    where, weight = gauss_points(3)
    values, gradients = shape_functions(8, where)
    jacobian = np.linalg.det(np.einsum("qkx,mky->mqxy", gradients, corners))
    places = np.einsum("qk,mky->mqy", values, corners)
    volume = jacobian * weight
    return density * volume.sum(), (volume[..., None] * places).sum(axis=(0, 1)) / volume.sum()
