"""Contact laws that a study file names: the same answer as from Python, closed forms, and what a file may not say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from law_studies import SETTINGS, STUDIES, WINDOW_HZ, interface_text, law_of, write_masses, write_study


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_gives_what_python_gives(name: str, tmp_path: Path) -> None:
    masses = write_masses(tmp_path)
    solution = ss.solve_case(ss.load_case(write_study(tmp_path, interface_text("joint", name))))
    operator = solution.model.pairs.operator
    pairs = ss.ContactPairs.with_laws(operator, [law_of(name)])
    curve = ss.forced_response(masses, pairs, solution.model.excitation, frequency_hz=WINDOW_HZ, **SETTINGS)
    np.testing.assert_allclose(curve.frequency_hz, solution.response.frequency_hz, rtol=1e-12)
    np.testing.assert_allclose(curve.displacement, solution.response.displacement, rtol=0.0, atol=1e-15)
    assert solution.converged
    assert (curve.contact_state != 0).any() or name == "cubic"
