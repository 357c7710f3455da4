"""Modes from their own file and from the results file of a study."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import stickslip as ss
from known_modes import one_mass
from sentences import rejects
from stickslip.results.quasi_static_mode import QuasiStaticMode
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import save_results
from synthetic import synthetic_response, synthetic_study
from synthetic_mode import with_mode

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def estimate() -> QuasiStaticMode:
    return ss.quasi_static_mode(*one_mass(), 1, (1e-6, 1e-3), points_per_decade=5)


@pytest.fixture(scope="module")
def response(estimate: QuasiStaticMode) -> ForcedResponse:
    return replace(with_mode(0.01), quasi_static_mode=estimate)


def test_modes_come_from_the_file_of_a_study(
    response: ForcedResponse, estimate: QuasiStaticMode, tmp_path: Path
) -> None:
    save_results(tmp_path / "results.nc", response, synthetic_study(columns=4, rows=3))
    mode = ss.NonlinearMode.load(tmp_path / "results.nc")
    assert mode == response.nonlinear_mode
    assert ss.QuasiStaticMode.load(tmp_path / "results.nc") == estimate


def test_modes_come_from_their_own_files(response: ForcedResponse, estimate: QuasiStaticMode, tmp_path: Path) -> None:
    assert response.nonlinear_mode is not None
    response.nonlinear_mode.save(tmp_path / "mode.nc")
    estimate.save(tmp_path / "estimate.nc")
    assert ss.NonlinearMode.load(tmp_path / "mode.nc") == response.nonlinear_mode
    assert ss.QuasiStaticMode.load(tmp_path / "estimate.nc") == estimate


def test_a_file_without_the_mode_is_rejected(estimate: QuasiStaticMode, tmp_path: Path) -> None:
    synthetic_response().save(tmp_path / "response.nc")
    estimate.save(tmp_path / "estimate.nc")
    for kind, name in (
        (ss.NonlinearMode, "response.nc"),
        (ss.QuasiStaticMode, "response.nc"),
        (ss.NonlinearMode, "estimate.nc"),
    ):
        with rejects(ss.ResultsFileError):
            kind.load(tmp_path / name)
