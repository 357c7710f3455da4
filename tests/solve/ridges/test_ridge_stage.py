"""The range of frequencies of a whole curve contains what pairs that close in vibration may do."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import stickslip as ss
from helpers import Blade
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage
from stickslip.solve.setting_up import StageReport

BLADE = Blade()
FACTOR = 1.03


def stage(open_pairs: int) -> RidgeStage:
    """The blade with some pairs open at rest."""
    preload = BLADE.pairs.preload.copy()
    preload[:open_pairs] = -1.0
    force = ss.Excitation.force(BLADE.force_cos, BLADE.force_sin)
    options = RidgeOptions((0.5 * BLADE.free_hz, 2.0 * BLADE.stuck_hz), harmonics=1, samples=64)
    problem = BLADE.superelement, BLADE.pairs_with(preload), force
    return RidgeStage.of(problem, BLADE.tip, options, None, StageReport(None))


@pytest.mark.parametrize("open_pairs", [0, 3, 8])
def test_the_range_ends_above_the_frequency_with_all_pairs_closed(open_pairs: int) -> None:
    found = stage(open_pairs)
    springs = BLADE.pairs.stuck_stiffness()
    closed = BLADE.superelement.stiffness + BLADE.operator.T @ (springs[:, None] * BLADE.operator)
    exact_hz = np.sqrt(scipy.linalg.eigvalsh(closed, BLADE.superelement.mass)[0]) / (2.0 * np.pi)
    at_rest_hz = found.balances.closed.natural_hz[0]
    if open_pairs:
        assert at_rest_hz < 0.99 * exact_hz
    highest = found.window_around(FACTOR, frozenset({0}))[1] / FACTOR
    assert highest == pytest.approx(exact_hz, rel=2e-3)
    assert highest >= exact_hz * (1.0 - 1e-4)  # the peak of a damped structure is a little below
