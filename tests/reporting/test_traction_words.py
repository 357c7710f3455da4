"""Residual tractions on the page: the range in words and as lines, and the sentence where nobody asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stickslip.reporting.curve_plot import amplitude_frequency
from stickslip.reporting.figures import amplitude_frequency as figure_of
from stickslip.reporting.page import page
from stickslip.reporting.view import View
from stickslip.results.disk import Disk
from stickslip.results.measures import SUMMARY_COLUMNS, summary, summary_table
from stickslip.results.response import ForcedResponse
from stickslip.results.traction_band import TractionBand
from synthetic import synthetic_response, synthetic_study

STUDY = synthetic_study(columns=4, rows=3)


def with_band(complete: bool = True) -> ForcedResponse:
    """The curve, beside it two curves of 0.9 and 1.2 times its motion."""
    response = synthetic_response(columns=4, rows=3, n_points=20)
    count, pairs = response.n_points, response.pairs.n_pairs
    band = TractionBand(
        ("no traction at rest", "peak raised"),
        np.array([True, complete]),
        np.repeat([0, 1], count),
        np.tile(response.frequency_hz, 2),
        np.concatenate([0.9 * response.displacement, 1.2 * response.displacement]),
        np.zeros((2, pairs, 2)),
        np.array([2e-4, 2.005e-4, 1.5e-4]),
        np.array([1e-4]),
    )
    return replace(response, traction_band=band)


def section(response: ForcedResponse) -> str:
    text = page(response, STUDY)
    return text[text.index("<h2>Residual tractions</h2>") :].partition("</section>")[0]


@pytest.mark.slow
def test_the_page_gives_the_range_of_the_peak() -> None:
    response = with_band()
    peak = summary(response, STUDY.outputs[STUDY.response_output]).peak.amplitude
    words = section(response)
    assert f"the highest peak is {0.9e6 * peak:.4g} to {1.2e6 * peak:.4g} µm" in words
    assert f"this curve: {1e6 * peak:.4g} µm" in words
    assert "was not computed" not in words
    assert "Of 3 optimisations of the tractions for the highest peak, 2 reached 200.5 µm within 1 %." in words
    assert "Of 1 optimisations of the tractions for the lowest peak, 1 reached 100 µm within 1 %." in words
    assert "end early" not in words


@pytest.mark.slow
def test_the_page_of_a_disk_advises_no_band() -> None:
    disk = Disk(6, 1, "forward", np.arange(4), np.ones((4, 2)), np.ones((4, 2)))
    text = page(synthetic_response(columns=4, rows=3, n_points=20), replace(STUDY, disk=disk))
    words = text[text.index("<h2>Residual tractions</h2>") :].partition("</section>")[0]
    assert "is not computed for a sector of a disk" in words
    assert "--traction-band" not in words


def test_a_curve_that_ends_early_is_no_lowest_peak() -> None:
    row = STUDY.outputs[STUDY.response_output]
    for complete, low in ((True, 0.9), (False, 1.2)):
        band = with_band(complete).traction_band
        assert band is not None
        swapped = replace(band, complete=band.complete[::-1].copy())
        ends = [peak / summary(with_band(), row).peak.amplitude for peak in swapped.peak_range(row)]
        assert ends == pytest.approx([low, 1.2])


def test_the_page_says_that_curves_of_the_range_end_early() -> None:
    assert "1 of the curves end early" in section(with_band(complete=False))


def test_the_page_says_that_nobody_asked() -> None:
    words = section(replace(with_band(), traction_band=None))
    assert "was not computed" in words
    assert "traction_band = true in [analysis]" in words


def test_the_figures_have_one_name_for_the_curves_of_the_range() -> None:
    response = with_band()
    figure = amplitude_frequency(View.of(response, STUDY))
    lines = [trace for trace in figure["data"] if trace["name"] == "other residual tractions"]
    assert [line["showlegend"] for line in lines] == [True, False]
    assert figure["data"][-1]["name"] == "shown below"
    legend = figure_of(response, STUDY).axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()].count("other residual tractions") == 1


def test_tables_contain_the_range() -> None:
    measures = summary(with_band(), STUDY.outputs[STUDY.response_output])
    peak = measures.peak.amplitude
    columns = {name: SUMMARY_COLUMNS[name][2](measures) for name in SUMMARY_COLUMNS if "traction" in name}
    assert columns == {
        "lowest_traction_peak_amplitude_m": pytest.approx(0.9 * peak),
        "highest_traction_peak_amplitude_m": pytest.approx(1.2 * peak),
    }
    rows = [
        value for name, value, _ in summary_table(measures) if name == "Highest peak over extreme residual tractions"
    ]
    assert rows == [f"{0.9e6 * peak:.4g} to {1.2e6 * peak:.4g}"]
    without = summary(replace(with_band(), traction_band=None), STUDY.outputs[STUDY.response_output])
    assert without.traction_peaks is None
    assert SUMMARY_COLUMNS["lowest_traction_peak_amplitude_m"][2](without) is None
