"""The page of a band: its figures contain the percentiles, limits and indices; failed samples have their messages."""

from __future__ import annotations

import html
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from band_tables import band_statistics
from browser_pages import LARGEST_PAGE, WIDTHS, opened_page, require_readable
from helpers import opened_browser
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.reporting.band_page import band_page, write_band_page
from stickslip.reporting.templates import StudyText
from stickslip.results.band import TractionRange
from stickslip.results.band_statistics import BandStatistics
from stickslip.results.sweep_table import Again

PEAKS = (1e-4 * (1.0 + 2.0 * (np.arange(32) + 0.5) / 32)).tolist()
PROVENANCE = {"date": "2026-01-01T00:00:00+00:00", "stickslip": "0"}


def page_of(statistics: BandStatistics) -> str:
    return band_page(statistics, "Two <blades>", StudyText("[study]"), PROVENANCE)


def figures_of(statistics: BandStatistics) -> dict[str, Any]:
    match = re.search(r'id="page-figures">(.*?)</script>', page_of(statistics), flags=re.DOTALL)
    assert match is not None
    figures: dict[str, Any] = json.loads(match.group(1))
    return figures


def named(figure: dict[str, Any], name: str) -> dict[str, Any]:
    return next(trace for trace in figure["data"] if html.unescape(trace["name"]) == name)


@pytest.mark.slow
def test_the_band_of_curves_is_that_of_the_samples() -> None:
    statistics = band_statistics(PEAKS, ["peak_amplitude < 0.25 mm"])
    figure = figures_of(statistics)["curves"]
    band = statistics.curve_band
    assert band is not None
    assert named(figure, "median")["y"] == pytest.approx(1e6 * band.amplitude_m[1], rel=1e-6)
    assert max(named(figure, "5 % to 95 % of the samples")["y"]) == pytest.approx(290.0, rel=1e-4)
    assert named(figure, "limit: peak_amplitude < 0.25 mm")["y"] == [250.0, 250.0]
    lines = named(figure, "32 samples")["y"]
    assert lines.count(None) == 32
    assert max(value for value in lines if value is not None) == pytest.approx(1e6 * max(PEAKS), rel=1e-5)
    # more points than the samples have: the interpolation of the percentiles, not straight lines
    assert len(lines) > 3 * sum(each.frequency_hz.size for each in statistics.curves if each is not None)


@pytest.mark.slow
def test_the_page_begins_with_its_result_in_words() -> None:
    text = html.unescape(page_of(band_statistics(PEAKS, ["peak_amplitude < 0.25 mm"])))
    answer = text[text.index('<div class="answer">') : text.index('<section class="tiles"')]
    assert "The highest peak is 200 µm in the median, and between 110 and 290 µm in 90 % of 32 samples." in answer
    assert "8 of 32 samples do not satisfy peak_amplitude < 0.25 mm; of all structures," in answer
    kept = html.unescape(page_of(band_statistics(PEAKS, ["peak_amplitude < 1 mm"])))
    assert "All 32 samples satisfy peak_amplitude < 1 mm; of all structures, up to 10.9 % do not" in kept


@pytest.mark.slow
def test_stresses_are_on_the_page_where_a_limit_asks_for_them() -> None:
    """2 MPa of von Mises stress for each um of the peak."""
    statistics = band_statistics(PEAKS, ["stress < 500 MPa"])
    text = html.unescape(page_of(statistics))
    assert (
        "The largest von Mises stress at the peak is 400 MPa in the median, and between 220 and 580 MPa in 90 % of 32 "
        "samples. It is that away from contacts and loads, on this mesh."
    ) in text
    assert "8 of 32 samples do not satisfy stress < 500 MPa" in text
    assert "Alternating stress, MPa" in text
    assert "compare a finer one before you trust a limit" in text
    figures = figures_of(statistics)
    assert named(figures["distribution-stress"], "limit: stress < 500 MPa")["x"] == [500.0, 500.0]
    assert "The input that matters most for the largest von Mises stress at the peak is excitation.amplitude." in text
    far = figures_of(band_statistics(PEAKS, ["stress < 5 GPa"]))["distribution-stress"]  # 4.4 beyond a range of 0.4 GPa
    assert not [trace for trace in far["data"] if html.unescape(trace["name"]).startswith("limit")]
    assert figures["distribution-stress"]["layout"]["xaxis"]["title"]["text"].endswith("at the peak, MPa")
    assert figures["indices-alternating_stress"]["data"][0]["x"] == [100.0]
    without = html.unescape(page_of(band_statistics(PEAKS)))
    assert "von Mises" not in without
    assert "distribution-stress" not in without


@pytest.mark.slow
def test_the_page_says_which_checks_its_samples_lack() -> None:
    assert "samples have no search for" in page_of(band_statistics(PEAKS))


@pytest.mark.slow
def test_the_distribution_shows_what_exceeds_the_limit() -> None:
    statistics = band_statistics(PEAKS, ["peak_amplitude < 0.25 mm"])
    figure = figures_of(statistics)["distribution-peak_amplitude"]
    assert sum(named(figure, "in the interval")["y"]) == pytest.approx(100.0)
    above = named(figure, "above the value")
    below = [y for x, y in zip(above["x"], above["y"], strict=True) if x < 250.0]
    assert below[-1] == pytest.approx(25.0)
    text = page_of(statistics)
    assert "8 of 32" in text
    assert statistics.exceedances[0].probability == 0.25


@pytest.mark.slow
def test_indices_have_their_intervals() -> None:
    figure = figures_of(band_statistics(PEAKS))["indices-peak_amplitude"]
    assert [trace["x"] for trace in figure["data"]] == [[100.0], [100.0]]
    assert figure["data"][0]["error_x"]["array"] == pytest.approx([0.0], abs=1e-6)


@pytest.mark.slow
def test_failed_and_open_samples_are_notices_and_rows() -> None:
    text = page_of(band_statistics([*PEAKS[:10], None, None], at_end=(3,)))
    assert "2 samples failed" in text
    assert "Sample 11: No &lt;first&gt; point." in text
    assert "2 of 12 samples failed" in text
    assert "The largest amplitude of 1 of 12 samples is at an end" in text
    assert text.count("Failed: No &lt;first&gt; point.") == 2
    assert "12 samples are not a power of two" in text


def test_a_band_without_any_result_has_a_page() -> None:
    text = page_of(band_statistics([None] * 8))
    assert "No sample has a complete curve." in text
    assert "0 samples have a result" in text


def tractions() -> TractionRange:
    """A second band of 180 to 260 µm about 200 µm."""
    frequency = np.linspace(440.0, 480.0, 81)
    lines = tuple((frequency, peak / np.hypot(1.0, frequency - 460.0)) for peak in (2e-4, 1.8e-4, 2.6e-4))
    return TractionRange(2e-4, 1.8e-4, 2.6e-4, lines)


@pytest.mark.slow
def test_the_range_over_residual_tractions_is_a_second_band() -> None:
    statistics = band_statistics(PEAKS, tractions=tractions())
    figures = figures_of(statistics)
    band = named(figures["distribution-peak_amplitude"], "residual tractions, central inputs")
    assert (min(band["x"]), max(band["x"])) == (180.0, 260.0)
    name = "residual tractions, central inputs"
    assert "residual tractions" not in json.dumps(figures["distribution-peak_frequency"])
    lines = [trace for trace in figures["curves"]["data"] if html.unescape(trace["name"]) == name]
    assert [max(trace["y"]) for trace in lines] == pytest.approx([200.0, 180.0, 260.0])
    assert [trace["showlegend"] for trace in lines] == [True, False, False]
    text = page_of(statistics)
    section = text[text.index("<h2>Residual tractions</h2>") :].partition("</section>")[0]
    assert "is 200 µm. Over extreme residual tractions it is 180 to 260 µm (-10 % to +30 %)" in section
    assert "lower bound" in section
    assert statistics.to_dataset()["traction_peak"].values.tolist() == [1.8e-4, 2.6e-4]


@pytest.mark.slow
def test_a_range_over_residual_tractions_that_failed_is_a_notice() -> None:
    text = page_of(band_statistics(PEAKS, tractions="No first point."))
    assert "residual tractions with central inputs was not computed: No first point." in text
    assert "<h2>Residual tractions</h2>" not in text


@pytest.mark.slow
def test_a_folder_that_does_not_exist_is_reported(tmp_path: Path) -> None:
    with rejects(InputError):
        write_band_page(tmp_path / "no" / "band.html", band_statistics(PEAKS), "t", StudyText(""), PROVENANCE)


@pytest.mark.long
def test_the_page_in_a_browser(tmp_path: Path) -> None:
    path = tmp_path / "band.html"
    statistics = band_statistics([*PEAKS, None], ["peak_amplitude < 0.25 mm"], (3,), tractions())
    write_band_page(path, statistics, "Two blades", StudyText("[study]"), PROVENANCE)
    assert path.stat().st_size < LARGEST_PAGE
    with opened_browser() as browser:
        for width in WIDTHS:
            with opened_page(browser, path, width) as page:
                require_readable(page)
                assert page.locator(".js-plotly-plot").count() == 5
                page.click("#scale")
                assert page.evaluate("document.getElementById('curves').layout.yaxis.type") == "log"


@pytest.mark.slow
def test_the_page_says_which_samples_were_solved_again_and_why() -> None:
    assert "solved again" not in page_of(band_statistics(PEAKS))
    error, samples = Again.HARMONICS.sentence(0.032), Again.SAMPLES.sentence(0.003)
    assert error == "the estimated error by neglected harmonics is 3.2 %"
    assert samples == "the residual with doubled samples is 0.3 %"
    reasons = {
        1: (error, (Again.HARMONICS,)),
        4: (samples, (Again.SAMPLES,)),
        5: (f"{samples}; then {error}", (Again.SAMPLES, Again.HARMONICS)),
        9: ("The curve ends at 3 Hz.", (Again.EARLY,)),
    }
    statistics = band_statistics(PEAKS)
    rows = tuple(
        replace(row, solved_again=reasons[i][0], again_because=reasons[i][1]) if i in reasons else row
        for i, row in enumerate(statistics.table.rows)
    )
    text = html.unescape(page_of(replace(statistics, table=replace(statistics.table, rows=rows))))
    assert (
        "4 of 32 samples were solved again, with more harmonics, more samples of a period or as a single case, because "
        "the first curve was not accurate enough: the estimated error by neglected harmonics was too large (1), the "
        "residual with doubled samples was too large (2), the curve ended early (1). Their rows have the figures."
    ) in text
    assert text.count("Solved again: ") == 4
    assert f"Solved again: {samples}; then {error}." in text
