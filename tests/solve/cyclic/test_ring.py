"""A sector against the full ring, which the ordinary path solves: friction, separation, pairs across the boundary."""

from typing import Any

import numpy as np
import pytest

from sectors import OWN, SmallDisk
from sentences import printed_sentence
from stickslip.core.fourier import synthesis_matrix
from stickslip.solve.cyclic.balances import sector_balances
from stickslip.solve.excitation import Excitation, TravellingWave
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.setting_up import prepare_balances
from stickslip.solve.transient.integrate import integrate_to_steady_state

# Samples of a period: a multiple of both numbers of sectors, so that the samples of all sectors are the same instants.
HARMONICS, SAMPLES = 3, 96
SHARP = NewtonSettings(tolerance=1e-12)
SLIPS, OPENS = 1, 2


def of_sector(disk: Any, engine_order: Any, direction: Any, omega: Any, ratio: Any = None) -> Any:
    """The balances of one sector."""
    wave = Excitation.travelling_wave(engine_order, disk.force_cos, disk.force_sin, direction)
    return sector_balances(
        disk.sector, disk.pairs, wave, omega, HARMONICS, HARMONICS, SAMPLES, ratio, "tractrix", lambda words: None
    )


def of_ring(disk: Any, engine_order: Any, direction: Any, omega: Any, ratio: Any = None) -> Any:
    """The balances of the full ring, by the ordinary path."""
    force = Excitation.force(*disk.ring_force(engine_order, direction))
    return prepare_balances(
        disk.ring, disk.ring_pairs, force, omega, HARMONICS, SAMPLES, ratio, "tractrix", lambda words: None
    )


def solved(balances: Any, omega: float, harmonics: int = HARMONICS) -> Any:
    """The converged trial of balances at a frequency, from their own linear response, and its displacement."""
    balance = balances.with_harmonics(harmonics)
    curve = FrequencyCurve(balance)
    point, _ = first_point(Newton(curve, SHARP), curve, omega, balances.with_harmonics)
    return point.trial, balance.displacement([point.trial])[0]


def of_all(coefficients: Any, balances: Any) -> Any:
    """Coefficients (2H+1, N k) of all sectors, one after the other, from those (2H+1, k) of the first one."""
    sectors = balances.stuck.sector.sectors
    return np.concatenate(
        [balances.stuck.wave.shifted(coefficients.T, sectors, ahead).T for ahead in range(sectors)], axis=1
    )


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["forward", "backward"])
@pytest.mark.parametrize(
    ("sectors", "engine_order", "state"),
    [
        (6, 0, [OPENS, OPENS]),
        (6, 1, [SLIPS, OPENS]),
        (6, 2, [SLIPS, OPENS]),
        (6, 5, [SLIPS, OPENS]),
        (12, 3, [OPENS, OPENS]),
        (12, 4, [SLIPS, OPENS]),
        (12, 17, [SLIPS, SLIPS]),
    ],
)
def test_every_sector_moves_as_the_first_one_later(sectors: Any, engine_order: Any, state: Any, direction: Any) -> None:
    disk, omega = SmallDisk.of(sectors), 2.0 * np.pi * 84.0
    own, whole = (kind(disk, engine_order, direction, omega) for kind in (of_sector, of_ring))
    trial, motion = solved(own, omega)
    ring_trial, ring_motion = solved(whole, omega)
    size = np.abs(ring_motion).max()
    np.testing.assert_allclose(ring_motion, of_all(motion, own), rtol=0.0, atol=1e-8 * size)
    assert np.abs(ring_motion[5:]).max() > 1e-3 * size  # so that a wrong lag of the third harmonic shows
    if direction == "forward":
        assert trial.contact.state.tolist() == state
    assert (ring_trial.contact.state.reshape(sectors, 2) == trial.contact.state).all()


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_outputs_of_a_vibration_in_this_and_the_next_sector_are_those_of_the_ring(direction: Any) -> None:
    disk, omega = SmallDisk.of(6), 2.0 * np.pi * 84.0
    own, whole = (kind(disk, 1, direction, omega) for kind in (of_sector, of_ring))
    trial, motion = solved(own, omega)
    outputs = np.random.default_rng(0).standard_normal((3, 2 * motion.shape[1]))
    answer = own.vibration_of(outputs)(own.with_harmonics(HARMONICS), trial.amplitude[None])[0]
    expected = solved(whole, omega)[1][1:, : outputs.shape[1]] @ outputs.T
    np.testing.assert_allclose(answer, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())


def test_modal_damping_of_a_sector_is_that_of_the_ring() -> None:
    disk, omega = SmallDisk.of(6, damped=False), 2.0 * np.pi * 84.0
    own, whole = (kind(disk, 2, "forward", omega, 0.01) for kind in (of_sector, of_ring))
    expected, motion = solved(whole, omega)[1], of_all(solved(own, omega)[1], own)
    np.testing.assert_allclose(motion, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [None, 0.01])
@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_coriolis_forces_of_a_sector_are_those_of_the_ring(direction: Any, ratio: Any) -> None:
    disk, omega = SmallDisk.of(6, damped=ratio is None, whirls=True), 2.0 * np.pi * 84.0
    own, whole = (kind(disk, 1, direction, omega, ratio) for kind in (of_sector, of_ring))
    trial, motion = solved(own, omega)
    expected = solved(whole, omega)[1]
    size = np.abs(expected).max()
    np.testing.assert_allclose(of_all(motion, own), expected, rtol=0.0, atol=1e-8 * size)
    assert (trial.contact.state == [SLIPS, OPENS]).all()
    still = solved(of_sector(SmallDisk.of(6, damped=ratio is None), 1, direction, omega, ratio), omega)[1]
    assert np.abs(still - motion).max() > 0.05 * size


@pytest.mark.slow
def test_energies_and_frequencies_of_a_curve_with_coriolis_forces() -> None:
    disk = SmallDisk.of(6, whirls=True)
    curves = {}
    for direction in ("forward", "backward"):
        wave = Excitation.travelling_wave(1, disk.force_cos, disk.force_sin, direction)
        curves[direction] = forced_response(
            disk.sector, disk.pairs, wave, frequency_hz=(100.0, 76.0), harmonics=HARMONICS, samples=SAMPLES
        )
    for direction, curve in curves.items():
        assert curve.converged
        lost = curve.dissipated_energy.sum(axis=1) + curve.viscous_energy
        np.testing.assert_allclose(lost, curve.input_energy, rtol=1e-7)
        free = disk.sector.natural_frequencies(1, 5, direction)  # type: ignore[arg-type]
        np.testing.assert_allclose(curve.linear.free_frequency_hz[:5], free, rtol=1e-10)
    one, other = (each.linear.stuck_frequency_hz[:5] for each in curves.values())
    assert np.abs(one / other - 1.0).max() > 1e-3


@pytest.fixture(scope="module")
def curve() -> Any:
    disk = SmallDisk.of(6)
    wave = Excitation.travelling_wave(1, disk.force_cos, disk.force_sin)
    return forced_response(
        disk.sector, disk.pairs, wave, frequency_hz=(100.0, 76.0), harmonics=HARMONICS, samples=SAMPLES
    )


@pytest.mark.slow
def test_each_point_of_a_curve_balances_the_ring(curve: Any) -> None:
    disk = SmallDisk.of(6)
    omega = 2.0 * np.pi * curve.frequency_hz
    own, whole = (kind(disk, 1, "forward", float(omega.max())) for kind in (of_sector, of_ring))
    balance, balance_of_ring = own.with_harmonics(HARMONICS), whole.with_harmonics(HARMONICS)
    for point in range(curve.n_points):
        relative = curve.pair_coefficients(point).reshape(6, -1).T
        error = balance.evaluate(relative, float(omega[point])).error
        error_of_ring = balance_of_ring.evaluate(of_all(relative, own), float(omega[point])).error
        assert error_of_ring == pytest.approx(error, abs=1e-10)
        assert error < 1e-7
    assert curve.converged
    assert (curve.contact_state.max(axis=0) == OPENS).all()


@pytest.mark.slow
def test_energies_of_a_curve_are_those_of_one_sector(curve: Any) -> None:
    disk = SmallDisk.of(6)
    lost = curve.dissipated_energy.sum(axis=1) + curve.viscous_energy
    np.testing.assert_allclose(lost, curve.input_energy, rtol=1e-7)
    top = int(curve.input_energy.argmax())
    own = of_sector(disk, 1, "forward", 700.0)
    first = of_all(curve.displacement[top].T[:, :OWN], own)[1:3]
    kinetic = 0.5 * (2.0 * np.pi * curve.frequency_hz[top]) ** 2 * np.einsum("ij,jk,ik", first, disk.ring.mass, first)
    assert curve.kinetic_energy[top] == pytest.approx(kinetic / 6, rel=1e-10)
    assert curve.residual.max() < 1e-8


def test_the_linear_limits_are_those_of_the_ring(curve: Any) -> None:
    disk = SmallDisk.of(6)
    whole = of_ring(disk, 1, "forward", 700.0)
    omega = 2.0 * np.pi * curve.linear.frequency_hz[::10]
    for limit, shown in ((whole.closed, curve.linear.stuck), (whole.free, curve.linear.free)):
        expected = limit.response_to(omega, whole.force)[:, : 2 * OWN]
        np.testing.assert_allclose(shown[::10], expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    assert np.isin(curve.linear.free_frequency_hz.round(6), whole.free.natural_hz.round(6)).all()


def test_unknowns_of_the_next_sector_are_those_of_this_one_later(curve: Any) -> None:
    own = of_sector(SmallDisk.of(6), 1, "forward", 700.0)
    for coefficients, smallest in ((curve.displacement, 1e-15), (curve.force, 1e-12)):
        here, following = np.split(coefficients, 2, axis=-2)
        np.testing.assert_allclose(following, own.stuck.wave.shifted(here, 6, 1), atol=smallest)


def test_the_stability_of_a_sector_is_not_known(curve: Any) -> None:
    assert curve.stable is None
    printed_sentence(curve.stability_message)


def test_a_force_on_the_next_sector_is_one_on_this_sector_earlier() -> None:
    disk = SmallDisk.of(6)
    expected = of_sector(disk, 2, "forward", 500.0).force
    ahead = TravellingWave(2).shifted(expected.terms[0][1][:5].T, 6, 1)
    wide = [np.vstack([np.zeros_like(disk.force_cos), ahead[:, first::2]]) for first in (1, 2)]
    disk_ahead = SmallDisk(6, disk.mass, disk.stiffness, disk.damping, disk.operator, *wide)
    found = of_sector(disk_ahead, 2, "forward", 500.0).force
    np.testing.assert_allclose(found.terms[0][1], expected.terms[0][1], atol=1e-12)


@pytest.mark.slow
def test_harmonics_by_accuracy() -> None:
    disk = SmallDisk.of(6)
    weak = Excitation.travelling_wave(1, 0.3 * disk.force_cos, 0.3 * disk.force_sin)
    response = forced_response(disk.sector, disk.pairs, weak, frequency_hz=(99.0, 97.0), accuracy=0.05, samples=SAMPLES)
    assert response.converged
    assert response.estimated_error is not None
    assert response.estimated_error.max() < 0.05


@pytest.mark.slow
def test_a_time_integration_of_the_ring_ends_in_the_motion_of_the_sector() -> None:
    disk, hertz, harmonics = SmallDisk.of(4), 84.0, 9
    wave = Excitation.travelling_wave(1, disk.force_cos, disk.force_sin)
    own = sector_balances(
        disk.sector, disk.pairs, wave, 2.0 * np.pi * hertz, harmonics, harmonics, 192, None, "tractrix",
        lambda words: None,
    )  # fmt: skip
    trial, motion = solved(own, 2.0 * np.pi * hertz, harmonics)
    in_time = integrate_to_steady_state(
        disk.ring, disk.ring_pairs, *disk.ring_force(1, "forward"), hertz, steps_per_period=400, tolerance=1e-5
    )
    signal = synthesis_matrix(harmonics, 400) @ of_all(motion, own)
    assert trial.contact.state.tolist() == [SLIPS, OPENS]
    assert in_time.converged
    assert np.abs(in_time.displacement - signal).max() < 3e-3 * np.abs(signal).max()


@pytest.mark.slow
@pytest.mark.parametrize("engine_order", [1, 2])
def test_landmarks_are_those_of_the_ring(engine_order: int) -> None:
    disk, omega = SmallDisk.of(6), 2.0 * np.pi * 84.0
    own, whole = (kind(disk, engine_order, "forward", omega) for kind in (of_sector, of_ring))
    # Of the tangent structure too, which counts once two successive points have the same moving pairs.
    marks = []
    for balances in (own, whole):
        landmarks, point = balances.landmarks(), FrequencyCurve(balances.with_harmonics(HARMONICS)).at
        relative = solved(balances, omega)[0].relative
        for _ in range(2):
            landmarks.of(point(relative, omega))
        marks.append(
            [np.unique([round(getattr(mark, name), 6) for mark in landmarks.seen]) for name in ("value", "width")]
        )
    for found, expected in zip(*marks, strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-6)
    limits = len(own.landmarks().seen)
    assert len(marks[0][0]) > limits
