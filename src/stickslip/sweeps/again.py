"""The pages of all cases of a sweep, and its own page with links to them, from the stored files; nothing is solved."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from stickslip.core.errors import ResultsFileError
from stickslip.reporting.sweep_page import write_sweep_page
from stickslip.reporting.sweep_view import SweepView
from stickslip.reporting.templates import StudyText
from stickslip.results.record import run_provenance
from stickslip.results.sweep_table import SweepRow, SweepTable
from stickslip.study.places import CASES_FOLDER, REPORT_FILE, RESULTS_FILE
from stickslip.study.run import report
from stickslip.sweeps.folder import SweepFolder
from stickslip.sweeps.record import StoredCase, read_record
from stickslip.sweeps.run import PAGE_FILE
from stickslip.sweeps.work import CaseOutcome


def is_sweep(folder: Path) -> bool:
    """Whether a folder has the record of a sweep. Raises ResultsFileError for a damaged one."""
    return read_record(folder) is not None


def report_sweep(folder: Path, renew: bool = True, lost: list[str] | None = None) -> Iterator[Path]:
    """Write the page of each solved case, then that of the sweep; yields each page as soon as it is written.

    Without ``renew`` pages of cases that exist remain. ``lost`` receives a sentence for each case whose result is
    missing or damaged. Raises ResultsFileError for a folder without a sweep or with a
    damaged record, InputError if a page cannot be written.
    """
    record = read_record(folder)
    if record is None:
        raise ResultsFileError(f'the folder "{folder}" contains no sweep.')
    cases = SweepFolder(folder)
    outcomes = [_outcome(cases, case, [] if lost is None else lost) for case in record.cases]
    rows = []
    for case, outcome in zip(record.cases, outcomes, strict=True):
        file = ""
        if outcome.curve is not None:
            if renew or not (folder / CASES_FOLDER / case.name / REPORT_FILE).exists():
                yield from report(folder / CASES_FOLDER / case.name)
            file = f"{CASES_FOLDER}/{case.name}/{RESULTS_FILE}"
        rows.append(
            SweepRow(
                case.name, case.values, outcome.converged, outcome.message, outcome.measures, outcome.warnings, file
            )
        )
    forces = np.array([case.force_n for case in record.cases])
    view = SweepView(SweepTable(record.keys, tuple(rows)), tuple(each.curve for each in outcomes), forces)
    write_sweep_page(folder / PAGE_FILE, view, record.title, StudyText(record.text, record.changed), run_provenance())
    yield folder / PAGE_FILE


def _outcome(cases: SweepFolder, case: StoredCase, lost: list[str]) -> CaseOutcome:
    """The stored outcome of a case; a failed one, with a sentence in ``lost``, if it is missing or damaged."""
    outcome, trouble = cases.stored(case.name, case.key)
    if outcome is not None:
        return outcome
    words = f"{trouble or 'This case has no stored result.'} Start the sweep again to solve it."
    lost.append(f"{case.name}: {words}")
    return CaseOutcome(converged=False, message=words, measures={})
