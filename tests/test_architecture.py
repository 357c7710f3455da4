"""Imports run one way, as docs/design.md promises, and the command line answers without the heavy packages."""

import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

import stickslip

SOURCE = Path(stickslip.__file__).parent
ROOT = "stickslip"

# A module imports from its own layer or from layers that stand before it; layers in one row do not know each other.
ROWS = (
    (
        "errors",
        "validation",
        "fourier",
        "progress",
        "reference",
        "files",
        "threads",
        "plausible",
        "terminal",
        "input_files",
    ),
    ("structure",),
    ("interface",),
    ("results",),
    ("solve", "report"),
    ("case",),
    ("study",),
    ("sweeps",),
    ("paper",),
    ("cli", ""),
)
LAYER_OF = {
    "units": "case",
    "template": "case",
    "case_file": "case",
    "case_sections": "case",
    "case_structure": "case",
    "case_fit": "case",
    "case_values": "case",
    "case_examples": "case",
    "profile_file": "case",
    "measured_roughness": "study",
    "facts": "study",
    "model_listing": "study",
    "drawing": "study",
    "setup": "study",
    "joint": "study",
    "two_blade": "study",
    "own_structure": "study",
    "joint_overlap": "study",
    "mesh_study": "study",
    "matrix_study": "study",
    "cli_errors": "cli",
    "model": "study",
    "solved_preload": "study",
    "sketching": "study",
}
BASE = ROWS[0]

HEAVY = ("numpy", "scipy", "numba", "matplotlib", "plotly", "xarray", "pint", "skfem", "meshio", "h5py", "pydantic")


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
    if base == ROOT and name in stickslip._HOME:
        return f"{ROOT}.{stickslip._HOME[name]}"
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


def layer(module: str) -> str:
    """The layer of a module: its first part, or the layer that it was given above."""
    first = module.split(".")[0]
    return LAYER_OF.get(first, first)


def row(module: str) -> int:
    """How high a module stands."""
    return next(i for i, names in enumerate(ROWS) if layer(module) in names)


def within(module: str, packages: tuple[str, ...]) -> bool:
    """Whether ``module`` is one of ``packages`` or below one."""
    return any(module == name or module.startswith(f"{name}.") for name in packages)


@pytest.mark.parametrize("module", sorted(modules()))
def test_imports_run_one_way(module: str) -> None:
    wrong = [
        name
        for name in imports(module)
        if row(name) > row(module) or (row(name) == row(module) != 0 and layer(name) != layer(module))
    ]
    assert wrong == []


@pytest.mark.parametrize("module", sorted(modules()))
def test_no_module_imports_itself_in_a_circle(module: str) -> None:
    assert module not in reached(module, at_once=True)


def test_interface_knows_no_elements() -> None:
    # A face is made of cell sides: their points, areas, directions and shape functions, and no cell behind them.
    of_faces = ("structure.faces", "structure.side_parts", "structure.shapes", "structure.finite_element_mesh")
    allowed = (*BASE, "interface", "structure.mesh", "structure.superelement", "structure.export", *of_faces)
    for module in modules():
        if layer(module) == "interface":
            assert [name for name in imports(module) if not within(name, allowed)] == [], module


def test_solve_never_sees_a_mesh() -> None:
    allowed = (*BASE, "solve", "interface", "results", "structure.superelement")
    for module in modules():
        if layer(module) == "solve":
            assert [name for name in imports(module) if not within(name, allowed)] == [], module
            assert "structure.mesh" not in reached(module), module


@pytest.mark.parametrize("package", ["results", "report"])
def test_results_and_report_never_solve(package: str) -> None:
    for module in modules():
        if layer(module) == package:
            assert [name for name in reached(module) if within(name, ("solve", "study"))] == [], module


def test_the_rule_can_fail() -> None:
    tree = ast.parse(
        "import stickslip\nfrom stickslip import Mesh\n"
        "def f():\n    from stickslip import cli\n    from stickslip.core.errors import InputError\n"
    )
    assert set(_imports(ast.walk(tree))) == {"", "structure.mesh", "cli", "errors"}
    assert set(_imports(tree.body)) == {"", "structure.mesh"}
    assert row("cli") > row("case_file") > row("results.response") > row("interface.friction")


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
    with pytest.raises(AttributeError, match="no attribute 'stick'"):
        stickslip.stick  # noqa: B018


def test_report_is_the_verb_and_the_package() -> None:
    code = (
        "import stickslip, sys, types; from stickslip import report; import stickslip.reporting as package;"
        "assert stickslip.reporting is report is package;"
        "study = types.ModuleType('stickslip.study.run'); study.report = lambda path: ('made', path);"
        "sys.modules['stickslip.study.run'] = study;"
        "assert stickslip.report('DIR') == ('made', 'DIR')"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
