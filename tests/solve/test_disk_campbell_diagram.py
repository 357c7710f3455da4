"""The Campbell diagram of a disk: waves, the engine orders that excite them, contact, figure and input errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sectors import SmallDisk
from sentences import rejects

SECTORS = 5
SPEEDS = np.linspace(300.0, 3300.0, 7)
DISK = SmallDisk.of(SECTORS, damped=False, whirls=True)


def sector_at(rpm: float) -> Any:
    """The small disk with Coriolis forces in proportion to its speed."""
    assert DISK.gyroscopic is not None
    return replace(DISK, gyroscopic=rpm / 3000.0 * DISK.gyroscopic).sector


@pytest.fixture(scope="module")
def diagram() -> Any:
    return ss.disk_campbell_diagram(sector_at, DISK.pairs, SPEEDS, count=4)


@pytest.mark.slow
def test_frequencies_are_those_of_each_wave_of_the_full_ring(diagram: Any) -> None:
    assert diagram.diameters == (0, 1, 2)
    for place, rpm in enumerate(SPEEDS.tolist()):
        sector = sector_at(rpm)
        for diameter in diagram.diameters:
            for direction in ("forward", "backward"):
                own = diagram.frequency_hz(diameter, direction, "free")[place]
                np.testing.assert_allclose(own, sector.natural_frequencies(diameter, 4, direction), rtol=1e-10)
    ring = ss.full_ring(sector_at(SPEEDS[-1]))
    joint = ring.joint(DISK.pairs)
    structure: Any = ring.superelement
    stuck = structure.stiffness + joint.operator.T @ (joint.resting_stiffness()[:, None] * joint.operator)
    size = structure.size
    first_order = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-np.linalg.solve(structure.mass, stuck), -np.linalg.solve(structure.mass, structure.gyroscopic)],
        ]
    )
    values = np.linalg.eigvals(first_order).imag
    expected = np.sort(values[values > 0.0])[:9] / (2.0 * np.pi)
    waves = [(0, "forward"), *((d, way) for d in (1, 2) for way in ("forward", "backward"))]
    found = np.sort(np.concatenate([diagram.frequency_hz(d, way)[-1] for d, way in waves]))[:9]
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_engine_orders_meet_the_waves_that_they_excite(diagram: Any) -> None:
    crossings = diagram.crossings()
    assert {each.direction for each in crossings} == {"forward", "backward"}
    assert {each.diameter for each in crossings} == {0, 1, 2}
    for each in crossings:
        assert each.frequency_hz == pytest.approx(each.order * each.speed_rpm / 60.0, rel=1e-12)
        turn = each.diameter if each.direction == "backward" else -each.diameter
        assert (each.order - turn) % SECTORS == 0
        table = diagram.frequency_hz(each.diameter, each.direction)[:, each.mode - 1]
        assert each.frequency_hz == pytest.approx(np.interp(each.speed_rpm, SPEEDS, table), rel=1e-9)
    speeds = [each.speed_rpm for each in crossings]
    assert speeds == sorted(speeds)
    # Each crossing of a wave with an engine order that excites it is there.
    excess = diagram.frequency_hz(1, "backward")[:, 0] - 6 * SPEEDS / 60.0
    expected = int((excess[:-1] * excess[1:] < 0.0).sum())
    same = [
        each for each in crossings if (each.diameter, each.direction, each.mode, each.order) == (1, "backward", 1, 6)
    ]
    assert len(same) == expected


def test_standing_waves_count_once() -> None:
    even = SmallDisk.of(4, damped=False)
    diagram = ss.disk_campbell_diagram(lambda rpm: even.sector, None, [600.0, 6000.0], count=2)
    np.testing.assert_array_equal(diagram.stuck_hz, diagram.free_hz)
    found = [(each.diameter, each.order, each.mode) for each in diagram.crossings() if each.diameter in (0, 2)]
    assert found
    assert len(found) == len(set(found))


@pytest.mark.slow
def test_the_figure(diagram: Any) -> None:
    axes = diagram.plot().axes[0]
    assert len(axes.lines) == 3 * 2 * 4 + len(diagram.crossings())
    assert [each.get_text() for each in axes.texts] == [str(each.order) for each in diagram.crossings()]
    assert len(axes.get_legend().get_texts()) == 3


def test_input_errors(diagram: Any) -> None:
    with rejects(ss.InputError, "speed_rpm"):
        ss.disk_campbell_diagram(sector_at, None, [3000.0, 1000.0])
    with rejects(ss.InputError, "sector_at"):
        fewer = sector_at(0.0)
        fewer = replace(fewer, diameters={0: fewer.diameters[0]})
        ss.disk_campbell_diagram(lambda rpm: fewer if rpm > 500.0 else sector_at(rpm), None, [0.0, 1000.0])
    with rejects(ss.InputError, "superelement"):
        ss.disk_campbell_diagram(lambda rpm: DISK.ring, None, [0.0, 1000.0])  # type: ignore[arg-type, return-value]
    with rejects(ss.InputError, "operator"):
        pairs = ss.ContactPairs(np.eye(3), 1.0, 1.0, 0.5, normal_load=1.0)
        ss.disk_campbell_diagram(sector_at, pairs, [0.0, 1000.0])
    with rejects(ss.InputError, "diameter"):
        diagram.frequency_hz(3)
    with rejects(ss.InputError, "direction"):
        diagram.frequency_hz(1, "up")
    with rejects(ss.InputError, "limit"):
        diagram.frequency_hz(1, limit="both")
