"""How long pages take to open in a browser: from the start of the navigation until every plot is drawn.

python benchmarks/page_opening.py report.html paper.html sweep.html
Every page is opened three times; the fastest is told, with the size of the file.
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path
from typing import Any

REPEATS = 3
PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
# Pages without a script are drawn once two frames have passed after their load event.
_DRAWN = """() => new Promise(done => {
  const told = () => requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now())));
  const look = () => {
    const waits = document.getElementById('page-figures') && document.body.dataset.ready !== 'yes';
    if (waits || document.readyState !== 'complete') setTimeout(look, 5); else told();
  };
  look();
})"""


def seconds_to_drawn(browser: Any, path: Path) -> float:
    """Seconds from the start of the navigation to the last plot, by the clock of the page."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto(path.resolve().as_uri(), wait_until="commit")
    milliseconds = float(page.evaluate(_DRAWN))
    page.close()
    return milliseconds / 1e3


def main(arguments: list[str] | None = None) -> dict[str, float]:
    """Print a row for each page; returns name -> seconds."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="+", type=Path)
    pages = parser.parse_args(arguments).pages
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    found = {}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        for path in pages:
            found[path.name] = min(seconds_to_drawn(browser, path) for _ in range(REPEATS))
            print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB, drawn after {found[path.name]:.2f} s", flush=True)
        browser.close()
    return found


if __name__ == "__main__":
    main()
