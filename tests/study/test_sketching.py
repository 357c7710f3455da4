"""From a study to its sketch: bodies, contact, loads, responses and constraints of the three kinds of structures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from own_cases import EXAMPLE, mesh_case
from stickslip.case.case import Case, load_case
from stickslip.model.model import kind_of, set_up
from stickslip.results.sketch import Sketch
from stickslip.structure.elasticity import Structure
from stickslip.study import sketching
from stickslip.study.sketching import make_sketch
from sweep_cases import COARSE_MESH

TETRAHEDRA = EXAMPLE.parent / "two_blades_gmsh" / "study.toml"


def sketch_of(case: Case) -> Sketch:
    setup, kind = set_up(case), kind_of(case)
    structure = setup.assemble()
    assert isinstance(structure, Structure)
    loads = kind.forces(case), kind.static_forces(case)
    return make_sketch(structure.mesh, setup.layout, structure.fixed_unknowns, *loads, kind.outputs(case)[0])


def areas(sketch: Sketch) -> np.ndarray:
    """(m, 3) m2 along the outward normals."""
    corner = sketch.points[sketch.sides]
    return 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])


def two_blades(element: str) -> Callable[[], Case]:
    return lambda: Case().replace(COARSE_MESH | {"geometry.excitation_height": "9 mm", "mesh.element": element})


@pytest.mark.parametrize("case", [two_blades("incompatible"), two_blades("serendipity"), lambda: load_case(TETRAHEDRA)])
def test_the_contact_faces_of_the_blades_are_where_the_drawing_says(case: Callable[[], Case]) -> None:
    """Bricks, bricks with midside nodes and quadratic tetrahedra whose faces do not match."""
    sketch = sketch_of(case())
    vectors, geometry = areas(sketch), Case().geometry
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
    assert sketch.constant.tolist() == [False, True, True]
    assert sketch.load_names[1:] == ("damper front edge", "damper back edge")
    assert sketch.loads[1:].sum(axis=0) == pytest.approx([0.0, 0.0, solved.preload.centrifugal_force])


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


def test_quadrature_marks_the_same_faces() -> None:
    nodes, points = (sketch_of(mesh_case(interfaces__sole__points=kind)) for kind in ("nodes", "quadrature"))
    of_block = nodes.body == 1
    np.testing.assert_array_equal(nodes.face[of_block], points.face[of_block])


def test_a_large_mesh_is_drawn_coarser(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sketch_of(two_blades("incompatible")())
    monkeypatch.setattr(sketching, "MOST_SIDES", 300)
    coarse = sketch_of(two_blades("incompatible")())
    assert coarse.is_coarsened
    assert len(coarse.sides) <= 300 < coarse.mesh_sides == len(whole.sides)
    assert set(coarse.face) == {-1, 0, 1}
    assert coarse.held.any()
