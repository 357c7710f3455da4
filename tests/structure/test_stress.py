"""Stress from displacements: patch test, balance with the stiffness, bending, several bodies, and CalculiX."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calculix import ELEMENTS, blades, our_structure
from calculix_stress import calculix_stress, our_stress, rounded
from sentences import rejects
from solid_cells import PARTS
from stickslip.core.errors import InputError
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Material, Structure, assemble, assemble_bodies
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import jacobians, shape_functions, stiffness_rule, strain_matrix
from stickslip.structure.stress import cell_stress, nodal_stress

STEEL = Material()
KINDS = (*((kind, "incompatible") for kind in CELL_KINDS), ("hexahedron", "trilinear"))
GRADIENT = 1e-4 * np.array([[1.0, 0.4, -0.2], [0.3, -0.5, 0.7], [0.1, 0.6, 0.8]])


def bricks(shape: tuple[int, int, int], size: tuple[float, float, float]) -> Mesh:
    """A box of bricks with edges along the axes."""
    counts = [n + 1 for n in shape]
    axes = [np.linspace(0.0, length, n) for length, n in zip(size, counts, strict=True)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    number = np.arange(np.prod(counts)).reshape(counts)
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([number[a : a + shape[0], b : b + shape[1], c : c + shape[2]].ravel() for a, b, c in corner], 1)
    return Mesh(np.column_stack([x.ravel(), y.ravel(), z.ravel()]), cells)


def distorted(kind: str) -> Mesh:
    """Eight bricks with moved nodes, as they are or in cells of another kind, with straight edges."""
    mesh = bricks((2, 2, 2), (0.02, 0.03, 0.04))
    points = mesh.points + 1.5e-3 * np.random.default_rng(3).uniform(-1.0, 1.0, mesh.points.shape)
    shape = CELL_KINDS[kind].name.rstrip("0125")
    local = np.array(PARTS[shape])
    cells = mesh.bricks()[:, local].reshape(-1, local.shape[1])
    if not CELL_KINDS[kind].is_quadratic:
        return Mesh(points, cells)
    edges = np.sort(cells[:, CELL_KINDS[kind].edges], axis=2)
    unique, position = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(points) + position.reshape(len(cells), -1)
    return Mesh(np.vstack([points, points[unique].mean(axis=1)]), np.hstack([cells, middle]))


def structure_of(mesh: Mesh, hexahedron: str) -> Structure:
    return assemble_bodies(mesh, [STEEL] * (int(mesh.body.max()) + 1), hexahedron)  # type: ignore[arg-type]


@pytest.mark.parametrize(("kind", "hexahedron"), KINDS)
def test_a_linear_displacement_has_its_constant_stress_everywhere(kind: str, hexahedron: str) -> None:
    structure = structure_of(distorted(kind), hexahedron)
    displacement = (structure.mesh.points @ GRADIENT.T).reshape(-1, 1)
    strain = 0.5 * (GRADIENT + GRADIENT.T)
    voigt = np.array([*np.diag(strain), *(2.0 * strain[[0, 1, 2], [1, 2, 0]])])
    nodal = nodal_stress(structure, displacement)
    expected = np.broadcast_to(STEEL.elastic_matrix() @ voigt, (structure.mesh.n_nodes, 6))
    np.testing.assert_array_equal(nodal.node, np.arange(structure.mesh.n_nodes))
    np.testing.assert_allclose(nodal.stress[:, :, 0], expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize(("kind", "hexahedron"), KINDS)
def test_the_stress_balances_the_nodal_forces_of_the_stiffness(kind: str, hexahedron: str) -> None:
    """``sum of w |J| B^T s = K u`` for random displacements of distorted cells: also with incompatible modes, whose own
    forces are zero."""
    structure = structure_of(distorted(kind), hexahedron)
    cells = structure.mesh.blocks[0].cells
    displacement = 1e-5 * np.random.default_rng(4).normal(size=structure.full_size)
    points, weights = stiffness_rule(cells.shape[1])
    unknowns = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), -1)
    stress = cell_stress(structure, cells, 0, displacement[unknowns][:, :, None], points)[..., 0]
    force = np.zeros(structure.full_size)
    for place, (gradient, weight) in enumerate(zip(shape_functions(cells.shape[1], points)[1], weights, strict=True)):
        jacobian, determinant = jacobians(structure.mesh.points[cells], gradient)
        strain = strain_matrix(gradient @ np.linalg.inv(jacobian).swapaxes(1, 2))
        of_cell = np.einsum("m,mia,mi->ma", weight * determinant, strain, stress[:, place])
        np.add.at(force, unknowns, of_cell)
    exact = structure.stiffness @ displacement
    np.testing.assert_allclose(force, exact, atol=1e-11 * np.abs(exact).max())


def test_pure_bending_has_the_stress_of_beam_theory() -> None:
    """u = (x z, -nu y z, -(x^2 + nu (z^2 - y^2)) / 2) / R has s_xx = E z / R and no other stress; bricks with midside
    nodes contain it exactly, incompatible ones of constant Jacobian at the Gauss points."""
    curvature, ratio = 0.02, STEEL.poisson_ratio
    mesh = bricks((4, 1, 2), (0.08, 0.01, 0.02)).quadratic()
    x, y, z = mesh.points.T
    field = np.column_stack([x * z, -ratio * y * z, -0.5 * (x**2 + ratio * (z**2 - y**2))])
    nodal = nodal_stress(assemble(mesh, STEEL, "serendipity"), curvature * field.reshape(-1, 1))
    exact = np.zeros((mesh.n_nodes, 6))
    exact[:, 0] = STEEL.young_modulus * curvature * z
    np.testing.assert_allclose(nodal.stress[:, :, 0], exact[nodal.node], atol=1e-9 * np.abs(exact).max())


def test_a_node_of_two_bodies_has_a_stress_in_each() -> None:
    mesh = bricks((2, 1, 1), (0.02, 0.01, 0.01))
    bodies = Mesh(mesh.points, mesh.cells, body=np.array([0, 1]), body_names=("hard", "soft"))
    soft = replace(STEEL, young_modulus=0.5 * STEEL.young_modulus)
    structure = assemble_bodies(bodies, [STEEL, soft])
    nodal = nodal_stress(structure, (bodies.points @ GRADIENT.T).reshape(-1, 1))
    assert len(nodal.node) == bodies.n_nodes + 4
    shared = np.flatnonzero(np.bincount(nodal.node) == 2)
    for node in shared:
        hard_row, soft_row = np.flatnonzero(nodal.node == node)
        np.testing.assert_allclose(nodal.stress[soft_row], 0.5 * nodal.stress[hard_row], rtol=1e-9)
    largest = nodal.at_nodes(nodal.stress[:, 0, 0], bodies.n_nodes)
    assert largest[shared] == pytest.approx(nodal.stress[nodal.body == 0, 0, 0].max())


def test_wrong_input_is_rejected() -> None:
    structure = structure_of(bricks((1, 1, 1), (0.01, 0.01, 0.01)), "incompatible")
    with rejects(InputError, "displacement"):
        nodal_stress(structure, np.zeros((7, 1)))
    with rejects(InputError):
        nodal_stress(replace(structure, materials=()), np.zeros((24, 1)))
    with rejects(InputError, "fatigue_limit"):
        Material(fatigue_limit=6e8, tensile_strength=5e8)
    with rejects(InputError, "tensile_strength"):
        Material(tensile_strength=-1.0)


# Coefficients of CalculiX for the nodes have four to six digits; those of C3D6 are not the linear ones through its two
# points (1.1455 instead of (1 + sqrt(3)) / 2).
NODES = {"C3D8": 5e-5, "C3D20": 2e-5, "C3D10": 1e-5, "C3D4": 1e-6, "C3D15": 2e-5}


@pytest.mark.slow
@pytest.mark.parametrize("element", [element for element in ELEMENTS if element != "C3D8I"])
def test_calculix_has_the_same_stress_from_the_same_displacements(element: str, tmp_path: Path) -> None:
    """On the two blades in cells of each kind, with a smooth displacement and noise on it."""
    kind, formulation = ELEMENTS[element]
    mesh, _ = blades(kind)
    x, y, z = (mesh.points / 0.1).T
    field = np.column_stack([np.sin(2 * x + z) + 0.3 * y**2, np.cos(3 * y - z), x * y + np.sin(2 * z)])
    noise = np.random.default_rng(1).standard_normal(field.shape)
    displacement = rounded(1e-4 * field + 1e-6 * noise)
    at_points, at_nodes = calculix_stress(tmp_path, mesh, element, displacement)
    structure = our_structure(mesh, formulation)
    np.testing.assert_allclose(
        our_stress(structure, displacement), at_points, atol=1e-6 * np.abs(at_points).max(), rtol=0
    )
    if element in NODES:
        nodal = nodal_stress(structure, displacement[:, None])
        scale = np.abs(at_nodes).max()
        np.testing.assert_allclose(nodal.stress[..., 0], at_nodes[nodal.node], atol=NODES[element] * scale, rtol=0)


def test_incompatible_bricks_have_the_stress_of_calculix_where_the_formulations_agree(tmp_path: Path) -> None:
    """C3D8I has other incompatible modes in distorted bricks; in parallelepipeds both are those of Wilson."""
    sheared = np.array([[1.0, 0.2, 0.1], [0.0, 0.8, 0.3], [0.1, 0.0, 1.2]])
    mesh = bricks((3, 2, 2), (0.03, 0.02, 0.02))
    mesh = Mesh(mesh.points @ sheared, mesh.cells)
    displacement = rounded(1e-5 * np.random.default_rng(1).standard_normal(mesh.points.shape))
    at_points, _ = calculix_stress(tmp_path, mesh, "C3D8I", displacement)
    structure = assemble(mesh, STEEL)
    np.testing.assert_allclose(
        our_stress(structure, displacement), at_points, atol=1e-6 * np.abs(at_points).max(), rtol=0
    )
