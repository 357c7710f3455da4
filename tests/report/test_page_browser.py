"""The page in a real browser: no error, no request, every plot drawn, and it answers to the reader."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from helpers import opened_browser
from stickslip.report.page import write_page
from synthetic import synthetic_response, synthetic_study

PLOTS = 2 + 2 + 4 + 2


@pytest.fixture(scope="module")
def browser() -> Iterator:
    with opened_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_page(path, synthetic_response(), synthetic_study())
    return path


@pytest.fixture
def width() -> int:
    """Width of the window in px."""
    return 1280


@pytest.fixture
def page(browser, report, width) -> Iterator:
    opened = browser.new_page(viewport={"width": width, "height": 900})
    troubles: list[str] = []
    opened.on(
        "console", lambda message: troubles.append(message.text) if message.type in ("error", "warning") else None
    )
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.on("request", lambda asked: None if asked.url == report.as_uri() else troubles.append(asked.url))
    opened.goto(report.as_uri())
    opened.wait_for_selector("body[data-ready=yes]", timeout=60_000)
    yield opened
    opened.close()
    assert troubles == []


def colours(page, plot: str) -> list:
    return page.evaluate(f"Array.from(document.getElementById('{plot}').data[0].marker.color)")


def loop(page) -> list:
    return page.evaluate("document.getElementById('loop').data.map(trace => [trace.x, trace.y])")


def settle(page) -> None:
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.mark.parametrize("width", [1280, 400])
def test_plots_are_drawn_and_nothing_overflows(page):
    assert page.locator(".js-plotly-plot").count() == PLOTS
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    widths = page.evaluate("Array.from(document.querySelectorAll('.js-plotly-plot')).map(plot => plot.clientWidth)")
    assert min(widths) > 300
    assert len(loop(page)[0][0]) > 60


def test_slider_moves_the_maps_the_cursor_and_the_signals(page):
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


@pytest.mark.parametrize("width", [1280, 400])
def test_pair_by_select_click_and_arrow_keys(page):
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


def test_loop_of_the_page_is_that_of_the_package(page):
    response = synthetic_response()
    pair = int(page.input_value("#pair"))
    point = int(page.input_value("#point"))
    force = response.pair_cycle(point).force[:, pair]
    drawn = page.evaluate("document.getElementById('signals').data.slice(0, 3).map(trace => trace.y)")
    for axis in range(3):
        assert drawn[axis][:-1] == pytest.approx(force[:, axis].tolist(), abs=2e-4 * abs(force[:, 2]).max())


def test_curve_has_a_logarithmic_axis_on_request(page):
    page.click("#scale")
    page.wait_for_function("document.getElementById('curve').layout.yaxis.type === 'log'")
    assert page.inner_text("#scale") == "Linear axis"
