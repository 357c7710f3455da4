"""A mistuned disk with friction in waves, against the full ring as an ordinary structure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sectors import BLADE, OWN, SmallDisk, node
from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.solve.cyclic.balances import force_on_sector
from stickslip.solve.cyclic.full_ring import full_ring
from stickslip.solve.cyclic.mistuned_response import mistuned_response
from stickslip.solve.cyclic.stuck_ring import ring_force, stuck_ring
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.setting_up import prepare_balances
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.superelement import Superelement

SECTORS, HARMONICS, RATIO = 5, 2, 0.004
EVEN = 6  # the wave N / 2 has no opposite
WINDOW = (60.0, 130.0)
HIGHEST = 2.0 * np.pi * WINDOW[1]
DISKS = {count: SmallDisk.of(count, damped=False) for count in (SECTORS, EVEN)}
DISK = DISKS[SECTORS]
WAVE = Excitation.travelling_wave(2, DISK.force_cos[:, :1], DISK.force_sin[:, :1])
PATTERN = np.array([0.02, -0.03, 0.0, 0.01, 0.015, -0.01])
DEVIATIONS = PATTERN[:SECTORS]
ROW = np.zeros(OWN)
ROW[node(BLADE)] = [1.0, 0.5, 0.0]


def blade() -> BladeAlone:
    """Two modes of the blade alone; their participation may be any matrix."""
    random = np.random.default_rng(5)
    lone = (0, EVEN // 2)  # waves that are their own opposites
    parts = {
        d: random.standard_normal((2, OWN)) + 1j * (d not in lone) * random.standard_normal((2, OWN)) for d in range(4)
    }
    return BladeAlone(np.array([70.0, 110.0]), {d: 0.2 * part for d, part in parts.items()})


BLADES = blade()


def dampers(sectors: int = SECTORS) -> list[ContactPairs]:
    """Those of one sector have less load."""
    pairs = DISKS[sectors].pairs
    weak = pairs.with_constants(normal_load=0.5 * pairs.normal_load)
    return [weak, *(sectors - 1) * [pairs]]


def mistuned_ring(sectors: int = SECTORS) -> Superelement:
    """The ring with the viscous damping of the tuned disk."""
    ring = full_ring(DISKS[sectors].sector)
    tuned = prepare_balances(
        ring.superelement, ring.joint(dampers(sectors)), ring.excitation(WAVE), HIGHEST, HARMONICS, 64, RATIO,
        "tractrix", lambda stage: None,
    )  # fmt: skip
    return replace(ring.mistuned(BLADES, PATTERN[:sectors]).superelement, damping=tuned.stuck.damping)


def both(sectors: int = SECTORS) -> tuple[Balance, Balance]:
    """The balance in waves, and that of the ring."""
    wave = WAVE.wave
    assert wave is not None
    sector = DISKS[sectors].sector
    force = ring_force(force_on_sector(sector, WAVE, wave, HARMONICS).coefficients(1.0), wave, sectors)
    stuck = stuck_ring(sector, BLADES, PATTERN[:sectors], dampers(sectors), wide(), HIGHEST, RATIO)
    ring = full_ring(sector)
    of_ring = prepare_balances(
        mistuned_ring(sectors), ring.joint(dampers(sectors)), ring.excitation(WAVE), HIGHEST, HARMONICS, 64, None,
        "tractrix", lambda stage: None,
    )  # fmt: skip
    return stuck.balance(force, 64), of_ring.with_harmonics(HARMONICS)


def wide() -> FloatArray:
    """The output of this sector and of the next one."""
    return np.append(ROW, np.zeros(OWN))


def assert_close(one: Any, other: Any) -> None:
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(other).max())


@pytest.mark.parametrize("sectors", [SECTORS, EVEN])
def test_the_equation_is_that_of_the_ring(sectors: int) -> None:
    waves, ring = both(sectors)
    omega = 2.0 * np.pi * 83.0
    linear = ring.linear(omega)
    assert_close(waves.linear(omega), linear)
    trial, expected = (each.evaluate(2.0 * linear, omega) for each in (waves, ring))
    assert expected.contact.moves.any()
    assert_close(trial.residual, expected.residual)
    assert_close(waves.frequency_slope(trial), ring.frequency_slope(expected))


def test_a_compliance_in_waves_has_no_unknowns_of_the_disk() -> None:
    waves, ring = both()
    force = np.random.default_rng(3).standard_normal(6 * SECTORS)
    assert_close(waves.compliance.mean_relative(force), ring.compliance.mean_relative(force))
    with pytest.raises(TypeError):
        waves.compliance.displacement(np.zeros((2 * HARMONICS, 1)), np.zeros((2 * HARMONICS + 1, 6 * SECTORS)))
    with pytest.raises(TypeError):
        waves.compliance.mean_transposed(np.zeros(OWN))


@pytest.mark.parametrize("sectors", [SECTORS, EVEN])
def test_newtons_matrix_is_that_of_the_ring(sectors: int) -> None:
    operators = [each.compliance.newton(2.0 * np.pi * 83.0, np.arange(0, 6 * sectors, 2)) for each in both(sectors)]
    random = np.random.default_rng(1)
    deviation, weights = (random.standard_normal((2 * HARMONICS + 1, size)) for size in (3 * sectors, 6 * sectors))
    rows = np.arange(1, 6 * sectors, 3)
    for answer in (
        lambda each: each.apply(deviation),
        lambda each: each.apply_transposed(weights),
        lambda each: each.mean,
        lambda each: each.block(1, rows),
        lambda each: each.block(2, rows),
    ):
        assert_close(*map(answer, operators))


@pytest.mark.parametrize("sectors", [SECTORS, EVEN])
def test_the_preconditioner_has_the_near_modes_and_the_compliance_within_sectors(sectors: int) -> None:
    waves = both(sectors)[0]
    columns, rows, omega = np.arange(0, 6 * sectors, 2), np.arange(1, 6 * sectors, 3), 2.0 * np.pi * 83.0
    found = waves.compliance.low_rank(omega, rows, columns, 1e30)  # all near modes
    assert found is not None
    assert found.local is not None
    newton: Any = waves.compliance.newton(omega, columns)
    deviation = np.random.default_rng(1).standard_normal((2 * HARMONICS + 1, columns.size))
    moved = found.relative(found.amplitude(deviation))
    newton.far[:] = 0.0
    assert_close(moved[1:], newton.apply(deviation)[1:, rows])
    assert not moved[0].any()
    force = np.random.default_rng(2).standard_normal(6)
    tuned = stuck_ring(DISKS[sectors].sector, BLADES, np.zeros(sectors), dampers(sectors), wide(), HIGHEST, RATIO)
    alone = tuned.compliance(HARMONICS).mean_relative(np.append(force, np.zeros(6 * sectors - 6)))
    assert_close(found.local.mean @ force, alone[:6])


@pytest.mark.long
def test_the_curve_is_that_of_the_ring() -> None:
    settings: dict[str, Any] = {"frequency_hz": WINDOW, "harmonics": HARMONICS, "samples": 64}
    found = mistuned_response(
        DISK.sector, BLADES, DEVIATIONS, dampers(), WAVE, ROW, modal_damping_ratio=RATIO, **settings
    )
    assert found.converged
    ring = full_ring(DISK.sector)
    expected = forced_response(mistuned_ring(), ring.joint(dampers()), ring.excitation(WAVE), checks=False, **settings)
    assert (expected.contact_state.max(axis=0) > 0).all()
    amplitude = [expected.amplitude(ring.row(ROW, sector)) for sector in range(SECTORS)]
    highest = found.amplitude.max(axis=0)
    np.testing.assert_allclose(highest, np.max(amplitude, axis=1), rtol=3e-3)  # points of the two curves differ
    assert highest.max() > 1.05 * highest.min()
    assert found.peaks is not None
    assert found.peaks.natural_frequencies >= 2 * SECTORS
    assert not found.peaks.missed
    assert "(stuck, free) checked" in found.message


@pytest.mark.slow
def test_equal_blades_have_one_amplitude() -> None:
    # 60 samples: five sectors are sampled at the same instants of their motion
    found = mistuned_response(
        DISK.sector, BLADES, np.zeros(SECTORS), DISK.pairs, WAVE, ROW, frequency_hz=WINDOW, harmonics=1, samples=60,
        modal_damping_ratio=RATIO,
    )  # fmt: skip
    assert found.converged
    assert "harmonics = 1" in found.warnings[0]
    np.testing.assert_allclose(found.amplitude, found.amplitude[:, :1] * np.ones(SECTORS), rtol=1e-6)


@pytest.mark.parametrize(
    ("changes", "argument"),
    [
        ({"pairs": [DISK.pairs]}, "pairs"),
        (
            {"pairs": [DISK.pairs.with_constants(normal_stiffness=np.full(2, 1e5)), *(SECTORS - 1) * [DISK.pairs]]},
            "pairs",
        ),
        ({"wave": Excitation.force(DISK.force_cos[:, :1])}, "wave"),
        ({"output": ROW[1:]}, "output"),
        ({"sector": SmallDisk.of(SECTORS).sector}, "sector"),
        ({"deviations": DEVIATIONS[1:]}, "deviations"),
    ],
    ids=["few sectors", "springs", "wave", "output", "damping", "deviations"],
)
def test_input_that_cannot_be_used(changes: dict[str, Any], argument: str) -> None:
    given: dict[str, Any] = {
        "sector": DISK.sector, "blade": BLADES, "deviations": DEVIATIONS, "pairs": DISK.pairs, "wave": WAVE,
        "output": ROW,
    }  # fmt: skip
    with rejects(InputError, argument):
        mistuned_response(**given | changes, frequency_hz=WINDOW, modal_damping_ratio=RATIO)
