"""[rotation] of study files: stiffness at the speed against ss.rotating, closed forms, and bodies assembled alone."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

import stickslip as ss
from own_cases import mesh_case
from sentences import printed_sentence, rejects
from stickslip.case.case import Case
from stickslip.case.examples import EXAMPLES
from stickslip.core.errors import InputError, StudyFileError
from stickslip.model import study_structure
from stickslip.model.kinds.mesh import MeshSetup
from stickslip.model.kinds.two_blade import TwoBladeSetup
from stickslip.model.model import ReducedModel, build_model, connect, kind_of, load_joint, set_up
from stickslip.model.parameters import case_parameters
from stickslip.results.measures import summary
from stickslip.structure.body_load import centrifugal_load
from stickslip.structure.elasticity import natural_frequencies
from stickslip.structure.factor import factorize
from stickslip.structure.gyroscopic import gyroscopic_modes
from stickslip.structure.mesh import Mesh
from stickslip.structure.rotating_superelement import RPM
from stickslip.structure.rotation_matrices import nodal_mass, softening_matrix, stress_stiffness_matrix
from stickslip.structure.sector_structure import SectorStructure
from stickslip.study.check import check
from stickslip.study.solution import solve_case
from stickslip.sweeps.plan import case_hashes
from turning_cases import TURN, beam_case, disk_case

STEEL = ss.Material(210e9, 0.3, 7850.0)


def free_hz(model: ReducedModel, count: int) -> Any:
    """Natural frequencies of the reduced structure without contact."""
    superelement = model.superelement
    squares, modes = scipy.linalg.eigh(superelement.stiffness, superelement.mass)
    elastic = np.sqrt(squares.clip(0.0))
    if superelement.gyroscopic is not None:
        elastic = gyroscopic_modes(elastic, modes.T @ superelement.gyroscopic @ modes)[0]
    return elastic[:count] / (2.0 * np.pi)


def at_rest(case: Case) -> Any:
    setup = set_up(case)
    assert isinstance(setup, MeshSetup)
    return setup.at_rest()


@pytest.mark.slow
@pytest.mark.parametrize("coriolis", [False, True])
def test_a_beam_of_a_study_has_the_frequencies_of_the_rotating_mesh(tmp_path: Path, coriolis: bool) -> None:
    case = beam_case(tmp_path, speed="6000 rpm", coriolis=coriolis)
    model = build_model(case)
    assert (model.superelement.gyroscopic is not None) is coriolis
    rotor = ss.rotating(at_rest(case), (0, 0, 1), (-0.1, 0.005, 0.004))
    expected = rotor.natural_frequencies(6000.0, 3, coriolis)
    np.testing.assert_allclose(free_hz(model, 3), expected, rtol=1e-4)
    still = free_hz(build_model(beam_case(tmp_path)), 4)
    assert expected[0] > 1.3 * still[0]
    if coriolis:
        without = rotor.natural_frequencies(6000.0, 3, coriolis=False)
        assert np.abs(expected / without - 1.0).max() > 5e-4  # it is a difference that the test sees


@pytest.mark.slow
def test_check_shows_the_frequencies_at_the_speed(tmp_path: Path) -> None:
    """They are those of a dense solution of the mesh at the speed with the springs of the joint."""
    case = beam_case(tmp_path, speed="6000 rpm")
    rows = {label: value for _, section in check(case) for label, value in section}
    shown = [float(each) for each in rows["first natural frequencies, contact stuck"].removesuffix(" Hz").split(", ")]
    rotor = ss.rotating(at_rest(case), (0, 0, 1), (-0.1, 0.005, 0.004)).at(6000.0)
    pairs = set_up(case).layout.face_pairs
    operator = rotor.of_unknowns(pairs.mesh_operator(rotor.mesh.n_nodes)).toarray()
    springs = build_model(case).pairs.resting_stiffness()
    stiffness = rotor.stiffness.toarray() + operator.T @ (springs[:, None] * operator)
    squares = scipy.linalg.eigh(stiffness, rotor.mass.toarray(), eigvals_only=True, subset_by_index=(0, 3))
    np.testing.assert_allclose(shown, np.sqrt(squares) / (2.0 * np.pi), atol=0.006)
    assert rows["Speed of rotation"] == "6000 rpm"


@pytest.mark.slow
def test_a_shaft_collapses_at_its_first_frequency(tmp_path: Path) -> None:
    """A beam that turns about its own axis: softening takes the square of the speed from both bending frequencies."""
    along = {"axis": [1, 0, 0], "point": ["0 mm", "10 mm", "5 mm"]}
    still = free_hz(build_model(beam_case(tmp_path)), 2)
    speed_hz = 0.8 * still[0]
    model = build_model(beam_case(tmp_path, speed=f"{60.0 * speed_hz} rpm", **along))
    np.testing.assert_allclose(free_hz(model, 2), np.sqrt(still**2 - speed_hz**2), rtol=1e-3)
    with rejects(InputError, "rotation.speed") as caught:
        build_model(beam_case(tmp_path, speed=f"{60.0 * 1.1 * still[0]} rpm", **along))
    collapse = float(str(caught.value).partition("collapses at ")[2].partition(" rpm")[0])
    assert collapse == pytest.approx(60.0 * still[0], rel=1e-3)


@pytest.mark.slow
def test_a_damper_without_constraint_keeps_its_stiffness_at_rest() -> None:
    case = mesh_case(**{f"rotation__{key}": value for key, value in {**TURN, "speed": "9000 rpm"}.items()})
    model, still = build_model(case), build_model(mesh_case())
    rotor = ss.rotating(at_rest(case), (0, 0, 1), (-0.1, 0.005, 0.004), free_bodies="at rest")
    damper = np.flatnonzero(np.isin(model.superelement.boundary_nodes, rotor.structure.node[rotor.unsupported]))
    unknowns = (3 * damper[:, None] + np.arange(3)).ravel()
    change = (model.superelement.stiffness - still.superelement.stiffness)[np.ix_(unknowns, unknowns)]
    assert np.abs(change).max() < 1e-9 * np.abs(still.superelement.stiffness[np.ix_(unknowns, unknowns)]).max()
    found = free_hz(model, 10)[6:]
    expected = rotor.natural_frequencies(9000.0, 10, coriolis=False)[6:]
    np.testing.assert_allclose(found, expected, rtol=1e-3)
    assert found[0] > 1.01 * free_hz(still, 10)[6]
    (free,) = [words for words in set_up(case).layout.messages if "[rotation]" in words]
    for words in (free, *kind_of(case).warnings(case)):
        printed_sentence(words)
    assert not any("[rotation]" in words for words in set_up(mesh_case()).layout.messages)
    with rejects(InputError, "rotation.coriolis"):
        build_model(case.replace({"rotation.coriolis": True}))


def coarse_blades(speed: str) -> Case:
    content = copy.deepcopy(EXAMPLES["two-blade"])
    content["rotation"] = {"speed": speed, "axis": [0, 1, 0], "point": ["0 mm", "0 mm", "-300 mm"]}
    content["mesh"] = {"airfoil_rows": 12, "chordwise": 4, "shank_rows": 5, "contact_columns": 2}
    return Case.from_mapping(content)


@pytest.mark.slow
def test_two_blades_at_a_speed_have_the_frequencies_of_one_blade_alone() -> None:
    case = coarse_blades("3000 rpm")
    setup = set_up(case)
    assert isinstance(setup, TwoBladeSetup)
    mesh: Any = setup.mesh
    nodes = np.unique(mesh.cells[mesh.body == 0])
    blade = Mesh(mesh.points[nodes], np.searchsorted(nodes, mesh.cells[mesh.body == 0]))
    fixed = np.flatnonzero(np.isin(nodes, mesh.node_set("fixed")))
    alone = ss.assemble(blade, setup.material, setup.element, fixed)
    expected = ss.rotating(alone, (0, 1, 0), (0.0, 0.0, -0.3)).natural_frequencies(3000.0, 2, coriolis=False)
    found = free_hz(build_model(case), 10)
    np.testing.assert_allclose(found[6:10:2], expected, rtol=2e-3)  # below six rigid motions of the damper
    rest = ss.rotating(alone, (0, 1, 0), (0.0, 0.0, -0.3)).natural_frequencies(0.0, 1)
    assert expected[0] > 1.02 * rest[0]


def test_a_damper_and_its_blades_have_one_speed() -> None:
    content = copy.deepcopy(EXAMPLES["two-blade"])
    content["rotation"] = {**TURN, "speed": "3000 rpm"}
    content["preload"] = {"damper_mass": "20 g", "radius_of_rotation": "300 mm", "speed_of_rotation": "3000 rpm"}
    case = Case.from_mapping(content)
    same, other = (kind_of(each).warnings(each) for each in (case, case.replace({"rotation.speed": "3001 rpm"})))
    assert len(other) == len(same) + 1
    printed_sentence(other[-1])
    assert not any("normal loads" in words for words in same)  # the load is that of the speed


@pytest.mark.long
def test_a_disk_of_a_study_has_the_frequencies_of_the_rotating_sector() -> None:
    case = disk_case(speed="9000 rpm")
    model, rest = build_model(case), build_model(disk_case())
    structure = rest.structure
    rotor = ss.rotating(structure.structure, (0, 0, 1), symmetry=structure.symmetry, free_bodies="at rest")  # type: ignore[union-attr]
    assert rotor.unsupported.size > 6  # the wedge
    (free,) = [words for words in set_up(case).layout.messages if "[rotation]" in words]
    assert "damper" in free
    full = ss.sector_frequencies(rotor.at(9000.0), structure.symmetry, (0, 4, 10), 8)  # type: ignore[union-attr]
    for diameter, expected in full.items():
        found = model.substructure.require_sector().natural_frequencies(diameter, 8)
        np.testing.assert_allclose(found[6:], expected[6:], rtol=5e-3)
        still = rest.substructure.require_sector().natural_frequencies(diameter, 8)
        assert found[6] > 1.05 * still[6]
    with rejects(InputError, "rotation.speed"):
        build_model(disk_case(speed="500000 rpm"))


@pytest.mark.slow
def test_speed_zero_is_the_structure_at_rest() -> None:
    one, other = (build_model(each) for each in (disk_case(), disk_case(speed="0 rpm")))
    assert kind_of(disk_case()).warnings(disk_case(speed="0 rpm")) == ()
    for diameter, matrices in one.substructure.require_sector().diameters.items():
        np.testing.assert_array_equal(
            matrices.stiffness, other.substructure.require_sector().diameters[diameter].stiffness
        )


@pytest.mark.slow
@pytest.mark.parametrize("coriolis", [False, True])
def test_one_reduction_for_all_speeds(tmp_path: Path, coriolis: bool) -> None:
    case = beam_case(tmp_path, speed="3000 rpm", top_speed="6000 rpm", coriolis=coriolis)
    model = build_model(case)
    rotor = ss.rotating(at_rest(case), (0, 0, 1), (-0.1, 0.005, 0.004))
    for speed in (0.0, 3000.0, 6000.0):
        other = connect(case.replace({"rotation.speed": f"{speed} rpm"}), model.reduced, model.joint)
        np.testing.assert_allclose(free_hz(other, 3), rotor.natural_frequencies(speed, 3, coriolis), rtol=1e-4)
    np.testing.assert_array_equal(
        model.superelement.stiffness, connect(case, model.reduced, model.joint).superelement.stiffness
    )
    sent = model.reduced.without_recovery()
    assert sent.at(0.0).require_structure().recovery is None
    with rejects(InputError, "rotation.speed"):
        model.reduced.at(700.0)
    with rejects(InputError, "rotation.top_speed"):
        build_model(case.replace({"rotation.top_speed": "900000 rpm"}))


@pytest.mark.slow
def test_one_reduction_for_all_speeds_with_a_free_damper() -> None:
    turn = {f"rotation__{key}": value for key, value in {**TURN, "speed": "9000 rpm"}.items()}
    model = build_model(mesh_case(**turn, rotation__top_speed="12000 rpm"))
    for speed in (0.0, 9000.0, 12000.0):
        at_speed = build_model(mesh_case(**turn).replace({"rotation.speed": f"{speed} rpm"}))
        superelement = model.reduced.at(speed * RPM).require_structure()
        squares = scipy.linalg.eigh(superelement.stiffness, superelement.mass, eigvals_only=True)
        np.testing.assert_allclose(np.sqrt(squares[6:12]) / (2.0 * np.pi), free_hz(at_speed, 12)[6:], rtol=1e-3)


@pytest.mark.slow
def test_the_reduction_for_all_speeds_is_read_from_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "cache"))
    case = beam_case(tmp_path, speed="3000 rpm", top_speed="6000 rpm")
    first = build_model(case)
    monkeypatch.setattr(study_structure, "rotating_superelement", None)  # a second reduction would fail
    second = build_model(case.replace({"rotation.speed": "6000 rpm"}))
    np.testing.assert_array_equal(first.reduced.at(6000.0 * RPM).require_structure().mass, second.superelement.mass)
    np.testing.assert_allclose(
        first.reduced.at(6000.0 * RPM).require_structure().stiffness, second.superelement.stiffness, rtol=1e-12
    )
    monkeypatch.undo()
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "cache"))
    assert len(list((tmp_path / "cache").glob("rotating-*.npz"))) == 1
    build_model(case.replace({"rotation.top_speed": "6001 rpm"}))
    assert len(list((tmp_path / "cache").glob("rotating-*.npz"))) == 2


@pytest.mark.long
def test_the_reduction_of_a_sector_is_read_from_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    first = build_model(disk_case(speed="3000 rpm")).substructure.require_sector()
    with monkeypatch.context() as context:
        context.setattr(SectorStructure, "reduced", None)  # a second reduction would fail
        second = build_model(disk_case(speed="3000 rpm")).substructure.require_sector()
    assert list(first.diameters) == list(second.diameters)
    for diameter, matrices in first.diameters.items():
        for name in ("mass", "stiffness", "modes"):
            own = getattr(second.diameters[diameter], name)
            np.testing.assert_array_equal(own, getattr(matrices, name))
            assert own.dtype == getattr(matrices, name).dtype
    build_model(disk_case(speed="3001 rpm"))
    assert len(list(tmp_path.glob("sector-*.npz"))) == 2
    first, second = (
        build_model(disk_case(speed="3001 rpm", coriolis=True)).substructure.require_sector() for _ in range(2)
    )
    assert len(list(tmp_path.glob("sector-*.npz"))) == 3
    for diameter, matrices in first.diameters.items():
        np.testing.assert_array_equal(second.diameters[diameter].gyroscopic, matrices.gyroscopic)


REJECTED: list[tuple[dict[str, Any], str]] = [
    ({"rotation": {**TURN, "speed": "3000 rpm", "coriolis": True}}, "rotation.coriolis"),
    ({"rotation": {"speed": "3000 rpm"}}, "rotation.axis"),
    ({"rotation": {**TURN, "speed": "3000 rpm", "top_speed": "2000 rpm"}}, "rotation.top_speed"),
]


@pytest.mark.parametrize(("sections", "key"), REJECTED)
def test_keys_that_two_blades_do_not_have(sections: dict[str, Any], key: str) -> None:
    with rejects(StudyFileError, key):
        Case.from_mapping({**copy.deepcopy(EXAMPLES["two-blade"]), **sections})


@pytest.mark.parametrize("key", ["axis", "point"])
def test_keys_that_a_sector_does_not_have(key: str) -> None:
    value = {"axis": [0, 0, 1], "point": ["1 mm", "0 mm", "0 mm"]}[key]
    with rejects(StudyFileError, f"rotation.{key}"):
        disk_case(speed="3000 rpm", **{key: value})


@pytest.mark.parametrize(
    ("analysis", "key"),
    [
        ({"kind": "mode", "smallest_amplitude": "1 um", "largest_amplitude": "9 um"}, "analysis.kind"),
        ({"gradients": True}, "analysis.gradients"),
    ],
)
def test_analyses_without_coriolis_forces(tmp_path: Path, analysis: dict[str, Any], key: str) -> None:
    content = beam_case(tmp_path, speed="3000 rpm", coriolis=True).to_dict()
    with rejects(StudyFileError, key):
        Case.from_mapping({**content, "analysis": analysis})


def test_cases_of_a_sweep_share_a_structure_at_one_speed_only(tmp_path: Path) -> None:
    first, second = (beam_case(tmp_path, speed=speed) for speed in ("3000 rpm", "3001 rpm"))
    other_force = first.replace({"forces.shaker.amplitude": "2 N"})
    assert case_hashes(first)[1] == case_hashes(other_force)[1]
    assert case_hashes(first)[1] != case_hashes(second)[1]
    shared = [case_hashes(each.replace({"rotation.top_speed": "6000 rpm"})) for each in (first, second)]
    assert shared[0][1] == shared[1][1]
    assert shared[0][0] != shared[1][0]


@pytest.mark.slow
def test_the_speed_is_a_parameter_of_the_structure(tmp_path: Path) -> None:
    """A gradient by the speed contains the change of the stiffness, W^2 K_w."""
    case = beam_case(tmp_path, speed="6000 rpm")
    (speed,) = [each for each in case_parameters(case, build_model(case)) if each.name == "rotation.speed"]
    changed = speed.change(6060.0)
    assert changed.structure is not None
    rotor = ss.rotating(at_rest(case), (0, 0, 1), (-0.1, 0.005, 0.004))
    expected = rotor.structure.stiffness + (6060.0 * RPM) ** 2 * rotor.speed_stiffness
    difference = abs(changed.structure.stiffness - expected).max()
    assert difference < 1e-12 * abs(expected).max()


@pytest.mark.slow
def test_the_stress_at_rest_is_that_of_the_centrifugal_load(tmp_path: Path) -> None:
    """In the middle of the beam: density W^2 integral of r dr beyond, the mean over the section; bending cancels."""
    case = beam_case(tmp_path, speed="6000 rpm").replace(
        {"solver.frequency_start": "150 Hz", "solver.harmonics": 1, "analysis.stiffness_band": False}
    )
    stress = solve_case(case).stress
    assert stress is not None
    assert stress.static == "prescribed"
    middle = np.abs(stress.mesh.points[stress.nodal.node][:, 0] - 0.15) < 1e-9
    mean = stress.nodal.stress[middle, 0, 0].mean()
    assert mean == pytest.approx(7850.0 * (6000.0 * RPM) ** 2 * (0.4**2 - 0.25**2) / 2.0, rel=0.02)


@pytest.mark.slow
def test_a_free_damper_at_rest_is_nearly_that_of_a_stuck_contact() -> None:
    """Against the static state with stuck contact: the damper stresses the blades, and has its own softening."""
    case = coarse_blades("9000 rpm")
    setup, speed = set_up(case), 9000.0 * RPM
    assert isinstance(setup, TwoBladeSetup)
    joint, mesh = load_joint(case, setup.layout), setup.mesh
    structure = ss.assemble(mesh, setup.material, setup.element)
    operator = structure.of_unknowns(joint.face_pairs.mesh_operator(mesh.n_nodes))
    stuck = (structure.stiffness + operator.T @ scipy.sparse.diags(joint.resting_springs) @ operator).tocsr()
    axis, point = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -0.3])
    load = structure.gather(centrifugal_load(mesh, [setup.material] * 3, axis, point))
    stress = stress_stiffness_matrix(structure, structure.expand(factorize(stuck).solve(load)))
    effect = stress - softening_matrix(nodal_mass(mesh, [setup.material] * 3), axis)
    rows = structure.of_unknowns(effect)
    whole = (stuck + speed**2 * structure.of_unknowns(rows.T.tocsr()).T).tocsr()
    expected = natural_frequencies(whole, structure.mass, 4)[0]
    study = study_structure.study_structure(setup.assemble())
    found = study.stuck_frequencies(joint.face_pairs, joint.resting_springs, None, 4)
    rest = natural_frequencies(stuck, structure.mass, 4)[0]
    assert expected[0] > 1.1 * rest[0]
    assert np.abs(found / expected - 1.0).max() < 1e-3  # of the mesh of the example 3.4e-4


def test_a_reduction_for_all_speeds_has_no_gradients(tmp_path: Path) -> None:
    case = beam_case(tmp_path, speed="3000 rpm", top_speed="6000 rpm")
    with rejects(InputError, "rotation.top_speed"):
        case_parameters(case, build_model(case))
    with rejects(StudyFileError, "rotation.top_speed"):
        case.replace({"analysis.gradients": True})


@pytest.mark.long
def test_the_gradient_of_a_peak_by_the_speed_is_that_of_two_more_runs(tmp_path: Path) -> None:
    changes = {
        "solver.frequency_start": "360 Hz", "solver.frequency_stop": "400 Hz", "solver.harmonics": 3,
        "analysis.stiffness_band": False, "forces.shaker.amplitude": "0.001 N",
    }  # fmt: skip
    case = beam_case(tmp_path, speed="6000 rpm").replace(changes)
    gradients = solve_case(case.replace({"analysis.gradients": True})).response.gradients
    assert gradients is not None
    place = gradients.names.index("rotation.speed")
    peaks = []
    for speed in ("5940 rpm", "6060 rpm"):
        solution = solve_case(case.replace({"rotation.speed": speed}))
        peaks.append(summary(solution.response, solution.model.outputs["tip"]).peak)
    for of_peak, expected in (
        (gradients.by_frequency_hz, peaks[1].frequency_hz - peaks[0].frequency_hz),
        (gradients.by_amplitude, peaks[1].amplitude - peaks[0].amplitude),
    ):
        assert 120.0 * of_peak[place] == pytest.approx(expected, rel=2e-3)
