"""Fixtures that all tests share."""

from __future__ import annotations

import functools
import gc
import os
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import typer.main

# Numerical packages are imported by fixtures: the process that only distributes tests has no use for them.
if TYPE_CHECKING:
    from helpers import Blade
    from stickslip.core.registry import Registry

pytest_plugins = ("pytester", "sentences", "structure_fixtures")


TESTS = Path(__file__).parent
# The tracer of the coverage makes tests 1.7 times slower. Slow tests of these files, or with these names, run lines
# that others cover, as coverage with contexts of tests shows; commands that they start are traced nevertheless.
UNTRACED = (
    "contact/", "solve/", "structure/", "model/kinds/test_gmsh_study.py", "model/test_solved_preload.py",
    "reporting/test_", "test_benchmarks.py", "test_examples.py", "test_guide.py", "test_site.py",
    "test_architecture.py", "core/test_units.py", "formats/test_calculix_deck.py", "results/test_response.py",
    "model/kinds/test_mesh_study.py",
    "case/test_extreme_values.py::test_values_that_no_computer_can_use",
    "case/test_extreme_values.py::test_the_check_of_a_study",
    "model/kinds/test_matrix_study.py::test_run_writes",
    "model/test_laws_of_studies.py::test_a_cubic_spring",
    "model/test_laws_of_studies.py::test_interfaces_follow",
    "model/test_laws_of_studies.py::test_laws_of_a_study_under",
    "model/test_model.py::test_default_sizes",
    "model/test_open_at_rest.py::test_a_sweep_compares",
    "results/test_storage.py::test_flipped_bits",
    "study/test_drawing.py::test_the_second_process",
    "study/test_study.py::test_a_reference",
    "study/test_study.py::test_an_unfinished_curve",
    "study/test_study.py::test_the_curve_is_the_same",
)  # fmt: skip


# What is imported and collected remains until the tests end, so the collector of garbage does not
# search it.
gc.disable()


def pytest_collection_finish() -> None:
    """The collector of garbage begins its work with the tests."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long tests are slow ones too; slow tests of :data:`UNTRACED` run without the tracer; files with many slow tests
    run first, so that the processes of the tests end together."""
    slow: Counter[Path] = Counter()
    for item in items:
        if item.get_closest_marker("long"):
            item.add_marker("slow")
        if item.get_closest_marker("slow"):
            slow[item.path] += 1
            if item.path.is_relative_to(TESTS):
                name = f"{item.path.relative_to(TESTS).as_posix()}::{item.name}"
                if name.startswith(UNTRACED):
                    item.add_marker("no_cover")
    items.sort(key=lambda item: -slow[item.path])


@pytest.fixture(scope="session", autouse=True)
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Tests keep reduced structures in a folder of their own, one for all processes of the tests; commands that they
    start inherit it."""
    run = tmp_path_factory.getbasetemp()
    folder = (run.parent if "PYTEST_XDIST_WORKER" in os.environ else run) / "cache"
    folder.mkdir(exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STICKSLIP_CACHE", str(folder))
        yield folder


@pytest.fixture(scope="session", autouse=True)
def command_line() -> Iterator[None]:
    """The commands of a program are built once, not for each call of a test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("typer.testing._get_command", functools.cache(typer.main.get_command))
        yield


@pytest.fixture
def untraced_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes that the test starts run without the tracer: others of its file start the same ones with it."""
    from helpers import unmeasured

    for name in sorted(os.environ.keys() - unmeasured().keys()):
        monkeypatch.delenv(name)


@pytest.fixture(autouse=True)
def registered_names() -> Iterator[None]:
    """What a test registers is gone after it: messages that list names do not depend on the order of the tests."""
    from stickslip.contact.law import registry as contact_laws
    from stickslip.contact.stiffness import registry as stiffness_laws
    from stickslip.formats.meshes import read as model_formats

    registries: list[Registry[Any]] = [contact_laws._LAWS, stiffness_laws._LAWS, model_formats._FORMATS]
    before = [dict(each._makers) for each in registries]
    yield
    for registry, makers in zip(registries, before, strict=True):
        registry._makers.clear()
        registry._makers.update(makers)


@pytest.fixture(autouse=True)
def no_stand_in_remains() -> Iterator[None]:
    """A test fails if the package holds an object of a test after it.

    A module that is first imported while a test replaces a function of another one keeps the stand-in under the name
    that it imports, and every later test of the process runs with it.
    """
    before = set(sys.modules)
    yield
    new = sorted(name for name in sys.modules.keys() - before if name.partition(".")[0] == "stickslip")
    if not new:
        return
    of_tests = {name for name, module in sys.modules.items() if str(TESTS) in str(getattr(module, "__file__", ""))}
    held = [
        f"{name}.{attribute} is of {value.__module__}"
        for name in new
        for attribute, value in vars(sys.modules[name]).items()
        if getattr(value, "__module__", None) in of_tests
    ]
    assert not held, f"import these modules before the test replaces a part of the package: {held}"


@pytest.fixture(scope="session")
def blade() -> Blade:
    """The bench problem with ten contacts."""
    from helpers import Blade

    return Blade()
