"""Input of a sector that cannot be used, and analyses that are not valid for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sectors import SmallDisk
from sentences import rejects
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import InputError
from stickslip.results.response import ForcedResponse
from stickslip.solve.controlled import controlled_response
from stickslip.solve.curve_structures import CurveInput, curve_structure
from stickslip.solve.excitation import Excitation
from stickslip.solve.forced import forced_response
from stickslip.solve.gradients.peak_gradients import peak_gradients
from stickslip.solve.modes.nonlinear_mode import nonlinear_mode
from stickslip.solve.other_solutions import search_other_solutions
from stickslip.solve.static.ramp_to_rest import static_preload
from stickslip.solve.transient.integrate import integrate_to_steady_state
from stickslip.structure.cyclic_sector import CyclicSector

DISK = SmallDisk.of(6)
WAVE = Excitation.travelling_wave(1, DISK.force_cos)
WINDOW = (80.0, 90.0)


def solve(sector: CyclicSector = DISK.sector, **changes: Any) -> None:
    arguments: dict[str, Any] = {"pairs": DISK.pairs, "excitation": WAVE, "frequency_hz": WINDOW, "harmonics": 2}
    forced_response(sector, **(arguments | changes))


def without(*diameters: int) -> CyclicSector:
    sector = DISK.sector
    return replace(sector, diameters={d: each for d, each in sector.diameters.items() if d not in diameters})


def test_an_engine_order_whose_nodal_diameter_the_reduction_omitted() -> None:
    with rejects(InputError, "diameters"):
        solve(without(1))


def test_a_harmonic_whose_nodal_diameter_the_reduction_omitted() -> None:
    with rejects(InputError, "diameters"):
        solve(without(3))


def test_the_mean_without_diameter_zero() -> None:
    with rejects(InputError, "diameters"):
        solve(without(0))


def test_a_force_that_does_not_travel() -> None:
    with rejects(InputError, "excitation"):
        solve(excitation=Excitation.force(DISK.force_cos))
    with rejects(InputError, "excitation"):
        solve(excitation=DISK.force_cos)


def test_a_wave_on_a_structure() -> None:
    with rejects(InputError, "excitation"):
        forced_response(DISK.ring, DISK.ring_pairs, WAVE, frequency_hz=WINDOW)


@pytest.mark.parametrize("order", [-1, 1.5])
def test_an_engine_order_that_is_none(order: Any) -> None:
    with rejects(InputError, "engine_order"):
        Excitation.travelling_wave(order, DISK.force_cos)


def test_a_direction_that_is_none() -> None:
    with rejects(InputError, "direction"):
        Excitation.travelling_wave(1, DISK.force_cos, direction="left")  # type: ignore[arg-type]


def test_two_engine_orders_together() -> None:
    with rejects(InputError, "excitation"):
        WAVE + Excitation.travelling_wave(2, DISK.force_cos)
    with rejects(InputError, "excitation"):
        WAVE + Excitation.unbalance(np.ones(9), np.ones(9), 1e-4)
    both = WAVE + Excitation.travelling_wave(1, np.ones(9))
    assert both.wave == WAVE.wave
    assert both.describe() == "forward wave of engine order 1 and forward wave of engine order 1"


def test_a_force_of_another_size() -> None:
    with rejects(InputError, "excitation"):
        solve(excitation=Excitation.travelling_wave(1, np.ones(10)))


def test_an_operator_of_another_size() -> None:
    wrong = ContactPairs.with_laws(np.ones((6, 10)), DISK.pairs.laws, DISK.pairs.members)
    with rejects(InputError, "operator"):
        solve(pairs=wrong)


def test_a_sector_without_damping() -> None:
    with rejects(InputError, "modal_damping_ratio"):
        solve(SmallDisk.of(6, damped=False).sector)
    with rejects(InputError, "modal_damping_ratio"):
        solve(modal_damping_ratio=0.01)


def test_contact_far_stiffer_than_the_disk() -> None:
    stiff = ContactPairs(DISK.operator, 1e15, 1e15, 0.3, normal_load=10.0)
    with rejects(InputError):
        solve(pairs=stiff)


def test_a_traction_band() -> None:
    with rejects(InputError, "traction_band"):
        solve(traction_band=np.ones(18))


def test_balances_of_a_sector_are_none_of_a_structure() -> None:
    given = CurveInput(DISK.pairs, WAVE, 600.0, 2, False, 64, None, "tractrix")
    balances = curve_structure(DISK.sector).balances(given, lambda words: None)
    assert balances.no_stability
    assert balances.in_time() is None
    with rejects(InputError, "superelement"):
        balances.of_structure()
    with rejects(InputError, "superelement"):
        balances.stability([], DISK.pairs)


def test_a_structure_of_another_type() -> None:
    with rejects(InputError, "superelement"):
        solve(DISK.mass)  # type: ignore[arg-type]


@pytest.mark.long
def test_analyses_that_are_not_valid_for_a_sector() -> None:
    sector: Any = DISK.sector
    pairs = ContactPairs.with_laws(DISK.operator[:, :9], DISK.pairs.laws, DISK.pairs.members)
    force = Excitation.force(DISK.force_cos[:, 0])
    output = np.eye(9)[0]
    with rejects(InputError, "superelement"):
        integrate_to_steady_state(sector, pairs, np.ones(9), np.ones(9), 80.0)
    with rejects(InputError, "superelement"):
        static_preload(sector, pairs, np.ones(9))
    with rejects(InputError, "superelement"):
        nonlinear_mode(sector, DISK.pairs, 1, (1e-6, 1e-5))
    with rejects(InputError, "superelement"):
        controlled_response(sector, pairs, force, frequency_hz=WINDOW, output=output, amplitude=1e-5)
    response = forced_response(sector, DISK.pairs, WAVE, frequency_hz=(100.0, 99.9), harmonics=2)
    with rejects(InputError, "superelement"):
        search_other_solutions(sector, DISK.pairs, WAVE, response)
    with rejects(InputError, "superelement"):
        peak_gradients(sector, DISK.pairs, WAVE, response, np.ones(18))


@pytest.mark.slow
def test_a_stored_response_of_a_sector(tmp_path: Path) -> None:
    response = forced_response(DISK.sector, DISK.pairs, WAVE, frequency_hz=(100.0, 99.9), harmonics=2)
    response.save(tmp_path / "results.nc")
    again = ForcedResponse.load(tmp_path / "results.nc")
    np.testing.assert_array_equal(again.displacement, response.displacement)
    np.testing.assert_array_equal(again.pairs.operator, DISK.operator)
    assert again.settings["excitation"] == "forward wave of engine order 1"


def test_damping_that_does_not_reach_a_mode() -> None:
    """A blade on its own spring beside a hub with a damped blade."""
    stiffness = np.zeros((4, 4))
    for first, second, spring in ((0, 3, 2e5), (0, 1, 1e5)):
        stiffness[[first, second], [first, second]] += spring
        stiffness[[first, second], [second, first]] -= spring
    stiffness[0, 0], stiffness[2, 2] = stiffness[0, 0] + 3e5, 4e4
    mass, damping = np.diag([0.5, 0.2, 0.2, 0.5]), np.diag([0.0, 5.0, 0.0, 0.0])
    sector = CyclicSector.of_matrices(mass, stiffness, damping, left=[0], right=[3], sectors=6)
    operator = np.zeros((3, 6))
    operator[0, 1] = operator[1, 0] = 1.0
    operator[2, 0] = 0.1
    pairs = ContactPairs(operator, 1e4, 2e4, 0.3, normal_load=5.0)
    wave = Excitation.travelling_wave(0, [2.0, 0.0, 1.0])
    with rejects(InputError, "modal_damping_ratio"):
        solve(sector, pairs=pairs, excitation=wave, frequency_hz=(66.0, 76.0))
