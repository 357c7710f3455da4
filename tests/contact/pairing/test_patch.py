"""The patch test: a uniform pressure goes through an interface between meshes that do not match."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
import pytest
from touching_blocks import PRESSURE, Options, press, stacked

from stickslip.contact.pairing.pairing import pair_surfaces
from stickslip.core.validation import FloatArray

RIGID = 1e15  # N/m3, a thousand times as stiff as a layer of elements
SOFT = 1e11  # N/m3, a tenth as stiff as a layer of elements, as contact of steel with elements of 1 mm is
KINDS: dict[str, Options] = {
    "bricks": {},
    "quadratic bricks": {"quadratic": True},
    "tetrahedra": {"kind": "tetra"},
    "quadratic tetrahedra": {"kind": "tetra", "quadratic": True},
}


def pressed(
    points: Literal["nodes", "quadrature"],
    normal_per_area: float,
    lower: Sequence[int] = (3, 2, 1),
    upper: Sequence[int] = (4, 3, 1),
    lower_options: Options | None = None,
    upper_options: Options | None = None,
) -> tuple[FloatArray, float]:
    mesh = stacked(lower, upper, lower_options=lower_options, upper_options=upper_options)
    pairs = pair_surfaces(mesh, "bottom", "top", points=points).pairs
    pressure, error, forces = press(mesh, pairs, normal_per_area)
    # The contact forces of both bodies balance, and so do their moments.
    scale = PRESSURE * 1e-12
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=scale)
    np.testing.assert_allclose(np.cross(mesh.points, forces).sum(axis=0), 0.0, atol=scale)
    # The first body gets the whole load.
    assert forces[mesh.nodes_of_body(1), 2].sum() == pytest.approx(-PRESSURE, rel=1e-9)
    return pressure, error


@pytest.mark.slow
@pytest.mark.parametrize("upper", KINDS)
@pytest.mark.parametrize("lower", KINDS)
def test_quadrature_passes_to_round_off(lower: str, upper: str) -> None:
    pressure, error = pressed("quadrature", RIGID, lower_options=KINDS[lower], upper_options=KINDS[upper])
    assert error < 1e-11
    np.testing.assert_allclose(pressure, 1.0, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "largest"), [("hexahedron", 1.5e-2), ("tetra", 2e-2)])
def test_quadrature_of_distorted_quadrilaterals_is_close(kind: str, largest: float) -> None:
    options = {"distortion": 0.2}
    pressure, error = pressed("quadrature", RIGID, lower_options=options, upper_options={**options, "kind": kind})
    assert error < 1e-4
    assert 1e-6 < np.abs(pressure - 1.0).max() < largest
    pressure, error = pressed("quadrature", SOFT, lower_options=options, upper_options={**options, "kind": kind})
    assert np.abs(pressure - 1.0).max() < 2e-4


def test_distorted_triangles_pass_to_round_off() -> None:
    options = {"distortion": 0.2, "kind": "tetra"}
    pressure, error = pressed("quadrature", RIGID, lower_options=options, upper_options=options)
    assert error < 1e-11
    np.testing.assert_allclose(pressure, 1.0, atol=1e-9)


@pytest.mark.slow
def test_nodes_pass_only_where_meshes_match() -> None:
    pressure, error = pressed("nodes", RIGID, (3, 2, 1), (3, 2, 1))
    np.testing.assert_allclose(pressure, 1.0, atol=1e-9)
    pressure, error = pressed("nodes", RIGID)
    assert 0.05 < np.abs(pressure - 1.0).max() < 0.25
    assert 0.01 < error < 0.15


@pytest.mark.slow
def test_displacements_of_nodes_converge_with_order_one() -> None:
    errors = [pressed("nodes", RIGID, (3 * n, 2 * n, n), (4 * n, 3 * n, n))[1] for n in (1, 2, 4)]
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (slopes > 0.9).all()


@pytest.mark.slow
def test_pressure_of_nodes_evens_out_where_the_springs_are_soft_beside_an_element() -> None:
    spread = [np.abs(pressed("nodes", SOFT, (3 * n, 2 * n, n), (4 * n, 3 * n, n))[0] - 1.0).max() for n in (1, 2, 4)]
    assert spread[0] < 0.06
    assert spread[1] < 0.7 * spread[0]
    assert spread[2] < 0.7 * spread[1]


@pytest.mark.slow
def test_a_finer_first_face_is_the_better_choice() -> None:
    coarse = stacked((6, 6, 2), (2, 2, 1))
    spread = {}
    for first, second in (("bottom", "top"), ("top", "bottom")):
        pairs = pair_surfaces(coarse, first, second).pairs
        spread[first] = press(coarse, pairs, RIGID)[1]
    assert spread["top"] < 0.2 * spread["bottom"]


def test_nodes_of_a_mesh_that_divides_the_other_one_pass() -> None:
    mesh = stacked((3, 2, 1), (9, 6, 2))
    pressure, error, _ = press(mesh, pair_surfaces(mesh, "bottom", "top").pairs, RIGID)
    assert error < 1e-11
    np.testing.assert_allclose(pressure, 1.0, atol=1e-9)
