from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse
from threadpoolctl import threadpool_limits

from calculix import cut_bricks
from sentences import rejects
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure import cache
from stickslip.structure import reduced_matrices as reduced_matrices_module
from stickslip.structure.craig_bampton import craig_bampton, reduction_table
from stickslip.structure.elasticity import Material, Structure, assemble_bodies, natural_frequencies
from stickslip.structure.mesh import Mesh
from stickslip.structure.recovery import partition
from stickslip.structure.superelement import Superelement


@pytest.mark.long
def test_blade_pair_has_699_unknowns(blade_mesh: Mesh, blade_superelement: Superelement) -> None:
    assert blade_superelement.size == 669 + 30
    assert blade_superelement.recovery.shape == (15015, 699)
    assert blade_superelement.boundary_nodes[-1] == blade_mesh.node_set("response")[0]


@pytest.mark.slow
def test_reduction_table_of_the_blade_pair(
    blade_mesh: Mesh,
    blade_structure: Structure,
    blade_superelement: Superelement,
    pairs_of: Callable[[Mesh], FacePairs],
) -> None:
    rows = reduction_table(blade_structure, blade_superelement, pairs_of(blade_mesh))
    difference = [row.difference_percent for row in rows]
    expected = [1.30e-4, 1.46e-4, 6.44e-4, 4.01e-4, 1.09e-2, 4.22e-3, 1.72e-4, 3.58e-4, 1.24e-1, 8.49e-2]
    np.testing.assert_allclose(difference, expected, rtol=0.1)
    assert min(row.mac for row in rows) == pytest.approx(0.999962, abs=2e-6)


@pytest.mark.slow
def test_stuck_frequencies_of_the_blade_pair(
    blade_mesh: Mesh,
    blade_structure: Structure,
    blade_superelement: Superelement,
    pairs_of: Callable[[Mesh], FacePairs],
    reference_frequencies: dict[str, FloatArray],
) -> None:
    pairs = pairs_of(blade_mesh)
    springs = pairs.springs(normal_per_area=1e14, tangential_per_area=8e13)
    rows = reduction_table(blade_structure, blade_superelement, pairs, count=11, springs=springs)
    expected = reference_frequencies["incompatible_modes_kn1e14_kt8e13_hz"]
    np.testing.assert_allclose([row.full_hz for row in rows[:10]], expected, rtol=1e-5)
    assert all(0.0 < row.difference_percent < 0.15 for row in rows[:10])
    assert [row.mode for row in rows] == list(range(1, 12))


def test_static_response_to_boundary_forces_is_exact(held_block: Structure) -> None:
    nodes = np.array([40, 20, 31])
    reduced = craig_bampton(held_block, nodes, n_modes=4)
    force = np.random.default_rng(0).standard_normal(9)
    full = np.zeros(held_block.stiffness.shape[0])
    full[held_block.unknowns_of(nodes).ravel()] = force
    exact = held_block.expand(np.linalg.solve(held_block.stiffness.toarray(), full))
    answer = np.linalg.solve(reduced.stiffness, np.append(force, np.zeros(4)))
    np.testing.assert_allclose(reduced.recovery @ answer, exact, atol=1e-10 * np.abs(exact).max())


@pytest.mark.slow
@pytest.mark.parametrize("n_modes", [0, 5])
@pytest.mark.parametrize("threads", [1, 2])
def test_a_large_boundary_reduced_by_blocks_gives_the_same_matrices(
    held_block: Structure, n_modes: int, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    stiffness, mass = held_block.stiffness, held_block.mass
    boundary, interior = partition(held_block, np.array([40, 20, 31, 22, 35]))
    skew = scipy.sparse.triu(stiffness, 1)
    matrices = stiffness, mass, 1e-3 * stiffness + 2.0 * mass

    def reduced() -> Any:
        return reduced_matrices_module.reduced_matrices(
            matrices, held_block.node, boundary, interior, n_modes, "superlu", threads, print, (skew - skew.T).tocsr()
        )

    whole = reduced()
    monkeypatch.setattr(reduced_matrices_module, "LARGE_BOUNDARY", 1)
    monkeypatch.setattr(reduced_matrices_module, "BLOCK", 4)
    blocks = reduced()
    for name in ("mass", "stiffness", "damping", "gyroscopic", "modes"):
        expected = getattr(whole, name)
        error = np.abs(getattr(blocks, name) - expected).max(initial=0.0)
        assert error <= 1e-12 * np.abs(expected).max(initial=1.0), name
    np.testing.assert_array_equal(blocks.mass, blocks.mass.T)
    load = np.random.default_rng(0).standard_normal(len(interior))
    np.testing.assert_allclose(blocks.factor.solve(load), whole.factor.solve(load), rtol=1e-9)


@pytest.mark.slow
def test_all_modes_give_the_full_model_and_more_modes_never_raise_a_frequency(held_block: Structure) -> None:
    nodes = np.array([40, 20])
    exact, _ = natural_frequencies(held_block.stiffness, held_block.mass, 5)
    previous = np.full(5, np.inf)
    for n_modes in (0, 5, 20, 60):
        reduced = craig_bampton(held_block, nodes, n_modes)
        actual, _ = natural_frequencies(reduced.stiffness, reduced.mass, 5)
        assert (actual <= previous * (1 + 1e-9)).all()
        assert (actual >= exact * (1 - 1e-9)).all()
        previous = actual
    np.testing.assert_allclose(previous, exact, rtol=1e-4)


def test_matrices_are_the_projection_of_the_full_ones(held_block: Structure) -> None:
    reduced = craig_bampton(held_block, [40, 20], 6)
    full = reduced.recovery @ np.eye(reduced.size)
    basis = full[held_block.free_unknowns]
    scale = np.abs(reduced.stiffness).max()
    np.testing.assert_allclose(basis.T @ held_block.stiffness @ basis, reduced.stiffness, atol=1e-9 * scale)
    np.testing.assert_allclose(basis.T @ held_block.mass @ basis, reduced.mass, atol=1e-9)
    np.testing.assert_allclose(reduced.mass[6:, 6:], np.eye(6), atol=1e-9)
    coordinate = reduced.selector(20, (0.0, 1.0, 0.0))
    np.testing.assert_array_equal(full[3 * 20 + 1], coordinate)


@pytest.mark.parametrize(
    ("nodes", "n_modes", "keys"),
    [
        ([], 5, ("boundary_nodes",)),
        ([20.5], 5, ("boundary_nodes",)),
        ([20, 45], 5, ("nodes",)),
        ([20, 20], 5, ("boundary_nodes",)),
        ([20, 3], 5, ("nodes",)),
        ([20], -1, ("n_modes",)),
        ([20], 105, ("n_modes",)),
    ],
)
def test_a_bad_boundary_or_mode_count_is_rejected(
    held_block: Structure, nodes: Any, n_modes: Any, keys: tuple[str, ...]
) -> None:
    with rejects(InputError, *keys):
        craig_bampton(held_block, nodes, n_modes)


@pytest.mark.slow
def test_a_boundary_that_leaves_the_damper_free_is_rejected(blade_mesh: Mesh, blade_structure: Structure) -> None:
    with rejects(InputError):
        craig_bampton(blade_structure, blade_mesh.node_set("left_face"))


@pytest.mark.slow
def test_table_needs_a_recovery(
    blade_mesh: Mesh, blade_structure: Structure, pairs_of: Callable[[Mesh], FacePairs]
) -> None:
    with rejects(InputError):
        reduction_table(blade_structure, Superelement(np.eye(3), np.eye(3)), pairs_of(blade_mesh))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["tetra10", "wedge15"])
def test_tetrahedra_and_wedges_are_reduced_and_kept(
    make_block: Callable[..., Mesh], kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A mesh of any cells: a reduction with all modes has the frequencies of the whole, from the folder too."""
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    mesh = cut_bricks(make_block((3, 1, 1), (3.0, 1.0, 1.0)), kind)
    ends = [np.flatnonzero(mesh.points[:, 0] == place) for place in (0.0, 3.0)]
    structure = assemble_bodies(mesh, [Material()], fixed_nodes=ends[0])
    whole_hz, _ = natural_frequencies(structure.stiffness, structure.mass, 4)
    actual = craig_bampton(structure, ends[1], 30)
    reduced_hz, shapes = natural_frequencies(actual.stiffness, actual.mass, 4)
    np.testing.assert_allclose(reduced_hz, whole_hz, rtol=1e-3)
    assert (actual.recovery @ shapes).shape == (3 * mesh.n_nodes, 4)
    calls = []

    def reduce() -> Superelement:
        calls.append(1)
        return craig_bampton(structure, ends[1], 30)

    retained = [cache.cached_superelement(structure, ends[1], 30, reduce) for _ in range(2)]
    assert len(calls) == 1
    np.testing.assert_array_equal(retained[0].stiffness, retained[1].stiffness)
    moved = assemble_bodies(replace(mesh, points=1.01 * mesh.points), [Material()], fixed_nodes=ends[0])
    cache.cached_superelement(moved, ends[1], 30, reduce)
    assert len(calls) == 2, "another mesh is reduced anew"


@pytest.mark.long
def test_the_reduction_is_the_same_with_any_number_of_threads(
    blade_structure: Structure, blade_superelement: Superelement
) -> None:
    """Bit for bit, whatever the threads of the linear algebra around it."""
    nodes = blade_superelement.boundary_nodes
    with threadpool_limits(limits=4):
        other = craig_bampton(blade_structure, nodes, 30, threads=4)  # the fixture has 1
    for name in ("mass", "stiffness"):
        assert np.array_equal(getattr(other, name), getattr(blade_superelement, name)), name
    assert np.array_equal(other.recovery.modes, blade_superelement.recovery.modes)


def test_the_sign_of_a_mode_does_not_hang_on_the_last_digit() -> None:
    """Two equal masses that move against each other: both components are equal but for round-off."""
    mass = np.eye(3)
    for last_digit in (-1e-12, 0.0, 1e-12):
        stiffness = np.array([[2.0 + last_digit, -1.0, 0.0], [-1.0, 2.0, 0.0], [0.0, 0.0, 9.0]])
        _, modes = natural_frequencies(stiffness, mass, 2)
        np.testing.assert_allclose(modes[:, 1], [np.sqrt(0.5), -np.sqrt(0.5), 0.0], atol=1e-9)
