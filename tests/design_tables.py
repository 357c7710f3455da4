"""A design made by hand: three evaluations of one key, with limits and two load cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.core.units import Quantity
from stickslip.results.band import limit_of
from stickslip.results.design import (
    DESIGN_MEASURES,
    DesignCase,
    DesignKey,
    DesignPeak,
    DesignResult,
    Evaluation,
    Sharpness,
    StartResult,
)
from stickslip.results.sweep_table import SweepCurve

LOADS = ("excitation.mode = single", "excitation.mode = same")


def design_case(name: str, peak_m: float, failure: str = "") -> DesignCase:
    """A case with one peak at 460 Hz."""
    if failure:
        return DesignCase(name, "", failure)
    frequency = np.linspace(440.0, 480.0, 41)
    curve = SweepCurve(frequency, peak_m / np.hypot(1.0, frequency - 460.0), np.ones(41, bool), np.zeros(41, int))
    return DesignCase(name, f"cases/{name}/results.nc", "", (DesignPeak(peak_m, 460.0),), {}, curve)


def evaluation(number: int, stage: str, force: float, peak_m: float, failure: str = "") -> Evaluation:
    """A design with a centrifugal force in N; above 0.2 mm it violates the limit."""
    at = (force - 100.0) / 400.0
    if failure:
        cases = tuple(design_case(f"case-{number}-{place}", peak_m, failure) for place in range(2))
        return Evaluation(number, stage, (at,), (force,), cases, np.nan, (np.nan,), np.nan)
    cases = tuple(design_case(f"case-{number}-{place}", factor * peak_m) for place, factor in enumerate((0.5, 1.0)))
    gradient = "exact" if stage.startswith("start") else "none"
    return Evaluation(number, stage, (at,), (force,), cases, peak_m, (peak_m,), max(0.0, peak_m / 2e-4 - 1.0), gradient)


def design_result(best: int | None = 2, cautions: tuple[str, ...] = ()) -> DesignResult:
    """The result; for ``best`` None with a limit of 0.01 mm that no design satisfies, and without an optimum."""
    key = DesignKey("preload.centrifugal_force", Quantity("force"), 100.0, 500.0, 500.0)
    evaluations: tuple[Evaluation, ...] = (
        evaluation(1, "sample", 500.0, 3e-4),
        evaluation(2, "sample", 200.0, 1.8e-4),
        evaluation(3, "start 1", 235.0, 1.7e-4),
        evaluation(4, "sharpness", 300.0, 1.9e-4),
        evaluation(5, "difference", 110.0, 0.0, "No <first> point."),
    )
    along = Sharpness(
        key.name, np.array([110.0, 200.0, 235.0, 300.0]), np.array([np.nan, 1.8e-4, 1.7e-4, 1.9e-4]),
        np.array([np.nan, 0.0, 0.0, 0.0]), None, 265.0, "smooth",
    )  # fmt: skip
    limit, has_one = limit_of("peak < 0.2 mm", DESIGN_MEASURES, "design"), best is not None
    if not has_one:
        limit = limit_of("peak < 0.01 mm", DESIGN_MEASURES, "design")
        evaluations = tuple(replace(each, excess=each.objective / limit.value - 1.0) for each in evaluations)
    starts = (StartResult(1, 2, "converged", same_value=has_one, same_place=has_one),)
    remarks = ("The optimum is interior.",) if has_one else ("No design of 5 satisfies all limits.",)
    sharpness = (along,) if has_one else ()
    return DesignResult(
        (key,), LOADS, DESIGN_MEASURES["peak"], (limit,), evaluations, best, starts, sharpness, remarks, cautions
    )  # fmt: skip


def failed_result() -> DesignResult:
    """The result of a design none of whose cases has one."""
    failed = tuple(
        evaluation(number, "sample", force, 0.0, f"No <first> point of {number}.")
        for number, force in ((1, 500.0), (2, 200.0), (3, 300.0))
    )
    remarks = ("None of 3 designs has a result.",)
    return replace(design_result(None), evaluations=failed, starts=(), remarks=remarks)
