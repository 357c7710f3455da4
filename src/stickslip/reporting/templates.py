"""Pages from the templates of the assets: all values in templates are escaped, and only the page's own scripts may
run."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup

from stickslip import __version__
from stickslip.core.shown_numbers import typeset

OWN_PACKAGE = "stickslip.reporting"
# Of style, plotly.js needs its own sheet and attributes; a picture is saved by way of a blob.
_POLICY = (
    "default-src 'none'; script-src {scripts}; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'none'; "
    "base-uri 'none'; form-action 'none'"
)


@dataclass(frozen=True)
class Notice:
    """A box with sentences; ``kind`` is "bad" or "warn"."""

    kind: str
    heading: str
    sentences: Sequence[str]


@dataclass(frozen=True)
class Tile:
    """A number of the summary with its name, its unit if it is separate, and a note."""

    name: str
    value: str
    unit: str = ""
    more: str = ""


@dataclass(frozen=True)
class StudyText:
    """The study file of a page, and the lines "section.key = value" of the keys that differ from their defaults."""

    text: str
    changed: Sequence[str] = ()


def asset(name: str, package: str = OWN_PACKAGE) -> str:
    """Text of a file of the assets of a package."""
    return (files(package) / "assets" / name).read_text(encoding="utf-8")


def rendered(template: str, values: Mapping[str, Any], package: str = OWN_PACKAGE) -> Markup:
    """A template of the assets filled with values; text in them is escaped. Raises jinja2.UndefinedError.

    Templates of another ``package`` may extend and import those of this one.
    """
    return Markup(_environment(package).get_template(template).render(values))


def rendered_text(template: str, values: Mapping[str, Any]) -> Markup:
    """A template in the code, which may use ``parts``; otherwise as :func:`rendered`."""
    return Markup(_template(template).render(values))


def whole_page(
    template: str,
    kind: str,
    values: Mapping[str, Any],
    provenance: Mapping[str, str],
    *,
    head_title: str = "",
    styles: Sequence[str] = (),
    scripts: Sequence[str] = (),
    data: Mapping[str, Any] | None = None,
    package: str = OWN_PACKAGE,
) -> str:
    """A page: a template of the assets that extends the frame which all pages share.

    values:
        title, description, byline, notices (:class:`Notice`) and tiles (:class:`Tile`) for the frame, ``answer`` where
        the page begins with sentences on its result, and what the template names.
    kind, head_title:
        the line above the title; the title of the window if it is another one.
    styles, scripts, data:
        further style sheets of the assets; scripts of the assets that draw figures with plotly, and what they read:
        id of an element -> value that becomes JSON. Without scripts the page has no plotly, only the tools of all
        pages.
    package:
        whose folder "assets" has the template and the further style sheets.
    """
    code = _scripts(scripts)
    frame = {
        "kind": kind,
        "head_title": head_title or values["title"],
        "css": Markup("\n").join([_own_text("page.css"), *(_own_text(name, package) for name in styles)]),
        "policy": _POLICY.format(scripts=" ".join(map(_source, code)) or "'none'"),
        "data": data or {},
        "scripts": code,
        "version": __version__,
        "provenance": provenance,
    }
    return str(rendered(template, {"answer": (), **values, **frame}, package))


def when(provenance: Mapping[str, str]) -> str:
    """The date of a provenance in words."""
    return provenance.get("date", "date unknown").replace("T", " ").replace("+00:00", " UTC")


@cache
def _template(text: str) -> Template:
    """A template in the code: a page with several of its kind, such as a sweep, compiles it once."""
    return _environment(OWN_PACKAGE).from_string('{% import "parts.html" as parts %}' + text)


def _unbroken(value: Any) -> Any:
    """Text in which no line ends within a number such as "8.2 × 10⁻⁴"; markup, as of scripts, remains as it is."""
    return value.replace(" × 10", "\u00a0×\u00a010") if type(value) is str else value


@cache
def _environment(package: str) -> Environment:
    places = dict.fromkeys((package, OWN_PACKAGE))
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(name, "assets") for name in places]),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_unbroken,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # short, and without numbers that JSON does not know; the filter "tojson" escapes what could end a script element
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "ensure_ascii": False, "allow_nan": False}
    environment.filters["typeset"] = typeset
    return environment


@cache
def _own_text(name: str, package: str = OWN_PACKAGE) -> Markup:
    """A style sheet or script of a package, which is no text of a user."""
    return Markup(asset(name, package))


def _scripts(own: Sequence[str]) -> tuple[Markup, ...]:
    """Scripts of the assets after plotly.js, if there are any, and the tools of every page."""
    tools = _own_text("tools.js")
    if not own:
        return (tools,)
    return _plotly(), *map(_own_text, own), tools


@cache
def _plotly() -> Markup:
    """The script of plotly.js, 4 MB."""
    from plotly.offline import get_plotlyjs

    return Markup(get_plotlyjs())


@cache
def _source(script: str) -> str:
    """The script for a Content-Security-Policy: its hash, of the text as a browser reads it."""
    read = script.replace("\r\n", "\n").replace("\r", "\n")
    return f"'sha256-{base64.b64encode(hashlib.sha256(read.encode()).digest()).decode('ascii')}'"
