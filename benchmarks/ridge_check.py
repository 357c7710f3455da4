"""Ridges of peaks against dense sweeps: one row for each key. Errors, points, and process time.

    python benchmarks/ridge_check.py              # all rows, about an hour on one core
    python benchmarks/ridge_check.py blade        # rows whose name begins so
    python benchmarks/ridge_check.py performance  # performance curves: process time over that of the study, and errors
    python benchmarks/ridge_check.py harmonics    # that of the default study against curves by its accuracy

Each row compares the highest peak of the ridge with that of whole frequency curves, with steps of at most FINE of the
range, at VALUES values over the range, most of them between the points of the ridge. The points of the ridge, those of
its two whole curves and of all its searches, are compared with those of DENSE curves with usual steps.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from blade_problem import load_blade_problem
from rough_casting import rough_casting
from threadpoolctl import threadpool_limits

import stickslip as ss
from stickslip.core.progress import SilentProgress
from stickslip.study.analyses import solve
from stickslip.study.performance_curve import with_performance_curve

VALUES, DENSE, FINE = 13, 40, 0.03
# Hz: from below the resonance without contact of the default study to above that with stuck contacts.
AROUND_BOTH = (410.0, 530.0)
STIFFNESS = {"normal_stiffness": 1.34e8, "tangential_stiffness": 1.11e8}


@dataclass(frozen=True)
class Row:
    """A key with its range, its ridge, and a whole curve at a value: its peak amplitude and its number of points."""

    name: str
    limits: tuple[float, float]
    ridge: Callable[[], ss.PeakRidge]
    curve: Callable[[float, float | None], tuple[float, int]]


def with_stiffness() -> ss.Case:
    """The rough casting with contact stiffnesses in place of its roughness."""
    sections = rough_casting().as_mapping(only_explicit=True)
    return ss.Case.from_mapping(
        {**{k: v for k, v in sections.items() if k != "roughness"}, "contact_stiffness": STIFFNESS}
    )


def case_row(key: str, limits: tuple[float, float], case: ss.Case | None = None) -> Row:
    """A row of a study of two blades, the rough casting by default."""
    case = case or rough_casting()

    def curve(value: float, step: float | None) -> tuple[float, int]:
        changed = case.replace({key: value if key != "roughness.fractal_roughness" else f"{value!r} m"})
        return case_curve(changed, step, changed.solver.harmonics)

    unit = " m" if key == "roughness.fractal_roughness" else ""
    texts = tuple(f"{limit!r}{unit}" if unit else limit for limit in limits)
    return Row(key, limits, lambda: ss.ridge(case, key, texts, threads=1), curve)


def case_curve(case: ss.Case, step: float | None, harmonics: int | None) -> tuple[float, int]:
    """Peak amplitude and number of points of the whole curve of a case."""
    model, solver = ss.build_model(case), case.solver
    response = ss.forced_response(
        model.superelement, model.pairs, model.excitation, harmonics=harmonics, samples=solver.samples,
        frequency_hz=(solver.frequency_start, solver.frequency_stop), threads=1,
        modal_damping_ratio=case.damping.modal_damping_ratio, continuation=settings(step),
    )  # fmt: skip
    return highest(response, next(iter(model.outputs.values())))


def blade_row(name: str, limits: tuple[float, float]) -> Row:
    """A row of the bench blade with 10 pairs: the force, or the normal load, times a factor."""
    problem = load_blade_problem(10)

    structure = ss.Superelement(problem.mass, problem.stiffness, problem.damping)

    def problem_at(factor: float) -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation]:
        of_force, of_load = (factor, 1.0) if name == "force" else (1.0, factor)
        pairs = ss.ContactPairs(
            problem.contact_operator(), problem.normal_stiffness, problem.tangential_stiffness,
            problem.friction_coefficient, of_load * problem.preload,
        )  # fmt: skip
        return structure, pairs, ss.Excitation.force(of_force * problem.force_cos, of_force * problem.force_sin)

    def curve(value: float, step: float | None) -> tuple[float, int]:
        superelement, pairs, excitation = problem_at(value)
        response = ss.forced_response(
            superelement, pairs, excitation, frequency_hz=problem.window_hz, harmonics=5, samples=256, threads=1,
            continuation=settings(step),
        )  # fmt: skip
        return highest(response, problem.output)

    def ridge() -> ss.PeakRidge:
        return ss.peak_ridge(problem_at, limits, problem.output, frequency_hz=problem.window_hz, threads=1)

    return Row(f"blade {name}", limits, ridge, curve)


def settings(step: float | None) -> ss.ContinuationSettings:
    """Usual steps, or steps of at most this fraction of the range."""
    return ss.ContinuationSettings() if step is None else ss.ContinuationSettings(largest_step=step)


def highest(response: ss.ForcedResponse, output: np.ndarray) -> tuple[float, int]:
    """Largest computed amplitude of a curve, and its number of points."""
    return float(response.amplitude(output).max()), response.n_points


ROWS = (
    lambda: case_row("preload.centrifugal_force", (30.0, 30_000.0)),
    lambda: case_row("excitation.amplitude", (30.0, 1000.0)),
    lambda: case_row("friction.coefficient", (0.1, 0.8)),
    lambda: case_row("contact_stiffness.tangential_stiffness", (3e7, 4e8), with_stiffness()),
    lambda: case_row("roughness.fractal_dimension", (2.38, 2.7)),
    lambda: case_row("roughness.fractal_roughness", (1e-9, 1e-7)),
    lambda: blade_row("force", (0.2, 3.0)),
    lambda: blade_row("normal load", (0.35, 5.0)),
)


def performance(name: str, case: ss.Case, ratios: tuple[float, ...]) -> None:
    """Print the process time of the performance curve of a study over that of its frequency curve, and its errors at
    some ratios of the forces against whole curves with fine steps."""
    seconds = []
    for with_curve in (False, False, True):  # the first compiles
        chosen = case.replace({"analysis.performance_curve": with_curve})
        model = ss.build_model(chosen)
        with threadpool_limits(limits=1):
            began = time.process_time()
            response = solve(chosen, model, threads=1)
            curve_seconds = time.process_time() - began
            began = time.process_time()
            response = with_performance_curve(chosen, model, response, SilentProgress(), 1)
            seconds = [curve_seconds, time.process_time() - began]
    curve = response.performance_curve
    print(f"{name}: {curve!r}: {curve.message}", *curve.words(), sep="\n")
    print(f"{seconds[1]:.1f} s over {seconds[0]:.1f} s of the frequency curve: {seconds[1] / seconds[0]:.2f}")
    points = sum(int(curve.settings[key]) for key in ("points_of_searches", "points_of_whole_curves"))
    print(f"{points} points; {DENSE} curves have {DENSE * response.n_points}", flush=True)
    for ratio in ratios:
        force = ratio * case.excitation.amplitude
        changed = case.replace({"preload.centrifugal_force": f"{force!r} N"})
        fine = case_curve(changed, FINE, int(curve.settings["harmonics"]))[0]
        error = float(curve.at(ratio).amplitude[0]) / fine - 1.0
        print(f"    {force:.4g} N: {1e6 * fine:.4f} um, {100 * error:+.3f} %", flush=True)


def by_accuracy(case: ss.Case, forces: tuple[float, ...]) -> None:
    """Print the highest peak of the performance curve, its estimated error and its check beside the highest peak of
    whole curves whose harmonics follow from the accuracy of the study: what the few harmonics of a ridge neglect."""
    model = ss.build_model(case)
    curve = with_performance_curve(case, model, solve(case, model, threads=1), SilentProgress(), 1).performance_curve
    estimates = curve.estimated_error
    for check in curve.checked:
        print(f"checked: {check.parameter * case.excitation.amplitude:.4g} N, {check}", flush=True)
    for force in forces:
        at = curve.at(force / case.excitation.amplitude)
        own = curve.of(int(at.ridge[0]))
        near = own[np.argmin(np.abs(np.log(curve.parameter[own] / at.parameter[0])))]
        changed = case.replace({"preload.centrifugal_force": f"{force!r} N"})
        model, solver = ss.build_model(changed), case.solver
        response = ss.forced_response(
            model.superelement, model.pairs, model.excitation, accuracy=solver.accuracy, samples=solver.samples,
            frequency_hz=AROUND_BOTH, modal_damping_ratio=case.damping.modal_damping_ratio, checks=False, threads=1,
        )  # fmt: skip
        amplitude = response.amplitude(next(iter(model.outputs.values())))
        top = int(amplitude.argmax())
        print(
            f"    {force:.4g} N: {1e6 * amplitude[top]:.4f} um at {response.frequency_hz[top]:.2f} Hz with "
            f"{response.point_harmonics[top]} harmonics (estimated error {100 * response.estimated_error[top]:.2f} %); "
            f"ridge {1e6 * at.amplitude[0]:.4f} um, {100 * (at.amplitude[0] / amplitude[top] - 1):+.2f} %, estimated "
            f"{100 * estimates[near]:.2f} %",
            flush=True,
        )


def main(names: list[str]) -> None:
    """Print the table."""
    if names == ["harmonics"]:
        default = ss.Case().replace({"solver.harmonics": None, "solver.accuracy": "2 %"})
        by_accuracy(default, (32.0, 34.3, 36.6, 39.0, 60.0, 107.0, 500.0, 1500.0, 3200.0))
        return
    if names == ["performance"]:
        performance("rough casting", rough_casting(), (0.25, 0.5, 1.0, 3.1, 10.0))
        default = ss.Case().replace({"solver.harmonics": None, "solver.accuracy": "2 %"})
        performance("default study", default, (0.105, 0.14, 0.24, 0.36, 1.0, 5.7, 10.4))
        return
    print("| key | range | errors of the ridge | switches | points of ridge / dense | process time of ridge / dense |")
    print("|---|---|---|---|---|---|")
    for make in ROWS:
        row = make()
        if names and not any(row.name.startswith(name) for name in names):
            continue
        began = time.process_time()
        ridge = row.ridge()
        seconds = time.process_time() - began
        values = np.geomspace(*row.limits, VALUES)
        began = time.process_time()
        _, points = row.curve(float(values[VALUES // 2]), None)
        dense_seconds, dense_points = DENSE * (time.process_time() - began), DENSE * points
        fine = np.array([row.curve(float(value), FINE)[0] for value in values])
        errors = np.abs(ridge.at(values).amplitude / fine - 1.0)
        own = sum(int(ridge.settings[name]) for name in ("points_of_searches", "points_of_whole_curves"))
        low, high = row.limits
        print(
            f"| {row.name} | {low:g} to {high:g} | {100 * np.nanmedian(errors):.3f} % median, "
            f"{100 * np.nanmax(errors):.3f} % largest, {int(np.isnan(errors).sum())} unknown | "
            f"{len(ridge.switches())} | {own} / {dense_points} | {seconds:.0f} / {dense_seconds:.0f} s |",
            flush=True,
        )
        print("   ", " ".join(f"{value:.4g}:{100 * error:.3f}" for value, error in zip(values, errors, strict=True)))
        print("   ", ridge.message, *ridge.warnings, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
