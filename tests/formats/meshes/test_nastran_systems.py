"""Coordinate systems of Nastran: places by hand, systems in each other, GRDSET, a sector in r, theta and z."""

from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from model_writers import write_bdf
from sentences import rejects
from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.nastran_frames import BASIC, Frame
from stickslip.formats.meshes.read import read_model, read_raw
from stickslip.structure.elasticity import assemble_bodies, natural_frequencies
from stickslip.structure.mesh import Mesh
from stickslip.structure.model_facts import body_volumes

ROOT_3 = 3.0**0.5
# Axis 3 is z through (1, 2, 3); axis 1 is y, so axis 2 is -x.
CYLINDER = "CORD2C,5,,1.,2.,3.,1.,2.,4.,+\n+,1.,3.,3.\n"
SPHERE = "CORD2S,5,,1.,2.,3.,1.,2.,4.,+\n+,1.,3.,3.\n"
# By places in the cylinder: (-1, 2, 8), one above it, and (-2, 2, 8): axes 1, 2, 3 are -x, -y, z.
NESTED = "CORD2R,6,5,2.,90.,5.,2.,90.,6.,+\n+,3.,90.,5.\n"
# Grids at (-1, 2, 8), (-1, 5, 8), (-1, 2, 10): axes 1, 2, 3 are z, x, y.
BY_GRIDS = "CORD1{},7,20,21,22\nGRID,20,5,2.,90.,5.\nGRID,21,,-1.,5.,8.\nGRID,22,0,-1.,2.,10.\n" + CYLINDER


def places(tmp_path: Path, text: str) -> dict[int, FloatArray]:
    """Basic coordinates by label of a deck of grids."""
    path = tmp_path / "deck.bdf"
    path.write_text(text, encoding="utf-8")
    raw = read_raw(path)
    return {int(label): place for label, place in zip(raw.node_labels, raw.coordinates, strict=True)}


@pytest.mark.parametrize(
    ("systems", "given", "wanted"),
    [
        (CYLINDER, "5,2.,90.,5.", (-1.0, 2.0, 8.0)),
        (CYLINDER, "5,2.,30.,5.", (0.0, 2.0 + ROOT_3, 8.0)),
        (CYLINDER, "5,2.,-180.,0.", (1.0, 0.0, 3.0)),
        (SPHERE, "5,2.,90.,0.", (1.0, 4.0, 3.0)),
        (SPHERE, "5,2.,30.,90.", (0.0, 2.0, 3.0 + ROOT_3)),
        (SPHERE, "5,2.,0.,77.", (1.0, 2.0, 5.0)),
        (CYLINDER + NESTED, "6,1.,2.,3.", (-2.0, 0.0, 11.0)),
        (NESTED + CYLINDER, "6,1.,2.,3.", (-2.0, 0.0, 11.0)),
        (BY_GRIDS.format("R"), "7,1.,2.,3.", (1.0, 5.0, 9.0)),
        (BY_GRIDS.format("C"), "7,2.,90.,1.", (1.0, 3.0, 8.0)),
        (BY_GRIDS.format("S"), "7,2.,90.,90.", (1.0, 2.0, 8.0)),
        (BY_GRIDS.format("S"), "7,2.,0.,0.", (-1.0, 4.0, 8.0)),
        # two systems in one card, the second with axes x, y, z at (-1, 2, 8)
        (BY_GRIDS.replace("22\n", "22,8,20,22,23\nGRID,23,,5.,2.,8.\n").format("R"), "8,1.,2.,3.", (0.0, 4.0, 11.0)),
        # large fields
        (
            f"CORD1C* {7:16d}{20:16d}{21:16d}{22:16d}\n*\n{BY_GRIDS.format('S,9,1')[18:]}",
            "7,2.,90.,1.",
            (1.0, 3.0, 8.0),
        ),
    ],
)
def test_places_by_hand(tmp_path: Path, systems: str, given: str, wanted: tuple[float, float, float]) -> None:
    for text in (f"{systems}GRID,1,{given}\n", f"GRID,1,{given}\n{systems}"):
        np.testing.assert_allclose(places(tmp_path, text)[1], wanted, atol=1e-14)


def test_grdset_gives_blank_fields_only(tmp_path: Path) -> None:
    text = f"GRID,1,,2.,90.,5.\nGRDSET,,6,,,,,3\nGRID,2,5,2.,90.,5.\nGRID,3,0,2.,90.,5.,,0\n{CYLINDER}{NESTED}"
    actual = places(tmp_path, text + "GRID,4,,0.,0.,0.,,12\n")
    np.testing.assert_allclose(actual[1], [-3.0, -88.0, 13.0], atol=1e-13)
    np.testing.assert_allclose(actual[2], [-1.0, 2.0, 8.0], atol=1e-14)
    np.testing.assert_allclose(actual[3], [2.0, 90.0, 5.0])
    constraints = [(entry.nodes.tolist(), entry.directions) for entry in read_raw(tmp_path / "deck.bdf").constraints]
    assert constraints == [([1], (2,)), ([2], (2,)), ([4], (0, 1))]


@pytest.mark.slow
def test_a_long_chain_of_systems(tmp_path: Path) -> None:
    """Each one lies at (1, 0, 0) of the next; no recursion ends it."""
    count = 3000
    chain = "".join(f"CORD2R,{n},{n + 1},1.,0.,0.,1.,0.,1.,+\n+,2.,0.,0.\n" for n in range(1, count))
    end = f"CORD2R,{count},0,1.,0.,0.,1.,0.,1.,+\n+,2.,0.,0.\n"
    np.testing.assert_allclose(places(tmp_path, f"{chain}{end}GRID,1,1,0.,7.,0.\n")[1], [count, 7.0, 0.0])


@pytest.mark.parametrize("kind", ["rectangular", "cylindrical", "spherical"])
def test_directions_are_those_in_which_the_coordinates_grow(
    kind: Literal["rectangular", "cylindrical", "spherical"],
) -> None:
    frame = Frame.through(kind, np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [4.0, -1.0, 2.0]]))
    assert frame is not None
    for values in ([2.0, 40.0, 70.0], [3.0, 130.0, -100.0]):
        place = frame.basic(np.array([values]))[0]
        steps = np.vstack([values + 1e-3 * np.eye(3), values - 1e-3 * np.eye(3)])
        ahead, behind = np.split(frame.basic(steps), 2)
        slope = (ahead - behind) / np.linalg.norm(ahead - behind, axis=1)[:, None]
        rows, lacking = frame.directions(place)
        np.testing.assert_allclose(rows, slope, atol=1e-8)
        np.testing.assert_allclose(rows @ rows.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(rows) == pytest.approx(1.0)
        assert lacking == set()
    assert BASIC.basic(np.array([[1.0, 2.0, 3.0]])).tolist() == [[1.0, 2.0, 3.0]]


@pytest.mark.parametrize(
    "text",
    [
        "GRID,1,5,0.,0.,0.\n",
        "GRID,1,,0.,0.,0.\nGRDSET,,5\n",
        "GRDSET,,5\nGRDSET,,5\n",
        "GRDSET,,x\nGRID,1,,0.,0.,0.\n",
        "GRDSET,,,,,,,8\nGRID,1,,0.,0.,0.\n",
        f"GRID,1,6,0.,0.,0.\n{NESTED}",
        "GRID,1,5,0.,0.,0.\nCORD1C,5,1,2,3\n",
        "GRID,1,5,0.,0.,0.\nCORD1C,5,2,3,4\n",
        "GRID,1,,0.,0.,0.\nGRID,2,5,0.,0.,0.\nCORD1S,5,1,1,1\n",
        "GRID,1,5,0.,0.,0.\nCORD2C,5,6,0.,0.,0.,0.,0.,1.,+\n+,1.\nCORD2S,6,7,0.,0.,0.,0.,0.,1.,+\n+,1.\n"
        "CORD2R,7,5,0.,0.,0.,0.,0.,1.,+\n+,1.\n",
        "GRID,1,5,0.,0.,0.\nCORD2C,5,,1.,0.,0.,2.,0.,0.,+\n+,3.,0.,0.\n",
        "GRID,1,5,0.,0.,0.\nCORD2S,5,,0.,0.,0.,1+200,0.,0.,+\n+,0.,1+200\n",
        "CORD2C,5,,1.,0.,0.,2.,0.,1.\n",
        "CORD2C,0,,1.,0.,0.,2.,0.,1.,+\n+,1.\n",
        "CORD1R,5,1,2,3,5,1,2,3\n",
        f"{CYLINDER}CORD1R,5,1,2,3\n",
        "CORD1R,5,1,2\n",
        "CORD2R,5,,a,0.,0.,2.,0.,1.,+\n+,1.\n",
    ],
)
def test_systems_that_are_wrong(tmp_path: Path, text: str) -> None:
    with rejects(ImportFileError):
        places(tmp_path, text)


@pytest.mark.slow
def test_a_sector_in_cylindrical_coordinates(tmp_path: Path, make_block: Callable[..., Mesh]) -> None:
    """Two layers of a sector: in x, y, z; and in r, theta, z of a tilted, moved system by grids, in several files."""
    block = make_block((3, 4, 2), (20.0, 40.0, 10.0))
    radius, angle, height = block.points[:, 0] + 50.0, block.points[:, 1], block.points[:, 2]
    tilt = 0.6
    turn = np.array(
        [[1.0, 0.0, 0.0], [0.0, np.cos(tilt), np.sin(tilt)], [0.0, -np.sin(tilt), np.cos(tilt)]]
    )  # rows: axes of the system
    origin = np.array([7.0, -3.0, 11.0])
    local = np.column_stack([radius * np.cos(np.radians(angle)), radius * np.sin(np.radians(angle)), height])
    sets = {"base": np.flatnonzero(height == 0.0), "top": np.flatnonzero(height == 10.0)}
    cells = (block.cells, (block.points[block.cells].mean(axis=1)[:, 2] > 5.0).astype(int))
    mesh = Mesh(1e-3 * (origin + local @ turn), *cells, sets)
    write_bdf(tmp_path / "plain.bdf", mesh, ["lower", "upper"], ["top"], "base", False)
    lines = (tmp_path / "plain.bdf").read_text(encoding="utf-8").splitlines()
    rest = [line for line in lines if not line.startswith("GRID")]
    round_grids = [
        f"GRID,{n},,{r:.12g},{theta:.12g},{z:.12g}"
        for n, (r, theta, z) in enumerate(zip(radius, angle, height, strict=True), start=1)
    ]
    corners = [origin, origin + turn[2], origin + turn[0]]
    by_grids = [f"GRID,{901 + n},0,{x:.12g},{y:.12g},{z:.12g}" for n, (x, y, z) in enumerate(corners)]
    start = rest.index("BEGIN BULK") + 1
    split = [*rest[:start], "GRDSET,,3", "INCLUDE 'grids.inc'", *rest[start:]]
    (tmp_path / "round.bdf").write_text("\n".join(split), encoding="utf-8")
    (tmp_path / "grids.inc").write_text("\n".join([*round_grids, "INCLUDE 'system.inc'"]), encoding="utf-8")
    (tmp_path / "system.inc").write_text("\n".join(["CORD1C,3,901,902,903", *by_grids]), encoding="utf-8")

    plain, actual = (read_model(tmp_path / name, "mm") for name in ("plain.bdf", "round.bdf"))
    np.testing.assert_allclose(actual.mesh.points, plain.mesh.points, atol=1e-12)
    assert actual.fixed_unknowns.tolist() == plain.fixed_unknowns.tolist()
    np.testing.assert_array_equal(actual.mesh.sides("top")[0], plain.mesh.sides("top")[0])
    volumes = body_volumes(actual.mesh)
    np.testing.assert_allclose(volumes, body_volumes(plain.mesh), rtol=1e-9)
    # four chords of 10 degrees between radii 50 and 70, 5 high: half the sine of 10 degrees each
    np.testing.assert_allclose(
        volumes, 1e-9 * 4 * 0.5 * np.sin(np.radians(10.0)) * (70.0**2 - 50.0**2) * 5.0, rtol=1e-9
    )
    frequencies = []
    for model in (plain, actual):
        materials = [model.materials[name] for name in model.mesh.body_names]
        structure = assemble_bodies(model.mesh, materials, fixed_unknowns=model.fixed_unknowns)
        frequencies.append(natural_frequencies(structure.stiffness, structure.mass, 8)[0])
        assert structure.mass.sum() > 0.0
    np.testing.assert_allclose(frequencies[1], frequencies[0], rtol=1e-8)
