"""What neither damping nor friction bounds is rejected, or has a warning, before the curve."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence, rejects
from stickslip.solve.harmonic import unbounded
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.unbounded import sliding_shapes

OMEGA, STIFF = 1000.0, 1e6  # rad/s of the free mass of 1 kg, and N/m of its contact
HERTZ = OMEGA / (2.0 * math.pi)
MU, LOAD = 0.5, 20.0
HOLDS = 4.0 / math.pi * MU * LOAD  # N: first harmonic of gross slip
SLIDES = [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]  # rows t1, t2, n of a contact of the first of two masses
RANGE = (0.8 * HERTZ, 2.0 * HERTZ)
ROW = np.array([1.0, 0.0])
# The warnings are of the range, before the curve, which takes seconds in each of these cases.
FEW_POINTS = ss.ContinuationSettings(max_points=3)
ends_early = pytest.mark.filterwarnings("ignore::stickslip.core.errors.NotConvergedWarning")


def solve(
    force: float,
    operator: Any = SLIDES,
    ratio: float = 0.0,
    window: tuple[float, float] = RANGE,
    stiffness: tuple[float, float] = (OMEGA**2, 25.0 * OMEGA**2),
    **options: Any,
) -> ss.ForcedResponse:
    """Two masses on springs, the first one excited and damped by ``ratio``; the second one is out of the range."""
    damping = np.diag([2.0 * ratio * OMEGA, 0.0])
    structure = ss.Superelement(np.eye(2), np.diag(stiffness), damping)
    pairs = ss.ContactPairs(np.array(operator), STIFF, STIFF, MU, LOAD)
    settings = {"harmonics": 3, "samples": 256, "threads": 1} | options
    return ss.forced_response(structure, pairs, [force, 0.0], frequency_hz=window, **settings)


@pytest.mark.parametrize("excess", [1.001, 1.5, 1e3])
def test_a_force_that_friction_cannot_hold_is_rejected(excess: float) -> None:
    """There is no periodic motion for F > 4 mu N / pi; the amplitude at its resonance was 1e15 m."""
    with rejects(ss.InputError, "modal_damping_ratio"):
        solve(excess * HOLDS)


@pytest.mark.long
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_force_that_friction_holds_is_solved(share: float) -> None:
    """A little below the limit friction bounds the motion: the curve has a peak and no such warning."""
    response = solve(share * HOLDS)
    assert response.converged, response.message
    assert response.amplitude(ROW).max() < 100.0 * MU * LOAD / STIFF
    assert not any(f"{HOLDS:.4g} N" in each for each in response.warnings)


@pytest.mark.long
def test_a_range_without_the_mode_is_solved() -> None:
    response = solve(1.5 * HOLDS, window=(1.2 * HERTZ, 2.0 * HERTZ))
    assert response.converged, response.message


@pytest.mark.parametrize("direction", [0.0, 0.3, 0.7])
def test_the_friction_of_several_pairs_adds_up_in_both_directions(direction: float) -> None:
    """Two pairs hold twice the force in any direction of sliding; one with half the motion holds half of that."""
    one = np.outer([math.cos(direction), math.sin(direction), 0.0], [1.0, 0.0])
    twice, weaker = np.vstack([one, one]), np.vstack([one, 0.5 * one])
    for operator, holds in ((twice, 2.0 * HOLDS), (weaker, 1.5 * HOLDS)):
        grip = unbounded.grip_of(ss.ContactPairs(operator, STIFF, STIFF, MU, LOAD), ROW)
        assert grip.friction == pytest.approx(holds, rel=1e-12)
        assert not grip.opens
        assert not grip.load_varies


def test_a_jenkins_element_holds_its_limit() -> None:
    pairs = ss.ContactPairs.with_laws(np.array(SLIDES), [ss.JenkinsElement(np.array([STIFF]), np.array([MU * LOAD]))])
    assert unbounded.grip_of(pairs, ROW).friction == pytest.approx(HOLDS, rel=1e-12)


def test_an_own_law_with_a_slip_limit_holds_it() -> None:
    """Laws of other packages count by what they declare, not by their class."""

    class OwnElement(ss.JenkinsElement):
        name = "own"

    limit = np.array([MU * LOAD])
    pairs = ss.ContactPairs.with_laws(np.array(SLIDES), [OwnElement(np.array([STIFF]), limit)])
    grip = unbounded.grip_of(pairs, ROW)
    assert grip.friction == pytest.approx(HOLDS, rel=1e-12)
    assert not grip.opens
    springs = ss.ContactPairs.with_laws(np.array(SLIDES), [ss.CubicSpring(np.array([STIFF]), np.array([1e9]))])
    assert unbounded.grip_of(springs, ROW) == unbounded.Grip(0.0, True, False)


def test_a_mode_without_motion_at_the_contact_is_rejected_for_any_force() -> None:
    with rejects(ss.InputError, "modal_damping_ratio"):
        solve(1e-3, operator=[[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]])


def test_a_mode_without_motion_at_the_contact_is_not_rejected_if_nothing_excites_it() -> None:
    structure = ss.Superelement(np.eye(2), np.diag([OMEGA**2, 4.0 * OMEGA**2]))
    pairs = ss.ContactPairs([[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]], STIFF, STIFF, MU, LOAD)
    response = ss.forced_response(structure, pairs, [0.0, 1.0], frequency_hz=RANGE, harmonics=1, samples=64, threads=1)
    assert response.converged, response.message


@pytest.mark.long
@pytest.mark.parametrize("ratio", [1e-3, 1e-4])
def test_the_height_in_a_warning_is_that_of_the_peak(ratio: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Den Hartog: the force that friction does not hold works against the viscous damping."""
    monkeypatch.setattr(unbounded, "HARDLY_DAMPED", 0.1)
    response = solve(2.0 * HOLDS, ratio=ratio, samples=1024)
    assert response.converged, response.message
    (sentence,) = (each for each in response.warnings if f"{HOLDS:.4g} N" in each)
    printed_sentence(sentence, f"{2.0 * HOLDS:.4g} N")
    height = float(re.findall(r"about ([\d.e+-]+) m", sentence)[0])
    assert height == pytest.approx(HOLDS / (2.0 * ratio * OMEGA**2), rel=2e-3)
    assert response.amplitude(ROW).max() == pytest.approx(height, rel=0.01)


@pytest.mark.slow
@ends_early
def test_almost_no_damping_has_a_warning() -> None:
    response = solve(2.0 * HOLDS, ratio=1e-9, continuation=FEW_POINTS)
    printed_sentence("\n".join(response.warnings), "1.0e-09")


@pytest.mark.slow
@ends_early
def test_a_normal_load_that_can_vary_makes_it_a_warning() -> None:
    """Friction also drives the second mass, which presses the pair."""
    response = solve(1.5 * HOLDS, operator=[[1.0, 0.1], [0.0, 0.0], [0.0, 1.0]], continuation=FEW_POINTS)
    printed_sentence("\n".join(response.warnings), f"{HOLDS:.4g} N")


def test_a_normal_load_that_nothing_can_change_makes_it_an_error() -> None:
    """A second mass presses the pair, but neither the excitation nor friction moves it; 6.9 km were computed."""
    with rejects(ss.InputError, "modal_damping_ratio"):
        solve(1.5 * HOLDS, operator=[[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])


@pytest.mark.slow
def test_a_structure_far_stiffer_than_the_range_has_a_curve() -> None:
    """No mode is near the range: the displacement is that of the static force less the friction of a sliding pair."""
    stiffness, force = 1e6, 5.0 * MU * LOAD
    structure = ss.Superelement(1e-6 * np.eye(2), stiffness * np.eye(2), np.eye(2))
    pairs = ss.ContactPairs(np.array(SLIDES), STIFF, STIFF, MU, LOAD)
    response = ss.forced_response(structure, pairs, [force, 0.0], frequency_hz=(10.0, 40.0), harmonics=9, threads=1)
    assert response.converged, response.message
    np.testing.assert_allclose(response.amplitude(ROW), (force - MU * LOAD) / stiffness, rtol=0.02)


@pytest.mark.slow
@ends_early
def test_a_mode_in_which_contacts_only_open_and_close_has_a_warning() -> None:
    response = solve(0.1, operator=[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]], continuation=FEW_POINTS)
    printed_sentence("\n".join(response.warnings), f"({math.sqrt(OMEGA**2 + STIFF) / (2.0 * math.pi):.3f} Hz)")


@pytest.mark.slow
def test_a_body_that_only_friction_supports_slides_by_its_inertia() -> None:
    """Far above the limit the amplitude at the lowest frequency is (F - 4 mu N / pi) / (m w^2), but for the phase."""
    force, low = 50.0 * HOLDS, 5.0
    response = solve(force, ratio=0.0, window=(low, 20.0), stiffness=(0.0, 25.0 * OMEGA**2), samples=512)
    words = "\n".join(response.warnings)
    printed_sentence(words, numbers=False)
    height = float(re.findall(r"about ([\d.e+-]+) m", words)[0])
    assert height == pytest.approx((force - HOLDS) / (2.0 * math.pi * low) ** 2, rel=2e-3)
    assert response.amplitude(ROW)[0] == pytest.approx(height, rel=0.03)


@pytest.mark.long
def test_no_warning_with_usual_damping() -> None:
    response = solve(2.0 * HOLDS, ratio=1e-3)
    assert not any(f"{HOLDS:.4g} N" in each for each in response.warnings)


@pytest.mark.slow
def test_a_motion_that_presses_nothing_but_for_round_off_slides() -> None:
    """A free mass with friction beside a ring of springs whose pair has its normal on the ring."""
    stiffness = np.zeros((7, 7))
    for first in range(6):
        second = (first + 1) % 6
        stiffness[first, first] += 3e5
        stiffness[second, second] += 1e5
        stiffness[[first, second], [second, first]] -= 1e5
    order = np.random.default_rng(0).permutation(7)
    place = np.argsort(order)
    stiffness, mass = stiffness[np.ix_(order, order)], np.diag(np.array([0.7] * 6 + [0.3])[order])
    operator, force = np.zeros((3, 7)), np.zeros(7)
    operator[0, place[6]], operator[0, place[0]], operator[2, place[1]] = 1.0, -1.0, 0.05
    force[place[[6, 0, 1]]] = 20.0, 5.0, 3.0
    free = LinearLimit.of_matrices(mass, stiffness, np.zeros((7, 7)))
    pairs = ss.ContactPairs(operator, 1e4, 2e4, 0.3, normal_load=20.0)
    shapes = sliding_shapes(free, pairs)
    assert shapes.shape == (7, 1)
    assert np.flatnonzero(np.abs(shapes[:, 0]) > 1e-6).tolist() == [place[6]]
    response = ss.forced_response(
        ss.Superelement(mass, stiffness), pairs, force, frequency_hz=(20.0, 45.0), harmonics=3, samples=128,
        modal_damping_ratio=0.01, checks=False,
    )  # fmt: skip
    assert np.abs(response.displacement[:, place[6], 0]).max() < 1e-6
    printed_sentence("\n".join(response.warnings), numbers=False)


@pytest.mark.slow
def test_an_error_without_any_point_says_that_the_body_moves_freely() -> None:
    """At 0.01 Hz it slides by 117 km, which leaves no digits: the stiffness of the contact is not the reason."""
    with pytest.raises(ss.ConvergenceError, match="A body moves freely"):
        ss.forced_response(
            ss.Superelement(np.eye(3), np.diag([0.0, 4e6, 4e6])),
            ss.ContactPairs(np.eye(3), 1e6, 1e6, 0.3, 100.0),
            np.array([500.0, 0.0, 0.0]),
            frequency_hz=(0.01, 50.0),
            harmonics=1,
            samples=64,
            modal_damping_ratio=1e-3,
            checks=False,
            continuation=FEW_POINTS,
        )
