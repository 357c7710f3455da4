"""A study with unknowns of the moving pairs alone: the results of all pairs, from the file to the page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castings import ROUGH_CASTING
from sentences import rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError, StudyFileError
from stickslip.model import model as models
from stickslip.model.model import build_model
from stickslip.results.storage import load_results
from stickslip.study import run as study
from stickslip.study.solution import solve_case
from stickslip.sweeps.plan import require_one_curve

QUICK = {
    "mesh.chordwise": 3,
    "solver.harmonics": 3,
    "solver.samples": 64,
    "excitation.amplitude": "120 N",
    "analysis.performance_curve": False,
    "output.figure_formats": [],
    "output.stress": False,
}
MOVING = {"reduction.pairs": "moving"}


@pytest.fixture(scope="module")
def case() -> Case:
    """Some of the pairs open."""
    return Case().replace(ROUGH_CASTING | QUICK)


@pytest.mark.long
def test_the_results_are_those_of_all_pairs(case: Case, tmp_path: Path) -> None:
    whole = solve_case(case)
    study.run(case.replace(MOVING), tmp_path)
    saved = load_results(tmp_path / "results.nc")
    part, record = saved.response, saved.study
    assert record is not None
    moving = int(part.settings["pairs_that_could_move"])
    assert 0 < moving < part.pairs.n_pairs == whole.response.pairs.n_pairs
    assert part.converged
    own = part.amplitude(record.outputs[record.response_output])
    other = whole.response.amplitude(next(iter(whole.model.outputs.values())))
    assert own.max() == pytest.approx(other.max(), rel=2e-3)
    np.testing.assert_array_equal(part.contact_state[own.argmax()], whole.response.contact_state[other.argmax()])
    for row in record.mode_table[:5]:
        assert abs(float(row["difference_percent"])) < 0.05
        assert float(row["mac"]) > 0.999
    assert record.mode_contact == "stuck"


@pytest.mark.slow
def test_pairs_join_until_the_others_rest(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """From an estimate of one pair."""
    one = np.zeros(build_model(case).pairs.n_pairs, dtype=bool)
    one[0] = True
    monkeypatch.setattr(models, "moving_pairs_of", lambda *_: one)
    solution = solve_case(case.replace(MOVING))
    moving = solution.model.reduced.moving
    assert moving is not None
    assert moving.sum() > 1
    assert solution.converged
    assert solution.response.settings["pairs_that_could_move"] == moving.sum()
    moved = (solution.response.contact_state != 0).any(axis=0)
    assert not (moved & ~moving).any()


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"analysis.kind": "mode"}, "analysis.kind"),
        ({"analysis.gradients": True}, "analysis.gradients"),
        ({"analysis.traction_band": True}, "analysis.traction_band"),
        ({"analysis.search": True}, "analysis.search"),
        ({"preload.method": "solved"}, "preload.method"),
        ({"rotation.speed": "3000 rpm", "rotation.axis": [0.0, 0.0, 1.0]}, "rotation"),
    ],
)
def test_other_analyses_are_rejected(changes: dict[str, object], key: str) -> None:
    with rejects(StudyFileError, key):
        Case().replace(MOVING | changes)


def test_sweeps_share_a_reduction_and_reject_it(case: Case) -> None:
    with rejects(InputError, "reduction.pairs"):
        require_one_curve(case.replace(MOVING), "sweep")
