"""A complete case on a mesh of Gmsh: two blades and a damper in quadratic tetrahedra, faces that do not match."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import stickslip as ss
from castings import casting_case
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.model.joint import Joint
from stickslip.model.model import load_joint, set_up
from stickslip.results.measures import energy_imbalance
from stickslip.results.storage import load_results
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import joined_modes

STUDY = Path(__file__).parents[3] / "examples" / "two_blades_gmsh" / "study.toml"
RIGID = 1e16  # N/m3: to the frequencies no different from tied faces
BOUND = 0.02  # of the frequencies of the bricks


def assembled(case: Case) -> tuple[Structure, Joint]:
    setup = set_up(case)
    structure = setup.assemble()
    assert isinstance(structure, Structure)
    return structure, load_joint(case, setup.layout)


@pytest.fixture(scope="module")
def tetrahedra() -> tuple[Structure, Joint]:
    return assembled(load_case(STUDY))


@pytest.fixture(scope="module")
def bricks() -> tuple[Structure, Joint]:
    return assembled(casting_case())


@pytest.mark.slow
def test_the_faces_do_not_match_and_every_node_finds_a_partner(tetrahedra: tuple[Structure, Joint]) -> None:
    setup, pairs = set_up(load_case(STUDY)), tetrahedra[1].face_pairs
    assert not pairs.is_matching
    for pairing in setup.pairings:  # type: ignore[attr-defined]
        assert pairing.pairs.n_pairs == 131
        assert not pairing.unpaired_first.points.size
        assert not pairing.unpaired_second.points.size
    assert np.bincount(pairs.face, pairs.area) == pytest.approx([182e-6, 182e-6], rel=1e-9)
    assert np.abs(pairs.gap).max() == 0.0


@pytest.mark.slow
def test_same_joint_in_both_models(tetrahedra: tuple[Structure, Joint], bricks: tuple[Structure, Joint]) -> None:
    """F_N = 500 N, the same roughness: force and stiffness of each face agree."""
    for ours, other in (
        (tetrahedra[1].preload, bricks[1].preload),
        (tetrahedra[1].normal_stiffness, bricks[1].normal_stiffness),
        (tetrahedra[1].tangential_stiffness, bricks[1].tangential_stiffness),
    ):
        assert tetrahedra[1].face_sum(ours) == pytest.approx(bricks[1].face_sum(other), rel=1e-3)


@pytest.mark.slow
def test_stuck_frequencies_are_those_of_the_bricks(
    tetrahedra: tuple[Structure, Joint], bricks: tuple[Structure, Joint]
) -> None:
    actual, wanted = (
        joined_modes(structure, joint.face_pairs, 4, joint.resting_springs)[0]
        for structure, joint in (tetrahedra, bricks)
    )
    assert actual[:2] == pytest.approx(wanted[:2], rel=BOUND)
    assert actual == pytest.approx(wanted, rel=0.005)  # what this mesh reaches


@pytest.mark.slow
def test_rigid_contact_gives_the_tied_frequencies_of_the_bricks(
    tetrahedra: tuple[Structure, Joint], bricks: tuple[Structure, Joint]
) -> None:
    structure, joint = tetrahedra
    springs = np.repeat(RIGID * joint.face_pairs.area[:, None], 3, axis=1).reshape(joint.resting_springs.shape)
    actual, _ = joined_modes(structure, joint.face_pairs, 4, springs)
    tied, _ = joined_modes(bricks[0], bricks[1].face_pairs, 4)
    assert actual[:2] == pytest.approx(tied[:2], rel=BOUND)
    assert actual == pytest.approx(tied, rel=0.005)


def shortened(folder: Path, changes: dict[str, str]) -> Path:
    """The study with some words changed, in another folder."""
    text = STUDY.read_text(encoding="utf-8")
    for old, new in {**changes, "../../tests": str(STUDY.parents[2] / "tests")}.items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def quick(folder: Path, changes: dict[str, str]) -> Path:
    """The study with one harmonic, a window below the resonance and no figures, in another folder."""
    changes = changes | {
        "harmonics = 3": "harmonics = 1",
        "samples = 128": "samples = 64",
        "430 Hz": "442 Hz",
        "470 Hz": "446 Hz",
        'figure_formats = ["png"]': "figure_formats = []",
    }
    return shortened(folder, changes)


def run(path: Path, out: Path) -> str:
    result = CliRunner().invoke(app, ["run", str(path), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "The curve reached the stop frequency." in result.output
    assert np.abs(energy_imbalance(load_results(out / "results.nc").response)).max() < 1e-6
    return result.output


@pytest.mark.long
def test_from_file_to_report(tmp_path: Path) -> None:
    """The example below its resonance, otherwise as it stands."""
    out = tmp_path / "out"
    output = run(shortened(tmp_path, {"430 Hz": "442 Hz", "470 Hz": "450 Hz"}), out)
    for name in ("results.nc", "report.html", "contact_pairs.vtu", "mode_shapes.vtu", "deflected_shape.pvd"):
        assert (out / name).stat().st_size > 0
        assert name in output
    study = load_results(out / "results.nc").study
    assert study is not None
    assert study.mode_table[0]["full_hz"] == pytest.approx(456.4, rel=BOUND)
    assert study.mode_table[1]["full_hz"] == pytest.approx(487.1, rel=BOUND)
    page = (out / "report.html").read_text(encoding="utf-8")
    for words in ("Contact states, left", "Positions on &#39;damper_left&#39; without a partner, left"):
        assert words in page, words


@pytest.mark.long
def test_with_a_solved_preload(tmp_path: Path) -> None:
    """500 N on the damper's bottom instead of a given normal load of each face."""
    load = '[static_loads.wedge]\nset = "damper_bottom"\nspread = "area"\ndirection = [0, 0, 1]\nforce = "500 N"\n'
    path = quick(
        tmp_path,
        {
            'normal_load = "288.7 N"\n': "\n",
            'normal_load = "288.7 N"        # F_N = 500 N on the wedge\n': "\n",
            "[friction]": load + '[preload]\nmethod = "solved"\n[friction]',
        },
    )
    checked = CliRunner().invoke(app, ["check", str(path)])
    assert checked.exit_code == 0, checked.output
    assert "Preload solved from 500 N at wedge" in checked.output
    assert "of the initial pressure of that solution" in " ".join(checked.output.split())
    solution = ss.solve_case(load_case(path))
    assert solution.response.converged, solution.response.message
    assert np.abs(energy_imbalance(solution.response)).max() < 1e-6
    study = solution.record
    derived = {row[0]: row[1] for row in study.derived}
    # by symmetry each face carries half of the vertical load; at rest without friction as much as the wedge says
    for face in ("left", "right"):
        assert derived[f"Normal load, {face}"] == pytest.approx(250.0 / np.cos(np.pi / 6.0), rel=1e-3)
    # one stiffness of each face at rest, in the mode table as in the curve
    stuck = float(str(derived["Natural frequencies, stuck"]).split(",")[0])
    assert study.mode_table[0]["full_hz"] == pytest.approx(stuck, rel=1e-3)
