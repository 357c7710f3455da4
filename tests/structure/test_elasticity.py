from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
import scipy.sparse.linalg

from sentences import rejects
from solid_cells import require_constant_strain
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure.elasticity import Element, Material, Structure, assemble, natural_frequencies
from stickslip.structure.joined import joined_modes
from stickslip.structure.mesh import Mesh

ELEMENTS = ("incompatible", "trilinear", "serendipity")
SOFT = Material(young_modulus=3.0, poisson_ratio=0.3, density=2.0)
# Beam theory knows no lateral contraction that a clamp could hinder.
BEAM = Material(young_modulus=3.0, poisson_ratio=0.0, density=2.0)


@pytest.mark.parametrize("element", ELEMENTS)
def test_patch_of_distorted_bricks_reproduces_constant_strain(
    make_block: Callable[..., Mesh], element: Element
) -> None:
    structure = assemble(make_block((3, 3, 3), (1.0, 1.0, 1.0), 0.15), SOFT, element)
    outer = structure.mesh.sides("all")[0]
    require_constant_strain(structure, structure.mesh.points, outer.ravel(), SOFT)


@pytest.mark.slow
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("counts", [(1, 1, 1), (3, 2, 2)])
def test_a_free_body_has_six_rigid_modes(
    make_block: Callable[..., Mesh], element: Element, counts: Sequence[int]
) -> None:
    structure = assemble(make_block(counts, (1.0, 1.2, 0.8), 0.15), SOFT, element)
    points = structure.mesh.points
    translations = np.stack([np.tile(axis, (len(points), 1)) for axis in np.eye(3)])
    rotations = np.stack([np.cross(axis, points) for axis in np.eye(3)])
    rigid = np.concatenate([translations, rotations]).reshape(6, -1).T
    stiffness = structure.stiffness.toarray()
    eigenvalues = np.linalg.eigvalsh(stiffness)
    np.testing.assert_allclose(eigenvalues[:6], 0.0, atol=1e-12 * eigenvalues[-1])
    assert eigenvalues[6] > 1e-4 * eigenvalues[-1]
    np.testing.assert_allclose(stiffness @ rigid, 0.0, atol=1e-12 * eigenvalues[-1])
    frequency_hz, _ = natural_frequencies(structure.stiffness, structure.mass, 8)
    assert frequency_hz[5] < 1e-3 * frequency_hz[6]


@pytest.mark.parametrize("element", ELEMENTS)
def test_mass_moves_rigidly(make_block: Callable[..., Mesh], element: Element) -> None:
    structure = assemble(make_block((2, 3, 2), (1.0, 2.0, 3.0)), SOFT, element)
    motion = np.tile([1.0, 2.0, 3.0], structure.mesh.n_nodes)
    assert motion @ structure.mass @ motion == pytest.approx(SOFT.density * 6.0 * 14.0)


def cantilever(make_block: Callable[..., Mesh], element: Element) -> Structure:
    """Slender beam 200 x 10 x 10 along x, one brick through its thickness and 10 along it."""
    mesh = make_block((10, 1, 1), (200.0, 10.0, 10.0))
    return assemble(mesh, BEAM, element, fixed_nodes=np.flatnonzero(mesh.points[:, 0] == 0.0))


@pytest.mark.parametrize(("element", "locks"), [("incompatible", False), ("trilinear", True)])
def test_bending_of_a_slender_cantilever(make_block: Callable[..., Mesh], element: Element, locks: bool) -> None:
    structure = cantilever(make_block, element)
    length, inertia, area = 200.0, 10.0**4 / 12.0, 100.0
    tip = np.flatnonzero(structure.mesh.points[:, 0] == length)
    load = np.zeros(structure.stiffness.shape[0])
    load[structure.unknowns_of(tip)[:, 2]] = 0.25
    deflection = (load @ scipy.sparse.linalg.spsolve(structure.stiffness.tocsc(), load)) / load.sum()
    shear = 2.0 * length / (5.0 / 6.0 * BEAM.young_modulus * area)
    timoshenko = length**3 / (3.0 * BEAM.young_modulus * inertia) + shear
    # One brick of this aspect through the thickness: without the modes less than half of the deflection is left.
    if locks:
        assert deflection < 0.5 * timoshenko
    else:
        assert deflection == pytest.approx(timoshenko, rel=0.004)


def test_cantilever_frequency_is_that_of_a_beam(make_block: Callable[..., Mesh]) -> None:
    structure = cantilever(make_block, "incompatible")
    frequency_hz, _ = natural_frequencies(structure.stiffness, structure.mass, 2)
    wave, length = 1.8751040687, 200.0
    beam = wave**2 / (2 * np.pi * length**2) * np.sqrt(BEAM.young_modulus * 10.0**2 / 12.0 / BEAM.density)
    np.testing.assert_allclose(frequency_hz, beam, rtol=0.01)


@pytest.mark.long
@pytest.mark.parametrize("element", ["incompatible", "trilinear"])
def test_frequencies_converge_with_the_square_of_the_element_size(
    make_block: Callable[..., Mesh], element: Element
) -> None:
    def first_elastic(name: Element, n: int) -> FloatArray:
        structure = assemble(make_block((n, n, n), (1.0, 0.8, 0.6)), SOFT, name)
        return natural_frequencies(structure.stiffness, structure.mass, 9)[0][6:]

    exact = first_elastic("serendipity", 6)
    sizes = np.array([4, 6, 8, 10])
    error = np.array([np.abs(first_elastic(element, n) / exact - 1.0) for n in sizes])
    slope = -np.polyfit(np.log(sizes), np.log(error), 1)[0]
    assert (slope > 1.8).all()
    assert (slope < 2.2).all()


@pytest.mark.long
@pytest.mark.parametrize(
    ("element", "column"),
    [
        ("incompatible", "incompatible_modes_tied_hz"),
        ("trilinear", "trilinear_tied_hz"),
        ("serendipity", "serendipity20_tied_hz"),
    ],
)
def test_ten_tied_frequencies_of_the_blade_pair(
    blade_mesh: Mesh,
    pairs_of: Callable[[Mesh], FacePairs],
    reference_frequencies: dict[str, FloatArray],
    element: Element,
    column: str,
) -> None:
    structure = assemble(blade_mesh, Material(), element)
    frequency_hz, _ = joined_modes(structure, pairs_of(structure.mesh), 10)
    np.testing.assert_allclose(frequency_hz, reference_frequencies[column], rtol=1e-4)
    # CalculiX: another formulation of incompatible modes (its C3D8I), the same 20-node element (its C3D20).
    independent = {"incompatible": ("calculix_c3d8i_hz", 1.1e-3), "serendipity": ("calculix_c3d20_hz", 1e-5)}
    if element in independent:
        name, tolerance = independent[element]
        np.testing.assert_allclose(frequency_hz, reference_frequencies[name], rtol=tolerance)


def test_dense_and_sparse_frequencies_agree(make_block: Callable[..., Mesh]) -> None:
    structure = assemble(make_block((3, 2, 2), (1.0, 0.7, 0.5)), SOFT, fixed_nodes=[0, 1, 2, 3])
    sparse, modes = natural_frequencies(structure.stiffness, structure.mass, 6)
    dense, dense_modes = natural_frequencies(structure.stiffness.toarray(), structure.mass.toarray(), 6)
    np.testing.assert_allclose(sparse, dense, rtol=1e-9)
    np.testing.assert_allclose(modes.T @ structure.mass @ modes, np.eye(6), atol=1e-9)
    np.testing.assert_allclose(modes, dense_modes, atol=1e-6 * np.abs(dense_modes).max())


@pytest.mark.slow
def test_fixed_nodes_come_from_the_set_or_from_the_caller(
    blade_mesh: Mesh, blade_structure: Structure, make_block: Callable[..., Mesh]
) -> None:
    np.testing.assert_array_equal(blade_structure.fixed_nodes, np.sort(blade_mesh.node_set("fixed")))
    assert blade_structure.stiffness.shape == (14751, 14751)
    block = make_block((1, 1, 1), (1.0, 1.0, 1.0))
    assert assemble(block, SOFT).stiffness.shape == (24, 24)
    held = assemble(block, SOFT, fixed_nodes=[2])
    np.testing.assert_array_equal(held.expand(np.ones(21)).reshape(-1, 3).sum(axis=1), [3, 3, 0, 3, 3, 3, 3, 3])
    with rejects(InputError, "nodes"):
        held.unknowns_of([1, 2])
    with rejects(InputError, "fixed_nodes"):
        assemble(block, SOFT, fixed_nodes=[8])


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"young_modulus": 0.0}, "young_modulus"),
        ({"young_modulus": np.nan}, "young_modulus"),
        ({"density": -7800.0}, "density"),
        ({"poisson_ratio": 0.5}, "poisson_ratio"),
        ({"poisson_ratio": np.inf}, "poisson_ratio"),
    ],
)
def test_a_bad_material_is_named(change: dict[str, Any], key: str) -> None:
    with rejects(InputError, key):
        Material(**change)


def test_an_element_that_does_not_suit_is_rejected(make_block: Callable[..., Mesh]) -> None:
    block = make_block((1, 1, 1), (1.0, 1.0, 1.0))
    wrong: Any = "hexahedron"
    with rejects(InputError, "element"):
        assemble(block, SOFT, wrong)
    with rejects(InputError, "element"):
        assemble(block.quadratic(), SOFT, "trilinear")


def test_negative_stiffness_and_bad_counts_are_rejected(make_block: Callable[..., Mesh]) -> None:
    structure = assemble(make_block((1, 1, 1), (1.0, 1.0, 1.0)), SOFT, fixed_nodes=[0, 1, 2, 3])
    with rejects(InputError, "count"):
        natural_frequencies(structure.stiffness, structure.mass, 12)
    with rejects(InputError):
        natural_frequencies(-structure.stiffness.toarray(), structure.mass.toarray(), 1)
