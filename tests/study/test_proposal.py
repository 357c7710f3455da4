"""Frequency range and excitation that check proposes and ``new --from`` writes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from own_cases import EXAMPLE, mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.case.load import load_case
from stickslip.case.sections import STRUCTURE_KINDS
from stickslip.cli.main import app
from stickslip.core.errors import StudyFileError
from stickslip.study.check import check
from stickslip.study.proposal import propose

OTHER_KINDS = ("blade", "damper", "platform", "wedge", "airfoil", "N1", "engine")


@pytest.fixture
def without_range(tmp_path: Path) -> Path:
    """The example of an own mesh without its frequency range."""
    lines = (EXAMPLE / "study.toml").read_text(encoding="utf-8").splitlines()
    path = tmp_path / "study.toml"
    path.write_text("\n".join(line for line in lines if not line.startswith("frequency_")), encoding="utf-8")
    (tmp_path / "beam_and_block.inp").write_bytes((EXAMPLE / "beam_and_block.inp").read_bytes())
    return path


@pytest.mark.slow
def test_the_proposal_contains_both_linear_peaks_and_makes_pairs_slip() -> None:
    case = mesh_case()
    proposal = propose(case)
    assert proposal.onset is not None
    assert proposal.onset.stuck_peak is not None
    assert proposal.onset.free_peak is not None
    assert proposal.frequency_hz is not None
    low, high = proposal.frequency_hz
    for peak in (proposal.onset.stuck_peak, proposal.onset.free_peak):
        assert low < peak.frequency_hz < high
    keys = proposal.keys(case)
    assert proposal.onset.first is not None
    assert keys["forces.push.amplitude"] > proposal.onset.first * case.sections["forces"]["push"].amplitude
    assert case.replace(keys).solver.frequency_start == low


@pytest.mark.slow
def test_a_study_without_range_is_checked_and_written_but_not_run(without_range: Path) -> None:
    with rejects(StudyFileError, "solver.frequency_start"):
        load_case(without_range)
    checked = CliRunner().invoke(app, ["check", str(without_range)])
    assert checked.exit_code == 0, checked.stderr
    for words in ("no frequency range", "linear peak, contacts stuck", "linear peak, no contact", "first pair slips",
                  "nearly all", "proposed range", "proposed excitation", "--from"):  # fmt: skip
        assert words in checked.stdout
    assert re.search(r"linear peak, contacts stuck +[\d.]+ Hz, [\d.]+ (nm|µm|mm) under", checked.stdout)
    target = without_range.with_name("filled.toml")
    written = CliRunner().invoke(app, ["new", str(target), "--from", str(without_range)])
    assert written.exit_code == 0, written.stderr
    assert 'file = "beam_and_block.inp"' in target.read_text(encoding="utf-8")
    case = load_case(target)
    assert case.solver.frequency_start < 2095.0 < case.solver.frequency_stop  # the stuck peak
    assert case.sections["forces"]["push"].amplitude != 0.5


def test_a_joint_of_ones_own_has_no_default_stiffness() -> None:
    data = mesh_case().as_mapping(only_explicit=True)
    del data["roughness"]
    with rejects(StudyFileError, "interfaces.sole"):
        Case.from_mapping(data)


@pytest.mark.parametrize("kind", ["mesh", "matrices"])
def test_templates_name_no_other_kind_of_structure(kind: str) -> None:
    text = Case.from_mapping(EXAMPLES[kind]).to_text().replace(STRUCTURE_KINDS, "")
    lines = [line for line in text.splitlines() if any(word in line for word in OTHER_KINDS)]
    assert lines == [], lines


@pytest.mark.slow
def test_check_reports_a_friction_coefficient_of_no_joint() -> None:
    warnings = [words for _, words in dict(check(mesh_case(friction__coefficient=2.0)))["Warnings"]]
    (sentence,) = [words for words in warnings if "friction coefficient" in words]
    printed_sentence(sentence)


def test_the_dimension_of_a_profile_is_rejected_with_that_of_its_surface() -> None:
    with rejects(StudyFileError, "roughness.fractal_dimension"):
        Case.from_mapping({"roughness": {"fractal_dimension": 1.2}})


def test_a_kind_beside_a_study_to_write_again_is_rejected(tmp_path: Path) -> None:
    target = tmp_path / "new.toml"
    outcome = CliRunner().invoke(app, ["new", str(target), "--kind", "mesh", "--from", str(EXAMPLE / "study.toml")])
    assert outcome.exit_code == 2
    assert not target.exists()
    printed_sentence(outcome.output)
