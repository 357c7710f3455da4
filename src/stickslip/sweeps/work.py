"""Tasks of a worker, as plain functions of plain data: any executor can run them, on this machine or another.

Cases with the same structure have one reduction (``ReducedStructure``): one task makes it, the tasks of the cases
receive it without the large recovery matrix. For the stress at its peak a task uses the full structure of its process
(:mod:`stickslip.sweeps.full_structure`). A worker writes no file; it returns the bytes of the results file.
"""

from __future__ import annotations

import os
import pickle
import socket
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from stickslip import __version__
from stickslip.case.case import Case
from stickslip.core.errors import StickslipError, WorkersError
from stickslip.core.files import source_digest
from stickslip.model.joint import Joint
from stickslip.model.layout import Setup
from stickslip.model.model import connect, reduce_structure
from stickslip.model.study_structure import ReducedStructure
from stickslip.results.band import STRESS_MEASURES
from stickslip.results.storage import results_bytes
from stickslip.results.sweep_table import SweepCurve, curve_and_measures
from stickslip.study.analyses import AGAIN_BECAUSE, SOLVED_AGAIN, solve
from stickslip.study.record import compare_modes, study_record
from stickslip.study.stress import largest_stresses_at_peak
from stickslip.sweeps.full_structure import full_structure
from stickslip.sweeps.task_reports import TaskProgress

# Entry of a results file's provenance with the hash of inputs and version.
CASE_KEY = "sweep_case"
# Entry of the details of an outcome with the most harmonics of its curve.
HARMONICS = "harmonics"


@dataclass(frozen=True)
class CaseTask:
    """One case to solve: ``key`` is stored with its results; ``wants_file`` requests the bytes of a results file.

    ``checks`` and ``harmonics`` as :func:`stickslip.study.analyses.solve` has them.

    ``name`` is that of the case in reports on the running task. ``stress_of`` is the hash of its structure, if the
    stress at its peak is wanted; None for none.
    """

    case: Case
    key: str
    joint: Joint
    threads: int
    wants_file: bool
    checks: bool = field(default=True, kw_only=True)
    harmonics: int | None = field(default=None, kw_only=True)
    name: str = field(default="case", kw_only=True)
    stress_of: str | None = field(default=None, kw_only=True)


@dataclass(frozen=True, eq=False)
class CaseOutcome:
    """The outcome of a case. Without a result ``curve`` is None, ``measures`` is empty, and ``message`` is the
    reason. ``details`` are further results as plain data for JSON: the harmonics of the curve and the reason why it was
    solved again, or the gradients of a design."""

    converged: bool
    message: str
    measures: Mapping[str, float]
    curve: SweepCurve | None = None
    warnings: tuple[str, ...] = ()
    file: bytes = b""
    details: Mapping[str, Any] = field(default_factory=dict)


@cache
def code_digest() -> str:
    """Digest of the code that determines a result, see :func:`answering_files`."""
    return source_digest(answering_files())


def answering_files() -> list[Path]:
    """Every module of the package except those of the folders that only show results.

    A test ensures that a worker which solves a case imports none of the others.
    """
    package = Path(__file__).parents[1]
    shown = tuple(package / name for name in ("papers", "reporting"))
    return [file for file in package.rglob("*.py") if not any(map(file.is_relative_to, shown))]


def worker_version() -> str:
    """Version and code of stickslip where the tasks run; an answer also shows that a worker runs at all."""
    return f"{__version__} (code {code_digest()[:12]})"


@dataclass(frozen=True)
class Parcel:
    """A task for a worker. Its content stays pickled until the worker has checked that it runs the same code."""

    version: str
    content: bytes


def parcel(task: Callable[..., Any], *arguments: Any) -> Parcel:
    """Pack a call of a function of a module."""
    return Parcel(worker_version(), pickle.dumps((task, arguments)))


def open_parcel(received: Parcel) -> Any:
    """Run the task of a parcel. Raises WorkersError if the code is not that of the sender."""
    if received.version != worker_version():
        raise WorkersError(
            f"the worker on {socket.gethostname()} (process {os.getpid()}) runs stickslip {worker_version()}, but the "
            f"sweep runs {received.version}. Install the same version there, or stop that worker."
        )
    task, arguments = pickle.loads(received.content)
    return task(*arguments)


def reduce_task(case: Case, setup: Setup, threads: int) -> ReducedStructure:
    """Assemble and reduce the structure of a case; without its recovery. Raises InputError."""
    # Several workers run on a machine: more threads than their own would hinder each other.
    with threadpool_limits(limits=threads):
        structure = setup.assemble()
        reduced = reduce_structure(case, structure, setup.layout)
        # The cases of one reduction for several speeds have no common table.
        shared = reduced.speeds is None
        table = compare_modes(structure, reduced.substructure, setup.layout.face_pairs) if shared else ()
    return replace(reduced.without_recovery(), mode_table=table)


def solve_task(task: CaseTask, reduced: ReducedStructure) -> CaseOutcome:
    """Solve one case; an error of stickslip becomes the message of an outcome."""
    try:
        with threadpool_limits(limits=task.threads):
            return _solved(task, reduced)
    except StickslipError as error:
        return CaseOutcome(converged=False, message=str(error), measures={})


def _solved(task: CaseTask, reduced: ReducedStructure) -> CaseOutcome:
    full = None
    if task.stress_of is None:
        model = connect(task.case, reduced, task.joint)
    else:  # the motion in the unknowns of the reduction whose recovery gives the stress
        model = full = full_structure(task.stress_of, task.case, task.threads).model(task.case, task.joint)
    progress = TaskProgress(task.name)
    response = solve(task.case, model, progress, threads=task.threads, checks=task.checks, harmonics=task.harmonics)
    response = replace(response, provenance={**response.provenance, CASE_KEY: task.key})
    # The common table of the cases of a structure has every pair closed.
    table = reduced.mode_table if model.pairs.resting_stiffness().all() else ()
    record = study_record(task.case, model, table, response)
    curve, measures = curve_and_measures(response, record)
    if full is not None and response.converged:
        stresses = largest_stresses_at_peak(task.case, full, response)
        measures |= {STRESS_MEASURES[name].column: value for name, value in stresses.items()}
    content = results_bytes(response, record) if task.wants_file else b""
    warnings = (*record.warnings, *response.warnings)
    details: dict[str, Any] = {HARMONICS: response.harmonics}
    if SOLVED_AGAIN in response.settings:
        details |= {name: response.settings[name] for name in (SOLVED_AGAIN, AGAIN_BECAUSE)}
    return CaseOutcome(response.converged, response.message, measures, curve, warnings, content, details)
