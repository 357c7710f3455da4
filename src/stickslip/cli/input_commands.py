"""The commands on files that a study begins with: a measured face, measured loops, a model of another program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stickslip.cli.errors import Debug, error_messages
from stickslip.cli.options import folder, print_rows
from stickslip.core.files import require_folder
from stickslip.core.terminal import echo


def roughness(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="Profile, or map of an instrument.", show_default=False)],
    unit: Annotated[str | None, typer.Option("--unit", help="Unit of both columns, such as um.")] = None,
    position_unit: Annotated[str | None, typer.Option("--position-unit", help="Unit of the first column.")] = None,
    height_unit: Annotated[str | None, typer.Option("--height-unit", help="Unit of the second column.")] = None,
    scales: Annotated[
        tuple[str, str] | None, typer.Option("--scales", help='Shortest and longest lag: "4 um" "0.2 mm".')
    ] = None,
    longest_wave: Annotated[
        str | None, typer.Option("--longest-wave", help='Longest wave, such as the cut-off of a filter: "0.8 mm".')
    ] = None,
    hardness: Annotated[
        str | None, typer.Option("--hardness", help='Hardness of the face, for the load that it requires: "3 GPa".')
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for plot and table.", parser=folder)
    ] = None,
    debug: Debug = False,
) -> None:
    """Fractal dimension, fractal roughness and contact stiffness of a measured profile or map."""
    with error_messages(debug):
        if out is not None:
            require_folder(out)
        from stickslip.cli import measured_roughness

        if hardness is not None:
            measured_roughness.require_hardness(hardness)
        measured = measured_roughness.measure(path, position_unit or unit, height_unit or unit, scales, longest_wave)
        print_rows(measured_roughness.rows(measured))
        for sentence in measured.fit.warnings:
            echo(f"Warning: {sentence}")
        for file in measured_roughness.write(out, measured) if out is not None else ():
            echo(f"Wrote {file}")
        lines = measured_roughness.study_lines(measured, hardness)
        echo(measured_roughness.contact_message(measured, hardness))
        echo("\nNormal contact stiffness per area of a face of 1 cm2 with the waves of the measurement:")
        print_rows(measured_roughness.stiffness_rows(measured, hardness))
        for sentence in measured_roughness.one_spot_messages(measured, hardness):
            echo(f"Warning: {sentence}")
        echo(f"\nFor the study file:\n{lines.rstrip()}")


def fit(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="Loops: displacement and force.", show_default=False)],
    normal_load: Annotated[
        str | None, typer.Option("--normal-load", help='Normal load of the measurement: "90 N".')
    ] = None,
    predict: Annotated[
        str | None, typer.Option("--predict", help='Energy per cycle at another normal load, such as "160 N".')
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for plot and table.", parser=folder)
    ] = None,
    debug: Debug = False,
) -> None:
    """Tangential stiffness, friction limit and backlash of measured hysteresis loops."""
    with error_messages(debug):
        if out is not None:
            require_folder(out)
        from stickslip.cli import measured_loops

        fit = measured_loops.fit_file(path, normal_load)
        other = measured_loops.predicted_rows(fit, predict)
        print_rows(measured_loops.rows(fit))
        for sentence in fit.warnings:
            echo(f"Warning: {sentence}")
        for file in measured_loops.write(out, fit) if out is not None else ():
            echo(f"Wrote {file}")
        if other:
            echo(f"\nAt a normal load of {predict}, with the same friction coefficient, stiffness and backlash:")
            print_rows(other)
        echo(f"\nFor the study file:\n{measured_loops.study_lines(fit)}")


def import_model(
    path: Annotated[Path, typer.Argument(metavar="FILE", help=".inp, .bdf, .msh, .vtu, ...", show_default=False)],
    length_unit: Annotated[
        str | None, typer.Option("--length-unit", help="Unit of the coordinates: mm, m, ...")
    ] = None,
    unit_system: Annotated[
        str | None, typer.Option("--unit-system", help="System of materials: mm-t-s, SI, ...")
    ] = None,
    includes_outside: Annotated[
        bool, typer.Option("--includes-outside", help="Let a deck include files outside of its folder.")
    ] = False,
    temperature: Annotated[
        float | None, typer.Option("--temperature", help="Of material constants that depend on it, in the file's unit.")
    ] = None,
    debug: Debug = False,
) -> None:
    """Show bodies, sets, masses and size of a model file."""
    with error_messages(debug):
        from stickslip.cli.model_listing import print_model

        print_model(path, length_unit, unit_system, includes_outside, temperature)
