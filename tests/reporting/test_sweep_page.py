"""The page of a sweep: its figures hold the numbers of the table, optimum and limits, failed cases with messages."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from browser_pages import LARGEST_PAGE, WIDTHS, opened_page, require_readable, tab_stops
from helpers import matched, opened_browser
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.reporting import sweep_plots as plots
from stickslip.reporting.sweep_page import sweep_page, write_sweep_page
from stickslip.reporting.sweep_view import SweepView, is_logarithmic
from stickslip.reporting.templates import StudyText
from stickslip.results.sweep_table import SweepCurve
from sweep_tables import FORCE, MODE, load_key, sweep_view

LOADS = load_key((100.0, 200.0, 400.0, 800.0))
BOWL = [3e-4, 1e-4, 2e-4, 4e-4]
PROVENANCE = {"date": "2026-01-01T00:00:00+00:00", "stickslip": "0"}


def page_of(view: SweepView) -> str:
    return sweep_page(view, "Two <blades>", StudyText("[study]"), PROVENANCE)


def figures_of(view: SweepView) -> dict[str, Any]:
    figures: dict[str, Any] = json.loads(
        matched(r'id="page-figures">(.*?)</script>', page_of(view), flags=re.DOTALL).group(1)
    )
    return figures


def test_every_curve_is_drawn_whole() -> None:
    view = sweep_view((LOADS,), BOWL)
    data = figures_of(view)["curves"]["data"]
    traces, legend = data[:4], data[4:]
    assert [trace["name"] for trace in traces] == [f"centrifugal force {load} N" for load in (100, 200, 400, 800)]
    assert [entry["name"] for entry in legend] == ["100 N", "200 N", "400 N", "800 N"]
    assert [entry["line"]["color"] for entry in legend] == [trace["line"]["color"] for trace in traces]
    for trace, curve in zip(traces, view.curves, strict=True):
        assert curve is not None
        assert trace["y"] == pytest.approx(1e6 * curve.amplitude_m, rel=1e-6)
    assert len({trace["line"]["color"] for trace in traces}) == 4


@pytest.mark.slow
def test_a_huge_sweep_is_thinned_and_reports_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plots, "DRAWN_POINTS", 300)
    view = sweep_view((LOADS,), BOWL, points=2001)
    traces = figures_of(view)["curves"]["data"][:4]
    assert sum(len(trace["x"]) for trace in traces) <= 300
    for trace, curve in zip(traces, view.curves, strict=True):
        assert curve is not None
        assert (trace["x"][0], trace["x"][-1]) == (440.0, 480.0)
        assert max(trace["y"]) == pytest.approx(1e6 * curve.amplitude_m.max(), rel=1e-6)
    assert re.search(r"of 8004 points are plotted", page_of(view))


def test_many_values_have_a_colour_bar() -> None:
    loads = load_key(tuple(np.linspace(100.0, 800.0, 15).tolist()))
    data = figures_of(sweep_view((loads,), [1e-4] * 15))["curves"]["data"]
    assert data[-1]["marker"]["showscale"]
    assert len({trace["line"]["color"] for trace in data[:-1]}) == 15


@pytest.mark.slow
def test_very_many_curves_share_lines_and_none_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plots, "SEPARATE_CURVES", 10)
    loads = load_key(tuple(np.linspace(100.0, 800.0, 200).tolist()))
    view = sweep_view((loads,), [1e-4 * (1.0 + k / 200) for k in range(200)])
    lines = figures_of(view)["curves"]["data"][:-1]
    assert 55 <= len(lines) <= 61
    drawn = [value for line in lines for value in line["y"] if value is not None]
    assert sorted(drawn) == pytest.approx(
        sorted(float(1e6 * value) for curve in view.curves if curve for value in curve.amplitude_m), rel=1e-6
    )
    assert sum(line["y"].count(None) for line in lines) == 200 - len(lines)
    assert re.search("centrifugal force 100 N to ", lines[0]["hovertemplate"])


def test_peaks_against_a_key_leave_failed_cases_out_and_mark_open_ends() -> None:
    view = sweep_view((LOADS, MODE), [1e-4, 2e-4, None, 3e-4, 4e-4, 5e-4, 6e-4, 7e-4], at_end=(4,))
    data = figures_of(view)["key-0"]["data"]
    single, open_end = (trace for trace in data if trace["name"] == "excitation mode single" and trace["yaxis"] == "y")
    assert (single["x"], single["y"]) == ([100.0, 800.0], pytest.approx([100.0, 600.0]))
    assert (open_end["x"], open_end["marker"]["symbol"]) == ([400.0], "circle-open")
    frequency = next(trace for trace in data if trace["name"] == "excitation mode same" and trace["yaxis"] == "y2")
    assert frequency["y"] == [461.0, 463.0, 465.0, 467.0]
    by_mode = figures_of(view)["key-1"]["data"][0]
    assert (by_mode["x"], by_mode["y"]) == (["single", "same"], pytest.approx([100.0, 200.0]))


@pytest.mark.slow
def test_each_key_has_one_style_on_the_whole_page() -> None:
    peaks = [1e-4 * (1 + place) for place in range(16)]
    view = sweep_view((LOADS, MODE, FORCE), peaks, limits={"stuck": [2e-4 + each for each in peaks]})
    figures, text = figures_of(view), page_of(view)
    assert "Colour shows preload.centrifugal_force, dash shows excitation.mode, mark shows excitation.amplitude" in text
    for name, without in (("curves", ""), ("key-0", "colour"), ("key-1", "dash"), ("key-2", "mark")):
        data = figures[name]["data"]
        columns = {trace["legendgrouptitle"]["text"] for trace in data if "legendgrouptitle" in trace}
        wanted = {"colour": "centrifugal force", "dash": "excitation mode", "mark": "excitation amplitude"}
        assert columns == {words for style, words in wanted.items() if style != without}
    against_load = [trace for trace in figures["key-0"]["data"] if trace.get("yaxis") == "y"]
    styles = {(trace["line"]["color"], trace["line"]["dash"], trace["marker"]["symbol"]) for trace in against_load}
    assert len(styles) == len(against_load) == 4
    assert {colour for colour, _, _ in styles} == {"#1b2a41"}
    limits = [trace for trace in figures["performance-load"]["data"] if trace["name"] == "linear, stuck"]
    assert len({(trace["line"]["dash"], trace["marker"]["symbol"]) for trace in limits}) == len(limits) == 4
    assert not any("text" in trace for trace in limits)  # the legend names them; names at their ends would overlap


def test_a_table_without_some_combinations_has_a_page() -> None:
    view = sweep_view((LOADS, MODE), [3e-4, 4e-4, 1e-4, 2e-4, 2e-4, 3e-4, 4e-4, 5e-4])
    kept = [place for place in range(8) if place != 3]  # 200 N, same was not computed
    rows = tuple(view.table.rows[place] for place in kept)
    view = SweepView(replace(view.table, rows=rows), tuple(view.curves[place] for place in kept), view.force_n[kept])
    assert figures_of(view)["map-0"]["data"][0]["z"] == [[300.0, 100.0, 200.0, 400.0], [400.0, None, 300.0, 500.0]]
    # 200 N has the lowest peak, but no peak under the second load case
    text = page_of(view)
    assert "Best design: centrifugal force 400 N. Its highest peak is 300 µm, in the load case" in text
    assert "1 designs with an unknown peak do not count" in text


def test_only_pages_that_exist_have_links(tmp_path: Path) -> None:
    view = sweep_view((LOADS,), BOWL)
    rows = tuple(replace(row, file=f"cases/{row.name}/results.nc") for row in view.table.rows)
    view = replace(view, table=replace(view.table, rows=rows))
    page = tmp_path / "cases" / "case-1" / "report.html"
    page.parent.mkdir(parents=True)
    page.touch()
    target = tmp_path / "sweep.html"
    write_sweep_page(target, view, "Blades", StudyText("[study]"), PROVENANCE)
    text = target.read_text(encoding="utf-8")
    assert re.findall(r'<a href="(cases[^"]*)">([^<]*)', text) == [("cases/case-1/report.html", "200 N")]
    assert "stickslip report" in text


@pytest.mark.slow
def test_damper_performance_marks_optimum_and_limits() -> None:
    view = sweep_view((LOADS,), BOWL)
    figures, text = figures_of(view), page_of(view)
    names = [trace["name"] for trace in figures["performance-load"]["data"]]
    assert names == ["peak", "linear, stuck", "optimum"]
    star = figures["performance-load"]["data"][2]
    assert (star["x"], star["y"]) == ([200.0], pytest.approx([100.0]))
    ratio = figures["performance-ratio"]["data"]
    assert ratio[0]["x"] == pytest.approx([50 / 800, 50 / 400, 50 / 200, 50 / 100])
    assert ratio[0]["y"] == pytest.approx([400.0, 200.0, 100.0, 300.0])
    assert ratio[2]["x"] == [0.25]
    assert "Lowest computed peak 100 µm at F_N = 200 N." in text
    falling = page_of(sweep_view((LOADS,), sorted(BOWL)))
    assert "at F_N = 100 N, at an end of the loads" in falling
    assert "no optimum" in page_of(sweep_view((LOADS,), BOWL, at_end=(0, 1, 2, 3)))
    assert "Damper performance" not in page_of(sweep_view((MODE,), [1e-4, 2e-4]))


def test_peaks_of_slow_sweeps_are_told_apart_where_they_are_lower() -> None:
    view = sweep_view((LOADS,), BOWL)
    reached: dict[str, list[Any]] = {
        "upward_peak_amplitude_m": [2e-4, 1e-4, None, 4e-4],
        "downward_peak_amplitude_m": BOWL,
    }
    rows = tuple(
        replace(row, measures={**row.measures, **{name: v[i] for name, v in reached.items() if v[i] is not None}})
        for i, row in enumerate(view.table.rows)
    )
    hertz = np.array([440.0, 460.0, 455.0, 450.0, 480.0])
    stable = np.array([True, True, False, True, True])
    folded = SweepCurve(hertz, np.array([1e-5, 1e-4, 2e-4, 3e-4, 1e-5]), stable, np.zeros(5, int))
    view = SweepView(replace(view.table, rows=rows), (folded, *view.curves[1:]), view.force_n)
    figures, text = figures_of(view), page_of(view)
    for figure in ("key-0", "performance-load"):
        marks = [trace for trace in figures[figure]["data"] if trace["name"].startswith("slow sweep")]
        assert [(mark["name"], mark["x"], mark["y"]) for mark in marks] == [
            ("slow sweep up, where lower", [100.0], [200.0])
        ]
        assert marks[0]["marker"]["symbol"] == "triangle-up"
    assert "1 of the curves is unstable in part: these parts are thin and finely dashed." in text
    headings = ("Highest peak, µm", "Peak, slow sweep up, µm", "Peak, slow sweep down, µm")
    assert [heading in text for heading in headings] == [True, True, False]  # each slow sweep down reaches the peak
    assert "is unstable" not in page_of(sweep_view((LOADS,), BOWL))
    solid, dashed = figures["curves"]["data"][:2]
    assert (solid["x"], solid["y"]) == ([440.0, 460.0, None, 450.0, 480.0], pytest.approx([10, 100, None, 300, 10]))
    assert (dashed["x"], dashed["y"]) == ([460.0, 455.0, 450.0], pytest.approx([100.0, 200.0, 300.0]))
    assert (solid["line"]["dash"], dashed["line"]["dash"]) == ("solid", "2px,2px")
    assert not dashed["showlegend"]


def test_performance_of_several_forces_is_per_force() -> None:
    view = sweep_view((load_key((100.0, 200.0)), FORCE), [1e-4, 2e-4, 3e-4, 6e-4], force_n=[50.0, 100.0, 50.0, 100.0])
    figure = figures_of(view)["performance-ratio"]
    assert "µm/N" in figure["layout"]["yaxis"]["title"]["text"]
    first, second = (
        next(t for t in figure["data"] if t["name"] == f"excitation amplitude {force} N") for force in (50, 100)
    )
    # the same force / F_N gives the same peak per force
    assert dict(zip(first["x"], first["y"], strict=True)) == {0.25: 6.0, 0.5: 2.0}
    assert dict(zip(second["x"], second["y"], strict=True)) == {0.5: 6.0, 1.0: 2.0}


@pytest.mark.slow
def test_maps_of_two_keys_show_every_cell() -> None:
    view = sweep_view((LOADS, MODE), [1e-4, 2e-4, None, 3e-4, 4e-4, 5e-4, 6e-4, 7e-4], at_end=(7,))
    figure = figures_of(view)["map-0"]["data"][0]
    assert (figure["x"], figure["y"]) == (list(LOADS.labels), ["single", "same"])
    assert figure["z"] == [[100.0, None, 400.0, 600.0], [200.0, 300.0, 500.0, 700.0]]
    assert figure["text"][1][3] == "at an end"
    three = figures_of(sweep_view((LOADS, MODE, FORCE), [1e-4] * 16))
    assert [name for name in three if name.startswith("map")] == ["map-0", "map-1", "map-2", "map-3"]
    assert "map-0" not in figures_of(sweep_view((LOADS,), BOWL))


@pytest.mark.slow
def test_failed_cases_and_warnings_are_listed_safely() -> None:
    text = page_of(sweep_view((LOADS,), [1e-4, None, 2e-4, 3e-4], at_end=(3,)))
    assert "1 case failed" in text
    assert "centrifugal force 200 N: No &lt;first&gt; point." in text
    assert "Two &lt;blades&gt;" in text
    assert text.count("<summary>1 warning</summary>") == 3
    assert "Peak: highest computed, at an end of the curve." in text
    assert "http://" not in re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL).replace("http://www.w3.org", "")
    nothing = page_of(sweep_view((LOADS,), [None] * 4))
    assert "No case has a curve." in nothing


def test_spacing_decides_the_axis() -> None:
    assert is_logarithmic(np.geomspace(10.0, 1000.0, 5))
    assert not is_logarithmic(np.linspace(10.0, 1000.0, 5))
    assert not is_logarithmic(np.array([0.0, 1.0, 10.0]))


def test_a_place_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    with rejects(InputError):
        write_sweep_page(tmp_path / "no" / "sweep.html", sweep_view((LOADS,), BOWL), "", StudyText(""), PROVENANCE)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def sweep_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sweep") / "sweep.html"
    view = sweep_view((LOADS, MODE), [1e-4, 2e-4, None, 3e-4, 4e-4, 5e-4, 6e-4, 7e-4], at_end=(7,))
    write_sweep_page(path, view, "Blades", StudyText("[study]"), PROVENANCE)
    return path


# Figures whose legend plotly cut and gave a scroll bar, or left less than 60 px for the curves.
_CRAMPED = """[...document.querySelectorAll('.js-plotly-plot')].filter(plot => {
  const bar = plot.querySelector('.legend .scrollbar');
  return (bar && bar.getBBox().height > 0) || plot._fullLayout._size.h < 60;
}).map(plot => plot.id)"""


@pytest.mark.long
def test_printed_legends_are_complete_and_leave_room_for_the_curves(browser: Any, sweep_file: Path) -> None:
    with opened_page(browser, sweep_file) as page:
        shown = page.evaluate("document.getElementById('curves')._fullLayout.height")
        page.emulate_media(media="print")
        page.wait_for_selector("#curves[data-height]")
        page.wait_for_timeout(500)
        assert page.evaluate(_CRAMPED) == []
        page.emulate_media(media="screen")
        page.wait_for_selector("#curves:not([data-height])")
        assert page.evaluate("document.getElementById('curves')._fullLayout.height") == shown


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_the_page_draws_itself_without_network(browser: Any, sweep_file: Path, width: int) -> None:
    with opened_page(browser, sweep_file, width) as page:
        assert page.locator(".js-plotly-plot").count() == 1 + 2 + 2 + 2
        require_readable(page)
        page.click("#scale")
        page.wait_for_function("document.getElementById('curves').layout.yaxis.type === 'log'")


@pytest.mark.long
def test_the_keyboard_reaches_everything(browser: Any, sweep_file: Path) -> None:
    with opened_page(browser, sweep_file) as page:
        stops = tab_stops(page)
        assert stops[0]["name"] == "Contents"
        assert "scale" in {stop["id"] for stop in stops}
        assert {"All cases", "The complete study file"} <= {stop["name"] for stop in stops}
        assert sum(stop["tag"] == "summary" for stop in stops) == page.locator("summary").count() == 9
        page.focus("#scale")
        page.keyboard.press("Enter")
        page.wait_for_function("document.getElementById('curves').layout.yaxis.type === 'log'")


@pytest.mark.long
def test_a_large_sweep_stays_small_and_draws_every_curve(browser: Any, tmp_path: Path) -> None:
    loads = load_key(tuple(np.linspace(100.0, 800.0, 200).tolist()))
    view = sweep_view((loads,), [1e-4 * (1.0 + k / 200) for k in range(200)], points=2001)
    path = tmp_path / "sweep.html"
    write_sweep_page(path, view, "Blades", StudyText("[study]"), PROVENANCE)
    assert path.stat().st_size < LARGEST_PAGE
    with opened_page(browser, path) as page:
        lines = page.evaluate("document.getElementById('curves').data.map(trace => [trace.name, trace.x.length])")
        drawn = [count for name, count in lines if count > 1]
        assert len(drawn) == 200
        assert sum(drawn) <= plots.DRAWN_POINTS
