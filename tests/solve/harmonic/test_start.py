"""The first point: each way of reaching it gives the same solution."""

from __future__ import annotations

import numpy as np
import pytest

from helpers import Blade
from sentences import printed_sentence, rejects
from stickslip.core.errors import ConvergenceError
from stickslip.solve.excitation import ExcitationForce
from stickslip.solve.harmonic import start as start_module
from stickslip.solve.harmonic.balance import Balance
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings

OMEGA = 2 * np.pi * 690.0


def balance_with(blade: Blade, harmonics: int) -> Balance:
    force = np.zeros((2 * harmonics + 1, blade.superelement.size))
    force[1], force[2] = blade.force_cos, blade.force_sin
    compliance = stuck_structure(blade.superelement, blade.pairs, 1.6 * OMEGA, None).compliance(harmonics)
    return Balance(compliance, blade.pairs, ExcitationForce(((0, force),)), 128)


@pytest.mark.slow
def test_ramp_and_few_harmonics_reach_the_direct_solution(blade: Blade) -> None:
    curve = FrequencyCurve(balance_with(blade, 3))
    newton = Newton(curve, NewtonSettings(1e-10, 40))
    direct, how = first_point(newton, curve, OMEGA)
    printed_sentence(how, numbers=False)
    ramped, message = start_module.amplitude_ramp(newton, curve, OMEGA)
    assert ramped is not None, message
    coarse = start_module._few_harmonics(newton, curve, balance_with(blade, 1), OMEGA)
    assert coarse.converged
    for other in (ramped, coarse.point):
        assert np.abs(other.unknowns - direct.unknowns).max() < 1e-7 * np.abs(direct.unknowns).max()


@pytest.mark.slow
def test_falls_back_to_the_ramp(blade: Blade) -> None:
    """Twelve iterations do not suffice from the linear response near resonance, but they do along the ramp."""
    curve = FrequencyCurve(balance_with(blade, 3))
    point, how = first_point(Newton(curve, NewtonSettings()), curve, OMEGA)
    printed_sentence(how, numbers=False)
    assert point.error <= 1e-9
    assert point.trial.load == pytest.approx(1.0)


@pytest.mark.slow
def test_the_ramp_passes_its_fold(blade: Blade) -> None:
    """With five iterations the step across the fold, near 78 % of the force, must follow the curve."""
    curve = FrequencyCurve(balance_with(blade, 3))
    point, how = first_point(Newton(curve, NewtonSettings(1e-9, 5)), curve, OMEGA)
    printed_sentence(how, numbers=False)
    assert point.trial.load == pytest.approx(1.0)
    assert point.error <= 1e-9


@pytest.mark.slow
def test_no_ramp_begins_after_others_took_too_long(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(start_module, "RAMP", ContinuationSettings(max_points=3))
    monkeypatch.setattr(start_module, "MOST_IN_RAMPS", 10.0)
    curve = FrequencyCurve(balance_with(blade, 3))
    newton = Newton(curve, NewtonSettings())
    ramps: list[float] = []
    while curve.work.in_ramps < 10.0:
        before = curve.work.newton
        assert start_module.amplitude_ramp(newton, curve, OMEGA)[0] is None
        ramps.append(curve.work.newton - before)
    assert curve.work.in_ramps == sum(ramps) > 0.0
    before = curve.work.newton
    point, message = start_module.amplitude_ramp(newton, curve, OMEGA)
    assert point is None
    assert curve.work.newton == before
    printed_sentence(message, numbers=False)


@pytest.mark.slow
def test_walks_in_from_outside_when_the_ramp_fails(blade: Blade, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(start_module, "RAMP", ContinuationSettings(max_points=3))
    curve = FrequencyCurve(balance_with(blade, 3))
    newton = Newton(curve, NewtonSettings(1e-9, 5))

    def walk(point: BalancePoint) -> Branch[BalancePoint]:
        return Branch(newton, point, OMEGA, ContinuationSettings())

    with rejects(ConvergenceError):
        first_point(newton, curve, OMEGA)
    point, how = first_point(newton, curve, OMEGA, walk=walk)
    printed_sentence(how, numbers=False)
    assert point.trial.omega == pytest.approx(OMEGA)
    assert point.error <= 1e-9
