"""The packages of an environment: each held by constraints.txt, with its licence in docs/licences.md."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]
# The file is that of this platform; others need a few packages more or less.
HELD_HERE = pytest.mark.skipif(
    sys.platform != "linux" or sys.version_info[:2] != (3, 11), reason="constraints.txt is for Linux and Python 3.11"
)


@pytest.fixture
def tools(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    return importlib.import_module("packages")


@pytest.mark.slow
@HELD_HERE
def test_every_installed_package_is_pinned(tools: ModuleType) -> None:
    """All that the project, its extras and the group dev need, directly or not."""
    actual = tools.installed(tools.requirements(dev=True, extras=True))
    assert {"numpy", "pandas", "pytest", "python-dateutil"} <= actual.keys()
    versions = {name: package.version for name, package in actual.items()}
    held = tools.pins()
    assert {name: held.get(name) for name in versions} == versions


def test_every_requirement_is_pinned_to_a_version_that_it_allows(tools: ModuleType) -> None:
    """Also of extras and of the build, which need not be installed."""
    from packaging.requirements import Requirement

    wanted = [*tools.requirements(dev=True, extras=True), "hatchling>=1.25", "pip"]
    held = tools.pins()
    for each in map(Requirement, wanted):
        assert each.specifier.contains(held[tools.plain(each.name)]), each


@pytest.mark.slow
def test_pinned_versions_install_on_the_oldest_python(tools: ModuleType) -> None:
    """On 3.11.0: Debian 12 has 3.11.2, and one pinned tool wanted 3.11.5."""
    from packaging.specifiers import SpecifierSet

    packages = tools.installed(tools.requirements(dev=True, extras=True))
    wanted = {name: package.metadata.get("Requires-Python") or "" for name, package in packages.items()}
    assert len(wanted) > 50
    assert {name: text for name, text in wanted.items() if "3.11.0" not in SpecifierSet(text)} == {}


def test_no_package_is_pinned_twice(tools: ModuleType) -> None:
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    assert len([line for line in lines if not line.startswith("#")]) == len(tools.pins())


@pytest.mark.slow
@HELD_HERE
def test_the_file_with_hashes_contains_the_same_versions(tools: ModuleType) -> None:
    lines = (ROOT / "requirements-hashed.txt").read_text(encoding="utf-8").splitlines()
    rows = [
        re.fullmatch(r"(\S+)==(\S+) --hash=sha256:([0-9a-f]{64})", line) for line in lines if not line.startswith("#")
    ]
    hashed = {tools.plain(row[1]): row[2] for row in rows if row is not None}
    assert len(hashed) == len(rows)
    held = tools.pins()
    assert {name: held[name] for name in hashed} == hashed
    assert hashed.keys() == tools.installed(tools.requirements(dev=True)).keys()


@pytest.mark.slow
@HELD_HERE
def test_the_licences_are_those_of_the_packages(tools: ModuleType) -> None:
    page = importlib.import_module("make_licences").table()
    assert (ROOT / "docs" / "licences.md").read_text(encoding="utf-8") == page, "run: python tools/make_licences.py"


@pytest.mark.slow
def test_no_package_of_the_default_set_is_under_the_gpl(tools: ModuleType) -> None:
    for name, package in tools.installed(tools.requirements()).items():
        words = tools.licence(package)
        assert words != "not stated", name
        # LGPL is allowed, and stated: the page is that of the metadata
        assert not re.search(r"\bA?GPL|Affero|(?<!Lesser )General Public", words), f"{name}: {words}"
