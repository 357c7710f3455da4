"""The code of docs/scaling.md."""

from __future__ import annotations

import pytest

from page_examples import names_of_page


@pytest.mark.slow
def test_the_batch_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    result = names_of_page("scaling.md", capsys)["result"]
    assert result.converged.all()
