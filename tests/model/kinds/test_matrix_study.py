"""A study of matrices: the same structure as a mesh gives the same joint; files, sets, lists of pairs, refusals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
import scipy.sparse
from typer.testing import CliRunner

from own_cases import MATRIX_STUDY, QUICK, mesh_case, write_matrices
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.core.errors import ImportFileError, InputError
from stickslip.formats.matrices.exchange import read_superelement, write_superelement
from stickslip.model.model import build_model, load_joint, set_up
from stickslip.reporting.page import page
from stickslip.results.record import reference_deviation
from stickslip.results.storage import load_results
from stickslip.structure.floating_parts import parts_of
from stickslip.structure.joined import joined_modes
from stickslip.structure.superelement import Superelement
from stickslip.study.solution import solve_case


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("matrices")
    write_matrices(folder, mesh_case())
    (folder / "study.toml").write_text(MATRIX_STUDY, encoding="utf-8")
    return folder


def changed(folder: Path, **changes: Any) -> Case:
    quick = {key: value for key, value in QUICK.items() if not key.startswith(("forces.", "responses."))}
    return load_case(folder / "study.toml").replace(
        quick | {key.replace("__", "."): value for key, value in changes.items()}
    )


@pytest.mark.long
def test_run_writes_report_and_results(folder: Path) -> None:
    result = CliRunner().invoke(app, ["run", str(folder / "study.toml"), "--out", str(folder / "out")])
    assert result.exit_code == 0, result.output
    saved = load_results(folder / "out" / "results.nc")
    assert saved.study is not None
    assert saved.study.title == "Vibration of superelement"
    assert saved.study.mode_table == ()
    assert (saved.response.contact_state > 0).any(), "nothing moves: raise the force of this test"
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "Contact states, lid" in page
    assert "Natural frequencies, contact" not in page
    assert saved.study.sketch is None  # matrices have no shape
    assert 'id="structure"' not in page


@pytest.mark.slow
def test_a_reference_is_compared_with_the_reduced_model(folder: Path, tmp_path: Path) -> None:
    """Matrices have no full model; the stuck frequencies of the solved one stand beside the reference."""
    case = changed(folder, reference__mode_frequencies=["900 Hz", "1.5 kHz"], reference__source="modal test")
    solution = solve_case(case)
    record = solution.record
    stuck_hz = solution.response.linear.stuck_frequency_hz
    assert record.mode_contact == "stuck"
    assert [row["reduced_hz"] for row in record.mode_table] == stuck_hz[:10].tolist()
    assert [row.get("reference_hz") for row in record.mode_table[:3]] == [900.0, 1500.0, None]
    assert reference_deviation(record.mode_table[0]) == pytest.approx(100.0 * (stuck_hz[0] / 900.0 - 1.0))
    text = page(solution.response, record)
    assert "Reduced model against reference, %" in text
    assert "Reference: modal test." in text


@pytest.mark.slow
def test_mesh_and_matrices_agree(folder: Path) -> None:
    """The lid of the mesh study and that of its own reduced matrices: places, directions, operator rows."""
    mesh, matrices = mesh_case(), changed(folder)
    lid = set_up(mesh).layout.face_pairs
    lid_rows = np.flatnonzero(lid.face == 1)
    setup = set_up(matrices)
    pairs = setup.layout.face_pairs
    order = np.argsort(pairs.first_node)
    expected = lid_rows[np.argsort(lid.first_node[lid_rows])]
    for name in ("points", "normal", "tangent1", "tangent2"):
        assert getattr(pairs, name)[order] == pytest.approx(getattr(lid, name)[expected], abs=1e-12)
    assert pairs.area.sum() == pytest.approx(160e-6)
    model = build_model(matrices, setup.assemble(), load_joint(matrices, setup.layout))
    assert model.excitation.on(model.superelement, 1).coefficients(0.0)[2].sum() == pytest.approx(8.0)
    assert model.joint.preload.sum() == pytest.approx(40.0)


@pytest.mark.slow
def test_separate_files_and_a_list_of_pairs_give_the_same_frequencies(folder: Path, tmp_path: Path) -> None:
    actual = read_superelement(folder)
    for name in ("stiffness", "mass"):
        scipy.io.mmwrite(tmp_path / f"{name}.mtx", scipy.sparse.coo_matrix(getattr(actual, name)), precision=17)
    nodes = actual.boundary_nodes
    rows = [f"{node}, {axis + 1}" for node in nodes for axis in range(3)]
    rows += [f"{10_000 + mode}, other" for mode in range(actual.size - 3 * nodes.size)]
    (tmp_path / "unknowns.csv").write_text("\n".join([*rows, ""]), encoding="utf-8")
    (tmp_path / "pairs.csv").write_text("\n".join([*map(str, actual.node_sets["lid"]), ""]), encoding="utf-8")
    text = MATRIX_STUDY.replace(
        'file = "superelement.npz"',
        'stiffness = "stiffness.mtx"\nmass = "mass.mtx"\nunknown_map = "unknowns.csv"\nlength_unit = "m"',
    ).replace('first = "lid"\nsecond = "ground"', 'pairs = "pairs.csv"')
    text = text.replace('set = "lid"', f"node = {nodes[0]}").replace(
        'point = ["48 mm", "3.67 mm", "14 mm"]', f"node = {nodes[-1]}"
    )
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    setup = set_up(load_case(tmp_path / "study.toml"))
    superelement = setup.assemble()
    assert isinstance(superelement, Superelement)
    assert superelement.size < actual.size, "matrix files are reduced to the nodes of the study"
    joint = load_joint(changed(folder), setup.layout)
    stuck_hz, _ = joined_modes(superelement, setup.layout.face_pairs, 4, joint.resting_springs)
    whole_hz, _ = joined_modes(actual, setup.layout.face_pairs, 4, joint.resting_springs)
    assert stuck_hz == pytest.approx(whole_hz, rel=1e-3)
    one, other = (each.layout.face_pairs for each in (setup, set_up(changed(folder))))
    assert np.array_equal(one.first_nodes, other.first_nodes)
    assert not one.second_weights.any()
    printed_sentence("\n".join(setup.layout.messages))
    (tmp_path / "pairs.csv").write_text("1, 2\n3\n", encoding="utf-8")
    with rejects(ImportFileError, "interfaces.lid.pairs"):
        set_up(load_case(tmp_path / "study.toml"))


WRONG = {
    "set": ({"interfaces.lid.first": "sole"}, "interfaces.lid.first"),
    "node": ({"forces.push.set": None, "forces.push.node": 1_000_000}, "forces.push.node"),
    "point": ({"responses.block.point": [9, 9, 9]}, "responses.block.point"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("changes", "about"), WRONG.values(), ids=WRONG.keys())
def test_what_does_not_fit_is_named(folder: Path, changes: dict[str, Any], about: str) -> None:
    data = changed(folder).to_dict()
    for path, value in changes.items():
        section, entry, key = path.split(".")
        if value is None:
            data[section][entry].pop(key)
        else:
            data[section][entry][key] = value
    with rejects(InputError, about):
        set_up(Case.from_mapping(data))


def test_roughness_needs_a_material(folder: Path) -> None:
    data = changed(folder).to_dict()
    for key in ("normal_stiffness", "tangential_stiffness"):
        data["interfaces"]["lid"].pop(key)
    with rejects(InputError):
        set_up(Case.from_mapping(data))


@pytest.mark.slow
def test_damping_of_the_files_is_taken_and_never_doubled(folder: Path, tmp_path: Path) -> None:
    actual = read_superelement(folder)
    damped = replace(actual, damping=2e-7 * actual.stiffness)
    write_superelement(tmp_path, damped)
    case = changed(folder, structure__file=str(tmp_path / "superelement.npz"))
    with rejects(InputError, "damping.modal_damping_ratio"):
        set_up(case)
    data = case.to_dict()
    data["damping"] = {"rayleigh_alpha": 3}
    both = Case.from_mapping(data)
    setup = set_up(both)
    model = build_model(both, setup.assemble(), load_joint(both, setup.layout))
    assert model.superelement.damping == pytest.approx(2e-7 * actual.stiffness + 3.0 * actual.mass, rel=1e-12, abs=1e-9)


def test_a_body_without_contact_without_support_is_rejected(folder: Path, tmp_path: Path) -> None:
    """The lid's name given to nodes of the clamped beam: contact then leaves the block alone."""
    actual = read_superelement(folder)
    part = parts_of(actual.stiffness)[: 3 * actual.boundary_nodes.size : 3]
    block = part[np.isin(actual.boundary_nodes, actual.node_sets["lid"])]
    beam = actual.boundary_nodes[part != block[0]]
    write_superelement(tmp_path, replace(actual, node_sets={"lid": beam[:4]}, recovery=None))
    text = MATRIX_STUDY.replace('"superelement.npz"', f'"{tmp_path / "superelement.npz"}"')
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(tmp_path / "study.toml")])
    assert result.exit_code == 2
    printed_sentence(" ".join(result.stderr.split()), "stiffness")


@pytest.mark.slow
def test_wrong_units_are_a_warning(folder: Path, tmp_path: Path) -> None:
    actual = read_superelement(folder)
    assert actual.positions is not None
    write_superelement(
        tmp_path, replace(actual, positions=1e6 * actual.positions, mass=1e-9 * actual.mass, recovery=None)
    )
    far = {"responses__block__point": ["48 km", "3.67 km", "14 km"]}
    layout = set_up(changed(folder, structure__file=str(tmp_path / "superelement.npz"), **far)).layout
    sentences = [odd.sentence for odd in layout.odd_values]
    printed_sentence("\n".join(sentences), "length_unit")
    sound = set_up(changed(folder)).layout
    assert (sound.messages, sound.odd_values) == ((), ())


def test_a_pair_that_appears_twice_in_a_list_is_rejected(folder: Path, tmp_path: Path) -> None:
    nodes = read_superelement(folder).node_sets["lid"]
    (tmp_path / "pairs.csv").write_text(f"{nodes[0]}\n{nodes[1]}\n{nodes[0]}", encoding="utf-8")
    data = changed(folder).to_dict()
    lid = data["interfaces"]["lid"]
    data["interfaces"]["lid"] = {key: lid[key] for key in lid if key not in ("first", "second")}
    data["interfaces"]["lid"]["pairs"] = str(tmp_path / "pairs.csv")
    with rejects(ImportFileError, "interfaces.lid.pairs"):
        set_up(Case.from_mapping(data))
    (tmp_path / "pairs.csv").write_text(f"{nodes[0]}\n{nodes[1]}", encoding="utf-8")
    assert set_up(Case.from_mapping(data)).layout.face_pairs.n_pairs == 2


def test_a_joint_that_appears_twice_is_rejected(folder: Path) -> None:
    data = changed(folder).to_dict()
    data["interfaces"]["again"] = {**data["interfaces"]["lid"], "normal": [0, 0, -1]}
    with rejects(InputError, "interfaces.lid", "interfaces.again"):
        set_up(Case.from_mapping(data))


@pytest.mark.slow
def test_a_file_of_another_kind_and_a_missing_map_are_reported(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "model.inp").write_text("*NODE\n", encoding="utf-8")
    with rejects(ImportFileError, "structure.file"):
        set_up(changed(folder, structure__file=str(tmp_path / "model.inp")))
    actual = read_superelement(folder)
    for name in ("stiffness", "mass"):
        scipy.io.mmwrite(tmp_path / f"{name}.mtx", scipy.sparse.coo_matrix(getattr(actual, name)), precision=17)
    files = 'stiffness = "stiffness.mtx"\nmass = "mass.mtx"\nlength_unit = "m"'
    (tmp_path / "study.toml").write_text(MATRIX_STUDY.replace('file = "superelement.npz"', files), encoding="utf-8")
    with rejects(InputError, "structure.unknown_map"):
        set_up(load_case(tmp_path / "study.toml"))
