"""Gradients of a peak beside central differences of peaks that are solved again, and laws that they obey.

The sampled contact force is piecewise smooth in its unknowns. The models here have their peak inside a piece, which each
test asserts, so that differences of the solved peaks are exact too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from known_modes import one_mass
from peak_differences import SolvedPeak
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.solve.parameters import parameters_of
from stickslip.solve.solver_input import SolverInput

# In metres, and three unknowns of one pair with slip, variable normal load and separation.
STIFFNESS = 1e6 * np.array([[3.0, -1.0, 0.2], [-1.0, 2.5, -0.5], [0.2, -0.5, 2.0]])
MASS = np.diag([1.0, 0.6, 0.8])
OPERATOR = np.array([[0.0, 1.0, 0.1], [0.2, 0.1, 0.0], [0.0, 0.1, 1.0]])
SLIDER_HZ = np.sqrt(0.5e6) / (2.0 * np.pi)


def factor(name: str, base: SolverInput, **changed: Callable[[float], object]) -> ss.Parameter:
    """A factor of one field of the input."""
    (field, value), *_ = changed.items()
    return ss.Parameter(name, "1", 1.0, lambda each: replace(base, **{field: value(each)}), 1e-4)  # type: ignore[arg-type]


def further_parameters(base: SolverInput) -> tuple[ss.Parameter, ...]:
    """Factors of matrices, operator and output."""
    superelement, pairs = base.superelement, base.pairs
    entry = np.zeros_like(superelement.stiffness)
    entry[0, 0] = superelement.stiffness[0, 0]
    return (
        factor("stiffness", base, superelement=lambda v: replace(superelement, stiffness=v * superelement.stiffness)),
        factor(
            "stiffness entry", base,
            superelement=lambda v: replace(superelement, stiffness=superelement.stiffness + (v - 1.0) * entry),
        ),
        factor("mass", base, superelement=lambda v: replace(superelement, mass=v * superelement.mass)),
        factor("operator", base, pairs=lambda v: ss.ContactPairs.with_laws(v * pairs.operator, pairs.laws)),
        factor("output", base, output=lambda v: v * base.output),
    )  # fmt: skip


def coulomb(ratio: float | None = 0.01, excitation: ss.Excitation | None = None) -> SolverInput:
    pairs = ss.ContactPairs(OPERATOR, 6e5, 5e5, 0.4, normal_load=30.0)  # type: ignore[arg-type]
    damping = None if ratio else 2e-5 * STIFFNESS
    force = excitation or ss.Excitation.force([60.0, 0.0, 0.0])
    return SolverInput(ss.Superelement(MASS, STIFFNESS, damping), pairs, force, np.array([1.0, 0.2, 0.0]), ratio)


def jenkins() -> SolverInput:
    superelement, pairs = one_mass(ratio=0.01)
    return SolverInput(superelement, pairs, ss.Excitation.force([40.0]), np.ones(1))


def cubic() -> SolverInput:
    superelement, _ = one_mass()
    law = ss.CubicSpring(np.array([[1e5, 0.0, 0.0]]), np.array([[1e13, 0.0, 0.0]]))
    pairs = ss.ContactPairs.with_laws(np.array([[1.0], [0.0], [0.0]]), [law])
    return SolverInput(replace(superelement, damping=None), pairs, ss.Excitation.force([40.0]), np.ones(1), 0.01)


UNBALANCE = ss.Excitation.unbalance([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], 3e-5) + ss.Excitation.base_motion(
    [1.0, 0.5, 0.0], 20.0
)
# Model, range in Hz, harmonics, samples, distance of the places over the width of the peak.
MODELS: dict[str, tuple[SolverInput, tuple[float, float], int, int, float]] = {
    "coulomb": (coulomb(), (150.0, 350.0), 3, 96, 3e-4),
    "matrix damping": (coulomb(None), (150.0, 350.0), 3, 96, 3e-4),
    "unbalance": (coulomb(excitation=UNBALANCE), (150.0, 350.0), 3, 96, 3e-4),
    "jenkins": (jenkins(), (0.8 * SLIDER_HZ, 1.4 * SLIDER_HZ), 3, 64, 1e-3),
    "cubic": (cubic(), (0.8 * SLIDER_HZ, 4.0 * SLIDER_HZ), 5, 128, 0.01),
}


@cache
def solved(model: str) -> SolvedPeak:
    base, *options = MODELS[model]
    return SolvedPeak.of(base, *options)


def parameter(model: str, name: str) -> ss.Parameter:
    base = MODELS[model][0]
    return next(each for each in (*parameters_of(base), *further_parameters(base)) if name in each.name)


CASES = [
    *[("coulomb", name) for name in (
        "force", "normal stiffness", "tangential stiffness", "friction coefficient", "normal load", "modal damping",
        "stiffness", "stiffness entry", "mass", "operator",
    )],
    ("matrix damping", "damping matrix"), ("matrix damping", "mass"),
    ("unbalance", "unbalance"), ("unbalance", "base"), ("unbalance", "mass"),
    *[("jenkins", name) for name in ("force", "tangential stiffness", "friction limit", "damping matrix")],
    *[("cubic", name) for name in ("force", "cubic stiffness", "modal damping")],
]  # fmt: skip
QUICK = {("coulomb", "friction coefficient"), ("unbalance", "mass"), ("jenkins", "tangential stiffness")}


@pytest.mark.parametrize(
    ("model", "name"), [pytest.param(*case, marks=() if case in QUICK else pytest.mark.slow) for case in CASES]
)
def test_derivatives_are_those_of_solved_peaks(model: str, name: str) -> None:
    peak, by = solved(model), parameter(model, name)
    refined = peak.refined(peak.base)
    assert abs(refined.top.slope) * refined.spacing < 1e-12 * refined.top.amplitude.value  # inside a piece
    found, expected, values = peak.gradient(by), peak.differences(by, 2e-5), peak.values(peak.base)
    scale = 1e-5 * np.abs(values) / by.value  # where a derivative is zero
    for place, quantity in enumerate(("amplitude", "frequency", "friction energy")):
        if model == "cubic" and quantity == "friction energy":
            assert abs(found[place]) < 1e-9
            continue
        assert found[place] == pytest.approx(expected[place], rel=1e-5, abs=1e-5 * scale[place]), quantity
