"""One case from study file to report: build, solve, save, show. Files are written completely or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

from threadpoolctl import threadpool_limits

from stickslip.case.case import Case
from stickslip.core.errors import InputError, ResultsFileError
from stickslip.core.files import require_folder, write_solved
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import thread_count
from stickslip.model.model import Model
from stickslip.results.measures import summary, summary_table
from stickslip.results.nonlinear_mode import NonlinearMode
from stickslip.results.peak_gradients import PeakGradients
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results, results_bytes
from stickslip.results.wear import Wear
from stickslip.structure.joined import joined_modes
from stickslip.structure.superelement import Superelement
from stickslip.study.figure_process import PAGE_GRID, Drawing, NoFigures, SecondProcess, artist_of, rough_patch
from stickslip.study.performance_curve import with_performance_curve
from stickslip.study.places import (
    FIGURE_FOLDER,
    MODES_FILE,
    PERIOD_FILE,
    REPORT_FILE,
    RESULTS_FILE,
    STRESS_FILE,
    require_places,
    require_space_for,
)
from stickslip.study.sketching import MeshMotion
from stickslip.study.solution import reported_model, solved
from stickslip.study.stiffness_band import with_stiffness_band
from stickslip.study.stress import StressAtPeak
from stickslip.study.stress_summary import fields_of, stress_rows

STRONGEST = 5  # chosen: inputs whose gradients the command prints; the page has all


@dataclass(frozen=True)
class StudyOutcome:
    """The result of a run: the response, the files, and a message on its end."""

    response: ForcedResponse
    files: tuple[Path, ...]
    converged: bool
    message: str


def run(
    case: Case, out_dir: str | PathLike[str], progress: Progress | None = None, threads: int | None = None
) -> StudyOutcome:
    """Solve a case and write results.nc, report.html, single figures, and shapes for ParaView into ``out_dir``.

    An incomplete curve is written too; ``converged`` is then False. ``threads`` None takes the environment variable
    STICKSLIP_THREADS, or else the usable cores, at most 4. Raises InputError (geometry, roughness), OutputError
    (folder, full disk), ConvergenceError (not even a first point), ResultsFileError.
    """
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
        ]
        progress.update("Files", 0.7, FIGURE_FOLDER)
        files = [out / RESULTS_FILE, page, *artist.files(), *shapes]
    progress.update("Files", 1.0, f"{len(files)} files")
    mode = response.nonlinear_mode
    ridge = response.peak_ridge
    besides = (mode, ridge, response.wear)
    converged = response.converged and all(each is None or each.converged for each in besides)
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

    write_page(out / REPORT_FILE, response, record)
    return out / REPORT_FILE


def _shapes(out: Path, case: Case, model: Model, motion: MeshMotion | None) -> Iterator[Path]:
    """Mode shapes with the pairs closed at rest stuck, and one period of the mesh at the peak, for ParaView."""
    from stickslip.structure.export import write_deflected_period, write_mode_shapes

    if isinstance(model.structure, Superelement) or motion is None:
        return  # matrices without a mesh
    mesh, count = model.structure.mesh, case.output.mode_shapes
    if count:
        springs = model.pairs.resting_stiffness()
        frequency_hz, modes = joined_modes(model.superelement, model.joint.face_pairs, count, springs)
        yield write_mode_shapes(out / MODES_FILE, mesh, modes, frequency_hz)
    frames = case.output.deflected_shape_frames
    if frames:
        yield write_deflected_period(out / PERIOD_FILE, mesh, motion.displacement, frames)


def _stress(out: Path, stress: StressAtPeak | None) -> Iterator[Path]:
    """Stress at the peak, for ParaView."""
    from stickslip.structure.export import write_nodal_fields

    if stress is not None:
        nodal = stress.nodal
        yield write_nodal_fields(out / STRESS_FILE, stress.mesh, nodal.node, nodal.body, fields_of(stress))


def _closing_words(response: ForcedResponse, record: StudyRecord) -> str:
    """The message of the curve, and its summary."""
    rows = summary_table(summary(response, record.outputs[record.response_output]))
    rows += stress_rows(record.stress) if record.stress is not None else ()
    width = max(len(name) for name, _, _ in rows)
    lines = [f"{response.message} {response.n_points} points."]
    lines += [f"  {name:<{width}}  {value} {unit}" for name, value, unit in rows]
    lines += [f"Warning: {sentence}" for sentence in (*record.warnings, *response.warnings)]
    if response.nonlinear_mode is not None:
        lines += _words_of_mode(response.nonlinear_mode)
    for title, ridge in (("Performance curve", response.performance_curve), ("Ridge of peaks", response.peak_ridge)):
        if ridge is not None:
            lines += _words_of_ridge(title, ridge)
    if response.wear is not None:
        lines += _words_of_wear(response.wear)
    if response.gradients is not None:
        lines += _words_of_gradients(response.gradients)
    return "\n".join(lines)


def _words_of_ridge(title: str, ridge: PeakRidge) -> Iterator[str]:
    """The message of a ridge of peaks, its optimum, and its warnings."""
    yield f"{title}: {ridge.message} {ridge.n_points} peaks."
    yield from (f"  {sentence}" for sentence in ridge.words())
    yield from (f"Warning: {sentence}" for sentence in ridge.warnings)


def _words_of_wear(wear: Wear) -> Iterator[str]:
    """The message of the wear, what it removes and changes, and its warnings."""
    yield f"Wear: {wear.message} {wear.n_states} states."
    yield from (f"  {sentence}" for sentence in wear.words())
    yield from (f"Warning: {sentence}" for sentence in wear.warnings)


def _words_of_mode(mode: NonlinearMode) -> Iterator[str]:
    """The message of a nonlinear mode, its range, and its warnings."""
    yield f"Nonlinear mode {mode.mode}: {mode.message} {mode.n_points} points."
    low, high = mode.damping_ratio.min(), mode.damping_ratio.max()
    yield f"  frequency      {mode.frequency_hz.min():.2f} to {mode.frequency_hz.max():.2f} Hz"
    yield f"  damping ratio  {100 * low:.3g} to {100 * high:.3g} %"
    yield from (f"Warning: {sentence}" for sentence in mode.warnings)


def _words_of_gradients(gradients: PeakGradients) -> Iterator[str]:
    """The strongest inputs, and the messages."""
    yield "Change of the peak amplitude by 10 % more of an input, first order:"
    changes, strongest = gradients.relative_changes(0.1)[0], gradients.order[:STRONGEST]
    width = max((len(gradients.names[place]) for place in strongest), default=0)
    yield from (f"  {gradients.names[place]:<{width}}  {100 * changes[place]:+.2g} %" for place in strongest)
    yield from (f"Note: {sentence}" for sentence in gradients.messages)


def report(folder: str | PathLike[str]) -> tuple[Path, ...]:
    """Make the page of a solved study again, without solving. Raises ResultsFileError, InputError."""
    source = Path(folder) / RESULTS_FILE
    saved = load_results(source)
    if saved.study is None:
        raise ResultsFileError(
            f'"{source}" contains a response without a study, and therefore no data of faces and outputs. '
            'Only "stickslip run" writes files for the report.'
        )
    require_folder(Path(folder), files=(REPORT_FILE,))
    return (_page(Path(folder), saved.response, saved.study),)
