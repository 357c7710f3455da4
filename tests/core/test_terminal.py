"""Text of files reaches the terminal as text: nothing in it moves a cursor, clears a screen or turns a line round."""

from __future__ import annotations

import ast
import io
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

import stickslip
from own_cases import EXAMPLE
from stickslip.cli.main import app
from stickslip.core.progress import LineProgress
from stickslip.core.terminal import printable

SOURCE = Path(stickslip.__file__).parent


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain – Dämpfer µm\n\tnext", "plain – Dämpfer µm\n\tnext"),
        ("\x1b[2J", "\\x1b[2J"),
        ("\x9b2J", "\\x9b2J"),
        ("a\rb\x08\x7f\0", "a\\rb\\x08\\x7f\\x00"),
        ("\u202egnp.exe\u202c", "\\u202egnp.exe\\u202c"),
        ("\u2066x\u2069\u200f", "\\u2066x\\u2069\\u200f"),
        ("\udc80", "\\udc80"),
    ],
)
def test_what_acts_on_a_terminal_is_an_escape(text: str, shown: str) -> None:
    assert printable(text) == shown


def hostile_deck(folder: Path) -> Path:
    """The example's deck with a set whose name clears the screen, sets a title and turns text round."""
    text = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    path = folder / "hostile.inp"
    path.write_text(text.replace("tip", "\x1b]0;owned\x07\x9b2J\u202etip"), encoding="utf-8")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "import"])
def test_names_of_sets_cannot_act_on_the_terminal(command: str, tmp_path: Path) -> None:
    deck = hostile_deck(tmp_path)
    study = (EXAMPLE / "study.toml").read_text(encoding="utf-8").replace("beam_and_block.inp", deck.name)
    (tmp_path / "study.toml").write_text(study, encoding="utf-8")
    arguments = [str(tmp_path / "study.toml")] if command == "check" else [str(deck), "--length-unit", "mm"]
    result = CliRunner().invoke(app, [command, *arguments])
    printed = result.stdout + result.stderr
    assert "owned" in printed.replace("\n", "").casefold()
    assert not any(letter in printed for letter in "\x1b\x07\x9b\u202e")


def test_progress_lines_are_printable() -> None:
    stream = io.StringIO()
    LineProgress(Console(file=stream)).update("stage \x1b[2J", 0.0, "detail \x9b")
    assert "\x1b" not in stream.getvalue()
    assert "\x9b" not in stream.getvalue()


@pytest.mark.long
def test_one_place_prints() -> None:
    """No module but core/terminal.py writes to a stream; what goes to a rich console passes printable or is a table."""
    wrong = []
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call) or path.name == "terminal.py":
                continue
            called = ast.unparse(node.func)
            first = ast.unparse(node.args[0]) if node.args else ""
            by_console = called.endswith("console.print")
            if called in ("print", "typer.echo", "typer.secho", "click.echo") or called.endswith(
                ("stdout.write", "stderr.write")
            ):
                wrong.append(f"{path.name}: {called}")
            elif by_console and not first.startswith("printable(") and first != "table":
                wrong.append(f"{path.name}: {called}({first})")
    assert wrong == []
