"""Imports run one way, as ARCHITECTURE.md promises, and the command line answers without the heavy packages."""

import ast
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
)


@cache
def public_homes() -> dict[str, str]:
    """Public name -> the module that defines it, from the list in ``__init__.pyi``."""
    tree = ast.parse((SOURCE / "__init__.pyi").read_text(encoding="utf-8"))
    found = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: node.module or "" for node in found for alias in node.names}


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
    known = modules()
    for node in nodes:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            names = [_home(node.module or "", alias.name, known) for alias in node.names]
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
    for name in MAY_IMPORT:
        assert [module for module in modules() if room(module) == name and module != name], name


def test_rooms_know_each_other_one_way() -> None:
    assert circle(MAY_IMPORT) == []


@pytest.mark.slow
@pytest.mark.parametrize("module", sorted(set(modules()) - {""}))
def test_imports_run_one_way(module: str) -> None:
    assert misplaced(module, imports(module)) == []


def test_no_circle_of_imports_not_even_inside_functions() -> None:
    assert circle({module: imports(module) for module in modules()}) == []


def test_contact_knows_no_elements() -> None:
    # A face is made of cell sides: their points, areas, directions and shape functions, and no cell behind them.
    of_faces = ("structure.faces", "structure.side_parts", "structure.shapes", "structure.finite_element_mesh")
    allowed = ("core", "contact", "structure.mesh", "structure.superelement", "structure.export", *of_faces)
    for module in modules():
        if room(module) == "contact":
            assert [name for name in imports(module) if not within(name, allowed)] == [], module


@pytest.mark.slow
def test_solve_never_sees_a_mesh() -> None:
    allowed = ("core", "solve", "contact", "results", "structure.superelement")
    for module in modules():
        if room(module) == "solve":
            assert [name for name in imports(module) if not within(name, allowed)] == [], module
            assert "structure.mesh" not in reached(module), module


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
