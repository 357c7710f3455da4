"""A section of the page of one run: its heading, its content, and its data for the scripts of the page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from markupsafe import Markup

from stickslip.reporting.look import Figure
from stickslip.reporting.templates import rendered_text
from stickslip.reporting.view import View


@dataclass(frozen=True)
class Content:
    """HTML, and ``data`` for scripts: id of an element -> value that becomes JSON."""

    html: Markup
    data: Mapping[str, Any] = field(default_factory=dict)

    @property
    def characters(self) -> int:
        """Approximate number of characters on the page."""
        return len(self.html) + sum(len(str(value)) for value in self.data.values())


def _nothing(view: View) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class Section:
    """A section of the page.

    heading:
        template of the heading.
    content:
        template of the content, or a function that makes it, with data for its scripts.
    values:
        values for heading and content.
    figures:
        id of a plot in the content -> its figure.
    applies:
        whether the page of this run has the section.
    beside:
        template of the text beside the heading.
    identity:
        id of the element, for style sheets and scripts.
    scripts:
        scripts of the assets that the section needs beside those of every page.
    """

    heading: str
    content: str | Callable[[View], Content]
    values: Callable[[View], Mapping[str, Any]] = _nothing
    figures: Callable[[View], Mapping[str, Figure]] = _nothing
    applies: Callable[[View], bool] = lambda view: True
    beside: str = ""
    identity: str = ""
    scripts: tuple[str, ...] = ()

    def on_page(self, view: View) -> Content:
        """The section on the page."""
        values = self.values(view)
        content = self.content(view) if callable(self.content) else Content(rendered_text(self.content, values))
        heading = rendered_text(self.heading, values)
        frame = {
            "heading": heading,
            "beside": rendered_text(self.beside, values),
            "content": content.html,
            "identity": self.identity,
        }
        return Content(rendered_text(_FRAME, frame), content.data)


_FRAME = """\
<section{{ {"id": identity or none} | xmlattr }}>
  {% if beside %}
  <div class="heading"><h2>{{ heading }}</h2>{{ beside }}</div>
  {% else %}
  <h2>{{ heading }}</h2>
  {% endif %}
{{ content }}
</section>
"""
