"""A case solved in memory: response, model and data for the report, without a folder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from threadpoolctl import threadpool_limits

from stickslip.case.case import Case
from stickslip.case.reference import MODE_COUNT
from stickslip.core.completeness import Ended, reported
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import thread_count
from stickslip.model.layout import Setup
from stickslip.model.model import Model, build_model
from stickslip.results.record import StudyRecord
from stickslip.results.response import ForcedResponse
from stickslip.study.assembled import Assembled
from stickslip.study.disk import DiskOfStudy
from stickslip.study.gradients import with_gradients
from stickslip.study.mode_doubts import reduction_doubts
from stickslip.study.mode_shapes import MeshShapes
from stickslip.study.nonlinear_mode import with_mode_doubts
from stickslip.study.pairs_that_move import solved_with_moving_pairs
from stickslip.study.record import compare_modes, study_record, with_constant_stiffness, with_other_tractions
from stickslip.study.sketching import MeshMotion, motion_at_peak, sketch_of
from stickslip.study.stress import StressAtPeak, stress_at_peak
from stickslip.study.stress_summary import NO_MESH, NO_SECTOR_STRESS, stress_summary, surface_stress


@dataclass(frozen=True)
class Solution:
    """A solved case.

    response:
        the curve; ``response.converged`` is False if it is incomplete.
    model:
        superelement, pairs, excitation and outputs by name.
    record:
        data for the report beside the response.
    motion:
        of the mesh at the peak of the first output; None for matrices without a mesh.
    stress:
        of the mesh over the period of this peak; None for matrices without a mesh, and if the case does not want it.
    """

    case: Case
    response: ForcedResponse
    model: Model
    record: StudyRecord
    motion: MeshMotion | None
    stress: StressAtPeak | None

    @property
    def converged(self) -> bool:
        """Whether the curve reaches its end."""
        return self.response.converged

    @property
    def message(self) -> str:
        """The message on the end of the curve."""
        return self.response.message

    def __repr__(self) -> str:
        start, stop = self.response.frequency_hz[[0, -1]]
        ending = "" if self.converged else ", not complete"
        return (
            f"Solution({self.case.study.title!r}: {self.response.n_points} points from {start:.2f} to {stop:.2f} Hz"
            f"{ending})"
        )

    def plot(self) -> Any:
        """The amplitude of the first output over the frequency with both linear limits, a matplotlib figure."""
        from stickslip.reporting.figures import amplitude_frequency

        return amplitude_frequency(self.response, self.record)


def solve_case(
    case: Case,
    progress: Progress | None = None,
    threads: int | None = None,
    raise_on_failure: bool = False,
) -> Solution:
    """Solve a case in memory; nothing is written.

    ``threads`` None takes the environment variable STICKSLIP_THREADS, or else the usable cores, at most 4. A curve,
    mode, ridge or wear that ends early gives a NotConvergedWarning, or with ``raise_on_failure`` a ConvergenceError.
    Raises InputError (geometry, roughness) and ConvergenceError (not even a first point).
    """
    count, listener = thread_count(threads), progress or SilentProgress()
    # One thread for matrix products here: more would slow down the threads that solve for many right-hand sides.
    with threadpool_limits(limits=1):
        _, model = reported_model(case, listener, count)
        solution = solved(case, model, listener, count)
    reported(least_complete(solution.response), raise_on_failure)
    return solution


def least_complete(response: ForcedResponse) -> Ended:
    """The curve, or of the analyses beside it the first one that ended early while the curve did not."""
    mode = response.nonlinear_mode or response.quasi_static_mode  # an estimate beside a mode is only its check
    results: tuple[Ended | None, ...] = (response, mode, response.peak_ridge, response.wear, response.mistuning)
    return next((each for each in results if each is not None and not each.converged), response)


def reported_model(case: Case, progress: Progress, threads: int) -> tuple[Setup, Model]:
    """The structure of a case before its matrices, and its model; ``progress`` receives the finished fraction."""
    progress.update("Structure", 0.0, "mesh and matrices")
    parts = Assembled.of(case)
    model = build_model(
        case,
        parts.structure,
        parts.joint,
        threads,
        lambda share, detail: progress.update("Structure", 0.1 + 0.7 * share, detail),
    )
    return parts.setup, model


def solved(case: Case, model: Model, progress: Progress, threads: int) -> Solution:
    """Solve a model and collect the data for its report."""
    progress.update("Structure", 0.8, "full against reduced frequencies")
    pairs = model.joint.face_pairs
    disk = DiskOfStudy.of(case, model)
    if disk is None:
        table = compare_modes(model.structure, model.superelement, pairs, model.pairs.resting_stiffness())
    else:
        table = disk.mode_rows(MODE_COUNT)
    doubts = reduction_doubts(case, model)
    progress.update("Structure", 1.0, f"{model.substructure.size} unknowns, {model.pairs.n_pairs} pairs")
    model, response = solved_with_moving_pairs(case, model, progress, threads)
    response = with_mode_doubts(response, doubts)
    if case.analysis.gradients:
        response = with_gradients(case, model, response, progress, threads)
    record = study_record(case, model, table, response)
    other = with_other_tractions(case, model, response, progress, threads)
    other = (*other, *with_constant_stiffness(case, model, response, progress, threads))
    motion = motion_at_peak(model, response, disk)
    progress.update("Stress", 0.0, "at the peak")
    stress, surface = stress_at_peak(case, model, response), None
    progress.update("Stress", 1.0, "none" if stress is None else f"{len(stress.nodal.node)} nodes")
    if stress is not None:
        record = replace(record, stress=stress_summary(case, model, response, stress))
        surface = partial(surface_stress, stress)
    elif case.output.stress:
        other = (*other, NO_MESH if model.in_study.mesh is None else NO_SECTOR_STRESS)
    sketch = sketch_of(case, model, motion, surface, disk, MeshShapes.of(model, response.nonlinear_mode))
    frequencies = None if disk is None else disk.frequencies()
    record = replace(record, derived=(*record.derived, *other), sketch=sketch, disk=frequencies)
    return Solution(case, response, model, record, motion, stress)
