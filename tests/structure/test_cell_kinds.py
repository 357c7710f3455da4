"""Every kind of cell: sides, functions, patch test, mass, rigid motions, convergence."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from sentences import rejects
from solid_cells import PARTS, require_constant_strain
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Material, assemble_bodies, natural_frequencies
from stickslip.structure.faces import face_geometry
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import shape_functions, stiffness_rule

SOFT = Material(young_modulus=3.0, poisson_ratio=0.3, density=2.0)
KINDS = list(CELL_KINDS)


def block_of(
    kind_name: str,
    make_block: Callable[..., Mesh],
    counts: Sequence[int],
    lengths: Sequence[float] = (1.0, 1.0, 1.0),
    distortion: float = 0.0,
) -> Mesh:
    """A block of cells of one kind, with node set "all" and its six faces as node sets x0, x1, y0, ..."""
    linear = next(name for name in PARTS if kind_name.startswith(name))
    bricks = make_block(counts, lengths, distortion)
    (block,) = bricks.blocks
    cells = block.cells[:, PARTS[linear]].reshape(-1, len(PARTS[linear][0]))
    points, kind = bricks.points, CELL_KINDS[kind_name]
    if kind.is_quadratic:
        ends = np.sort(cells[:, kind.edges], axis=2)
        edges, position = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
        cells = np.hstack([cells, len(points) + position.reshape(len(cells), -1)])
        points = np.vstack([points, points[edges].mean(axis=1)])
    sets = {"all": np.arange(len(points))}
    if not distortion:
        for axis, name in enumerate("xyz"):
            for end, value in enumerate((0.0, lengths[axis])):
                sets[f"{name}{end}"] = np.flatnonzero(np.abs(points[:, axis] - value) < 1e-9)
    return Mesh(points, cells, node_sets=sets)


@pytest.mark.parametrize("name", KINDS)
def test_functions_are_one_at_their_node_and_reproduce_linear_fields(name: str) -> None:
    kind = CELL_KINDS[name]
    values, _ = shape_functions(kind.n_nodes, kind.nodes)
    np.testing.assert_allclose(values, np.eye(kind.n_nodes), atol=1e-13)
    points, _ = stiffness_rule(kind.n_nodes)
    values, gradients = shape_functions(kind.n_nodes, points)
    field = 2.0 + kind.nodes @ [1.0, -3.0, 0.5]
    np.testing.assert_allclose(values @ field, 2.0 + points @ [1.0, -3.0, 0.5])
    np.testing.assert_allclose(np.einsum("qka,k->qa", gradients, field), np.tile([1.0, -3.0, 0.5], (len(points), 1)))
    step = 1e-6
    for axis in range(3):
        move = step * np.eye(3)[axis]
        ahead, behind = (shape_functions(kind.n_nodes, points + sign * move)[0] for sign in (1, -1))
        np.testing.assert_allclose(gradients[:, :, axis], (ahead - behind) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("name", KINDS)
def test_sides_look_outwards_and_carry_their_midside_nodes(name: str) -> None:
    kind = CELL_KINDS[name]
    for side in kind.sides:
        corners = 3 if len(side) in (3, 6) else 4
        at = kind.nodes[side[:corners]]
        normal = np.cross(at[1] - at[0], at[2] - at[0])
        assert normal @ (at.mean(axis=0) - kind.nodes[: kind.n_corners].mean(axis=0)) > 0.0
        if kind.is_quadratic:
            np.testing.assert_allclose(kind.nodes[side[corners:]], 0.5 * (at + np.roll(at, -1, axis=0)))
    assert (kind.corner_jacobians(kind.nodes[None]) > 0.0).all()


@pytest.mark.parametrize("name", KINDS)
def test_patch_of_distorted_cells_reproduces_constant_stress(make_block: Callable[..., Mesh], name: str) -> None:
    mesh = block_of(name, make_block, (3, 3, 3), distortion=0.12)
    structure = assemble_bodies(mesh, [SOFT])
    require_constant_strain(
        structure, mesh.points, np.concatenate([sides.ravel() for sides in mesh.outer_sides()]), SOFT
    )


@pytest.mark.parametrize("name", KINDS)
def test_one_cell_has_six_rigid_modes_and_its_whole_mass(name: str) -> None:
    kind = CELL_KINDS[name]
    lengths = [1.0, 0.7, 0.4]
    mesh = Mesh(kind.nodes * lengths, np.arange(kind.n_nodes)[None])
    structure = assemble_bodies(mesh, [SOFT])
    eigenvalues = np.linalg.eigvalsh(structure.stiffness.toarray())
    np.testing.assert_allclose(eigenvalues[:6], 0.0, atol=1e-12 * eigenvalues[-1])
    assert eigenvalues[6] > 1e-5 * eigenvalues[-1]
    volume = np.prod(lengths) * {"t": 1 / 6, "w": 1.0, "h": 8.0}[name[0]]
    motion = np.tile([1.0, 0.0, 0.0], kind.n_nodes)
    assert motion @ structure.mass @ motion == pytest.approx(SOFT.density * volume, rel=1e-12)
    assert np.linalg.eigvalsh(structure.mass.toarray())[0] > 0.0


@pytest.mark.parametrize("name", KINDS)
def test_mass_of_a_turning_block_is_its_inertia(make_block: Callable[..., Mesh], name: str) -> None:
    mesh = block_of(name, make_block, (2, 2, 1), (1.0, 2.0, 0.5))
    structure = assemble_bodies(mesh, [SOFT])
    turning = np.cross([0.0, 0.0, 1.0], mesh.points).ravel()
    assert turning @ structure.mass @ turning == pytest.approx(SOFT.density * (1.0 + 4.0) / 3.0, rel=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "sizes", "slope"),
    [
        ("tetra", (3, 4, 6), (1.6, 2.3)),
        ("wedge", (3, 4, 6), (1.7, 2.3)),
        ("hexahedron", (3, 4, 6), (1.7, 2.3)),
        ("tetra10", (2, 3, 4), (2.8, 4.6)),
        ("wedge15", (1, 2, 3), (2.8, 4.6)),
        ("hexahedron20", (1, 2, 3), (2.8, 4.6)),
    ],
)
def test_frequencies_converge_with_the_order_of_the_cell(
    make_block: Callable[..., Mesh], name: str, sizes: tuple[int, ...], slope: tuple[float, float]
) -> None:
    def elastic(kind: str, n: int) -> FloatArray:
        structure = assemble_bodies(block_of(kind, make_block, (n, n, n), (1.0, 0.8, 0.6)), [SOFT], "trilinear")
        return natural_frequencies(structure.stiffness, structure.mass, 8)[0][6:]

    exact = elastic("hexahedron20", 5)
    error = np.array([np.abs(elastic(name, n) / exact - 1.0).mean() for n in sizes])
    actual = -np.polyfit(np.log(sizes), np.log(error), 1)[0]
    assert slope[0] < actual < slope[1]


@pytest.mark.parametrize("name", KINDS)
def test_face_areas_are_shared_among_the_nodes_and_look_outwards(make_block: Callable[..., Mesh], name: str) -> None:
    mesh = block_of(name, make_block, (2, 3, 2), (1.0, 2.0, 0.5))
    for axis, letter in enumerate("xyz"):
        for end, sign in ((0, -1.0), (1, 1.0)):
            _, area, normal = face_geometry(mesh, f"{letter}{end}")
            assert area.min() > 0.0
            assert area.sum() == pytest.approx(1.0 / [1.0, 2.0, 0.5][axis], rel=1e-12)
            np.testing.assert_allclose(normal, np.tile(sign * np.eye(3)[axis], (len(area), 1)), atol=1e-12)
    assert sum(len(sides) for sides in mesh.outer_sides(0)) == sum(len(sides) for sides in mesh.outer_sides())


def test_several_materials_and_single_constrained_directions(make_block: Callable[..., Mesh]) -> None:
    mesh = block_of("wedge", make_block, (2, 1, 1), (2.0, 1.0, 1.0))
    (block,) = mesh.blocks
    body = (mesh.points[block.cells].mean(axis=1)[:, 0] > 1.0).astype(int)
    mesh = Mesh(mesh.points, block.cells, body, mesh.node_sets, ("left", "right"))
    heavy = Material(3.0, 0.3, 10.0)
    structure = assemble_bodies(mesh, [SOFT, heavy], fixed_nodes=[0], fixed_unknowns=[3 * 5 + 1, 1])
    assert structure.mass.shape == (3 * mesh.n_nodes - 4,) * 2
    np.testing.assert_array_equal(structure.fixed_unknowns, [0, 1, 2, 16])
    whole = assemble_bodies(mesh, [SOFT, heavy])
    assert whole.mass[::3, ::3].sum() == pytest.approx(2.0 + 10.0)
    with rejects(InputError, "nodes"):
        structure.unknowns_of([4, 5])
    with rejects(InputError, "nodes"):
        structure.unknowns_of([0])
    with rejects(InputError, "materials"):
        assemble_bodies(mesh, [SOFT])
    with rejects(InputError, "fixed_unknowns"):
        assemble_bodies(mesh, [SOFT, heavy], fixed_unknowns=[36])
