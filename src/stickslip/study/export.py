"""The tables of a solved study as files for spreadsheets and MATLAB, without solving again."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from stickslip.core.errors import InputError
from stickslip.core.files import require_folder
from stickslip.core.validation import require_choice
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results
from stickslip.results.table_files import FORMATS
from stickslip.results.tables import study_tables
from stickslip.study.contact_file import write_contact
from stickslip.study.places import CONTACT_FILE, RESULTS_FILE


def export_tables(
    folder: str | PathLike[str], to: str = "csv", path: str | PathLike[str] | None = None, force: bool = False
) -> tuple[Path, ...]:
    """Write every table of a solved study: curve, linear limits, measures, pairs, modes, stress, inputs and others.

    Parameters
    ----------
    folder:
        of ``run``, with results.nc.
    to:
        "csv": a folder with a file for each table; "xlsx": an Excel workbook; "mat": a MATLAB file. Numbers are in SI
        units, with units in the headings (in ``units`` of each structure for MATLAB).
    path:
        of the folder or file; by default ``tables``, ``tables.xlsx`` or ``tables.mat`` in ``folder``.
    force:
        whether to overwrite what exists there.

    Returns
    -------
    tuple of Path
        the files.

    Raises
    ------
    InputError
        for another format, a folder without a result, a path with another ending, one that exists, or one that cannot
        be written.
    ResultsFileError
        for a results file that is damaged.
    """
    require_choice("to", to, tuple(FORMATS))
    source = _results_in(folder)
    target = target_of_tables(to, Path(folder) / FORMATS[to].default_name if path is None else Path(path), force)
    return FORMATS[to].write(target, study_tables(*_loaded(source)))


def export_contact(
    folder: str | PathLike[str],
    frequency_hz: float | None = None,
    path: str | PathLike[str] | None = None,
    force: bool = False,
) -> Path:
    """Write the contact pairs of a solved study as points of a .vtu file for ParaView, without solving again.

    The fields are those of docs/results_files.md: state, fractions of the period, slip distance, pressure, energy.

    Parameters
    ----------
    folder:
        of ``run``, with results.nc.
    frequency_hz:
        of a point of the curve; None for the highest peak. On a fold it is the point with the largest amplitude.
    path:
        of the file; by default ``contact_at_peak.vtu`` in ``folder``, at a frequency ``contact_450Hz.vtu``.
    force:
        whether to overwrite a file that exists.

    Raises
    ------
    InputError
        for a folder without a result, a frequency that is not on the curve, results without positions of the pairs, a
        path with another ending, one that exists, or one that cannot be written.
    ResultsFileError
        for a results file that is damaged.
    """
    source = _results_in(folder)
    name = CONTACT_FILE if frequency_hz is None else f"contact_{frequency_hz:g}Hz.vtu"
    target = Path(folder) / name if path is None else Path(path)
    require_free(target, force)
    return write_contact(target, *_loaded(source), frequency_hz)


def _results_in(folder: str | PathLike[str]) -> Path:
    """The results file of a run. Raises InputError."""
    source = Path(folder) / RESULTS_FILE
    if not source.is_file():
        raise InputError(
            f'the folder "{folder}" contains no {RESULTS_FILE}, the result of a run. Give the --out folder of '
            "stickslip run; the table of a sweep is its sweep.csv."
        )
    return source


def _loaded(source: Path) -> tuple[ForcedResponse, StudyRecord]:
    """Response and study of a results file. Raises InputError, ResultsFileError."""
    saved = load_results(source)
    if saved.study is None:
        raise InputError(
            f'"{source}" contains a response without a study, so its outputs are unknown. Only "stickslip run" writes '
            "files with tables."
        )
    return saved.response, saved.study


def target_of_tables(to: str, target: Path, force: bool) -> Path:
    """``target`` after a check that tables can be written there. Raises InputError."""
    require_choice("to", to, tuple(FORMATS))
    if to != "csv" and target.suffix != f".{to}":
        raise InputError(f'"{target}" must end in .{to}, the ending of files of this format.')
    require_free(target, force)
    names = {"folders" if to == "csv" else "files": (target.name,)}
    require_folder(target.absolute().parent, **names)
    return target


def require_free(target: Path, force: bool) -> None:
    """Raise InputError for a file or folder that exists, unless ``force`` allows to overwrite it."""
    if target.exists() and not force:
        raise InputError(f'"{target}" exists already. Give another name with --out, or --force to overwrite it.')
