"""Imports run one way, as ARCHITECTURE.md promises, the command line answers without the heavy packages, and no word of
the published study stands outside of its room."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import stickslip

SOURCE = Path(stickslip.__file__).parent
ROOT = "stickslip"

# Rooms and the rooms that each may import from, directly. A room that is not here does not exist: see the first test.
_PHYSICS = ("core", "structure", "contact", "results", "solve")
MAY_IMPORT: dict[str, tuple[str, ...]] = {
    "core": (),
    # A study file gives the constants of the law that it names, and the law declares them.
    "case": ("core", "contact"),
    "structure": ("core",),
    "contact": ("core", "structure"),
    "formats": ("core", "structure"),
    "results": ("core", "contact"),
    "solve": ("core", "structure", "contact", "results"),
    "reporting": ("core", "structure", "contact", "results"),
    "model": (*_PHYSICS, "case", "formats"),
    "study": (*_PHYSICS, "case", "formats", "reporting", "model"),
    "sweeps": (*_PHYSICS, "case", "reporting", "model", "study"),
    "papers": (*_PHYSICS, "case", "reporting", "model", "study", "sweeps"),
    "cli": (*_PHYSICS, "case", "formats", "reporting", "model", "study", "sweeps", "papers"),
    "__main__": ("cli",),  # a single module, for python -m stickslip
}

HEAVY = (
    "numpy",
    "scipy",
    "numba",
    "matplotlib",
    "plotly",
    "xarray",
    "pint",
    "skfem",
    "meshio",
    "h5py",
    "pydantic",
    "jinja2",
    "openpyxl",
)


@cache
def public_homes() -> dict[str, str]:
    """Public name -> the module that defines it, from the list in ``__init__.pyi``."""
    tree = ast.parse((SOURCE / "__init__.pyi").read_text(encoding="utf-8"))
    actual = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: node.module or "" for node in actual for alias in node.names}


@cache
def modules() -> dict[str, Path]:
    """Dotted name below the package ("" for the package itself) -> file."""
    result = {}
    for path in SOURCE.rglob("*.py"):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        result[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return result


@cache
def imports(module: str, at_once: bool = False) -> frozenset[str]:
    """Modules of this package that ``module`` imports: anywhere, also inside functions and for type checkers, or only
    those that are imported ``at_once`` with it."""
    tree = ast.parse(modules()[module].read_text(encoding="utf-8"))
    return frozenset(_imports(tree.body if at_once else ast.walk(tree)))


def _imports(nodes: Iterable[ast.AST]) -> Iterator[str]:
    reference = modules()
    for node in nodes:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            names = [_home(node.module or "", alias.name, reference) for alias in node.names]
            names = [name for name in names if name != ROOT]  # what the package itself holds, such as __version__
        else:
            continue
        for name in names:
            if name == ROOT or name.startswith(f"{ROOT}."):
                yield name.removeprefix(ROOT).removeprefix(".")


def _home(base: str, name: str, known: dict[str, Path]) -> str:
    """The module that ``from base import name`` needs: ``base.name``, the home of a public name, or ``base``."""
    full = f"{base}.{name}"
    if full.removeprefix(f"{ROOT}.") in known:
        return full
    if base == ROOT and name in public_homes():
        return f"{ROOT}.{public_homes()[name]}"
    return base


def reached(module: str, at_once: bool = False) -> set[str]:
    """Everything that ``module`` imports, directly or not."""
    seen: set[str] = set()
    waiting = [module]
    while waiting:
        for name in imports(waiting.pop(), at_once) - seen:
            seen.add(name)
            waiting.append(name)
    return seen


def room(module: str) -> str:
    """The room of a module; "" is the package itself."""
    return module.split(".")[0]


def within(module: str, packages: tuple[str, ...]) -> bool:
    """Whether ``module`` is one of ``packages`` or below one."""
    return any(module == name or module.startswith(f"{name}.") for name in packages)


def misplaced(module: str, imported: Iterable[str]) -> list[str]:
    """Those of the ``imported`` modules that the room of ``module`` may not import from."""
    allowed = (room(module), *MAY_IMPORT[room(module)])
    return sorted(name for name in imported if room(name) not in allowed)


def circle(arrows: Mapping[str, Iterable[str]]) -> list[str]:
    """A circle of modules that import each other, in order; empty where there is none."""
    try:
        TopologicalSorter({name: set(targets) - {name} for name, targets in arrows.items()}).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_the_rooms_are_exactly_these_and_none_is_empty() -> None:
    rooms = {room(module) for module in modules() if module}
    assert rooms == set(MAY_IMPORT)
    for name in MAY_IMPORT.keys() - {"__main__"}:
        assert [module for module in modules() if room(module) == name and module != name], name


def test_rooms_know_each_other_one_way() -> None:
    assert circle(MAY_IMPORT) == []


@pytest.mark.slow
@pytest.mark.parametrize("module", sorted(set(modules()) - {""}))
def test_imports_run_one_way(module: str) -> None:
    assert misplaced(module, imports(module)) == []


@pytest.mark.slow
def test_no_circle_of_imports_not_even_inside_functions() -> None:
    assert circle({module: imports(module) for module in modules()}) == []


@pytest.mark.slow
def test_contact_knows_no_elements() -> None:
    # A face is made of cell sides: their points, areas, directions and shape functions, and no cell behind them.
    of_faces = ("structure.faces", "structure.side_parts", "structure.shapes")
    allowed = ("core", "contact", "structure.mesh", "structure.superelement", "structure.export", *of_faces)
    for module in modules():
        if room(module) == "contact":
            assert [name for name in imports(module) if not within(name, allowed)] == [], module


@pytest.mark.slow
def test_solve_never_sees_a_mesh() -> None:
    dense = ("superelement", "substructure", "rotating_superelement", "gyroscopic", "cyclic_sector", "blade_alone")
    allowed = ("core", "solve", "contact", "results", *(f"structure.{name}" for name in dense))
    for module in modules():
        if room(module) == "solve":
            assert [name for name in imports(module) if not within(name, allowed)] == [], module
            assert "structure.mesh" not in reached(module), module


@pytest.mark.slow
@pytest.mark.parametrize("package", ["results", "reporting"])
def test_results_and_report_never_solve(package: str) -> None:
    for module in modules():
        if room(module) == package:
            assert [name for name in reached(module) if within(name, ("solve", "study"))] == [], module


def test_the_rules_can_fail() -> None:
    tree = ast.parse(
        "import stickslip\nfrom stickslip import Mesh\n"
        "def f():\n    from stickslip import cli\n    from stickslip.core.errors import InputError\n"
    )
    assert set(_imports(ast.walk(tree))) == {"", "structure.mesh", "cli", "core.errors"}
    assert set(_imports(tree.body)) == {"", "structure.mesh"}
    assert misplaced("solve.forced", ["structure.superelement", "study.run"]) == ["study.run"]
    assert set(circle({"a": ["b"], "b": ["c"], "c": ["a"], "d": ["a"]})) == {"a", "b", "c"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "allowed"),
    [
        ("import stickslip", ()),
        ("import stickslip.cli.main", ()),
        ("import sys; sys.argv = ['stickslip', '--help']; from stickslip.cli.main import main; main()", ()),
        ("from stickslip.case.case import Case; Case().solver", ("pydantic",)),
    ],
)
def test_heavy_packages_wait_until_they_are_needed(code: str, allowed: tuple[str, ...]) -> None:
    loaded = f"print(*[name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    check = f"import atexit, sys; atexit.register(lambda: {loaded})"
    result = subprocess.run([sys.executable, "-c", f"{check}; {code}"], capture_output=True, text=True, check=True)
    assert set(result.stderr.split()) <= set(allowed)


@pytest.mark.parametrize("name", stickslip.__all__)
def test_public_name_is_there(name: str) -> None:
    assert name in dir(stickslip)
    assert getattr(stickslip, name) is not None


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="stick"):
        stickslip.stick  # type: ignore[attr-defined]  # noqa: B018


# The room of the study, and the command line, which has a command of its name.
ITS_ROOMS = ("papers", "cli")
ENDINGS = (".py", ".pyi", ".html", ".css", ".js", ".csv", ".toml")

# A paper, also within a longer name; its Table 2, also as the name of a column; what only its geometry is.
_WORD = re.compile(r"papers?|table[ _]?\d|\binferred\b|\berrat(?:um|a)\b|\bas printed\b", re.IGNORECASE)
# An equation, table or figure by its number; right only behind its source, as in "Segalman (2005), eq. 12".
_NUMBERED = re.compile(r"\b(?:eqs?\.?|equations?|tables?|fig(?:ure|s)?\.?)[ ~]*\(?\d", re.IGNORECASE)
_SOURCE = re.compile(r"\b(?:1[89]|20)\d\d\)?[^.;]*$")

# File -> the text around a word that may stay there, and why.
ALLOWED = {
    # the other paper, which printers take
    "reporting/structure_still.py": ("still picture, for paper and for browsers",),
    "reporting/sweep_view.py": ("invisible on white paper",),
    "reporting/look.py": ('"paper_bgcolor":',),  # plotly's name of the ground of a figure
    "sweeps/work.py": ('package / name for name in ("papers", "reporting")',),  # the room
    # names of earlier versions, in study files and in results files
    "case/sections.py": (
        '"paper" is the earlier name of "varying-curvature"',
        'Respelled("paper", "varying-curvature")',
    ),
    "results/record.py": ('EARLIER_REFERENCE = ("table2_hz",',),
}


def foreign_words(text: str, allowed: tuple[str, ...] = ()) -> list[str]:
    """The lines of a text that have a word of the study, outside of what is allowed."""
    for each in allowed:
        text = text.replace(each, "")
    return [line.strip() for line in text.splitlines() if _WORD.search(line)] + list(_without_source(text))


def _without_source(text: str) -> Iterator[str]:
    for actual in _NUMBERED.finditer(text):
        before = text[max(0, actual.start() - 100) : actual.start()]
        if not _SOURCE.search(before):
            yield f"{before.splitlines()[-1] if before else ''}{actual.group()}".strip()


def general_files() -> dict[str, str]:
    """Path -> text of each file that belongs to no room of the study."""
    actual = (path for path in sorted(SOURCE.rglob("*")) if path.suffix in ENDINGS)
    named = {path.relative_to(SOURCE).as_posix(): path for path in actual}
    return {name: path.read_text("utf-8") for name, path in named.items() if name.split("/")[0] not in ITS_ROOMS}


@pytest.mark.slow
def test_no_word_of_the_published_study_outside_of_its_room() -> None:
    files = general_files()
    assert len(files) > 150
    for name, text in files.items():
        assert foreign_words(text, ALLOWED.get(name, ())) == [], name
        assert not _WORD.search(name), name


def test_every_exception_is_still_needed() -> None:
    files = general_files()
    for name, allowed in ALLOWED.items():
        for words in allowed:
            assert words in files[name], f"{name}: {words}"
            assert foreign_words(words), f"{name}: {words}"


@pytest.mark.parametrize(
    "text",
    [
        "    paper_full_hz: float | None",
        'cells["table2_hz"] = row.full_hz',
        "against Table 2, %",
        "the geometry is inferred",
        'mode == "paper"',
        "equation (8) read with d",
        "see Figure 4",
        "Published in 2005. Here eq. 12 is used",
    ],
)
def test_a_word_that_returns_is_found(text: str) -> None:
    assert foreign_words(f"first line\n{text}\nlast line")


@pytest.mark.parametrize(
    "text", ["Segalman (2005), eq. 12", "Jaeger 1942,\n    equation 3", "two equations", "tables of 3"]
)
def test_a_citation_with_its_year_may_stay(text: str) -> None:
    assert foreign_words(text) == []


SUBSTRUCTURES = {"Structure", "RotatingBodies", "SectorStructure", "Superelement", "CyclicSector"}


def asked_classes(text: str) -> set[str]:
    """Names of the classes in all ``isinstance`` of a module."""
    calls = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call))
    asked = (call.args[1] for call in calls if isinstance(call.func, ast.Name) and call.func.id == "isinstance")
    return {node.id for each in asked for node in ast.walk(each) if isinstance(node, ast.Name)}


@pytest.mark.slow
def test_studies_never_ask_which_structure_it_is() -> None:
    """A structure answers itself (structure/substructure.py, model/study_structure.py); the kinds of study make it."""
    assert asked_classes("isinstance(a, Superelement | Mesh) or isinstance(b, (int, str))") == {
        "Superelement", "Mesh", "int", "str",
    }  # fmt: skip
    chosen = [m for m in modules() if room(m) in ("model", "study", "sweeps") and not m.startswith("model.kinds.")]
    assert len(chosen) > 20
    for module in chosen:
        assert asked_classes(modules()[module].read_text(encoding="utf-8")) & SUBSTRUCTURES == set(), module
