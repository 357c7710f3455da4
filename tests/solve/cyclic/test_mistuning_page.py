"""docs/theory_mistuning.md: its blocks run, and print what their comments promise."""

from __future__ import annotations

import pytest

from page_examples import names_of_page


@pytest.mark.long
def test_the_example_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    names = names_of_page("theory_mistuning.md", capsys)
    assert names["response"].converged
    assert (names["response"].contact_state.max(axis=0) > 0).all()
