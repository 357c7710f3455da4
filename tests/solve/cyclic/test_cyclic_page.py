"""docs/theory_cyclic.md: its blocks run, and print what their comments promise."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PAGE = Path(__file__).parents[3] / "docs" / "theory_cyclic.md"


@pytest.mark.slow
def test_the_example_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    script = "\n".join(re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL))
    names: dict[str, Any] = {}
    exec(compile(script, PAGE.name, "exec", dont_inherit=True), names)
    promised = re.findall(r"^print\(.*\)  # (.+)$", script, flags=re.MULTILINE)
    assert capsys.readouterr().out.splitlines() == promised
    response, tip = names["response"], names["tip"]
    assert response.converged
    assert not response.warnings
    assert (response.contact_state.max(axis=0) > 0).all()
    ahead = np.roll(tip, names["sector"].size)
    lag = names["wave"].wave.shifted(response.coefficients(tip), 12, 1)
    np.testing.assert_allclose(response.coefficients(ahead), lag, atol=1e-15)
    assert names["fifth"].shape == (response.n_points, 15)
