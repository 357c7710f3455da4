"""One case from study file to report: build, solve, save, show. Files are written whole or not at all."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from threadpoolctl import threadpool_limits

from stickslip.contact.pairing.pairing import FacePairs
from stickslip.core.errors import ConvergenceError, InputError, ResultsFileError
from stickslip.core.files import require_folder, write_solved
from stickslip.core.plausible import suspecting
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import thread_count
from stickslip.core.validation import FloatArray
from stickslip.model.joint import odd_values
from stickslip.model.layout import Derived
from stickslip.model.model import Model, ReducedModel, build_model, kind_of, load_joint, set_up
from stickslip.model.solved_preload import resting_pairs
from stickslip.results.measures import hertz, summary, summary_table
from stickslip.results.record import StudyRecord, run_provenance
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import load_results, results_bytes
from stickslip.solve.forced import forced_response
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.structure.craig_bampton import ReductionRow, reduction_table
from stickslip.structure.elasticity import Structure
from stickslip.structure.joined import joined_modes
from stickslip.structure.superelement import RIGID_BODY_HZ, Superelement
from stickslip.study.facts import (
    compared_tractions,
    derived_quantities,
    natural_frequencies_found,
    resting_state,
    sizes,
    study_warnings,
)
from stickslip.study.figure_process import PAGE_GRID, Drawing, SecondProcess, rough_patch
from stickslip.study.places import (
    FIGURE_FOLDER,
    MODES_FILE,
    PERIOD_FILE,
    REPORT_FILE,
    RESULTS_FILE,
    require_places,
    require_room_for,
)
from stickslip.study.sketching import MeshMotion, motion_at_peak, sketch_of

if TYPE_CHECKING:
    from stickslip.case.case import Case

MODE_COUNT = 10
SHOWN_FREQUENCIES = 4
TIED, CLOSED_AT_REST = "tied", "(pairs closed at rest)"


@dataclass(frozen=True)
class StudyOutcome:
    """What a run gave: the response, the files it wrote, and how it ended."""

    response: ForcedResponse
    files: tuple[Path, ...]
    converged: bool
    message: str


def run(
    case: Case, out_dir: str | PathLike[str], progress: Progress | None = None, threads: int | None = None
) -> StudyOutcome:
    """Solve a case and write results.nc, report.html, single figures, and shapes for ParaView into ``out_dir``.

    A curve that could not be followed to its end is written all the same; ``converged`` is then False. ``threads`` None
    takes the environment variable STICKSLIP_THREADS, or else the usable cores, at most 4.
    Raises InputError (geometry, roughness), PlaceError (folder, room on the disk), ConvergenceError (not even a first
    point), ResultsFileError.
    """
    out, count = Path(out_dir), thread_count(threads)
    require_places(out)
    # One thread for the matrix products here: beside threads that solve for many right-hand sides more would be slower.
    with threadpool_limits(limits=1), SecondProcess(Drawing(out / FIGURE_FOLDER, case)) as artist:
        return _run(case, out, progress or SilentProgress(), count, artist)


def _run(case: Case, out: Path, progress: Progress, threads: int, artist: SecondProcess) -> StudyOutcome:
    progress.update("Structure", 0.0, "mesh and matrices")
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    structure = setup.assemble()
    model = build_model(
        case, structure, joint, threads, lambda share, detail: progress.update("Structure", 0.1 + 0.7 * share, detail)
    )
    progress.update("Structure", 0.8, "full against reduced frequencies")
    table = compare_modes(structure, model.superelement, joint.face_pairs, model.pairs.resting_stiffness())
    progress.update("Structure", 1.0, f"{model.superelement.size} unknowns, {model.pairs.n_pairs} pairs")
    require_room_for(case, model, out)
    response = solve(case, model, progress, threads)
    motion = motion_at_peak(model, response)
    record = study_record(case, model, table, response)
    record = replace(
        record,
        derived=(*record.derived, *_with_other_tractions(case, model, response, progress, threads)),
        sketch=sketch_of(case, model, motion),
        rough_patch=rough_patch(case, PAGE_GRID),
    )
    progress.update("Files", 0.0, RESULTS_FILE)
    artist.start(response, record)
    then = '"stickslip report" makes the report of it'
    write_solved(out / RESULTS_FILE, results_bytes(response, record), "results", ResultsFileError, then)
    with _kept_results(out):
        progress.update("Files", 0.3, REPORT_FILE)
        page = _page(out, response, record)
        progress.update("Files", 0.5, "shapes for ParaView")
        shapes = [*setup.write_places(out), *_shapes(out, case, model, motion)]
        progress.update("Files", 0.7, FIGURE_FOLDER)
        files = [out / RESULTS_FILE, page, *artist.files(), *shapes]
    progress.update("Files", 1.0, f"{len(files)} files")
    return StudyOutcome(response, tuple(files), response.converged, _closing_words(response, record))


@contextmanager
def _kept_results(out: Path) -> Iterator[None]:
    """Say of an error that the curve itself is safe."""
    try:
        yield
    except InputError as error:
        safe = f'The curve is safe in "{out / RESULTS_FILE}"; "stickslip report" makes the report of it.'
        raise error.reworded(f"{error} {safe}") from error


def solve(
    case: Case, model: ReducedModel, progress: Progress | None = None, threads: int | None = None
) -> ForcedResponse:
    """The forced response of a model with the settings of its case; provenance says inputs and versions."""
    settings, told = case.solver, progress or SilentProgress()
    compiling = "preparing; the first run on a machine compiles the friction law, about ten seconds"
    told.update("Response", 0.0, compiling)
    response = forced_response(
        model.superelement,
        model.pairs,
        model.force_cos,
        model.force_sin,
        frequency_hz=(settings.frequency_start, settings.frequency_stop),
        harmonics=settings.harmonics,
        samples=settings.samples,
        modal_damping_ratio=case.damping.modal_damping_ratio,
        update=settings.update,
        newton=NewtonSettings(tolerance=settings.tolerance),
        continuation=ContinuationSettings(
            largest_step=settings.largest_step,
            smallest_step=settings.smallest_step,
            first_step=settings.first_step,
        ),
        threads=threads,
        progress=lambda fraction, detail: told.update("Response", fraction, detail),
    )
    return replace(response, provenance={**response.provenance, **run_provenance()})


def _with_other_tractions(
    case: Case, model: ReducedModel, response: ForcedResponse, progress: Progress, threads: int
) -> tuple[Derived, ...]:
    """The peak with the tractions at rest treated the other way, where the preload was solved."""
    if model.preload is None:
        return ()
    output, other = next(iter(model.outputs.values())), model.preload.other
    if other is None:
        return compared_tractions(case, response, model.preload.why, output)
    kept = case.preload.residual_traction != "kept"
    changed = replace(model, pairs=resting_pairs(model.joint, model.superelement, other, kept))
    try:
        return compared_tractions(case, response, solve(case, changed, progress, threads), output)
    except ConvergenceError as error:
        return compared_tractions(case, response, str(error), output)


def compare_modes(
    structure: Structure | Superelement, superelement: Superelement, pairs: FacePairs, springs: FloatArray | None = None
) -> tuple[ReductionRow, ...]:
    """Frequencies of the full and the reduced model, with the pairs held as :func:`held_contact` says.

    ``springs`` (3 * n_pairs,) N/m are 0 where a pair is open at rest; None takes all pairs as closed. Empty for a
    structure that is given by matrices, and for pairs that are not tied where no springs are given.
    """
    tied = held_contact(pairs, springs is None or bool(springs.all())) == TIED
    if isinstance(structure, Superelement) or not (tied or springs is not None):
        return ()
    return reduction_table(structure, superelement, pairs, count=MODE_COUNT, springs=None if tied else springs)


def held_contact(pairs: FacePairs, all_closed: bool) -> str:
    """How the mode table holds the pairs: tied where all nodes meet nodes, else stuck on their springs.

    A pair that is open at rest is left open, as the linear stuck curve leaves it; a joint with such a pair (not
    ``all_closed``) is never tied, since ties would close it.
    """
    if not all_closed:
        return f"stuck {CLOSED_AT_REST}"
    return TIED if pairs.is_matching else "stuck"


def study_record(
    case: Case, model: ReducedModel, table: tuple[ReductionRow, ...], response: ForcedResponse
) -> StudyRecord:
    """What the report shows beside the response, but for the sketch, which the cases of a sweep have in common."""
    pairs = model.joint.face_pairs
    held = held_contact(pairs, bool(model.pairs.closed_at_rest.all()))
    return StudyRecord(
        title=case.study.title,
        description=kind_of(case).description(case),
        inputs=case.to_text(),
        outputs=dict(model.outputs),
        signal_groups=dict(model.signal_groups),
        face_names=model.joint.face_names,
        pair_face=pairs.face,
        pair_position=pairs.face_position[:, ::-1],  # along the damper first, then up the slope
        pair_area=pairs.area,
        mode_table=tuple(_mode_rows(table, fitted=held == TIED and kind_of(case).is_fitted(case))),
        mode_contact=held,
        derived=(*derived_quantities(case, model.joint), *resting_state(model), *natural_frequencies_found(response)),
        warnings=study_warnings(case, model.joint),
    )


def _mode_rows(table: tuple[ReductionRow, ...], fitted: bool) -> Iterator[dict[str, str | float | int]]:
    """Rows of the mode table; the paper's column only beside tied contact of the geometry that was fitted to it."""
    for row in table:
        cells: dict[str, str | float | int] = {
            "mode": row.mode,
            "full_hz": row.full_hz,
            "reduced_hz": row.reduced_hz,
        }
        if not math.isnan(row.difference_percent):  # it is for a body that moves freely
            cells |= {"difference_percent": row.difference_percent, "mac": row.mac}
        if fitted and row.paper_full_hz is not None:
            cells["table2_hz"] = row.paper_full_hz
        yield cells


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


def _closing_words(response: ForcedResponse, record: StudyRecord) -> str:
    """How the curve ended, and its summary."""
    rows = summary_table(summary(response, record.outputs[record.response_output]))
    width = max(len(name) for name, _, _ in rows)
    lines = [f"{response.message} {response.n_points} points."]
    lines += [f"  {name:<{width}}  {value} {unit}" for name, value, unit in rows]
    lines += [f"Warning: {sentence}" for sentence in (*record.warnings, *response.warnings)]
    return "\n".join(lines)


def report(folder: str | PathLike[str]) -> tuple[Path, ...]:
    """Make the page of a solved study again, without solving. Raises ResultsFileError, InputError."""
    source = Path(folder) / RESULTS_FILE
    saved = load_results(source)
    if saved.study is None:
        raise ResultsFileError(
            f'"{source}" holds a response without a study, so there is nothing to say about faces and outputs. '
            'Only "stickslip run" writes files that the report needs.'
        )
    require_folder(Path(folder), files=(REPORT_FILE,))
    return (_page(Path(folder), saved.response, saved.study),)


def check(case: Case) -> list[tuple[str, list[tuple[str, str]]]]:
    """What would run, as sections of (label, value); builds the mesh and the joint, but reduces and solves nothing.

    Raises InputError where the geometry does not fit, RoughnessError for a contact without stiffness.
    """
    setup = set_up(case)
    joint = load_joint(case, setup.layout)
    structure = setup.assemble()
    numbers = [
        (name, f"{_short(value)} {unit}".rstrip("- ")) for name, value, unit, _ in derived_quantities(case, joint)
    ]
    solver = case.solver
    with suspecting(odd_values(case, setup.layout)):
        stuck_hz, _ = joined_modes(structure, joint.face_pairs, SHOWN_FREQUENCIES, joint.resting_springs)
    solved = case.preload.method == "solved"
    held = "" if joint.closed_at_rest.all() else " (pairs without a gap)" if solved else f" {CLOSED_AT_REST}"
    sections = [
        ("Sizes", list(sizes(case, setup, structure, joint))),
        ("Derived quantities", numbers),
        (
            "Would run",
            [
                ("sweep", f"{solver.frequency_start:g} to {solver.frequency_stop:g} Hz"),
                (f"first natural frequencies, contact stuck{held}", ", ".join(map(hertz, stuck_hz)) + " Hz"),
                ("excitation", kind_of(case).description(case)),
                ("resolution", f"{solver.harmonics} harmonics, {solver.samples} samples"),
            ],
        ),
    ]
    warnings = list(study_warnings(case, joint))
    if solved:
        warnings.append(
            "The preload is solved by a run: normal loads, stiffness and frequencies shown here are those of the "
            "pressure that the solution starts from, with every pair closed that has no gap."
        )
    if (stuck_hz < RIGID_BODY_HZ).any():
        warnings.append(
            "A frequency of 0 Hz is a body that moves freely: "
            + ("pairs without a gap" if solved else "the pairs closed at rest")
            + " do not hold it"
            + (", so the static load must close others." if solved else ", and a run refuses that.")
        )
    low, high = sorted((solver.frequency_start, solver.frequency_stop))
    if not ((stuck_hz >= low) & (stuck_hz <= high)).any():
        warnings.append("None of these natural frequencies lies in the sweep, so it may hold no resonance.")
    if warnings:
        sections.append(("Warnings", [(f"{i}.", sentence) for i, sentence in enumerate(warnings, start=1)]))
    return sections


def _short(value: str | float | int) -> str:
    if isinstance(value, float):
        return f"{value:.4g}" if math.isfinite(value) else "not defined"
    return str(value)
