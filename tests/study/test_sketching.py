"""From a study to its sketch: bodies, contact, loads, responses and constraints of the three kinds of structures."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.spatial import KDTree

from castings import casting_case
from own_cases import EXAMPLE, mesh_case
from stickslip.case.case import Case, TwoBladeCase
from stickslip.case.load import load_case
from stickslip.core.validation import FloatArray
from stickslip.model.model import Model, build_model, kind_of, load_joint, set_up
from stickslip.model.study_structure import study_structure
from stickslip.results.response import ForcedResponse
from stickslip.results.sketch import Sketch
from stickslip.structure.elasticity import Structure
from stickslip.structure.superelement import Superelement
from stickslip.study import sketching
from stickslip.study.sketching import MeshMotion, make_sketch, motion_at_peak
from sweep_cases import COARSE_MESH

TETRAHEDRA = EXAMPLE.parent / "two_blades_gmsh" / "study.toml"


def sketch_of(case: Case) -> Sketch:
    setup, kind = set_up(case), kind_of(case)
    structure = setup.assemble()
    assert isinstance(structure, Structure)
    loads = kind.forces(case), kind.static_forces(case)
    distributed = setup.layout.distributed_forces(kind.load_sizes(case))
    return make_sketch(
        structure.mesh, setup.layout, structure.fixed_unknowns, *loads, kind.outputs(case)[0], distributed
    )


def areas(sketch: Sketch) -> np.ndarray:
    """(m, 3) m2 along the outward normals."""
    corner = sketch.points[sketch.sides]
    return 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])


def two_blades(element: str) -> Callable[[], Case]:
    return lambda: casting_case().replace(COARSE_MESH | {"geometry.excitation_height": "9 mm", "mesh.element": element})


@pytest.mark.slow
@pytest.mark.parametrize("case", [two_blades("incompatible"), two_blades("serendipity"), lambda: load_case(TETRAHEDRA)])
def test_the_contact_faces_of_the_blades_are_where_the_drawing_says(case: Callable[[], Case]) -> None:
    """Bricks, bricks with midside nodes and quadratic tetrahedra whose faces do not match."""
    sketch = sketch_of(case())
    blades = Case()
    assert isinstance(blades, TwoBladeCase)
    vectors, geometry = areas(sketch), blades.geometry
    assert geometry is not None
    expected = geometry.contact_face_width * geometry.damper_length
    slope = np.array([np.sin(geometry.platform_angle), 0.0, np.cos(geometry.platform_angle)])
    for face, side in ((0, -1.0), (1, 1.0)):
        outwards = slope * [side, 1.0, 1.0]
        of_damper = (sketch.face == face) & (sketch.body == 2)
        of_blade = (sketch.face == face) & (sketch.body == face)
        assert vectors[of_damper].sum(axis=0) == pytest.approx(expected * outwards, abs=1e-9)
        assert vectors[of_blade].sum(axis=0) == pytest.approx(-expected * outwards, abs=1e-9)
        assert ((sketch.face == face) == (of_damper | of_blade)).all()
    assert sketch.mesh_sides == len(sketch.sides)
    height = sketch.points[sketch.held][:, 2]
    assert height.size > 8
    assert height == pytest.approx(0.0, abs=1e-12)


def test_places_of_the_blades() -> None:
    sketch = sketch_of(two_blades("incompatible")())
    assert sketch.body_names == ("left blade", "right blade", "damper")
    assert sketch.load_names == ("excitation left",)  # the other force is zero in this mode
    assert sketch.loads == pytest.approx(np.array([[300.0, 0.0, 0.0]]))
    assert sketch.load_places[0, 2] == pytest.approx(9e-3, abs=5e-3)
    assert sketch.load_places[0, 0] == pytest.approx(sketch.points[:, 0].min(), rel=0.3)
    assert sketch.response_names == ("blade tip A", "damper left x, y, z", "damper right x, y, z")
    assert sketch.response_places[0, 2] == pytest.approx(sketch.points[:, 2].max())
    opposed = sketch_of(two_blades("incompatible")().replace({"excitation.mode": "opposite"}))
    assert opposed.loads[:, 0].tolist() == [300.0, -300.0]


def test_a_preload_that_is_solved_shows_its_constant_loads() -> None:
    solved = two_blades("incompatible")().replace({"preload.method": "solved"})
    sketch = sketch_of(solved)
    assert isinstance(solved, TwoBladeCase)
    assert sketch.constant.tolist() == [False, True, True]
    assert sketch.load_names[1:] == ("damper front edge", "damper back edge")
    assert sketch.loads[1:].sum(axis=0) == pytest.approx([0.0, 0.0, solved.preload.centrifugal_force])


@pytest.mark.slow
def test_only_the_part_of_a_face_that_has_pairs_is_contact() -> None:
    """The block stands on a part of the beam's upper face; its other face is on the ground."""
    sketch = sketch_of(mesh_case())
    assert sketch.body_names == ("beam", "damper")
    on_beam = sketch.points[sketch.sides[(sketch.face == 0) & (sketch.body == 0)]].mean(axis=1)
    block = sketch.points[np.unique(sketch.sides[sketch.body == 1])]
    upper = (areas(sketch)[:, 2] > 0.0) & (sketch.body == 0)
    assert 0 < len(on_beam) < 0.6 * upper.sum()
    assert on_beam[:, 0].min() > block[:, 0].min() - 3e-3
    assert set(sketch.body[sketch.face == 1]) == {1}
    assert sketch.load_names == ("push",)
    assert sketch.response_names == ("tip", "block")
    assert sketch.load_places[0] == pytest.approx(sketch.response_places[0])  # one set


@pytest.mark.slow
def test_quadrature_marks_the_same_faces() -> None:
    nodes, points = (sketch_of(mesh_case(interfaces__sole__points=kind)) for kind in ("nodes", "quadrature"))
    of_block = nodes.body == 1
    np.testing.assert_array_equal(nodes.face[of_block], points.face[of_block])


@pytest.fixture(scope="module")
def shaken() -> tuple[Sketch, Case, Model, FloatArray]:
    """A sketch with the motion of a mesh whose displacements are those of a response at its second point."""
    case = mesh_case()
    setup = set_up(case)
    structure = setup.assemble()
    model = build_model(case, structure, load_joint(case, setup.layout))
    rng = np.random.default_rng(3)
    displacement = rng.normal(size=(3, model.superelement.size, 5)) * np.array([1.0, 3.0, 2.0])[:, None, None]
    response = SimpleNamespace(
        displacement=displacement,
        part=np.zeros(3, dtype=np.int64),
        frequency_hz=np.array([400.0, 410.0, 420.0]),
        amplitude=lambda row: np.array([1.0, 3.0, 2.0]),
    )
    motion = motion_at_peak(model, cast(ForcedResponse, response))
    sketch = sketching.sketch_of(case, model, motion)
    assert sketch is not None
    return sketch, case, model, displacement[1]


@pytest.mark.slow
def test_the_motion_is_that_of_the_mesh_at_the_highest_point(shaken: tuple[Sketch, Case, Model, FloatArray]) -> None:
    sketch, _, model, displacement = shaken
    assert sketch.motion is not None
    assert isinstance(model.structure, Structure)
    assert sketch.motion.frequency_hz == 410.0
    full = (model.superelement.recovery @ displacement).reshape(-1, 3, 5)
    mesh = model.structure.mesh
    node = KDTree(mesh.points).query(sketch.points)[1]
    assert mesh.points[node] == pytest.approx(sketch.points)
    own = [np.isclose(mesh.points, point).all(axis=1).sum() == 1 for point in sketch.points]  # not where bodies meet
    assert sum(own) > 50
    np.testing.assert_allclose(sketch.motion.points[own], full[node[own]], rtol=1e-6, atol=1e-6 * abs(full).max())
    free = [axis for axis in range(3) if not sketch.motion.points[sketch.held][:, axis].any()]
    assert free == [0, 1, 2]  # held along all axes


def test_loads_and_responses_move_as_the_mean_of_their_nodes(shaken: tuple[Sketch, Case, Model, FloatArray]) -> None:
    sketch, case, model, displacement = shaken
    assert sketch.motion is not None
    rows = [model.outputs[name] for name in ("tip", "block")]
    for place, (reading, row) in enumerate(zip(kind_of(case).outputs(case)[0].values(), rows, strict=True)):
        along = np.asarray(reading.direction) @ sketch.motion.responses[place]
        np.testing.assert_allclose(along, row @ displacement, rtol=1e-5, atol=1e-5)
    node_group = model.joint.layout.node_groups[kind_of(case).forces(case)[0].node_group]
    full = (model.superelement.recovery @ displacement).reshape(-1, 3, 5)
    expected = sum(share * full[node] for share, node in zip(node_group.weights, node_group.nodes, strict=True))
    np.testing.assert_allclose(sketch.motion.loads[0], expected, rtol=1e-5, atol=1e-5)


def test_matrices_have_no_motion() -> None:
    model = SimpleNamespace(in_study=study_structure(Superelement(np.eye(3), np.eye(3))))
    assert motion_at_peak(cast(Model, model), cast(ForcedResponse, None)) is None


def test_a_large_mesh_is_drawn_coarser(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sketch_of(two_blades("incompatible")())
    monkeypatch.setattr(sketching, "MOST_SIDES", 300)
    coarse = sketch_of(two_blades("incompatible")())
    assert coarse.is_coarsened
    assert len(coarse.sides) <= 300 < coarse.mesh_sides == len(whole.sides)
    assert set(coarse.face) == {-1, 0, 1}
    assert coarse.held.any()


@pytest.mark.parametrize(("columns", "kept"), [((), 1), ((0,), 1), ((1,), 3), ((2,), 3), ((0, 3), 5), ((6,), 7)])
def test_a_motion_has_coefficients_up_to_its_highest_harmonic(columns: tuple[int, ...], kept: int) -> None:
    displacement = np.zeros((6, 7))
    displacement[4, list(columns)] = -1.0
    motion = MeshMotion(displacement, 100.0)
    np.testing.assert_array_equal(motion.own_coefficients, displacement[:, :kept])
