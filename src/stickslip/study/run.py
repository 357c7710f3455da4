"""One case from study file to report: build, solve, save, show. Files are written completely or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

from threadpoolctl import threadpool_limits

from stickslip.case.case import Case
from stickslip.core.completeness import reported
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.files import require_folder, write_solved
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import thread_count
from stickslip.model.model import Model
from stickslip.results.measures import summary, summary_table
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results, results_bytes
from stickslip.structure.joined import joined_modes
from stickslip.study.contact_file import write_contact
from stickslip.study.figure_process import PAGE_GRID, Drawing, NoFigures, SecondProcess, artist_of, rough_patch
from stickslip.study.performance_curve import with_performance_curve
from stickslip.study.places import (
    CASES_FOLDER,
    CONTACT_FILE,
    FIGURE_FOLDER,
    FRD_FILE,
    MODES_FILE,
    PERIOD_FILE,
    REPORT_FILE,
    RESULTS_FILE,
    STRESS_FILE,
    require_places,
    require_space_for,
)
from stickslip.study.record import changed_inputs
from stickslip.study.sketching import MeshMotion
from stickslip.study.solution import least_complete, reported_model, solved
from stickslip.study.stiffness_band import with_stiffness_band
from stickslip.study.stress import StressAtPeak
from stickslip.study.stress_summary import fields_of, stress_rows


@dataclass(frozen=True)
class StudyOutcome:
    """The result of a run: the response, the files, and a message on its end."""

    response: ForcedResponse
    files: tuple[Path, ...]
    converged: bool
    message: str


def run(
    case: Case,
    out_dir: str | PathLike[str],
    progress: Progress | None = None,
    threads: int | None = None,
    raise_on_failure: bool = False,
) -> StudyOutcome:
    """Solve a case and write results.nc, report.html, single figures, and shapes for ParaView into ``out_dir``.

    An incomplete curve is written too; ``converged`` is then False, with a NotConvergedWarning, or with
    ``raise_on_failure`` a ConvergenceError. ``threads`` None takes the environment variable STICKSLIP_THREADS, or else
    the usable cores, at most 4. Raises InputError (geometry, roughness), OutputError (folder, full disk),
    ConvergenceError (not even a first point), ResultsFileError.
    """
    outcome = unreported_run(case, out_dir, progress, threads)
    reported(least_complete(outcome.response), raise_on_failure)
    return outcome


def unreported_run(
    case: Case, out_dir: str | PathLike[str], progress: Progress | None = None, threads: int | None = None
) -> StudyOutcome:
    """:func:`run`, for a caller that reports an incomplete curve itself."""
    out, count = Path(out_dir), thread_count(threads)
    require_places(out)
    # One thread for matrix products here: more would slow down the threads that solve for many right-hand sides.
    with threadpool_limits(limits=1), artist_of(Drawing(out / FIGURE_FOLDER, case)) as artist:
        return _run(case, out, progress or SilentProgress(), count, artist)


def _run(case: Case, out: Path, progress: Progress, threads: int, artist: SecondProcess | NoFigures) -> StudyOutcome:
    setup, model = reported_model(case, progress, threads)
    require_space_for(case, model, out)
    solution = solved(case, model, progress, threads)
    response, record = solution.response, replace(solution.record, rough_patch=rough_patch(case, PAGE_GRID))
    progress.update("Files", 0.0, RESULTS_FILE)
    artist.start(response, record)
    then = '"stickslip report" writes its report'
    write_solved(out / RESULTS_FILE, results_bytes(response, record), "results", ResultsFileError, then)
    with _saved_results(out):
        # They take longer than the frequency curve, which is safe by now.
        response = with_stiffness_band(case, model, response, progress, threads)
        response = with_performance_curve(case, model, response, progress, threads)
        if response is not solution.response:
            write_solved(out / RESULTS_FILE, results_bytes(response, record), "results", ResultsFileError, then)
        progress.update("Files", 0.3, REPORT_FILE)
        page = _page(out, response, record)
        progress.update("Files", 0.5, "shapes for ParaView")
        shapes = [
            *setup.write_places(out),
            *_shapes(out, case, model, solution.motion),
            *_stress(out, solution.stress),
            *_contact(out, response, record),
            *_frd(out, model, case, solution.stress),
        ]
        progress.update("Files", 0.7, FIGURE_FOLDER)
        files = [out / RESULTS_FILE, page, *artist.files(), *shapes]
    progress.update("Files", 1.0, f"{len(files)} files")
    converged = least_complete(response).converged
    return StudyOutcome(response, tuple(files), converged, _closing_words(response, record))


@contextmanager
def _saved_results(out: Path) -> Iterator[None]:
    """Add to an error that the curve itself is saved."""
    try:
        yield
    except InputError as error:
        safe = f'The curve is in "{out / RESULTS_FILE}"; "stickslip report" writes its report.'
        raise error.reworded(f"{error} {safe}") from error


def _page(out: Path, response: ForcedResponse, record: StudyRecord) -> Path:
    """Write the page."""
    from stickslip.reporting.page import write_page

    write_page(out / REPORT_FILE, response, record, changed_inputs(record))
    return out / REPORT_FILE


def _shapes(out: Path, case: Case, model: Model, motion: MeshMotion | None) -> Iterator[Path]:
    """Mode shapes with the pairs closed at rest stuck, and one period of the mesh at the peak, for ParaView.

    Of a disk it is one period of its first sector, without mode shapes.
    """
    from stickslip.structure.export import write_deflected_period, write_mode_shapes

    mesh, count = model.in_study.mesh, case.output.mode_shapes
    if mesh is None or motion is None:
        return  # matrices
    if count and model.in_study.full_model is not None:
        springs = model.pairs.resting_stiffness()
        frequency_hz, modes = joined_modes(model.superelement, model.joint.face_pairs, count, springs)
        yield write_mode_shapes(out / MODES_FILE, mesh, modes, frequency_hz)
    if case.output.deflected_shape_frames:
        # an accuracy determines the harmonics only while the curve is solved
        coefficients = motion.own_coefficients
        frames = max(case.output.deflected_shape_frames, coefficients.shape[-1])
        yield write_deflected_period(out / PERIOD_FILE, mesh, coefficients, frames)


def _stress(out: Path, stress: StressAtPeak | None) -> Iterator[Path]:
    """Stress at the peak, for ParaView."""
    from stickslip.structure.export import write_nodal_fields

    if stress is not None:
        nodal = stress.nodal
        yield write_nodal_fields(out / STRESS_FILE, stress.mesh, nodal.node, nodal.body, fields_of(stress))


def _contact(out: Path, response: ForcedResponse, record: StudyRecord) -> Iterator[Path]:
    """Contact pairs at the peak, for ParaView; none for matrices without positions."""
    if record.pair_point is not None:
        yield write_contact(out / CONTACT_FILE, response, record)


def _frd(out: Path, model: Model, case: Case, stress: StressAtPeak | None) -> Iterator[Path]:
    """Motion and stress at the peak, for CalculiX."""
    from stickslip.study.frd_file import write_peak_frd

    if case.output.frd and stress is not None:
        yield write_peak_frd(out / FRD_FILE, stress, model.joint.layout.file_numbers)


def _closing_words(response: ForcedResponse, record: StudyRecord) -> str:
    """The message of the curve, and its summary."""
    rows = summary_table(summary(response, record.outputs[record.response_output]))
    rows += stress_rows(record.stress) if record.stress is not None else ()
    width = max(len(name) for name, _, _ in rows)
    lines = [f"{response.message} {response.n_points} points."]
    lines += [f"  {name:<{width}}  {_with_unit(value, unit)}" for name, value, unit in rows]
    lines += [f"Warning: {sentence}" for sentence in (*record.warnings, *response.warnings)]
    lines += [line for name, part in response.parts.items() for line in part.closing_words(name)]
    return "\n".join(lines)


def _with_unit(value: str, unit: str) -> str:
    """A value of the summary; without a unit where it has none, or where it is not available."""
    return value if "-" in (value, unit) else f"{value} {unit}"


def report(folder: str | PathLike[str]) -> tuple[Path, ...]:
    """Make the page of a solved study again, or the page of each case of a sweep, without solving.

    Raises ResultsFileError, InputError.
    """
    source = Path(folder) / RESULTS_FILE
    cases = sorted((Path(folder) / CASES_FOLDER).glob(f"*/{RESULTS_FILE}"))
    if cases and not source.exists():
        return tuple(page for case in cases for page in report(case.parent))
    saved = load_results(source)
    if saved.study is None:
        raise ResultsFileError(
            f'"{source}" contains a response without a study, and therefore no data of faces and outputs. '
            'Only "stickslip run" writes files for the report.'
        )
    require_folder(Path(folder), files=(REPORT_FILE,))
    return (_page(Path(folder), saved.response, saved.study),)
