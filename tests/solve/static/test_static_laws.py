"""Any laws at rest under a static load, against closed forms and roots, and curves about those states."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.integrate
import scipy.optimize

import stickslip as ss
from law_makers import coulomb, cubic, iwan, jenkins, stop
from sentences import printed_sentence, rejects

K = 1e6  # N/m of the structure in each direction
STRUCTURE = ss.Superelement(np.eye(3), K * np.eye(3), 60.0 * np.eye(3))
ALONG_T1, ALONG_N = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def joint(*laws: ss.ContactLaw) -> ss.ContactPairs:
    """The laws side by side between the mass and the ground."""
    return ss.ContactPairs.with_laws(np.vstack([np.eye(3)] * sum(law.n_pairs for law in laws)), laws)


@pytest.mark.parametrize("bend", [1e15, 1e18, -1e14])
def test_a_cubic_spring_finds_its_root(bend: float) -> None:
    pairs = joint(cubic(2e5, bend))
    state = ss.static_preload(STRUCTURE, pairs, 20.0 * ALONG_N)
    roots = np.roots([bend, 0.0, K + 2e5, -20.0])
    root = min(roots[np.abs(roots.imag) < 1e-12 * np.abs(roots)].real, key=abs)  # the branch that begins at rest
    assert state.displacement == pytest.approx([0.0, 0.0, root], rel=1e-9, abs=1e-20)
    assert state.normal_force[0] == pytest.approx(20.0 - K * root, rel=1e-8)
    assert state.normal_stiffness[0] == pytest.approx(2e5 + 3.0 * bend * root**2, rel=1e-8)
    about = state.about(pairs, keep_traction=True)
    assert about.resting_stiffness()[2] == pytest.approx(2e5 + 3.0 * bend * root**2, rel=1e-8)
    printed_sentence(state.message, "cubic 1 elastic", numbers=False)


@pytest.mark.slow
@pytest.mark.parametrize("bend", [4e15, -1e15])
def test_small_vibration_about_a_loaded_cubic_spring_has_the_frequency_of_its_slope(bend: float) -> None:
    pairs = joint(cubic(2e5, bend))
    state = ss.static_preload(STRUCTURE, pairs, 15.0 * ALONG_N)
    natural = np.sqrt(K + 2e5 + 3.0 * bend * state.displacement[2] ** 2) / (2 * np.pi)
    response = ss.forced_response(
        STRUCTURE,
        state.about(pairs, keep_traction=True),
        1e-4 * ALONG_N,
        frequency_hz=(natural - 1.0, natural + 1.0),
        harmonics=1,
    )
    coefficients = response.coefficients(ALONG_N)
    quadrature = np.interp(natural, response.frequency_hz, coefficients[:, 1])  # no part in phase at resonance
    assert abs(quadrature) < 2e-3 * np.abs(coefficients[:, 2]).max()
    assert natural != pytest.approx(np.sqrt(K + 2e5) / (2 * np.pi), rel=0.05)


def test_a_spring_that_softens_too_far_has_no_state() -> None:
    """K x + k x - k3 x^3 reaches the load only far away on the other side, where it falls: an unstable state."""
    largest = 2.0 / 3.0 * (K + 2e5) * np.sqrt((K + 2e5) / 3e15)
    pairs = joint(cubic(2e5, -1e15))
    assert ss.static_preload(STRUCTURE, pairs, 0.97 * largest * ALONG_N).residual < 1e-9
    with rejects(ss.ConvergenceError):
        ss.static_preload(STRUCTURE, pairs, 1.05 * largest * ALONG_N)


def test_an_elastic_stop_closes_under_load() -> None:
    pairs = joint(stop(5e6, 8e-6, 1e5))
    before = ss.static_preload(STRUCTURE, pairs, 5.0 * ALONG_N)
    assert before.displacement[2] == pytest.approx(5.0 / 1.1e6, rel=1e-9)
    assert before.about(pairs, keep_traction=True).resting_stiffness()[2] == 1e5
    after = ss.static_preload(STRUCTURE, pairs, 40.0 * ALONG_N)
    assert after.displacement[2] == pytest.approx((40.0 + 5e6 * 8e-6) / 6.1e6, rel=1e-9)
    assert after.about(pairs, keep_traction=True).resting_stiffness()[2] == pytest.approx(5.1e6)
    printed_sentence(after.message, "elastic-stop 1", numbers=False)


def test_a_jenkins_joint_keeps_its_traction_or_is_released() -> None:
    """5 N of 10 N would go into the element if it stuck; it slips at 2 N. Without friction it carries nothing."""
    pairs = joint(jenkins(K, 2.0, 3e5))
    retained = ss.static_preload(STRUCTURE, pairs, 10.0 * ALONG_T1)
    assert retained.displacement[0] == pytest.approx(8.0 / K, rel=1e-9)
    assert retained.traction[0] == pytest.approx([2.0, 0.0], abs=1e-9)
    assert retained.state.tolist() == [ss.ContactState.STICK_SLIP]
    about = retained.about(pairs, keep_traction=True)
    assert about.resting_traction[0] == pytest.approx([2.0, 0.0], abs=1e-9)
    assert not about.released
    released = ss.static_preload(STRUCTURE, pairs, 10.0 * ALONG_T1, friction=False)
    assert released.displacement[0] == pytest.approx(10.0 / K, rel=1e-8)
    assert not released.traction.any()
    assert released.about(pairs, keep_traction=False).released
    small = ss.static_preload(STRUCTURE, pairs, 3.0 * ALONG_T1)
    assert small.traction[0, 0] == pytest.approx(1.5)
    assert small.state.tolist() == [ss.ContactState.STUCK]


def test_an_iwan_joint_follows_its_backbone() -> None:
    law = iwan(2e6, 5.0, -0.5, 0.1, 3e5)
    pairs = joint(law)
    state = ss.static_preload(STRUCTURE, pairs, 6.0 * ALONG_T1)
    root = scipy.optimize.brentq(lambda x: K * x + law.backbone(x)[0, 0] - 6.0, 0.0, 1e-5, xtol=1e-20, rtol=1e-14)
    assert state.displacement[0] == pytest.approx(root, rel=1e-9)
    assert state.traction[0, 0] == pytest.approx(law.backbone(root)[0, 0], rel=1e-9)
    about = state.about(pairs, keep_traction=True)
    assert about.resting_traction[0, 0] == pytest.approx(law.backbone(root)[0, 0], rel=1e-9)
    # Unloading by Masing: the law about the state starts a new branch.
    back = about.step(np.array([[-0.4 * root, 0.0, 0.0]]), about.memory_at_rest())
    assert back.force[0, 0] == pytest.approx(-2.0 * law.backbone(0.2 * root)[0, 0], rel=1e-9)
    free = ss.static_preload(STRUCTURE, pairs, 6.0 * ALONG_T1, friction=False)
    assert free.displacement[0] == pytest.approx(6.0 / K, rel=1e-8)


def test_kept_and_released_do_not_mix() -> None:
    pairs = joint(jenkins(K, 2.0, 3e5))
    with_friction = ss.static_preload(STRUCTURE, pairs, 10.0 * ALONG_T1)
    without = ss.static_preload(STRUCTURE, pairs, 10.0 * ALONG_T1, friction=False)
    with rejects(ss.InputError):
        with_friction.about(pairs, keep_traction=False)
    with rejects(ss.InputError):
        without.about(pairs, keep_traction=True)
    with rejects(ss.InputError):
        with_friction.pairs(pairs.operator, 0.3, keep_traction=True)
    with rejects(ss.InputError):
        ss.static_preload(STRUCTURE, pairs, 10.0 * ALONG_T1, local_stiffness=lambda force: (force, force))


def test_a_traction_that_pairs_keep_already_is_no_start_of_a_load() -> None:
    """It was left out without a word."""
    pressed = ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 10.0, residual_traction=[[1.0, 0.0]])
    for pairs in (pressed, joint(jenkins(K, 2.0, kept=[[1.0, 0.0]]))):
        with rejects(ss.InputError):
            ss.static_preload(STRUCTURE, pairs, 10.0 * ALONG_T1)


def test_what_only_a_hysteretic_joint_would_hold_needs_its_friction() -> None:
    loose = ss.Superelement(np.eye(3), np.diag([0.0, K, K]))
    pairs = joint(jenkins(K, 20.0, 3e5))
    assert ss.static_preload(loose, pairs, 10.0 * ALONG_T1).traction[0, 0] == pytest.approx(10.0)
    with rejects(ss.ConvergenceError):
        ss.static_preload(loose, pairs, 10.0 * ALONG_T1, friction=False)


def test_a_mixed_joint_is_in_equilibrium_and_its_state_is_that_of_each_law() -> None:
    laws: list[ss.ContactLaw] = [
        coulomb([2e6, 1e6], [1e6, 1e6], [0.3, 0.3], [0.0, 0.0], [0.0, 4e-6]),
        cubic(1e5, 1e16),
        stop(5e6, 3e-6),
        jenkins(5e5, 1.0),
        iwan(5e5, 2.0, -0.5, 0.1),
    ]
    pairs, load = joint(*laws), np.array([15.0, -6.0, 30.0])
    state = ss.static_preload(STRUCTURE, pairs, load)
    force = np.column_stack([state.traction, state.normal_force])
    assert STRUCTURE.stiffness @ state.displacement + pairs.operator.T @ force.ravel() == pytest.approx(load, rel=1e-9)
    relative = state.displacement
    assert force[2] == pytest.approx(1e5 * relative + 1e16 * relative**3, rel=1e-9)
    assert force[3, 2] == pytest.approx(5e6 * (relative[2] - 3e-6), rel=1e-9)
    assert force[4, :2] == pytest.approx([1.0, -1.0])
    assert force[0, 2] == pytest.approx(2e6 * relative[2], rel=1e-9)
    assert np.hypot(*force[0, :2]) <= 0.3 * force[0, 2] * (1.0 + 1e-9)
    about = state.about(pairs, keep_traction=True)
    assert about.resting_traction == pytest.approx(state.traction, abs=1e-9)
    assert about.normal_load == pytest.approx(force[:, 2], abs=1e-9)
    printed_sentence(state.message, "jenkins 1", "iwan 1", numbers=False)


@pytest.mark.long
@pytest.mark.parametrize(
    ("law", "static", "dynamic"),
    [(cubic(1e5, 4e15), 20.0, 3.0), (stop(2e6, 8e-6, 1e5), 14.0, 2.0)],
)
def test_the_curve_about_a_loaded_state_equals_the_motion_under_both_loads(
    law: ss.ContactLaw, static: float, dynamic: float
) -> None:
    """The static load stays in the reference: scipy's Runge-Kutta on the unloaded law under both loads."""
    pairs = joint(law)
    state = ss.static_preload(STRUCTURE, pairs, static * ALONG_N)
    hertz = 150.0
    response = ss.forced_response(
        STRUCTURE,
        state.about(pairs, keep_traction=True),
        dynamic * ALONG_N,
        frequency_hz=(hertz, 151.0),
        harmonics=11,
        samples=1024,
    )
    omega = 2 * np.pi * hertz

    def rate(t: float, y: np.ndarray) -> list[float]:
        contact = law.force_and_slope(np.full((1, 3, 1), y[0]))[0][0, 2, 0]  # type: ignore[attr-defined]
        return [y[1], static + dynamic * np.cos(omega * t) - 60.0 * y[1] - K * y[0] - contact]

    period, start = 1.0 / hertz, [state.displacement[2], 0.0]
    settled = scipy.integrate.solve_ivp(rate, (0.0, 60 * period), start, rtol=1e-7, atol=1e-12).y[:, -1]
    last = scipy.integrate.solve_ivp(rate, (0.0, period), settled, rtol=1e-8, atol=1e-13, max_step=period / 300).y[0]
    signal = state.displacement[2] + response.signal(ALONG_N, 0, 1000)
    assert response.contact_state.max() == 0  # the stop stays closed, so it is a spring
    assert [signal.max(), signal.min()] == pytest.approx([last.max(), last.min()], rel=2e-3)
    # About the unloaded rest the same force gives another motion, so this test can fail.
    unloaded = ss.forced_response(STRUCTURE, pairs, dynamic * ALONG_N, frequency_hz=(hertz, 151.0), harmonics=11)
    assert np.ptp(unloaded.signal(ALONG_N, 0, 1000)) != pytest.approx(np.ptp(last), rel=0.03)
