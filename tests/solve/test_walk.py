"""Bodies that friction alone supports: they keep their tractions, and slide on from cycle to cycle where these fail."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from sentences import printed_sentence
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.solve.transient.integrate import start_from_response

STIFFNESS, FRICTION, LOAD = 1e6, 0.3, 20.0
DAMPING = np.array([0.0, 20.0, 20.0])  # N s/m; the balance leaves out the viscous force of the walk itself
SUPPORT = np.array([0.0, 1e5, 1e5])  # N/m: nothing but friction holds the mass along x
COSINE, SINE = np.array([12.0, 0.0, 6.0]), np.array([0.0, 0.0, 4.0])
HERTZ = 160.0


def solved(
    traction: list[list[float]] | None = None, share: float = 1.0, band: list[float] | None = None
) -> ss.ForcedResponse:
    """A mass of 1 kg on one pair whose normal load varies with the motion, so that slip to both sides is not alike."""
    mass = ss.Superelement(np.eye(3), np.diag(SUPPORT), np.diag(DAMPING))
    pairs = ss.ContactPairs(np.eye(3), STIFFNESS, STIFFNESS, FRICTION, LOAD, traction)
    force = share * COSINE, share * SINE
    return ss.forced_response(
        mass, pairs, *force, frequency_hz=(165.0, HERTZ), harmonics=9, samples=512, traction_band=band
    )


def integrated(
    static: float, cycles: int = 150, steps: int = 1500, start: tuple[np.ndarray, ...] | None = None
) -> tuple[float, np.ndarray]:
    """Way along x in the last cycle, and half of the ranges of the motion less that way: explicit time integration.

    ``start`` is the place, speed and traction at time 0; rest by default.
    """
    step = 1.0 / (HERTZ * steps)
    place, speed, traction = start or (np.zeros(3), np.zeros(3), np.array([static, 0.0]))
    places = np.empty((steps, 3))
    for _ in range(cycles):
        before = place[0]
        for i in range(steps):
            angle = 2 * np.pi * i / steps
            normal = max(LOAD + STIFFNESS * place[2], 0.0)
            contact = np.array([*traction, normal - LOAD])
            pushed = COSINE * np.cos(angle) + SINE * np.sin(angle) + [static, 0.0, 0.0] - contact
            speed = speed + step * (pushed - SUPPORT * place - DAMPING * speed)
            place = place + step * speed
            traction = traction + STIFFNESS * step * speed[:2]
            limit = FRICTION * max(LOAD + STIFFNESS * place[2], 0.0)
            size = np.hypot(*traction)
            if size > limit:
                traction *= limit / size
            places[i] = place
        way = place[0] - before
    places[:, 0] -= way * np.arange(1, steps + 1) / steps
    return float(way), 0.5 * np.ptp(places, axis=0)


@pytest.mark.long
@pytest.mark.parametrize("static", [0.0, 2.0])
def test_a_mass_walks_as_in_time_integration(static: float) -> None:
    """Way of a cycle and amplitudes; the integration knows neither harmonics nor a state after many cycles."""
    response = solved([[static, 0.0]] if static else None)
    point = len(response.frequency_hz) - 1
    assert response.converged
    assert response.frequency_hz[point] == pytest.approx(HERTZ)
    way, motion = integrated(static)
    assert abs(way) > 1e-6
    assert response.walk is not None
    assert response.walk[point] == pytest.approx([way, 0.0, 0.0], rel=2e-3)
    assert response.pair_way(point)[0] == pytest.approx([CYCLES * way, 0.0, 0.0], rel=2e-3)
    assert abs(response.displacement[point, 0, 0]) < 2.0 * motion[0]
    signals = [response.signal(axis, point, 1000) for axis in np.eye(3)[[0, 2]]]
    assert [0.5 * np.ptp(signal) for signal in signals] == pytest.approx(motion[[0, 2]], rel=2e-3)
    assert response.amplitude(np.eye(3)[0])[point] < 2.0 * motion[0]


@pytest.mark.slow
def test_a_walk_starts_from_its_place() -> None:
    """The first cycle of a time integration from the curve is that of the walk."""
    response = solved()
    point = len(response.frequency_hz) - 1
    assert response.walk is not None
    start = start_from_response(response, point)
    place, speed = start["initial_displacement"], start["initial_velocity"]
    way, motion = integrated(0.0, 1, 6000, (place, speed, STIFFNESS * (place[:2] - start["initial_slider"][0])))
    assert way == pytest.approx(response.walk[point, 0], rel=2e-2)
    assert 0.5 * np.ptp(response.signal([1, 0, 0], point, 1000)) == pytest.approx(motion[0], rel=1e-2)


@pytest.mark.slow
def test_curves_beside_a_walk_leave_the_way_out() -> None:
    response = solved(band=[1, 0, 0])
    assert response.walk is not None
    assert response.traction_band is not None
    largest = response.amplitude([1, 0, 0]).max()
    for curve in response.traction_band.curves([1, 0, 0]):
        assert curve.amplitude.max() < 2.0 * largest


@pytest.mark.slow
def test_the_energy_of_a_walk_balances() -> None:
    """Also where a static load, which the traction at rest balances, works on the way."""
    for traction in (None, [[2.0, 0.0]]):
        response = solved(traction)
        lost = response.friction_energy.sum(axis=1) + response.viscous_energy
        assert lost == pytest.approx(response.input_energy, rel=1e-3)


@pytest.mark.slow
def test_a_walk_is_reported() -> None:
    response = solved()
    assert response.pairs.residual_traction is not None
    assert not response.pairs.residual_traction.any()
    assert response.walk is not None
    way = np.abs(response.walk).max()
    assert way > 1e-6
    printed_sentence("\n".join(response.warnings), f"{1e6 * way:.3g} um", numbers=False)


@pytest.mark.slow
def test_a_body_that_sticks_does_not_walk() -> None:
    response = solved(share=0.005)
    assert (response.contact_state == ss.ContactState.STUCK).all()
    printed_sentence("\n".join(response.warnings), numbers=False)
    assert response.walk is None


@pytest.mark.slow
def test_without_need_the_tractions_stay_released() -> None:
    mass = ss.Superelement(np.eye(3), np.diag(SUPPORT + np.array([1e5, 0.0, 0.0])), np.diag(DAMPING))
    pairs = ss.ContactPairs(np.eye(3), STIFFNESS, STIFFNESS, FRICTION, LOAD)
    response = ss.forced_response(mass, pairs, COSINE, SINE, frequency_hz=(165.0, HERTZ), harmonics=3)
    assert response.pairs.residual_traction is None
