"""The folder of a sweep: a results file for each case, what is found finished when a sweep goes on, and the tables.

``DIR/cases/NAME/results.nc`` holds a case that was solved, ``row.json`` beside it what table and page need of it with
the digest of that file, ``failed.json`` the message of a case that stickslip refused or could not start. NAME ends with
the hash of its inputs, the version and the code.
"""

from __future__ import annotations

import hashlib
import json
import traceback
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stickslip.core.errors import ResultsFileError
from stickslip.core.files import remove_abandoned, require_folder, require_room, whole_file, write_solved
from stickslip.results.storage import load_results
from stickslip.results.sweep_table import SweepCurve, curve_and_measures
from stickslip.study.places import RESULTS_FILE
from stickslip.sweeps.plan import PlannedCase
from stickslip.sweeps.work import CASE_KEY, CaseOutcome

CASES = "cases"
FAILED_FILE = "failed.json"
ROW_FILE = "row.json"
TRACEBACK_FILE = "traceback.log"
ROOM_BYTES = 15_000_000  # the page of a sweep and one case of the two-blade study


@dataclass(frozen=True)
class SweepFolder:
    """Where a sweep keeps its cases. Methods raise ResultsFileError where the folder cannot be written."""

    path: Path

    def make(self, files: Iterable[str]) -> None:
        """Make the folder itself, for cases and these files. Raises PlaceError where they could not be written."""
        require_folder(self.path, files, folders=(CASES,))
        require_room(self.path, ROOM_BYTES, ROOM_BYTES)

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
        write_solved(target, content, "results", ResultsFileError, then="start the same sweep again")
        if outcome.file:
            # after the results: a process that is killed between the two leaves a case that is read whole
            with whole_file(target.with_name(ROW_FILE), "row of a case", ResultsFileError) as part:
                part.write_text(_row_text(planned.key, outcome), encoding="utf-8")
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
        remove_abandoned(file.parent)
        failed = file.with_name(FAILED_FILE)
        if not file.exists():
            return _failure(failed, planned.key) if failed.exists() else (None, "")
        row = _row(file, planned.key)
        if row is not None:
            return row, ""
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


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultsFileError(
            f'the folder "{folder}" cannot be made ({error.strerror}). Give a folder in which you can make files.'
        ) from error


def _row_text(key: str, outcome: CaseOutcome) -> str:
    """What a row, its curve and its warnings need of the results, as JSON; numbers keep every digit."""
    curve = outcome.curve
    assert curve is not None  # a case with a results file has one
    row = {
        CASE_KEY: key,
        "results": _digest(outcome.file),
        "converged": outcome.converged,
        "message": outcome.message,
        "measures": dict(outcome.measures),
        "warnings": list(outcome.warnings),
        "frequency_hz": curve.frequency_hz.tolist(),
        "amplitude_m": curve.amplitude_m.tolist(),
    }
    return json.dumps(row)


def _row(results: Path, key: str) -> CaseOutcome | None:
    """The row kept beside a results file, without opening that as NetCDF; None unless both belong to the case.

    The caller reads the results themselves then, and tells what is wrong with them.
    """
    try:
        kept = json.loads(results.with_name(ROW_FILE).read_text(encoding="utf-8"))
        if kept[CASE_KEY] != key or kept["results"] != _digest(results.read_bytes()):
            return None
        curve = SweepCurve(np.array(kept["frequency_hz"]), np.array(kept["amplitude_m"]))
        return CaseOutcome(kept["converged"], kept["message"], kept["measures"], curve, tuple(kept["warnings"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=16).hexdigest()


def _failure(file: Path, key: str) -> tuple[CaseOutcome | None, str]:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        if kept[CASE_KEY] == key:
            return CaseOutcome(converged=False, message=str(kept["message"]), measures={}), ""
    except (OSError, ValueError, KeyError, TypeError) as error:
        return None, f'"{file}" is damaged ({type(error).__name__}). This case is solved again.'
    return None, f'"{file}" does not belong to this case. It is solved again.'
