"""The branch stays on its curve: long steps do not jump across a sharp resonance."""

from __future__ import annotations

import numpy as np
import pytest
from plane_curves import circle

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.structure.superelement import Superelement

RATIO = 1e-3


@pytest.mark.parametrize(("max_points", "lost"), [(8, False), (90, True)])
def test_a_branch_that_runs_back_when_it_has_used_its_points_is_lost(max_points: int, lost: bool) -> None:
    """On the circle from (1, 0): up to y = 1, then back. A curve may begin again beyond, not on the way there."""
    curve = circle()
    settings = ContinuationSettings(largest_step=0.02, max_points=max_points)
    branch = Branch(Newton(curve, NewtonSettings()), curve.at(1.0, 0.0), 2.0, settings)
    branch.follow()
    assert "points were not enough" in branch.message
    assert not branch.complete
    assert branch.lost == lost


def resonance(largest_step: float, preload: float = 1e6) -> ForcedResponse:
    """A mass on springs and one contact that sticks, with 0.1 % damping; its peak is 500 times the static answer."""
    force = np.zeros(3)
    force[0] = 10.0
    return forced_response(
        Superelement(np.eye(3), 4e6 * np.eye(3)),
        ContactPairs(np.eye(3), 1e6, 1e6, 0.3, preload),
        force,
        frequency_hz=(340.0, 370.0),
        harmonics=1,
        samples=64,
        modal_damping_ratio=RATIO,
        continuation=ContinuationSettings(largest_step=largest_step),
    )


@pytest.mark.slow
@pytest.mark.parametrize("largest_step", [0.05, 0.15, 0.5, 1.0])
def test_long_steps_pass_over_the_peak_of_a_linear_resonance(largest_step: float) -> None:
    curve = resonance(largest_step)
    assert curve.converged, curve.message
    assert (np.diff(curve.frequency_hz) > 0).all()
    exact = 10.0 / (2.0 * RATIO * 5e6)
    peak = curve.amplitude(np.array([1.0, 0.0, 0.0])).max()
    assert 0.98 * exact < peak <= exact * (1 + 1e-9)


@pytest.mark.long
@pytest.mark.parametrize("largest_step", [0.15, 0.5])
def test_long_steps_keep_to_a_curve_that_slips(largest_step: float) -> None:
    row = np.array([1.0, 0.0, 0.0])
    close, coarse = resonance(0.03, preload=2000.0), resonance(largest_step, preload=2000.0)
    assert coarse.converged, coarse.message
    assert (close.contact_state == 1).any()
    assert coarse.amplitude(row).max() == pytest.approx(close.amplitude(row).max(), rel=0.02)
