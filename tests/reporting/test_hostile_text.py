"""Text of a file reaches the pages escaped, whatever it is; and no code of the pages makes markup in another way."""

from __future__ import annotations

import ast
import base64
import dataclasses
import hashlib
import html
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jinja2
import pytest

import stickslip
from hostile import ATTACKS, hostile, write_hostile_pages
from stickslip.papers.rough_damper.page import DOI
from stickslip.reporting import figures
from stickslip.reporting.look import PlotMarkup, plain_figures
from stickslip.reporting.templates import rendered
from synthetic import synthetic_response, synthetic_study

SOURCE = Path(stickslip.__file__).parent
ASSETS = SOURCE / "reporting" / "assets"
PAPER = SOURCE / "papers" / "rough_damper"
# Elements and attributes that the pages have; whatever else stands in a page came out of a text.
_TAG_NAMES = (
    "html head meta title link style body header div p h1 h2 h3 main section ul li small b button figure "
    "figcaption label output input select option span table caption thead tbody tr th td pre footer "
    "script svg rect path circle sub details summary nav a img code"
)
TAGS = frozenset(_TAG_NAMES.split())


class Reader(HTMLParser):
    """What a browser reads in a page: words, elements, attributes, and the text of its scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.tags: set[str] = set()
        self.attributes: list[tuple[str, str]] = []
        self.scripts: list[tuple[dict[str, str | None], str]] = []
        self._inside = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes += [(name, value or "") for name, value in attrs]
        self._inside = tag
        if tag == "script":
            self.scripts.append((dict(attrs), ""))

    def handle_data(self, data: str) -> None:
        if self._inside == "script" and self.scripts:
            self.scripts[-1] = (self.scripts[-1][0], self.scripts[-1][1] + data)
        else:
            self.words.append(data)

    def handle_endtag(self, tag: str) -> None:
        self._inside = ""

    def policy(self) -> str:
        return next(value for _, value in self.attributes if value.startswith("default-src"))


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Name -> text of a page, and the fields that must be read in it."""
    folder = tmp_path_factory.mktemp("hostile")
    return {
        name: ((folder / f"{name}.html").read_text(encoding="utf-8"), fields)
        for name, fields in write_hostile_pages(folder).items()
    }


ARTICLE = ("href", f"https://doi.org/{DOI}")
KINDS = pytest.mark.parametrize("kind", ["report", "sweep", "band", "design", "paper"])


@pytest.mark.slow
@KINDS
def test_every_text_is_read_as_it_is_and_makes_no_element(pages: Any, kind: str) -> None:
    text, fields = pages[kind]
    read = Reader(text)
    words = "".join(read.words)
    assert [field for field in fields if hostile(field).replace("_", " ") not in words] == []
    assert read.tags - {"textarea"} <= TAGS
    assert "textarea" not in read.tags
    assert [name for name, _ in read.attributes if name.startswith("on") or name == "style"] == []
    # The DOI of the article is a link that a reader may follow; the page itself loads nothing.
    links = [value for name, value in read.attributes if name in ("href", "src") and (name, value) != ARTICLE]
    assert all(value.startswith(("data:", "#", "figures/", "tables/", "cases/")) for value in links), links


@pytest.mark.slow
@KINDS
def test_no_attack_is_in_a_page_unescaped(pages: Any, kind: str) -> None:
    text, _ = pages[kind]
    for attack in ATTACKS:
        if html.escape(attack) != attack and "%{" not in attack:
            assert attack not in text, attack


@pytest.mark.slow
@KINDS
def test_data_can_not_end_their_script_nor_begin_another(pages: Any, kind: str) -> None:
    read = Reader(pages[kind][0])
    held = [code for attributes, code in read.scripts if attributes.get("type") == "application/json"]
    assert len(held) == {"report": 3, "sweep": 1, "band": 1, "design": 1, "paper": 0}[kind]
    for code in held:
        assert not set("<>&") & set(code)
        json.loads(code)
    others = [attributes for attributes, _ in read.scripts if not attributes]
    assert len(others) == {"report": 6, "sweep": 3, "band": 3, "design": 3, "paper": 1}[kind]  # plotly.js and own
    assert len(read.scripts) == len(held) + len(others)


@pytest.mark.slow
@KINDS
def test_the_policy_allows_the_scripts_of_the_page_and_nothing_else(pages: Any, kind: str) -> None:
    read = Reader(pages[kind][0])
    policy = dict(part.split(" ", 1) for part in read.policy().split("; "))
    own = [code for attributes, code in read.scripts if not attributes]
    hashes = [base64.b64encode(hashlib.sha256(code.encode()).digest()).decode() for code in own]
    assert policy == {
        "default-src": "'none'",
        "script-src": " ".join(f"'sha256-{each}'" for each in hashes) or "'none'",
        "style-src": "'unsafe-inline'",
        "img-src": "data: blob:",
        "connect-src": "'none'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    head = pages[kind][0]
    assert head.index("Content-Security-Policy") < min(head.index("<style"), head.index("<title"), head.index("<link"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["report", "sweep", "band", "design"])
def test_texts_of_figures_have_no_markup_but_their_own(pages: Any, kind: str) -> None:
    """plotly.js makes links and bold letters of tags, decodes entities, and fills "%{x}" in."""
    read = Reader(pages[kind][0])
    held = {attributes.get("id"): json.loads(code) for attributes, code in read.scripts if attributes.get("id")}
    drawn = [held["page-figures"], *([held["structure-data"]["figure"]] if kind == "report" else [])]
    texts = list(_texts(drawn))
    own = re.compile(r"<br>|<extra></extra>|%\{(x|y|z|text)(:[^{}]*)?\}")
    for text in texts:
        rest = own.sub("", text)
        assert not set("<>%") & set(rest), text
        assert re.fullmatch(r"(?:[^&]|&(?:amp|lt|gt|#34|#39|#37);)*", rest), text
    structure = ("body-0", "body-1", "face-0", "load", "response")
    fields = {
        "report": ("output-2", "output-7", *structure),
        "band": ("key-0",),
        "design": ("key-0", "load-0", "load-1"),
        "sweep": ("key-unit", "second-1", "third-1", "key-0", "key-1"),
    }[kind]
    shown = "\n".join(html.unescape(text) for text in texts)
    assert [field for field in fields if hostile(field).replace("_", " ") not in shown] == []


def _texts(value: Any) -> Any:
    if isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _texts(each)
    elif isinstance(value, str):
        yield value


def test_texts_of_a_figure_are_escaped_unless_they_are_markup() -> None:
    values = {"a": ["<b>50 % & %{x}</b>", 1.5, None], "b": PlotMarkup("{}<br>%{{x}} {:.1f}").format("<i>%{y}", 2.0)}
    assert plain_figures(values) == {
        "a": ["&lt;b&gt;50 &#37; &amp; &#37;{x}&lt;/b&gt;", 1.5, None],
        "b": "&lt;i&gt;&#37;{y}<br>%{x} 2.0",
    }


def test_a_template_that_names_what_it_was_not_given_is_an_error() -> None:
    with pytest.raises(jinja2.UndefinedError, match="'caption' is undefined"):
        rendered("structure.html", {"legend": [], "deflection": "", "words": "", "still": ""})


@pytest.mark.long
@pytest.mark.parametrize("name", ["$x^{2$", "--><script>", "<b>R&D</b>"])
def test_a_figure_shows_names_as_they_are(tmp_path: Path, name: str) -> None:
    """A "$" begins no mathematics, and names in an SVG file are no elements of it, nor end a comment."""
    study, response = synthetic_study(), synthetic_response()
    rows = dict(zip([name, *list(study.outputs)[1:]], study.outputs.values(), strict=True))
    named = dataclasses.replace(study, outputs=rows, face_names=(name, name))
    for draw in (figures.amplitude_frequency, figures.contact_states, figures.hysteresis_loop):
        drawn, usual = (
            figures.save(draw(response, record), tmp_path / f"{place}.svg")
            for place, record in enumerate((named, study))
        )
        tags = [{each.tag for each in ElementTree.parse(file).iter()} for file in (drawn, usual)]
        assert tags[0] == tags[1]


def files_of_pages(pattern: str) -> list[Path]:
    actual = sorted((SOURCE / "reporting").glob(pattern))
    assert actual, f"no {pattern}: has the folder another name?"
    return actual


def _modules_of_pages() -> list[Path]:
    return [*files_of_pages("*.py"), PAPER / "page.py"]


@pytest.mark.parametrize("module", _modules_of_pages(), ids=lambda path: path.stem)
def test_code_makes_markup_of_its_own_words_alone(module: Path) -> None:
    """Markup is written out in the code, where format escapes what is put in; only templates.py makes it of texts: of
    what a template gave, and of files of the package and plotly.js."""
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        name = node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""
        if name in ("Markup", "PlotMarkup") and module.stem != "templates":
            assert isinstance(node.args[0], ast.Constant), f"{module.name}:{node.lineno}"  # type: ignore[attr-defined]
        if isinstance(node, ast.JoinedStr):
            written = "".join(str(part.value) for part in node.values if isinstance(part, ast.Constant))
            assert not re.search(r"</?[a-z]|<!--", written), f"{module.name}:{node.lineno}: HTML outside of templates"


def test_own_scripts_write_no_html() -> None:
    for script in files_of_pages("assets/*.js"):
        code = script.read_text(encoding="utf-8")
        for way in (
            "innerHTML",
            "outerHTML",
            "insertAdjacentHTML",
            "document.write",
            "eval(",
            "Function(",
            "DOMParser",
        ):
            assert way not in code, (script.name, way)


def test_templates_mark_no_text_as_safe_and_handle_no_events_inline() -> None:
    of_paper = sorted((PAPER / "assets").glob("*.html"))
    assert of_paper
    for template in [*files_of_pages("assets/*.html"), *files_of_pages("*section*.py"), *of_paper]:
        text = template.read_text(encoding="utf-8")
        assert not re.search(r"\|\s*safe\b|autoescape|\son\w+\s*=|javascript:", text), template.name
