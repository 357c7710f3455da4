"""A study with gradients of its peak, from file to page, on a coarse two-blade model."""

from __future__ import annotations

from pathlib import Path

import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.results.storage import load_results
from stickslip.study import gradients as gradients_of_study
from stickslip.study import run as study
from stickslip.study.solution import solve_case
from stickslip.sweeps.axes import swept_keys
from stickslip.sweeps.plan import plan_cases
from sweep_cases import quick_case

pytestmark = pytest.mark.slow

GRADIENTS = {"analysis.gradients": True}


@pytest.mark.long
def test_run_writes_the_gradients_and_their_section(tmp_path: Path) -> None:
    outcome = study.run(quick_case().replace(GRADIENTS), tmp_path)
    saved = load_results(tmp_path / "results.nc").response.gradients
    assert saved is not None
    assert saved == outcome.response.gradients
    assert {"friction.coefficient", "geometry.platform_angle", "roughness.fractal_dimension"} <= set(saved.names)
    printed_sentence(outcome.message, "10 %", numbers=False)
    assert f"  {saved.names[saved.order[0]]} " in outcome.message
    assert "<h2>Which input matters most</h2>" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.long
def test_a_curve_without_gradients_is_a_result_with_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object, **__: object) -> None:
        raise ConvergenceError("the peak is a corner.")

    monkeypatch.setattr(gradients_of_study, "peak_gradients", fails)
    response = solve_case(quick_case().replace(GRADIENTS)).response
    assert response.gradients is None
    printed_sentence(response.warnings[-1])


def test_a_sweep_has_no_gradients() -> None:
    case = quick_case().replace(GRADIENTS)
    with rejects(InputError, "analysis.gradients"):
        plan_cases(case, swept_keys({"friction.coefficient": ["0.2", "0.3"]}, case))
