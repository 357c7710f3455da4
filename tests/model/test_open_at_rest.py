"""Pairs that are open at rest: frequencies, shapes, tables and words of a study all leave them open."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import meshio
import numpy as np
import pytest

from castings import casting_case
from own_cases import mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.core.errors import InputError
from stickslip.model.model import Model, build_model, load_joint, set_up
from stickslip.results.storage import load_results
from stickslip.solve.harmonic.damping import modal_basis, stuck_stiffness_matrix
from stickslip.structure.craig_bampton import ReductionRow, reduction_table
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.study import run as study
from stickslip.study.analyses import solve
from stickslip.study.check import check
from stickslip.study.facts import resting_state
from stickslip.study.record import compare_modes, contact_of_modes
from stickslip.sweeps.work import CaseTask, reduce_task, solve_task
from sweep_cases import COARSE_MESH, quick_case

CONSTRAINED = "stuck (pairs closed at rest)"
GIVEN = {"normal_stiffness": "5e7 N/m", "tangential_stiffness": "4e7 N/m"}


def block_case(preload: Mapping[str, object], load: str = "80 N") -> Case:
    """The block on the beam; its lid stays 10 um off the ground, so that the sole alone is closed."""
    data = mesh_case(interfaces__lid__gap="0.01 mm").to_dict()
    for interface in data["interfaces"].values():
        del interface["normal_load"]
    data["interfaces"]["sole"] |= GIVEN
    data["preload"] = dict(preload)
    if preload.get("method") == "solved":
        data["static_loads"] = {"weight": {"set": "damper_top", "direction": [0, 0, -1], "force": load}}
    data["output"] |= {"mode_shapes": 4, "deflected_shape_frames": 0}
    return Case.from_mapping(data)


SOLVED = {"method": "solved", "residual_traction": "kept"}
PRESCRIBED = {"values": [2.0] * 24 + [0.0] * 24}  # a pair across a gap gets -k_n gap


def built(case: Case) -> Model:
    setup = set_up(case)
    return build_model(case, setup.assemble(), load_joint(case, setup.layout))


def table_of(found: Model) -> tuple[ReductionRow, ...]:
    return compare_modes(found.structure, found.superelement, found.joint.face_pairs, found.pairs.resting_stiffness())


@cache
def two_blades(traction: str) -> Model:
    """Faces whose nodes match, with some pairs open at rest."""
    changes = {"preload.method": "solved", "preload.residual_traction": traction}
    return built(casting_case().replace(COARSE_MESH | changes | {"roughness.fractal_roughness": "1e-10 m"}))


@pytest.mark.long
@pytest.mark.parametrize("preload", [SOLVED, PRESCRIBED], ids=["solved", "prescribed"])
def test_one_state_in_report_shapes_and_curve(tmp_path: Path, preload: dict[str, object]) -> None:
    outcome = study.run(block_case(preload), tmp_path)
    stuck_hz = outcome.response.linear.stuck_frequency_hz
    record = load_results(tmp_path / "results.nc").study
    assert record is not None
    opened = ~outcome.response.pairs.closed_at_rest
    assert opened.tolist() == [False] * 24 + [True] * 24
    assert [row["reduced_hz"] for row in record.mode_table] == pytest.approx(stuck_hz[:10], rel=1e-6)
    assert [row["full_hz"] for row in record.mode_table[:4]] == pytest.approx(stuck_hz[:4], rel=1e-3)
    shapes = meshio.read(tmp_path / "mode_shapes.vtu")
    named = [float(name.removesuffix(" Hz").split()[-1]) for name in shapes.point_data]
    assert named == pytest.approx(stuck_hz[:4], abs=0.06)
    assert record.mode_contact == CONSTRAINED
    page = html.unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert f"Natural frequencies, contact {CONSTRAINED}" in page
    assert "linear, stuck (pairs closed at rest)" in page
    assert "all stuck" not in page
    words = {name: meaning for name, _, _, meaning in record.derived}
    assert words["Normal stiffness, sole"] == "all pairs of the face, closed"
    assert words["Normal stiffness, lid"] == "all pairs of the face, as if the 24 open ones were closed"


@pytest.mark.slow
def test_closing_the_open_pairs_would_be_seen() -> None:
    """The springs of the lid are no trifle here: with them the frequencies are others by a fifth and more."""
    actual = built(block_case(PRESCRIBED))
    assert isinstance(actual.structure, Structure)
    all_closed = replace(actual.joint, preload=np.ones(48)).resting_springs
    wrong = reduction_table(actual.structure, actual.superelement, actual.joint.face_pairs, 3, all_closed)
    right = table_of(actual)
    assert np.count_nonzero(actual.joint.resting_springs) == 72
    np.testing.assert_array_equal(actual.joint.resting_springs, actual.pairs.resting_stiffness())
    assert max(one.full_hz / two.full_hz for one, two in zip(wrong, right, strict=False)) > 1.2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("preload", "words"), [(SOLVED, "(pairs without a gap)"), (PRESCRIBED, "(pairs closed at rest)")]
)
def test_check_shows_the_frequencies_of_the_run(preload: dict[str, object], words: str) -> None:
    case = block_case(preload)
    sections = dict(check(case))
    shown = dict(sections["Would run"])[f"first natural frequencies, contact stuck {words}"]
    actual = [float(number) for number in shown.removesuffix(" Hz").split(", ")]
    assert actual == pytest.approx([row.full_hz for row in table_of(built(case))[:4]], abs=0.06)
    assert dict(sections["Derived quantities"])["Normal load, lid"] == "0 N"


@pytest.mark.slow
def test_matching_faces_with_open_pairs_are_not_tied() -> None:
    actual = two_blades("released")
    closed = actual.pairs.closed_at_rest
    assert 0 < np.count_nonzero(closed) < closed.size
    assert contact_of_modes(actual.joint.face_pairs, True, actual.superelement) == "tied"
    assert contact_of_modes(actual.joint.face_pairs, False, actual.superelement) == CONSTRAINED
    omega, _ = modal_basis(actual.superelement.mass, stuck_stiffness_matrix(actual.superelement, actual.pairs))
    table = table_of(actual)
    assert [row.reduced_hz for row in table] == pytest.approx(omega[: len(table)] / (2.0 * np.pi), rel=1e-6)
    assert max(abs(row.difference_percent) for row in table[:2]) < 0.1


@pytest.mark.slow
def test_a_body_that_open_pairs_leave_free_moves_at_0_hz() -> None:
    """Table and check show it; the response refuses it. Its motions have neither difference nor modal assurance."""
    case = block_case({"values": [-1.0] * 24 + [0.0] * 24})
    actual = built(case)
    table = table_of(actual)
    assert max(max(row.full_hz, row.reduced_hz) for row in table[:6]) < 0.1
    assert all(math.isnan(row.difference_percent) and math.isnan(row.mac) for row in table[:6])
    assert isinstance(actual.structure, Structure)
    beam, _ = natural_frequencies(actual.structure.stiffness, actual.structure.mass, 8)
    assert [row.full_hz for row in table[6:8]] == pytest.approx(beam[6:], rel=1e-9)
    assert all(row.mac > 0.999 and row.difference_percent < 0.1 for row in table[6:8])
    sections = dict(check(case))
    frequencies = dict(sections["Would run"])["first natural frequencies, contact stuck (pairs closed at rest)"]
    assert frequencies == "0.00, 0.00, 0.00, 0.00 Hz"
    printed_sentence(sections["Warnings"][0][1])
    with rejects(InputError, "preload"):
        solve(case, actual)


@pytest.mark.slow
def test_friction_limit_only_where_the_state_was_found_with_friction() -> None:
    retained, released = (
        {name: (value, words) for name, value, _, words in resting_state(two_blades(traction))}
        for traction in ("kept", "released")
    )
    limit = [name for name in retained if name.startswith("Pairs on the friction limit at rest")]
    assert len(limit) == 2
    state = two_blades("kept").preload.state  # type: ignore[union-attr]
    size = np.hypot(*state.traction.T)
    friction = two_blades("kept").joint.friction_coefficient
    touching = (state.normal_force > 0.0) & (size > (1.0 - 1e-9) * friction * state.normal_force)
    assert sum(int(retained[name][0]) for name in limit) == np.count_nonzero(touching) > 0
    assert not any("friction limit" in name or "slip" in words for name, (_, words) in released.items())
    forces = {name: row for name, row in released.items() if name.startswith("Friction force at rest")}
    assert len(forces) == 2
    assert all(value == 0.0 and "without friction" in words for value, words in forces.values())
    assert all(float(retained[name][0]) > 1.0 and "resultant" in retained[name][1] for name in forces)


@pytest.mark.long
def test_a_sweep_gives_no_table_of_closed_pairs_to_a_case_with_open_ones(tmp_path: Path) -> None:
    case = quick_case().replace({"preload.method": "solved", "roughness.fractal_roughness": "1e-10 m"})
    setup = set_up(case)
    reduced = reduce_task(case, setup, 1)
    assert len(reduced.mode_table) == 10
    outcome = solve_task(CaseTask(case, "key", load_joint(case, setup.layout), 1, wants_file=True), reduced)
    assert outcome.file, outcome.message
    (tmp_path / "results.nc").write_bytes(outcome.file)
    saved = load_results(tmp_path / "results.nc")
    assert saved.study is not None
    assert not saved.response.pairs.closed_at_rest.all()
    assert saved.study.mode_table == ()


@pytest.mark.long
def test_a_sweep_compares_a_case_with_open_pairs_with_its_reference(tmp_path: Path) -> None:
    """There is no table of the full model, so the stuck frequencies of the reduced one stand beside the reference."""
    opened = {"preload.method": "solved", "roughness.fractal_roughness": "1e-10 m"}
    case = quick_case().replace({**opened, "reference.mode_frequencies": ["450 Hz"], "reference.source": "test"})
    setup = set_up(case)
    task = CaseTask(case, "key", load_joint(case, setup.layout), 1, wants_file=True)
    (tmp_path / "results.nc").write_bytes(solve_task(task, reduce_task(case, setup, 1)).file)
    saved = load_results(tmp_path / "results.nc")
    assert saved.study is not None
    assert saved.study.mode_contact == "stuck (pairs closed at rest)"
    first = saved.response.linear.stuck_frequency_hz[0]
    assert saved.study.mode_table[0] == {"mode": 1, "reduced_hz": first, "reference_hz": 450.0}
