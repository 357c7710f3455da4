"""The command ``stickslip design``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from stickslip.cli.errors import Debug, error_messages
from stickslip.cli.many_cases import EXIT_NOT_CONVERGED, about_file, load_study, require_one_place, solving
from stickslip.cli.options import FINISHED_CASES_NOTE, OutFolder, Quiet, Scheduler, StudyFile, Workers, WorkerThreads
from stickslip.core.files import require_folder
from stickslip.core.terminal import echo

if TYPE_CHECKING:
    from stickslip.sweeps.design import Design


def design(
    path: StudyFile,
    over: Annotated[
        list[str],
        typer.Option(
            "--over",
            metavar="KEY=FROM:TO",
            help='A key of the study file and its range, for example "preload.centrifugal_force=50 N:5 kN". Several '
            "--over vary together.",
            show_default=False,
        ),
    ],
    out: OutFolder,
    minimise: Annotated[
        str, typer.Option("--minimise", metavar="MEASURE", help="peak, peak_frequency, stress or alternating_stress.")
    ] = "peak",
    subject_to: Annotated[
        list[str] | None,
        typer.Option(
            "--subject-to",
            metavar="LIMIT",
            help='A limit of such a measure, for example "stress < 300 MPa" or "peak_frequency > 400 Hz".',
            show_default=False,
        ),
    ] = None,
    worst_of: Annotated[
        list[str] | None,
        typer.Option(
            "--worst-of",
            metavar="KEY=VALUES",
            help="Load cases: a key and its values, as --vary of a sweep. The worst of all combinations counts.",
            show_default=False,
        ),
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option("--samples", min=1, help="Samples of the ranges; default 8 for each key.", show_default=False),
    ] = None,
    starts: Annotated[int, typer.Option("--starts", min=1, help="Descents, from the best samples.")] = 3,
    workers: Workers = None,
    scheduler: Scheduler = None,
    threads: WorkerThreads = 1,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Find the values of keys that minimise the peak within limits; resumes an earlier design into DIR."""
    with error_messages(debug, log_folder=out, closing=FINISHED_CASES_NOTE):
        require_one_place(workers, scheduler)
        case, places = load_study(path, quiet)
        from dataclasses import replace

        from stickslip.sweeps import axes
        from stickslip.sweeps import design as designs
        from stickslip.sweeps.design_lock_up import lock_up_in_ranges

        ranges = axes.split_options(over, "--over", '"preload.centrifugal_force=50 N:5 kN"', case)
        loads = axes.split_options(worst_of or [], "--worst-of", "excitation.mode=single,same", case)
        limits = subject_to or []
        places = replace(places, varied=tuple(ranges), option="--over")
        with about_file(places):  # reported before a folder is created or a cluster is contacted
            space, _ = designs.checked_design(case, ranges, minimise, limits, loads)
            space.require_valid_box()
            cautions = list(lock_up_in_ranges(space))
        require_folder(out)
        for sentence in [] if quiet else cautions:
            echo(f"Note: {sentence}", err=True)
        with solving(places, scheduler, quiet) as (progress, executor):
            result = designs.design(
                case, ranges, executor, out, progress, minimise=minimise, subject_to=limits, worst_of=loads,
                samples=samples, starts=starts, workers=workers, threads=threads,
            )  # fmt: skip
        _close(result, quiet)


def _close(result: Design, quiet: bool) -> None:
    """Report the files, the optimum and the remarks; raises the exit of a design without an optimum."""
    for notice in result.notices:
        echo(notice, err=True)
    if not quiet:
        for file in result.files:
            echo(f"Wrote {file}")
        echo(f"{len(result.evaluations)} designs; {result.solved} cases solved, {result.reused} from an earlier run.")
    best = result.optimum
    if best is None:
        echo(result.remarks[0], err=True)
        raise typer.Exit(EXIT_NOT_CONVERGED)
    if quiet:
        return
    width = max(len(key.name) for key in result.keys)
    for key, value, along in zip(result.keys, best.values, result.sharpness, strict=True):
        ends = [None if end is None else key.label(end) for end in (along.lower, along.upper)]
        cost = " and ".join(end for end in ends if end is not None)
        words = f"5 % more at {cost}" if cost else "5 % more nowhere in the range"
        echo(f"  {key.name:<{width}}  {key.label(value)} ({words})")
    rows = [(result.measure, best.objective)]
    rows += [(limit.measure, value) for limit, value in zip(result.limits, best.required, strict=True)]
    for measure, number in rows:
        factor, unit = {"m": (1e6, "um"), "Pa": (1e-6, "MPa")}.get(measure.unit, (1.0, measure.unit))
        echo(f"  {measure.words:<{width}}  {factor * number:.5g} {unit}")
    for sentence in result.remarks:
        echo(sentence)
