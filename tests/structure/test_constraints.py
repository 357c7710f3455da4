"""Equations between displacements: elimination against dense algebra, rigid motions, reference nodes, and limits."""

from collections.abc import Iterable

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.structure.constraints import Constraints, eliminate
from stickslip.structure.elasticity import Material, assemble_bodies, natural_frequencies
from stickslip.structure.equations import DependsTwice, Equations, add_distributing, add_rigid
from stickslip.structure.mesh import Mesh

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
MOVED, TURNED = [24, 25, 26], [27, 28, 29]


def columns(nodes: Iterable[int]) -> np.ndarray:
    """Unknowns (k, 3) of nodes."""
    return 3 * np.array([*nodes])[:, None] + np.arange(3)


def with_reference(n_nodes: int = 8) -> Equations:
    """Equations of a mesh with one reference node that has displacements and rotations."""
    equations = Equations(n_nodes)
    for axis in range(6):
        equations.unknown((99, axis), 1.0)
    return equations


def written(equations: Equations, *rows: dict[int, float]) -> Equations:
    """The same with rows {unknown: coefficient}, the first unknown dependent."""
    owner = equations.owner("rows")
    for row in rows:
        equations.add(row.items(), next(iter(row)), owner)
    return equations


def residual(equations: Equations, constraints: Constraints) -> float:
    """Largest left side of the equations of the mesh for ``u = T q``, for each q."""
    rows = np.zeros((len(equations.rows), constraints.size))
    for at, row in enumerate(equations.rows):
        for unknown, coefficient in row.terms.items():
            rows[at, unknown] = coefficient
    return float(np.abs(rows @ constraints.transformation.toarray()).max())


def test_random_equations_have_the_null_space_of_dense_algebra() -> None:
    """T spans the null space of all equations, also of chains, cycles and equations that follow from others."""
    random = np.random.default_rng(3)
    rows = [
        dict(zip(random.choice(24, 4, replace=False).tolist(), random.normal(size=4), strict=True)) for _ in range(9)
    ]
    rows.append({key: 2.0 * value for key, value in rows[0].items()})  # follows from the first
    equations = Equations(8)
    owner = equations.owner("rows")
    for row in rows:
        equations.add(row.items(), -1, owner)
    constraints = eliminate(equations, [0, 5])
    dense = np.zeros((12, 24))
    for at, row in enumerate(rows):
        dense[at, list(row)] = list(row.values())
    dense[10, 0] = dense[11, 5] = 1.0
    assert constraints.n_redundant == 1
    assert len(constraints.free_unknowns) == 24 - np.linalg.matrix_rank(dense)
    assert residual(equations, constraints) < 1e-12
    tie = constraints.transformation.toarray()
    np.testing.assert_array_equal(tie[constraints.free_unknowns], np.eye(len(constraints.free_unknowns)))
    np.testing.assert_allclose(tie[[0, 5]], 0.0, atol=1e-15)


def test_chains_follow_their_last_leader_and_cycles_are_solved() -> None:
    equations = written(Equations(8), {0: 1.0, 3: -2.0}, {3: 1.0, 6: -3.0}, {6: 1.0, 9: -1.0})
    constraints = eliminate(equations)
    assert constraints.dependent_unknowns.tolist() == [0, 3, 6]
    assert constraints.leaders(0).tolist() == [9]
    assert constraints.rows([0]).toarray()[0, 9] == pytest.approx(6.0)
    cycle = eliminate(written(Equations(8), {0: 1.0, 3: -2.0}, {3: 1.0, 0: -2.0}))  # only zero satisfies both
    assert not cycle.transformation[[0, 3]].nnz


def test_a_dependent_displacement_cannot_depend_twice() -> None:
    equations = written(Equations(8), {0: 1.0, 3: -1.0})
    with rejects(DependsTwice):
        written(equations, {0: 1.0, 6: -1.0})


def test_nodes_to_retain_lead_if_the_equation_has_another_unknown() -> None:
    equations = written(Equations(8), {0: 1.0, 3: -0.5, 6: -0.5})
    assert eliminate(equations).dependent_unknowns.tolist() == [0]
    assert eliminate(equations, avoided={0}).dependent_unknowns.tolist() == [3]
    assert eliminate(equations, avoided={0, 3}).dependent_unknowns.tolist() == [6]
    assert len(eliminate(equations, avoided={0, 3, 6}).dependent_unknowns) == 1


def test_a_fixed_leader_fixes_its_dependent() -> None:
    constraints = eliminate(written(Equations(8), {0: 1.0, 3: -1.0}), [3])
    assert 0 not in constraints.free_unknowns
    assert not constraints.dependent_unknowns.size


def test_a_rigid_body_has_the_motions_of_one() -> None:
    """Eight nodes on a rigid body have six free displacements, which move them as any rigid motion does."""
    equations = with_reference()
    origin = np.array([3.0, -1.0, 2.0])
    owner = equations.owner("rigid")
    add_rigid(equations, owner, columns(range(8)), CUBE, (origin, np.array(MOVED), np.array(TURNED)), np.eye(3))
    constraints = eliminate(equations)
    assert len(constraints.free_unknowns) == 6
    for moved, turned in zip(
        np.vstack([np.eye(3), np.zeros((3, 3))]), np.vstack([np.zeros((3, 3)), np.eye(3)]), strict=True
    ):
        motion = (moved + np.cross(turned, CUBE - origin)).ravel()
        np.testing.assert_allclose(constraints.transformation @ motion[constraints.free_unknowns], motion, atol=1e-12)
        own = [constraints.further[99, axis] for axis in range(6)]
        np.testing.assert_allclose(constraints.reference[own] @ motion, np.append(moved, turned), atol=1e-12)
    assert abs(constraints.transformation).max() < 3.0  # the three leading nodes are far apart


def test_a_distributing_coupling_follows_the_mean_and_the_rotation_of_least_squares() -> None:
    random = np.random.default_rng(5)
    weights, origin = random.uniform(0.5, 2.0, 8), np.array([0.2, 4.0, -1.0])
    equations = with_reference()
    reference = (origin, np.array(MOVED), np.array(TURNED))
    add_distributing(equations, equations.owner("mean"), columns(range(8)), CUBE, weights, reference)
    constraints = eliminate(equations)
    assert len(constraints.free_unknowns) == 24
    u = random.normal(size=24)
    answer = constraints.reference[[constraints.further[99, axis] for axis in range(6)]] @ u
    # least squares of u_i = a + theta x (x_i - x_r), with the weights
    design = np.vstack([np.hstack([np.eye(3), np.cross(np.eye(3), arm).T]) for arm in CUBE - origin])
    scale = np.sqrt(np.repeat(weights, 3))
    fitted, *_ = np.linalg.lstsq(scale[:, None] * design, scale * u, rcond=None)
    np.testing.assert_allclose(answer[3:], fitted[3:], atol=1e-12)
    # the displacement is that of the weighted mean, carried to the reference node: also the least squares solution
    np.testing.assert_allclose(answer[:3], fitted[:3], atol=1e-12)
    force = constraints.reference[[constraints.further[99, 1]]].toarray()[0].reshape(8, 3)
    np.testing.assert_allclose(force.sum(axis=0), [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(np.cross(CUBE - origin, force).sum(axis=0), 0.0, atol=1e-12)


@pytest.mark.parametrize(("nodes", "weights"), [([0, 1], [1.0, 1.0]), ([0, 1, 2], [0.0, 0.0, 0.0]), ([3], [1.0])])
def test_couplings_without_a_mean_or_a_rotation_are_rejected(nodes: list[int], weights: list[float]) -> None:
    equations = with_reference()
    reference = (np.zeros(3), np.array(MOVED), np.array(TURNED))
    with rejects(InputError):
        add_distributing(equations, 0, columns(nodes), CUBE[nodes], np.array(weights), reference)


def cubes() -> Mesh:
    """Two unit cubes, one above the other, with nodes of their own between them."""
    cell = np.array([0, 1, 3, 2, 4, 5, 7, 6])
    return Mesh(np.vstack([CUBE, CUBE + np.array([0.0, 0.0, 1.0])]), np.vstack([cell, cell + 8]), np.array([0, 1]))


def node_ties(mesh: Mesh) -> Equations:
    """Equations that connect the lower nodes of the second cube to the upper ones of the first."""
    equations = Equations(mesh.n_nodes)
    owner = equations.owner("ties")
    for lower, upper in zip(range(4, 8), range(8, 12), strict=True):
        for axis in range(3):
            equations.add([(3 * upper + axis, 1.0), (3 * lower + axis, -1.0)], 3 * upper + axis, owner)
    return equations


@pytest.mark.slow
def test_tied_nodes_are_those_of_a_mesh_that_shares_them() -> None:
    """Exact: the frequencies of two tied cubes are those of two cubes with common nodes, and six are zero."""
    mesh, material = cubes(), Material(1e9, 0.3, 1000.0)
    tied = assemble_bodies(mesh, [material] * 2, constraints=eliminate(node_ties(mesh)))
    number = np.append(np.arange(12), np.arange(12, 16))
    number[8:12] = np.arange(4, 8)
    kept = np.append(np.arange(8), np.arange(12, 16))
    place = np.full(16, -1)
    place[kept] = np.arange(12)
    merged = Mesh(mesh.points[kept], place[number[mesh.cells]])
    whole = assemble_bodies(merged, [material])
    own, other = (natural_frequencies(each.stiffness, each.mass, 12)[0] for each in (tied, whole))
    np.testing.assert_allclose(own[6:], other[6:], rtol=1e-9)
    assert own[:6].max() < 1e-3 * own[6]


def test_constraints_of_other_unknowns_are_rejected() -> None:
    mesh, material = cubes(), Material()
    with rejects(InputError, "constraints"):
        assemble_bodies(mesh, [material] * 2, fixed_nodes=[0], constraints=eliminate(node_ties(mesh)))
    with rejects(InputError, "constraints"):
        assemble_bodies(mesh, [material] * 2, constraints=eliminate(Equations(8)))


def test_dependent_nodes_have_no_unknowns_and_loads_go_to_their_leaders() -> None:
    mesh = cubes()
    structure = assemble_bodies(mesh, [Material()] * 2, constraints=eliminate(node_ties(mesh)))
    with rejects(InputError, "nodes"):
        structure.unknowns_of([8])
    load = np.zeros(48)
    load[3 * 8] = 7.0
    (place,) = np.flatnonzero(structure.gather(load))
    assert structure.free_unknowns[place] == 3 * 4
    assert isinstance(structure.constraints, Constraints)
    np.testing.assert_array_equal(structure.of_unknowns(load[None]), structure.gather(load)[None])
