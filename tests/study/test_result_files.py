"""Results for other programs: contact pairs for ParaView, the result file of CalculiX, arrays of results.nc."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from frd_reader import read_frd
from own_cases import BELOW_THE_PEAK, MATRIX_STUDY, mesh_case
from sentences import rejects
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.cli.main import app
from stickslip.core.errors import InputError, StudyFileError
from stickslip.results.pair_measures import pair_measures
from stickslip.results.record import StudyRecord
from stickslip.results.storage import load_results, save_results
from stickslip.study.contact_file import write_contact
from stickslip.study.export import export_contact
from stickslip.study.frd_file import write_peak_frd
from stickslip.study.run import run
from stickslip.study.solution import Solution, solve_case
from synthetic import synthetic_response, synthetic_study

STATE, SLIP = "state (0 stuck, 1 stick-slip, 2 separating)", "slip distance per cycle, m"
TIP = "A, tip of the left blade, flap"


def placed_study() -> StudyRecord:
    study = synthetic_study()
    across = np.column_stack([study.pair_face, study.pair_position])
    return replace(study, pair_point=across + 0.25)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_results(tmp_path / "results.nc", synthetic_response(), placed_study())
    return tmp_path


@pytest.mark.slow
def test_the_pairs_at_the_peak_are_points_with_their_numbers(folder: Path) -> None:
    response, study = synthetic_response(), placed_study()
    path = export_contact(folder)
    assert path == folder / "contact_at_peak.vtu"
    actual = meshio.read(path)
    np.testing.assert_array_equal(actual.points, study.pair_point)
    top = int(response.amplitude(study.outputs[TIP]).argmax())
    data, measures = actual.point_data, pair_measures(response, top)
    np.testing.assert_array_equal(data[STATE], response.contact_state[top])
    assert set(data[STATE]) > {0}
    np.testing.assert_array_equal(data["dissipated energy per cycle, J"], response.dissipated_energy[top])
    np.testing.assert_allclose(data[SLIP], measures.slip_distance)
    np.testing.assert_allclose(data["mean normal pressure, Pa"] * study.pair_area, measures.mean_normal_force)
    np.testing.assert_array_equal(data["normal load at rest, N"], response.pairs.normal_load)
    np.testing.assert_array_equal(data["frequency, Hz"], response.frequency_hz[top])
    np.testing.assert_array_equal(data["face"], study.pair_face)
    shares = sum(data[f"{name}, fraction of the period"] for name in ("stick", "slip", "separated"))
    np.testing.assert_allclose(shares, 1.0)


@pytest.mark.slow
def test_the_command_writes_another_frequency(folder: Path) -> None:
    response = synthetic_response()
    wanted = float(response.frequency_hz[3]) + 1e-4
    arguments = ["export", str(folder), "--to", "vtu", "--frequency", f"{wanted:.6f} Hz"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    (path,) = folder.glob("contact_*Hz.vtu")
    np.testing.assert_array_equal(meshio.read(path).point_data["frequency, Hz"], response.frequency_hz[3])
    assert CliRunner().invoke(app, arguments).exit_code == 2  # exists
    assert CliRunner().invoke(app, [*arguments, "--force"]).exit_code == 0
    for wrong in (["--to", "vtu", "--frequency", "3"], ["--to", "vtu", "--frequency", "3 mm"], ["--to", "stl"]):
        assert CliRunner().invoke(app, ["export", str(folder), *wrong]).exit_code == 2
    assert CliRunner().invoke(app, ["export", str(folder), "--frequency", "450 Hz"]).exit_code == 2


@pytest.mark.slow
def test_pairs_without_positions_and_wrong_frequencies_are_rejected(folder: Path) -> None:
    response = synthetic_response()
    with rejects(InputError):
        write_contact(folder / "a.vtu", response, synthetic_study())
    with rejects(InputError, "frequency_hz"):
        export_contact(folder, 1e4)
    with rejects(InputError):
        export_contact(folder / "none")
    with rejects(InputError):
        export_contact(folder, path=folder / "a.vtk")
    with rejects(InputError, "pair_point"):
        replace(synthetic_study(), pair_point=np.zeros((3, 3)))


@pytest.mark.slow
def test_the_file_contains_amplitude_and_positions(folder: Path) -> None:
    response, study = synthetic_response(), placed_study()
    with xarray.open_dataset(folder / "results.nc", engine="h5netcdf") as root:
        np.testing.assert_array_equal(root["amplitude"], response.amplitude(study.outputs[TIP]))
        assert root["amplitude"].dims == ("point",)
        assert TIP in root["amplitude"].attrs["long_name"]
        assert root["amplitude"].attrs["units"] == "m"
    again = load_results(folder / "results.nc")
    assert again.response == response
    assert again.study == study


@pytest.fixture(scope="module")
def solution(tmp_path_factory: pytest.TempPathFactory) -> tuple[Solution, Path]:
    """The block on the beam below its peak, solved, and its files."""
    case = mesh_case().replace(BELOW_THE_PEAK | {"output.frd": True, "analysis.stiffness_band": False})
    folder = tmp_path_factory.mktemp("files")
    solved = solve_case(case)
    assert solved.stress is not None
    write_peak_frd(folder / "peak.frd", solved.stress)
    return solved, folder


@pytest.mark.slow
def test_the_result_file_has_the_motion_and_stress_of_the_peak(solution: tuple[Solution, Path]) -> None:
    solved, folder = solution
    stress, content = solved.stress, read_frd(folder / "peak.frd")
    assert stress is not None
    assert solved.motion is not None
    assert [each.name for each in content.blocks] == ["DISP", "STRESS", "DISP", "STRESS", "DISPI", "STRESSI"]
    assert content.blocks[2].value == pytest.approx(stress.frequency_hz, rel=1e-8)
    n_nodes = stress.mesh.n_nodes
    assert len(content.nodes) == n_nodes  # no node belongs to two bodies
    np.testing.assert_allclose(list(content.nodes.values()), stress.mesh.points, atol=1e-7)
    real, imaginary = content.blocks[2].values, content.blocks[4].values
    motion = solved.motion.displacement.reshape(n_nodes, 3, -1)
    # the motion for pictures has no static part of omitted modes, which is small but at the loads
    size = np.abs(motion[:, :, 1:]).max()
    np.testing.assert_allclose(real, motion[:, :, 1], atol=1e-3 * size)
    np.testing.assert_allclose(imaginary, -motion[:, :, 2], atol=1e-3 * size)
    for block, column in ((content.blocks[1], 0), (content.blocks[3], 1)):
        expected = np.empty((n_nodes, 6))
        expected[stress.nodal.node] = stress.nodal.stress[:, :, column]
        np.testing.assert_allclose(block.values, expected, rtol=5.1e-6)


@pytest.mark.slow
def test_a_node_of_two_bodies_is_in_the_file_once_for_each(solution: tuple[Solution, Path], tmp_path: Path) -> None:
    """Bodies of the beam alone: its halves share nodes, where the stress of each half differs."""
    solved, _ = solution
    assert solved.stress is not None
    mesh = solved.stress.mesh
    left = np.concatenate([mesh.points[cells].mean(axis=1)[:, 0] < 0.03 for _, cells in mesh.cell_arrays()])
    body = np.where(mesh.body == 1, 2, np.where(left, 0, 1))
    halves = replace(mesh, body=body, body_names=("left", "right", "damper"))
    pairs = [(node, number) for number in range(3) for node in halves.nodes_of_body(number)]
    node, owner = np.array(pairs).T
    marked = np.repeat(owner[:, None, None] * 1.0, 6, axis=1) * np.ones((1, 1, 3))
    nodal = replace(solved.stress.nodal, node=node, body=owner, stress=marked)
    labels = 7 + 2 * np.random.default_rng(1).permutation(mesh.n_nodes)
    cells = 500 - np.arange(mesh.n_cells)
    path = write_peak_frd(tmp_path / "a.frd", replace(solved.stress, mesh=halves, nodal=nodal), (labels, cells))
    content = read_frd(path)
    shared = np.intersect1d(halves.nodes_of_body(0), halves.nodes_of_body(1)).size
    assert shared > 0
    assert len(content.nodes) == mesh.n_nodes + shared
    value = dict(zip(content.blocks[1].nodes, content.blocks[1].values[:, 0], strict=True))
    for _, material, nodes in content.elements.values():
        assert {value[each] for each in nodes} == {material - 1.0}
    np.testing.assert_allclose([content.nodes[label] for label in labels.tolist()], mesh.points, atol=1e-7)
    assert set(content.nodes) - set(labels.tolist()) == set(range(labels.max() + 1, labels.max() + 1 + shared))
    assert list(content.elements) == cells.tolist()


@pytest.mark.slow
def test_a_run_writes_both_files(tmp_path: Path) -> None:
    case = mesh_case().replace(
        BELOW_THE_PEAK | {"output.frd": True, "analysis.stiffness_band": False, "output.deflected_shape_frames": 0}
    )
    files = {each.name for each in run(case, tmp_path).files}
    assert {"contact_at_peak.vtu", "peak.frd"} <= files
    pairs = meshio.read(tmp_path / "contact_at_peak.vtu")
    assert pairs.points[:, 2].max() == pytest.approx(0.014)  # the lid of the block
    assert len(pairs.points) == 48


def test_a_result_file_without_stress_is_rejected() -> None:
    with rejects(StudyFileError, "output.frd"):
        mesh_case().replace({"output.frd": True, "output.stress": False})
    with rejects(StudyFileError, "output.frd"):
        Case.from_text(MATRIX_STUDY + "frd = true\n")
    with rejects(StudyFileError, "output.frd"):
        load_case(Path(__file__).parents[2] / "examples" / "bladed_disk.toml").replace({"output.frd": True})


PAGE = (Path(__file__).parents[2] / "docs" / "results_files.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_python_lines_of_the_page(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (script,) = re.findall(r"<!-- tested -->\n```python\n(.*?)```", PAGE, flags=re.DOTALL)
    monkeypatch.chdir(folder)
    exec(compile(script, "results_files.md", "exec"), {})
    response, study = synthetic_response(), placed_study()
    amplitude = response.amplitude(study.outputs[TIP])
    top = int(amplitude.argmax())
    separate = int((response.contact_state[top] == 2).sum())
    assert capsys.readouterr().out.splitlines() == [
        f"{1e6 * amplitude[top]:.4g} um at {response.frequency_hz[top]:.2f} Hz",
        f"{separate} of 110 pairs separate",
    ]
    assert separate > 0


@pytest.mark.slow
def test_the_page_names_the_variables_and_fields_of_the_files(folder: Path) -> None:
    plain = re.sub(r"```.*?```", "", PAGE, flags=re.DOTALL)
    named = set(re.findall(r"`([^`]+)`", plain))
    with xarray.open_dataset(folder / "results.nc", engine="h5netcdf") as root:
        numbers = {name for name, each in root.variables.items() if each.dtype.kind in "fi" and each.dims}
        assert numbers - {"harmonic"} <= named
        layout = PAGE.split("| variable of the root |")[1].split("\n\n")[0]
        listed = {name for line in layout.splitlines()[2:] for name in re.findall(r"`(\w+)`", line.split("|")[1])}
        optional = {"stable", "multipliers_real", "multipliers_imaginary"}  # no stability in this file
        assert listed - optional <= set(root.variables)
    with xarray.open_dataset(folder / "results.nc", group="study", engine="h5netcdf") as study:
        assert {"pair_point", "pair_face", "pair_area", "face_names", "output_rows", "output_names", "inputs"} <= named
        assert {"pair_point", "pair_face", "pair_area", "output_rows"} <= set(study.variables)
    words = {
        part.strip() for name in meshio.read(export_contact(folder)).point_data for part in name.split(", fraction")
    }
    assert {name for name in words if name and name != "of the period"} <= named
