"""The task of a worker for one case of a design: its curve, high peaks with gradients, and stress."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from stickslip.case.case import Case
from stickslip.case.continuous_keys import continuous_keys
from stickslip.core.errors import ConvergenceError, StickslipError
from stickslip.model.model import Model, load_joint
from stickslip.model.parameters import case_parameters
from stickslip.results.peaks import Peak, peaks
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import results_bytes
from stickslip.results.sweep_table import curve_and_measures
from stickslip.study.analyses import solve
from stickslip.study.gradients import gradients_of_peak
from stickslip.study.record import study_record
from stickslip.study.stress import largest_stresses_at_peak
from stickslip.sweeps.full_structure import full_structure
from stickslip.sweeps.plan import case_hashes
from stickslip.sweeps.task_reports import TaskProgress
from stickslip.sweeps.work import CASE_KEY, CaseOutcome

# chosen: peaks below this fraction of the highest one are far from becoming the highest within a step.
HIGH_FRACTION, MOST_PEAKS = 0.7, 3


@dataclass(frozen=True)
class DesignTask:
    """One case of a design to solve.

    gradient_keys:
        keys by which the high peaks are differentiated; () for none.
    wants_stress, wants_file:
        whether the stress at the peak, and the bytes of a results file, are computed.
    """

    case: Case
    key: str
    name: str
    gradient_keys: tuple[str, ...]
    wants_stress: bool
    threads: int
    wants_file: bool


def solve_design(task: DesignTask) -> CaseOutcome:
    """Solve one case; an error of stickslip becomes the message of an outcome."""
    try:
        with threadpool_limits(limits=task.threads):
            return _solved(task)
    except StickslipError as error:
        return CaseOutcome(converged=False, message=str(error), measures={})


def _solved(task: DesignTask) -> CaseOutcome:
    case = task.case
    structure = full_structure(case_hashes(case)[1], case, task.threads)
    model = structure.model(case, load_joint(case, structure.setup.layout))
    response = solve(case, model, TaskProgress(task.name), threads=task.threads, checks=False)
    response = replace(response, provenance={**response.provenance, CASE_KEY: task.key})
    record = study_record(case, model, (), response)
    curve, measures = curve_and_measures(response, record)
    output = next(iter(model.outputs.values()))
    high = _high_peaks(response, response.amplitude(output))
    details: dict[str, Any] = {"peaks": [], "messages": []}
    if response.converged:
        details["peaks"] = list(_details(task, model, response, high, details["messages"]))
    if response.converged and task.wants_stress:
        details["stresses"] = largest_stresses_at_peak(case, model, response)
    content = results_bytes(response, record) if task.wants_file else b""
    warnings = (*record.warnings, *response.warnings)
    return CaseOutcome(response.converged, response.message, measures, curve, warnings, content, details)


def _high_peaks(response: ForcedResponse, amplitude: np.ndarray) -> list[Peak]:
    """The peaks that may be the highest one of a design close by."""
    found = peaks(response.frequency_hz, amplitude, response.part)[:MOST_PEAKS]
    return [each for each in found if each.amplitude >= HIGH_FRACTION * found[0].amplitude]


def _details(
    task: DesignTask, model: Model, response: ForcedResponse, high: list[Peak], messages: list[str]
) -> Iterator[dict[str, Any]]:
    """The peaks, with derivatives by the keys in SI that have one; ``messages`` receives why others have none."""
    scale = {each.path: each.quantity.shown_unit[1] for each in continuous_keys(task.case)}
    parameters = [each for each in case_parameters(task.case, model) if each.name in task.gradient_keys]
    for number, peak in enumerate(high):
        entry: dict[str, Any] = {
            "amplitude_m": peak.amplitude,
            "frequency_hz": peak.frequency_hz,
            "bracketed": peak.bracketed,
        }
        if parameters and peak.bracketed:
            try:
                gradients = gradients_of_peak(task.case, model, response, parameters, task.threads, number)
            except ConvergenceError as error:
                messages.append(f"The peak at {peak.frequency_hz:.2f} Hz has no gradient: {error}")
            else:
                size = [scale[name] for name in gradients.names]
                entry |= {
                    "amplitude_m": float(gradients.amplitude),
                    "frequency_hz": float(gradients.frequency_hz),
                    "by_amplitude": dict(zip(gradients.names, (gradients.by_amplitude / size).tolist(), strict=True)),
                    "by_frequency_hz": dict(
                        zip(gradients.names, (gradients.by_frequency_hz / size).tolist(), strict=True)
                    ),
                }
                messages += gradients.messages
        yield entry
