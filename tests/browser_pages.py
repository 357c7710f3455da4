"""What the browser tests of all pages share: a page that may not complain, and what a reader needs of it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

WIDTHS = (1280, 400)
SMALLEST_TEXT_PX = 11.0
LARGEST_PAGE = 15_000_000  # bytes

# What Chromium says of how plotly.js draws letters in space, and of a machine without a graphics card.
_ABOUT_SPEED = ("willReadFrequently", "GPU stall due to ReadPixels")

# Visible text that is smaller than it may be.
_SMALL = """(least) => {
  const small = [];
  const walker = document.createTreeWalker(document.querySelector('body'), NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const holder = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || !holder.getClientRects().length) continue;
    if (holder.closest('script, style')) continue;
    if (parseFloat(getComputedStyle(holder).fontSize) < least) small.push(walker.currentNode.data.trim());
  }
  return small;
}"""
_FOCUS = """() => {
  const held = document.activeElement, look = getComputedStyle(held);
  const words = held.getAttribute('aria-label') || (held.labels && held.labels[0] && held.labels[0].textContent);
  return {
    tag: held.tagName.toLowerCase(), id: held.id, name: (words || held.textContent || '').trim(),
    ring: look.outlineStyle !== 'none' && parseFloat(look.outlineWidth) >= 1,
    shown: held.getClientRects().length > 0,
  };
}"""


@contextmanager
def opened_page(
    browser: Any, path: Path, width: int = 1280, drawn: bool = True, before: str = "", **options: Any
) -> Iterator[Any]:
    """The page of a file; afterwards no error or warning stands on its console and nothing else was asked for.

    ``drawn``: wait until its script has drawn the plots; ``before``: a script that runs before those of the page;
    ``options`` are those of playwright for a new page.
    """
    page, troubles = browser.new_page(viewport={"width": width, "height": 900}, **options), []
    if before:
        page.add_init_script(before)

    def hear(said: Any) -> None:
        is_about_speed = said.type == "warning" and any(words in said.text for words in _ABOUT_SPEED)
        if said.type in ("error", "warning") and not is_about_speed:
            troubles.append(said.text)

    page.on("console", hear)
    page.on("pageerror", lambda error: troubles.append(str(error)))
    own = ("data:", "blob:", path.as_uri())  # data and blobs are of the page itself
    page.on("request", lambda asked: None if asked.url.startswith(own) else troubles.append(asked.url))
    page.goto(path.as_uri())
    if drawn:
        page.wait_for_selector("body[data-ready=yes]", timeout=60_000)
        if page.locator("#structure").count():
            page.wait_for_selector("#structure[data-ready]", timeout=60_000)
    yield page
    page.close()
    assert troubles == [], troubles


def require_readable(page: Any) -> None:
    """Nothing is wider than the window, no text too small, every picture and plot says in words what it shows."""
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert page.evaluate("document.body.scrollWidth <= window.innerWidth")
    small = page.evaluate(_SMALL, SMALLEST_TEXT_PX)
    assert small == [], small
    unnamed = page.evaluate(
        "[...document.querySelectorAll('img, .js-plotly-plot, svg[role=img]')].filter(each => "
        "!(each.getAttribute('alt') || each.getAttribute('aria-label'))).map(each => each.id || each.alt)"
    )
    assert unnamed == [], unnamed
    assert page.evaluate("document.documentElement.lang") == "en"


def tab_stops(page: Any, most: int = 400) -> list[dict[str, Any]]:
    """Where the Tab key leads, from the top of the page to its end; each stop is seen and has a visible ring."""
    page.evaluate("() => { document.activeElement.blur(); window.scrollTo(0, 0); }")
    stops: list[dict[str, Any]] = []
    for _ in range(most):
        page.keyboard.press("Tab")
        stop = page.evaluate(_FOCUS)
        if stop["tag"] == "body":
            break
        assert stop["shown"], stop
        assert stop["ring"], stop
        assert stop["name"], stop
        stops.append(stop)
    else:
        raise AssertionError(f"the end of the page was not reached by {most} presses of Tab")
    return stops
