"""Solve the study of "stickslip new" and create the pictures of its report for docs/reading_the_report.md.

python docs/make_report_pictures.py       (requires playwright with Chromium; takes half a minute)
"""

import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

import stickslip as ss

IMAGES = Path(__file__).parent / "images"
# heading of the section -> name of the picture
SECTIONS = {
    "Amplitude against frequency": "report_curve.png",
    "Performance curve of the damper": "report_performance.png",
    "Structure": "report_structure.png",
    "Contact states": "report_states.png",
    "Hysteresis and time signals of one pair": "report_loop.png",
}


def main(program: str | None = None) -> None:
    """Write the pictures. ``program`` is a browser; the default is the browser of playwright."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        ss.run(ss.Case.from_mapping({"solver": {"accuracy": "2 %"}}), folder)
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 900, "height": 900})
        page.goto((Path(folder) / "report.html").as_uri())
        page.wait_for_selector("body[data-ready=yes]")
        page.wait_for_selector("#structure[data-ready=live]")
        page.add_style_tag(content=".controls { position: static !important; }")
        for heading, name in SECTIONS.items():
            page.locator("section", has=page.locator("h2", has_text=heading)).first.screenshot(path=IMAGES / name)
            print(f"Wrote {IMAGES / name}")
        browser.close()


if __name__ == "__main__":
    main(*sys.argv[1:2])
