"""Plate and cylinder below the platforms: volumes, positions, what does not fit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.model.kinds.damper_shapes import Cylinder, Plate, Wedge
from stickslip.model.kinds.plane_sections import sides_at
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh, sections
from stickslip.structure.model_facts import body_volumes

FLAT = BladePairGeometry(platform_angle_deg=0.0, damper=Plate(2e-3))
ROUND = BladePairGeometry(damper=Cylinder(6.6e-3))
SHAPES = [
    BladePairGeometry(),
    BladePairGeometry(platform_angle_deg=20.0, right_platform_angle_deg=45.0),
    FLAT,
    ROUND,
    BladePairGeometry(platform_angle_deg=40.0, right_platform_angle_deg=25.0, damper=Cylinder(5.5e-3)),
    BladePairGeometry(platform_angle_deg=60.0, damper=Cylinder(3e-3), damper_length=20e-3),
]


@pytest.mark.slow
@pytest.mark.parametrize("geometry", SHAPES)
@pytest.mark.parametrize("counts", [BladePairElements(), BladePairElements(damper_columns=3, damper_flank_rows=1)])
def test_the_mesh_has_the_volume_of_the_shape(geometry: BladePairGeometry, counts: BladePairElements) -> None:
    """Of the circle too: its polygon has the same area."""
    mesh = blade_pair_mesh(geometry, counts)
    assert body_volumes(mesh)[2] == pytest.approx(geometry.damper_volume, rel=1e-12)
    assert mesh.quadratic().n_cells == mesh.n_cells


def test_volumes_by_hand() -> None:
    assert FLAT.damper_volume == pytest.approx((2 * 6.5e-3 + 1e-3) * 2e-3 * 28e-3)
    assert ROUND.damper_volume == pytest.approx(math.pi * 6.6e-3**2 * 28e-3)
    run, rise = 6.5e-3 * math.cos(math.radians(30.0)), 6.5e-3 * math.sin(math.radians(30.0))
    wedge = run * rise + 1e-3 * rise + (2 * run + 1e-3) * 2.5e-3
    assert BladePairGeometry().damper_volume == pytest.approx(wedge * 28e-3)


@pytest.mark.slow
@pytest.mark.parametrize("geometry", [each for each in SHAPES if isinstance(each.damper, Cylinder)])
def test_a_cylinder_touches_both_slopes(geometry: BladePairGeometry) -> None:
    cylinder, roof = geometry.damper, geometry.roof
    assert isinstance(cylinder, Cylinder)
    centre = cylinder.centre(roof)
    for side, angle, contact in zip((-1.0, 1.0), roof.angles, cylinder.contacts(roof), strict=True):
        normal = np.array([side * math.sin(angle), math.cos(angle)])
        np.testing.assert_allclose(contact - centre, cylinder.radius * normal, atol=1e-15)
        upper = np.array([side * 0.5 * roof.gap, roof.height])
        assert (contact - upper) @ normal == pytest.approx(0.0, abs=1e-15)  # on the plane of the contact face
    mesh = blade_pair_mesh(geometry)
    for name, contact in zip(("left", "right"), cylinder.contacts(roof), strict=True):
        for line in (f"damper_{name}_face", f"{name}_face"):
            points = mesh.points[mesh.node_set(line)][:, [0, 2]]
            np.testing.assert_allclose(points, np.tile(contact, (11, 1)), atol=1e-15)
    for end in ("damper_front_edge", "damper_back_edge"):  # the static force acts through the axis
        assert mesh.points[mesh.node_set(end), 0].mean() == pytest.approx(centre[0], abs=1e-15)


def test_a_plate_lies_below_both_undersides() -> None:
    mesh = blade_pair_mesh(FLAT)
    for name in ("left", "right"):
        plate, blade = mesh.points[mesh.node_set(f"damper_{name}_face")], mesh.points[mesh.node_set(f"{name}_face")]
        np.testing.assert_allclose(np.sort(plate, axis=0), np.sort(blade, axis=0), atol=1e-15)
        np.testing.assert_allclose(plate[:, 2], FLAT.underside_height_at_shank)
    heights = mesh.points[mesh.nodes_of_body(2), 2]
    assert np.ptp(heights) == pytest.approx(2e-3)


def test_sides_at_a_contact_line() -> None:
    blade, _, damper = sections(ROUND, BladePairElements())
    along, _ = sides_at(blade, int(blade.sets["contact"][0]))
    assert along == pytest.approx(6.5e-3 / 4)
    _, deep = sides_at(damper, int(damper.sets["left"][0]))
    assert deep == pytest.approx(0.5 * (1.0 - 0.55) * 6.6e-3)


@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ({"damper": Cylinder(12e-3)}, ("radius", "contact_face_width", "platform_angle_deg", "platform_gap")),
        ({"damper": Cylinder(1.2e-3)}, ("radius", "contact_face_width", "platform_angle_deg", "platform_gap")),
        (
            {"damper": Cylinder(6.6e-3), "underside_height_at_shank": 9e-3, "excitation_height": 3e-3},
            ("radius", "inner_overhang", "underside_height_at_shank"),
        ),
        (
            {"damper": Cylinder(7.4e-3), "inner_overhang": 1e-4, "shank_thickness_at_base": 18e-3},
            ("radius", "inner_overhang", "underside_height_at_shank"),
        ),
    ],
)
def test_cylinders_that_do_not_fit(changes: dict[str, Any], keys: tuple[str, ...]) -> None:
    geometry = BladePairGeometry(**changes)
    with rejects(InputError, *keys):
        blade_pair_mesh(geometry)


@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ({"damper": Plate(2e-3)}, ("platform_angle_deg",)),
        ({"damper": Wedge(), "platform_angle_deg": 0.0}, ("platform_angle_deg",)),
        ({"damper": Cylinder(6e-3), "right_platform_angle_deg": 0.0}, ("right_platform_angle_deg",)),
        ({"damper": Plate(40e-3), "platform_angle_deg": 0.0}, ("thickness", "underside_height_at_shank")),
        ({"damper": "cylinder"}, ("damper",)),
    ],
)
def test_shapes_that_contradict_the_platforms(changes: dict[str, Any], keys: tuple[str, ...]) -> None:
    with rejects(InputError, *keys):
        BladePairGeometry(**changes)


@pytest.mark.parametrize("name", ["contact_columns", "damper_columns"])
def test_a_line_has_elements_on_both_sides(name: str) -> None:
    with rejects(InputError, name):
        blade_pair_mesh(ROUND, BladePairElements(**{name: 1}))


def test_sizes_of_shapes_are_above_zero() -> None:
    with rejects(InputError, "thickness"):
        Plate(0.0)
    with rejects(InputError, "radius"):
        Cylinder(-1e-3)
