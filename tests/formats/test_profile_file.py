"""Profiles from text files: separators, units, and sentences about what is wrong, with the line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.formats.profile_file import read_profile


def written(folder: Path, text: str) -> Path:
    """A file with this text."""
    path = folder / "profile.txt"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "  ", " , ", ", "])
def test_separators(tmp_path: Path, separator: str) -> None:
    text = "".join(f"{x}{separator}{z}\n" for x, z in (("0.0", "1.5"), ("0.5", "-2e-1"), ("1", "3")))
    profile = read_profile(written(tmp_path, text), "mm", "um")
    assert profile.spacing == pytest.approx(0.5e-3, rel=1e-14)
    np.testing.assert_allclose(profile.heights, [1.5e-6, -0.2e-6, 3e-6], rtol=1e-14)
    assert profile.units == ("mm", "um")


@pytest.mark.parametrize(
    "heading",
    [
        "# x [mm], z [um]\n",
        "x (mm);z (um)\n",
        "# made today\n\nposition [ mm ]\theight [µm]\n",
        "\ufeff# x [mm] z [um]\n",
    ],
)
def test_units_of_the_heading(tmp_path: Path, heading: str) -> None:
    profile = read_profile(written(tmp_path, heading + "1 2\n2 3\n# the end\n3 5\n"))
    assert profile.spacing == pytest.approx(1e-3, rel=1e-14)
    np.testing.assert_allclose(profile.heights, [2e-6, 3e-6, 5e-6], rtol=1e-14)


def test_option_may_repeat_the_heading(tmp_path: Path) -> None:
    assert read_profile(written(tmp_path, "# x [mm], z [um]\n1 2\n2 3\n"), "mm", "um").units == ("mm", "um")


def test_rounded_positions_are_equal_distances(tmp_path: Path) -> None:
    text = "".join(f"{x / 3:.4f} {x % 2}\n" for x in range(30))
    assert read_profile(written(tmp_path, text), "um", "um").spacing == pytest.approx(1e-6 / 3, rel=1e-4)


WRONG = {
    "no unit": ("1 2\n2 3\n", None, ["unit of the position is not stated", "--unit um", "not guessed"]),
    "one unit in the heading": ("# x [mm] z\n1 2\n2 3\n", None, ["unit of the position"]),
    "another unit than the file's": ("# x [mm], z [um]\n1 2\n2 3\n", "um", ["position in mm, but um"]),
    "unknown unit": ("1 2\n2 3\n", "mmm", ['"mmm"', "unknown unit"]),
    "unit of force": ("1 2\n2 3\n", "N", ["unit of force", "length is needed"]),
    "a word": ("1 2\n2 three\n", "um", ["line 2", 'height "three" is not a number']),
    "a word first": ("1 2\n\ntwo 3\n", "um", ["line 3", 'position "two"']),
    "damaged first line": ("O.5 2\n1 3\n2 3\n", "um", ["line 1", 'position "O.5"']),
    "NaN": ("1 2\n2 nan\n", "um", ["line 2", "the height is nan", "gaps"]),
    "infinite": ("1 2\ninf 3\n", "um", ["line 2", "the position is inf"]),
    "one column": ("1\n2\n", "um", ["line 1", "has 1 columns"]),
    "three columns": ("1 2\n2 3 4\n", "um", ["line 2", "has 3 columns"]),
    "decimal comma": ("0,5;1,5\n1,0;2,5\n", "um", ["line 1", "4 columns", "not a comma"]),
    "names twice": ("x z\nmm um\n1 2\n2 3\n", "um", ["line 2", "second line of column names"]),
    "unequal": ("0 1\n1 2\n2 3\n3.5 4\n", "um", ["line 4", "1.5 after", "equal distances"]),
    "backward": ("0 1\n1 2\n0.5 3\n", "um", ["line 3", "0.5 is not above"]),
    "repeated": ("0 1\n1 2\n1 3\n", "um", ["line 3", "must increase"]),
    "empty": ("", "um", ["0 lines of numbers"]),
    "comments only": ("# x [mm], z [um]\n", None, ["0 lines of numbers"]),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_file(tmp_path: Path, name: str) -> None:
    text, unit, words = WRONG[name]
    path = written(tmp_path, text)
    with rejects(InputError) as caught:
        read_profile(path, unit, unit)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_missing_and_binary_file(tmp_path: Path) -> None:
    with rejects(InputError):
        read_profile(tmp_path / "none.txt", "um", "um")
    path = tmp_path / "binary"
    path.write_bytes(b"\xff\xfe\x00\x81")
    with rejects(InputError):
        read_profile(path, "um", "um")


@pytest.mark.parametrize(
    "rows",
    [
        ["0, 0", "1e300, 1"],
        ["0, 1e308", "1, 1"],
        ["0, 0", "5e-324, 1"],
        ["0, 0", "1e-12, 1"],
    ],
)
def test_numbers_of_no_surface(rows: list[str], tmp_path: Path) -> None:
    (tmp_path / "profile.csv").write_text("\n".join(rows), encoding="utf-8")
    with rejects(InputError):
        read_profile(tmp_path / "profile.csv", "um", "um")
