"""The files around the code agree with it: version, change log, make targets, pinned tools, continuous integration."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

import stickslip

ROOT = Path(__file__).parents[1]
# A changelog entry is one line; longer ones tell how instead of what.
LONGEST_ENTRY = 130


def text(name: str) -> str:
    """A file at the top level."""
    return (ROOT / name).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def project() -> dict[str, Any]:
    """pyproject.toml."""
    return tomllib.loads(text("pyproject.toml"))


def test_the_version_is_in_one_place(project: dict[str, Any]) -> None:
    assert "version" not in project["project"]
    assert project["project"]["dynamic"] == ["version"]
    source = text(project["tool"]["hatch"]["version"]["path"])
    assert re.findall(r'^__version__ = "(.+)"$', source, flags=re.MULTILINE) == [stickslip.__version__]


def test_the_citation_names_the_version() -> None:
    actual = re.findall(r"^version: (.+)$", text("CITATION.cff"), flags=re.MULTILINE)
    assert actual == [stickslip.__version__]


def test_the_changelog_has_one_line_for_each_change() -> None:
    log = text("CHANGELOG.md")
    assert "## [Unreleased]" in log
    body = log.split("## [Unreleased]")[1].splitlines()
    for line in filter(None, body):
        assert re.match(r"- |#", line), f"continues the entry before: {line}"
        assert len(line) <= LONGEST_ENTRY, line


def test_make_help_lists_every_target() -> None:
    makefile = text("Makefile")
    targets = re.search(r"^\.PHONY: (.+)$", makefile, flags=re.MULTILINE)
    assert targets
    listed = re.findall(r'^\t@echo "make (\w+)', makefile, flags=re.MULTILINE)
    assert sorted({"help", *listed}) == sorted(targets.group(1).split())


def test_tools_of_development_are_pinned(project: dict[str, Any]) -> None:
    pinned = {line.split("==")[0].lower() for line in text("constraints.txt").splitlines() if "==" in line}
    for name, group in project["dependency-groups"].items():
        for requirement in (each for each in group if isinstance(each, str)):
            package = re.match(r"[\w.-]+", requirement)
            assert package
            assert package.group().lower() in pinned, f"{requirement} of the group {name}"


def test_continuous_integration_runs_the_versions_that_the_package_promises(project: dict[str, Any]) -> None:
    promised = [words.rsplit(" ", 1)[1] for words in project["project"]["classifiers"] if ":: 3." in words]
    workflow = text(".github/workflows/ci.yml")
    listed = re.search(r"python: \[(.+)\]", workflow)
    assert listed
    assert re.findall(r"[\d.]+", listed.group(1)) == promised
    assert project["project"]["requires-python"] == f">={promised[0]}"
    for words in ("ubuntu-latest", "macos-latest", "windows-latest", "make check", "make test"):
        assert words in workflow


@pytest.mark.long
def test_every_room_has_quick_tests() -> None:
    """``make check`` touches each folder of tests that mirrors the code."""
    for folder in sorted((ROOT / "src" / "stickslip").iterdir()):
        if not (folder / "__init__.py").is_file():
            continue
        quick = 0
        for path in (ROOT / "tests" / folder.name).rglob("test_*.py"):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            if any(ast.unparse(line).startswith("pytestmark = pytest.mark.") for line in tree.body):
                continue
            tests = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]
            marks = [{ast.unparse(each) for each in test.decorator_list} for test in tests]
            quick += sum(not {"pytest.mark.slow", "pytest.mark.long"} & each for each in marks)
        assert quick >= 5, f"{folder.name}: {quick} quick tests"


@pytest.mark.slow
def test_the_architecture_names_every_room_and_no_file_that_is_gone() -> None:
    page = text("ARCHITECTURE.md")
    source = ROOT / "src" / "stickslip"
    for room in (folder.name for folder in source.iterdir() if (folder / "__init__.py").is_file()):
        assert f"`{room}`" in page, room
    for path in re.findall(r"`((?:\w+/)+\w+\.(?:pyi?|md|html))`", page):
        assert [*source.rglob(path), *ROOT.glob(path)], path
    for path in re.findall(r"\]\(([^)#]+)\)", page):
        assert (ROOT / path).is_file(), path


@pytest.mark.slow
def test_documents_name_files_that_there_are() -> None:
    there = [
        f"/{path.relative_to(ROOT).as_posix()}"
        for folder in ("src", "tests", "benchmarks", "examples", "docs", "tools")
        for path in (ROOT / folder).rglob("*.py")
    ]
    for document in (
        *sorted(ROOT.glob("docs/*.md")),
        *(ROOT / name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md")),
    ):
        named = re.findall(r"`([\w/]*\w\.py)`", document.read_text(encoding="utf-8"))
        missing = [name for name in named if not any(path.endswith(f"/{name}") for path in there)]
        assert not missing, f"{document.name}: {missing}"
