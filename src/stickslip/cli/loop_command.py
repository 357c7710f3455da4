"""The command ``stickslip fit``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stickslip.cli.errors import Debug, error_messages
from stickslip.core.files import require_folder
from stickslip.core.terminal import echo, echo_rows


def fit(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="Loops: displacement and force.", show_default=False)],
    normal_load: Annotated[
        str | None, typer.Option("--normal-load", help='Normal load of the measurement: "90 N".')
    ] = None,
    predict: Annotated[
        str | None, typer.Option("--predict", help='Energy per cycle at another normal load, such as "160 N".')
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder for plot and table.")] = None,
    debug: Debug = False,
) -> None:
    """Tangential stiffness, friction limit and backlash of measured hysteresis loops."""
    with error_messages(debug):
        if out is not None:
            require_folder(out)
        from stickslip.cli import measured_loops

        found = measured_loops.fit_file(path, normal_load)
        other = measured_loops.predicted_rows(found, predict)
        echo_rows(measured_loops.rows(found))
        for sentence in found.warnings:
            echo(f"Warning: {sentence}")
        for file in measured_loops.write(out, found) if out is not None else ():
            echo(f"Wrote {file}")
        if other:
            echo(f"\nAt a normal load of {predict}, with the same friction coefficient, stiffness and backlash:")
            echo_rows(other)
        echo(f"\nFor the study file:\n{measured_loops.study_lines(found)}")
