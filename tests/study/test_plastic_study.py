"""A study whose faces have plastic spots alone, from the case to its files; and what passes no jump of the law."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import RoughnessError
from stickslip.results.storage import load_results
from stickslip.study import run as study
from stickslip.study.ridge import ridge
from sweep_cases import quick_case

PLASTIC = {"roughness.fractal_dimension": 2.2}
RANGE = {"solver.frequency_start": "300 Hz", "solver.frequency_stop": "480 Hz"}


@pytest.mark.long
@pytest.mark.parametrize("allocation", ["area", "pressure"])
def test_a_study_with_plastic_faces_runs_and_says_that_its_stiffness_is_a_lower_bound(
    tmp_path: Path, allocation: str
) -> None:
    outcome = study.run(quick_case().replace(PLASTIC | RANGE | {"roughness.allocation": allocation}), tmp_path)
    assert outcome.converged, outcome.message
    record = load_results(tmp_path / "results.nc")
    assert record.response == outcome.response
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Fully plastic" in page
    assert "one round spot of the real area" in page
    assert record.study is not None
    amplitude = outcome.response.amplitude(record.study.outputs["blade tip A"])
    assert np.isfinite(amplitude).all()
    assert amplitude.max() > 3.0 * amplitude[0]  # the resonance with stuck contact is inside


def test_a_ridge_does_not_pass_the_jump() -> None:
    with rejects(RoughnessError, "preload.centrifugal_force"):
        ridge(quick_case(), "preload.centrifugal_force", ("5 N", "100 N"))
