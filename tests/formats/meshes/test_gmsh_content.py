"""What Gmsh itself writes beyond the common case is read, or refused with the option that helps."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model_writers import write_meshio
from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.read import read_model
from stickslip.structure.mesh import Mesh

MODELS = Path(__file__).parents[2] / "data" / "models"
PLAIN = MODELS / "gmsh_4.1_text.msh"


def changed(folder: Path, old: bytes, new: bytes, name: str = "gmsh_4.1_text.msh") -> Path:
    content = (MODELS / name).read_bytes()
    assert content.count(old) >= 1
    path = folder / "changed.msh"
    path.write_bytes(content.replace(old, new, 1))
    return path


def require_same_model(path: Path, reference: Path = PLAIN) -> None:
    plain, model = (read_model(each, "mm") for each in (reference, path))
    assert model.mesh.body_names == plain.mesh.body_names
    assert {k: sum(map(len, v)) for k, v in model.mesh.face_sets.items()} == {
        k: sum(map(len, v)) for k, v in plain.mesh.face_sets.items()
    }
    assert set(model.mesh.node_sets) == set(plain.mesh.node_sets)
    np.testing.assert_allclose(model.mesh.points, plain.mesh.points, atol=1e-15)
    for block, other in zip(model.mesh.blocks, plain.mesh.blocks, strict=True):
        np.testing.assert_array_equal(block.cells, other.cells)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gmsh_4.1_all_text.msh", "gmsh_4.1_all_binary.msh"])
def test_entities_without_a_group(name: str) -> None:
    require_same_model(MODELS / name)


@pytest.mark.parametrize("quadratic", [False, True])
def test_version_1(tmp_path: Path, make_block: Callable[..., Mesh], quadratic: bool) -> None:
    """The same bricks as in version 2.2; version 1 has numbers of groups in place of names."""
    mesh = make_block((3, 2, 1), (0.06, 0.03, 0.01), 0.1)
    mesh = replace(mesh, node_sets={"base": np.arange(24).reshape(4, 3, 2)[:, :, 0].ravel()})
    mesh = mesh.quadratic() if quadratic else mesh
    for form, file in (("gmsh22", "new.msh"), ("gmsh1", "old.msh")):
        write_meshio(tmp_path / file, mesh, ["block"], ["base"], form)
    new, old = (read_model(tmp_path / file, "mm").mesh for file in ("new.msh", "old.msh"))
    assert (new.body_names, old.body_names) == (("block",), ("group 1",))
    np.testing.assert_allclose(old.points, new.points, atol=1e-12)
    np.testing.assert_array_equal(old.cells, new.cells)
    np.testing.assert_array_equal(old.sides("group 2")[0], new.sides("base")[0])


@pytest.mark.parametrize(
    ("old", "new"), [("$ENDNOD", "$ENDNODES"), ("$ENDELM", ""), (" 8 1 ", " 9 1 "), (" 8 1 ", " eight 1 ")]
)
def test_damaged_version_1(tmp_path: Path, make_block: Callable[..., Mesh], old: str, new: str) -> None:
    mesh = make_block((1, 1, 1), (0.06, 0.03, 0.01), 0.0)
    write_meshio(tmp_path / "old.msh", mesh, ["block"], [], "gmsh1")
    text = (tmp_path / "old.msh").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "damaged.msh").write_text(text.replace(old, new), encoding="utf-8")
    with rejects(ImportFileError):
        read_model(tmp_path / "damaged.msh", "mm")


def test_version_4_0(tmp_path: Path) -> None:
    plain, model = (read_model(each, "mm").mesh for each in (PLAIN, MODELS / "gmsh_4.0_text.msh"))
    assert model.body_names == plain.body_names
    np.testing.assert_allclose(model.points, plain.points, atol=1e-15)
    for side, other in zip(model.sides("left face"), plain.sides("left face"), strict=True):
        np.testing.assert_array_equal(side, other)
    with rejects(ImportFileError):
        read_model(changed(tmp_path, b" 1 3 4 -1 ", b" 2 3 4 4 -1 ", "gmsh_4.0_text.msh"), "mm")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gmsh_4.1_text.msh", "gmsh_4.1_binary.msh", "gmsh_2.2_text.msh"])
def test_comments_before_the_header(tmp_path: Path, name: str) -> None:
    comments = b"$Comments\nmade by hand\n$EndComments\n" * 2
    require_same_model(changed(tmp_path, b"$MeshFormat", comments + b"$MeshFormat", name), MODELS / name)


def test_solids_without_a_group_are_reported(tmp_path: Path) -> None:
    """Gmsh saves them with Mesh.SaveAll; they have no body, so no material."""
    path = changed(tmp_path, b" 1 2 6 ", b" 0 6 ", "gmsh_4.1_all_text.msh")
    with rejects(ImportFileError):
        read_model(path, "mm")


def test_parametric_nodes_and_huge_numbers(tmp_path: Path) -> None:
    head = b"$Nodes\n"
    content = PLAIN.read_bytes()
    first = content[content.index(head) + len(head) :].split(b"\n")[:3]  # sizes, first block, first node number
    dimension, tag, _, count = first[1].split()
    parametric = b" ".join([dimension, tag, b"1", count])
    with rejects(ImportFileError):
        read_model(changed(tmp_path, head + first[0] + b"\n" + first[1], head + first[0] + b"\n" + parametric), "mm")
    whole = head + b"\n".join(first)
    with rejects(ImportFileError):
        read_model(changed(tmp_path, whole + b"\n", head + b"\n".join([*first[:2], b"20000000"]) + b"\n"), "mm")
    with rejects(ImportFileError):
        read_model(changed(tmp_path, head, b"$ParametricNodes\n", "gmsh_2.2_text.msh"), "mm")


def test_damaged_entities_are_named(tmp_path: Path) -> None:
    content = PLAIN.read_bytes()
    start = content.index(b"$Entities\n") + len(b"$Entities\n")
    counts = content[start:].split(b"\n", 1)[0]
    with rejects(ImportFileError):
        read_model(changed(tmp_path, b"$Entities\n" + counts, b"$Entities\n9999 1 1 1"), "mm")
