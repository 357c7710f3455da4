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
    "no unit": ("1 2\n2 3\n", None),
    "one unit in the heading": ("# x [mm] z\n1 2\n2 3\n", None),
    "another unit than the file's": ("# x [mm], z [um]\n1 2\n2 3\n", "um"),
    "unknown unit": ("1 2\n2 3\n", "mmm"),
    "unit of force": ("1 2\n2 3\n", "N"),
    "a word": ("1 2\n2 three\n", "um"),
    "a word first": ("1 2\n\ntwo 3\n", "um"),
    "damaged first line": ("O.5 2\n1 3\n2 3\n", "um"),
    "NaN": ("1 2\n2 nan\n", "um"),
    "infinite": ("1 2\ninf 3\n", "um"),
    "one column": ("1\n2\n", "um"),
    "three columns": ("1 2\n2 3 4\n", "um"),
    "decimal comma": ("0,5;1,5\n1,0;2,5\n", "um"),
    "names twice": ("x z\nmm um\n1 2\n2 3\n", "um"),
    "unequal": ("0 1\n1 2\n2 3\n3.5 4\n", "um"),
    "backward": ("0 1\n1 2\n0.5 3\n", "um"),
    "repeated": ("0 1\n1 2\n1 3\n", "um"),
    "empty": ("", "um"),
    "comments only": ("# x [mm], z [um]\n", None),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_file(tmp_path: Path, name: str) -> None:
    text, unit = WRONG[name]
    path = written(tmp_path, text)
    with rejects(InputError):
        read_profile(path, unit, unit)


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
