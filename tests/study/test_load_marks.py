"""Arrows of loads in the picture of the structure: distributed loads by their resultants."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from own_cases import EXAMPLE, mesh_case
from stickslip.case.load import load_case
from stickslip.model.model import kind_of, set_up
from stickslip.study.load_marks import distributed_marks, force_marks


def test_pressure_and_gravity_of_a_study_have_one_arrow_each(tmp_path: Path) -> None:
    loads = """
[preload]
method = "solved"
[pressures.end]
set = "tip"
pressure = "2 MPa"
[gravity]
direction = [0, 0, -2]
"""
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8").replace('normal_load = "40 N"\n', "")
    study = tmp_path / "study.toml"
    study.write_text(text.replace("beam_and_block.inp", str(EXAMPLE / "beam_and_block.inp")) + loads, encoding="utf-8")
    case = load_case(study)
    setup, kind = set_up(case), kind_of(case)
    mesh = setup.mesh  # type: ignore[attr-defined]
    forces = setup.layout.distributed_forces(kind.load_sizes(case))
    marks = {mark.name: mark for mark in distributed_marks(forces, mesh.points)}
    assert set(marks) == {"end", "gravity"}
    assert all(mark.is_constant for mark in marks.values())
    tip = mesh.points[mesh.node_set("tip")]
    area = np.ptp(tip[:, 1]) * np.ptp(tip[:, 2])
    np.testing.assert_allclose(marks["end"].vector, [-2e6 * area, 0.0, 0.0], atol=1e-9 * 2e6 * area)
    middle = 0.5 * (tip.min(axis=0) + tip.max(axis=0))
    nearest = np.linalg.norm(tip - middle, axis=1).min()
    assert np.linalg.norm(marks["end"].group.mean_place(mesh.points) - middle) == pytest.approx(nearest)
    down = marks["gravity"].vector
    assert down[2] < 0.0
    assert down[:2] == pytest.approx([0.0, 0.0])
    assert marks["gravity"].group.mean_place(mesh.points)[2] == mesh.points[:, 2].max()


def test_opposite_pressures_have_an_arrow_each() -> None:
    clamped = np.zeros((5, 3))
    clamped[:2, 2], clamped[2:4, 2] = -3.0, 3.0
    places = np.array([[x, 0.0, z] for x, z in ((0.0, 2.0), (1.0, 2.0), (0.0, 0.0), (1.0, 0.0), (0.5, 1.0))])
    below, above = sorted(distributed_marks({"pressures.bolt": clamped}, places), key=lambda mark: mark.vector[2])
    assert (below.name, above.name) == ("bolt", "bolt")
    assert below.vector.tolist() == [0.0, 0.0, -6.0]
    assert above.vector.tolist() == [0.0, 0.0, 6.0]
    assert below.group.nodes[0] in (0, 1)
    assert above.group.nodes[0] in (2, 3)


def test_a_pressure_in_a_bore_has_arrows_all_round() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False) + 0.001
    radial = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    marks = list(distributed_marks({"pressures.bore": radial}, radial))
    assert len(marks) == 4
    sums = np.array([mark.vector for mark in marks])
    assert np.linalg.norm(sums, axis=1) == pytest.approx(np.full(4, 100.0 * np.sqrt(8.0) / np.pi), rel=1e-3)
    np.testing.assert_allclose(sums.sum(axis=0), radial.sum(axis=0), atol=1e-9)


def test_loads_of_zero_have_no_arrow() -> None:
    assert not list(distributed_marks({"rotation": np.zeros((4, 3))}, np.zeros((4, 3))))
    case = mesh_case()
    layout, forces = set_up(case).layout, kind_of(case).forces(case)
    assert [mark.name for mark in force_marks(layout, forces, is_constant=False)] == ["push"]
    idle = tuple(type(force)(force.node_group, force.direction, 0.0) for force in forces)
    assert not list(force_marks(layout, idle, is_constant=False))
