"""Text for a terminal, without the characters of files that would control the terminal."""

from __future__ import annotations

import unicodedata

# Characters that reorder or hide text (Unicode TR 9 and TR 36), beside the control characters: marks, embeddings,
# overrides and isolates of direction, line and paragraph separators.
_TERMINAL_CONTROLS = frozenset(
    "\u061c\u200e\u200f\u2028\u2029\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\ufeff"
)


def printable(text: str) -> str:
    """``text`` with control characters (but line ends and tabs), direction marks and lone surrogates as escapes.

    The set name ``ESC [ 2 J`` in a mesh file is then shown as ``\\x1b[2J`` and does not clear the screen.
    """
    return text if text.isascii() and text.isprintable() else "".join(map(_shown, text))


def echo(text: str, err: bool = False) -> None:
    """Print a line on stdout or stderr, :func:`printable`; every module prints through this function or Console."""
    import typer

    typer.echo(printable(text), err=err)


def _shown(letter: str) -> str:
    acts = unicodedata.category(letter) in ("Cc", "Cs") and letter not in "\n\t"
    return letter.encode("unicode_escape").decode("ascii") if acts or letter in _TERMINAL_CONTROLS else letter
