from collections.abc import Sequence

import numpy as np
import pytest

from solid_cells import CORNERS
from stickslip.structure.elasticity import Material, assemble_bodies
from stickslip.structure.mesh import Mesh
from stickslip.structure.rigid_motions import part_motions

CUBE = (CORNERS + 1) / 2
NOTHING = np.empty(0, dtype=np.int64)


def cubes(*shifts: Sequence[float]) -> Mesh:
    """Unit cubes at places, with one node where several have a corner."""
    corners = np.vstack([CUBE + np.array(shift, dtype=float) for shift in shifts])
    points, position = np.unique(np.round(corners, 9), axis=0, return_inverse=True)
    return Mesh(points, position.reshape(-1, 8))


@pytest.mark.parametrize(
    ("shifts", "parts", "regions", "strainless"),
    [
        ([(0, 0, 0), (1, 0, 0)], 1, [1], [6]),
        ([(0, 0, 0), (3, 0, 0)], 2, [1, 1], [6, 6]),
        ([(0, 0, 0), (1, 1, 0)], 1, [2], [7]),  # a common edge is a hinge
        ([(0, 0, 0), (1, 1, 1)], 1, [2], [9]),  # a common corner is a ball joint
        ([(0, 0, 0), (1, 1, 0), (0, 2, 0), (-1, 1, 0)], 1, [4], [7]),  # a ring of four hinges
    ],
)
@pytest.mark.parametrize("held", [NOTHING, np.array([0, 1, 2])], ids=["free", "held"])
def test_motions_are_the_zero_eigenvalues_of_the_stiffness(
    shifts: list[tuple[float, float, float]], parts: int, regions: list[int], strainless: list[int], held: np.ndarray
) -> None:
    mesh = cubes(*shifts)
    actual = part_motions(mesh, held)
    assert len(actual) == parts
    assert [part.n_regions for part in actual] == regions
    assert [part.is_hinged for part in actual] == [count > 6 for count in strainless]
    structure = assemble_bodies(mesh, [Material(3.0, 0.3, 2.0)], fixed_unknowns=held)
    eigenvalues = np.linalg.eigvalsh(structure.stiffness.toarray())
    assert sum(part.strainless for part in actual) == (eigenvalues < 1e-9 * eigenvalues[-1]).sum()
    if not held.size:
        assert [part.strainless for part in actual] == strainless
        assert [part.rigid for part in actual] == [6] * parts


def test_a_clamped_part_has_no_motion() -> None:
    (part,) = part_motions(cubes((0, 0, 0), (1, 0, 0)), np.arange(12))
    assert (part.rigid, part.strainless, part.is_hinged) == (0, 0, False)


def slab_with_tetrahedra(columns: int) -> Mesh:
    """A slab of bricks, each with a tetrahedron on three of its upper nodes: each of these is a region of its own."""
    bricks = cubes(*((i, j, 0) for i in range(columns) for j in range(columns)))
    cells = bricks.blocks[0].cells
    apex = len(bricks.points) + np.arange(len(cells))
    tops = bricks.points[cells[:, 4:]].mean(axis=1) + np.array([0.0, 0.0, 1.0])
    tetra = np.column_stack([cells[:, 4:7], apex])
    return Mesh(np.vstack([bricks.points, tops]), (cells, tetra))


def test_many_regions_are_no_hinges_by_themselves() -> None:
    (part,) = part_motions(slab_with_tetrahedra(15), NOTHING)
    assert (part.n_regions, part.rigid, part.strainless, part.is_hinged) == (226, 6, 6, False)


def test_many_hinges_are_found() -> None:
    chain = cubes(*((i, i, 0) for i in range(250)))
    (part,) = part_motions(chain, NOTHING)
    assert (part.n_regions, part.rigid, part.strainless) == (250, 6, 6 + 249)
    assert part.is_hinged
