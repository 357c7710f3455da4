"""The static preload against closed forms, an independent balance, and its own invariances."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize

from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_harmonics import harmonic_force
from stickslip.contact.law.normal_law import PressureGapLaw, SpringLaw
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.forced import forced_response
from stickslip.solve.static.load_ramp import LoadRamp
from stickslip.solve.static.ramp_to_rest import PATH_TOLERANCE, static_preload
from stickslip.solve.static.state import StaticState
from stickslip.structure.superelement import Superelement

FRICTION, ANGLE = 0.3, np.pi / 6


def wedge(stiffness: float = 1e8) -> tuple[Superelement, ContactPairs]:
    """A free rigid damper (x, y, z) between two rigid faces under 30 degrees; two pairs on each face."""
    cosine, sine = np.cos(ANGLE), np.sin(ANGLE)
    rows = []
    for side in (-1.0, 1.0):
        frame = [[-side * cosine, 0.0, sine], [0.0, 1.0, 0.0], [side * sine, 0.0, cosine]]
        rows += 2 * frame
    pairs = ContactPairs(np.array(rows), 0.5 * stiffness, 0.4 * stiffness, FRICTION, 0.0)
    return Superelement(0.01 * np.eye(3), np.zeros((3, 3))), pairs


def test_wedge_slips_up_and_friction_carries_part_of_the_load() -> None:
    """N of a face is F / (2 (cos + mu sin)) with friction, F / (2 cos) without."""
    superelement, pairs = wedge()
    load = np.array([0.0, 0.0, 500.0])
    state = static_preload(superelement, pairs, load)
    face = state.normal_force.reshape(2, 2).sum(axis=1)
    np.testing.assert_allclose(face, 500.0 / (2.0 * (np.cos(ANGLE) + FRICTION * np.sin(ANGLE))), rtol=1e-9)
    np.testing.assert_allclose(np.hypot(*state.traction.T), FRICTION * state.normal_force, rtol=1e-9)
    assert (state.state == 1).all()
    assert state.residual < 1e-12
    smooth = static_preload(superelement, pairs, load, friction=False)
    np.testing.assert_allclose(smooth.normal_force, 500.0 / (4.0 * np.cos(ANGLE)), rtol=1e-6)
    assert not smooth.traction.any()


@pytest.mark.slow
def test_a_load_without_support_has_no_state() -> None:
    superelement, pairs = wedge()
    sideways = np.array([0.0, 300.0, 500.0])  # along the damper: more than friction carries
    with rejects(ConvergenceError):
        static_preload(superelement, pairs, sideways)
    with rejects(ConvergenceError):
        static_preload(superelement, pairs, np.array([0.0, 10.0, 500.0]), friction=False)
    with rejects(ConvergenceError):
        static_preload(superelement, pairs, np.array([0.0, 0.0, -500.0]))


def test_gaps_close_one_after_the_other() -> None:
    """A mass on two springs with gaps 0 and 10 um: F = k x below the second gap, k x + k (x - g) above."""
    stiffness, gap = 1e7, 1e-5
    superelement = Superelement(np.eye(3), np.diag([1e6, 1e6, 0.0]))
    operator = np.vstack([np.eye(3), np.eye(3)])
    pairs = ContactPairs(operator, stiffness, stiffness, FRICTION, [0.0, -stiffness * gap])
    below = static_preload(superelement, pairs, [0.0, 0.0, 50.0])
    np.testing.assert_allclose(below.preload, [50.0, -stiffness * (gap - 50.0 / stiffness)], rtol=1e-9)
    assert below.state.tolist() == [0, 2]
    above = static_preload(superelement, pairs, [0.0, 0.0, 200.0])
    closure = (200.0 + stiffness * gap) / (2.0 * stiffness)
    np.testing.assert_allclose(above.normal_force, [stiffness * closure, stiffness * (closure - gap)], rtol=1e-9)
    np.testing.assert_array_equal(above.gap, 0.0)


def test_a_free_body_reaches_its_contact_across_a_gap() -> None:
    """Plain Newton has no stiffness to go on with while all pairs are open; the damped approach has."""
    superelement = Superelement(np.eye(3), np.zeros((3, 3)))
    pairs = ContactPairs(np.vstack([np.eye(3)] * 2), 1e7, 1e7, FRICTION, -200.0)
    state = static_preload(superelement, pairs, [0.0, 0.0, 80.0])
    np.testing.assert_allclose(state.normal_force, 40.0, rtol=1e-8)
    assert state.displacement[2] == pytest.approx(200.0 / 1e7 + 40.0 / 1e7, rel=1e-8)


def test_interference_presses_without_a_load() -> None:
    superelement = Superelement(np.eye(3), np.diag([1e6, 1e6, 1e7]))
    pairs = ContactPairs(np.eye(3), 1e7, 1e7, FRICTION, 100.0)
    state = static_preload(superelement, pairs, np.zeros(3))
    assert state.normal_force[0] == pytest.approx(50.0, rel=1e-9)  # the structure gives way by half


def test_pushing_first_or_pulling_first_leaves_another_traction() -> None:
    """Friction remembers: the same load in two ramps is not the load in one; a ramp in one go is proportional."""
    superelement = Superelement(np.eye(3), np.diag([1e6, 1e6, 1e6]))
    pairs = ContactPairs(np.eye(3), 1e7, 1e7, FRICTION, 0.0)
    state = static_preload(superelement, pairs, [2.0, 0.0, 11.0])
    # Proportional: N = 10/11 of 11 N; sticks while |T| < mu N, and T takes 10/11 of 2 N.
    np.testing.assert_allclose(state.normal_force, 10.0, rtol=1e-9)
    np.testing.assert_allclose(state.traction[0], [20.0 / 11.0, 0.0], atol=1e-9)
    assert state.state[0] == 0


def pressed(blade: Blade) -> tuple[Superelement, ContactPairs, FloatArray]:
    """The bench blade pressed against its contacts by a static load with components along and across them."""
    rng = np.random.default_rng(5)
    pairs = blade.pairs_with(np.zeros(blade.n_pairs))
    forces = np.zeros((blade.n_pairs, 3))
    forces[:, 2] = rng.uniform(-60.0, 90.0, blade.n_pairs)
    forces[:, :2] = rng.normal(size=(blade.n_pairs, 2)) * 5.0
    return blade.superelement, pairs, pairs.operator.T @ forces.ravel()


def require_admissible(state: StaticState, pairs: ContactPairs, superelement: Superelement, load: FloatArray) -> None:
    """Equilibrium, no tension, Coulomb's limit, and springs that agree with the displacement."""
    force = np.column_stack([state.traction, state.normal_force])
    unbalanced = superelement.stiffness @ state.displacement + pairs.operator.T @ force.ravel() - load
    assert np.linalg.norm(unbalanced) < 1e-8 * np.linalg.norm(load)
    relative = (pairs.operator @ state.displacement).reshape(-1, 3)
    np.testing.assert_allclose(state.preload, state.normal_stiffness * relative[:, 2], atol=1e-7 * force.max())
    assert (state.normal_force >= 0.0).all()
    size, limit = np.hypot(*state.traction.T), pairs.friction_coefficient * state.normal_force
    assert (size <= limit * (1.0 + 1e-9)).all()
    np.testing.assert_allclose(size[state.state == 1], limit[state.state == 1], rtol=1e-9)
    assert not force[state.state == 2].any()


def test_states_of_a_blade_are_admissible_and_do_not_depend_on_the_steps(blade: Blade) -> None:
    """A ramp in proportion from a just touching joint slips along straight lines: one step is as good as ten."""
    superelement, pairs, load = pressed(blade)
    one, ten = (static_preload(superelement, pairs, load, steps=steps) for steps in (1, 10))
    assert {0, 1, 2} == set(one.state.tolist())
    require_admissible(one, pairs, superelement, load)
    np.testing.assert_allclose(one.normal_force, ten.normal_force, atol=1e-8 * one.normal_force.max())
    np.testing.assert_allclose(one.traction, ten.traction, atol=1e-8 * one.normal_force.max())
    twice = static_preload(superelement, pairs, 2.0 * load)
    np.testing.assert_allclose(twice.normal_force, 2.0 * one.normal_force, atol=1e-8 * one.normal_force.max())


def test_without_springs_open_pairs_are_left_nearly_singular(blade: Blade) -> None:
    """Kbar holds however little the closed pairs hold: contact a thousand times stiffer, most pairs open."""
    superelement, pairs, load = pressed(blade)
    stiff = ContactPairs(
        pairs.operator, 1e3 * pairs.normal_stiffness, 1e3 * pairs.tangential_stiffness, FRICTION, pairs.preload
    )
    state = static_preload(superelement, stiff, load)
    require_admissible(state, stiff, superelement, load)


def test_local_stiffness_agrees_with_its_own_pressure(blade: Blade) -> None:
    superelement, pairs, load = pressed(blade)

    def local(normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
        share = np.where(normal_force > 1.0, normal_force, 1.0) / 40.0
        return pairs.normal_stiffness * share**0.8, 0.8 * pairs.normal_stiffness * share**0.8

    state = static_preload(superelement, pairs, load, local_stiffness=local)
    normal, tangential = local(state.normal_force)
    np.testing.assert_allclose(state.normal_stiffness, normal, rtol=1e-3)
    np.testing.assert_allclose(state.tangential_stiffness, tangential, rtol=1e-3)


def test_pressure_gap_law_integrates_its_stiffness() -> None:
    """kappa = c sqrt(p) gives p = (c closure / 2)^2 above the lowest pressure."""
    law = PressureGapLaw.from_stiffness([2.0], lambda p: 1e6 * np.sqrt(p), 1e-6, 1e9)
    closure = np.geomspace(1e-4, 1e-2, 7)
    force = np.array([law.force(np.array([value]))[0][0] for value in closure])
    slope = np.array([law.force(np.array([value]))[1][0] for value in closure])
    np.testing.assert_allclose(force, 2.0 * (0.5e6 * closure) ** 2, rtol=2e-4)
    np.testing.assert_allclose(slope, 2.0 * 1e6 * 0.5e6 * closure, rtol=2e-4)
    assert law.force(np.array([-1e-3]))[0][0] < 0.0
    last, stiffest = np.array([law.force(law.closure[-1:]), law.force(law.closure[-1:] + 1.0)])[..., 0]
    assert stiffest == pytest.approx([last[0] + last[1], last[1]], rel=1e-12)  # linear beyond the table


def test_the_slope_of_a_pressure_gap_law_has_no_jumps() -> None:
    """Its change over a small step is that of the closed form, also across the points of its table."""
    law = PressureGapLaw.from_stiffness([2.0], lambda p: p / 1e-6, 1e4, 1e9)  # p rises by e in each micrometre
    law = replace(law, area=np.full(995, 2.0))  # as many pairs as closures
    step = 1e-4 * 1e-6
    (low, soft), (high, stiff) = (law.force(law.closure[5:1000] + move) for move in (-step, step))
    np.testing.assert_allclose((stiff - soft) / soft, 2e-4, rtol=5e-3)
    np.testing.assert_allclose((high - low) / (2.0 * step), 0.5 * (soft + stiff), rtol=1e-6)


def test_a_pressure_gap_table_whose_stiffness_is_another_one_is_rejected() -> None:
    law = PressureGapLaw.from_stiffness([2.0], lambda p: p / 1e-6, 1e4, 1e9)
    with rejects(InputError, "closure", "stiffness"):
        PressureGapLaw(law.area, 1.01 * law.closure, law.pressure, law.stiffness)
    straight = PressureGapLaw(np.ones(1), np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 4.0]))
    assert [straight.force(np.array([each]))[1][0] for each in (0.5, 1.5, 3.0)] == [1.0, 3.0, 3.0]


def test_a_load_on_a_pressure_gap_law_finds_its_closure() -> None:
    superelement = Superelement(np.eye(3), np.diag([1e6, 1e6, 0.0]))
    pairs = ContactPairs(np.eye(3), 1e7, 1e7, FRICTION, 0.0)
    law = PressureGapLaw.from_stiffness([1e-4], lambda p: 1e6 * np.sqrt(p), 1e2, 1e9)
    state = static_preload(superelement, pairs, [0.0, 0.0, 300.0], normal_law=law)
    assert state.normal_force[0] == pytest.approx(300.0, rel=1e-9)
    assert state.normal_stiffness[0] == pytest.approx(1e-4 * 1e6 * np.sqrt(3e6), rel=1e-2)
    assert state.displacement[2] == pytest.approx(2.0 * np.sqrt(3e6) / 1e6, rel=1e-2)


def test_a_bent_path_takes_more_steps_and_reports_it(blade: Blade) -> None:
    """The pressure-gap law is not proportional to the load, so the first few steps are not enough with friction."""
    superelement, pairs, load = pressed(blade)
    law = PressureGapLaw.from_stiffness(np.full(pairs.n_pairs, 1e-6), lambda p: 1e9 * np.sqrt(p), 1e3, 1e9)
    state = static_preload(superelement, pairs, load, normal_law=law, steps=1)
    assert state.steps >= 4
    printed_sentence(state.message, numbers=False)
    with rejects(InputError, "steps"):
        static_preload(superelement, pairs, load, steps=2.5)  # type: ignore[arg-type]


@pytest.mark.long
@pytest.mark.parametrize("kept", [False, True])
def test_vibration_about_the_state_equals_a_balance_with_the_static_load_in_its_mean(blade: Blade, kept: bool) -> None:
    """Mode B: an independent dense balance carries the static load in the mean and counts from the unloaded state."""
    superelement, pairs, load = pressed(blade)
    state = static_preload(superelement, pairs, load, friction=kept)
    loaded = state.pairs(pairs.operator, pairs.friction_coefficient, keep_traction=kept)
    frequency = 0.97 * blade.stuck_hz
    amplitude = 0.02
    response = forced_response(
        superelement,
        loaded,
        amplitude * blade.force_cos,
        amplitude * blade.force_sin,
        frequency_hz=(frequency, 1.0001 * frequency),
        harmonics=2,
        samples=64,
    )
    moving = response.contact_state[0]
    assert (moving > 0).any()
    expected = response.displacement[0].copy()
    expected[:, 0] += state.displacement
    residual = dense_residual(superelement, pairs, state, load, blade, amplitude, frequency, kept)
    solution = scipy.optimize.root(
        residual, 1.02 * expected.ravel(), method="krylov", tol=None, options={"fatol": 1e-7}
    )
    assert solution.success
    actual = solution.x.reshape(expected.shape)
    relative = (pairs.operator @ (actual - expected)).reshape(-1, 3, 5)
    if not kept:
        relative[:, :2, 0] = 0.0  # no force depends on the mean tangential displacement of released pairs
    assert np.abs(relative).max() < 1e-6 * np.abs(pairs.operator @ expected).max()


def dense_residual(
    superelement: Superelement,
    pairs: ContactPairs,
    state: StaticState,
    load: FloatArray,
    blade: Blade,
    amplitude: float,
    frequency_hz: float,
    kept: bool,
) -> Callable[[FloatArray], FloatArray]:
    """R (5 n,) of all unknowns in absolute displacements: the pairs touch at zero, the static load is in the mean."""
    omega = 2.0 * np.pi * frequency_hz
    rest = pairs.operator @ state.displacement

    def contact_force(relative: FloatArray) -> FloatArray:
        """(n_pairs, 3, 5) N in full. Released pairs need nothing but the law; kept ones the slider of the ramp."""
        if not kept:
            return harmonic_force(relative, pairs, 64).force
        moved = relative.copy()
        moved[:, :, 0] -= rest.reshape(-1, 3)
        about_rest = state.pairs(pairs.operator, pairs.friction_coefficient, keep_traction=True)
        force = harmonic_force(moved, about_rest, 64).force
        force[:, :2, 0] += state.traction
        force[:, 2, 0] += state.normal_force
        return force

    def residual(vector: FloatArray) -> FloatArray:
        u = vector.reshape(-1, 5)
        contact = contact_force((pairs.operator @ u).reshape(-1, 3, 5))
        force = pairs.operator.T @ contact.reshape(-1, 5)
        damping = superelement.damping
        assert damping is not None
        result = superelement.stiffness @ u + force
        result[:, 0] -= load
        for order in (1, 2):
            c, s = 2 * order - 1, 2 * order
            result[:, c] += -((order * omega) ** 2) * (superelement.mass @ u[:, c]) + order * omega * damping @ u[:, s]
            result[:, s] += -((order * omega) ** 2) * (superelement.mass @ u[:, s]) - order * omega * damping @ u[:, c]
        result[:, 1] -= amplitude * blade.force_cos
        result[:, 2] -= amplitude * blade.force_sin
        return np.asarray(result.ravel())

    return residual


def test_bad_input_gets_a_sentence(blade: Blade) -> None:
    superelement, pairs, load = pressed(blade)
    with rejects(InputError, "load"):
        static_preload(superelement, pairs, np.zeros_like(load))
    with rejects(InputError, "load"):
        static_preload(superelement, pairs, load[:-1])
    with rejects(InputError, "steps"):
        static_preload(superelement, pairs, load, steps=0)
    unequal = ContactPairs(pairs.operator, 1e6, np.array([[1e6, 2e6]] * pairs.n_pairs), 0.3, 0.0)
    with rejects(InputError, "tangential_stiffness"):
        static_preload(superelement, unequal, load)
    with rejects(InputError, "pressure"):
        PressureGapLaw(np.ones(1), np.array([0.0, 1.0]), np.array([1.0, 2.0]))
    assert SpringLaw(np.ones(2)).force(np.ones(2))[0].tolist() == [1.0, 1.0]


def test_the_restraint_of_a_state_without_friction_carries_nothing_that_the_structure_carries() -> None:
    """Contact far stiffer than the structure: the restraint of the mean position must not stand in for K."""
    rng = np.random.default_rng(3)
    rotation, _ = np.linalg.qr(rng.normal(size=(9, 9)))
    stiffness = (rotation * np.geomspace(1e5, 1e7, 9)) @ rotation.T
    superelement = Superelement(np.eye(9), 0.5 * (stiffness + stiffness.T))
    load = 100.0 * rng.normal(size=9)
    for preload in (0.0, 1e5):
        for force in (load, np.zeros(9)):
            if preload == 0.0 and not force.any():
                continue
            pairs = ContactPairs(np.eye(9), 1e10, 1e10, FRICTION, preload)
            state = static_preload(superelement, pairs, force, friction=False)
            contact = np.column_stack([np.zeros((3, 2)), state.normal_force]).ravel()
            unbalanced = superelement.stiffness @ state.displacement + contact - force
            assert np.linalg.norm(unbalanced) < 1e-6 * (np.linalg.norm(force) + np.linalg.norm(contact))
            assert state.residual < 1e-6


@pytest.mark.long
def test_gaps_take_as_many_load_steps_as_the_tractions_need() -> None:
    """Pairs that touch one after the other slip along bent lines: the error of a ramp falls with its steps."""
    rng = np.random.default_rng(11)
    rotation, _ = np.linalg.qr(rng.normal(size=(18, 18)))
    stiffness = (rotation * np.geomspace(1e5, 1e7, 18)) @ rotation.T
    superelement = Superelement(np.eye(18), 0.5 * (stiffness + stiffness.T))
    load = np.tile([25.0, 10.0, 60.0], 6) + 10.0 * rng.normal(size=18)
    gap = rng.uniform(-5e-6, 3e-5, 6)
    pairs = ContactPairs(np.eye(18), 1e7, 1e7, 0.5, -1e7 * gap)
    coarse = LoadRamp(superelement, pairs, load, SpringLaw(pairs.normal_stiffness), gap, True).run(4)
    fine = LoadRamp(superelement, pairs, load, SpringLaw(pairs.normal_stiffness), gap, True).run(2000)
    state = static_preload(superelement, pairs, load)
    limit = (0.5 * fine.normal_force).max()
    far, near = (np.abs(each.traction - fine.traction).max() / limit for each in (coarse, state))
    assert far > 2.0 * PATH_TOLERANCE
    assert near < PATH_TOLERANCE
    assert state.steps > 4
    assert re.search(r"Tractions change by \S+ % of the largest friction limit", state.message)


@pytest.mark.parametrize("law", [None, SpringLaw(np.array([2e7]))])
def test_local_stiffness_settles_also_where_the_forces_do_not_depend_on_it(law: SpringLaw | None) -> None:
    """One pair under a force: N is known from the start, and the stiffness still has to reach its law."""
    superelement = Superelement(np.eye(3), np.diag([1e6, 1e6, 0.0]))
    pairs = ContactPairs(np.eye(3), 1e7, 1e7, FRICTION, 0.0)

    def local(normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
        return 2e5 * normal_force, 1e5 * normal_force

    state = static_preload(superelement, pairs, [0.0, 0.0, 300.0], local_stiffness=local, normal_law=law)
    assert state.tangential_stiffness[0] == pytest.approx(3e7, rel=1e-3)
    assert state.normal_stiffness[0] == pytest.approx(6e7 if law is None else 2e7, rel=1e-3)
