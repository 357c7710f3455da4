"""The folder of a sweep: a results file for each case, the finished cases when a sweep resumes, and the tables.

``DIR/cases/NAME/results.nc`` contains a solved case, ``row.json`` beside it the data for table and page with the digest
of that file, ``failed.json`` the message of a case that stickslip rejected or could not start. NAME ends with the hash
of its inputs, the version and the code. Both JSON files are sealed with that hash. A case is finished only if row and
results are present and undamaged; otherwise a notice names the wrong file, and the case is solved again.
"""

from __future__ import annotations

import hashlib
import io
import json
import traceback
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.core.errors import ResultsFileError
from stickslip.core.files import remove_abandoned, require_disk_space, require_folder, whole_file, write_solved
from stickslip.core.seal import require_seal, seal
from stickslip.results.sweep_table import SweepCurve
from stickslip.study.places import CASES_FOLDER, REPORT_FILE, RESULTS_FILE
from stickslip.sweeps.plan import KEY_DIGITS, PlannedCase
from stickslip.sweeps.work import CaseOutcome

FAILED_FILE = "failed.json"
ROW_FILE = "row.json"
TRACEBACK_FILE = "traceback.log"
SPACE_BYTES = 15_000_000  # the page of a sweep and one case of the two-blade study


@dataclass(frozen=True)
class SweepFolder:
    """The cases of a sweep on the disk. Methods raise ResultsFileError if the folder cannot be written."""

    path: Path

    def make(self, files: Iterable[str]) -> None:
        """Make the folder itself, for cases and these files. Raises OutputError if they could not be written."""
        require_folder(self.path, files, folders=(CASES_FOLDER,))
        require_disk_space(self.path, SPACE_BYTES, SPACE_BYTES)

    def folder_names(self) -> dict[str, str]:
        """First digits of the key of a case -> name of its folder, for all cases in the folder."""
        return {each.name[-KEY_DIGITS:]: each.name for each in (self.path / CASES_FOLDER).glob("*") if each.is_dir()}

    def results_file(self, planned: PlannedCase) -> Path:
        """The results file of a case, whether or not it exists."""
        return self.path / CASES_FOLDER / planned.name / RESULTS_FILE

    def relative(self, planned: PlannedCase) -> str:
        """The same, relative to the folder of the sweep, as the table shows it."""
        return self.results_file(planned).relative_to(self.path).as_posix()

    def store(self, planned: PlannedCase, outcome: CaseOutcome) -> None:
        """Write the results of a case, or the message of one without results; completely or not at all."""
        results = self.results_file(planned)
        _make(results.parent)
        if not outcome.file:
            write_sealed(results.with_name(FAILED_FILE), planned.key, {"message": outcome.message})
            return
        # The row before the results: then results always have a row, even after a kill between the two.
        write_sealed(results.with_name(ROW_FILE), planned.key, _row(outcome))
        write_solved(results, outcome.file, "results", ResultsFileError, then="start the same sweep again")
        for old_file in (FAILED_FILE, TRACEBACK_FILE, REPORT_FILE):
            results.with_name(old_file).unlink(missing_ok=True)

    def store_traceback(self, planned: PlannedCase, error: BaseException) -> Path:
        """Write the traceback of a defect of the program; returns its file."""
        target = self.results_file(planned).with_name(TRACEBACK_FILE)
        _make(target.parent)
        with whole_file(target, "traceback", ResultsFileError) as part:
            part.write_text("".join(traceback.format_exception(error)), encoding="utf-8")
        return target

    def finished(self, planned: PlannedCase) -> tuple[CaseOutcome | None, str]:
        """The outcome of an earlier sweep for these inputs and this version, or None; and a message on a wrong file."""
        outcome, trouble = self.stored(planned.name, planned.key)
        return outcome, f"{trouble} This case is solved again." if trouble else ""

    def stored(self, name: str, key: str) -> tuple[CaseOutcome | None, str]:
        """The outcome of the case with a name and a key, or None; and a message on a missing part or a wrong file."""
        results = self.path / CASES_FOLDER / name / RESULTS_FILE
        remove_abandoned(results.parent)
        row, failed = results.with_name(ROW_FILE), results.with_name(FAILED_FILE)
        try:
            if results.exists() or row.exists():
                return _solved(results, read_sealed(row, key)), ""
            if failed.exists():
                message = str(read_sealed(failed, key)["message"])
                return CaseOutcome(converged=False, message=message, measures={}), ""
        except ResultsFileError as error:
            return None, str(error)
        return None, ""


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultsFileError(
            f'the folder "{folder}" cannot be created ({error.strerror}). Give a writable folder.'
        ) from error


def _row(outcome: CaseOutcome) -> dict[str, Any]:
    """Row, curve and warnings from the results, and the digest of these; numbers have all digits."""
    curve = outcome.curve
    assert curve is not None  # a case with a results file has one
    return {
        "results": _digest(outcome.file),
        "converged": outcome.converged,
        "message": outcome.message,
        "measures": dict(outcome.measures),
        "warnings": list(outcome.warnings),
        "frequency_hz": curve.frequency_hz.tolist(),
        "amplitude_m": curve.amplitude_m.tolist(),
        "stable": curve.stable.tolist(),
        "part": curve.part.tolist(),
        "details": dict(outcome.details),
    }


def _solved(results: Path, row: dict[str, Any]) -> CaseOutcome:
    """The outcome of a row. Raises ResultsFileError unless its results file is present and unchanged."""
    if row["results"] != _digest(_content(results)):
        raise ResultsFileError(f'"{results}" is not used: "{ROW_FILE}" in the same folder belongs to another file.')
    row.setdefault("part", [0] * len(row["stable"]))  # folders of earlier versions have curves of one part
    curve = SweepCurve(*(np.array(row[name]) for name in ("frequency_hz", "amplitude_m", "stable", "part")))
    details = row.get("details", {})
    return CaseOutcome(
        row["converged"], row["message"], row["measures"], curve, tuple(row["warnings"]), details=details
    )


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=16).hexdigest()


def write_sealed(file: Path, key: str, entries: dict[str, Any]) -> None:
    """Write a JSON object that belongs to the case with this key."""
    with whole_file(file, "row of a case", ResultsFileError) as part, part.open("w+b") as stream:
        stream.write(json.dumps(entries).encode())
        seal(stream, _subject(file, key))


def read_sealed(file: Path, key: str) -> dict[str, Any]:
    """The object of ``write_sealed`` for this case. Raises ResultsFileError for anything else."""
    stream = io.BytesIO(_content(file))
    try:
        size = require_seal(stream, _subject(file, key))
    except ResultsFileError as error:
        raise ResultsFileError(f'"{file}" is not used: {error}') from error
    entries: dict[str, Any] = json.loads(stream.read(size))
    return entries


def _subject(file: Path, key: str) -> str:
    return f"{file.name} of case {key}"


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except FileNotFoundError as error:
        raise ResultsFileError(f'"{file}" is missing.') from error
    except OSError as error:
        raise ResultsFileError(f'"{file}" cannot be read ({error.strerror}).') from error
