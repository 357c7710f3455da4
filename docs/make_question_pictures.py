"""Create the pictures of docs/questions.md from the results of its commands.

python docs/make_question_pictures.py FOLDER [BROWSER]
(FOLDER with mode, gradients, band, performance, light)
"""

import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

import stickslip as ss

IMAGES = Path(__file__).parent / "images"
MOST_HEIGHT = 640  # px; tables below a plot are not in the picture
# Results -> name of the picture of their performance curve.
CURVES = {"performance": "question_performance.png", "light": "question_performance_light.png"}
# Page and heading of its section -> name of the picture.
SECTIONS = {
    ("mode/report.html", "Nonlinear mode"): "question_mode.png",
    ("gradients/report.html", "Which input matters most"): "question_inputs.png",
    ("band/band.html", "Amplitude against frequency"): "question_band.png",
}


def main(folder: str, program: str | None = None) -> None:
    """Write the pictures. ``program`` is a browser; the default is the browser of playwright."""
    for name, picture in CURVES.items():
        curve = ss.ForcedResponse.load(Path(folder) / name / "results.nc").performance_curve
        assert curve is not None
        curve.plot().savefig(IMAGES / picture, dpi=120)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 900, "height": 900})
        for (name, heading), picture in SECTIONS.items():
            page.goto((Path(folder) / name).resolve().as_uri())
            page.wait_for_selector("body[data-ready=yes]")
            section = page.locator("section", has=page.locator("h2", has_text=heading)).first
            section.scroll_into_view_if_needed()
            page.wait_for_timeout(1500)  # plots are drawn when they come into view
            page.evaluate("scrollTo(0, 0)")
            box = section.bounding_box()
            assert box is not None
            clip = {**box, "height": min(box["height"], MOST_HEIGHT)}
            page.screenshot(path=IMAGES / picture, clip=clip, full_page=True)
            print(f"Wrote {IMAGES / picture}")
        browser.close()


if __name__ == "__main__":
    main(*sys.argv[1:3])
