"""The results file of one run: the response, and the record of the study for the report."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.results.groups import groups_bytes, read_groups, write_groups
from stickslip.results.periodic_motions import CURVE
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.stored import StoredGroup
from stickslip.results.variables import Variables, variable

if TYPE_CHECKING:
    import xarray

_STUDY = "study"


@dataclass(frozen=True)
class SavedResults:
    """A results file in memory: the response, and the study record or None if none was stored."""

    response: ForcedResponse
    study: StudyRecord | None


def save_results(path: str | PathLike[str], response: ForcedResponse, study: StudyRecord | None = None) -> None:
    """Write one NetCDF-4 file completely or not at all: a hidden file beside it is renamed once it is complete.

    Raises InputError if ``study`` does not belong to ``response``, ResultsFileError if the file cannot be written.
    """
    write_groups(Path(path), _groups(response, study))


def results_bytes(response: ForcedResponse, study: StudyRecord | None = None) -> bytes:
    """The content of a results file. Raises InputError if ``study`` does not belong to ``response``."""
    return groups_bytes(_groups(response, study))


def load_results(path: str | PathLike[str]) -> SavedResults:
    """Read a file of :func:`save_results`; the response and the study are equal to the saved ones.

    Raises
    ------
    ResultsFileError
        for a file that is missing, is not NetCDF-4, is not of stickslip, is of another version, or is damaged.
    """
    return read_groups(path, _saved)


def _groups(response: ForcedResponse, study: StudyRecord | None) -> dict[str, xarray.Dataset]:
    groups = response.to_groups()
    if study is not None:
        study.require_fit(response)
        groups[""] = groups[""].assign(_amplitude(response, study))
        groups |= study.to_groups(_STUDY)
    return groups


def _amplitude(response: ForcedResponse, study: StudyRecord) -> Variables:
    """The curve of the first response, for readers of the file; stickslip computes it from the displacement."""
    name = study.response_output
    values = response.amplitude(study.outputs[name])
    return {"amplitude": variable(CURVE, values, "m", f"0-to-peak amplitude of {name}, mean included")}


def _saved(root: StoredGroup) -> SavedResults:
    response = ForcedResponse.from_group(root)
    if _STUDY not in root:
        return SavedResults(response, None)
    study = StudyRecord.from_group(root.subgroup(_STUDY), response.harmonics)
    study.require_fit(response)
    return SavedResults(response, study)
