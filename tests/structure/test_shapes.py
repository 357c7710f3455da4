import numpy as np
import pytest

from sentences import rejects
from solid_cells import CORNERS
from stickslip.core.errors import InputError
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.shapes import consistent_mass, gauss_points, shape_functions

NODES = CELL_KINDS["hexahedron20"].nodes


@pytest.mark.parametrize("n_nodes", [8, 20])
def test_functions_are_one_at_their_node_and_reproduce_linear_fields(n_nodes: int) -> None:
    values, _ = shape_functions(n_nodes, NODES[:n_nodes])
    np.testing.assert_allclose(values, np.eye(n_nodes), atol=1e-13)
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 3))
    values, gradients = shape_functions(n_nodes, points)
    field = 2.0 + NODES[:n_nodes] @ [1.0, -3.0, 0.5]
    np.testing.assert_allclose(values @ field, 2.0 + points @ [1.0, -3.0, 0.5])
    np.testing.assert_allclose(np.einsum("qka,k->qa", gradients, field), np.tile([1.0, -3.0, 0.5], (5, 1)), atol=1e-13)


@pytest.mark.parametrize("n_nodes", [8, 20])
def test_gradients_are_the_slopes_of_the_values(n_nodes: int) -> None:
    point = np.array([[0.3, -0.2, 0.6]])
    _, gradients = shape_functions(n_nodes, point)
    step = 1e-5
    for axis in range(3):
        move = step * np.eye(3)[axis]
        slope = (shape_functions(n_nodes, point + move)[0] - shape_functions(n_nodes, point - move)[0]) / (2 * step)
        np.testing.assert_allclose(gradients[0, :, axis], slope[0], atol=1e-9)


def test_gauss_rule_integrates_the_degree_it_promises() -> None:
    points, weights = gauss_points(3)
    assert weights @ (points[:, 0] ** 4 * points[:, 1] ** 2) == pytest.approx(2 / 5 * 2 / 3 * 2)


def test_mass_sums_to_density_times_volume() -> None:
    corners = (CORNERS + 1) / 2 * [2.0, 3.0, 0.5]
    assert consistent_mass(corners[None], 7800.0).sum() == pytest.approx(7800.0 * 3.0)


def test_a_folded_cell_is_rejected() -> None:
    nodes = NODES.copy()[None]
    nodes[0, 8] = [0.0, 3.0, -1.0]
    with rejects(InputError):
        consistent_mass(nodes, 1.0)
