import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import meshio
import numpy as np
import pytest
from meshio._mesh import topological_dimension

from calculix import cut_bricks
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.structure import export
from stickslip.structure.export import write_deflected_period, write_mode_shapes, write_nodal_fields
from stickslip.structure.mesh import Mesh


@pytest.fixture
def block(make_block: Callable[..., Mesh]) -> Mesh:
    return make_block((2, 1, 1), (2.0, 1.0, 1.0))


@pytest.fixture
def modes(block: Mesh) -> FloatArray:
    return np.random.default_rng(0).standard_normal((3 * block.n_nodes, 2))


@pytest.mark.parametrize("quadratic", [False, True])
def test_mode_shapes_read_back(tmp_path: Path, block: Mesh, quadratic: bool) -> None:
    mesh = block.quadratic() if quadratic else block
    modes = np.random.default_rng(0).standard_normal((3 * mesh.n_nodes, 2))
    path = write_mode_shapes(tmp_path / "modes.vtu", mesh, modes, np.array([507.29, 526.7]))
    actual = meshio.read(path)
    np.testing.assert_array_equal(actual.points, mesh.points)
    np.testing.assert_array_equal(actual.cells[0].data, mesh.cells)
    assert actual.cells[0].type == ("hexahedron20" if quadratic else "hexahedron")
    assert list(actual.point_data) == ["mode 01, 507.3 Hz", "mode 02, 526.7 Hz"]
    shape = actual.point_data["mode 02, 526.7 Hz"]
    assert np.linalg.norm(shape, axis=1).max() == pytest.approx(1.0)
    np.testing.assert_allclose(shape / shape[0, 0], modes[:, 1].reshape(-1, 3) / modes[0, 1])
    assert [item.name for item in tmp_path.iterdir()] == ["modes.vtu"]


def test_deflected_period_reads_back(tmp_path: Path, block: Mesh) -> None:
    coefficients = np.random.default_rng(1).standard_normal((3 * block.n_nodes, 5))
    path = write_deflected_period(tmp_path / "peak.pvd", block, coefficients, n_frames=8)
    entries = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    assert [float(entry.attrib["timestep"]) for entry in entries] == [frame / 8 for frame in range(8)]
    angle = 2 * np.pi * 3 / 8
    weight = [1.0, np.cos(angle), np.sin(angle), np.cos(2 * angle), np.sin(2 * angle)]
    actual = meshio.read(tmp_path / entries[3].attrib["file"])
    np.testing.assert_allclose(actual.point_data["displacement"].ravel(), coefficients @ weight)
    np.testing.assert_array_equal(actual.points, block.points)


def test_a_second_period_replaces_the_first_one(tmp_path: Path, block: Mesh, modes: FloatArray) -> None:
    coefficients = np.hstack([modes, modes[:, :1]])
    for n_frames in (6, 4):
        write_deflected_period(tmp_path / "peak.pvd", block, coefficients, n_frames)
    assert len(list((tmp_path / "peak_frames").iterdir())) == 4
    assert sorted(item.name for item in tmp_path.iterdir()) == ["peak.pvd", "peak_frames"]


def test_a_write_that_fails_leaves_the_old_files(
    tmp_path: Path, block: Mesh, modes: FloatArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    coefficients = np.hstack([modes, modes[:, :1]])
    write_deflected_period(tmp_path / "peak.pvd", block, coefficients, 4)
    before = (tmp_path / "peak.pvd").read_text()
    written: list[Path] = []

    def full_disk(path: Path, mesh: Mesh, fields: object) -> None:
        if written:
            raise OSError(28, "No space left on device")
        written.append(path)
        path.write_text("half")

    monkeypatch.setattr(export, "_write_vtu", full_disk)
    with rejects(InputError):
        write_deflected_period(tmp_path / "peak.pvd", block, coefficients, 6)
    assert (tmp_path / "peak.pvd").read_text() == before
    assert len(list((tmp_path / "peak_frames").iterdir())) == 4
    assert sorted(item.name for item in tmp_path.iterdir()) == ["peak.pvd", "peak_frames"]


def test_what_cannot_be_written_gets_a_sentence(tmp_path: Path, block: Mesh, modes: FloatArray) -> None:
    with rejects(InputError):
        write_mode_shapes(tmp_path / "modes.vtk", block, modes, np.array([1.0, 2.0]))
    with rejects(InputError):
        write_mode_shapes(tmp_path / "nowhere" / "modes.vtu", block, modes, np.array([1.0, 2.0]))
    with rejects(InputError, "modes"):
        write_mode_shapes(tmp_path / "modes.vtu", block, modes[:-3], np.array([1.0, 2.0]))
    with rejects(InputError, "frequency_hz"):
        write_mode_shapes(tmp_path / "modes.vtu", block, modes, np.array([1.0]))
    with rejects(InputError, "modes"):
        write_mode_shapes(tmp_path / "modes.vtu", block, modes * [1.0, 0.0], np.array([1.0, 2.0]))
    with rejects(InputError, "coefficients"):
        write_deflected_period(tmp_path / "peak.pvd", block, modes)
    with rejects(InputError, "n_frames"):
        write_deflected_period(tmp_path / "peak.pvd", block, np.hstack([modes, modes[:, :1]]), 2)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", ["tetra10", "wedge", "wedge15"])
def test_mode_shapes_of_tetrahedra_and_wedges_read_back(tmp_path: Path, block: Mesh, kind: str) -> None:
    mesh = cut_bricks(block, kind)
    modes = np.random.default_rng(0).standard_normal((3 * mesh.n_nodes, 1))
    with patch.dict(topological_dimension):
        topological_dimension.pop("wedge15", None)  # as meshio has it in a new process
        actual = meshio.read(write_mode_shapes(tmp_path / "modes.vtu", mesh, modes, np.array([507.0])))
    assert actual.cells[0].type == kind
    np.testing.assert_array_equal(actual.cells[0].data, mesh.blocks[0].cells)
    shape = actual.point_data["mode 01, 507.0 Hz"]
    np.testing.assert_allclose(shape / shape[0, 0], modes[:, 0].reshape(-1, 3) / modes[0, 0])


def test_fields_of_bodies_jump_at_the_nodes_that_they_share(tmp_path: Path) -> None:
    """Two bricks of two bodies: twelve nodes, four of them shared, so sixteen rows; in any order."""
    corner = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)])
    first = np.array([0, 1, 4, 3, 6, 7, 10, 9])
    mesh = Mesh(corner, np.array([first, first + 1]), body=np.array([0, 1]), body_names=("left", "right"))
    node = np.concatenate([np.sort(first), np.sort(first + 1)])[::-1]
    body = np.repeat([1, 0], 8)
    written = meshio.read(write_nodal_fields(tmp_path / "stress.vtu", mesh, node, body, {"jump": 1.0 * body}))
    assert len(written.points) == 16
    for number, cells in enumerate(written.cells_dict["hexahedron"]):
        assert set(written.point_data["jump"][cells]) == {float(number)}
        np.testing.assert_allclose(written.points[cells], corner[first + number])
    with rejects(InputError, "node"):
        write_nodal_fields(tmp_path / "stress.vtu", mesh, node[1:], body[1:], {"jump": 1.0 * body[1:]})
    with rejects(InputError):
        write_nodal_fields(tmp_path / "stress.vtu", mesh, node, body, {"jump": np.ones(3)})
