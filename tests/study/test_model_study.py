"""The study file that ``new --from MODEL`` writes: what it contains, and that its completed form passes ``check``."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import stickslip as ss
from assembly_deck import assembly_deck
from own_cases import EXAMPLE
from sentences import printed_sentence, rejects
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.core.errors import StudyFileError
from stickslip.model.model import set_up
from stickslip.results.storage import load_results
from stickslip.study.proposal import propose

MODELS = Path(__file__).parents[1] / "data" / "models"
CONTACT = """*SURFACE INTERACTION, NAME=Steel on steel
*FRICTION
0.25, 1000.
*CONTACT PAIR, INTERACTION=steel on STEEL, TYPE=SURFACE TO SURFACE
DAMPER_BOTTOM, beam_top
"""
RESOLUTION_OF_TEMPLATES = 0.005  # as in `stickslip new --kind mesh`
RANGE = 'frequency_start = "1600 Hz"\nfrequency_stop = "2000 Hz"\n'
# What no model file contains, by the line to complete.
ANSWERS = {
    'normal_load = "... N"': 'normal_load = "40 N"',
    'sq = "... um"': 'sq = "1 um"',
    'sample_length = "... mm"': 'sample_length = "0.8 mm"',
    'set = "..."': 'set = "tip"',
    'amplitude = "... N"': 'amplitude = "0.2 N"',
}


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    """The example of an own mesh with a contact pair, in the folder of the study."""
    text = (EXAMPLE / "beam_and_block.inp").read_text(encoding="utf-8")
    (tmp_path / "deck.inp").write_text(text + CONTACT, encoding="utf-8")
    return tmp_path / "deck.inp"


def written(model: Path, *options: str) -> str:
    target = model.with_name("study.toml")
    outcome = CliRunner().invoke(app, ["new", str(target), "--from", str(model), *(options or ("--length-unit", "mm"))])
    assert outcome.exit_code == 0, outcome.output
    assert "GIVE" in outcome.stdout
    return target.read_text(encoding="utf-8")


def completed(text: str) -> str:
    for line, answer in ANSWERS.items():
        text = text.replace(f"# GIVE {line}", answer)
    return re.sub(r"^# GIVE ", "", text, flags=re.MULTILINE)


@pytest.mark.slow
def test_a_completed_study_passes_check(deck: Path) -> None:
    text = written(deck)
    pair = tomllib.loads(text)["interfaces"]["damper_bottom - beam_top"]
    assert pair == {"first": "damper_bottom", "second": "beam_top", "friction": 0.25}
    study = deck.with_name("study.toml")
    study.write_text(completed(text), encoding="utf-8")
    outcome = CliRunner().invoke(app, ["check", str(study)])
    assert outcome.exit_code == 0, outcome.output
    study.write_text(study.read_text(encoding="utf-8") + RANGE, encoding="utf-8")
    pairs, of_example = (set_up(load_case(path)).layout.face_pairs for path in (study, EXAMPLE / "study.toml"))
    first = np.flatnonzero(of_example.face == 0)
    np.testing.assert_allclose(pairs.area, of_example.area[first], rtol=1e-12)
    np.testing.assert_allclose(pairs.normal, of_example.normal[first], atol=1e-12)


def test_a_study_that_is_not_completed_is_rejected(deck: Path) -> None:
    text = written(deck)
    with rejects(StudyFileError, "interfaces.damper_bottom - beam_top.normal_load"):
        load_case(deck.with_name("study.toml"))
    # loads, forces and responses complete: the contact stiffness is still nobody's choice
    part = completed(text.replace("# GIVE [roughness]", "#").replace("# GIVE sq", "#").replace("# GIVE sample", "#"))
    deck.with_name("study.toml").write_text(part, encoding="utf-8")
    outcome = CliRunner().invoke(app, ["check", str(deck.with_name("study.toml"))])
    assert outcome.exit_code == 2
    printed_sentence(outcome.output)


def test_archives_and_bonded_pairs(tmp_path: Path) -> None:
    """The pair of the archive as a joint; bonded, it is a tie."""
    text = (MODELS / "cubes.cdb").read_text(encoding="utf-8")
    (tmp_path / "cubes.cdb").write_text(text, encoding="utf-8")
    data = tomllib.loads(written(tmp_path / "cubes.cdb"))
    assert data["interfaces"] == {"pair 5": {"first": "contact 5", "second": "target 5", "friction": 0.2}}
    assert data["structure"] == {"kind": "mesh", "file": "cubes.cdb", "length_unit": "mm"}
    (tmp_path / "tied").mkdir()
    (tmp_path / "tied" / "cubes.cdb").write_text(text.replace("KEYOP,2,12,0", "KEYOP,2,12,5"), encoding="utf-8")
    tied = written(tmp_path / "tied" / "cubes.cdb")
    assert tomllib.loads(tied)["ties"] == {"pair 5": {"dependent": "contact 5", "independent": "target 5"}}
    assert "# GIVE [interfaces.joint]" in tied


def test_a_model_without_material_constraint_and_friction(tmp_path: Path) -> None:
    """A VTU file names faces only; a contact pair without friction asks for it."""
    (tmp_path / "cubes.vtu").write_bytes((MODELS / "cubes.vtu").read_bytes())
    text = written(tmp_path / "cubes.vtu")
    assert {"# GIVE [bodies.lower]", '# GIVE fixed = ["..."]'} <= set(text.splitlines())
    deck = (MODELS / "cubes.inp").read_text(encoding="utf-8") + "*CONTACT PAIR\nopposite, contact\nopposite, contact\n"
    (tmp_path / "cubes.inp").write_text(deck, encoding="utf-8")
    target = tmp_path / "other.toml"
    outcome = CliRunner().invoke(
        app,
        ["new", str(target), "--from", str(tmp_path / "cubes.inp"), "--length-unit", "mm", "--unit-system", "mm-t-s"],
    )
    assert outcome.exit_code == 0, outcome.output
    data = tomllib.loads(target.read_text(encoding="utf-8"))
    assert list(data["interfaces"]) == ["opposite - contact", "opposite - contact 2"]
    assert data["structure"]["unit_system"] == "mm-t-s"
    assert target.read_text(encoding="utf-8").count("# GIVE friction = ...") == 2


@pytest.mark.parametrize(
    "options", [["--from", "deck.inp"], ["--length-unit", "mm"], ["--from", "study.toml", "--unit-system", "SI"]]
)
def test_options_that_do_not_fit(deck: Path, options: list[str]) -> None:
    words = [str(deck.with_name(word)) if "." in word else word for word in options]
    outcome = CliRunner().invoke(app, ["new", str(deck.with_name("new.toml")), *words])
    assert outcome.exit_code == 2
    assert not deck.with_name("new.toml").exists()
    printed_sentence(outcome.output)


@pytest.mark.slow
def test_faces_of_a_mesh_that_touch_are_proposed_as_a_joint(tmp_path: Path) -> None:
    """A Gmsh file names faces, but no contact pairs."""
    (tmp_path / "mesh.msh").write_bytes((MODELS.parent / "two_blades" / "two_blades.msh").read_bytes())
    lines = written(tmp_path / "mesh.msh").splitlines()
    found = [line.partition("= ")[2] for line in lines if line.startswith(("# GIVE first", "# GIVE second"))]
    assert found == ['"damper_left"', '"left_face"', '"damper_right"', '"right_face"']
    assert "# GIVE [interfaces.joint_2]" in lines


@pytest.mark.long
def test_a_deck_of_abaqus_cae_from_the_file_to_the_page(tmp_path: Path) -> None:
    """Only what no model file contains is completed; the load acts on the reference point by the name of its set."""
    (tmp_path / "deck.inp").write_text(assembly_deck(), encoding="utf-8")
    text = written(tmp_path / "deck.inp")
    assert '(set "Load point")' in text
    assert "_lower_lap_S2" not in text
    path = tmp_path / "study.toml"
    path.write_text(completed(text).replace('"tip"', '"Load point"'), encoding="utf-8")
    final = tmp_path / "final.toml"
    for words in (["check", str(path)], ["new", str(final), "--from", str(path)]):
        outcome = CliRunner().invoke(app, words)
        assert outcome.exit_code == 0, outcome.output
    case = load_case(final)
    assert case.solver.accuracy == RESOLUTION_OF_TEMPLATES
    low, high = case.solver.frequency_start, case.solver.frequency_stop
    proposal = propose(case)
    assert proposal.onset is not None
    assert proposal.onset.is_loose  # without contact the second plate is loose: its elastic modes lie far above
    assert proposal.onset.free_peak is None
    assert proposal.onset.stuck_peak is not None
    assert low < proposal.onset.stuck_peak.frequency_hz < high < 1.2 * proposal.onset.stuck_peak.frequency_hz
    quick = case.replace(
        {"analysis.stiffness_band": False, "solver.accuracy": None, "solver.harmonics": 1, "solver.samples": 32}
    )
    solved = ss.run(quick, tmp_path / "out", threads=1)
    assert solved.response.converged
    study = load_results(tmp_path / "out" / "results.nc").study
    assert study is not None
    assert not [words for words in study.warnings if words in study.notes]
    assert any("*TIE" in words for words in study.notes)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert f"Notes on the model file ({len(study.notes)})" in page


LOADED = "*NSET, NSET=loaded\n1, 2, 3\n"
REFERENCE = "*NODE\n9001, 0., 0., 0.\n*RIGID BODY, NSET=loaded, REF NODE=9001\n"
FORCES = {
    "one node": ("*CLOAD\n1, 1, 3.\n1, 2, -4.\n", "node = 1", "[0.75, -1, 0]", "5 N"),
    "a reference node": (f"{REFERENCE}*CLOAD\n9001, 3, 12.\n", "node = 9001", "[0, 0, 1]", "12 N"),
    "a node set": ("*CLOAD\nloaded, 1, 2.\n", 'set = "loaded"', "[1, 0, 0]", "6 N"),
    "forces that differ": ("*CLOAD\nloaded, 1, 2.\n1, 1, 3.\n", 'set = "..."', "[0, 0, 1]", "... N"),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", FORCES)
def test_the_force_of_a_model_stands_in_the_lines_to_complete(deck: Path, case: str) -> None:
    cards, place, direction, amplitude = FORCES[case]
    deck.write_text(deck.read_text(encoding="utf-8") + LOADED + cards, encoding="utf-8")
    text = written(deck)
    block = text[text.index("# GIVE [forces.drive]") : text.index("# GIVE [responses.output]")]
    assert f"# GIVE {place}\n" in block
    assert f"# GIVE direction = {direction}\n" in block
    assert f'# GIVE amplitude = "{amplitude}"' in block
    assert "The model has a force of" in text


@pytest.mark.slow
def test_sets_of_bodies_come_last_in_the_list(deck: Path) -> None:
    (line,) = [line for line in written(deck).splitlines() if line.startswith("# Other sets")]
    mesh = ss.read_model(deck, "mm").mesh
    names = re.findall(r'"([^"]+)"', line)
    is_of_elements = [name in mesh.element_sets for name in names]
    assert is_of_elements == sorted(is_of_elements)


@pytest.mark.parametrize("kind", ["mesh", "matrices", "bladed-disk"])
def test_a_template_names_no_key_of_two_blades(tmp_path: Path, kind: str) -> None:
    target = tmp_path / "study.toml"
    assert CliRunner().invoke(app, ["new", str(target), "--kind", kind]).exit_code == 0
    text = target.read_text(encoding="utf-8")
    assert not [word for word in ("performance_curve", "centrifugal_force", "up the slope") if word in text]
