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
from stickslip.model.layout import AnyStructure, Setup
from stickslip.model.model import Model, connect, kind_of, load_joint, reduce_structure, set_up
from stickslip.model.parameters import case_parameters
from stickslip.model.study_structure import ReducedStructure
from stickslip.results.design import ALTERNATING_STRESS, STRESS, STRESSES
from stickslip.results.peaks import Peak, peaks
from stickslip.results.response import ForcedResponse
from stickslip.results.storage import results_bytes
from stickslip.results.sweep_table import curve_and_measures
from stickslip.structure.stress_cycle import stress_cycle
from stickslip.study.analyses import solve
from stickslip.study.gradients import gradients_of_peak
from stickslip.study.record import study_record
from stickslip.study.stress import stress_at_peak
from stickslip.study.stress_summary import ALTERNATING as ALTERNATING_QUANTITY
from stickslip.study.stress_summary import LARGEST_VON_MISES, stress_summary
from stickslip.sweeps.plan import case_hashes
from stickslip.sweeps.task_reports import TaskProgress
from stickslip.sweeps.work import CASE_KEY, CaseOutcome

# chosen: peaks below this fraction of the highest one are far from becoming the highest within a step.
HIGH_FRACTION, MOST_PEAKS = 0.7, 3
_STORED_STRUCTURES = 2  # chosen: of a worker; the joint alone changes between most designs, or the structure each time
_structures: dict[str, tuple[Setup, AnyStructure, ReducedStructure]] = {}


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
    case, model = task.case, _model(task.case, task.threads)
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
        details["stresses"] = _stresses(case, model, response, high[0].amplitude)
    content = results_bytes(response, record) if task.wants_file else b""
    warnings = (*record.warnings, *response.warnings)
    return CaseOutcome(response.converged, response.message, measures, curve, warnings, content, details)


def _model(case: Case, threads: int) -> Model:
    """The model; structure and reduction of the last cases of this process are used again."""
    # A structure at a speed has the stress and the gradients of this speed, also where a reduction is valid for others.
    key = f"{case_hashes(case)[1]} {kind_of(case).rotation_speed(case)}"
    if key not in _structures:
        setup = set_up(case)
        structure = setup.assemble()
        while len(_structures) >= _STORED_STRUCTURES:
            del _structures[next(iter(_structures))]
        _structures[key] = setup, structure, reduce_structure(case, structure, setup.layout, threads)
    setup, structure, reduced = _structures[key]
    return Model(**vars(connect(case, reduced, load_joint(case, setup.layout))), structure=structure)


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


def _stresses(case: Case, model: Model, response: ForcedResponse, amplitude: float) -> dict[str, float]:
    """Largest stresses away from contacts and loads; the vibration is scaled from the computed point to the peak."""
    asked = case.replace({"output.stress": True})
    stress = stress_at_peak(asked, model, response)
    assert stress is not None  # see require_computed
    output = next(iter(model.outputs.values()))
    coefficients = stress.nodal.stress.copy()
    coefficients[..., 1:] *= amplitude / float(response.amplitude(output)[stress.point])
    scaled = replace(stress, cycle=stress_cycle(coefficients))
    summary = stress_summary(asked, model, response, scaled)
    quantities = {STRESS: LARGEST_VON_MISES, ALTERNATING_STRESS: ALTERNATING_QUANTITY}
    return {name: summary.extreme(quantities[name]).value for name in STRESSES}
