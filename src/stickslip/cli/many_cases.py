"""Common parts of the commands that solve a study file, or many cases of it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from os.path import relpath
from typing import TYPE_CHECKING

import typer

from stickslip.core.errors import InputError, OutputError, ResultsFileError
from stickslip.core.progress import terminal_progress
from stickslip.core.terminal import echo

if TYPE_CHECKING:
    from pathlib import Path

    from stickslip.case.case import Case
    from stickslip.case.toml_text import KeyPositions
    from stickslip.core.progress import Progress
    from stickslip.sweeps.band import Band
    from stickslip.sweeps.cluster import ClusterExecutor
    from stickslip.sweeps.run import Sweep

EXIT_NOT_CONVERGED = 3  # what was computed is written
PAGES_AT_ONCE = 24  # chosen: each takes 5 MB and a third of a second; "stickslip report" writes those of larger sweeps
SHOWN_FAILURES = 10  # chosen: lines on failed cases


def load_study(
    path: Path, quiet: bool = False, central: bool = True, needs_range: bool = True
) -> tuple[Case, KeyPositions]:
    """The case of a study file and the lines of its keys; reports which values are defaults, and which are the
    ``central`` ones of distributed inputs. Unless it ``needs_range``, the file may lack the frequency range. Raises
    StudyFileError."""
    from stickslip.case.load import load_case_and_positions
    from stickslip.case.scatter_text import central_sentences

    case, places = load_case_and_positions(path, needs_range)
    defaults = case.defaulted_keys()
    if defaults and not quiet:
        echo(f"Not in the file; stickslip uses the defaults: {', '.join(defaults)}", err=True)
    for sentence in central_sentences(places.scattered) if central else ():
        echo(f"Note: {sentence}", err=True)
    return case, places


def study_from(source: Path, target: Path) -> str:
    """The text of the study file ``source`` at ``target``, with the range and the excitation that are proposed for it.

    Raises InputError.
    """
    case, places = load_study(source, quiet=True, needs_range=False)
    from stickslip.study.proposal import propose

    with about_file(places):
        text = case.replace(propose(case).keys(case)).to_text()
    for file in case.input_files.values():  # absolute in the case
        text = text.replace(json.dumps(file, ensure_ascii=False), json.dumps(relpath(file, target.parent)))
    return text


def study_from_model(source: Path, target: Path, length_unit: str | None, unit_system: str | None) -> str:
    """The text of a study file at ``target`` on the model file ``source``. Raises InputError and ImportFileError."""
    from stickslip.formats.meshes.read import read_model
    from stickslip.study.model_study import study_of_model

    if length_unit is None:
        raise InputError(
            f"{source} does not contain its unit of length. Give --length-unit mm, m or another unit; "
            f'"stickslip import {source}" shows the size of the model in both.'
        )
    model = read_model(source, length_unit, unit_system)
    return study_of_model(model, relpath(source, target.parent), unit_system)


@contextmanager
def about_file(places: KeyPositions) -> Iterator[None]:
    """Put the study file's name and the lines of its keys before errors after reading."""
    try:
        yield
    except (OutputError, ResultsFileError):
        raise  # the study file is not the cause
    except InputError as error:
        raise error.reworded(places.sentence(error)) from error


def require_one_place(workers: int | None, scheduler: str | None) -> None:
    """Raise InputError for both kinds of workers."""
    if scheduler is not None and workers is not None:
        raise InputError("--workers and --scheduler cannot both be given: the cluster has its own workers.")


@contextmanager
def solving(
    places: KeyPositions, scheduler: str | None, quiet: bool
) -> Iterator[tuple[Progress, ClusterExecutor | None]]:
    """Progress of many cases and the executor of a cluster, if any; errors name the study file."""
    from stickslip.sweeps.cluster import cluster_executor

    with terminal_progress(quiet) as progress, about_file(places):
        if scheduler is None:
            yield progress, None
            return
        with cluster_executor(scheduler, progress) as executor:
            yield progress, executor


def pages_of_cases(result: Sweep, out: Path, progress: Progress) -> None:
    """Write the page of each case of a small sweep that has none, and the page of the sweep with links to them."""
    from stickslip.sweeps.again import report_sweep

    count = len(result.table.rows)
    if count > PAGES_AT_ONCE:
        return
    for number, page in enumerate(report_sweep(out, renew=False)):
        progress.update("Pages", min(1.0, (number + 1) / (count + 1)), page.parent.name)


def close_cases(result: Sweep | Band, quiet: bool, cases: str) -> None:
    """Report the files and the failed ``cases``; raises the exit of a sweep or band with such cases."""
    failed, count = result.table.failed, len(result.table.rows)
    for notice in result.notices:
        echo(notice, err=True)
    if not quiet:
        for file in result.files:
            echo(f"Wrote {file}")
        echo(f"{count} {cases}, {result.reused} of them from an earlier run; {len(failed)} failed.")
        for remark in result.remarks:
            echo(remark)
    for row in failed[:SHOWN_FAILURES]:
        echo(f"Failed: {row.name}: {row.message}", err=True)
    if failed:
        rest = len(failed) - SHOWN_FAILURES
        more = f" {rest} more failed." if rest > 0 else ""
        echo(f"{more} The table {result.files[0]} contains all {cases} with their messages.".lstrip(), err=True)
        raise typer.Exit(EXIT_NOT_CONVERGED)
