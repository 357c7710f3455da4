"""An element of a drawing as data; the template structure.html writes it, and escapes the words in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Element:
    """An element of SVG: its tag, its attributes, and what stands inside, which is words or further elements."""

    tag: str
    attributes: Mapping[str, str | int]
    inside: tuple[Element | str, ...] = ()
