"""The nonlinear mode on the page: three figures, and where its theory must not be used."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stickslip.contact.law.law import ContactState
from stickslip.reporting.further_answers import further_answers
from stickslip.reporting.mode_section import damping_of_mode, frequency_of_mode, states_of_mode
from stickslip.reporting.page import page
from stickslip.reporting.view import View
from stickslip.results.nonlinear_mode import POOR_REDUCTION
from stickslip.results.response import ForcedResponse
from synthetic import synthetic_study
from synthetic_mode import with_mode

STUDY = synthetic_study(columns=4, rows=3)


def section(response: ForcedResponse) -> str:
    text = page(response, STUDY)
    return text[text.index("<h2>Nonlinear mode</h2>") :].partition("</section>")[0]


@pytest.mark.slow
def test_the_page_says_where_peaks_are_on_the_mode() -> None:
    words = section(with_mode(0.02))
    assert "Mode 2 of the structure with stuck contacts" in words
    assert "Its damping ratio is at most 2 %" in words
    assert "below 3 % everywhere" in words
    assert "near this mode are on these curves.</p>" in words
    assert "Warning on the mode:" in words
    assert "<li>A warning of the mode.</li>" in words
    for name in ("mode-frequency", "mode-damping", "mode-states"):
        assert f'id="{name}"' in words
    assert "below 3 % everywhere" not in section(with_mode(0.05))


@pytest.mark.slow
def test_modal_amplitudes_have_powers_of_ten_and_a_root() -> None:
    response = with_mode(0.05)
    assert response.nonlinear_mode is not None
    mode = replace(response.nonlinear_mode, warnings=("From 3.18e-05 m kg^0.5 on the damping ratio is above 3 %.",))
    words = section(replace(response, nonlinear_mode=mode)).replace("\N{NO-BREAK SPACE}", " ")
    assert "From 3.18 × 10⁻⁵ m √kg on" in words
    assert "kg^0.5" not in words


@pytest.mark.slow
def test_a_mode_of_a_poor_reduction_promises_no_peaks_of_the_real_structure() -> None:
    response = with_mode(0.02)
    assert response.nonlinear_mode is not None
    mode = replace(response.nonlinear_mode, warnings=(f"{POOR_REDUCTION} 2 poorly: it has 500 Hz.",))
    assert "peaks of forced responses of the reduced structure near" in section(replace(response, nonlinear_mode=mode))
    assert "of the reduced structure" not in section(response)


@pytest.mark.slow
def test_without_a_mode_the_page_has_no_such_section() -> None:
    assert "<h2>Nonlinear mode</h2>" not in page(replace(with_mode(0.02), nonlinear_mode=None), STUDY)


def test_the_figures_show_the_mode_over_a_logarithmic_axis() -> None:
    view = View.of(with_mode(0.05), STUDY)
    mode = view.response.nonlinear_mode
    assert mode is not None
    stuck, sliding, curve = frequency_of_mode(view)["data"]
    assert (stuck["y"], sliding["y"]) == ([500.0, 500.0], [410.0, 410.0])
    assert curve["x"] == pytest.approx(mode.modal_amplitude, rel=1e-6)
    assert curve["text"][0].endswith("µm")
    far = replace(mode, sliding_frequency_hz=np.full_like(mode.sliding_frequency_hz, 1.0))
    response = replace(view.response, nonlinear_mode=far)
    assert [trace["name"] for trace in frequency_of_mode(View.of(response, STUDY))["data"]][:-1] == [stuck["name"]]
    assert "not in the figure: linear sliding mode 1, 1.00 Hz" in section(response)
    assert "mode 2 goes from " in " ".join(further_answers(view))
    damping = damping_of_mode(view)
    assert damping["layout"]["xaxis"]["type"] == "log"
    assert damping["data"][0]["y"] == pytest.approx(100.0 * mode.damping_ratio, rel=1e-6)
    assert damping["data"][1]["name"] == "3 %"
    states = states_of_mode(view)["data"]
    assert len(states) == len(ContactState)
    assert sum(np.array(trace["y"]) for trace in states) == pytest.approx(100.0)
