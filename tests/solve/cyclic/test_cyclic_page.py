"""docs/theory_cyclic.md: its blocks run, and print what their comments promise."""

from __future__ import annotations

import numpy as np
import pytest

from page_examples import names_of_page


@pytest.mark.slow
def test_the_example_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    names = names_of_page("theory_cyclic.md", capsys)
    response, tip = names["response"], names["tip"]
    assert response.converged
    assert not response.warnings
    assert (response.contact_state.max(axis=0) > 0).all()
    ahead = np.roll(tip, names["sector"].size)
    lag = names["wave"].wave.shifted(response.coefficients(tip), 12, 1)
    np.testing.assert_allclose(response.coefficients(ahead), lag, atol=1e-15)
    assert names["fifth"].shape == (response.n_points, 15)
