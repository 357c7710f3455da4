from math import factorial

import numpy as np
import pytest

from stickslip.structure.side_shapes import (
    BORDER,
    N_CORNERS,
    NODES,
    facet_corners,
    side_functions,
    side_geometry,
    square_rule,
    triangle_rule,
)


@pytest.mark.parametrize("n_nodes", [3, 4, 6, 8])
def test_functions_are_one_at_their_node_and_sum_to_one(n_nodes):
    np.testing.assert_allclose(side_functions(n_nodes, NODES[n_nodes])[0], np.eye(n_nodes), atol=1e-15)
    where = np.random.default_rng(n_nodes).uniform(0.0, 0.5, (7, 2))
    values, gradients = side_functions(n_nodes, where)
    np.testing.assert_allclose(values.sum(axis=1), 1.0)
    np.testing.assert_allclose(values @ NODES[n_nodes], where, atol=1e-15)
    step = 1e-6
    for axis in (0, 1):
        shift = step * np.eye(2)[axis]
        slope = (side_functions(n_nodes, where + shift)[0] - side_functions(n_nodes, where - shift)[0]) / (2 * step)
        np.testing.assert_allclose(gradients[..., axis], slope, atol=1e-9)


@pytest.mark.parametrize("degree", [2, 4])
def test_triangle_rules_are_exact_to_their_degree(degree):
    points, weights = triangle_rule(degree)
    assert weights.min() > 0.0
    assert points.min() > 0.0
    assert points.sum(axis=1).max() < 1.0
    for first in range(degree + 1):
        for second in range(degree + 1 - first):
            exact = factorial(first) * factorial(second) / factorial(first + second + 2)
            assert weights @ (points[:, 0] ** first * points[:, 1] ** second) == pytest.approx(exact, rel=1e-13)


def test_square_rule_is_exact_to_degree_three():
    points, weights = square_rule(2)
    assert weights @ (points[:, 0] ** 2 * points[:, 1] ** 2) == pytest.approx(4.0 / 9.0)
    assert weights.sum() == pytest.approx(4.0)


@pytest.mark.parametrize("n_nodes", [3, 4, 6, 8])
def test_facets_and_border_tile_the_side(n_nodes):
    def area(polygon):
        x, y = polygon.T
        return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))

    whole = area(NODES[n_nodes][BORDER[n_nodes]])
    assert whole == pytest.approx(0.5 if N_CORNERS[n_nodes] == 3 else 4.0)
    parts = [area(corners) for corners in facet_corners(n_nodes)[1]]
    assert min(parts) > 0.0
    assert sum(parts) == pytest.approx(whole)


@pytest.mark.parametrize("n_nodes", [3, 4, 6, 8])
def test_area_shares_of_a_plane_side(n_nodes):
    frame = np.array([[2.0, 0.0, 1.0], [0.5, 3.0, 0.0]])
    share, normal = side_geometry((NODES[n_nodes] @ frame)[None])
    vector = np.cross(*frame)
    assert share.min() > 0.0
    reference_area = 0.5 if N_CORNERS[n_nodes] == 3 else 4.0
    assert share.sum() == pytest.approx(reference_area * np.linalg.norm(vector), rel=1e-13)
    np.testing.assert_allclose(normal[0], vector / np.linalg.norm(vector), atol=1e-14)
