"""Wear: a flat punch against its closed form, balance of volume and energy, independent cycle jumps, changing peaks."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.core.validation import FloatArray
from stickslip.solve.wear.worn_joint import WornJoint

LOAD, SPRING, FRICTION, SLIP, AREA, ALPHA = 400.0, 1e7, 0.4, 50e-6, 1e-5, 1e-13
COUNT = 8
GAPS = np.linspace(0.0, 2e-6, COUNT)  # a form of the face: the pairs do not carry the same
# Share of the deviation from the mean load that wears off in a cycle: each pair slips 4 SLIP under friction.
RATE = ALPHA * 4.0 * FRICTION * SLIP * SPRING / AREA
FIXED: dict[str, Any] = {"area": AREA, "energy_wear_coefficient": ALPHA, "harmonics": 1, "samples": 128}


def punch(gaps: FloatArray) -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation]:
    """A rigid punch, unknowns x and z, pressed by LOAD, on a drive so stiff that x has the amplitude SLIP."""
    operator = np.zeros((3 * gaps.size, 2))
    operator[0::3, 0] = operator[2::3, 1] = 1.0
    # Of the rising gaps those are closed whose pairs reach equilibrium with the least approach.
    down = min((LOAD / SPRING + gaps[:closed].sum()) / closed for closed in range(1, gaps.size + 1))
    pairs = ss.ContactPairs(operator, SPRING, 1e9, FRICTION, SPRING * (down - gaps))
    drive = 1e10
    structure = ss.Superelement(np.eye(2), np.diag([drive, 1e-3]), np.diag([1e3, 1e3]))
    return structure, pairs, ss.Excitation.force([drive * SLIP, 0.0])


def worn_punch(cycles: float, gaps: FloatArray = GAPS, **options: Any) -> ss.Wear:
    return ss.wear(*punch(gaps), [1.0, 0.0], cycles=cycles, frequency_hz=20.0, **(FIXED | options))


@pytest.mark.slow
def test_the_loads_of_a_flat_punch_approach_each_other_as_the_closed_form() -> None:
    worn = worn_punch(1.5 / RATE, accuracy=1e-4)
    before = worn.normal_load[0]
    exact = LOAD / COUNT + (before - LOAD / COUNT) * np.exp(-RATE * worn.cycles)[:, None]
    assert np.abs(worn.normal_load - exact).max() < 0.01 * np.abs(before - LOAD / COUNT).max()
    assert worn.normal_load.sum(axis=1) == pytest.approx(LOAD)
    # In the mean all of the load slips 4 SLIP in each cycle, less the elastic part.
    assert worn.mean_depth[-1] == pytest.approx(
        ALPHA * 4.0 * FRICTION * SLIP * LOAD / COUNT / AREA * worn.cycles[-1], rel=2e-3
    )
    assert worn.converged


@pytest.mark.slow
def test_the_example_of_the_theory_runs() -> None:
    text = (Path(__file__).parents[3] / "docs" / "theory_wear.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    exec(compile(script, "theory_wear.md", "exec"), {})


@pytest.mark.slow
def test_volume_is_the_coefficient_times_the_friction_energy() -> None:
    worn = worn_punch(1.5 / RATE, accuracy=1e-3)
    assert worn.energy_volume[-1] == pytest.approx(worn.volume[-1], rel=1e-4)
    assert worn.volume[-1] > 0.0


@pytest.mark.slow
def test_a_finer_accuracy_gives_smaller_errors_of_the_depth() -> None:
    finest = worn_punch(1.5 / RATE, accuracy=1e-5).depth[-1]
    errors = [
        float(np.abs(worn_punch(1.5 / RATE, accuracy=each).depth[-1] - finest).max()) for each in (0.05, 0.005, 5e-4)
    ]
    closure = LOAD / COUNT / SPRING
    assert errors[0] < 0.05 * closure
    assert errors[1] < 0.005 * closure
    assert errors[2] < 0.5 * errors[0]


@pytest.mark.slow
def test_small_wear_does_not_depend_on_the_jump() -> None:
    # Within a thousandth of the closure the rate is that of the joint without wear.
    first = worn_punch(1e-3 / RATE)
    rate = ALPHA * first.friction_energy[0] / AREA
    for accuracy in (0.05, 0.005):
        worn = worn_punch(1e-3 / RATE, accuracy=accuracy)
        assert worn.depth[-1] == pytest.approx(rate * worn.cycles[-1], rel=1e-3)


@pytest.mark.slow
def test_a_pair_with_a_gap_closes_when_the_others_are_worn() -> None:
    gaps = np.append(np.zeros(3), 20e-6)
    worn = worn_punch(12.0 / RATE, gaps, accuracy=1e-3)
    assert worn.normal_load[0, 3] == 0.0
    assert worn.depth[1, 3] == 0.0
    assert worn.open_pairs[0] == 1
    assert worn.open_pairs[-1] == 0
    assert worn.normal_load[-1] == pytest.approx(np.full(4, LOAD / 4), rel=1e-2)
    # Equal loads: the depths differ by the gap.
    assert worn.depth[-1, 0] - worn.depth[-1, 3] == pytest.approx(gaps[3], rel=1e-2)


def test_archard_is_the_energy_over_the_friction_coefficient_of_each_pair() -> None:
    structure, pairs, excitation = punch(GAPS)
    friction = np.linspace(0.2, 0.5, COUNT)
    pairs = ss.ContactPairs(pairs.operator, SPRING, 1e11, friction, pairs.preload)
    archard = 4e-14
    worn = ss.wear(structure, pairs, excitation, [1.0, 0.0], cycles=100.0, frequency_hz=20.0,
                   **FIXED | {"energy_wear_coefficient": archard / friction})  # fmt: skip
    # K times normal force times slip, whatever the friction.
    assert worn.depth[-1] == pytest.approx(archard * pairs.preload * 4.0 * SLIP * 100.0 / AREA, rel=5e-3)


# A rigid block on four pairs, unknowns x, z and tilt, which springs hold too, so that wear unloads the pairs.
PLACES = np.array([-30e-3, -10e-3, 10e-3, 30e-3])


def block() -> tuple[ss.Superelement, ss.ContactPairs, ss.Excitation]:
    operator = np.zeros((12, 3))
    operator[0::3, 0] = operator[2::3, 1] = 1.0
    operator[2::3, 2] = PLACES
    stiffness = np.diag([2e6, 3e6, 2e3])
    structure = ss.Superelement(np.diag([1.0, 1.0, 1e-3]), stiffness, 2e-5 * stiffness)
    pairs = ss.ContactPairs(operator, 2e6, 1e6, 0.3, np.array([50.0, 60.0, 70.0, 90.0]))
    return structure, pairs, ss.Excitation.force([120.0, 0.0, 0.0])


def loads_after(depth: FloatArray) -> FloatArray:
    """Equilibrium of the block with closed pairs, a linear system."""
    structure, pairs, _ = block()
    rows = pairs.operator[2::3]
    moved = np.linalg.solve(structure.stiffness + 2e6 * rows.T @ rows, 2e6 * rows.T @ depth)
    return pairs.preload + 2e6 * (rows @ moved - depth)


@pytest.mark.long
def test_a_fixed_frequency_agrees_with_explicit_cycle_jumps() -> None:
    structure, pairs, excitation = block()
    hertz, cycles, jumps, alpha = 250.0, 1.5e6, 6, 5e-14
    worn = ss.wear(structure, pairs, excitation, [1.0, 0.0, 0.0], area=AREA, energy_wear_coefficient=alpha,
                   cycles=cycles, frequency_hz=hertz, accuracy=1e-3, harmonics=3)  # fmt: skip

    def rate(depth: FloatArray) -> FloatArray:
        now = ss.ContactPairs(pairs.operator, 2e6, 1e6, 0.3, loads_after(depth))
        curve = ss.forced_response(
            structure, now, excitation, frequency_hz=(hertz, 1.0001 * hertz), harmonics=3, samples=256
        )
        return np.asarray(alpha * curve.friction_energy[0] / AREA)

    depth = np.zeros(4)
    for _ in range(jumps):  # midpoint rule
        depth = depth + cycles / jumps * rate(depth + 0.5 * cycles / jumps * rate(depth))
    assert worn.depth[-1] == pytest.approx(depth, rel=3e-3)
    assert worn.normal_load[-1] == pytest.approx(loads_after(worn.depth[-1]), rel=1e-9)
    assert worn.normal_load[-1].sum() < 0.9 * worn.normal_load[0].sum()
    assert worn.frequency_hz == pytest.approx(hertz)


@pytest.mark.long
def test_the_motion_is_that_of_the_highest_peak_of_the_worn_joint() -> None:
    structure, pairs, excitation = block()
    worn = ss.wear(structure, pairs, excitation, [1.0, 0.0, 0.0], area=AREA, energy_wear_coefficient=5e-14, cycles=1e6,
                   frequency_hz=(215.0, 245.0), harmonics=1, samples=128)  # fmt: skip
    assert worn.converged, worn.message
    assert not worn.warnings
    assert worn.frequency_hz[-1] < worn.frequency_hz[0]
    for place in (0, -1):
        now = ss.ContactPairs(pairs.operator, 2e6, 1e6, 0.3, worn.normal_load[place])
        curve = ss.forced_response(structure, now, excitation, frequency_hz=(215.0, 245.0), harmonics=1, samples=128)
        assert worn.amplitude[place] == pytest.approx(curve.amplitude([1.0, 0.0, 0.0]).max(), rel=2e-3)


@pytest.mark.long
def test_another_peak_that_becomes_the_highest_takes_over() -> None:
    # Two masses that do not touch each other. Wear takes the load of the pair that holds the first one, which slips.
    omega = 2.0 * np.pi * np.array([10.0, 15.0])
    spring = 0.3 * omega[0] ** 2
    stiffness = np.diag(omega**2 - [spring, 0.0])
    structure = ss.Superelement(np.eye(2), stiffness, np.diag(0.02 * omega))
    pairs = ss.ContactPairs(np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]), 1.0, spring, 0.5, 26.0)
    excitation, cycles = ss.Excitation.force([1.0, 1.8]), 2e3
    worn = ss.wear(structure, pairs, excitation, [1.0, 1.0], area=1.0, energy_wear_coefficient=5.0, cycles=cycles,
                   frequency_hz=(5.0, 20.0), harmonics=1, samples=128)  # fmt: skip
    assert worn.frequency_hz[0] < 11.0
    assert worn.frequency_hz[-1] > 14.0
    assert len(worn.warnings) == 1
    for place in (0, -2, -1):
        now = ss.ContactPairs(pairs.operator, 1.0, spring, 0.5, worn.normal_load[place])
        curve = ss.forced_response(structure, now, excitation, frequency_hz=(5.0, 20.0), harmonics=1, samples=128)
        assert worn.amplitude[place] == pytest.approx(curve.amplitude([1.0, 1.0]).max(), rel=3e-3)


def test_a_joint_that_sticks_does_not_wear() -> None:
    structure, pairs, _ = block()
    worn = ss.wear(structure, pairs, ss.Excitation.force([1.0, 0.0, 0.0]), [1.0, 0.0, 0.0], area=AREA,
                   energy_wear_coefficient=ALPHA, cycles=1e9, frequency_hz=250.0)  # fmt: skip
    assert not worn.depth.any()
    assert worn.cycles.tolist() == [0.0, 1e9]
    assert next(worn.words()) == "No pair slips, so nothing wears."


def test_stiffness_that_rises_with_wear_moves_no_load() -> None:
    structure, pairs, _ = punch(GAPS)
    depth = np.full(COUNT, 3e-6)
    joint = WornJoint(structure, pairs, lambda loads, worn: (SPRING * (1.0 + worn / 1e-6), 1e9 * (1.0 + worn / 1e-6)))
    after = joint.pairs_after(depth)
    assert after.preload == pytest.approx(pairs.preload, rel=1e-9)
    assert after.coulomb.normal_stiffness == pytest.approx(4.0 * SPRING)
    assert after.coulomb.tangential_stiffness == pytest.approx(4e9)


@pytest.mark.slow
def test_stiffness_proportional_to_the_load_agrees_with_the_law() -> None:
    structure, pairs, _ = punch(GAPS)
    depth = np.linspace(2e-6, 0.0, COUNT)
    factor = SPRING * COUNT / LOAD
    after = WornJoint(structure, pairs, lambda loads, worn: (factor * loads, factor * loads)).pairs_after(depth)
    # N = P + k N (z - h), with z such that the loads sum to LOAD.
    down = (after.preload - pairs.preload) / (factor * after.preload) + depth
    assert down == pytest.approx(np.full(COUNT, down[0]), abs=1e-11)
    assert after.preload.sum() == pytest.approx(LOAD, rel=1e-6)


@pytest.mark.slow
def test_wear_ends_with_a_reason_where_no_motion_is_found() -> None:
    structure, pairs, excitation = block()
    # The frequency range begins just below the peak, which wear moves down.
    with pytest.warns(ss.NotConvergedWarning):
        worn = ss.wear(structure, pairs, excitation, [1.0, 0.0, 0.0], area=AREA, energy_wear_coefficient=5e-14,
                       cycles=1e7, frequency_hz=(227.5, 240.0), harmonics=1, samples=128)  # fmt: skip
    assert not worn.converged
    printed_sentence(worn.message, f"{worn.cycles[-1]:.4g} cycles", numbers=False)
    assert 0.0 < worn.cycles[-1] < 1e7


@pytest.mark.parametrize(
    ("argument", "changes"),
    [
        ("area", {"area": 0.0}),
        ("area", {"area": np.ones(3)}),
        ("energy_wear_coefficient", {"energy_wear_coefficient": -1e-13}),
        ("cycles", {"cycles": 0.0}),
        ("accuracy", {"accuracy": 0.5}),
        ("frequency_hz", {"frequency_hz": -1.0}),
        ("frequency_hz", {"frequency_hz": (20.0, 20.0)}),
        ("output", {"output": np.zeros(2)}),
    ],
)
def test_arguments_that_cannot_be_used_are_rejected(argument: str, changes: dict[str, Any]) -> None:
    arguments = FIXED | {"output": [1.0, 0.0], "cycles": 10.0, "frequency_hz": 20.0} | changes
    with rejects(ss.InputError, argument):
        ss.wear(*punch(GAPS), **arguments)


def _with_another_law(operator: FloatArray) -> ss.ContactPairs:
    return ss.ContactPairs.with_laws(operator, [ss.JenkinsElement(np.array([1e9]), np.array([100.0]))], [[0]])


@pytest.mark.parametrize(
    ("key", "made"),
    [
        ("normal_load", lambda operator: ss.ContactPairs(operator, SPRING, 1e9, 0.3, -1.0)),
        ("residual_traction",
         lambda operator: ss.ContactPairs(operator, SPRING, 1e9, 0.3, 50.0, residual_traction=[[1.0, 0.0]])),
        ("pairs", _with_another_law),
    ],
)  # fmt: skip
def test_joints_that_cannot_wear_are_rejected(key: str, made: Any) -> None:
    structure, pairs, excitation = punch(GAPS)
    with rejects(ss.InputError, key):
        ss.wear(structure, made(pairs.operator[:3]), excitation, [1.0, 0.0], cycles=10.0, frequency_hz=20.0, **FIXED)
