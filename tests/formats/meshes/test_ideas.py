"""I-DEAS universal files: what is rejected, and older data sets. The round trip is in test_round_trip.py."""

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.mesh import Mesh
from stickslip.structure.model_facts import body_volumes
from universal_writer import write_unv

MODELS = Path(__file__).parents[2] / "data" / "models"
FILE = (MODELS / "cubes.unv").read_text(encoding="utf-8")


def changed(tmp_path: Path, old: str, new: str) -> ImportedModel:
    assert old in FILE, "the file of the test has changed"
    (tmp_path / "changed.unv").write_text(FILE.replace(old, new, 1), encoding="utf-8")
    return read_model(tmp_path / "changed.unv", "mm")


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_all_solids(tmp_path: Path, kind: str) -> None:
    """The reference cell of each kind, so that exchanged nodes change its volume or invert it."""
    nodes = 0.01 * CELL_KINDS[kind].nodes
    mesh = Mesh(nodes, np.arange(len(nodes))[None], np.zeros(1, dtype=int), {"corner": np.array([0])})
    write_unv(tmp_path / "cell.unv", mesh, ["cell"], [])
    actual = read_model(tmp_path / "cell.unv", "mm").mesh
    np.testing.assert_array_equal(actual.cell_arrays()[0][1][0], np.arange(len(nodes)))
    np.testing.assert_allclose(body_volumes(actual), body_volumes(mesh), rtol=1e-12)


def test_bodies_without_groups_are_materials(tmp_path: Path) -> None:
    """The second cube belongs to no group."""
    first, _, rest = FILE.partition("upper\n")
    assert rest.startswith("         8         2")
    (tmp_path / "other.unv").write_text(f"{first}other\n         7        15{rest[20:]}", encoding="utf-8")
    mesh = read_model(tmp_path / "other.unv", "mm").mesh
    assert mesh.body_names == ("material 1",)
    np.testing.assert_array_equal(mesh.element_sets["lower"], [0])
    np.testing.assert_array_equal(mesh.node_set("other"), [14])


def test_older_data_sets(tmp_path: Path) -> None:
    """Nodes of 15, elements of 780, groups of 2432 with four members in a line."""
    nodes, elements, groups = [], [], []
    lines = FILE.splitlines()
    at = lines.index("  2411") + 1
    while lines[at] != "    -1":
        places = "".join(f"{float(word.replace('D', 'E')):13.5E}" for word in lines[at + 1].split())
        nodes.append(lines[at] + places)
        at += 2
    for label in (1, 2):
        corners = "".join(f"{n:10d}" for n in range(8 * label - 7, 8 * label + 1))
        elements += [f"{label:10d}{115:10d}" + "         1" * 4 + f"{7:10d}{8:10d}", corners]
    members = "".join(f"{7:10d}{n:10d}" for n in (1, 2, 3, 4))
    groups = [f"{1:10d}" + "         0" * 6 + f"{5:10d}", "the base", members, f"{7:10d}{9:10d}"]
    text = [
        "    -1",
        "    15",
        *nodes,
        "    -1",
        "    -1",
        "   780",
        *elements,
        "    -1",
        "    -1",
        "  2432",
        *groups,
        "    -1",
    ]
    (tmp_path / "old.unv").write_text("\n".join(text), encoding="utf-8")
    mesh = read_model(tmp_path / "old.unv", "mm").mesh
    np.testing.assert_allclose(1e9 * body_volumes(mesh), [2000.0], rtol=1e-5)
    np.testing.assert_array_equal(mesh.node_set("the base"), [0, 1, 2, 3, 8])


def test_the_global_system_is_allowed(tmp_path: Path) -> None:
    identity = "1. 0. 0.\n0. 1. 0.\n0. 0. 1.\n0. 0. 0.\n"
    system = f"    -1\n  2420\n         1\nPart\n         1         0         8\nglobal\n{identity}    -1\n"
    model = changed(tmp_path, "    -1\n  2411", f"{system}    -1\n  2411")
    assert model.mesh.n_cells == 2


ROTATED = "    -1\n  2420\n 1\nPart\n 1 0 8\nlocal\n0. 1. 0.\n-1. 0. 0.\n0. 0. 1.\n0. 0. 0.\n    -1\n    -1\n  2411"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("    -1\n  2411", ROTATED),
        ("    -1\n  2412", "  2412"),
        ("       115         1", "       117         1"),
        ("       115         1", "       116         1"),
        ("         7         8\n", "         7         9\n"),
        ("  2411\n         1", "  2411\n         x"),
        ("1.0000000000000000D+01", "1.0000000000000000D+9999"),
        ("         8         1         0         0", "         8"),
        ("         8\n", "        88\n"),
    ],
)
def test_what_is_rejected(tmp_path: Path, old: str, new: str) -> None:
    with rejects(ImportFileError):
        changed(tmp_path, old, new)
