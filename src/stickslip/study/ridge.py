"""Ridges of peaks of a case over a key of its study file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from stickslip.case.case import Case
from stickslip.case.key_ranges import CaseFamily, Limits
from stickslip.core.completeness import reported
from stickslip.core.errors import RoughnessError, concerning
from stickslip.core.progress import Progress, SilentProgress
from stickslip.core.threads import thread_count
from stickslip.model.joint import Joint
from stickslip.model.layout import Layout
from stickslip.model.model import ReducedModel, build_model, connect, load_joint, set_up
from stickslip.results.peak_ridge import PeakRidge
from stickslip.results.record import run_provenance
from stickslip.solve.forced import DEFAULT_HARMONICS
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.ridges.ridge import ridge_between
from stickslip.solve.ridges.ridge_slope import STEP
from stickslip.solve.ridges.ridge_stage import Problem, RidgeOptions, RidgeStage
from stickslip.solve.setting_up import StageReport


def _problem(model: ReducedModel) -> Problem:
    return model.superelement, model.pairs, model.excitation


@dataclass(frozen=True)
class CaseStages:
    """The equations of a family of cases at each value; ``model`` is that of the case of the family."""

    family: CaseFamily
    model: ReducedModel
    report: StageReport
    threads: int
    options: RidgeOptions

    def __call__(self, value: float, earlier: RidgeStage | None) -> RidgeStage:
        """Raises InputError, RoughnessError, ConvergenceError (solved preload)."""
        case = self.family.at(value)
        model = self.model_at(case)
        output = next(iter(model.outputs.values()))
        ratio = case.damping.modal_damping_ratio
        # A new structure, or a new state at rest, takes longer than a peak.
        is_quick = not self.family.changes_structure and case.preload.method == "prescribed"

        def changed() -> Problem:
            return _problem(self.model_at(self.family.at(value * (1.0 + STEP))))

        return RidgeStage.of(
            _problem(model), output, self.options, ratio, self.report, earlier, changed if is_quick else None
        )

    def model_at(self, case: Case) -> ReducedModel:
        """The model of a case of the family."""
        if self.family.changes_structure:
            return build_model(case, threads=self.threads)
        return connect(case, self.model.reduced, load_joint(case, self.model.joint.layout), compare=False)


def ridge_options(case: Case, tolerance: float, harmonics: int | None = None) -> RidgeOptions:
    """The options of [solver], with a tolerance of Newton's method; with ``solver.accuracy``, which gives no number,
    the ``harmonics``."""
    settings = case.solver
    return RidgeOptions(
        (settings.frequency_start, settings.frequency_stop),
        settings.harmonics or harmonics or DEFAULT_HARMONICS,
        settings.samples,
        settings.update,
        NewtonSettings(tolerance=tolerance),
    )


def checked_range(case: Case, key: str, limits: Limits, layout: Layout) -> tuple[CaseFamily, tuple[float, float]]:
    """The family of a key and its range in SI units, after a check that both ends have a structure and a joint.

    Raises InputError, StudyFileError, and RoughnessError where the roughness gives no usable contact, or where a face
    has plastic spots alone at one end and elastic ones at the other: the fractal law jumps between.
    """
    family = CaseFamily.of(case, key)
    bounds = family.bounds(limits)
    require_joints(family, bounds, layout)
    return family, bounds


def require_joints(family: CaseFamily, bounds: tuple[float, float], layout: Layout) -> None:
    """Raise the errors of :func:`checked_range` on both ends of a range; ``layout`` is that of the case."""
    with concerning(family.key):
        joints = [
            load_joint(changed, set_up(changed).layout if family.changes_structure else layout)
            for changed in map(family.at, bounds)
        ]
        _require_no_jump(joints)


def _require_no_jump(joints: Sequence[Joint]) -> None:
    """Raise RoughnessError if the contact stiffness jumps between the two ends of a range."""
    first, last = (joint.faces_with_least_stiffness for joint in joints)
    if first != last:
        raise RoughnessError(
            "at one end of the range a face has plastic contact spots alone, at the other end elastic ones too, and "
            "the fractal law jumps between them, so no ridge can pass. Narrow the range to one side, or use "
            'roughness.law = "persson" or roughness.mode = "unloading", which have no jump.'
        )


def ridge(
    case: Case,
    key: str,
    limits: Limits,
    *,
    harmonics: int | None = None,
    model: ReducedModel | None = None,
    progress: Progress | None = None,
    threads: int | None = None,
    raise_on_failure: bool = False,
) -> PeakRidge:
    """Follow the peaks of the first output of a case while a key of its study file changes.

    Parameters
    ----------
    case:
        the study.
    key:
        a quantity, ``section.key`` or ``section.NAME.key``, such as "preload.centrifugal_force",
        "excitation.amplitude", "friction.coefficient", "roughness.fractal_dimension".
    limits:
        (from, to) of the key, each as in a study file: a number in SI units or a text with a unit; above zero, and
        rising.
    harmonics:
        of a case with ``solver.accuracy``, by default 5; those of its frequency curve have the accuracy.
    model:
        of the case, if it exists.
    progress, threads, raise_on_failure:
        as in :func:`solve_case`.

    Returns
    -------
    PeakRidge
        with the parameter in SI units; ``converged`` is False if the highest peak is not known over the whole range.

    Raises
    ------
    InputError
        for an unknown key, and values that the key or its law does not allow; StudyFileError if they contradict other
        keys. ConvergenceError if no peak can be followed.
    """
    return reported(unreported_ridge(case, key, limits, harmonics, model, progress, threads), raise_on_failure)


def unreported_ridge(
    case: Case, key: str, limits: Limits, harmonics: int | None, model: ReducedModel | None,
    progress: Progress | None, threads: int | None,
) -> PeakRidge:  # fmt: skip
    """:func:`ridge`, for a caller that reports a ridge that ends early itself."""
    listener, count = progress or SilentProgress(), thread_count(threads)
    layout = set_up(case).layout if model is None else model.joint.layout
    family, bounds = checked_range(case, key, limits, layout)
    model = model or build_model(case, threads=count)
    report = StageReport(lambda fraction, detail: listener.update("Ridge of peaks", fraction, detail))
    stages = CaseStages(family, model, report, count, ridge_options(case, case.solver.tolerance, harmonics))
    name = next(iter(model.outputs))
    result = ridge_between(stages, bounds, report, count, key, family.quantity.si_unit, name)
    return replace(result, provenance={**result.provenance, **run_provenance()})
