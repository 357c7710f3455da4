"""What several commands read and print in the same form."""

from __future__ import annotations

from pathlib import Path

import typer

from stickslip.core.terminal import echo


def folder(text: str) -> Path:
    """The folder of an option. Raises BadParameter for an empty text, which would be the current folder."""
    if not text.strip():
        raise typer.BadParameter("it is empty. Give a folder; the current one is .")
    return Path(text)


def print_rows(rows: list[tuple[str, str]]) -> None:
    """Print labels and values in two columns."""
    width = max((len(label) for label, _ in rows), default=0)
    for label, value in rows:
        echo(f"  {label:<{width}}  {value}")
