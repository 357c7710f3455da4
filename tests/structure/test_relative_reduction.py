"""A joint in the relative displacements of its pairs: the same structure as with both sides of each pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.formats.matrices.exchange import write_superelement
from stickslip.model.layout import Layout, NodeGroup
from stickslip.model.study_structure import study_structure
from stickslip.solve.forced import forced_response
from stickslip.structure import relative_reduction
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.elasticity import Material, Structure
from stickslip.structure.joined import joined_modes
from stickslip.structure.mesh import Mesh
from stickslip.structure.recovery import reduced_load
from stickslip.structure.relative_model import RelativeModel
from stickslip.structure.relative_reduction import cached_relative_superelement, relative_superelement
from stickslip.structure.superelement import Superelement

OTHER = np.array([44, 31])  # nodes of the block that keep their displacements
ALL_MODES = 108 - 6 - 9  # unknowns of the block without those of the other nodes and of the pairs
SPRINGS = np.tile([2e9, 1e9, 3e9], 3)


def three_pairs(**changed: Any) -> FacePairs:
    """A node against a node, a node against a point between two, and a node against the ground, in oblique axes."""
    turned = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3, 3)))[0]
    given: dict[str, Any] = {
        "first_nodes": np.array([[40], [41], [38]]),
        "first_weights": np.ones((3, 1)),
        "second_nodes": np.array([[31, 0], [32, 33], [0, 0]]),
        "second_weights": np.array([[1.0, 0.0], [0.4, 0.6], [0.0, 0.0]]),
        "gap": np.zeros(3),
        "points": np.zeros((3, 3)),
        "area": np.ones(3),
        "tangent1": turned[:, 0],
        "tangent2": turned[:, 1],
        "normal": turned[:, 2],
        "face": np.zeros(3, dtype=np.int64),
        "face_position": np.arange(6.0).reshape(3, 2),
    }
    return FacePairs(**given | changed)


@pytest.fixture(scope="module")
def model(held_block: Structure) -> RelativeModel:
    found = RelativeModel.of(held_block, three_pairs(), OTHER)
    assert found is not None
    return found


def reduced(model: RelativeModel, n_modes: int) -> Superelement:
    return relative_superelement(model, three_pairs(), OTHER, n_modes)


def full_compliance(structure: Structure, omega: float) -> FloatArray:
    """``B (K + B^T k B - w^2 M)^-1 B^T`` of the full model."""
    operator = structure.of_unknowns(three_pairs().mesh_operator(structure.mesh.n_nodes)).toarray()
    dynamic = structure.stiffness.toarray() - omega**2 * structure.mass.toarray()
    return np.asarray(operator @ np.linalg.solve(dynamic + operator.T @ (SPRINGS[:, None] * operator), operator.T))


def compliance(superelement: Superelement, omega: float) -> FloatArray:
    """The same of a reduced one."""
    operator = superelement.operator(three_pairs())
    dynamic = superelement.stiffness - omega**2 * superelement.mass + operator.T @ (SPRINGS[:, None] * operator)
    return np.asarray(operator @ np.linalg.solve(dynamic, operator.T))


def test_relative_displacements_are_unknowns_and_no_motion_is_lost(held_block: Structure, model: RelativeModel) -> None:
    np.testing.assert_array_equal(model.own_nodes, [40, 41, 38])
    unknowns = np.random.default_rng(0).standard_normal(held_block.stiffness.shape[0])
    relative = three_pairs().mesh_operator(held_block.mesh.n_nodes) @ model.expand(unknowns)
    np.testing.assert_allclose(relative, unknowns[model.unknowns_of(model.own_nodes).ravel()], atol=1e-13)
    load = np.random.default_rng(1).standard_normal(held_block.full_size)
    assert model.gather(load) @ unknowns == pytest.approx(load @ model.expand(unknowns))
    before, after = (
        scipy.linalg.eigvalsh(each.stiffness.toarray(), each.mass.toarray()) for each in (held_block, model)
    )
    np.testing.assert_allclose(after, before, rtol=1e-9)


def test_the_static_compliance_of_the_pairs_is_exact_without_modes(held_block: Structure, model: RelativeModel) -> None:
    exact = full_compliance(held_block, 0.0)
    np.testing.assert_allclose(compliance(reduced(model, 0), 0.0), exact, atol=1e-10 * np.abs(exact).max())


@pytest.mark.slow
def test_the_compliance_converges_to_that_of_the_full_model(held_block: Structure, model: RelativeModel) -> None:
    """At 1500 Hz, above ten natural frequencies of the block (182 to 1450 Hz without contact)."""
    omega = 2.0 * np.pi * 1500.0
    exact = full_compliance(held_block, omega)
    errors = [
        np.abs(compliance(reduced(model, n_modes), omega) - exact).max() / np.abs(exact).max()
        for n_modes in (0, 20, 60, ALL_MODES - 1)
    ]
    assert (np.diff(errors) < 0.0).all()
    assert errors[1] < 3e-2
    assert errors[-1] < 1e-4


def test_matrices_are_the_projection_of_the_full_ones(held_block: Structure, model: RelativeModel) -> None:
    superelement = reduced(model, 5)
    assert superelement.size == 3 * 2 + 9 + 5
    motion = superelement.recovery @ np.eye(superelement.size)
    basis = motion[held_block.free_unknowns]
    for name in ("stiffness", "mass"):
        matrix = getattr(superelement, name)
        np.testing.assert_allclose(
            basis.T @ getattr(held_block, name) @ basis, matrix, atol=1e-10 * np.abs(matrix).max(), err_msg=name
        )
    relative = three_pairs().mesh_operator(held_block.mesh.n_nodes) @ motion
    np.testing.assert_allclose(relative, superelement.operator(three_pairs()), atol=1e-12)
    np.testing.assert_allclose(motion[3 * 31 + 1], superelement.selector(31, np.eye(3)[1]), atol=1e-12)
    load = np.random.default_rng(2).standard_normal(held_block.full_size)
    np.testing.assert_allclose(reduced_load(superelement, load), motion.T @ load, atol=1e-10)


def test_vibrations_on_the_mesh_are_displacements(held_block: Structure, model: RelativeModel) -> None:
    omega, superelement = 2.0 * np.pi * 200.0, reduced(model, 40)
    row = superelement.selector(44, (0.6, 0.0, 0.8))
    answer = np.linalg.solve(superelement.stiffness - omega**2 * superelement.mass, row)
    force = np.zeros(held_block.full_size)
    force[3 * 44 : 3 * 44 + 3] = 0.6, 0.0, 0.8
    dynamic = held_block.stiffness.toarray() - omega**2 * held_block.mass.toarray()
    exact = np.linalg.solve(dynamic, held_block.gather(force))
    motion = superelement.recovery.vibrating(answer[:, None], np.array([omega**2]))[:, 0]
    np.testing.assert_allclose(motion, exact, atol=1e-3 * np.abs(exact).max())


@pytest.mark.slow
def test_the_curve_is_that_with_both_sides(held_block: Structure, model: RelativeModel) -> None:
    """With all modes but one both reductions are nearly the full model: one pair sticks, one slips, one separates."""
    pairs, curves = three_pairs(), []
    both = craig_bampton(held_block, np.union1d(pairs.nodes, OTHER), 86)
    for superelement in (reduced(model, ALL_MODES - 1), both):
        joint = ContactPairs(superelement.operator(pairs), 3e9, 2e9, 0.3, np.array([900.0, 600.0, 10.0]))
        force = 400.0 * superelement.selector(44, (0.0, 0.6, 0.8))
        curves.append(
            forced_response(
                superelement, joint, force, frequency_hz=(180.0, 180.1), harmonics=3, samples=64,
                modal_damping_ratio=0.01, checks=False,
            )
        )  # fmt: skip
    assert set(curves[0].contact_state[0]) == set(curves[1].contact_state[0]) == {0, 1, 2}
    motions = [
        curve.displacement[0, superelement.unknowns_of(44)]
        for curve, superelement in zip(curves, (reduced(model, 1), both), strict=True)
    ]
    np.testing.assert_allclose(motions[0], motions[1], atol=1e-5 * np.abs(motions[1]).max())


def test_pairs_without_own_nodes_have_no_such_model(held_block: Structure) -> None:
    assert RelativeModel.of(held_block, three_pairs(), np.array([40, 31, 41])) is None
    shared = three_pairs(
        first_nodes=np.array([[40], [40], [38]]),
        second_nodes=np.array([[31, 32]] * 3),
        second_weights=np.array([[0.5, 0.5]] * 2 + [[0.0, 0.0]]),
    )
    assert RelativeModel.of(held_block, shared, OTHER) is None
    second = RelativeModel.of(held_block, three_pairs(), np.array([40]))
    assert second is not None
    np.testing.assert_array_equal(second.own_nodes, [31, 41, 38])


def test_pairs_on_constrained_nodes_are_rejected(held_block: Structure) -> None:
    with rejects(InputError, "nodes"):
        RelativeModel.of(held_block, three_pairs(first_nodes=np.array([[40], [41], [3]])), OTHER)


def test_other_pairs_and_formats_of_nodes_are_rejected(model: RelativeModel, tmp_path: Path) -> None:
    superelement = reduced(model, 2)
    with rejects(InputError, "pairs"):
        superelement.operator(three_pairs(first_nodes=np.array([[40], [41], [39]])))
    with rejects(InputError, "pairs"):
        superelement.operator(three_pairs(first_nodes=np.array([[40], [41], [1000]])))
    with rejects(InputError, "superelement"):
        write_superelement(tmp_path, superelement)


def test_the_reduction_is_read_from_the_disk(model: RelativeModel, monkeypatch: pytest.MonkeyPatch) -> None:
    first = cached_relative_superelement(model, three_pairs(), OTHER, 3)

    def fail(*_: object) -> None:
        raise AssertionError("computed twice")

    monkeypatch.setattr(relative_reduction, "relative_superelement", fail)
    second = cached_relative_superelement(model, three_pairs(), OTHER, 3)
    np.testing.assert_array_equal(second.mass, first.mass)
    motion = np.random.default_rng(3).standard_normal(first.size)
    np.testing.assert_allclose(second.recovery @ motion, first.recovery @ motion, atol=1e-12)
    np.testing.assert_array_equal(second.operator(three_pairs()), first.operator(three_pairs()))


@pytest.mark.long
def test_studies_reduce_large_joints_so(
    blade_mesh: Mesh,
    blade_structure: Structure,
    blade_superelement: Superelement,
    pairs_of: Callable[[Mesh], FacePairs],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two blades: tied and stuck frequencies as near to the full model as those of the reduction to both sides."""
    pairs = pairs_of(blade_mesh)
    names = ("excitation_left", "excitation_right", "response")
    groups = {name: NodeGroup.single(int(blade_mesh.node_set(name)[0])) for name in names}
    layout = Layout(pairs, ("left", "right"), ((Material(), Material()),) * 2, groups)
    bodies = study_structure(blade_structure)
    assert bodies.reduced_unknowns(layout, 30) == (blade_superelement.size - 30, 30)
    monkeypatch.setattr(relative_reduction, "LARGE_JOINT", 600)
    superelement = bodies.reduced(layout, 30).substructure.require_structure()
    assert sum(bodies.reduced_unknowns(layout, 30)) == superelement.size == 3 * (110 + 3) + 30
    full, _ = joined_modes(blade_structure, pairs, 6)
    tied, modes = joined_modes(superelement, pairs, 6)
    np.testing.assert_allclose(tied, full, rtol=1e-4)
    assert np.abs(pairs.mesh_operator(blade_mesh.n_nodes) @ modes).max() < 1e-10 * np.abs(modes).max()
    springs = pairs.springs(1e13, 1e13)
    of_both, _ = joined_modes(blade_superelement, pairs, 6, springs)
    np.testing.assert_allclose(joined_modes(superelement, pairs, 6, springs)[0], of_both, rtol=5e-4)
    assert replace(superelement, recovery=None).operator(pairs).shape == (330, superelement.size)
