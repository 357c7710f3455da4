"""Things by name: own ones, registered ones, and those that other packages offer."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from sentences import rejects
from stickslip.core.errors import InputError
from stickslip.core.registry import Registry


def shelf() -> Registry[dict[str, int]]:
    return Registry("shelf", "stickslip.tests.no_such_group", {"dict": dict})


def test_a_registered_maker_is_found() -> None:
    shelves = shelf()
    shelves.register("other", dict.copy)
    assert shelves.names() == ("dict", "other")
    assert shelves.find("dict")(a=1) == {"a": 1}


def test_a_name_cannot_be_taken_twice() -> None:
    shelves = shelf()
    shelves.register("dict", dict)  # the same again changes nothing
    with rejects(InputError):
        shelves.register("dict", dict.copy)


def test_an_unknown_name_lists_those_that_there_are() -> None:
    with rejects(InputError):
        shelf().find("box")


@pytest.mark.long
@pytest.mark.parametrize(
    ("group", "name", "code"),
    [
        (
            "stiffness_laws",
            "halfway",
            "from stickslip.contact.stiffness.registry import stiffness_law as find, stiffness_law_names as names",
        ),
        (
            "model_formats",
            "halfway",
            "from stickslip.formats.meshes.read import _FORMATS; find, names = _FORMATS.find, _FORMATS.names",
        ),
    ],
)
def test_an_installed_package_offers_its_own(tmp_path: Path, group: str, name: str, code: str) -> None:
    """A package that is only on the path: its entry point is listed, and found by name."""
    (tmp_path / "elsewhere.py").write_text("def make():\n    return 'made elsewhere'\n", encoding="utf-8")
    information = tmp_path / "elsewhere-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: elsewhere\nVersion: 1.0\n", encoding="utf-8")
    entry = f"[stickslip.{group}]\n{name} = elsewhere:make\n"
    (information / "entry_points.txt").write_text(entry, encoding="utf-8")
    text = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{code}\n"
    text += f"assert {name!r} in names()\nprint(find({name!r})())"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False)
    assert done.stdout == "made elsewhere\n", done.stderr
