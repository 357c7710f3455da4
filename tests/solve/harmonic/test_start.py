"""The first point: each way of reaching it gives the same solution."""

from __future__ import annotations

import numpy as np
import pytest

from helpers import Blade
from stickslip.core.errors import ConvergenceError
from stickslip.solve.harmonic import start as start_module
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.continuation import Branch, ContinuationSettings
from stickslip.solve.path.newton import Newton, NewtonSettings

OMEGA = 2 * np.pi * 690.0


def balance_with(blade: Blade, harmonics: int) -> Balance:
    force = np.zeros((2 * harmonics + 1, blade.superelement.size))
    force[1], force[2] = blade.force_cos, blade.force_sin
    compliance = stuck_structure(blade.superelement, blade.pairs, 1.6 * OMEGA, None).compliance(harmonics)
    return Balance(compliance, blade.pairs, force, 128, "tractrix")


def test_ramp_and_few_harmonics_reach_the_direct_solution(blade: Blade) -> None:
    newton = Newton(balance_with(blade, 3), NewtonSettings(1e-10, 40))
    direct, how = first_point(newton, OMEGA)
    assert "from the linear stuck response" in how
    ramped, reached = start_module._amplitude_ramp(newton, OMEGA)
    assert reached == 1.0
    assert ramped is not None
    coarse = start_module._few_harmonics(newton, balance_with(blade, 1), OMEGA)
    assert coarse.converged
    for other in (ramped, coarse.trial):
        assert np.abs(other.relative - direct.relative).max() < 1e-7 * np.abs(direct.relative).max()


def test_falls_back_to_the_ramp(blade: Blade) -> None:
    """Twelve iterations do not suffice from the linear response near resonance, but they do along the ramp."""
    trial, how = first_point(Newton(balance_with(blade, 3), NewtonSettings()), OMEGA)
    assert "amplitude ramp" in how
    assert trial.error <= 1e-9
    assert trial.load == pytest.approx(1.0)


def test_walks_in_from_outside_when_the_ramp_folds(blade: Blade) -> None:
    """With five iterations the ramp ends at its fold, near 78 % of the force."""
    newton = Newton(balance_with(blade, 3), NewtonSettings(1e-9, 5))

    def walk(trial: Trial) -> Branch:
        return Branch(newton, trial, OMEGA, ContinuationSettings())

    with pytest.raises(ConvergenceError, match=r"amplitude ramp: stopped at 77\.\d %"):
        first_point(newton, OMEGA)
    trial, how = first_point(newton, OMEGA, walk=walk)
    assert "where it converged" in how
    assert trial.omega == pytest.approx(OMEGA)
    assert trial.error <= 1e-9
