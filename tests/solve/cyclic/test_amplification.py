"""Amplification factors of mistuned linear disks against direct solutions of the ring, and Whitehead's limit."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sentences import printed_sentence, rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import ConvergenceError, InputError, NotConvergedWarning
from stickslip.solve.cyclic.amplification import Amplification, amplification_factors
from stickslip.solve.cyclic.full_ring import full_ring
from stickslip.solve.excitation import Excitation
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cyclic_sector import CyclicSector

SECTORS, RATIO, WINDOW = 12, 1e-3, (135.0, 185.0)
DISK_MASS, BLADE_MASS, ROOT, BLADE, COUPLING = 1.0, 0.3, 1e7, 3e5, 1e6


def lumped(sectors: int = SECTORS) -> tuple[CyclicSector, BladeAlone]:
    """Disk and blade of a mass each, with springs to the ground, to the next disk and between them."""
    stiffness = np.zeros((3, 3))  # disk, blade, disk of the next sector
    stiffness[0, 0] += ROOT
    for i, j, spring in ((0, 1, BLADE), (0, 2, COUPLING)):
        stiffness[[i, j], [i, j]] += spring
        stiffness[i, j] -= spring
        stiffness[j, i] -= spring
    mass = np.diag([DISK_MASS, BLADE_MASS, 0.0])
    sector = CyclicSector.of_matrices(mass, stiffness, left=[0], right=[2], sectors=sectors)
    # One blade alone has the mode 1 / sqrt(m), so q = sqrt(m) (u_blade - u_disk).
    row = np.sqrt(BLADE_MASS) * np.array([[-1.0, 1.0]])
    alone = BladeAlone(np.array([np.sqrt(BLADE / BLADE_MASS) / (2.0 * np.pi)]), dict.fromkeys(sector.diameters, row))
    return sector, alone


def factors(deviations: Any, engine_order: int = 3, sectors: int = SECTORS, **changes: Any) -> Amplification:
    sector, alone = lumped(sectors)
    options: dict[str, Any] = {"frequency_hz": WINDOW, "modal_damping_ratio": RATIO} | changes
    wave = options.pop("wave", Excitation.travelling_wave(engine_order, [0.0, 2.0]))
    return amplification_factors(sector, alone, deviations, wave, options.pop("output", [0.0, 1.0]), **options)


def direct_peak(deviations: np.ndarray, engine_order: int) -> float:
    """The highest amplitude of any blade from the modes of the whole mistuned ring, on a fine grid."""
    sector, alone = lumped()
    ring = full_ring(sector).mistuned(alone, deviations).superelement
    size = sector.size
    scale = np.diag(ring.mass) ** -0.5
    squares, shapes = np.linalg.eigh(scale[:, None] * ring.stiffness * scale)
    modes = scale[:, None] * shapes
    force = np.zeros(ring.size, dtype=complex)
    force[1::size] = 2.0 * np.exp(-2j * np.pi * engine_order * np.arange(SECTORS) / SECTORS)
    omega = 2.0 * np.pi * np.linspace(*WINDOW, 60001)
    resonance = squares[:, None] - omega**2 + 2j * RATIO * np.sqrt(squares)[:, None] * omega
    return float(np.abs(modes[1::size] @ ((modes.T @ force)[:, None] / resonance)).max())


@pytest.mark.slow
def test_a_tuned_disk_has_the_factor_one() -> None:
    found = factors(np.zeros((1, SECTORS)))
    np.testing.assert_allclose(found.factor, 1.0, rtol=1e-12)
    assert found.tuned_peak_hz == pytest.approx(found.peak_hz[0])
    assert found.tuned_peak == pytest.approx(direct_peak(np.zeros(SECTORS), 3), rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("engine_order", [1, 3, 11])
def test_factors_are_those_of_the_whole_ring(engine_order: int) -> None:
    patterns = 0.01 * np.random.default_rng(2).standard_normal((4, SECTORS))
    found = factors(patterns, engine_order)
    expected = [direct_peak(pattern, engine_order) for pattern in patterns]
    np.testing.assert_allclose(found.factor * found.tuned_peak, expected, rtol=1e-4)
    assert found.factor.max() > 1.1


def test_a_pattern_that_turns_with_the_disk_turns_the_sector() -> None:
    pattern = 0.01 * np.random.default_rng(4).standard_normal(SECTORS)
    found = factors([np.roll(pattern, shift) for shift in range(3)])
    np.testing.assert_allclose(found.factor, found.factor[0], rtol=1e-6)
    np.testing.assert_array_equal((found.sector - found.sector[0]) % SECTORS, [0, 1, 2])


@pytest.mark.slow
def test_no_pattern_passes_the_limit_of_whitehead() -> None:
    patterns = 0.002 * np.random.default_rng(1).standard_normal((300, SECTORS))
    found = factors(patterns)
    assert found.whitehead_limit == pytest.approx((1.0 + np.sqrt(12.0)) / 2.0)
    assert 1.4 < found.factor.max() < found.whitehead_limit


@pytest.mark.slow
def test_a_highest_amplitude_at_an_end_of_the_range_is_reported() -> None:
    tuned_hz = factors(np.zeros((1, SECTORS))).tuned_peak_hz
    patterns = np.array([np.zeros(SECTORS), np.full(SECTORS, 0.01), np.full(SECTORS, 0.1)])
    narrow: dict[str, Any] = {"frequency_hz": (tuned_hz - 1.0, tuned_hz + 1.0)}
    with pytest.warns(NotConvergedWarning):
        found = factors(patterns, **narrow)
    assert not found.converged
    assert found.at_end == 2
    assert found.factor[0] == pytest.approx(1.0)
    printed_sentence(found.message)
    with pytest.raises(ConvergenceError):
        factors(patterns, raise_on_failure=True, **narrow)
    assert factors(patterns[:1]).converged


def test_a_sector_with_damping_matrices_is_rejected() -> None:
    sector, alone = lumped()
    damped = sector.with_rayleigh_damping(1.0, 0.0)
    wave = Excitation.travelling_wave(3, [0.0, 1.0])
    options: dict[str, Any] = {"frequency_hz": WINDOW, "modal_damping_ratio": RATIO}
    with rejects(InputError, "sector"):
        amplification_factors(damped, alone, np.zeros((1, SECTORS)), wave, [0.0, 1.0], **options)


def test_coriolis_forces_are_rejected() -> None:
    sector, alone = lumped()
    whirl = np.array([[0.0, 1.0], [-1.0, 0.0]])
    whirling = {diameter: replace(each, gyroscopic=whirl) for diameter, each in sector.diameters.items()}
    wave = Excitation.travelling_wave(3, [0.0, 1.0])
    with rejects(InputError, "sector"):
        amplification_factors(
            replace(sector, diameters=whirling), alone, np.zeros((1, SECTORS)), wave, [0.0, 1.0], frequency_hz=WINDOW,
            modal_damping_ratio=RATIO,
        )  # fmt: skip


def test_stuck_pairs_between_blades_raise_the_frequency() -> None:
    operator = np.zeros((3, 4))
    operator[0, [1, 3]] = -1.0, 1.0  # blade to the blade of the next sector
    pairs = ContactPairs(operator, 1e4, 5e4, 0.3, normal_load=10.0)
    stiff, loose = (factors(np.zeros((1, SECTORS)), pairs=each, frequency_hz=(100.0, 300.0)) for each in (pairs, None))
    springs = 2.0 * 5e4 * (1.0 - np.cos(2.0 * np.pi * 3 / SECTORS))
    sector, _ = lumped()
    matrices = sector.lagged(3)
    stiffened = matrices.stiffness + np.diag([0.0, springs])
    squares = np.linalg.eigvals(np.linalg.solve(matrices.mass, stiffened))
    assert stiff.tuned_peak_hz == pytest.approx(np.sqrt(squares.real.min()) / (2.0 * np.pi), rel=1e-5)
    assert stiff.tuned_peak_hz > 1.05 * loose.tuned_peak_hz


def test_input_that_does_not_fit_is_rejected() -> None:
    zeros = np.zeros((1, SECTORS))
    with rejects(InputError, "deviations"):
        factors(np.zeros(SECTORS))
    with rejects(InputError, "output"):
        factors(zeros, output=[1.0])
    with rejects(InputError, "wave"):
        factors(zeros, wave=Excitation.force([0.0, 1.0]))
    with rejects(InputError, "wave"):
        factors(zeros, wave=Excitation.travelling_wave(1, np.ones((2, 2))))
    with rejects(InputError, "frequency_hz"):
        factors(zeros, frequency_hz=(20.0, 30.0))
    with rejects(InputError, "modal_damping_ratio"):
        factors(zeros, modal_damping_ratio=0.0)
    sector, alone = lumped()
    some = replace(sector, diameters={3: sector.diameters[3]})
    with rejects(InputError, "sector"):
        amplification_factors(
            some, alone, zeros, Excitation.travelling_wave(3, [0.0, 1.0]), [0.0, 1.0], frequency_hz=WINDOW,
            modal_damping_ratio=RATIO,
        )  # fmt: skip
    assert "Whitehead" in repr(factors(zeros))
