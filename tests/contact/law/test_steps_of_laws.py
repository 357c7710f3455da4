"""Single steps of the laws against closed forms: Coulomb, cubic, stop, Jenkins, Iwan."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

import stickslip as ss
from law_makers import coulomb, cubic, iwan, jenkins, stop
from sentences import rejects

IWAN = iwan(1.5e7, 4000.0, -0.6, 0.02)
SLIDES = float(IWAN.macroslip_displacement[0, 0])


def forces(law: ss.ContactLaw, axis: int, path: Iterable[float]) -> np.ndarray:
    """(n,) N of pair 0 along one axis after each step of a path from rest, the other axes still."""
    memory, actual = law.memory_at_rest(), []
    for x in path:
        displacement = np.zeros((law.n_pairs, 3))
        displacement[:, axis] = x
        step = law.step(displacement, memory)
        memory = step.memory
        actual.append(step.force[0, axis])
    return np.array(actual)


def test_jenkins_loads_unloads_and_reloads() -> None:
    """k = 1e6 N/m, limit 4 N: it slips beyond 4 um of stretch, and springs back from where it turns."""
    path = [2e-6, 6e-6, 5e-6, -3e-6, 0.0, 4e-6, 9e-6]
    assert forces(jenkins(1e6, 4.0), 0, path) == pytest.approx([2.0, 4.0, 3.0, -4.0, -1.0, 3.0, 4.0])


def test_a_jenkins_element_that_keeps_a_traction_has_that_much_less_to_go() -> None:
    law = jenkins(1e6, 4.0, kept=[[3.0, -1.0]])
    assert forces(law, 0, [0.5e-6, 2e-6, 1e-6, -9e-6]) == pytest.approx([0.5, 1.0, 0.0, -7.0])
    assert not law.undetermined().any()
    with rejects(ss.InputError, "residual_traction"):
        jenkins(1e6, 4.0, kept=[[5.0, 0.0]])
    with rejects(ss.InputError, "residual_traction"):
        jenkins(1e6, 4.0, kept=[[1.0]])


def test_an_element_that_shakes_down_to_its_limit_is_stuck() -> None:
    """After its first period it touches the limit to round-off and slips no more: no energy, not even 1e-22 J."""
    angle = 2 * np.pi * np.arange(64) / 64
    law = jenkins(np.full(50, 1e6), 4.0, kept=np.tile([3.7, 0.0], (50, 1)))
    motion = np.zeros((64, 50, 3))
    motion[:, :, 0] = np.linspace(0.4e-6, 3e-6, 50) * np.cos(angle)[:, None]
    cycle = law.cycle(motion)
    assert cycle.force[:, :, 0].max(axis=0) == pytest.approx(np.full(50, 4.0), rel=1e-12)
    assert not cycle.dissipated_energy.any()
    assert (cycle.state == ss.ContactState.STUCK).all()


def test_iwan_loads_along_its_backbone_and_turns_by_masings_rules() -> None:
    """Segalman 2005: F(x), after a turn at x0 F(x0) - 2 F((x0 - x) / 2), the backbone again beyond -x0."""

    def backbone(x: float) -> float:
        return float(IWAN.backbone(x)[0, 0])

    x0 = 0.6 * SLIDES
    down = [0.4 * x0, -0.5 * x0, -x0]
    expected = [backbone(x0) - 2.0 * backbone(0.5 * (x0 - x)) for x in down]
    actual = forces(IWAN, 0, [0.3 * x0, x0, *down, -1.2 * x0, -3.0 * SLIDES])
    assert actual[:2] == pytest.approx([backbone(0.3 * x0), backbone(x0)], rel=1e-13)
    assert actual[2:5] == pytest.approx(expected, rel=1e-12)
    assert actual[4] == pytest.approx(-backbone(x0), rel=1e-12)
    assert actual[5:] == pytest.approx([-backbone(1.2 * x0), -4000.0], rel=1e-12)


def test_a_closed_inner_loop_of_an_iwan_joint_is_forgotten() -> None:
    straight = forces(IWAN, 1, [SLIDES, -0.2 * SLIDES, 0.5 * SLIDES])
    looped = forces(
        IWAN, 1, [SLIDES, 0.3 * SLIDES, 0.6 * SLIDES, 0.1 * SLIDES, 0.2 * SLIDES, -0.2 * SLIDES, 0.5 * SLIDES]
    )
    assert looped[-2:] == pytest.approx(straight[-2:], rel=1e-13)


@pytest.mark.parametrize("size", [0.2, 1.0])
def test_iwan_equals_the_steps_of_thousands_of_jenkins_elements(size: float) -> None:
    """The turning points against sliders that each remember for themselves, on a path that is not periodic."""
    density, chi = float(IWAN._density[0, 0]), -0.6
    edges = SLIDES * np.linspace(0.0, 1.0, 3001) ** 3
    stiffness = density * np.diff(edges ** (chi + 1)) / (chi + 1)
    limits = density * np.diff(edges ** (chi + 2)) / (chi + 2)
    stiffness = np.append(stiffness, 1.5e7 - stiffness.sum())
    limits = np.append(limits, stiffness[-1] * SLIDES)
    elements = jenkins(stiffness, limits)
    memory, own = elements.memory_at_rest(), IWAN.memory_at_rest()
    for x in size * SLIDES * np.random.default_rng(5).normal(size=40):
        many = elements.step(np.tile([x, 0.0, 0.0], (stiffness.size, 1)), memory)
        one = IWAN.step(np.array([[x, 0.0, 0.0]]), own)
        memory, own = many.memory, one.memory
        assert one.force[0, 0] == pytest.approx(many.force[:, 0].sum(), abs=1e-3 * 4000.0)


@pytest.mark.slow
def test_a_kept_iwan_joint_ends_in_the_state_of_its_jenkins_elements() -> None:
    """A vibration about a loaded state: inner elements go round, outer ones keep what the load left in them."""
    density, chi = float(IWAN._density[0, 0]), -0.6
    edges = SLIDES * np.linspace(0.0, 1.0, 3001) ** 3
    stiffness = density * np.diff(edges ** (chi + 1)) / (chi + 1)
    limits = density * np.diff(edges ** (chi + 2)) / (chi + 2)
    stiffness = np.append(stiffness, 1.5e7 - stiffness.sum())
    elements = jenkins(stiffness, np.append(limits, stiffness[-1] * SLIDES))
    rest = np.array([[0.5 * SLIDES, 0.0, 0.0]])
    retained = IWAN.about(rest, IWAN.step(rest, IWAN.memory_at_rest()).memory)
    every = np.tile(rest, (stiffness.size, 1))
    many = elements.about(every, elements.step(every, elements.memory_at_rest()).memory)
    angle = 2 * np.pi * np.arange(200) / 200
    motion = np.zeros((200, 1, 3))
    motion[:, 0, 0] = 0.2 * SLIDES * (np.cos(angle) + 0.4 * np.sin(3 * angle) + 0.3)
    one, all_of_them = retained.cycle(motion), many.cycle(np.tile(motion, (1, stiffness.size, 1)))
    assert one.force[:, 0, 0] == pytest.approx(all_of_them.force[:, :, 0].sum(axis=1), abs=1e-3 * 4000.0)
    assert one.dissipated_energy[0] == pytest.approx(all_of_them.dissipated_energy.sum(), rel=3e-3)
    assert one.force[:, 0, 0].mean() > 500.0  # a released joint would carry next to nothing in the mean


def test_a_vibration_in_which_the_whole_patch_slides_forgets_the_load_of_an_iwan_joint() -> None:
    rest = np.array([[0.5 * SLIDES, 0.0, 0.0]])
    retained = IWAN.about(rest, IWAN.step(rest, IWAN.memory_at_rest()).memory)
    motion = np.zeros((200, 1, 3))
    motion[:, 0, 0] = np.cos(2 * np.pi * np.arange(200) / 200)
    for size, mean in ((0.2 * SLIDES, 1500.0), (2.0 * SLIDES, 0.0)):
        actual, released = (law.cycle(size * motion).force[:, 0, 0] for law in (retained, IWAN))
        assert abs(released.mean()) < 1e-9 * 4000.0
        assert (actual.mean() > mean) if mean else actual == pytest.approx(released, abs=1e-9 * 4000.0)


def test_a_path_to_rest_of_another_shape_gets_a_sentence() -> None:
    with rejects(ss.InputError, "path_to_rest"):
        replace(IWAN, path_to_rest=np.zeros((1, 2)))


def test_elastic_laws_follow_their_curve_and_remember_nothing() -> None:
    x = np.array([3e-6, -5e-6, 1e-6, 8e-6])
    assert forces(cubic(1e5, 1e15), 1, x) == pytest.approx(1e5 * x + 1e15 * x**3, rel=1e-14)
    one = stop(4e6, 2e-6, 1e5)
    assert forces(one, 2, x) == pytest.approx(1e5 * x + 4e6 * np.maximum(x - 2e-6, 0.0), rel=1e-14)
    both = stop(4e6, 2e-6, 1e5, two_sided=True)
    beyond = np.maximum(x - 2e-6, 0.0) + np.minimum(x + 2e-6, 0.0)
    assert forces(both, 2, x) == pytest.approx(1e5 * x + 4e6 * beyond, rel=1e-14)


def test_elastic_laws_about_a_load_feel_the_slope_there() -> None:
    """Cubic: k + 3 k3 x0^2, and f(x0 + x) - f(x0); a stop that the load has closed: spring and stop."""
    x0, x = 4e-6, 2e-6
    about = cubic(1e5, 1e16).about(np.full((1, 3), x0), None)
    assert about.resting_springs() == pytest.approx(np.full((1, 3), 1e5 + 3e16 * x0**2), rel=1e-14)
    assert forces(about, 0, [x])[0] == pytest.approx(1e5 * x + 1e16 * ((x0 + x) ** 3 - x0**3), rel=1e-12)
    assert about.normal_load == pytest.approx([1e5 * x0 + 1e16 * x0**3], rel=1e-14)
    closed = stop(4e6, 3e-6, 1e5).about(np.full((1, 3), x0), None)
    assert closed.resting_springs()[0].tolist() == [0.0, 0.0, 4.1e6]
    assert forces(closed, 2, [1e-6, -3e-6]) == pytest.approx([4.1, -4e6 * 1e-6 - 1e5 * 3e-6], rel=1e-12)
    with rejects(ss.InputError, "rest_displacement"):
        cubic([1e5, 1e5], 1e16, rest=np.zeros(3))


def test_coulomb_touches_down_slips_and_opens() -> None:
    """A gap of 2 um, k_n = 2e6, k_t = 1e6, mu = 0.3: friction grows from touchdown, at most mu N."""
    law = coulomb([2e6], [1e6], [0.3], [0.0], [2e-6])
    # Halfway down the step it touches: half of 1 um shears it, 0.5 N, within 0.3 times 4 N.
    half = law.step(np.array([[1e-6, 0.0, 4e-6]]), law.memory_at_rest())
    assert half.force[0] == pytest.approx([0.5, 0.0, 4.0])
    slip = law.step(np.array([[4e-6, 0.0, 4e-6]]), half.memory)
    assert slip.force[0] == pytest.approx([1.2, 0.0, 4.0])
    away = law.step(np.array([[4e-6, 0.0, 1e-6]]), slip.memory)
    assert away.force[0].tolist() == [0.0, 0.0, 0.0]
    assert [int(each.state[0]) for each in (half, slip, away)] == [
        ss.ContactState.STUCK,
        ss.ContactState.STICK_SLIP,
        ss.ContactState.SEPARATING,
    ]


def test_coulomb_about_a_state_has_its_load_gap_and_traction() -> None:
    law = coulomb([2e6, 2e6], [1e6, 1e6], [0.3, 0.3], [10.0, 1.0], [0.0, 0.0])
    rest = np.array([[2e-6, 0.0, 1e-6], [1e-6, 0.0, -2e-6]])
    about = law.about(rest, law.step(rest, law.memory_at_rest()).memory)
    assert about.normal_load == pytest.approx([12.0, 0.0])
    assert about.gap == pytest.approx([0.0, 1.5e-6])
    assert about.resting_traction == pytest.approx(np.array([[2.0, 0.0], [0.0, 0.0]]))
    assert law.about(rest, None).released


def test_a_stop_that_a_load_holds_closed_is_a_spring() -> None:
    """It was counted as hitting the stop, though its stiffness never changed."""
    stop = ss.ElasticStop(np.array([2e6]), gap=np.array([1e-6]), spring=np.array([1e6]))
    about = stop.about(np.array([[0.0, 0.0, 5e-6]]), None)
    motion = np.zeros((1, 3, 3))
    motion[0, 2, 1] = 1e-7
    assert about.period(motion, 64).state.tolist() == [ss.ContactState.STUCK]
    motion[0, 2, 1] = 6e-6
    assert about.period(motion, 64).state.tolist() == [ss.ContactState.SEPARATING]
