"""Constraint equations of Ansys archives against the same equations of an Abaqus deck, and with turned nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_ansys import ARCHIVE, cut_cubes

from archive_writer import write_cdb
from model_writers import write_inp
from sentences import printed_sentence, rejects
from stickslip.core.errors import ImportFileError
from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.formats.meshes.read import read_model
from stickslip.structure.elasticity import natural_frequencies

# Lower and upper node of each tied corner, in the numbers of the file, and the terms of each equation.
CORNERS = [(5, 9), (6, 10), (7, 11)]
LABELS = ("UX", "UY", "UZ")


def written(tmp_path: Path, lines: list[str], archive: str = ARCHIVE) -> ImportedModel:
    path = tmp_path / "tied.cdb"
    path.write_text("\n".join([archive, *lines, ""]), encoding="utf-8")
    return read_model(path, "mm")


def frequencies_hz(model: ImportedModel) -> FloatArray:
    structure = model.assemble()
    return natural_frequencies(structure.stiffness, structure.mass, 10)[0]


def as_written(number: int, terms: list[tuple[int, str, float]], constant: float = 0.0) -> list[str]:
    """The lines of CDWRITE: two terms in each."""
    lines = [f"CE,R5.0,DEFI,{len(terms):8d},{number:8d},{constant:12.8f}"]
    for at in range(0, len(terms), 2):
        words = [f"{node:10d},{name:4},{factor:12.8f}" for node, name, factor in terms[at : at + 2]]
        lines.append(f"CE,R5.0,NODE,{','.join(words)}")
    return lines


def three_terms() -> list[list[tuple[int, str, float]]]:
    """u_9 = 0.75 u_5 + 0.25 u_8 and the like: 9 equations that tie the upper cube to the lower one."""
    return [[(upper, name, 1.0), (lower, name, -0.75), (8, name, -0.25)] for lower, upper in CORNERS for name in LABELS]


def of_a_deck(tmp_path: Path) -> ImportedModel:
    path = tmp_path / "tied.inp"
    write_inp(path, cut_cubes("hexahedron", False), ["lower", "upper"], ["contact", "opposite"], "base")
    equations = []
    for terms in three_terms():
        words = ", ".join(f"{node}, {LABELS.index(name) + 1}, {factor}" for node, name, factor in terms)
        equations += ["*EQUATION", "3", words]
    text = path.read_text(encoding="utf-8")
    at = text.index("*BOUNDARY")
    path.write_text("\n".join([text[:at].rstrip(), *equations, text[at:]]), encoding="utf-8")
    return read_model(path, "mm")


@pytest.fixture
def archive(tmp_path: Path) -> str:
    """The two cubes of the deck."""
    path = tmp_path / "cubes.cdb"
    write_cdb(path, cut_cubes("hexahedron", False), ["contact", "opposite"], "base")
    return path.read_text(encoding="utf-8")


@pytest.mark.slow
def test_equations_are_those_of_a_deck(tmp_path: Path, archive: str) -> None:
    """Both forms: of CDWRITE, and of the command, whose fourth term stands in a second one."""
    lines = [line for number, terms in enumerate(three_terms(), 1) for line in as_written(number, terms)]
    commands = []
    for number, ((a, name, f), (b, _, g), (c, _, h)) in enumerate(three_terms(), 1):
        commands += [f"CE,{number},0,{a},{name},{f},{b},{name},{g}", f"CE,{number},0,{c},{name},{h}"]
    wanted = frequencies_hz(of_a_deck(tmp_path))
    assert wanted[0] > 1.0  # the upper cube is held
    for words in (lines, commands):
        model = written(tmp_path, words, archive)
        assert model.equations is not None
        np.testing.assert_allclose(frequencies_hz(model), wanted, rtol=1e-7)


def test_an_equation_acts_along_the_directions_of_turned_nodes(tmp_path: Path, archive: str) -> None:
    """Node 9 turned by 90 degrees about z: its UX is y, its UY is -x."""
    line = next(line for line in archive.splitlines() if line.startswith(f"{9:9d}{0:9d}"))
    turned = archive.replace(line, f"{line}{90.0:21.13E}")
    lines, plain = [], []
    for number, (lower, upper) in enumerate(CORNERS):
        own = [("UY", -1.0), ("UX", 1.0), ("UZ", 1.0)] if upper == 9 else [(name, 1.0) for name in LABELS]
        for axis, (name, sign) in enumerate(own):
            place = 3 * number + axis + 1
            lines += as_written(place, [(upper, name, sign), (lower, LABELS[axis], -1.0)])
            plain += as_written(place, [(upper, LABELS[axis], 1.0), (lower, LABELS[axis], -1.0)])
    wanted = frequencies_hz(written(tmp_path, plain, archive))
    np.testing.assert_allclose(frequencies_hz(written(tmp_path, lines, turned)), wanted, rtol=1e-7)


PAIRS = [(lower, upper, name) for lower, upper in CORNERS for name in LABELS]
COUPLED = {
    "a set each": [f"CP,{number},{name},{low},{up}" for number, (low, up, name) in enumerate(PAIRS, 1)],
    "all directions": [f"CP,NEXT,ALL,{low},{up}" for low, up in CORNERS],
    "node by node": [line for low, up, name in PAIRS for line in (f"CP,NEXT,{name},{low}", f"CP,HIGH,,{up},{low}")],
    "changed direction": [line for low, up, name in PAIRS for line in (f"CP,NEXT,ROTX,{low},{up}", f"CP,HIGH,{name}")],
}


@pytest.mark.slow
def test_coupled_sets_are_equations(tmp_path: Path, archive: str) -> None:
    equations = [
        line
        for number, (low, up, name) in enumerate(PAIRS, 1)
        for line in as_written(number, [(up, name, 1.0), (low, name, -1.0)])
    ]
    wanted = frequencies_hz(written(tmp_path, equations, archive))
    for lines in COUPLED.values():
        np.testing.assert_allclose(frequencies_hz(written(tmp_path, lines, archive)), wanted, rtol=1e-7)


@pytest.mark.slow
def test_a_coupled_set_of_many_nodes_follows_its_first_along_their_own_directions(tmp_path: Path, archive: str) -> None:
    """Node 9 turned by 90 degrees about z: its UX is y."""
    line = next(line for line in archive.splitlines() if line.startswith(f"{9:9d}{0:9d}"))
    turned = archive.replace(line, f"{line}{90.0:21.13E}")
    held = [f"CP,NEXT,{name},{low},{up}" for low, up, name in PAIRS if up != 9]
    plain = as_written(1, [(9, "UY", 1.0), (5, "UX", -1.0)]) + as_written(2, [(7, "UX", 1.0), (5, "UX", -1.0)])
    wanted = frequencies_hz(written(tmp_path, [*held, *plain], archive))
    found = frequencies_hz(written(tmp_path, [*held, "CP,NEXT,UX,5,9,7"], turned))
    np.testing.assert_allclose(found, wanted, rtol=1e-7)
    without = frequencies_hz(written(tmp_path, held, archive))
    assert abs(without[0] / wanted[0] - 1.0) > 1e-3  # the set acts


def test_a_constant_is_told(tmp_path: Path) -> None:
    model = written(tmp_path, as_written(1, [(5, "UX", 1.0), (9, "UX", -1.0)], 0.5))
    printed_sentence(next(message for message in model.messages if "CE" in message))


@pytest.mark.parametrize(
    "lines",
    [
        ["CE,R5.0,DEFI,       3,       1,  0.0", "CE,R5.0,NODE,  5,UX,1.0,  9,UX,-1.0"],
        ["CE,R5.0,NODE,  5,UX,1.0,  9,UX,-1.0"],
        as_written(1, [(5, "UX", 1.0), (9, "UX", -1.0)]) * 2,
        as_written(1, [(5, "TEMP", 1.0), (9, "UX", -1.0)]),
        as_written(1, [(5, "UX", 0.0), (9, "UX", 0.0)]),
        as_written(1, [(999, "UX", 1.0), (9, "UX", -1.0)]),
        ["CERIG,5,9,ALL"],
        ["CP,1,TEMP,5,9"],
        ["CP,1,UX,5"],
        ["CP,1,UX,ALL"],
        ["CP,1,UX,5,-9"],
        ["CP,1,UX,5,9", "CP,1,ALL,6,10"],
        ["CP,2,UX,5,9", "CP,1,ALL,6,10"],
        ["CP,HIGH,UX,5,9"],
        ["CP,1,,5,9"],
        ["CP,1,UX,5,999"],
    ],
    ids=[
        *("a term is missing", "no DEFI", "twice", "direction", "all zero", "no such node", "CERIG", "CP temperature"),
        *("CP one node", "CP all nodes", "CP removes a node", "CP all, set exists", "CP all, a later set exists"),
        *("CP no highest", "CP no direction", "CP no such node"),
    ],
)
def test_what_is_rejected(tmp_path: Path, lines: list[str]) -> None:
    with rejects(ImportFileError):
        written(tmp_path, lines)
