"""The ridge of peaks: the highest maximum of an output, followed directly while a parameter changes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.core.completeness import reported
from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import finite_array
from stickslip.results.peak_ridge import PeakRidge
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.ridges.ridge_map import RidgeMap
from stickslip.solve.ridges.ridge_slope import STEP
from stickslip.solve.ridges.ridge_stage import Problem, RidgeOptions, RidgeStage, StageMaker
from stickslip.solve.setting_up import StageReport, checked_window


def peak_ridge(
    problem_at: Callable[[float], Problem],
    parameter: tuple[float, float],
    output: ArrayLike,
    *,
    frequency_hz: tuple[float, float],
    name: str = "parameter",
    unit: str = "",
    harmonics: int = 5,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
    raise_on_failure: bool = False,
) -> PeakRidge:
    """Follow the peaks of an output directly while a parameter changes.

    At each value the equations of a periodic motion are solved together with the stationarity of the amplitude along
    the frequency curve (docs/theory_ridge.md). Whole frequency curves are computed at both ends of the range; their
    peaks are followed over it, and the highest one counts.

    Parameters
    ----------
    problem_at:
        gives superelement, pairs and excitation at a value of the parameter.
    parameter:
        (start, stop) of the parameter, both above zero and rising; steps are in its logarithm.
    output:
        (n,) row whose 0-to-peak amplitude counts.
    frequency_hz:
        range in which peaks count.
    name, unit:
        of the parameter, for messages and figures.
    harmonics, samples, modal_damping_ratio, update, newton, threads, progress, raise_on_failure:
        as in :func:`forced_response`.

    Returns
    -------
    PeakRidge
        also if a ridge ends early: ``converged`` is then False and ``message`` gives the reason.

    Raises
    ------
    InputError
        for inputs that cannot be used. ConvergenceError if no peak can be followed.
    """
    bounds = checked_bounds(parameter)
    options = RidgeOptions(checked_window(frequency_hz), harmonics, samples, update, newton or NewtonSettings())
    report = StageReport(progress)
    row = finite_array("output", output)

    def stage_at(value: float, earlier: RidgeStage | None) -> RidgeStage:
        problem = problem_at(value)
        if row.shape != (problem[0].size,) or not row.any():
            raise InputError(
                f"output must have shape ({problem[0].size},) with an entry that is not zero.", arguments=["output"]
            )
        changed = partial(problem_at, value * (1.0 + STEP))
        return RidgeStage.of(problem, row, options, modal_damping_ratio, report, earlier, changed)

    return reported(ridge_between(stage_at, bounds, report, threads, name, unit), raise_on_failure)


def ridge_between(
    stage_at: StageMaker,
    bounds: tuple[float, float],
    report: StageReport,
    threads: int | None,
    name: str,
    unit: str,
    output_name: str = "",
) -> PeakRidge:
    """The ridges of the peaks of the curves at both ends of a range. Raises InputError, ConvergenceError."""
    began = time.perf_counter()
    first = stage_at(bounds[0], None)
    with solver_threads(thread_count(threads)):
        named = f"{name} = {{:.4g}} {unit}".rstrip().format
        ridges = RidgeMap(stage_at, bounds, report, named=named)
        for value in bounds:
            ridges.add_curve(value)
        ridges.refine()
        ridges.check_ends()
        result = ridges.result(name, unit, output_name)
    options = {
        "frequency_start_hz": first.window[0],
        "frequency_stop_hz": first.window[1],
        "harmonics": first.search.balance.harmonics,
        "samples": first.search.balance.samples,
    }
    report.stage(f"{result.n_points} points", 1.0)
    provenance = {"solve_seconds": f"{time.perf_counter() - began:.2f}"}
    return replace(result, settings={**options, **result.settings}, provenance=provenance)


def checked_bounds(parameter: tuple[float, float]) -> tuple[float, float]:
    """(start, stop). Raises InputError unless both are above zero and rise."""
    values = finite_array("parameter", parameter)
    if values.shape != (2,) or not 0.0 < values[0] < values[1]:
        raise InputError(
            f"parameter is {np.array2string(values, separator=', ')}, but it must be (start, stop), two values above "
            "zero, the first below the second: steps are in its logarithm.",
            arguments=["parameter"],
        )
    return float(values[0]), float(values[1])
