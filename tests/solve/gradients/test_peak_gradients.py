"""Gradients of a peak beside central differences of peaks that are solved again, and laws that they obey.

The sampled contact force is piecewise smooth in its unknowns. The models here have their peak inside a piece, which
each test asserts, so that differences of the solved peaks are exact too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from known_modes import one_mass
from peak_differences import SolvedPeak
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.solve.gradients.parameters import parameters_of
from stickslip.solve.solver_input import SolverInput

pytestmark = pytest.mark.slow

# In metres, and three unknowns of one pair with slip, variable normal load and separation.
STIFFNESS = 1e6 * np.array([[3.0, -1.0, 0.2], [-1.0, 2.5, -0.5], [0.2, -0.5, 2.0]])
MASS = np.diag([1.0, 0.6, 0.8])
OPERATOR = np.array([[0.0, 1.0, 0.1], [0.2, 0.1, 0.0], [0.0, 0.1, 1.0]])
SLIDER_HZ = np.sqrt(0.5e6) / (2.0 * np.pi)


def factor(name: str, base: SolverInput, **changed: Callable[[float], Any]) -> ss.Parameter:
    """A factor of one field of the input."""
    (field, value), *_ = changed.items()
    return ss.Parameter(name, "1", 1.0, lambda each: replace(base, **{field: value(each)}), 1e-4)


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
    pairs = ss.ContactPairs(OPERATOR, 6e5, 5e5, 0.4, normal_load=30.0)
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
    "unbalance": (coulomb(excitation=UNBALANCE), (150.0, 350.0), 3, 80, 3e-4),
    "jenkins": (jenkins(), (0.8 * SLIDER_HZ, 1.4 * SLIDER_HZ), 3, 64, 1e-3),
    "cubic": (cubic(), (0.8 * SLIDER_HZ, 4.0 * SLIDER_HZ), 5, 128, 0.01),
}


@cache
def solved(model: str) -> SolvedPeak:
    return SolvedPeak.of(*MODELS[model])


def parameter(model: str, name: str) -> ss.Parameter:
    base = MODELS[model][0]
    candidates = (*further_parameters(base), *parameters_of(base))
    return next(each for each in candidates if each.name == name or each.name.startswith(f"factor of {name}"))


CASES = [
    *[("coulomb", name) for name in (
        "harmonic force", "normal stiffness", "tangential stiffness", "friction coefficient", "normal load",
        "modal damping ratio", "stiffness", "stiffness entry", "mass", "operator",
    )],
    ("matrix damping", "damping matrix"), ("matrix damping", "mass"),
    ("unbalance", "unbalance"), ("unbalance", "base"), ("unbalance", "mass"),
    *[("jenkins", name) for name in ("harmonic force", "tangential stiffness", "friction limit", "damping matrix")],
    *[("cubic", name) for name in ("harmonic force", "cubic stiffness", "modal damping ratio")],
]  # fmt: skip
QUICK = {("coulomb", "friction coefficient"), ("unbalance", "mass"), ("jenkins", "tangential stiffness")}


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "name"), [pytest.param(*case, marks=() if case in QUICK else pytest.mark.slow) for case in CASES]
)
def test_derivatives_are_those_of_solved_peaks(model: str, name: str) -> None:
    peak, by = solved(model), parameter(model, name)
    own = peak.own
    assert abs(own.top.slope) * own.spacing < 1e-12 * own.top.amplitude.value  # inside a piece
    found, expected, values = peak.gradient(by), peak.differences(by, 1e-5), peak.sensitivity.values
    for place, quantity in enumerate(("amplitude", "frequency", "friction energy")):
        # Where a derivative is zero, differences have the error of the solver over their step.
        noise = 1e-6 * values[place] / by.value
        if model == "cubic" and quantity == "friction energy":
            assert abs(found[place]) < 1e-9  # no friction
            continue
        assert found[place] == pytest.approx(expected[place], rel=1e-5, abs=noise), quantity


def gradients(base: SolverInput, frequency_hz: tuple[float, float], **options: object) -> ss.PeakGradients:
    response = ss.forced_response(
        base.superelement, base.pairs, base.excitation, frequency_hz=frequency_hz, harmonics=3, samples=128,
        modal_damping_ratio=base.modal_damping_ratio,
    )  # fmt: skip
    return ss.peak_gradients(
        base.superelement, base.pairs, base.excitation, response, base.output,
        modal_damping_ratio=base.modal_damping_ratio, **options,  # type: ignore[arg-type]
    )  # fmt: skip


def derivative(found: ss.PeakGradients, name: str) -> np.ndarray:
    """Derivatives of amplitude, frequency and energy by one parameter."""
    place = next(place for place, each in enumerate(found.names) if name in each)
    return np.array([found.by_amplitude[place], found.by_frequency_hz[place], found.by_friction_energy[place]])


def test_twice_all_forces_is_twice_the_motion() -> None:
    """With twice the excitation and twice the normal load all motions are twice as large, and the energy is four times:
    Euler's theorem for homogeneous functions."""
    found = gradients(coulomb(), (150.0, 350.0))
    total = derivative(found, "harmonic force") + derivative(found, "normal load")
    assert total[0] == pytest.approx(found.amplitude, rel=1e-6)
    assert total[1] == pytest.approx(0.0, abs=1e-6 * float(found.frequency_hz))
    assert total[2] == pytest.approx(2.0 * found.friction_energy, rel=1e-6)


def test_twice_the_mass_only_lowers_the_frequency() -> None:
    """With modal damping ratios the same motion solves the equation at a frequency lower by sqrt(2)."""
    base = coulomb()
    found = gradients(base, (150.0, 350.0), parameters=[parameter("coulomb", "mass")])
    assert found.by_amplitude == pytest.approx([0.0], abs=1e-9 * float(found.amplitude))
    assert found.by_frequency_hz == pytest.approx([-0.5 * found.frequency_hz], rel=1e-9)
    assert found.by_friction_energy == pytest.approx([0.0], abs=1e-6 * float(found.friction_energy))


def test_the_peak_of_a_linear_oscillator() -> None:
    """``F / (2 zeta sqrt(1 - zeta^2) k)`` at ``sqrt(1 - 2 zeta^2) w`` with a pair that sticks."""
    ratio = 0.05
    superelement, pairs = one_mass(ratio=ratio)
    base = SolverInput(superelement, pairs, ss.Excitation.force([1e-3]), np.ones(1))
    found = gradients(base, (100.0, 180.0))
    stiffness, omega = 1.5e6, np.sqrt(0.75e6)
    assert found.amplitude == pytest.approx(1e-3 / (2.0 * ratio * np.sqrt(1.0 - ratio**2) * stiffness), rel=1e-9)
    assert found.frequency_hz == pytest.approx(np.sqrt(1.0 - 2.0 * ratio**2) * omega / (2.0 * np.pi), rel=1e-9)
    by_ratio = derivative(found, "damping matrix")  # a factor of the ratio
    assert by_ratio[0] == pytest.approx(-found.amplitude * (1.0 - 2.0 * ratio**2) / (1.0 - ratio**2), rel=1e-6)
    expected = -2.0 * ratio**2 / (1.0 - 2.0 * ratio**2) * found.frequency_hz
    assert by_ratio[1] == pytest.approx(expected, rel=1e-3)
    assert derivative(found, "friction limit").tolist() == [0.0, 0.0, 0.0]
    assert found.friction_energy == 0.0
    printed_sentence(found.messages[0])


@pytest.mark.long
def test_the_blade_with_many_pairs(blade: Blade) -> None:
    """Fold and many samples that switch: the secant between two forces is between the derivatives at both."""
    found = []
    for scale in (1.0, 1.02):
        force = ss.Excitation.force(scale * blade.force_cos, scale * blade.force_sin)
        curve = ss.forced_response(
            blade.superelement, blade.pairs, force, frequency_hz=blade.window_hz, harmonics=1, samples=256
        )
        found.append(ss.peak_gradients(blade.superelement, blade.pairs, force, curve, blade.tip, samples=512))
    secant = (found[1].amplitude - found[0].amplitude) / 0.02
    tangents = [derivative(each, "harmonic force")[0] for each in found]
    assert secant == pytest.approx(0.5 * (tangents[0] + tangents[1] / 1.02), rel=1e-2)


@pytest.mark.long
def test_a_second_peak_and_the_tornado() -> None:
    base = coulomb()
    found = gradients(base, (150.0, 450.0), peak=1)
    first = gradients(base, (150.0, 350.0))
    assert found.frequency_hz > first.frequency_hz
    assert found.amplitude < first.amplitude
    axes = first.plot(count=3).axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == [first.names[place] for place in first.order[:3]]
    assert len(axes.patches) == 6
    assert "strongest: " in repr(first)


def test_a_parameter_that_the_model_rejects_is_left_out() -> None:
    base = coulomb()

    def change(value: float) -> SolverInput:
        if value < 1.0:
            raise InputError("it must be 1 or above.")
        return base

    found = gradients(base, (150.0, 350.0), parameters=[ss.Parameter("bound", "1", 1.0, change, 1e-4)])
    assert found.names == ()
    printed_sentence(found.messages[0])


def test_wrong_input_is_rejected_before_the_modes() -> None:
    base = coulomb()
    response = ss.forced_response(
        base.superelement, base.pairs, base.excitation, frequency_hz=(150.0, 350.0), harmonics=1, samples=64,
        modal_damping_ratio=0.01,
    )  # fmt: skip

    def call(**changed: object) -> None:
        arguments = {"superelement": base.superelement, "pairs": base.pairs, "output": base.output} | changed
        ss.peak_gradients(
            excitation=base.excitation, response=response, modal_damping_ratio=0.01, **arguments  # type: ignore[arg-type]
        )  # fmt: skip

    with rejects(InputError, "output"):
        call(output=np.zeros(3))
    with rejects(InputError, "peak"):
        call(peak=7)
    with rejects(InputError, "samples"):
        call(samples=0)
    with rejects(InputError, "response"):
        call(superelement=ss.Superelement(np.eye(4), np.eye(4)))
    controlled = replace(response, load_factor=np.linspace(1.0, 2.0, response.n_points))
    with rejects(InputError, "response"):
        ss.peak_gradients(
            base.superelement, base.pairs, base.excitation, controlled, base.output, modal_damping_ratio=0.01
        )


def test_a_curve_that_ends_at_its_top_has_no_peak() -> None:
    with rejects(ConvergenceError):
        gradients(coulomb(), (150.0, 225.0))


@pytest.mark.long
@pytest.mark.parametrize(("force", "count"), [(0.5, 0), (0.6003, 1), (5.0, 0)])
def test_a_pair_that_begins_to_slip_at_the_peak_is_announced(force: float, count: int) -> None:
    """The stuck peak of F carries F / (2 zeta) k_t / k in the slider: 10 N, its limit, with F = 0.6 N."""
    superelement, pairs = one_mass(ratio=0.01)
    base = SolverInput(superelement, pairs, ss.Excitation.force([force]), np.ones(1))
    sentences = [each for each in gradients(base, (120.0, 150.0)).messages if "corner" in each]
    assert len(sentences) == count
    for sentence in sentences:
        printed_sentence(sentence)


@pytest.mark.long
def test_all_uncertain_derivatives_stand_in_one_sentence() -> None:
    superelement, pairs = one_mass(ratio=0.01)
    base = SolverInput(superelement, pairs, ss.Excitation.force([0.6003]), np.ones(1))
    (sentence,) = (each for each in gradients(base, (120.0, 150.0)).messages if "uncertain" in each)
    for words in ("peak amplitude", "friction energy", "tangential stiffness", "friction limit"):
        assert words in sentence
    well_inside = replace(base, excitation=ss.Excitation.force([5.0]))
    assert gradients(well_inside, (120.0, 150.0)).messages == ()
