"""Pieces of HTML that the pages share."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.metadata import version
from importlib.resources import files
from typing import Any


def asset(name: str) -> str:
    """Text of a file of the assets."""
    return (files("stickslip.reporting") / "assets" / name).read_text(encoding="utf-8")


def filled(template: str, parts: Mapping[str, str]) -> str:
    """A template of the assets with every ``{{name}}`` replaced by its part."""
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)], asset(template))


def whole_page(
    template: str,
    kind: str,
    parts: Mapping[str, str],
    provenance: Mapping[str, str],
    *,
    head_title: str = "",
    styles: Sequence[str] = (),
    script: str = "",
    data: Mapping[str, Any] | None = None,
) -> str:
    """A page: the frame that all pages share around the body that ``template`` makes of ``parts``.

    parts:
        HTML of title, description, byline, notices and tiles for the frame, and of what the template names.
    kind, head_title:
        the line above the title; the title of the window if it is another one.
    styles, script, data:
        further style sheets of the assets; the script of the assets that draws figures with plotly, and what it reads:
        id of an element -> value that becomes JSON. Without a script the page has none, nor plotly.
    """
    scripts = ""
    if script:
        from plotly.offline import get_plotlyjs

        elements = [
            f'<script type="application/json" id="{name}">{script_json(value)}</script>'
            for name, value in (data or {}).items()
        ]
        scripts = "\n".join([*elements, *(f"<script>{code}</script>" for code in (get_plotlyjs(), asset(script)))])
    all_parts = {**parts, "provenance": table_rows(provenance.items())}
    frame = {
        **all_parts,
        "kind": escape(kind),
        "head_title": head_title or parts["title"],
        "body": filled(template, all_parts),
        "scripts": scripts,
        "css": "\n".join(asset(name) for name in ("page.css", *styles)),
        "version": version("stickslip"),
    }
    return filled("frame.html", frame)


def when(provenance: Mapping[str, str]) -> str:
    """The date of a provenance in words."""
    return provenance.get("date", "date unknown").replace("T", " ").replace("+00:00", " UTC")


def script_json(value: Any) -> str:
    """JSON that may stand inside a script element."""
    # "<" would let a text such as "</script>" end the element; JSON may write it as an escape.
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


def notice(kind: str, heading: str, sentences: Sequence[str]) -> str:
    """A box with sentences; ``kind`` is "bad" or "warn"."""
    body = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    return f'<div class="notice {kind}" role="alert"><h2>{heading}</h2><ul>{body}</ul></div>'


def scrolled(words: str, table: str) -> str:
    """A table in a frame of its own that scrolls sideways, also by the keyboard; ``words`` name it to a reader."""
    return f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(words)}">{table}</div>'


def word_class(is_text: bool) -> str:
    """The attribute of a table cell that holds words, so that it is set to the left."""
    return ' class="word"' if is_text else ""


def table_rows(items: Iterable[tuple[str, str]]) -> str:
    """A table body of names and values."""
    rows = (f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>' for name, value in items)
    return f"<tbody>{''.join(rows)}</tbody>"
