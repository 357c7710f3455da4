"""Pairs along a line: lengths, normals, crown, and lines that do not fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sentences import rejects
from stickslip.contact.pairing.line_pairs import node_lengths, pair_lines
from stickslip.core.errors import InputError
from stickslip.model.kinds.damper_shapes import Cylinder
from stickslip.model.kinds.two_blade_geometry import BladePairElements, BladePairGeometry
from stickslip.model.kinds.two_blade_mesh import blade_pair_mesh
from stickslip.structure.mesh import Mesh

LEFT = ("damper_left_face", "left_face")
NORMAL = (-0.5, 0.0, np.sqrt(0.75))


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    counts = BladePairElements(1, 4, 2, 6, 1, 3, chordwise=4, damper_columns=2, damper_flank_rows=1)
    return blade_pair_mesh(BladePairGeometry(damper=Cylinder(6.6e-3)), counts)


@pytest.mark.parametrize("quadratic", [False, True])
def test_pairs_divide_the_strip(mesh: Mesh, quadratic: bool) -> None:
    mesh = mesh.quadratic() if quadratic else mesh
    pairs = pair_lines(mesh, *LEFT, NORMAL, 1e-4, drop=2e-6)
    assert pairs.n_pairs == (9 if quadratic else 5)
    assert pairs.area.sum() == pytest.approx(28e-3 * 1e-4)
    np.testing.assert_allclose(pairs.normal, [NORMAL] * pairs.n_pairs)
    assert (np.diff(pairs.points[:, 1]) > 0.0).all()
    np.testing.assert_allclose(pairs.gap, 2e-6 * (pairs.points[:, 1] / 14e-3) ** 2, atol=1e-20)
    np.testing.assert_allclose(mesh.points[pairs.first_node], mesh.points[pairs.second_node], atol=1e-15)


def test_lengths_are_those_of_a_uniform_load() -> None:
    """The load of elements with a linear or a quadratic displacement does the work of a uniform one."""
    position = np.array([0.0, 0.5, 1.0, 2.0, 3.0])
    assert node_lengths(position, has_midside_nodes=False) == pytest.approx([0.25, 0.5, 0.75, 1.0, 0.5])
    lengths = node_lengths(position, has_midside_nodes=True)
    for power in range(3):
        assert lengths @ position**power == pytest.approx(3.0 ** (power + 1) / (power + 1))


def test_lines_that_do_not_fit(mesh: Mesh) -> None:
    with rejects(InputError, "first_set", "second_set"):
        pair_lines(mesh, "damper_left_face", "right_face", NORMAL, 1e-4)
    with rejects(InputError, "first_set", "second_set"):
        pair_lines(mesh, "damper_left_mid", "left_face", NORMAL, 1e-4)
    moved = mesh.points.copy()
    moved[mesh.node_set("left_face")[2], 2] += 1e-5
    with rejects(InputError, "first_set", "second_set"):
        pair_lines(replace(mesh, points=moved), *LEFT, NORMAL, 1e-4)
