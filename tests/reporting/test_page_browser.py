"""The page in a real browser: no error, no request, every plot drawn, and it answers to the reader."""

import json
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from browser_pages import LARGEST_PAGE, WIDTHS, opened_page, require_readable, tab_stops
from helpers import opened_browser
from large_results import large_result
from stickslip.reporting.page import write_page
from synthetic import synthetic_response, synthetic_study

pytestmark = pytest.mark.slow

PLOTS = 2 + 2 + 4 + 2 + 2 + 1


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_page(path, synthetic_response(), synthetic_study())
    return path


@pytest.fixture
def width() -> int:
    """Width of the window in px."""
    return 1280


@pytest.fixture(scope="module")
def opened_pages(browser: Any, report: Path) -> Iterator[dict[int, Any]]:
    """The page in a window of each width, with the pair that it opens with."""
    with ExitStack() as stack:
        opened = {width: stack.enter_context(opened_page(browser, report, width)) for width in WIDTHS}
        yield {width: (page, page.input_value("#pair")) for width, page in opened.items()}


@pytest.fixture
def page(opened_pages: dict[int, Any], width: int) -> Iterator[Any]:
    """The page as it opens; it takes seconds to draw, so tests share it."""
    page, pair = opened_pages[width]
    yield page
    page.click("#to-peak")
    page.select_option("#pair", pair)
    if page.inner_text("#scale") == "Linear axis":
        page.click("#scale")
    settle(page)


def colours(page: Any, plot: str) -> list[str]:
    return list(page.evaluate(f"Array.from(document.getElementById('{plot}').data[0].marker.color)"))


def loop(page: Any) -> list[Any]:
    return list(page.evaluate("document.getElementById('loop').data.map(trace => [trace.x, trace.y])"))


def settle(page: Any) -> None:
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


# Between the tasks of the page: whether the curve was there to be painted while other figures were still to come.
_WATCH = """(() => {
  const look = () => {
    const [curve, energy] = ['#curve', '#energy-curve'].map(plot => document.querySelector(plot + ' .trace'));
    if (curve && !energy) window.curveFirst = true;
    if (!document.body || !document.body.dataset.ready) setTimeout(look, 0);
  };
  look();
})()"""


@pytest.mark.long
def test_the_curve_is_shown_before_the_other_figures_are_drawn(browser: Any, report: Path) -> None:
    with opened_page(browser, report, before=_WATCH) as page:
        assert page.evaluate("window.curveFirst") is True


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_plots_are_drawn_and_nothing_overflows(page: Any) -> None:
    assert page.locator(".js-plotly-plot").count() == PLOTS
    require_readable(page)
    widths = page.evaluate("Array.from(document.querySelectorAll('.js-plotly-plot')).map(plot => plot.clientWidth)")
    assert min(widths) > 300
    assert len(loop(page)[0][0]) > 60


def test_slider_moves_the_maps_the_cursor_and_the_signals(page: Any) -> None:
    before = colours(page, "state-map-0"), page.evaluate("document.getElementById('group-0').data[0].y")
    page.locator("#point").focus()
    page.keyboard.press("Home")
    settle(page)
    after = colours(page, "state-map-0"), page.evaluate("document.getElementById('group-0').data[0].y")
    assert after[0] != before[0]
    assert set(after[0]) == {"#0072B2"}
    assert after[1] != before[1]
    first = page.evaluate("document.getElementById('curve').data.at(-1).x[0]")
    assert first == pytest.approx(synthetic_response().frequency_hz[0], abs=1e-5)
    assert "1 of 40" in page.inner_text("#point-label")
    assert "stuck110" in page.inner_text("#state-legend").replace("\n", "").replace(" ", "")
    page.click("#to-peak")
    settle(page)
    assert colours(page, "state-map-0") == before[0]


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_pair_by_select_click_and_arrow_keys(page: Any) -> None:
    before, chosen = loop(page), page.input_value("#pair")
    page.select_option("#pair", "3")
    assert loop(page) != before
    assert "Left face, pair 4" in page.inner_text("#pair-now")
    place = page.evaluate(
        "(() => { const map = document.getElementById('state-map-1'); const full = map._fullLayout;"
        "return [full.xaxis.d2p(map.data[0].x[27]), full.yaxis.d2p(map.data[0].y[27])]; })()"
    )
    page.evaluate("document.getElementById('state-map-1').scrollIntoView({block: 'center'})")
    settle(page)
    box = page.locator("#state-map-1 .nsewdrag").bounding_box()
    page.mouse.move(box["x"] + place[0], box["y"] + place[1])
    page.mouse.click(box["x"] + place[0], box["y"] + place[1])
    page.wait_for_function("document.getElementById('pair').value === '82'", timeout=5_000)
    clicked = loop(page)
    page.locator("#state-map-1").focus()
    page.keyboard.press("ArrowRight")
    assert page.input_value("#pair") == "87"  # five pairs across: the next along the length
    assert loop(page) != clicked
    page.keyboard.press("ArrowUp")
    assert page.input_value("#pair") == "88"
    page.select_option("#pair", chosen)
    assert loop(page) == before


SHOWN = """Object.fromEntries(
  ['curve', 'energy-curve', 'state-map-0', 'energy-map-0', 'energy-map-1', 'loop', 'signals', 'group-0'].map(id => [
    id, document.getElementById(id)._fullData.map(trace => [trace.x, trace.y, trace.text, trace.name, trace.marker && [
      trace.marker.color, trace.marker.symbol, trace.marker.cmin, trace.marker.cmax, trace.marker.cauto]])]))"""


@pytest.mark.long
def test_what_the_page_opens_with_is_what_a_choice_of_the_same_point_shows(browser: Any, report: Path) -> None:
    with opened_page(browser, report) as page:
        opened = page.evaluate(SHOWN)
        page.locator("#point").focus()
        page.keyboard.press("Home")
        settle(page)
        assert page.evaluate(SHOWN) != opened
        page.locator("#to-peak").click()
        settle(page)
        assert page.evaluate(SHOWN) == opened


def test_loop_of_the_page_is_that_of_the_package(page: Any) -> None:
    response = synthetic_response()
    pair = int(page.input_value("#pair"))
    point = int(page.input_value("#point"))
    force = response.pair_cycle(point).force[:, pair]
    drawn = page.evaluate("document.getElementById('signals').data.slice(0, 3).map(trace => trace.y)")
    for axis in range(3):
        assert drawn[axis][:-1] == pytest.approx(force[:, axis].tolist(), abs=2e-4 * abs(force[:, 2]).max())


@pytest.mark.long
def test_curve_has_a_logarithmic_axis_on_request(page: Any) -> None:
    page.click("#scale")
    page.wait_for_function("document.getElementById('curve').layout.yaxis.type === 'log'")
    assert page.inner_text("#scale") == "Linear axis"


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_the_keyboard_alone_moves_the_point_and_the_pair(browser: Any, report: Path, width: int) -> None:
    with opened_page(browser, report, width) as page:  # of its own: the keyboard starts at its top
        stops = tab_stops(page)
        wanted = ["scale", "point", "to-peak", "previous-pair", "pair", "next-pair"]
        wanted += [f"{quantity}-map-{face}" for quantity in ("state", "energy") for face in (0, 1)]
        actual = [stop["id"] for stop in stops]
        assert [name for name in actual if name in wanted] == wanted  # all of them, in the order of the page
        assert {"The complete study file", "Measures at the peak", "Natural frequencies"} <= {
            stop["name"] for stop in stops
        }
        start, before = int(page.input_value("#point")), loop(page)
        go_to(page, "point")
        page.keyboard.press("ArrowLeft")
        settle(page)
        assert int(page.input_value("#point")) == start - 1
        page.keyboard.press("Home")
        settle(page)
        assert loop(page) != before
        assert "1 of 40" in page.get_attribute("#point", "aria-valuetext")
        go_to(page, "to-peak")
        page.keyboard.press("Enter")
        settle(page)
        assert (int(page.input_value("#point")), loop(page)) == (start, before)
        go_to(page, "energy-map-1")
        page.keyboard.press("ArrowRight")
        assert int(page.input_value("#pair")) >= 55  # a pair of that face
        assert loop(page) != before
        go_to(page, "scale")
        page.keyboard.press("Space")
        page.wait_for_function("document.getElementById('curve').layout.yaxis.type === 'log'")


def go_to(page: Any, name: str) -> None:
    """Press Tab until an element has the focus."""
    page.evaluate("() => document.activeElement.blur()")
    while page.evaluate("document.activeElement.id") != name:
        page.keyboard.press("Tab")


@pytest.mark.long
def test_size_and_points_of_a_long_curve(browser: Any, tmp_path: Path) -> None:
    """Pages stay small because the curves and loops are thinned by their shape; nothing of the shape is lost."""
    response = synthetic_response(n_points=150)
    path = tmp_path / "long.html"
    write_page(path, response, synthetic_study())
    assert path.stat().st_size < LARGEST_PAGE
    with opened_page(browser, path) as page:
        drawn = page.evaluate("document.getElementById('curve').data[2].x.length")
        assert drawn == 150
        assert page.get_attribute("#point", "max") == "149"
        assert page.locator(".js-plotly-plot").count() == PLOTS


@pytest.mark.long
@pytest.mark.parametrize(("n_pairs", "characters", "has_loops"), [(2000, 9_000_000, True), (110, 216_000, False)])
def test_what_a_page_of_very_many_pairs_leaves_out_is_reported(
    browser: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, n_pairs: int, characters: int, has_loops: bool
) -> None:
    monkeypatch.setattr("stickslip.reporting.page_data.DATA_CHARACTERS", characters)
    path = tmp_path / "many.html"
    write_page(path, *large_result(n_pairs, 300))
    assert path.stat().st_size < LARGEST_PAGE
    with opened_page(browser, path) as page:
        data = json.loads(page.text_content("#page-data"))
        assert 1 < len(data["mapPoints"]) < 300
        away = next(point for point in range(300) if point not in data["mapPoints"])
        page.evaluate(
            "point => { const slider = document.getElementById('point'); slider.value = point; "
            "slider.dispatchEvent(new Event('input')); }",
            away,
        )
        words = f"(this page contains maps of {len(data['mapPoints'])} points; this is the nearest)"
        page.wait_for_function("words => document.querySelector('.now').textContent.includes(words)", arg=words)
        reported = page.text_content("#loop-now")
        if has_loops:
            assert (
                f"(this page contains loops of {len(data['loops']['points'])} points; this is the nearest)" in reported
            )
            assert page.evaluate("document.getElementById('loop').data[0].x.length") > 60
        else:
            assert "(loops of so many pairs would make this page too large; the results file contains them)" in reported
            assert page.evaluate("document.getElementById('loop').data[0].x.length") == 0
        counts = page.eval_on_selector_all("#state-legend b", "all => all.map(each => Number(each.textContent))")
        assert sum(counts) == data["nPairs"]


# Width of the marks of a map over the distance of two neighbours, px.
_MARKS = """() => {
  const plot = document.getElementById('state-map-0'), trace = plot.data[0], axis = plot._fullLayout.xaxis;
  const places = [...new Set(Array.from(trace.x, x => axis.d2p(x)))].sort((a, b) => a - b);
  return trace.marker.size / Math.min(...places.slice(1).map((x, i) => x - places[i]));
}"""
# Rows whose value covers their name.
_COVERED = """[...document.querySelectorAll('.quantities tbody tr')].filter(row => {
  const words = document.createRange(), value = document.createRange();
  words.selectNodeContents(row.cells[0]);
  value.selectNodeContents(row.cells[1]);
  return row.offsetParent && [...words.getClientRects()].some(a => [...value.getClientRects()].some(b =>
    Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
    Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1));
}).map(row => row.textContent)"""


@pytest.mark.long
def test_on_a_phone_marks_and_numbers_do_not_cover_each_other(browser: Any, tmp_path: Path) -> None:
    study = synthetic_study()
    row = ("Natural frequencies, stuck", "1495.33, 1517.56, 1230.27, 1292.33", "Hz", "contacts that are closed")
    study = replace(study, derived=(*study.derived, row))
    write_page(tmp_path / "phone.html", synthetic_response(), study)
    with opened_page(browser, tmp_path / "phone.html", WIDTHS[1]) as page:
        assert page.evaluate(_MARKS) < 1.0
        assert page.evaluate(_COVERED) == []
