"""Several solved studies on one page: their results are read, checked and compared, never solved again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from stickslip.core.errors import InputError
from stickslip.core.files import require_folder
from stickslip.results.comparison import Compared, comparison_tables, names_of_cases
from stickslip.results.storage import load_results
from stickslip.results.table_files import FORMATS
from stickslip.study.export import require_free, target_of_tables
from stickslip.study.places import CASES_FOLDER, RESULTS_FILE

COMPARE_FILE = "compare.html"
MOST_RESULTS = 12  # chosen: more curves cannot be distinguished in one figure


def compare(
    folders: Sequence[str | PathLike[str]],
    path: str | PathLike[str] = COMPARE_FILE,
    force: bool = False,
    to: str | None = None,
) -> tuple[Path, ...]:
    """Write one page with curves, measures, differences and differing inputs of several solved studies.

    Parameters
    ----------
    folders:
        two to twelve folders of ``run``, each with results.nc; the first is the reference of all differences.
    path:
        the page, a file that ends in ``.html``.
    force:
        whether to overwrite existing files.
    to:
        "csv", "xlsx" or "mat" to write the tables of the page too, beside it: a folder ``NAME_tables``, or a file with
        the name of the page and this ending.

    Returns
    -------
    tuple of Path
        the page and the files of its tables.

    Raises
    ------
    InputError
        for fewer than two folders or too many, a folder twice, one without a result of a run, results of different
        kinds, another format, and a page or tables that exist or cannot be written.
    ResultsFileError
        for a results file that is damaged or has no study.
    """
    target = Path(path)
    sources = _sources(folders)
    if target.suffix != ".html":
        raise InputError(f'"{target}" must end in .html, because browsers open the page by this ending.')
    require_free(target, force)
    require_folder(target.absolute().parent, files=(target.name,))
    tables = None if to is None else target_of_tables(to, _beside(target, to), force)
    compared = tuple(_read(sources))
    _require_one_kind(compared)
    from stickslip.reporting.compare_page import write_compare_page

    write_compare_page(target, compared)
    if to is None or tables is None:
        return (target,)
    return (target, *FORMATS[to].write(tables, comparison_tables(compared)))


def _beside(page: Path, to: str) -> Path:
    """The tables of a page: a folder for CSV, else a file."""
    return page.with_name(f"{page.stem}_tables") if to == "csv" else page.with_suffix(f".{to}")


def _sources(folders: Sequence[str | PathLike[str]]) -> list[Path]:
    """The results files of folders. Raises InputError."""
    places = [Path(folder) for folder in folders]
    if not 2 <= len(places) <= MOST_RESULTS:
        raise InputError(
            f"{len(places)} folder{'' if len(places) == 1 else 's'} given, but a comparison requires 2 to "
            f"{MOST_RESULTS}. For more, use stickslip sweep, whose page shows any number of cases."
        )
    resolved = [place.resolve() for place in places]
    twice = next((place for number, place in enumerate(places) if resolved[number] in resolved[:number]), None)
    if twice is not None:
        raise InputError(f'the folder "{twice}" is given twice. Give each result once.')
    for place in places:
        if not place.is_dir():
            raise InputError(f'the folder "{place}" does not exist. Give --out folders of stickslip run.')
        if not (place / RESULTS_FILE).is_file():
            hint = "Give --out folders of stickslip run."
            if (place / "sweep.nc").is_file() or (place / "cases").is_dir():
                hint = f'It is the folder of a sweep; give folders of its cases, such as "{place / "cases"}/NAME".'
            raise InputError(f'the folder "{place}" contains no {RESULTS_FILE}, the result of a run. {hint}')
    return [place / RESULTS_FILE for place in places]


def _read(sources: Sequence[Path]) -> Iterator[Compared]:
    """Results with short names that differ. Raises ResultsFileError, InputError."""
    folders = [source.parent for source in sources]
    names = [folder.resolve().name for folder in folders]
    if len(set(names)) < len(names):
        names = [str(folder) for folder in folders]
    loaded = []
    for source in sources:
        saved = load_results(source)
        if saved.study is None:
            raise InputError(
                f'"{source}" contains a response without a study, so its outputs and inputs are unknown. Compare '
                "results of stickslip run."
            )
        loaded.append((saved.response, saved.study))
    if all(folder.resolve().parent.name == CASES_FOLDER for folder in folders):
        names = list(names_of_cases(names, [study for _, study in loaded]))
    for name, (response, study) in zip(names, loaded, strict=True):
        yield Compared(name, response, study)


def _require_one_kind(compared: Sequence[Compared]) -> None:
    """Raise InputError for a curve at constant excitation beside one whose excitation is controlled."""
    controlled = [bool(np.ptp(each.response.load_factor) > 0.0) for each in compared]
    if any(controlled) and not all(controlled):
        other, constant = compared[controlled.index(True)].name, compared[controlled.index(False)].name
        raise InputError(
            f'the results are of different kinds: "{constant}" has a constant excitation, "{other}" a controlled one '
            "(prescribed amplitude or phase), so their curves are not comparable. Compare results of one kind."
        )
