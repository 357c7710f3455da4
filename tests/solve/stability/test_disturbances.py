"""Disturbances of a motion whose pairs touch their limits: each choice of touches from one march."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import stickslip as ss
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.stability import disturbances
from stickslip.solve.stability.contact_steps import linear_steps
from stickslip.solve.stability.disturbances import Disturbances
from stickslip.solve.stability.model import stability_model

SAMPLES, OMEGA = 64, 1.1
PHASE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
MASS, STIFFNESS = np.diag([1.0, 0.6, 1.4]), np.diag([3.0, 2.5, 2.0])


def touching_pairs() -> tuple[Disturbances, list[Disturbances]]:
    """Of three pairs the first touches both limits, the second one limit in two directions, and the third slips. Also
    the marches with the steps of each choice of touches."""
    operator = np.vstack([np.eye(3), np.roll(np.eye(3), 1, axis=0), np.roll(np.eye(3), 2, axis=0)])
    pairs = ss.ContactPairs(operator, 1.0, 0.8, 0.5, preload=[0.8 - 1e-9, 1.2, 0.3])
    motion = np.zeros((SAMPLES, 3, 3))
    motion[:, :, 0] = 0.5 * np.cos(PHASE)[:, None]
    motion[:, 1, 1] = 0.3 * np.cos(PHASE)
    motion[:, 1, 2] = -0.7 * np.cos(PHASE)
    steps = linear_steps(pairs, motion)
    stuck = stuck_structure(ss.Superelement(MASS, STIFFNESS, 0.03 * STIFFNESS), pairs, OMEGA, None)
    model = stability_model(stuck, 3, np.ones((3, 3), dtype=bool), np.zeros((3, 3)))
    moving, sticks, touching = np.arange(3), np.array([True, True, False]), np.array([True, True, False])
    together = Disturbances(model, steps, moving, sticks, touching, OMEGA)
    assert set(together.limits.pair) == {0, 1}
    marches = []
    for follow in itertools.product((False, True), repeat=together.n_touches):
        chosen = together.limits.changed(steps, model.springs, np.array(follow))
        marches.append(Disturbances(model, chosen, moving, sticks, ~np.ones(3, dtype=bool), OMEGA))
    return together, marches


@pytest.mark.parametrize("dense_size", [0, 64])
def test_one_march_has_the_multipliers_of_all_choices(dense_size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disturbances, "DENSE_SIZE", dense_size)
    together, marches = touching_pairs()
    assert 2 <= together.n_touches <= 6
    sizes = set()
    for follow, march in zip(itertools.product((False, True), repeat=together.n_touches), marches, strict=True):
        values = together.modes(np.array(follow)).values
        expected = march.modes(np.zeros(0, dtype=bool)).values
        large = np.abs(expected) > 0.5
        assert large.any()
        np.testing.assert_allclose(np.abs(values[: large.sum()]), np.abs(expected[large]), rtol=1e-6)
        sizes.add(round(float(np.abs(values[0])), 6))
    assert len(sizes) > 2  # a slider that follows matters
