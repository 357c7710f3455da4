"""Seeded mutations of study files through ``stickslip check``: exit code 0, 2 or 3, and never a traceback."""

from __future__ import annotations

import os
import random
import re
from pathlib import Path

import pytest
from test_lines_of_keys import BLADES
from typer.testing import CliRunner

from own_cases import EXAMPLE
from sentences import printed_sentence
from stickslip.cli.main import app

LONG = 5000
VALUES = (
    "nan", "-inf", "0", "-1", "1e308", "5e-324", '"1e308 m"', '"1 GPa"', '"1 parsec"', "true", '""', '"\\u0000"', "[]",
    '"\\u001b[2J"', "[[]]", "{}", "{a=1}", "1979-05-27", "07:32:00", "9" * 400, "9" * LONG, f'"{"x" * LONG}"',
    "[0, 0, 1]", f'"1 {"m*" * LONG}m"', "[1e308, 1e308, 1e308]", '["a"]', '"ground"',
    '"mesh"', '"two-blade"', '"\\u202e"', "-0.0",
    '"1e400 m"', '"--1 m"', '"1 m/m*m"', "0x7fffffffffffffff", "[" * 200 + "]" * 200, "2.0000000000000004", '"1 degC"',
    '"89.9999999 deg"', "'''a\nb'''",
)  # fmt: skip
LINES = (
    "[a]", "[[interfaces]]", '[interfaces."a/b"]', '[interfaces."\\u0000"]', f"[interfaces.{'x' * LONG}]", "[[[[[",
    f"[{'.'.join(['a'] * 3000)}]", f"[1, {'9' * LONG}]", "=", '"unclosed', "\0", "\x1b[2J", "\ufeff", "\u2028",
    "interfaces = [1]", 'interfaces = {"" = {}}', "forces = {a = {}}", "bodies = 3", '[preload]\nmethod = "solved"',
    "[rotation]", "[study]",
)  # fmt: skip


def mutated(text: str, rng: random.Random) -> str:
    """The text with other values, lines that belong nowhere, or a line less."""
    lines = text.splitlines()
    for _ in range(rng.choice((1, 1, 2, 3))):
        kind, at = rng.random(), rng.randrange(len(lines))
        if kind < 0.7 and " = " in lines[at]:
            lines[at] = f"{lines[at].partition(' = ')[0]} = {rng.choice(VALUES)}"
        elif kind < 0.9:
            lines.insert(at, rng.choice(LINES))
        else:
            del lines[at]
    return "\n".join(lines) + "\n"


@pytest.mark.long
@pytest.mark.parametrize("seed", range(8))
def test_mutations(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    mesh = (EXAMPLE / "study.toml").read_text(encoding="utf-8").replace(
        "beam_and_block.inp", (EXAMPLE / "beam_and_block.inp").as_posix()
    )  # fmt: skip
    path = tmp_path / "study.toml"
    codes = set()
    for _ in range(30):
        path.write_text(mutated(rng.choice((BLADES, mesh)), rng), encoding="utf-8")
        result = CliRunner().invoke(app, ["check", str(path)])
        printed = result.stdout + result.stderr
        codes.add(result.exit_code)
        assert result.exit_code in (0, 2, 3), (path.read_text(encoding="utf-8"), printed)
        assert "Traceback" not in printed
        assert len(printed) < 20_000
        assert not re.search("[\0\x1b\x9b\u202e]", printed)
        assert not re.search(r"\b(nan|inf)\b", result.stdout)
    assert 2 in codes


LONG_NAMES = {
    "unit": (f'[geometry]\nwidth = "1 {"m*" * LONG}m"', "has the unknown unit"),
    "file": (f'[structure]\nkind = "mesh"\nlength_unit = "mm"\nfile = "{"x" * LONG}"', "is not a file name"),
    "key": (f"[geometry]\n{'x' * LONG} = 1", "is not a key of a study file"),
    "unicode key": ('[geometry]\n"wídth \U0001f642" = 1', "is not a key of a study file"),
}


@pytest.mark.parametrize(("text", "words"), LONG_NAMES.values(), ids=LONG_NAMES)
def test_names_without_end(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 2
    assert words in result.stderr
    assert len(result.stderr) < 2000


def test_an_entry_with_a_name_without_end(tmp_path: Path) -> None:
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8").replace("interfaces.sole", f"interfaces.{'x' * LONG}")
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 2
    printed_sentence(result.stderr)


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="there is no device without end here")
def test_a_study_file_without_end() -> None:
    result = CliRunner().invoke(app, ["check", "/dev/zero"])
    assert result.exit_code == 2
    printed_sentence(result.stderr, "/dev/zero")
