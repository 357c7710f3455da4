"""Hook of mkdocs: run the example that a page of the gallery names, and show its pictures, output and source.

A page contains ``<!-- example: examples/own_matrices.py -->`` at their position. A script runs as a reader would run
it; the page shows its open matplotlib figures. ``stickslip.run`` runs a study file; the page shows its figures and its
report.
"""

from __future__ import annotations

import base64
import contextlib
import io
import os
import re
import runpy
import tempfile
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
STILL = re.compile(rb'<img class="still"[^>]*base64,([^"]+)"')
MARK = re.compile(r"<!-- example: (\S+) -->")


@dataclass(frozen=True)
class Shown:
    """Result of an example: files by name, and the printed lines."""

    files: dict[str, bytes]
    printed: str


_SHOWN: dict[str, Shown] = {}


def run_script(path: Path) -> Shown:
    """Run a script. Its open matplotlib figures are the pictures."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.close("all")
    printed, before = io.StringIO(), Path.cwd()
    os.chdir(ROOT)
    try:
        with contextlib.redirect_stdout(printed), patch.object(plt, "show"):  # nobody waits for a window here
            runpy.run_path(str(path), run_name="__main__")
    finally:
        os.chdir(before)
    files = {}
    for number in plt.get_fignums():
        picture = io.BytesIO()
        plt.figure(number).savefig(picture, format="png", dpi=150)
        files[f"{path.stem}_{number}.png"] = picture.getvalue()
    plt.close("all")
    return Shown(files, printed.getvalue())


def stills(report: bytes) -> list[bytes]:
    """The static image of the structure on a report, as PNG; none for matrices without a shape."""
    return [base64.b64decode(image) for image in STILL.findall(report)]


def run_study(path: Path) -> Shown:
    """Run a study file. Its figures are the pictures; its report is a separate page."""
    import stickslip as ss

    name = path.parent.name if path.stem == "study" else f"{path.parent.name}_{path.stem}"
    with tempfile.TemporaryDirectory() as folder:
        outcome = ss.run(ss.load_case(path), folder)
        if not outcome.converged:
            raise RuntimeError(f"{path} did not converge: {outcome.message}")
        pictures = sorted(file for file in outcome.files if file.suffix == ".png")
        report = (Path(folder) / "report.html").read_bytes()
        files = {f"{name}_structure.png": still for still in stills(report)}
        files |= {f"{name}_{picture.name}": picture.read_bytes() for picture in pictures}
        files[f"{name}_report.html"] = report
    return Shown(files, outcome.message)


def shown(example: str) -> Shown:
    """Run an example. Raises RuntimeError if a script has no open figure at its end."""
    path = ROOT / example
    result = run_script(path) if path.suffix == ".py" else run_study(path)
    if not any(name.endswith(".png") for name in result.files):
        raise RuntimeError(f"{example} leaves no open matplotlib figure, so the gallery has no picture of it.")
    return result


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Run the examples of all pages and add their pictures."""
    for page in [file for file in files if file.src_uri.startswith("gallery/") and file.is_documentation_page()]:
        for example in MARK.findall(page.content_string):
            print(f"Running {example}", flush=True)
            _SHOWN[example] = result = shown(example)
            for name, content in result.files.items():
                files.append(File.generated(config, f"gallery/{name}", content=content))
    return files


def block(example: str) -> str:
    """Return pictures, output and source of an example as Markdown."""
    result = _SHOWN[example]
    lines = []
    for name in result.files:
        if name.endswith(".png"):
            words = Path(name).stem.replace("_", " ")
            lines.append(f"![{words}]({name})\n")
        else:
            lines.append(f"[The report of this study]({name}) contains all figures and tables on one page.\n")
    if result.printed.strip():
        lines.append(f"Output:\n\n```text\n{result.printed.rstrip()}\n```\n")
    source = (ROOT / example).read_text(encoding="utf-8")
    language = "python" if example.endswith(".py") else "toml"
    lines.append(f"## {example}\n\n```{language}\n{source.rstrip()}\n```\n")
    return "\n".join(lines)


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Replace each mark of a page by the result of its example."""
    return MARK.sub(lambda match: block(match.group(1)), markdown)
