"""Ties of nodes to faces with other nodes: linear fields, rigid motions over a gap, and the patch test."""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from stickslip.structure.constraints import Constraints, eliminate
from stickslip.structure.elasticity import Material, assemble_bodies, natural_frequencies
from stickslip.structure.equations import Equations
from stickslip.structure.face_ties import TiedNodes, add_tie, mean_edge, tie_nodes
from stickslip.structure.mesh import Mesh
from stickslip.structure.tied_parts import supported_groups

Triple = tuple[int, int, int]
STEEL = Material(2e11, 0.3, 7800.0)


def block(counts: Triple, low: Sequence[float], high: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Points and cells of a block of 8-node bricks."""
    axes = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True)]
    points = np.array([[x, y, z] for z in axes[2] for y in axes[1] for x in axes[0]])
    row, layer = counts[0] + 1, (counts[0] + 1) * (counts[1] + 1)
    first = [i + row * j + layer * k for k in range(counts[2]) for j in range(counts[1]) for i in range(counts[0])]
    corner = np.array([0, 1, row + 1, row])
    return points, np.array(first)[:, None] + np.append(corner, corner + layer)


def stacked(lower: Triple, upper: Triple, quadratic: bool = False, gap: float = 0.0) -> Mesh:
    """Two blocks, one above the other, with the sets bottom, below, above and top."""
    first, cells = block(lower, (0, 0, 0), (1.0, 0.8, 0.5))
    second, others = block(upper, (0, 0, 0.5 + gap), (1.0, 0.8, 1.1 + gap))
    points = np.vstack([first, second])
    z, second_block = points[:, 2], np.arange(len(points)) >= len(first)
    sets = {
        "bottom": z == 0.0,
        "below": (z == 0.5) & ~second_block,
        "above": (z == 0.5 + gap) & second_block,
        "top": z == z.max(),
    }
    body = np.repeat([0, 1], [len(cells), len(others)])
    named = {name: np.flatnonzero(members) for name, members in sets.items()}
    mesh = Mesh(points, np.vstack([cells, others + len(first)]), body, named)
    return mesh.quadratic() if quadratic else mesh


def tied(
    mesh: Mesh, fixed: Sequence[int] | np.ndarray = (), tolerance: float | None = None
) -> tuple[Constraints, TiedNodes]:
    """Constraints of the tie, and the tied nodes."""
    equations = Equations(mesh.n_nodes)
    nodes = tie_nodes(mesh.points, mesh.node_set("above"), mesh.sides("below"), tolerance)
    add_tie(equations, equations.owner("tie"), nodes)
    return eliminate(equations, fixed), nodes


@pytest.mark.parametrize("quadratic", [False, True])
def test_linear_fields_satisfy_the_tie(quadratic: bool) -> None:
    mesh = stacked((2, 3, 1), (3, 2, 1), quadratic)
    constraints, nodes = tied(mesh)
    field = (mesh.points @ np.array([[1.0, 0.2, 0.3], [-0.4, 0.5, 0.1], [0.2, 0.7, -0.6]])).ravel()
    np.testing.assert_allclose(constraints.transformation @ field[constraints.free_unknowns], field, atol=1e-13)
    assert not nodes.untied.size
    assert nodes.distance.max() < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("quadratic", [False, True])
def test_rigid_motions_pass_a_gap_and_nothing_else_is_free(quadratic: bool) -> None:
    """Six frequencies are zero with a gap of a tenth of an element between the faces, too."""
    mesh = stacked((2, 3, 1), (3, 2, 1), quadratic, gap=0.03)
    constraints, nodes = tied(mesh, tolerance=0.04)
    np.testing.assert_allclose(nodes.distance, 0.03)
    turned = np.cross([0.3, -0.5, 0.8], mesh.points).ravel()
    np.testing.assert_allclose(constraints.transformation @ turned[constraints.free_unknowns], turned, atol=1e-13)
    structure = assemble_bodies(mesh, [STEEL] * 2, constraints=constraints)
    frequency_hz, _ = natural_frequencies(structure.stiffness, structure.mass, 7)
    assert frequency_hz[5] < 1e-4 * frequency_hz[6]
    (group,) = supported_groups(mesh, np.empty(0, dtype=np.int64), constraints)
    assert (len(group.parts), group.free) == (2, 6)
    assert [each.free for each in supported_groups(mesh, np.empty(0, dtype=np.int64))] == [6, 6]


def patch_error(lower: Triple, upper: Triple, quadratic: bool) -> float:
    """Largest error of the vertical displacement under uniform pressure, as a fraction of the largest displacement.

    The exact solution is uniaxial stress; symmetry planes at x = 0, y = 0, z = 0.
    """
    mesh = stacked(lower, upper, quadratic)
    fixed = np.concatenate([3 * np.flatnonzero(mesh.points[:, axis] == 0.0) + axis for axis in range(3)])
    constraints, _ = tied(mesh, fixed)
    structure = assemble_bodies(mesh, [STEEL] * 2, fixed_unknowns=fixed, constraints=constraints)
    z = mesh.points[:, 2]
    exact = np.outer(z, [0.0, 0.0, 1.0]) - 0.3 * np.column_stack([mesh.points[:, :2], np.zeros(len(z))])
    stress = STEEL.young_modulus
    # consistent load of a uniform pressure: what the stiffness of the upper block alone needs for the exact field
    upper_block = assemble_bodies(mesh, [STEEL] * 2)
    load = np.zeros(3 * mesh.n_nodes)
    top = 3 * mesh.node_set("top") + 2
    load[top] = (upper_block.stiffness @ exact.ravel())[top]
    assert load.sum() == pytest.approx(stress * 0.8, rel=1e-9)
    found = structure.expand(spsolve(structure.stiffness.tocsc(), structure.gather(load)))
    return float(np.abs(found - exact.ravel()).max() / np.abs(exact).max())


@pytest.mark.slow
def test_the_patch_test_is_exact_where_a_finer_mesh_divides_the_sides() -> None:
    """Forces of the dependent nodes then are consistent with those of the face."""
    assert patch_error((2, 2, 1), (4, 4, 1), False) < 1e-12
    assert patch_error((2, 2, 1), (2, 2, 1), True) < 1e-12


@pytest.mark.slow
def test_the_patch_test_of_other_meshes_has_an_error_of_first_order() -> None:
    """Node-to-surface ties transmit forces at nodes. Displacements next to the face are off by some percent, in
    proportion to the size of the elements. docs/ties.md gives these numbers."""
    linear, finer = patch_error((2, 2, 1), (3, 3, 1), False), patch_error((4, 4, 2), (6, 6, 2), False)
    assert linear == pytest.approx(0.0864, abs=5e-4)
    assert finer < 0.5 * linear
    assert patch_error((2, 2, 1), (3, 3, 1), True) == pytest.approx(0.0343, abs=5e-4)
    # the wrong way round: the coarser mesh follows the finer one
    assert patch_error((3, 3, 1), (2, 2, 1), False) > 2.0 * linear


def test_nodes_beyond_the_tolerance_and_on_the_face_itself_are_left_out() -> None:
    mesh = stacked((2, 2, 1), (3, 3, 1), gap=0.03)
    _, nodes = tied(mesh, tolerance=0.02)
    assert (len(nodes.nodes), len(nodes.untied)) == (0, 16)
    both = np.concatenate([mesh.node_set("above"), mesh.node_set("below")])
    of_both = tie_nodes(mesh.points, both, mesh.sides("below"), 0.05)
    assert len(of_both.nodes) == 16
    assert mean_edge(mesh.points, mesh.sides("below")) == pytest.approx(0.45)
    assert tie_nodes(mesh.points, both, mesh.sides("below")).tolerance == pytest.approx(0.05 * 0.45)


def test_a_node_that_follows_already_is_not_tied_again() -> None:
    mesh = stacked((2, 2, 1), (3, 3, 1))
    equations = Equations(mesh.n_nodes)
    nodes = tie_nodes(mesh.points, mesh.node_set("above"), mesh.sides("below"))
    assert add_tie(equations, equations.owner("first"), nodes) == 0
    count = len(equations.rows)
    assert add_tie(equations, equations.owner("second"), nodes) == 16
    assert len(equations.rows) == count == 48


def test_a_curved_quadratic_face_is_met_on_its_curve() -> None:
    """A quarter of a cylinder in 6 and 4 quadratic sides: nodes of one are within the height of the other's sides."""
    mesh = stacked((4, 1, 1), (6, 1, 1), True)
    angle, radius = 0.5 * np.pi * mesh.points[:, 0], 1.0 + mesh.points[:, 2]
    bent = np.column_stack([radius * np.sin(angle), mesh.points[:, 1], radius * np.cos(angle)])
    curved = Mesh(bent, mesh.cells, mesh.body, dict(mesh.node_sets))
    nodes = tie_nodes(bent, curved.node_set("above"), curved.sides("below"), 0.05)
    assert not nodes.untied.size
    assert 0.0 < nodes.distance.max() < 1e-3
    equations = Equations(curved.n_nodes)
    add_tie(equations, equations.owner("tie"), nodes)
    constraints = eliminate(equations)
    turned = np.cross([0.3, -0.5, 0.8], bent).ravel()
    np.testing.assert_allclose(constraints.transformation @ turned[constraints.free_unknowns], turned, atol=1e-12)
