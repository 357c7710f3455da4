"""The command line: ``stickslip new | check | run | sweep | band | design | report | compare | export | fit | ...``.

Exit codes: 0 done, 1 defect of the program, 2 bad input, 3 not converged (computed results remain), 130 interrupted,
128 + n stopped by signal n. Large packages are imported inside the commands, so that ``stickslip --help`` answers at
once.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stickslip.cli import input_commands, result_commands
from stickslip.cli.design_command import design
from stickslip.cli.errors import Debug, error_messages
from stickslip.cli.many_cases import (
    EXIT_NOT_CONVERGED,
    SHOWN_FAILURES,
    about_file,
    close_cases,
    load_study,
    pages_of_cases,
    require_one_place,
    solving,
    study_from,
    study_from_model,
)
from stickslip.cli.options import (
    FINISHED_CASES_NOTE,
    OutFolder,
    Quiet,
    Scheduler,
    StudyFile,
    Workers,
    WorkerThreads,
    folder,
    print_rows,
)
from stickslip.cli.process import tolerate_closed_output
from stickslip.core.errors import InputError, concerning
from stickslip.core.files import require_folder, whole_file
from stickslip.core.progress import terminal_progress
from stickslip.core.terminal import echo

if TYPE_CHECKING:
    from stickslip.case.case import Case
    from stickslip.study.run import StudyOutcome

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Forced vibration of structures with rough, dry-friction joints.",
)


TractionBand = Annotated[
    bool,
    typer.Option(
        "--traction-band",
        help="Bound the peak over the residual tractions of the pairs, as analysis.traction_band = true in FILE.",
    ),
]


def main() -> None:
    """Entry point of the command ``stickslip``."""
    tolerate_closed_output()
    app(prog_name="stickslip")


def _print_version(wanted: bool) -> None:
    if wanted:
        from stickslip import __version__

        echo(f"stickslip {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """The options before the command."""


@app.command()
def new(
    path: StudyFile,
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind",
            help="Structure: two-blade (default), bladed-disk, mesh (your own file) or matrices.",
            show_default=False,
        ),
    ] = None,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="STUDY|MODEL",
            help="Write this study file again, with the frequency range and the excitation that check proposes for it; "
            "or the study file of a model (.inp, .bdf, .cdb, ...) with its contact pairs as joints.",
            show_default=False,
        ),
    ] = None,
    length_unit: Annotated[
        str | None, typer.Option("--length-unit", help="With a model: unit of its coordinates: mm, m, ...")
    ] = None,
    unit_system: Annotated[
        str | None, typer.Option("--unit-system", help="With a model: system of its materials: mm-t-s, SI, ...")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
    debug: Debug = False,
) -> None:
    """Write a commented study file to start from."""
    with error_messages(debug):
        from stickslip.case.case import Case
        from stickslip.case.examples import EXAMPLES
        from stickslip.formats.meshes.read import is_model_file

        if kind is not None and source is not None:
            raise InputError("--kind and --from are both given, but the study of --from has a kind. Give one of them.")
        if kind is not None and kind not in EXAMPLES:
            raise InputError(f"--kind is {kind}, but it must be one of {', '.join(EXAMPLES)}.")

        if path.exists() and not force:
            raise InputError(f"{path} exists already. Give another name, or --force to overwrite it.")
        require_folder(path.parent, files=(path.name,))
        is_model = source is not None and is_model_file(source)
        if not is_model and (length_unit or unit_system):
            raise InputError("--length-unit and --unit-system belong to --from with a model file. Remove them.")
        with whole_file(path, "study file", InputError) as part:
            if source is None:
                text = Case.from_mapping(EXAMPLES[kind or "two-blade"]).to_text()
            elif is_model:
                text = study_from_model(source, path, length_unit, unit_system)
            else:
                text = study_from(source, path)
            part.write_text(text, encoding="utf-8")
        first = "complete its lines with # GIVE, then " if is_model else ""
        echo(f'Wrote {path}. Next: {first}stickslip check "{path}"')


@app.command()
def check(path: StudyFile, debug: Debug = False) -> None:
    """Validate a study file and show what would run."""
    with error_messages(debug):
        case, places = load_study(path, needs_range=False)
        from stickslip.study.assembled import Assembled
        from stickslip.study.check import check as checked
        from stickslip.study.proposal import proposed_section

        with about_file(places):
            assembled = Assembled.of(case)
            sections = [*checked(case, assembled), proposed_section(case, assembled)]
        for title, rows in sections:
            echo(f"\n{title}")
            print_rows(rows)


@app.command()
def run(
    path: StudyFile,
    out: OutFolder,
    threads: Annotated[
        int | None,
        typer.Option(
            "--threads",
            min=1,
            help="Threads; default STICKSLIP_THREADS, else the usable cores (at most 4).",
            show_default=False,
        ),
    ] = None,
    search: Annotated[
        bool,
        typer.Option("--search", help="Search for motions off the curve too, as analysis.search = true in FILE."),
    ] = False,
    ridge: Annotated[
        str | None,
        typer.Option(
            "--ridge",
            metavar="KEY=FROM:TO",
            help="Follow the peaks while a key of the study changes, such as "
            '"preload.centrifugal_force=50 N:5 kN"; as analysis.kind = "ridge" in FILE.',
            show_default=False,
        ),
    ] = None,
    gradients: Annotated[
        bool,
        typer.Option(
            "--gradients", help="Compute what each input changes at the peak, as analysis.gradients = true in FILE."
        ),
    ] = False,
    traction_band: TractionBand = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only errors.")] = False,
    debug: Debug = False,
) -> None:
    """Solve a study and write results, report and figures into DIR."""
    with error_messages(debug, log_folder=out):
        case, places = load_study(path, quiet)
        case = case.replace({"analysis.search": True}) if search else case
        case = case.replace(_ridge_keys(ridge, case)) if ridge is not None else case
        case = case.replace({"analysis.gradients": True}) if gradients else case
        case = case.replace({"analysis.traction_band": True}) if traction_band else case
        from stickslip.case.key_ranges import ridge_of_study

        with about_file(places):  # a wrong key or range is reported before a folder is created
            ridge_of_study(case)
        require_folder(out)  # before the packages of the solver are loaded, which takes seconds
        from stickslip.study import run as study

        with terminal_progress(quiet) as progress, about_file(places):
            outcome = study.unreported_run(case, out, progress=progress, threads=threads)
        _close(outcome, quiet)


def _ridge_keys(option: str, case: Case) -> dict[str, str]:
    """The keys of [analysis] of ``KEY=FROM:TO`` for a case. Raises InputError for another form."""
    key, equals, limits = (part.strip() for part in option.partition("="))
    start, colon, stop = (part.strip() for part in limits.partition(":"))
    if not (key and equals and start and colon and stop):
        raise InputError(
            f'--ridge "{option}" must be KEY=FROM:TO, for example --ridge "preload.centrifugal_force=50 N:5 kN".'
        )
    from stickslip.case.key_kinds import full_key

    range_keys = {"analysis.over_from": start, "analysis.over_to": stop}
    return {"analysis.kind": "ridge", "analysis.over": full_key(key, case), **range_keys}


@app.command()
def sweep(
    path: StudyFile,
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary",
            metavar="KEY=VALUES",
            help="A key of the study file and its values: a comma list (100,300 or single,same) or a range "
            "start:stop:count or start:stop:count:log. Several --vary give all combinations.",
            show_default=False,
        ),
    ],
    out: OutFolder,
    workers: Workers = None,
    scheduler: Scheduler = None,
    threads: WorkerThreads = 1,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Solve a study for all combinations of some values; resumes an earlier sweep into DIR."""
    with error_messages(debug, log_folder=out, closing=FINISHED_CASES_NOTE):
        require_one_place(workers, scheduler)
        case, places = load_study(path, quiet)
        from dataclasses import replace

        from stickslip.sweeps import axes, run

        varied = axes.split_options(vary, case=case)
        axes.swept_keys(varied, case)  # a wrong key is reported before a folder is created or a cluster is contacted
        require_folder(out)
        with solving(replace(places, varied=tuple(varied)), scheduler, quiet) as (progress, executor):
            result = run.sweep(case, varied, executor, out, progress, workers=workers, threads=threads)
            pages_of_cases(result, out, progress)
        close_cases(result, quiet, "cases")


@app.command()
def band(
    path: StudyFile,
    out: OutFolder,
    scatter: Annotated[
        list[str] | None,
        typer.Option(
            "--scatter",
            metavar="KEY=DISTRIBUTION",
            help='A key of the study file and its distribution, for example friction.coefficient="0.3 +- 0.1". FILE '
            "itself may have distributions.",
            show_default=False,
        ),
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option(
            "--limit",
            metavar="REQUIREMENT",
            help='Compute the probability to exceed it, for example "peak_amplitude < 0.2 mm" or "stress < 300 MPa".',
            show_default=False,
        ),
    ] = None,
    samples: Annotated[int, typer.Option("--samples", min=8, help="Number of samples, best a power of two.")] = 64,
    traction_band: TractionBand = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    threads: WorkerThreads = 1,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Percentiles of curve, peak and frequency with distributed inputs; resumes an earlier band into DIR."""
    with error_messages(debug, log_folder=out, closing=FINISHED_CASES_NOTE):
        require_one_place(workers, scheduler)
        case, places = load_study(path, quiet, central=False)
        case = case.replace({"analysis.traction_band": True}) if traction_band else case
        from dataclasses import replace

        from stickslip.reporting.band_page import band_in_words
        from stickslip.sweeps import axes, distributions
        from stickslip.sweeps import band as bands

        given = axes.split_options(scatter or [], "--scatter", 'friction.coefficient="0.3 +- 0.1"', case)
        places = replace(places, varied=tuple(given), option="--scatter")
        chosen, limits = {**places.scattered, **given}, limit or []
        with about_file(places):  # reported before a folder is created or a cluster is contacted
            for key in chosen:
                with concerning(key):
                    distributions.distributions({key: chosen[key]}, case)
            bands.require_limits(limits, samples, case)
        require_folder(out)
        with solving(places, scheduler, quiet) as (progress, executor):
            result = bands.band(
                case, chosen, executor, out, progress, samples=samples, limits=limits, workers=workers, threads=threads
            )
        if not quiet:
            for sentence in band_in_words(result):
                echo(sentence)
        close_cases(result, quiet, "samples")


for _command in (
    design,
    result_commands.report,
    result_commands.compare,
    result_commands.export,
    input_commands.roughness,
    input_commands.fit,
):
    app.command()(_command)
app.command("import")(input_commands.import_model)


@app.command()
def paper(
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder of the study.", show_default=False, parser=folder)
    ],
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes.")] = 2,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only errors.")] = False,
    debug: Debug = False,
) -> None:
    """Compute a published study again, with a verdict on each of its claims; resumes an interrupted run."""
    with error_messages(debug, log_folder=out, closing=FINISHED_CASES_NOTE.replace("cases", "curves")):
        from stickslip.papers.rough_damper.study import paper_study

        with terminal_progress(quiet) as progress:
            outcome = paper_study(out, workers, progress)
        for notice in outcome.notices:
            echo(notice, err=True)
        if not quiet:
            echo(f"Wrote {outcome.files[0]} and {len(outcome.files) - 1} other files.")
            words = ", ".join(f"{verdict.value}: {count}" for verdict, count in outcome.verdicts.items())
            echo(f"{outcome.curves} curves, {outcome.reused} of them from an earlier run. Claims: {words}.")
        for failure in outcome.failures[:SHOWN_FAILURES]:
            echo(f"Failed: {failure.setting}: {failure.message}", err=True)
        if outcome.failures:
            raise typer.Exit(EXIT_NOT_CONVERGED)


def _close(outcome: StudyOutcome, quiet: bool) -> None:
    """Report the files and the message of the run; raises the exit of a run that did not converge."""
    if not outcome.converged:
        files = ", ".join(str(file) for file in outcome.files)
        echo(f"Not converged: {outcome.message}", err=True)
        echo(f"The computed part is in: {files}" if files else "There is no result.", err=True)
        raise typer.Exit(EXIT_NOT_CONVERGED)
    if not quiet:
        for file in outcome.files:
            echo(f"Wrote {file}")
        echo(outcome.message)
