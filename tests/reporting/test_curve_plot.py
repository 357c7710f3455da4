"""The amplitude curve of the page where it folds: dashes, arrows, three peaks, and the words beside them."""

from __future__ import annotations

import dataclasses
import json
import re

import numpy as np
import plotly
import pytest

from folded_curves import FOLD_HZ, VALLEY_HZ, folded_response
from stickslip.core.plain_figure import DOWNWARD, UPWARD
from stickslip.reporting.curve_plot import amplitude_frequency
from stickslip.reporting.page import page
from stickslip.reporting.sweep_words import sweep_words
from stickslip.reporting.view import View
from stickslip.results.response_data import NO_STABILITY
from synthetic import synthetic_response, synthetic_study


@pytest.fixture(scope="module")
def view() -> View:
    response = folded_response()
    words = "Some points are unstable."
    known = dataclasses.replace(response, stable=response.stable_points, stability_message=words)
    return View.of(known, synthetic_study())


def test_unknown_stability_is_never_called_stable() -> None:
    """An Iwan joint has no multipliers: only the parts between folds are known, and they are unstable."""
    reason = "Stability was not computed: the law iwan does not give the derivatives of its steps."
    unknown = View.of(dataclasses.replace(folded_response(), stability_message=reason), synthetic_study())
    assert unknown.response.stable is None
    names = {trace["name"] for trace in amplitude_frequency(unknown)["data"]}
    assert {"with friction, stability not known", "with friction, unstable"} <= names
    assert "with friction, stable" not in names
    words = sweep_words(unknown)
    assert words.startswith(f"{reason} Dashed parts run back between two folds, so they are unstable")
    assert "Solid parts are stable" not in words
    axes = unknown.response.plot(unknown.study.outputs[unknown.study.response_output], "tip").axes[0]
    assert "with friction, stability not known" in {str(line.get_label()) for line in axes.lines}


@pytest.mark.slow
def test_stable_parts_are_solid_and_unstable_parts_dashed(view: View) -> None:
    figure = amplitude_frequency(view)
    plotly.graph_objects.Figure(figure)  # raises for an unknown key or value
    traces = {trace["name"]: trace for trace in figure["data"]}
    solid, dashed = traces["with friction, stable"], traces["with friction, unstable"]
    assert (solid["line"]["dash"], dashed["line"]["dash"]) == ("solid", "dash")
    assert solid["x"].count(None) == 1  # two stable parts
    assert (max(dashed["x"]), min(dashed["x"])) == pytest.approx((FOLD_HZ, VALLEY_HZ))
    points = figure["data"][2]
    assert len(points["x"]) == view.response.n_points  # page.js numbers points by this trace
    assert points["marker"]["opacity"].count(0.0) == int((~view.response.stable_points).sum()) > 5


def test_no_line_crosses_an_interruption() -> None:
    response, study = synthetic_response(), synthetic_study()
    half = response.n_points // 2
    parted = View.of(dataclasses.replace(response, part=np.arange(response.n_points) // half), study)
    (solid,) = (
        trace for trace in amplitude_frequency(parted)["data"] if trace["name"] == "with friction, stability not known"
    )
    assert solid["x"].index(None) == half
    axes = parted.response.plot(parted.output, "tip").axes[0]
    (line,) = (each for each in axes.lines if each.get_label() == "with friction, stability not known")
    assert np.isnan(np.asarray(line.get_xdata(), dtype=float)).tolist().index(True) == half
    assert not any(str(each.get_label()).endswith("unstable") for each in axes.lines)


def test_arrows_run_from_before_to_after_each_jump_and_peaks_have_marks(view: View) -> None:
    figure = amplitude_frequency(view)
    label, *arrows = figure["layout"]["annotations"]
    assert label["text"].startswith("highest peak<br>")
    jumps = view.summary.notable_jumps
    assert [jump.direction for jump in jumps] == ["up", "down"]
    for arrow, jump, colour in zip(arrows, jumps, (UPWARD, DOWNWARD), strict=True):
        assert (arrow["x"], arrow["y"]) == (jump.frequency_hz, 1e6 * jump.amplitude_to)
        assert (arrow["ax"], arrow["ay"]) == (jump.frequency_hz, 1e6 * jump.amplitude_from)
        assert (arrow["axref"], arrow["ayref"], arrow["arrowcolor"]) == ("x", "y", colour)
    marks = {trace["name"]: trace for trace in figure["data"] if trace["name"].startswith("peak of")}
    up, down = marks["peak of a slow sweep up"], marks["peak of a slow sweep down"]
    assert (up["marker"]["symbol"], down["marker"]["symbol"]) == ("triangle-up", "triangle-down")
    assert up["y"][0] < 0.95 * down["y"][0]


def test_words_name_jumps_and_the_way_out_of_the_curve(view: View) -> None:
    words = sweep_words(view)
    up, down = view.summary.notable_jumps
    assert words.startswith("Some points are unstable. Solid parts are stable, dashed parts unstable")
    assert f"A slow sweep up jumps at {up.frequency_hz:.2f} Hz from {1e6 * up.amplitude_from:.4g} to" in words
    assert f"A slow sweep down jumps at {down.frequency_hz:.2f} Hz from {1e6 * down.amplitude_from:.4g} to" in words
    response = view.response
    part = [
        field.name for field in dataclasses.fields(response) if np.shape(getattr(response, field.name))[:1] == (40,)
    ]
    end = int(response.stable_points.argmin()) + 3  # on the part that runs back
    early = dataclasses.replace(response, **{name: getattr(response, name)[:end] for name in part})
    assert "A slow sweep up leaves the computed curve at 428." in sweep_words(View.of(early, synthetic_study()))
    assert sweep_words(View.of(synthetic_response(), synthetic_study())) == NO_STABILITY


@pytest.mark.slow
def test_tiles_tell_three_peaks_apart_and_one_where_nothing_folds(view: View) -> None:
    def tiles(text: str) -> list[str]:
        part = re.search(r'class="tiles".*?<section', text, flags=re.S)
        assert part is not None
        return re.findall(r"(?:Highest peak|Peak)[^<]*0‑to‑peak", part.group())

    study = synthetic_study()
    assert tiles(page(view.response, study)) == [
        "Highest peak on the curve, 0‑to‑peak",
        "Peak of a slow sweep up, 0‑to‑peak",
        "Peak of a slow sweep down, 0‑to‑peak",
    ]
    text = page(view.response, study)
    assert "only a slow sweep down reaches it" in text
    plain = page(synthetic_response(), study)
    assert tiles(plain) == ["Peak amplitude, 0‑to‑peak"]
    assert "of a slow sweep up and down alike" in plain
    figures = json.loads(re.search(r'id="page-figures">(.*?)</script>', plain, flags=re.S)[1])  # type: ignore[index]
    assert len(figures["curve"]["layout"]["annotations"]) == 1


def test_plain_figure_has_the_same_parts(view: View) -> None:
    response, row = view.response, view.study.outputs[view.study.response_output]
    axes = response.plot(row, "tip").axes[0]
    lines = {str(line.get_label()): line for line in axes.lines}
    assert lines["with friction, unstable"].get_linestyle() == "--"
    assert lines["with friction, stable"].get_linestyle() == "-"
    assert len(axes.texts) == len(view.summary.notable_jumps) == 2  # an annotation without words is an arrow
    assert any(name.startswith("slow sweep up:") for name in lines)
    plain = synthetic_response().plot(row, "tip").axes[0]
    assert not plain.texts
    assert "with friction" in {str(line.get_label()) for line in plain.lines}


def test_the_curve_fills_its_figure(view: View) -> None:
    figure = amplitude_frequency(view)
    highest = max(value for trace in figure["data"] for value in trace["y"] if value is not None)
    assert figure["layout"]["yaxis"]["range"] == pytest.approx([0.0, 1.15 * highest])
