"""Ansys archives: the model of the equivalent deck, the mesh that another reader finds, and rejected commands."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from archive_writer import write_cdb
from helpers import absent_tool
from model_writers import write_inp
from sentences import rejects
from solid_cells import CORNERS
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.ansys_systems import rotated_axes
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.raw_contacts import RawContact
from stickslip.formats.meshes.read import read_model
from stickslip.structure.cell_kinds import CELL_KINDS
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from stickslip.structure.mesh import Mesh

MODELS = Path(__file__).parents[2] / "data" / "models"
Middles = dict[tuple[int, ...], int]  # node of each edge by its ends
ARCHIVE = (MODELS / "cubes.cdb").read_text(encoding="utf-8")
# The brick cut into two wedges, and into six tetrahedra, by its nodes in VTK order.
CUTS = {
    "hexahedron": [list(range(8))],
    "wedge": [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]],
    "tetra": [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
}


def cut_cubes(shape: str, quadratic: bool) -> Mesh:
    """Two stacked cubes, distorted, with nodes of their own, in cells of one shape."""
    cube = 5e-3 * (CORNERS + 1) + 1e-3 * np.random.default_rng(3).random((8, 3))
    points = np.vstack([cube, cube + np.array([0.0, 0.0, 0.012])])
    cells = np.array([[n + 8 * body for n in cell] for body in (0, 1) for cell in CUTS[shape]])
    middles: Middles = {}
    if quadratic:
        points, cells, middles = with_middles(points, cells, shape)
    sets = {"base": [0, 1, 2, 3], "contact": [4, 5, 6, 7], "opposite": [8, 9, 10, 11], "tip": [15]}
    return Mesh(
        points,
        cells,
        np.repeat([0, 1], len(cells) // 2),
        {name: within(nodes, middles) for name, nodes in sets.items()},
    )


def with_middles(points: np.ndarray, cells: np.ndarray, shape: str) -> tuple[np.ndarray, np.ndarray, Middles]:
    places, all_cells = points.tolist(), []
    known: Middles = {}
    for cell in cells:
        middles = []
        for a, b in CELL_KINDS[shape].edges:
            key = (min(cell[a], cell[b]), max(cell[a], cell[b]))
            if key not in known:
                known[key] = len(places)
                places.append(((points[key[0]] + points[key[1]]) / 2).tolist())
            middles.append(known[key])
        all_cells.append([*cell, *middles])
    return np.array(places), np.array(all_cells), known


def within(corners: list[int], middles: Middles) -> np.ndarray:
    """A node set with the middles of edges between its corners."""
    return np.array([*corners, *(node for ends, node in middles.items() if set(ends) <= set(corners))])


@pytest.mark.slow
@pytest.mark.parametrize("quadratic", [False, True], ids=["linear", "quadratic"])
@pytest.mark.parametrize(
    ("shape", "collapse"), [("hexahedron", True), ("wedge", True), ("tetra", True), ("tetra", False)]
)
def test_it_is_the_model_of_the_abaqus_deck(tmp_path: Path, shape: str, collapse: bool, quadratic: bool) -> None:
    """SOLID185 and SOLID186, collapsed too, SOLID285 and SOLID187."""
    mesh = cut_cubes(shape, quadratic)
    write_cdb(tmp_path / "model.cdb", mesh, ["contact", "opposite"], "base", collapse)
    write_inp(tmp_path / "model.inp", mesh, ["lower", "upper"], ["contact", "opposite"], "base")
    archive, deck = (read_model(tmp_path / f"model.{ending}", "mm") for ending in ("cdb", "inp"))
    assert archive.mesh.body_names == ("material 1", "material 2")
    np.testing.assert_allclose(archive.mesh.points, deck.mesh.points, atol=1e-15)
    assert {block.kind for block in archive.mesh.blocks} == {block.kind for block in deck.mesh.blocks}
    np.testing.assert_array_equal(archive.fixed_unknowns, deck.fixed_unknowns)
    for name, other in (("contact 5", "contact"), ("target 5", "opposite"), ("TIP", "tip")):
        np.testing.assert_array_equal(archive.mesh.node_set(name), deck.mesh.node_set(other))
    frequencies_hz = []
    for model in (archive, deck):
        materials = [model.materials[name] for name in model.mesh.body_names]
        structure = assemble_bodies(model.mesh, materials, fixed_unknowns=model.fixed_unknowns)
        frequencies_hz.append(natural_frequencies(structure.stiffness, structure.mass, 12)[0])
    np.testing.assert_allclose(frequencies_hz[0][6:], frequencies_hz[1][6:], rtol=1e-7)


def test_contact_pairs() -> None:
    model = read_model(MODELS / "cubes.cdb", "mm")
    (pair,) = model.contacts
    assert (pair.name, pair.first, pair.second, pair.friction) == ("pair 5", "contact 5", "target 5", 0.2)
    assert not pair.is_bonded
    assert pair.notes == ()
    assert sum(map(len, model.mesh.sides("contact 5"))) == 1
    assert any("friction 0.2" in message for message in model.messages)


@pytest.mark.parametrize(("key", "is_bonded", "n_notes"), [(1, False, 1), (4, False, 1), (5, True, 0)])
def test_behaviour_of_contact(tmp_path: Path, key: int, is_bonded: bool, n_notes: int) -> None:
    (pair,) = changed(tmp_path, "KEYOP,2,12,0", f"KEYOPT,2,12,{key}").contacts
    assert (pair.is_bonded, len(pair.notes)) == (is_bonded, n_notes)


def test_a_rigid_target_is_the_ground(tmp_path: Path) -> None:
    """Target elements on nodes of no solid."""
    lines = ARCHIVE.splitlines()
    end = lines.index("N,R5.3,LOC,       -1,")
    extra = [line.replace(line[:9], f"{int(line[:9]) + 100:9d}", 1) for line in lines[end - 4 : end]]
    target = next(n for n, line in enumerate(lines) if line.startswith(f"{3:10d}{3:10d}"))
    lines[target] = lines[target][:110] + "".join(f"{n:10d}" for n in (113, 114, 115, 116))
    (tmp_path / "rigid.cdb").write_text("\n".join([*lines[:end], *extra, *lines[end:]]), encoding="utf-8")
    (pair,) = read_model(tmp_path / "rigid.cdb", "mm").contacts
    assert isinstance(pair, RawContact)
    assert pair.second == "ground"
    assert len(pair.notes) == 1


def changed(tmp_path: Path, old: str, new: str) -> ImportedModel:
    assert old in ARCHIVE, "the file of the test has changed"
    (tmp_path / "changed.cdb").write_text(ARCHIVE.replace(old, new), encoding="utf-8")
    return read_model(tmp_path / "changed.cdb", "mm")


def test_ranges_of_components(tmp_path: Path) -> None:
    new = "CMBLOCK,RANGE,NODE,       3\n(8i10)\n         1         9       -12\nCMBLOCK,BASE"
    model = changed(tmp_path, "CMBLOCK,BASE", new)
    np.testing.assert_array_equal(model.mesh.node_set("RANGE"), [0, 8, 9, 10, 11])


def test_components_of_elements(tmp_path: Path) -> None:
    """Element 3 is a contact element, element 2 a solid."""
    new = "CMBLOCK,A,ELEM,       1\n(8i10)\n         3\nCMBLOCK,B,ELEM,       1\n(8i10)\n         2\nCMBLOCK,BASE"
    mesh = changed(tmp_path, "CMBLOCK,BASE", new).mesh
    np.testing.assert_array_equal(mesh.sides("A")[0], mesh.sides("contact 5")[0])
    np.testing.assert_array_equal(mesh.element_sets["B"], [1])


def test_axes_of_nodes() -> None:
    """A node turned by 90 degrees about z has its x along the y of the model; then about its own x, its y along z."""
    np.testing.assert_allclose(rotated_axes([90.0, 0.0, 0.0]), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(rotated_axes([90.0, 90.0, 0.0]), [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(rotated_axes([0.0, 0.0, 90.0]), [[0, 0, -1], [0, 1, 0], [1, 0, 0]], atol=1e-15)


def test_constraints_and_forces_in_axes_of_a_node(tmp_path: Path) -> None:
    """Node 16 turned by 90 degrees about z: its UX is the y of the model."""
    line = next(line for line in ARCHIVE.splitlines() if line.startswith(f"{16:9d}{0:9d}"))
    free = "\n".join([ARCHIVE.replace(line, f"{line}{90.0:21.13E}"), "D,16,UX,0.", "F,16,FZ,7.,0.", "F,15,FY,-2."])
    (tmp_path / "turned.cdb").write_text(free, encoding="utf-8")
    model = read_model(tmp_path / "turned.cdb", "mm")
    assert 3 * 15 + 1 in model.fixed_unknowns
    assert 3 * 15 not in model.fixed_unknowns
    np.testing.assert_allclose(model.node_forces[[15, 14]], [[0, 0, 7], [0, -2, 0]], atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["HexBeam.cdb", "TetBeam.cdb", "sector.cdb"])
def test_mesh_of_the_reader_of_ansys(name: str) -> None:
    """Nodes, elements and components that ansys-mapdl-reader finds in its examples, which MAPDL wrote."""
    if find_spec("ansys") is None or find_spec("ansys.mapdl.reader") is None:
        absent_tool("ansys-mapdl-reader", 'pip install "stickslip[ansys]".')
    from ansys.mapdl import reader

    path = Path(reader.__file__).parent / "examples" / name
    other = reader.Archive(str(path), parse_vtk=False)
    model = read_model(path, "m")
    place = {int(label): xyz for label, xyz in zip(other.nnum, other.nodes[:, :3], strict=True)}
    np.testing.assert_allclose(model.mesh.points, [place[label] for label in model.node_labels.tolist()], atol=1e-12)
    np.testing.assert_array_equal(np.sort(model.element_labels), np.sort(other.enum))
    nodes_of = {label: set(row[10:].tolist()) - {0} for label, row in zip(other.enum, other.elem, strict=True)}
    labels = model.node_labels
    cells = [set(labels[cell].tolist()) for block in model.mesh.blocks for cell in block.cells]
    assert [nodes_of[label] for label in model.element_labels] == cells
    for each, members in other.node_components.items():
        np.testing.assert_array_equal(np.sort(labels[model.mesh.node_set(each)]), np.intersect1d(members, labels))
    for each, members in other.element_components.items():
        np.testing.assert_array_equal(np.sort(model.element_labels[model.mesh.element_sets[each]]), np.sort(members))


BAD = [
    ("ET,1,185", "ET,9,185"),
    ("ET,1,185", "ET,1,185\nKEYOPT,1,3,1"),
    ("ET,1,185", "ET,1,tid"),
    ("(3i9,6e21.13e3)", "(3x9)"),
    ("(19i10)", "(19i10000)"),
    ("EBLOCK,19,SOLID", "EBLOCK,10,"),
    ("NBLOCK,6,SOLID", "NBLOCK,3,"),
    ("MPDATA,R5.0, 1,EX  ,       1, 1,", "MPDATA,R5.0, 1,EY  ,       1, 1, 1.,\nMPDATA,R5.0, 1,EX  ,       1, 1,"),
    ("MPDATA,R5.0, 1,MU  ,       3, 1, 0.2    ,", "MP,EX,1,2.1e5,3.5"),
    ("MPDATA,R5.0, 1,MU  ,       3, 1, 0.2    ,", "MPDATA,R5.0, 1,MU  ,       3, 1, mu_value    ,"),
    ("ACEL,", "CE,R5.0,DEFI,       1,       2,  0.00000000\nACEL,"),
    ("CMBLOCK,BASE", "CMBLOCK,BAD,NODE,       2\n(8i10)\n         9        -3\nCMBLOCK,BASE"),
    ("CMBLOCK,TIP     ,NODE,       1", "CMBLOCK,TIP     ,NODE,     999"),
    (f"{8:10d}{0:10d}{1:10d}", f"{7:10d}{0:10d}{1:10d}"),
    (f"{8:10d}{0:10d}{1:10d}", f"{12:10d}{0:10d}{1:10d}"),
    (f"{5:10d}{6:10d}{7:10d}{8:10d}\n", f"{5:10d}{5:10d}{5:10d}{5:10d}\n"),
]


@pytest.mark.parametrize(("old", "new"), BAD)
def test_what_is_rejected(tmp_path: Path, old: str, new: str) -> None:
    with rejects(ImportFileError):
        changed(tmp_path, old, new)
