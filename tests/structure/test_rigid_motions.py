import numpy as np
import pytest

from stickslip.structure.elasticity import Material, assemble_bodies
from stickslip.structure.finite_element_mesh import CellBlock, FiniteElementMesh
from stickslip.structure.mesh import CORNERS
from stickslip.structure.rigid_motions import part_motions

CUBE = (CORNERS + 1) / 2
NOTHING = np.empty(0, dtype=np.int64)


def cubes(*shifts):
    """Unit cubes at places, with one node where several have a corner."""
    points, position = np.unique(
        np.round(np.vstack([CUBE + shift for shift in shifts]), 9), axis=0, return_inverse=True
    )
    return FiniteElementMesh(
        points, (CellBlock("hexahedron", position.reshape(-1, 8), np.zeros(len(shifts), dtype=int)),)
    )


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
def test_motions_are_the_zero_eigenvalues_of_the_stiffness(shifts, parts, regions, strainless, held):
    mesh = cubes(*shifts)
    found = part_motions(mesh, held)
    assert len(found) == parts
    assert [part.n_regions for part in found] == regions
    assert [part.is_hinged for part in found] == [count > 6 for count in strainless]
    structure = assemble_bodies(mesh, [Material(3.0, 0.3, 2.0)], fixed_unknowns=held)
    eigenvalues = np.linalg.eigvalsh(structure.stiffness.toarray())
    assert sum(part.strainless for part in found) == (eigenvalues < 1e-9 * eigenvalues[-1]).sum()
    if not held.size:
        assert [part.strainless for part in found] == strainless
        assert [part.rigid for part in found] == [6] * parts


def test_a_clamped_part_has_no_motion():
    (part,) = part_motions(cubes((0, 0, 0), (1, 0, 0)), np.arange(12))
    assert (part.rigid, part.strainless, part.is_hinged) == (0, 0, False)
