"""A study without damping: a warning of ``check``, and a rejection of ``run`` where nothing bounds the amplitude."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import stickslip as ss
from own_cases import MATRIX_STUDY
from sentences import printed_sentence
from stickslip.cli.main import app

STUDY = (
    MATRIX_STUDY.replace('set = "lid"', 'set = "top"')
    .replace('point = ["48 mm", "3.67 mm", "14 mm"]', 'set = "top"')
    .replace('"1 kHz"', '"100 Hz"')
    .replace('"9 kHz"', '"300 Hz"')
    + "[damping]\nmodal_damping_ratio = 0\n"
)


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """A mass "top" of 159 Hz beside a mass "lid" on a rough contact, which no spring connects."""
    structure = ss.Superelement(
        np.eye(6),
        np.diag([1e6, 4e7, 9e7, 4e7, 4e7, 4e7]),
        boundary_nodes=np.array([0, 1]),
        positions=np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]),
        node_sets={"top": np.array([0]), "lid": np.array([1])},
    )
    ss.write_superelement(tmp_path / "superelement.npz", structure)
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def test_check_has_a_warning(study: Path) -> None:
    outcome = CliRunner().invoke(app, ["check", str(study)])
    assert outcome.exit_code == 0, outcome.output
    _, heading, warnings = outcome.output.partition("\nWarnings\n")
    assert heading
    printed_sentence(" ".join(warnings.partition("\nA sensible study\n")[0].split()))
    printed_sentence(" ".join(warnings.partition("\nA sensible study\n")[2].split()))


@pytest.mark.slow
def test_run_rejects_a_resonance_without_a_bound(study: Path, tmp_path: Path) -> None:
    outcome = CliRunner().invoke(app, ["run", str(study), "--out", str(tmp_path / "out")])
    assert outcome.exit_code == 2
    printed_sentence(outcome.output[outcome.output.index("Error: ") :], "159.155 Hz")
    assert "Traceback" not in outcome.output
    assert not (tmp_path / "out" / "results.nc").exists()
