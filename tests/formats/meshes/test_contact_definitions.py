"""Contact definitions of Abaqus and Nastran decks as pairs of faces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model

MODELS = Path(__file__).parents[2] / "data" / "models"
STEEL = "*SURFACE INTERACTION, NAME=Steel\n*FRICTION\n0.3\n"


def abaqus(tmp_path: Path, cards: str, name: str = "cubes.inp") -> ImportedModel:
    (tmp_path / name).write_text((MODELS / name).read_text(encoding="utf-8") + cards, encoding="utf-8")
    return read_model(tmp_path / name, "mm")


def nastran(tmp_path: Path, cards: str) -> ImportedModel:
    text = (MODELS / "cubes.bdf").read_text(encoding="utf-8").replace("ENDDATA", f"{cards}\nENDDATA")
    (tmp_path / "cubes.bdf").write_text(text, encoding="utf-8")
    return read_model(tmp_path / "cubes.bdf", "mm")


@pytest.mark.parametrize(
    ("cards", "friction", "is_bonded", "n_notes"),
    [
        (f"{STEEL}*CONTACT PAIR, INTERACTION=STEEL\nOpposite, contact\n", 0.3, False, 0),
        (f"*CONTACT PAIR, INTERACTION=steel, TIED\nOpposite, contact\n{STEEL}", 0.3, True, 0),
        ("*CONTACT PAIR\nopposite, CONTACT\n", None, False, 0),
        (
            "*SURFACE INTERACTION, NAME=a\n*FRICTION, ROUGH\n*CONTACT PAIR, INTERACTION=a\nopposite, contact\n",
            None,
            False,
            1,
        ),
        (
            "*SURFACE INTERACTION, NAME=a\n*FRICTION, EXPONENTIAL DECAY, TAUMAX=9.\n0.3, 0.2, 1.\n*CONTACT PAIR, "
            "INTERACTION=a\nopposite, contact\n",
            0.3,
            False,
            2,
        ),
        (
            f"{STEEL}*CONTACT\n*CONTACT INCLUSIONS\nopposite, contact\n*CONTACT PROPERTY ASSIGNMENT\n, , steel\n",
            0.3,
            False,
            0,
        ),
        (
            f"{STEEL}*CONTACT INCLUSIONS\nopposite, contact\n*CONTACT PROPERTY ASSIGNMENT\ncontact, opposite, steel\n",
            0.3,
            False,
            0,
        ),
    ],
)
def test_abaqus(tmp_path: Path, cards: str, friction: float | None, is_bonded: bool, n_notes: int) -> None:
    (pair,) = abaqus(tmp_path, cards).contacts
    assert (pair.first, pair.second) == ("opposite", "contact")
    assert (pair.friction, pair.is_bonded, len(pair.notes)) == (friction, is_bonded, n_notes)


def test_abaqus_with_parts(tmp_path: Path) -> None:
    """Surfaces of an instance have its name before theirs."""
    cards = f"{STEEL}*Contact Pair, interaction=Steel\nAssembly.Cube-2.Top, Cube-1.top\n"
    (pair,) = abaqus(tmp_path, cards, "cubes_of_parts.inp").contacts
    assert (pair.first, pair.second, pair.friction) == ("Cube-2.Top", "Cube-1.Top", 0.3)


def test_abaqus_without_pairs(tmp_path: Path) -> None:
    """General contact, contact of a face with itself, and faces that are not of solids give messages."""
    cards = "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PAIR\ncontact\ncontact, nowhere\n"
    model = abaqus(tmp_path, cards)
    assert model.contacts == ()
    for message in model.messages[-3:]:
        printed_sentence(message)


@pytest.mark.parametrize(
    "cards",
    [
        "*CONTACT PAIR, INTERACTION=nothing\nopposite, contact\n",
        "*FRICTION\n0.3\n",
        "*SURFACE INTERACTION, NAME=a\n*FRICTION\n-0.3\n",
        "*SURFACE INTERACTION, NAME=a\n*FRICTION\nhigh\n",
        "*CONTACT PAIR\n,\n",
    ],
)
def test_abaqus_errors(tmp_path: Path, cards: str) -> None:
    with rejects(ImportFileError):
        abaqus(tmp_path, cards)


@pytest.mark.parametrize(
    ("cards", "friction", "is_bonded"),
    [
        ("BSURFS,1,,,,2,9,10,11\nBSURFS,2,,,,1,5,6,7\nBCTSET,9,1,2,0.3", 0.3, False),
        ("BSURF,1,4\nBSURF,2,3\nBCTSET,9,1,2", None, False),
        ("BSURF,1,4\nBSURF,2,3\nBGSET,9,1,2", None, True),
        ("BCPROPS,1,101\nBCPROPS,2,100\nBCTSET,9,1,2,.1", 0.1, False),
        (
            "BSURF,11,4\nBSURF,12,3\nBCBODY,1,3D,DEFORM,11\nBCBODY,2,3D,DEFORM,12\n"
            "BCTABLE,9,,,1,,,,,+\n+,SLAVE,1,,,0.15,,0,,+\n+,MASTERS,2",
            0.15,
            False,
        ),
        (
            "BSURF,11,4\nBSURF,12,3\nBCBODY,1,3D,DEFORM,11\nBCBODY,2,3D,DEFORM,12\n"
            "BCTABLE,9,,,1,,,,,+\n+,SLAVE,1,,,,,1,,+\n+,MASTERS,2",
            None,
            True,
        ),
    ],
)
def test_nastran(tmp_path: Path, cards: str, friction: float | None, is_bonded: bool) -> None:
    model = nastran(tmp_path, cards)
    (pair,) = model.contacts
    assert (pair.friction, pair.is_bonded) == (friction, is_bonded)
    for name, nodes in zip((pair.first, pair.second), ([8, 9, 10, 11], [4, 5, 6, 7]), strict=True):
        np.testing.assert_array_equal(model.mesh.node_set(name), nodes)


def test_all_free_sides_of_a_solid(tmp_path: Path) -> None:
    """A region of solids has all of their free sides, of which those without a partner form no pairs."""
    model = nastran(tmp_path, "BSURF,1,2\nBSURF,2,1\nBCTSET,9,1,2,0.3")
    assert sum(map(len, model.mesh.sides("region 1"))) == 6
    assert model.contacts[0].first == "region 1"


@pytest.mark.parametrize(
    "cards",
    [
        "BCTSET,9,1,2,0.3",
        "BSURF,1,77\nBSURF,2,3\nBCTSET,9,1,2",
        "BSURFS,1,,,,2,9,10,16\nBSURF,2,3\nBCTSET,9,1,2",
        "BSURFS,1,,,,3,5,6,7\nBSURF,2,3\nBCTSET,9,1,2",
        "BCTABLE,9,,,1",
        "BCTABLE,9,,,1,,,,,+\n+,SLAVE,1,,,,,1",
    ],
)
def test_nastran_errors(tmp_path: Path, cards: str) -> None:
    with rejects(ImportFileError):
        nastran(tmp_path, cards)
