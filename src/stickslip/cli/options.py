"""Options and output that several commands have in the same form."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stickslip.core.terminal import echo


def folder(text: str) -> Path:
    """The folder of an option. Raises BadParameter for an empty text, which would be the current folder."""
    if not text.strip():
        raise typer.BadParameter("it is empty. Give a folder; the current one is .")
    return Path(text)


FINISHED_CASES_NOTE = "Completed cases are stored; the same command resumes with the others."
StudyFile = Annotated[Path, typer.Argument(metavar="FILE", help="The study file (TOML).", show_default=False)]
OutFolder = Annotated[
    Path,
    typer.Option("--out", metavar="DIR", help="Folder of the results.", show_default=False, parser=folder),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print only errors.")]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, help="Processes; default one for each processor.", show_default=False),
]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Solve on the Dask cluster with this scheduler."),
]
WorkerThreads = Annotated[int, typer.Option("--threads", min=1, help="Threads of each worker.")]


def print_rows(rows: list[tuple[str, str]]) -> None:
    """Print labels and values in two columns."""
    width = max((len(label) for label, _ in rows), default=0)
    for label, value in rows:
        echo(f"  {label:<{width}}  {value}")
