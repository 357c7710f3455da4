"""The folder of a sweep: a results file for each case, what is found finished when a sweep goes on, and the tables.

``DIR/cases/NAME/results.nc`` holds a case that was solved, ``DIR/cases/NAME/failed.json`` the message of one that
stickslip refused or could not start. NAME ends with the hash of its inputs and of the version.
"""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from stickslip.errors import ResultsFileError
from stickslip.files import whole_file
from stickslip.results.storage import load_results
from stickslip.results.sweep_table import curve_and_measures
from stickslip.study import RESULTS_FILE
from stickslip.sweeps.plan import PlannedCase
from stickslip.sweeps.work import CASE_KEY, CaseOutcome

CASES = "cases"
FAILED_FILE = "failed.json"
TRACEBACK_FILE = "traceback.log"
# Saving takes seconds: an unfinished file this old was left by a process that was killed.
_ABANDONED_SECONDS = 600.0


@dataclass(frozen=True)
class SweepFolder:
    """Where a sweep keeps its cases. Methods raise ResultsFileError where the folder cannot be written."""

    path: Path

    def make(self) -> None:
        """Make the folder itself."""
        _make(self.path)

    def results_file(self, planned: PlannedCase) -> Path:
        """The results file of a case, whether or not it exists."""
        return self.path / CASES / planned.name / RESULTS_FILE

    def relative(self, planned: PlannedCase) -> str:
        """The same, relative to the folder of the sweep, as the table shows it."""
        return self.results_file(planned).relative_to(self.path).as_posix()

    def store(self, planned: PlannedCase, outcome: CaseOutcome) -> None:
        """Keep the results of a case, or the message of one that has none; whole or not at all."""
        target = self.results_file(planned) if outcome.file else self.results_file(planned).with_name(FAILED_FILE)
        content = outcome.file or json.dumps({CASE_KEY: planned.key, "message": outcome.message}).encode()
        _make(target.parent)
        with whole_file(target, "results", ResultsFileError) as part:
            part.write_bytes(content)
        if outcome.file:
            for left_over in (FAILED_FILE, TRACEBACK_FILE):
                target.with_name(left_over).unlink(missing_ok=True)

    def store_traceback(self, planned: PlannedCase, error: BaseException) -> Path:
        """Keep the traceback of a fault of the program; returns its file."""
        target = self.results_file(planned).with_name(TRACEBACK_FILE)
        _make(target.parent)
        with whole_file(target, "traceback", ResultsFileError) as part:
            part.write_text("".join(traceback.format_exception(error)), encoding="utf-8")
        return target

    def finished(self, planned: PlannedCase) -> tuple[CaseOutcome | None, str]:
        """What an earlier sweep found for these inputs and this version, or None; and a sentence about a bad file."""
        file = self.results_file(planned)
        self._remove_abandoned(file.parent)
        failed = file.with_name(FAILED_FILE)
        if not file.exists():
            return _failure(failed, planned.key) if failed.exists() else (None, "")
        try:
            saved = load_results(file)
        except ResultsFileError as error:
            return None, f"{error} This case is solved again."
        if saved.study is None or saved.response.provenance.get(CASE_KEY) != planned.key:
            return None, f'"{file}" does not hold the results of this case. It is solved again.'
        response = saved.response
        curve, measures = curve_and_measures(response, saved.study)
        warnings = (*saved.study.warnings, *response.warnings)
        return CaseOutcome(response.converged, response.message, measures, curve, warnings), ""

    def _remove_abandoned(self, folder: Path) -> None:
        for part in _parts(folder):
            if time.time() - part.stat().st_mtime > _ABANDONED_SECONDS:
                part.unlink(missing_ok=True)


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultsFileError(
            f'the folder "{folder}" cannot be made ({error.strerror}). Give a folder in which you can make files.'
        ) from error


def _parts(folder: Path) -> Iterator[Path]:
    """Unfinished files of ``whole_file``."""
    return folder.glob(".*.part")


def _failure(file: Path, key: str) -> tuple[CaseOutcome | None, str]:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        if kept[CASE_KEY] == key:
            return CaseOutcome(converged=False, message=str(kept["message"]), measures={}), ""
    except (OSError, ValueError, KeyError, TypeError) as error:
        return None, f'"{file}" is damaged ({type(error).__name__}). This case is solved again.'
    return None, f'"{file}" does not belong to this case. It is solved again.'
