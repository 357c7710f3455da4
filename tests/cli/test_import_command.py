"""stickslip import FILE."""

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from sentences import printed_sentence
from stickslip.cli.main import app

MODELS = Path(__file__).parents[1] / "data" / "models"


def run(*words: object) -> Result:
    return CliRunner().invoke(app, ["import", *map(str, words)])


def sentences_of(output: str) -> str:
    """What the command prints after its tables; lines end where the terminal does."""
    return " ".join(output.rpartition("┘")[2].split())


def test_what_is_in_a_model() -> None:
    result = run(MODELS / "cubes.inp", "--length-unit", "mm")
    assert result.exit_code == 0, result.output
    for words in ("Abaqus/CalculiX", "lower", "0.00785", "contact", "base", "free faces"):
        assert words in result.output
    printed_sentence(sentences_of(result.output), "mm-t-s", "upper")
    assert "Warning" not in result.output
    (contact,) = [line for line in result.output.splitlines() if line.startswith("│ contact")]
    assert [word.strip() for word in contact.split("│")[1:-1]] == ["contact", "1", "4", "100", "lower"]


def test_a_deck_as_abaqus_cae_writes_it() -> None:
    result = run(MODELS / "cubes_of_parts.inp", "--length-unit", "mm")
    assert result.exit_code == 0, result.output
    table = [[word.strip() for word in line.split("│")[1:-1]] for line in result.output.splitlines()]
    assert ["Cube-2", "1", "8", "6", "hexahedron"] in table
    assert ["Cube-2", "1000", "0.00785", "210", "7850"] in table
    assert ["Cube-2.Top", "1", "4", "100", "Cube-2"] in table
    assert ["Skin", "3", "10", "300", "Cube-1, Cube-2"] in table
    assert ["x", "-10", "10", "20"] in table
    printed_sentence(sentences_of(result.output), "'Cube-2' + 1000", "(2, 0, -2.5) N")
    assert "Warning" not in result.output


def test_a_bad_part_ends_with_2(tmp_path: Path) -> None:
    text = (MODELS / "cubes_of_parts.inp").read_text(encoding="utf-8")
    (tmp_path / "bad.inp").write_text(text.replace("*End Part", "", 1), encoding="utf-8")
    result = run(tmp_path / "bad.inp", "--length-unit", "mm")
    assert result.exit_code == 2
    printed_sentence(result.output, "bad.inp", "line 32", "*PART")


def test_without_a_unit_one_is_requested() -> None:
    result = run(MODELS / "gmsh_4.1_text.msh")
    assert result.exit_code == 0, result.output
    printed_sentence(next(line for line in result.output.splitlines() if "--length-unit" in line))
    assert "mass" not in result.output
    assert "left face" in result.output


def test_wrong_units_are_warned_of() -> None:
    output = run(MODELS / "cubes.inp", "--length-unit", "m").output
    printed_sentence("\n".join(line for line in output.splitlines() if line.startswith("Warning: ")), "lower")


@pytest.mark.parametrize(
    ("options", "key"),
    [
        (["--length-unit", "yard"], "length_unit"),
        (["--unit-system", "SI"], "--length-unit"),
        (["--length-unit", "mm", "--unit-system", "SI"], "unit_system"),
    ],
)
def test_bad_options_end_with_2(options: list[str], key: str) -> None:
    result = run(MODELS / "cubes.inp", *options)
    assert result.exit_code == 2
    printed_sentence(result.output, key)


def test_a_bad_file_ends_with_2(tmp_path: Path) -> None:
    (tmp_path / "bad.inp").write_text("*NODE\n1, 0, 0, nothing\n", encoding="utf-8")
    result = run(tmp_path / "bad.inp", "--length-unit", "mm")
    assert result.exit_code == 2
    printed_sentence(result.output, "bad.inp", "line 2", "*NODE")


@pytest.mark.parametrize(
    "name",
    ["part.stl", "job.odb", "k.mtx", "study.toml", "notes.txt", "folder.inp", "binary.inp", "text.msh"],
)
def test_files_of_another_kind_end_with_2_and_advice(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    if name.startswith("folder"):
        path.mkdir()
    else:
        path.write_bytes(b"\0\1\2" if name.startswith("binary") else b"hello\n")
    result = run(path, "--length-unit", "mm")
    assert result.exit_code == 2
    printed_sentence(result.output, name)
