"""One reduction of a disk for all speeds: a study at each speed against its own reduction there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_cyclic_preload import disk

import stickslip as ss
from sentences import rejects
from stickslip.core.errors import InputError, StudyFileError
from stickslip.model import study_structure
from stickslip.model.model import ReducedModel, build_model, connect
from stickslip.study.solution import solve_case
from stickslip.sweeps.plan import case_hashes


def stuck_hz(model: ReducedModel, diameter: int, count: int = 3) -> Any:
    """Natural frequencies with stuck contact of a nodal diameter."""
    sector, pairs = model.substructure.require_sector(), model.pairs
    here, ahead = np.hsplit(pairs.operator, 2)
    operator = here + np.exp(2j * np.pi * diameter / sector.sectors) * ahead
    matrices = sector.lagged(diameter)
    stiffness = matrices.stiffness + operator.conj().T @ (pairs.resting_stiffness()[:, None] * operator)
    stuck = ss.CyclicSector(
        sector.sectors, {diameter: type(matrices)(matrices.mass, stiffness)}, np.empty(0, dtype=np.int64)
    )
    return stuck.natural_frequencies(diameter, count)


@pytest.mark.long
def test_each_speed_of_one_reduction_is_the_study_at_this_speed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    case = disk(3000.0, rotation={"speed": "3000 rpm", "top_speed": "7500 rpm", "coriolis": True})
    model = build_model(case)
    monkeypatch.setattr(study_structure, "rotating_sector", None)  # a second reduction would fail
    rises = []
    for speed in (1500.0, 4500.0, 7500.0):
        found = connect(case.replace({"rotation.speed": f"{speed} rpm"}), model.reduced, model.joint)
        again = build_model(case.replace({"rotation.speed": f"{speed} rpm"}))
        own = build_model(disk(speed, rotation={"speed": f"{speed} rpm", "coriolis": True}))
        for each in (found, again):
            assert each.preload is not None
            assert own.preload is not None
            largest = own.preload.state.normal_force.max()
            np.testing.assert_allclose(
                each.preload.state.normal_force, own.preload.state.normal_force, atol=1e-3 * largest
            )
            for diameter in range(4):
                np.testing.assert_allclose(stuck_hz(each, diameter), stuck_hz(own, diameter), rtol=2e-3)
            one, other = (each.substructure.require_sector().diameters[1].gyroscopic for each in (each, own))
            assert one is not None
            assert other is not None
        rises.append(stuck_hz(own, 1)[0])
    assert rises[2] > 1.02 * rises[0]  # the speed is an effect that the comparison sees


@pytest.mark.long
def test_the_motion_and_the_curve_of_a_study_with_one_reduction() -> None:
    turning = {"speed": "6000 rpm", "top_speed": "7500 rpm"}
    both = [solve_case(disk(6000.0, rotation=each)) for each in (turning, {"speed": "6000 rpm"})]
    peaks = [each.response.amplitude(each.model.outputs["tip"]).max() for each in both]
    assert peaks[0] == pytest.approx(peaks[1], rel=5e-3)
    sizes = []
    for each in both:
        assert each.motion is not None
        sizes.append(np.abs(each.motion.displacement).max())
    assert sizes[0] == pytest.approx(sizes[1], rel=1e-2)


def test_cases_at_several_speeds_share_their_reduction() -> None:
    def hashes(speed: float, **rotation: str) -> tuple[str, str]:
        return case_hashes(disk(rotation={"speed": f"{speed} rpm", **rotation}))

    assert hashes(1000.0, top_speed="9000 rpm")[1] == hashes(3000.0, top_speed="9000 rpm")[1]
    assert hashes(1000.0)[1] != hashes(3000.0)[1]


@pytest.mark.slow
def test_bad_input() -> None:
    with rejects(StudyFileError, "rotation.top_speed"):
        disk(rotation={"speed": "3000 rpm", "top_speed": "2000 rpm"})
    with rejects(InputError, "rotation.top_speed"):
        build_model(disk(rotation={"speed": "3000 rpm", "top_speed": "900000 rpm"}))
    with rejects(StudyFileError, "rotation.top_speed"):
        mistuning = {"standard_deviation": "1 %"}
        disk(mistuning=mistuning, rotation={"speed": "3000 rpm", "top_speed": "9000 rpm"})
