"""Result files of CalculiX: read back by columns, and compared with the lines that CalculiX itself writes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from calculix import ELEMENTS, cut_bricks
from calculix_loads import calculix_static
from frd_reader import read_frd
from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.formats.frd import FrdStep, write_frd
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh

MakeBlock = Callable[..., Mesh]
LENGTHS = (0.04, 0.03, 0.02)


def block(make_block: MakeBlock, kind: str) -> Mesh:
    bricks = make_block((2, 1, 1), LENGTHS)
    sets = {"fixed": bricks.points[:, 2] < 1e-9, "top": bricks.points[:, 2] > LENGTHS[2] - 1e-9}
    named = {name: np.flatnonzero(member) for name, member in sets.items()}
    mesh = Mesh(bricks.points, bricks.cells, node_sets=named)
    if kind == "hexahedron":
        return mesh
    return mesh.quadratic() if kind == "hexahedron20" else cut_bricks(mesh, kind)


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_a_file_is_read_back_by_its_columns(tmp_path: Path, make_block: MakeBlock, kind: str) -> None:
    mesh = block(make_block, kind)
    random = np.random.default_rng(4)
    fields = {"DISP": 1e-5 * random.standard_normal((mesh.n_nodes, 3)), "STRESS": random.normal(size=(mesh.n_nodes, 6))}
    both = fields | {"DISPI": -2.0 * fields["DISP"], "STRESSI": 1e8 * fields["STRESS"]}
    path = write_frd(tmp_path / "a.frd", mesh, [FrdStep(None, fields), FrdStep(451.8765, both)])
    content = read_frd(path)
    np.testing.assert_allclose(list(content.nodes.values()), mesh.points, rtol=1e-5)
    assert list(content.nodes) == list(range(1, mesh.n_nodes + 1))
    assert len(content.elements) == mesh.n_cells
    assert [each.name for each in content.blocks] == ["DISP", "STRESS", "DISP", "STRESS", "DISPI", "STRESSI"]
    assert [each.value for each in content.blocks] == [1.0] * 2 + [451.8765] * 4
    assert [each.step for each in content.blocks] == [1] * 2 + [2] * 4
    for each, (name, values) in zip(content.blocks[2:], both.items(), strict=True):
        assert each.name == name
        assert each.nodes == list(content.nodes)
        np.testing.assert_allclose(each.values, values, rtol=5.1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("element", ELEMENTS)
def test_the_lines_are_those_of_calculix(tmp_path: Path, make_block: MakeBlock, element: str) -> None:
    """The same mesh and the values that CalculiX printed: every line from the nodes on is equal."""
    mesh = block(make_block, ELEMENTS[element][0])
    _, _, source = calculix_static(tmp_path, mesh, element, [Material()], "top", 3e6, (0.0, 0.0, -9.81))
    theirs = read_frd(source)
    fields = {each.name: each.values for each in theirs.blocks if each.name in ("DISP", "STRESS")}
    assert set(fields) == {"DISP", "STRESS"}
    ours = write_frd(tmp_path / "ours.frd", mesh, [FrdStep(None, fields)]).read_text(encoding="ascii")
    own, other = (_lines(text) for text in (ours, source.read_text(encoding="ascii")))
    assert own == other[: len(own)]
    rest = [line for line in other[len(own) :] if line.startswith(" -4")]
    assert len(own) > 2 * mesh.n_nodes
    assert all("ERROR" in line for line in rest)  # an estimate of CalculiX, which follows


def _lines(text: str) -> list[str]:
    """The lines from the nodes to the last block, without blanks at their ends; values of steps as numbers."""
    lines = [line.rstrip() for line in text[text.index("    2C") :].splitlines()]
    lines = [f"{line[:12]}{float(line[12:24]):12.5f}{line[24:]}" if "100CL" in line else line for line in lines]
    return lines[: lines.index(" 9999")]


def test_a_body_is_a_material_and_small_numbers_fit(tmp_path: Path, make_block: MakeBlock) -> None:
    brick = make_block((2, 1, 1), LENGTHS)
    mesh = Mesh(brick.points, brick.cells, np.array([0, 1]), body_names=("blade", "damper"))
    values = np.full((mesh.n_nodes, 3), -1.23456789e-150)
    values[0] = [1.23456789e98, -9.99999999e-98, 0.0]
    path = write_frd(tmp_path / "a.frd", mesh, [FrdStep(None, {"DISP": values})])
    content = read_frd(path)
    assert [material for _, material, _ in content.elements.values()] == [1, 2]
    assert "    1UMAT    2damper" in path.read_text()
    np.testing.assert_allclose(content.blocks[0].values[0], values[0], rtol=5.1e-6)
    assert not content.blocks[0].values[1:].any()


def test_nodes_and_elements_have_the_given_numbers(tmp_path: Path, make_block: MakeBlock) -> None:
    mesh = make_block((2, 1, 1), LENGTHS)
    nodes = 1000 - 3 * np.arange(mesh.n_nodes)
    values = np.arange(3.0 * mesh.n_nodes).reshape(-1, 3)
    content = read_frd(write_frd(tmp_path / "a.frd", mesh, [FrdStep(None, {"DISP": values})], nodes, [70, 5]))
    assert list(content.nodes) == nodes.tolist() == content.blocks[0].nodes
    assert list(content.elements) == [70, 5]
    for number, cell in zip((70, 5), mesh.cells, strict=True):
        assert content.elements[number][2] == tuple(nodes[cell])


def test_bad_input_is_rejected(tmp_path: Path, make_block: MakeBlock) -> None:
    mesh, path = make_block((1, 1, 1), LENGTHS), tmp_path / "a.frd"
    good = np.zeros((8, 3))
    with rejects(InputError):
        write_frd(tmp_path / "a.vtu", mesh, [FrdStep(None, {"DISP": good})])
    with rejects(InputError, "steps"):
        write_frd(path, mesh, [])
    with rejects(InputError, "fields"):
        write_frd(path, mesh, [FrdStep(None, {"U": good})])
    with rejects(InputError, "DISP"):
        write_frd(path, mesh, [FrdStep(None, {"DISP": good[:7]})])
    with rejects(InputError, "DISP"):
        write_frd(path, mesh, [FrdStep(None, {"DISP": good + 1e99})])
    with rejects(InputError, "STRESS"):
        write_frd(path, mesh, [FrdStep(None, {"STRESS": np.full((8, 6), np.nan)})])
    with rejects(InputError, "frequency_hz"):
        write_frd(path, mesh, [FrdStep(float("inf"), {"DISP": good})])
    step = [FrdStep(None, {"DISP": good})]
    for wrong in (np.arange(8), np.full(8, 3), np.arange(1, 8), np.arange(1.0, 9.0), 2**31 + np.arange(8)):
        with rejects(InputError, "node_numbers"):
            write_frd(path, mesh, step, wrong)
    with rejects(InputError, "cell_numbers"):
        write_frd(path, mesh, step, None, [0])
    assert not list(tmp_path.iterdir())
