"""What decks may include: from below their folder, not without end, and without showing what foreign files hold."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bombs import flat_memory
from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.formats.meshes import included_files, raw_model
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model

MODELS = Path(__file__).parents[2] / "data" / "models"
SECRET = "root:x:0:0:top/secret\n*NOTHING secret, 1\nMAT1,secret,1\n"
FORMATS = {"inp": "*INCLUDE, INPUT={}\n", "bdf": "INCLUDE '{}'\n"}


@pytest.fixture
def deck(tmp_path: Path) -> Callable[[str, object], Path]:
    """A deck of a format that first includes a file, and a folder beside its own that holds a secret."""

    def write(ending: str, included: object) -> Path:
        folder = tmp_path / "deck"
        folder.mkdir(exist_ok=True)
        path = folder / f"deck.{ending}"
        text = (MODELS / f"cubes.{ending}").read_text(encoding="utf-8")
        path.write_text(FORMATS[ending].format(included) + text, encoding="utf-8")
        return path

    (tmp_path / "beside").mkdir()
    (tmp_path / "beside" / "secret").write_text(SECRET)
    return write


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("how", ["absolute", "above", "link", "absent"])
def test_files_outside_of_the_folder_are_rejected(
    deck: Callable[[str, object], Path], tmp_path: Path, ending: str, how: str
) -> None:
    secret = tmp_path / "beside" / "secret"
    names = {"absolute": secret, "above": "../beside/secret", "link": "inner", "absent": "../beside/nothing"}
    path = deck(ending, names[how])
    if how == "link":
        (path.parent / "inner").symlink_to(secret)
    with rejects(ImportFileError):
        read_model(path, "mm")


@pytest.mark.parametrize("ending", FORMATS)
def test_absolute_names_and_names_above_are_read_below_the_folder(
    deck: Callable[[str, object], Path], tmp_path: Path, ending: str
) -> None:
    comment = {"inp": "** a comment\n*HEADING\n", "bdf": "$ a comment\n"}[ending]
    for name in (tmp_path / "deck" / "part", "../deck/part", "inner/../part"):
        path = deck(ending, name)
        (path.parent / "inner").mkdir(exist_ok=True)
        (path.parent / "part").write_text(comment)
        assert read_model(path, "mm").mesh.n_nodes == 16


@pytest.mark.parametrize("ending", FORMATS)
def test_what_a_foreign_file_contains_is_not_shown_where_it_is_allowed(
    deck: Callable[[str, object], Path], ending: str
) -> None:
    path = deck(ending, "../beside/secret")
    try:
        printed = " ".join(read_model(path, "mm", includes_outside=True).messages)
    except ImportFileError as error:
        printed = str(error)
        printed_sentence(printed)
    for word in ("root:", "ROOT:", "top"):
        assert word not in printed


@pytest.mark.parametrize("ending", FORMATS)
def test_allowed_files_are_read(deck: Callable[[str, object], Path], tmp_path: Path, ending: str) -> None:
    part = tmp_path / "beside" / "part"
    part.write_text({"inp": "*NSET, NSET=more\n", "bdf": "SET1,77,1,2\n"}[ending])
    text = (MODELS / f"cubes.{ending}").read_text(encoding="utf-8")
    path = deck(ending, part)
    if ending == "inp":
        part.write_text("*NSET, NSET=more\n1, 2\n")
        at = text.index("*NSET")
    else:
        at = text.index("BEGIN BULK\n") + len("BEGIN BULK\n")
    path.write_text(text[:at] + FORMATS[ending].format(part) + text[at:], encoding="utf-8")
    model = read_model(path, "mm", includes_outside=True)
    assert model.mesh.node_set({"inp": "more", "bdf": "set 77"}[ending]).tolist() == [0, 1]


@pytest.mark.parametrize("ending", FORMATS)
def test_a_fan_of_files_ends_early(
    deck: Callable[[str, object], Path], monkeypatch: pytest.MonkeyPatch, ending: str
) -> None:
    """30 includes in each of five levels: 24 million files."""
    read = []
    whole = included_files.read_text  # type: ignore[attr-defined]
    monkeypatch.setattr(included_files, "read_text", lambda path: read.append(path) or whole(path))  # type: ignore[func-returns-value]
    path = deck(ending, "level0")
    for level in range(4):
        (path.parent / f"level{level}").write_text(FORMATS[ending].format(f"level{level + 1}") * 30)
    (path.parent / "level4").write_text({"inp": "*HEADING\n", "bdf": "$\n"}[ending])
    with rejects(ImportFileError):
        read_model(path, "mm")
    assert len(read) == 24


@pytest.mark.long
@pytest.mark.parametrize("ending", FORMATS)
def test_the_number_and_the_size_of_all_files_have_limits(
    deck: Callable[[str, object], Path], monkeypatch: pytest.MonkeyPatch, ending: str
) -> None:
    path = deck(ending, "part")
    line = {"inp": "** comment\n*HEADING\n", "bdf": "$ comment\n"}[ending]
    (path.parent / "part").write_text("".join(FORMATS[ending].format(f"p{n}") for n in range(1001)))
    for number in range(1001):
        (path.parent / f"p{number}").write_text(line)
    with rejects(ImportFileError):
        read_model(path, "mm")
    monkeypatch.setattr(included_files, "LARGEST_FILE", 20_000)
    with rejects(ImportFileError):
        read_model(path, "mm")


def many_lines(count: int) -> str:
    """A row of bricks with a constraint, a force and a side of a surface for each in lines of their own."""
    rows = range(count + 1)
    corners = [(x, y, z) for x in rows for y, z in ((0, 0), (1, 0), (1, 1), (0, 1))]
    nodes = "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(corners, start=1))
    cells = "".join(
        f"{x + 1}, " + ", ".join(str(4 * x + corner) for corner in range(1, 9)) + "\n" for x in range(count)
    )
    sides = "".join(f"{x + 1}, S3\n" for x in range(count))
    held = "".join(f"{4 * x + 1}, 1, 3\n" for x in rows)
    forces = "".join(f"{4 * x + 2}, 2, 1.5\n" for x in rows)
    return (
        f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=row\n{cells}*SURFACE, NAME=side\n{sides}"
        f"*BOUNDARY\n{held}*STEP\n*CLOAD\n{forces}*END STEP\n"
    )


def sorted_numbers(monkeypatch: pytest.MonkeyPatch, path: Path) -> tuple[int, ImportedModel]:
    """How many numbers go through the functions of NumPy that sort, while a model is read."""
    total = 0

    def counted(function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **options: Any) -> Any:
            nonlocal total
            total += sum(np.size(each) for each in arguments[:2])
            return function(*arguments, **options)

        return call

    with monkeypatch.context() as patch:
        for name in ("unique", "isin", "setdiff1d", "sort", "argsort"):
            patch.setattr(np, name, counted(getattr(np, name)))
        model = read_model(path, "mm")
    return total, model


@pytest.mark.slow
def test_a_deck_with_an_entry_in_each_line_takes_linear_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in nonlinear decks of CalculiX, which hold each node of a face in a line of its own."""
    work = []
    for count in (100, 400):
        path = tmp_path / f"row{count}.inp"
        path.write_text(many_lines(count))
        total, model = sorted_numbers(monkeypatch, path)
        work.append(total)
        assert model.fixed_unknowns.size == 3 * (count + 1)
        assert model.node_forces.sum() == pytest.approx(1.5 * (count + 1))
        assert sum(len(side) for side in model.mesh.sides("side")) == count
    assert work[1] < 6.0 * work[0]


def test_names_of_a_deck_that_take_each_other_do_not_grow(tmp_path: Path) -> None:
    """A set of 16 times itself, 12 times over; the last one has 16 nodes as the first one."""
    text = (MODELS / "cubes.inp").read_text(encoding="utf-8")
    sets = "*NSET, NSET=s0\n" + ", ".join(map(str, range(1, 17))) + "\n"
    sets += "".join(f"*NSET, NSET=s{n}\n" + ", ".join([f"s{n - 1}"] * 16) + "\n" for n in range(1, 13))
    sets += "*NSET, NSET=s12\n" + ", ".join(["s12"] * 16) + "\n"
    path = tmp_path / "deck.inp"
    path.write_text(text.replace("*NSET, NSET=base", f"{sets}*NSET, NSET=base", 1))
    with flat_memory():
        model = read_model(path, "mm")
    assert model.mesh.node_set("s12").size == 16


@pytest.mark.slow
def test_ranges_of_nastran_have_a_limit(tmp_path: Path) -> None:
    """A line of 20 characters may name a million grids."""
    text = (MODELS / "cubes.bdf").read_text(encoding="utf-8")
    path = tmp_path / "deck.bdf"
    path.write_text(text.replace("ENDDATA", "SET1,5,1,THRU,40000\n" * 500 + "ENDDATA"))
    with flat_memory(600_000_000), rejects(ImportFileError):
        read_model(path, "mm")


@pytest.mark.slow
def test_a_keyword_that_continues_without_end(tmp_path: Path) -> None:
    """Parameters over 200,000 lines are joined once."""
    text = (MODELS / "cubes.inp").read_text(encoding="utf-8")
    path = tmp_path / "deck.inp"
    path.write_text(text.replace("*HEADING", ",\n".join(["*HEADING", *["a=1"] * 200_000]), 1))
    assert read_model(path, "mm").mesh.n_nodes == 16


def test_a_pipe_in_a_deck(deck: Callable[[str, object], Path], tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no named pipes")
    for ending in FORMATS:
        path = deck(ending, "pipe")
        if not (path.parent / "pipe").exists():
            os.mkfifo(path.parent / "pipe")
        with rejects(ImportFileError):
            read_model(path, "mm")
    assert raw_model.read_text(MODELS / "cubes.inp")
