"""Nastran decks in several files: what is found where, and whose line an error names."""

from pathlib import Path

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes.included_files import IncludedFiles
from stickslip.formats.meshes.nastran_include import join_files
from stickslip.formats.meshes.read import read_model

CUBES = (Path(__file__).parents[2] / "data" / "models" / "cubes.bdf").read_text(encoding="utf-8")
GRIDS = "".join(line for line in CUBES.splitlines(keepends=True) if line.startswith("GRID"))
REST = CUBES.split("BEGIN BULK\n")[1].replace(GRIDS, "").replace("ENDDATA\n", "")


def write(folder: Path, **files: str) -> Path:
    """Files by their stem; two underscores stand for a folder."""
    for name, text in files.items():
        path = folder / f"{name.replace('__', '/')}.bdf"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "deck.bdf"


def same_as_in_one_file(path: Path) -> None:
    whole = path.parent / "whole.bdf"
    whole.write_text(CUBES, encoding="utf-8")
    actual, wanted = read_model(path, "mm"), read_model(whole, "mm")
    np.testing.assert_array_equal(actual.mesh.points, wanted.mesh.points)
    assert actual.fixed_unknowns.tolist() == wanted.fixed_unknowns.tolist()
    assert actual.mesh.body_names == wanted.mesh.body_names == ("lower", "upper")
    assert actual.mesh.node_sets.keys() == wanted.mesh.node_sets.keys()
    assert actual.materials.keys() == wanted.materials.keys()


@pytest.mark.parametrize(
    "statement",
    [
        "INCLUDE 'parts/grids.bdf'",
        'include "parts/grids.bdf" $ all of them',
        "  Include parts/grids.bdf $ without quotes",
        "INCLUDE'parts\\grids.bdf'",
        "INCLUDE 'parts/   \n        gri\n   ds.bdf'   $ in three lines",
    ],
)
def test_every_way_to_write_the_statement(tmp_path: Path, statement: str) -> None:
    deck = (
        f"SOL 103\nCEND\nSPC = 1\nBEGIN BULK\n$ INCLUDE 'comment.bdf'\n{statement}\n{REST}ENDDATA\nINCLUDE 'no.bdf'\n"
    )
    same_as_in_one_file(write(tmp_path, deck=deck, parts__grids=GRIDS))


def test_executive_and_case_control_are_included_too(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        deck="INCLUDE executive.bdf\nCEND\nINCLUDE case.bdf\nINCLUDE 'bulk.bdf'",
        executive="SOL 103\n",
        case="SPC = 1\nBEGIN BULK\n",
        bulk=f"{GRIDS}SPC1,2,123,9\n{REST}ENDDATA\n",
    )
    assert read_model(path, "mm").fixed_unknowns.tolist() == [*range(12)]


def test_names_are_relative_to_the_including_file_then_to_the_deck(tmp_path: Path) -> None:
    nested = "INCLUDE 'inner.bdf'\nINCLUDE 'parts/outer.bdf'\n"
    path = write(
        tmp_path,
        deck=f"SOL 103\nCEND\nSPC = 1\nBEGIN BULK\nINCLUDE 'parts/all.bdf'\n{REST}\nENDDATA\n",
        inner="RBE1,1,2,3,4\n",  # is refused if it is read
        parts__inner=GRIDS[: GRIDS.index("GRID,7")],
        parts__outer=GRIDS[GRIDS.index("GRID,7") :],
        parts__all=nested,
    )
    same_as_in_one_file(path)
    (tmp_path / "parts" / "inner.bdf").unlink()
    with rejects(ImportFileError):
        read_model(path, "mm")


def test_every_joined_line_knows_its_file_and_line(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        deck="a\nINCLUDE 'one.bdf'\nb\nINCLUDE\t'o\n ne.bdf'\nc",
        one="d\nINCLUDE 'two.bdf'\nINCLUDE two.bdf\ne",
        two="f",
    )
    lines, places = join_files(path, IncludedFiles(path, outside=False))
    assert lines == [*"adffebdffec"]
    actual = [(file.stem, line) for file, line in map(places.of, range(1, 12))]
    inner = [("one", 1), ("two", 1), ("two", 1), ("one", 4)]
    assert actual == [("deck", 1), *inner, ("deck", 3), *inner, ("deck", 6)]
    assert places.words(6) == "line 3"
    assert places.words(3) == f"line 1 of {tmp_path / 'two.bdf'}"


HEAD = "SOL 103\nCEND\nSPC = 1\nBEGIN BULK\n"


@pytest.mark.parametrize(
    "files",
    [
        {"deck": f"{HEAD}INCLUDE 'a.bdf'"},
        {"deck": f"{HEAD}INCLUDE '{'a' * 5000}'"},
        {"deck": f"{HEAD}INCLUDE '.'"},
        {"deck": f"{HEAD}INCLUDE"},
        {"deck": f"{HEAD}INCLUDE ''"},
        {"deck": f"{HEAD}INCLUDE my grids.bdf"},
        {"deck": f"{HEAD}INCLUDE 'a.bdf' b"},
        {"deck": f"{HEAD}INCLUDE 'a.bdf\n{GRIDS}"},
        {"deck": f"{HEAD}INCLUDE deck.bdf"},
        {"deck": f"{HEAD}INCLUDE a.bdf", "a": "$\nINCLUDE b.bdf", "b": "$\n$\nINCLUDE 'a.bdf'"},
        {"deck": f"{HEAD}INCLUDE a0.bdf", **{f"a{n}": f"INCLUDE a{n + 1}.bdf" for n in range(6)}, "a6": "$"},
        {"deck": f"{HEAD}INCLUDE a.bdf", "a": " \n"},
        {"deck": f"{HEAD}INCLUDE a.bdf", "a": "$\0"},
        {"deck": f"{HEAD}INCLUDE a.bdf\n$\n{REST}", "a": f"{GRIDS}ENDDATA\n"},
        {"deck": f"{HEAD}INCLUDE a.bdf\n{REST}", "a": f"$\nBEGIN BULK\n{GRIDS}"},
        {"deck": f"{HEAD}INCLUDE a.bdf\n{REST}", "a": f"$\n{GRIDS}GRID,9,,x\n"},
        {"deck": f"{HEAD}INCLUDE a.bdf\n{REST}", "a": f"{GRIDS}$\nGRID,9,,0,0,0\n"},
        {"deck": f"{HEAD}INCLUDE a.bdf\n{GRIDS}{REST}", "a": "$\nGRID,9,,0,0,0\n"},
        {"deck": f"{HEAD}{GRIDS}INCLUDE a.bdf\n", "a": f"$\n$\n{REST.replace('13      14', '14      13')}"},
        {"deck": f"{HEAD}{GRIDS}INCLUDE a.bdf\nSET1,7,99\n", "a": REST.replace("MAT1,7", "MAT1,8")},
        {"deck": f"{HEAD}{GRIDS}INCLUDE a.bdf\n", "a": f"{REST}$\nSPC1,1,123,99\n"},
        {"deck": f"{HEAD}INCLUDE a.bdf\n{REST}", "a": "+,1,2\n"},
    ],
)
def test_what_is_wrong_is_reported_with_its_file_and_line(tmp_path: Path, files: dict[str, str]) -> None:
    path = write(tmp_path, **files)
    with rejects(ImportFileError):
        read_model(path, "mm")


def test_entries_that_are_not_read_are_reported_with_their_file(tmp_path: Path) -> None:
    path = write(tmp_path, deck=f"{HEAD}{GRIDS}GRAV,1,,9.81,0.,0.,1.\nINCLUDE a.bdf\n{REST}", a="$\nTEMP,1,1,20.\n")
    printed_sentence("\n".join(read_model(path, "mm").messages), "GRAV (line 21)", "TEMP (line 2 of ")
