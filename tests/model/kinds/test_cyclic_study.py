"""Studies of kind "cyclic": the parametric disk, the same sector from a mesh file, and bad input."""

from __future__ import annotations

import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from model_writers import write_inp
from sectors import annulus
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.core.errors import InputError, StudyFileError
from stickslip.model.kinds.cyclic import CyclicSetup
from stickslip.model.model import build_model, load_joint, set_up
from stickslip.reporting.disk_figures import disk_figures
from stickslip.reporting.page import page
from stickslip.reporting.structure_marks import of_first_sector
from stickslip.reporting.structure_view import best_camera, contact_extent
from stickslip.results.measures import summary
from stickslip.results.storage import load_results, save_results
from stickslip.results.tables import study_tables
from stickslip.solve.ridges.slip_onset import slip_onset
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.elasticity import Material, assemble
from stickslip.structure.joined import joined_modes
from stickslip.structure.mesh import Mesh
from stickslip.study.check import check
from stickslip.study.disk import DiskOfStudy
from stickslip.study.proposal import propose
from stickslip.study.ridge import checked_range
from stickslip.study.solution import solve_case
from stickslip.sweeps.design import design

# A small disk that solves in seconds.
COARSE = {"contact_columns": 2, "contact_rows": 1, "sectors": 20}
STEEL = {"young_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}  # that of the file
FACES = ["damper here", "damper ahead", "platform right", "platform left"]


def data(**structure: Any) -> dict[str, Any]:
    content = copy.deepcopy(EXAMPLES["bladed-disk"])
    content["structure"] = {"kind": "cyclic", **(COARSE | structure)}
    content["analysis"] = {"stiffness_band": False}
    content["reduction"] = {"modes": 8}
    content["output"] = {"figure_formats": []}
    return content


def changed(**sections: Any) -> Case:
    """The coarse disk with other sections."""
    return Case.from_mapping({**data(), **sections})


def mesh_of(case: Case) -> Mesh:
    setup = set_up(case)
    assert isinstance(setup, CyclicSetup)
    return setup.sector.mesh


def file_data(folder: Path, points: Any = None, **structure: Any) -> dict[str, Any]:
    """The study of the coarse disk from a mesh file, with nodes at other ``points`` (n, 3) if they are given."""
    named = mesh_of(changed())
    mesh = Mesh(
        named.points if points is None else points,
        named.cells,
        named.body,
        {key.replace(" ", "_"): value for key, value in named.node_sets.items() if key not in FACES},
        ("blade", "damper"),
        {key.replace(" ", "_"): value for key, value in named.face_sets.items()},
    )
    write_inp(folder / "sector.inp", mesh, ["blade", "damper"], [face.replace(" ", "_") for face in FACES], "bore")
    content = data()
    content["structure"] = {
        "kind": "cyclic", "file": str(folder / "sector.inp"), "length_unit": "mm",
        "left": "left_boundary", "right": "right_boundary", **structure,
    }  # fmt: skip
    del content["material"]
    for interface in content["interfaces"].values():
        interface |= {key: interface[key].replace(" p", "_p").replace("r h", "r_h").replace("r a", "r_a")
                      .replace("m r", "m_r").replace("m l", "m_l").replace("next_p", "next p")
                      for key in ("first", "second")}  # fmt: skip
    content["responses"]["damper"]["set"] = "damper_middle"
    return content


@pytest.mark.slow
def test_the_study_of_a_file_is_that_of_the_dimensions(tmp_path: Path) -> None:
    own = changed(material=STEEL)
    read = Case.from_mapping(file_data(tmp_path))
    one, other = (set_up(case) for case in (own, read))
    assert isinstance(one, CyclicSetup)
    assert isinstance(other, CyclicSetup)
    assert one.symmetry.sectors == other.symmetry.sectors == 20
    joints = [load_joint(case, setup.layout) for case, setup in ((own, one), (read, other))]
    np.testing.assert_allclose(joints[0].normal_stiffness, joints[1].normal_stiffness, rtol=1e-6)
    frequencies = [
        setup.assemble().stuck_frequencies(joint.face_pairs, joint.resting_springs, 4, 3)
        for setup, joint in zip((one, other), joints, strict=True)
    ]
    np.testing.assert_allclose(frequencies[0], frequencies[1], rtol=1e-5)


@pytest.mark.long
def test_tied_boundaries_of_a_file(tmp_path: Path) -> None:
    """Nodes of the right boundary move along it, so that the boundaries do not match; the frequencies hardly change."""
    plain = set_up(changed(material=STEEL))
    assert isinstance(plain, CyclicSetup)
    points, right = plain.sector.mesh.points.copy(), plain.symmetry.right
    radius = np.hypot(points[right, 0], points[right, 1])
    share = (radius - radius.min()) / np.ptp(radius)
    points[right, :2] *= (1.0 + 0.01 * share * (1.0 - share))[:, None]
    content = file_data(tmp_path, points, axis=[0, 0, 1])
    with rejects(InputError, "structure.left", "structure.right"):
        set_up(Case.from_mapping(content))
    content["structure"]["tied"] = True
    case = Case.from_mapping(content)
    setup = set_up(case)
    assert isinstance(setup, CyclicSetup)
    assert setup.symmetry.is_tied
    assert "tied" in dict(setup.sizes())["boundaries"]
    for diameter in (1, 4):
        own, expected = (
            each.assemble().stuck_frequencies(joint.face_pairs, joint.resting_springs, diameter, 3)
            for each, joint in ((one, load_joint(case, one.layout)) for one in (setup, plain))
        )
        np.testing.assert_allclose(own, expected, rtol=5e-3)
        assert (own != expected).all()
    reduced = build_model(case).substructure.require_sector()
    assert reduced.symmetry is not None
    assert reduced.symmetry.is_tied
    content["responses"]["edge"] = {"node": int(right[-1]) + 1, "direction": [1.0, 0.0, 0.0]}
    with rejects(InputError, "responses.edge"):
        set_up(Case.from_mapping(content))


@pytest.mark.long
def test_the_page_of_a_disk(tmp_path: Path) -> None:
    case = changed(solver={"frequency_start": "580 Hz", "frequency_stop": "600 Hz", "harmonics": 2, "samples": 64})
    solution = solve_case(case)
    assert solution.converged
    disk = DiskOfStudy.of(case, solution.model)
    assert disk is not None
    record = solution.record
    assert record.disk is not None
    assert record.disk.diameter == 4
    np.testing.assert_array_equal(record.disk.diameters, np.arange(11))
    # the diagram at the diameter of the wave has the linear limits of the curve
    np.testing.assert_allclose(record.disk.stuck_hz[4, :2], solution.response.linear.stuck_frequency_hz[:2], rtol=1e-9)
    differences = [float(row["difference_percent"]) for row in record.mode_table[:2]]
    assert all(0.0 <= each < 0.5 for each in differences)
    # the motion of the mesh is that of the response at its node, and all sectors move alike
    assert solution.motion is not None
    tip = int(mesh_of(case).node_set("tip")[0])
    point = int(np.argmin(np.abs(solution.response.frequency_hz - solution.motion.frequency_hz)))
    expected = solution.response.coefficients(solution.model.outputs["tip"])[point]
    np.testing.assert_allclose(solution.motion.displacement[3 * tip + 1], expected, rtol=1e-9)
    whole = disk.ring_motion(solution.motion.displacement).reshape(-1, 3, expected.size)
    tips = whole[disk.ring.number[:, tip]]
    # the motion along the axis of the disk needs no rotation
    amplitude = np.linalg.norm(tips[:, 2, 1:3], axis=1)
    np.testing.assert_allclose(amplitude, amplitude[0], rtol=1e-9)
    later = tips[1, 2, 1] - 1j * tips[1, 2, 2]
    here = tips[0, 2, 1] - 1j * tips[0, 2, 2]
    np.testing.assert_allclose(later / here, np.exp(-2j * np.pi * 4 / 20), rtol=1e-9)
    save_results(tmp_path / "results.nc", solution.response, record)
    saved = load_results(tmp_path / "results.nc")
    assert saved.study is not None
    assert saved.study.disk is not None
    np.testing.assert_array_equal(saved.study.disk.free_hz, record.disk.free_hz)
    tables = {table.name: table for table in study_tables(solution.response, record)}
    assert len(tables["nodal_diameters"].columns[0].values) == 11
    drawn = disk_figures(solution.response, record)
    assert set(drawn) == {"nodal_diameters", "disk"}
    text = str(page(solution.response, record))
    assert "t1 and t2 are those of the first sector" in text
    sketch, known = record.sketch, record.face_directions
    assert sketch is not None
    assert known is not None
    first = of_first_sector(record, sketch)
    for face, middle in enumerate(known.middle):
        near = first.points[first.sides[first.face == face]].mean(axis=1) - middle
        assert 0 < len(near) == (sketch.face == face).sum() / 20
        assert np.linalg.norm(near, axis=1).max() < 0.015  # half of the width of the disk
    assert contact_extent(sketch, best_camera(sketch)) is None
    assert contact_extent(first, best_camera(first)) is not None
    assert "Every sector has the same amplitude" in text
    assert "those of the disk at rest" in text
    turning = replace(record, inputs=changed(rotation={"speed": "3000 rpm"}).to_text())
    assert "those at 3000 rpm" in str(page(solution.response, turning))
    assert "Nodal diameter of 20 sectors" in text
    assert summary(solution.response, solution.model.outputs["tip"]).peak.amplitude < 1e-3


@pytest.mark.slow
def test_check_of_a_disk() -> None:
    rows = {label: value for _, section in check(changed()) for label, value in section}
    assert rows["disk"] == "20 sectors about (0, 0, 1) through (0, 0, 0) mm"
    assert rows["excitation"].startswith("Forward wave of engine order 4")


@pytest.mark.slow
def test_the_proposal_of_a_disk() -> None:
    case = changed()
    proposal = propose(case)
    assert proposal.onset is not None
    assert proposal.onset.stuck_peak is not None
    model = build_model(case)
    assert isinstance(model.substructure, CyclicSector)
    # an independent way to the same peak: the dense dynamic stiffness of the nodal diameter
    sector, pairs = model.substructure, model.pairs
    here, ahead = np.hsplit(pairs.operator, 2)
    operator = here + np.exp(-2j * np.pi * 4 / 20) * ahead
    matrices = sector.lagged(-4)
    stiffness = matrices.stiffness + operator.conj().T @ (pairs.resting_stiffness()[:, None] * operator)
    squares, modes = scipy.linalg.eigh(stiffness, matrices.mass)
    row = model.outputs["tip"][: sector.size]
    omega = 2.0 * np.pi * proposal.onset.stuck_peak.frequency_hz
    gain = (row @ modes) * (modes.conj().T @ row) / (squares - omega**2 + 2e-3j * np.sqrt(squares.clip(0.0)) * omega)
    np.testing.assert_allclose(proposal.onset.stuck_peak.amplitude, 0.5 * abs(gain.sum()), rtol=1e-3)
    assert 550.0 < proposal.onset.stuck_peak.frequency_hz < 620.0
    assert proposal.onset.first is not None
    assert proposal.frequency_hz is not None


@pytest.mark.slow
def test_without_a_range_the_dampers_that_move_freely_do_not_end_the_damping() -> None:
    """The first modes of the disk without contact are those of its wedges, at 0 Hz."""
    case = changed()
    model = build_model(case)
    joint = model.pairs, model.excitation, model.outputs["tip"]
    without, within = (
        slip_onset(model.substructure, *joint, modal_damping_ratio=0.001, highest_hz=each) for each in (None, 700.0)
    )
    assert without.stuck_peak is not None
    assert within.stuck_peak is not None
    assert without.stuck_peak.amplitude == pytest.approx(within.stuck_peak.amplitude, rel=1e-3)
    assert without.first == pytest.approx(within.first, rel=1e-3)


REJECTED: list[tuple[str, dict[str, Any]]] = [
    ("analysis.kind", {"analysis": {"kind": "mode"}}),
    ("analysis.search", {"analysis": {"search": True}}),
    ("preload.method", {"preload": {"method": "solved"}}),
    ("damping.modal_damping_ratio", {"damping": {"modal_damping_ratio": 0.0}}),
    ("travelling_wave.engine_order", {"travelling_wave": {"direction": "backward"}}),
    ("travelling_wave.direction", {"travelling_wave": {"engine_order": 3, "direction": "left"}}),
    ("structure.left", {"structure": {"kind": "cyclic", "left": "here"}}),
    ("structure.sectors", {"structure": {"kind": "cyclic", "sectors": 1}}),
    (
        "static_loads",
        {"static_loads": {"own": {"set": "tip", "direction": [0, 0, 1], "force": "3 N"}}},
    ),
]


@pytest.mark.parametrize(("key", "sections"), REJECTED)
def test_sections_that_a_sector_does_not_allow(key: str, sections: dict[str, Any]) -> None:
    if key in ("preload.method", "damping.modal_damping_ratio"):
        sections = sections | {"interfaces": data()["interfaces"]}
    with pytest.raises(StudyFileError) as caught:
        changed(**sections)
    assert key in caught.value.keys
    printed_sentence(str(caught.value))


def test_a_wave_that_is_missing() -> None:
    content = data()
    del content["travelling_wave"]
    with rejects(StudyFileError, "travelling_wave"):
        Case.from_mapping(content)


def test_dimensions_that_do_not_fit() -> None:
    with rejects(InputError, "structure.rim_radius"):
        set_up(Case.from_mapping(data(rim_radius="50 mm")))


BAD_FILES: list[tuple[str, dict[str, Any]]] = [
    ("structure.left", {"left": "nothing"}),
    ("structure.sectors", {"sectors": 24}),
    ("structure.right", {"right": "bore"}),
    ("structure.left", {"axis": [1, 1, 0]}),
    ("structure.axis_point", {"axis_point": ["0 mm", "0 mm", "0 mm"]}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("key", "structure"), BAD_FILES)
def test_a_sector_that_is_none(tmp_path: Path, key: str, structure: dict[str, Any]) -> None:
    case = Case.from_mapping(file_data(tmp_path, **structure))
    with pytest.raises(InputError) as caught:
        set_up(case)
    assert key in caught.value.keys
    printed_sentence(str(caught.value))


def test_faces_of_the_next_sector_alone() -> None:
    content = data()
    content["interfaces"]["own platform"] |= {"first": "next damper here", "second": "next platform right"}
    with rejects(InputError, "interfaces.own platform"):
        set_up(Case.from_mapping(content))


def test_a_force_on_a_constrained_node() -> None:
    content = data()
    content["forces"]["gas"]["set"] = "bore"
    with rejects(InputError, "forces.gas"):
        set_up(Case.from_mapping(content))


@pytest.mark.long
def test_all_nodal_diameters_against_the_full_ring() -> None:
    """The ring of all sectors with all its stuck pairs, by the ordinary path: the same frequencies, in pairs."""
    content = data(sectors=6)
    content["reduction"] = {"modes": 20}
    case = Case.from_mapping(content)
    model = build_model(case)
    disk = DiskOfStudy.of(case, model)
    assert disk is not None
    ring, layout = disk.ring, disk.ring_layout(model.joint.layout)
    full = assemble(ring.mesh, Material(), fixed_nodes=ring.mesh.node_set("bore"))
    springs = np.tile(model.pairs.resting_stiffness(), 6)
    whole, _ = joined_modes(full, layout.face_pairs, 12, springs)
    found = disk.frequencies()
    every = np.concatenate([np.repeat(row, 1 if each in (0, 3) else 2) for each, row in enumerate(found.stuck_hz)])
    np.testing.assert_allclose(np.sort(every)[:12], whole, rtol=2e-4)  # by the reduction
    unreduced = [
        disk.structure.stuck_frequencies(model.joint.face_pairs, model.pairs.resting_stiffness(), each, 4)
        for each in range(4)
    ]
    every = np.concatenate([np.repeat(row, 1 if each in (0, 3) else 2) for each, row in enumerate(unreduced)])
    np.testing.assert_allclose(np.sort(every)[:12], whole, rtol=1e-7)


def test_designs_and_ridges_of_a_disk() -> None:
    with rejects(InputError, "structure.kind"):
        design(changed(), {"friction.coefficient": (0.2, 0.6)})
    layout = set_up(changed()).layout
    with rejects(InputError, "structure.kind"):
        checked_range(changed(), "friction.coefficient", (0.2, 0.6), layout)


def test_a_body_over_three_sectors(tmp_path: Path) -> None:
    own = annulus(6, (0.05, 0.1), 0.01, (2, 2, 1))
    long = annulus(6, (0.11, 0.13), 0.01, (1, 2, 1), of=3)
    mesh = Mesh(
        np.vstack([own.points, long.points]),
        np.vstack([own.cells, np.asarray(long.cells) + own.n_nodes]),
        np.repeat([0, 1], [own.n_cells, long.n_cells]),
        {**own.node_sets, "tip": np.array([own.n_nodes - 1])},
        ("plate", "band"),
    )
    write_inp(tmp_path / "sector.inp", mesh, ["plate", "band"], [], "inner")
    content = data()
    content["structure"] = {
        "kind": "cyclic", "file": str(tmp_path / "sector.inp"), "length_unit": "mm", "left": "left", "right": "right",
    }  # fmt: skip
    with rejects(InputError, "structure.file"):
        set_up(Case.from_mapping(content))


@pytest.mark.long
def test_the_page_of_a_disk_with_coriolis_forces(tmp_path: Path) -> None:
    """The diagram has the waves of the excitation and those against it, in the file and in the table too."""
    wave = {"engine_order": 19, "direction": "forward"}  # of 20 sectors: a backward wave of nodal diameter 1
    case = changed(
        rotation={"speed": "9000 rpm", "coriolis": True},
        travelling_wave=wave,
        solver={"frequency_start": "580 Hz", "frequency_stop": "584 Hz", "harmonics": 1, "samples": 64},
    )
    solution = solve_case(case)
    stored = solution.record
    save_results(tmp_path / "results.nc", solution.response, stored)
    saved = load_results(tmp_path / "results.nc").study
    assert saved is not None
    disk = saved.disk
    assert disk is not None
    assert disk.opposite_hz is not None
    linear = solution.response.linear
    np.testing.assert_allclose(disk.stuck_hz[1, :2], linear.stuck_frequency_hz[:2], rtol=1e-9)
    np.testing.assert_allclose(disk.free_hz[1, :2], linear.free_frequency_hz[:2], rtol=1e-9)
    sector = solution.model.substructure.require_sector()
    np.testing.assert_allclose(disk.free_hz[1, 0], sector.natural_frequencies(1, 7, "backward")[6], rtol=1e-6)
    assert (np.abs(disk.opposite_hz[1] / disk.stuck_hz[1] - 1.0) > 1e-5).any()
    np.testing.assert_allclose(disk.opposite_hz[[0, 10]], disk.stuck_hz[[0, 10]], rtol=1e-9)
    tables = {table.name: table for table in study_tables(solution.response, stored)}
    assert len(tables["nodal_diameters"].columns) == 1 + 3 * disk.stuck_hz.shape[1]
    assert "waves against the excitation" in str(page(solution.response, stored))
