"""A study without damping: a warning of ``check``, and a rejection of ``run`` where nothing bounds the amplitude."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import stickslip as ss
from stickslip.cli.main import app

STUDY = """\
[structure]
kind = "matrices"
file = "superelement.npz"
[interfaces.foot]
first = "foot"
second = "ground"
normal = [0, 0, 1]
area = "160 mm^2"
normal_load = "40 N"
normal_stiffness = "2e7 N/m"
tangential_stiffness = "1.6e7 N/m"
[forces.push]
set = "top"
direction = [1, 0, 0]
amplitude = "8 N"
[responses.top]
set = "top"
direction = [1, 0, 0]
[damping]
modal_damping_ratio = 0
[solver]
frequency_start = "100 Hz"
frequency_stop = "300 Hz"
harmonics = 1
samples = 64
[output]
figure_formats = []
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """A mass "top" of 159 Hz beside a mass "foot" on a rough contact, which no spring connects."""
    structure = ss.Superelement(
        np.eye(6),
        np.diag([1e6, 4e7, 9e7, 4e7, 4e7, 4e7]),
        boundary_nodes=np.array([0, 1]),
        positions=np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]),
        node_sets={"top": np.array([0]), "foot": np.array([1])},
    )
    ss.write_superelement(tmp_path / "superelement.npz", structure)
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def test_check_has_a_warning(study: Path) -> None:
    outcome = CliRunner().invoke(app, ["check", str(study)])
    assert outcome.exit_code == 0, outcome.output
    assert "There is no viscous damping" in " ".join(outcome.output.split())


@pytest.mark.slow
def test_run_rejects_a_resonance_without_a_bound(study: Path, tmp_path: Path) -> None:
    outcome = CliRunner().invoke(app, ["run", str(study), "--out", str(tmp_path / "out")])
    assert outcome.exit_code == 2
    words = " ".join(outcome.output.split())
    assert "nothing bounds the amplitude at 159.155 Hz" in words
    assert "no contact moves in it" in words
    assert "Traceback" not in words
    assert not (tmp_path / "out" / "results.nc").exists()
