"""Pieces of HTML that the pages share."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from typing import Any


def asset(name: str) -> str:
    """Text of a file of the assets."""
    return (files("stickslip.report") / "assets" / name).read_text(encoding="utf-8")


def filled(template: str, parts: Mapping[str, str]) -> str:
    """A template of the assets with every ``{{name}}`` replaced by its part."""
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)], asset(template))


def script_json(value: Any) -> str:
    """JSON that may stand inside a script element."""
    # "<" would let a text such as "</script>" end the element; JSON may write it as an escape.
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


def notice(kind: str, heading: str, sentences: Sequence[str]) -> str:
    """A box with sentences; ``kind`` is "bad" or "warn"."""
    body = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    return f'<div class="notice {kind}" role="alert"><h2>{heading}</h2><ul>{body}</ul></div>'


def word_class(is_text: bool) -> str:
    """The attribute of a table cell that holds words, so that it is set to the left."""
    return ' class="word"' if is_text else ""


def table_rows(items: Iterable[tuple[str, str]]) -> str:
    """A table body of names and values."""
    rows = (f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>' for name, value in items)
    return f"<tbody>{''.join(rows)}</tbody>"
