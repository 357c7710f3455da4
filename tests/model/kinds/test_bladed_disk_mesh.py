"""The mesh of the parametric bladed disk: it is that of one sector, and its contact faces match across the boundary."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sentences import rejects
from stickslip.case.cyclic_sections import BladedDiskSection
from stickslip.contact.pairing.pairing import pair_surfaces
from stickslip.core.errors import InputError
from stickslip.model.kinds.bladed_disk_mesh import LEFT, RIGHT, BladedDisk
from stickslip.structure.model_facts import body_volumes, connected_parts
from stickslip.structure.sector_boundaries import cyclic_symmetry, with_next_sector


def disk(**changes: Any) -> BladedDisk:
    section = BladedDiskSection(kind="cyclic").model_dump(exclude={"kind"})
    return BladedDisk(**(section | changes))


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{}, {"sectors": 31, "contact_rows": 2}, {"platform_angle": 0.9}])
def test_the_damper_fits_both_platforms(changes: dict[str, Any]) -> None:
    own = disk(**changes)
    mesh = own.mesh()
    symmetry = cyclic_symmetry(mesh.points, mesh.node_set(LEFT), mesh.node_set(RIGHT))
    assert symmetry.sectors == own.sectors
    np.testing.assert_array_equal(symmetry.direction, [0.0, 0.0, 1.0])
    both = with_next_sector(mesh, symmetry)
    here = pair_surfaces(both, "damper here", "platform right").pairs
    ahead = pair_surfaces(both, "damper ahead", "next platform left").pairs
    for pairs in (here, ahead):
        assert pairs.n_pairs == (own.contact_rows + 1) * (own.contact_columns + 1)
        assert np.abs(pairs.gap).max() < 1e-12
        np.testing.assert_allclose(pairs.area.sum(), own.contact_face_width * own.width, rtol=1e-9)
    # the wedge is symmetric about the plane between the sectors, its faces at the platform angle from the radius
    radial = np.array([np.cos(own.half_angle), np.sin(own.half_angle), 0.0])
    np.testing.assert_allclose(here.normal @ radial, np.cos(own.platform_angle), atol=1e-9)
    np.testing.assert_allclose(ahead.normal @ radial, np.cos(own.platform_angle), atol=1e-9)


def test_bodies() -> None:
    own = disk()
    mesh = own.mesh()
    assert connected_parts([block.cells for block in mesh.blocks]).max() == 1
    across, up = own.face_extent
    section = 0.5 * across * up * 2.0 + own.platform_gap * up
    section += (2.0 * across + own.platform_gap) * own.damper_flank_height
    np.testing.assert_allclose(body_volumes(mesh)[1], section * own.width, rtol=1e-9)
    radius = np.linalg.norm(mesh.points[:, :2], axis=1)
    assert radius.min() == pytest.approx(own.bore_radius)
    assert mesh.points[:, 0].max() == pytest.approx(own.rim_radius + own.blade_length)


@pytest.mark.parametrize(
    ("key", "value"),
    [("rim_radius", 0.05), ("shank_thickness", 0.1), ("platform_height", 0.002), ("blade_length", 0.04)],
)
def test_parts_that_do_not_fit(key: str, value: float) -> None:
    with rejects(InputError, key):
        disk(**{key: value})
