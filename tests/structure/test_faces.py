import numpy as np
import pytest

from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import Mesh


def quarter_tube(quadratic: bool) -> Mesh:
    """Quarter of a tube around y, radius 1 outside and 0.5 inside, length 2, with its outer surface as a node set."""
    angle, radius, y = np.linspace(0.0, np.pi / 2, 13), np.array([0.5, 1.0]), np.linspace(0.0, 2.0, 3)
    grid = np.array([[[(r * np.cos(a), v, r * np.sin(a)) for v in y] for r in radius] for a in angle])
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    order = [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)]
    cells = np.stack([number[i : 12 + i, j : 1 + j, k : 2 + k].ravel() for i, j, k in order], axis=1)
    mesh = Mesh(grid.reshape(-1, 3), cells, node_sets={"outside": number[:, 1].ravel()})
    return mesh.quadratic() if quadratic else mesh


@pytest.mark.parametrize("quadratic", [False, True])
def test_area_and_normals_of_a_curved_face(quadratic: bool) -> None:
    mesh = quarter_tube(quadratic)
    nodes, area, normal = face_geometry(mesh, "outside")
    np.testing.assert_array_equal(nodes, mesh.node_set("outside"))
    facet = 2.0 * np.sin(np.pi / 48)
    assert area.sum() == pytest.approx(2.0 * 12 * facet, rel=1e-12)
    assert area.min() > 0.0
    radial = mesh.points[nodes] * [1.0, 0.0, 1.0]
    radial /= np.linalg.norm(radial, axis=1, keepdims=True)
    # Nodes inside the arc see the two facets beside them alike; the end nodes see one facet, half of its angle off.
    assert np.abs(normal - radial).max() < 1.01 * facet
    inner = (mesh.points[nodes][:, 0] > 1e-9) & (mesh.points[nodes][:, 2] > 1e-9)
    np.testing.assert_allclose(normal[inner], radial[inner], atol=1e-12)


def test_linear_fractions_follow_the_shape_functions() -> None:
    points = np.array([[0, 0, 0], [2, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [2, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    mesh = Mesh(points, np.arange(8)[None], node_sets={"top": np.arange(4, 8)})
    nodes, area, _ = face_geometry(mesh, "top")
    # First moments: the shares carry the centroid of the trapezoid, integral of x dA = sum of share_i x_i.
    assert area @ points[nodes, 0] == pytest.approx(7 / 6)
    assert area @ points[nodes, 1] == pytest.approx(2 / 3)
