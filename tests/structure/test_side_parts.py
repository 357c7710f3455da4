from math import factorial

import numpy as np
import pytest

from stickslip.core.validation import FloatArray
from stickslip.structure.shapes import side_shape_functions, square_rule, triangle_rule
from stickslip.structure.side_parts import SIDE_BORDER, SIDE_FACETS, SIDE_NODES


@pytest.mark.parametrize("n_nodes", [3, 4, 6, 8])
def test_nodes_are_where_the_shape_functions_are_one(n_nodes: int) -> None:
    values, _ = side_shape_functions(n_nodes, SIDE_NODES[n_nodes])
    np.testing.assert_allclose(values, np.eye(n_nodes), atol=1e-14)


@pytest.mark.parametrize("n_nodes", [3, 4, 6, 8])
def test_facets_and_border_tile_the_side(n_nodes: int) -> None:
    def area(polygon: FloatArray) -> float:
        x, y = polygon.T
        return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))

    whole = area(SIDE_NODES[n_nodes][SIDE_BORDER[n_nodes]])
    assert whole == pytest.approx(0.5 if n_nodes in (3, 6) else 4.0)
    parts = [area(SIDE_NODES[n_nodes][facet]) for facet in SIDE_FACETS[n_nodes]]
    assert min(parts) > 0.0
    assert sum(parts) == pytest.approx(whole)


@pytest.mark.parametrize(("degree", "size"), [(2, 3), (4, 6)])
def test_triangle_rules_are_exact_to_their_degree(degree: int, size: int) -> None:
    points, weights = triangle_rule(degree)
    assert len(weights) == size
    assert weights.min() > 0.0
    for first in range(degree + 1):
        for second in range(degree + 1 - first):
            exact = factorial(first) * factorial(second) / factorial(first + second + 2)
            assert weights @ (points[:, 0] ** first * points[:, 1] ** second) == pytest.approx(exact, rel=1e-12)


def test_square_rule_is_exact_to_degree_three() -> None:
    points, weights = square_rule(2)
    assert weights @ (points[:, 0] ** 2 * points[:, 1] ** 2) == pytest.approx(4.0 / 9.0)
    assert weights.sum() == pytest.approx(4.0)
