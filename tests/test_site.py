"""The documentation site: it builds without a warning, asks no server for anything, and runs the examples it shows."""

from __future__ import annotations

import dataclasses
import importlib.util
import logging
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType

import pytest

import stickslip
from helpers import absent_tool
from sketches import stacked_boxes
from stickslip.reporting.page import page as report_page
from synthetic import synthetic_response, synthetic_study

ROOT = Path(__file__).parents[1]
# Attributes with an address that a browser loads by itself. (Links that a reader follows are in <a>.)
LOADED = {
    "link": "href", "script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src", "object": "data"
}  # fmt: skip


def hook(name: str) -> ModuleType:
    """A hook of the site, as mkdocs loads it."""
    if importlib.util.find_spec("mkdocs") is None:
        absent_tool("mkdocs", "python -m pip install --constraint constraints.txt --group docs")
    spec = importlib.util.spec_from_file_location(f"site_{name}", ROOT / "docs" / "site" / f"{name}.py")
    assert spec
    assert spec.loader
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Loaded(HTMLParser):
    """Collects what a page loads from a server."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        address = dict(attrs).get(LOADED.get(tag, ""))
        if address and re.match(r"(\w+:)?//", address):
            self.found.append(address)


def loaded_from_servers(page: str) -> list[str]:
    """Addresses of servers that a page loads something from."""
    parser = Loaded()
    parser.feed(page)
    return parser.found


def test_what_a_page_loads_is_seen() -> None:
    page = '<a href="https://a.org"></a><script src="//b.org/x.js"></script><img src="c.png"><link href="http://d.org">'
    assert loaded_from_servers(page) == ["//b.org/x.js", "http://d.org"]


@pytest.mark.long
@pytest.mark.filterwarnings("default")  # those of the builder's own packages
def test_the_site_builds_and_asks_no_server(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """All but the pictures of the gallery, which :func:`test_a_page_of_the_gallery` makes."""
    hook("pages")
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    monkeypatch.chdir(ROOT)
    config = load_config("mkdocs.yml", site_dir=str(tmp_path), hooks=["docs/site/pages.py"])
    with caplog.at_level(logging.WARNING, logger="mkdocs"):
        build(config)
    assert [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING] == []
    pages = sorted(tmp_path.rglob("*.html"))
    assert len(pages) > 30
    for page in pages:
        assert loaded_from_servers(page.read_text(encoding="utf-8")) == [], page
    for sheet in tmp_path.rglob("*.css"):
        assert not re.search(r"(@import|url\()\s*['\"]?(https?:)?//", sheet.read_text(encoding="utf-8")), sheet
    reference = "".join(page.read_text(encoding="utf-8") for page in (tmp_path / "reference").glob("*.html"))
    for name in stickslip.__all__:
        assert f"stickslip.{name}" in reference, name


@pytest.mark.slow
def test_a_page_of_the_gallery(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gallery = hook("gallery")
    script = tmp_path / "drawing.py"
    script.write_text("import matplotlib.pyplot as plt\nplt.plot([0, 1])\nprint('one line')\nplt.show()\n")
    monkeypatch.setattr(gallery, "ROOT", tmp_path)
    gallery._SHOWN["drawing.py"] = result = gallery.shown("drawing.py")
    assert result.files["drawing_1.png"].startswith(b"\x89PNG")
    text = gallery.on_page_markdown("# Goal\n<!-- example: drawing.py -->\n", None, None, None)
    for part in ("![drawing 1](drawing_1.png)", "one line", "plt.plot"):
        assert part in text


@pytest.mark.slow
def test_the_gallery_has_the_still_picture_of_a_report() -> None:
    report = report_page(synthetic_response(), dataclasses.replace(synthetic_study(), sketch=stacked_boxes()))
    (still,) = hook("gallery").stills(report.encode())
    assert still.startswith(b"\x89PNG")
    assert hook("gallery").stills(report_page(synthetic_response(), synthetic_study()).encode()) == []  # no structure


def test_an_example_without_a_picture_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gallery = hook("gallery")
    (tmp_path / "silent.py").write_text("x = 1\n")
    monkeypatch.setattr(gallery, "ROOT", tmp_path)
    with pytest.raises(RuntimeError, match=r"silent\.py"):
        gallery.shown("silent.py")


def test_every_example_that_draws_has_a_page() -> None:
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs" / "gallery").glob("*.md"))
    # The cluster example submits jobs; docs/sweeps.md shows it. A script that makes meshes draws nothing.
    actual = [path for ending in ("py", "toml") for path in (ROOT / "examples").rglob(f"*.{ending}")]
    examples = {path.relative_to(ROOT).as_posix() for path in actual}
    assert set(re.findall(r"<!-- example: (\S+) -->", pages)) == examples - {
        "examples/cluster_sweep.py",
        "examples/joints/make_meshes.py",
    }


def test_links_to_top_level_files_become_links_to_pages() -> None:
    pages = hook("pages")
    text = "[a](docs/theory.md), [b](ARCHITECTURE.md#x), [c](ARCHITECTURE.md), [d](src/x.py), [e](https://e.org)"
    assert pages.for_the_site(text) == "[a](theory.md), b, [c](architecture.md), d, [e](https://e.org)"
