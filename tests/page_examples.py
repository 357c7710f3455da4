"""Run the Python blocks of a page of the documentation."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[1] / "docs"


def names_of_page(name: str, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """The names that the blocks of a page define, after a check that they print what their comments promise."""
    script = "\n".join(re.findall(r"```python\n(.*?)```", (DOCS / name).read_text(encoding="utf-8"), flags=re.DOTALL))
    names: dict[str, Any] = {}
    exec(compile(script, name, "exec", dont_inherit=True), names)
    promised = re.findall(r"^print\(.*\)  # (.+)$", script, flags=re.MULTILINE)
    assert capsys.readouterr().out.splitlines() == promised
    return names
