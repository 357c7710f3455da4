"""The commands on results of solved studies: report, compare, export."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stickslip.cli.errors import Debug, error_messages
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.terminal import echo


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run or of a sweep.", show_default=False)],
    debug: Debug = False,
) -> None:
    """Write the report of a solved study again, or those of all cases of a sweep, without a new solution."""
    with error_messages(debug):
        if not folder.is_dir():
            raise InputError(
                f'the folder "{folder}" does not exist. Give the --out folder of a run, with results.nc, or of a sweep.'
            )
        from stickslip.study import run as study
        from stickslip.sweeps import again

        lost: list[str] = []
        for file in again.report_sweep(folder, lost=lost) if again.is_sweep(folder) else study.report(folder):
            echo(f"Wrote {file}")
        if lost:
            raise ResultsFileError(
                f"the page of the sweep lacks the results of {len(lost)} cases. The first: {lost[0]}"
            )


def compare(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR DIR...", help="Folders of runs; the first is the reference.")
    ],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The page.")] = Path("compare.html"),
    to: Annotated[str | None, typer.Option("--to", help="Also write the tables: csv, xlsx or mat.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite existing files.")] = False,
    debug: Debug = False,
) -> None:
    """Show several solved studies on one page: curves, differences, inputs that differ."""
    with error_messages(debug):
        from stickslip.study.compare import compare as write_comparison

        for file in write_comparison(folders, out, force, to):
            echo(f"Wrote {file}")


def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder with results.nc.", show_default=False)],
    to: Annotated[str, typer.Option("--to", help="csv (a folder of files), xlsx, mat, or vtu (contact).")] = "csv",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PATH", help="File or folder; default DIR/tables.")
    ] = None,
    frequency: Annotated[
        str | None, typer.Option("--frequency", metavar="VALUE", help='vtu: "450 Hz"; default the highest peak.')
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite existing files.")] = False,
    debug: Debug = False,
) -> None:
    """Write every table of a solved study as CSV, Excel or MATLAB, or its contact pairs for ParaView."""
    with error_messages(debug):
        from stickslip.core.validation import require_choice
        from stickslip.results.table_files import FORMATS
        from stickslip.study.export import export_contact, export_tables

        require_choice("to", to, (*FORMATS, "vtu"))
        if to == "vtu":
            echo(f"Wrote {export_contact(folder, _hertz(frequency), out, force)}")
            return
        if frequency is not None:
            raise InputError(f'--frequency belongs to --to vtu, but --to is "{to}". Remove it.')
        for file in export_tables(folder, to, out, force):
            echo(f"Wrote {file}")


def _hertz(text: str | None) -> float | None:
    """The frequency of an option in Hz. Raises InputError."""
    from stickslip.core.units import Quantity

    if text is None:
        return None
    try:
        return Quantity("frequency", above=0.0, unit_required="A frequency needs its unit.").parse(text)
    except InputError as error:
        raise InputError(f'--frequency "{text}" {error}') from error
