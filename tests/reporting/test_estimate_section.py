"""The quasi-static estimate on the page: a dashed line beside the nonlinear mode, or a section of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stickslip.reporting.estimate_section import ESTIMATE_ALONE
from stickslip.reporting.further_answers import further_answers
from stickslip.reporting.mode_section import damping_of_mode, frequency_of_mode
from stickslip.reporting.page import page
from stickslip.reporting.view import View
from stickslip.results.mode_figure import ESTIMATE
from stickslip.results.quasi_static_mode import QuasiStaticMode
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_response, synthetic_study
from synthetic_mode import with_mode

STUDY = synthetic_study(columns=4, rows=3)


def with_estimate(response: ForcedResponse) -> ForcedResponse:
    """The response with an estimate whose motions are those of the curve."""
    count = response.n_points
    estimate = QuasiStaticMode(
        modal_amplitude=np.geomspace(1e-7, 1e-4, count),
        frequency_hz=np.linspace(500.0, 480.0, count),
        damping_ratio=np.linspace(0.001, 0.02, count),
        modal_force=np.ones(count),
        friction_energy=np.ones(count),
        displacement=response.displacement[:, :, 1],
        contact_state=response.contact_state,
        linear_frequency_hz=np.asarray(500.0),
        mode=2,
        converged=True,
        message="The message of the estimate.",
        warnings=("A warning of the estimate.",),
        settings={},
        provenance={},
    )
    return replace(response, quasi_static_mode=estimate)


def test_it_is_a_dashed_line_beside_the_nonlinear_mode() -> None:
    view = View.of(with_estimate(with_mode(0.02)), STUDY)
    for figure, values in ((frequency_of_mode(view), (500.0, 480.0)), (damping_of_mode(view), (0.1, 2.0))):
        (line,) = (trace for trace in figure["data"] if trace["name"] == ESTIMATE)
        assert line["line"]["dash"] == "dash"
        assert (line["y"][0], line["y"][-1]) == pytest.approx(values)
        assert line["text"][0].endswith("µm")
    assert not ESTIMATE_ALONE.applies(view)


@pytest.mark.slow
def test_the_section_of_the_mode_has_its_words() -> None:
    text = page(with_estimate(with_mode(0.02)), STUDY)
    section = text[text.index("<h2>Nonlinear mode</h2>") :].partition("</section>")[0]
    assert "rule: The message of the estimate.</p>" in section
    assert "Warning on the estimate:" in section
    assert "<li>A warning of the estimate.</li>" in section


@pytest.mark.slow
def test_alone_it_has_a_section() -> None:
    response = with_estimate(synthetic_response(columns=4, rows=3, n_points=20))
    text = page(response, STUDY)
    section = text[text.index("<h2>Quasi-static estimate of a mode</h2>") :].partition("</section>")[0]
    assert "The message of the estimate. From 500.00 Hz to 480.00 Hz" in section
    assert "<li>A warning of the estimate.</li>" in section
    assert "damping ratio is at most 2 %, at 480.00 Hz" in section
    for name in ("estimate-frequency", "estimate-damping"):
        assert f'id="{name}"' in section
    assert "<h2>Nonlinear mode</h2>" not in text
    (answer,) = further_answers(View.of(response, STUDY))
    assert "by a quasi-static estimate, mode 2 goes from 500.00 to 480.00 Hz" in answer
    assert answer.endswith("; section “Quasi-static estimate of a mode” has 1 warning on it.")
