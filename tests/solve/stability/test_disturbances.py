"""Disturbances of a motion whose pairs touch their limits: each choice of touches from one march."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

import stickslip as ss
from law_makers import jenkins
from stickslip.solve.harmonic.compliance import stuck_structure
from stickslip.solve.stability import disturbances
from stickslip.solve.stability.contact_steps import linear_steps
from stickslip.solve.stability.disturbances import Disturbances
from stickslip.solve.stability.model import stability_model

SAMPLES, OMEGA = 64, 1.1
PHASE = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
MASS, STIFFNESS = np.diag([1.0, 0.6, 1.4]), np.diag([3.0, 2.5, 2.0])


OPERATOR = np.vstack([np.eye(3), np.roll(np.eye(3), 1, axis=0), np.roll(np.eye(3), 2, axis=0)])


def coulomb_pairs() -> tuple[ss.ContactPairs, np.ndarray]:
    """The first pair touches both limits, the second one in an oblique direction, and the third slips."""
    pairs = ss.ContactPairs(OPERATOR, 1.0, 0.8, 0.5, preload=[0.8 - 1e-9, 1.2, 0.3])
    motion = np.zeros((SAMPLES, 3, 3))
    motion[:, :, 0] = 0.5 * np.cos(PHASE)[:, None]
    motion[:, 1, 1] = 0.3 * np.cos(PHASE)
    motion[:, 1, 2] = -0.7 * np.cos(PHASE)
    return pairs, motion


def jenkins_pairs() -> tuple[ss.ContactPairs, np.ndarray]:
    """The first pair touches both limits of both sliders in the same samples, the others slip."""
    limits = np.array([[0.4 - 1e-10, 0.24 - 1e-10], [0.2, 0.2], [0.3, 0.3]])
    pairs = ss.ContactPairs.with_laws(OPERATOR, [jenkins(np.full((3, 2), 0.8), limits, np.ones(3))])
    motion = np.zeros((SAMPLES, 3, 3))
    motion[:, :, 0] = 0.5 * np.cos(PHASE)[:, None]
    motion[:, 0, 1] = 0.3 * np.cos(PHASE)
    return pairs, motion


def marches(
    pairs: ss.ContactPairs, motion: np.ndarray, touching: np.ndarray
) -> tuple[Disturbances, list[Disturbances]]:
    """The march of all choices of touches, and those with the steps of each choice."""
    steps = linear_steps(pairs, motion)
    stuck = stuck_structure(ss.Superelement(MASS, STIFFNESS, 0.03 * STIFFNESS), pairs, OMEGA, None)
    model = stability_model(stuck, 3, np.ones((3, 3), dtype=bool), np.zeros((3, 3)))
    moving = np.arange(3)
    together = Disturbances(model, steps, moving, touching, touching, OMEGA)
    assert set(together.limits.pair) == set(np.flatnonzero(touching))
    single = []
    for follow in itertools.product((False, True), repeat=together.n_touches):
        chosen = together.limits.changed(steps, model.springs, np.array(follow))
        single.append(Disturbances(model, chosen, moving, touching, ~np.ones(3, dtype=bool), OMEGA))
    return together, single


@pytest.mark.parametrize(
    ("make", "touching", "touches"),
    [(coulomb_pairs, [True, True, False], 3), (jenkins_pairs, [True, False, False], 4)],
)
@pytest.mark.parametrize("dense_size", [0, 64])
def test_one_march_has_the_multipliers_of_all_choices(
    dense_size: int,
    make: Callable[[], tuple[ss.ContactPairs, np.ndarray]],
    touching: list[bool],
    touches: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(disturbances, "DENSE_SIZE", dense_size)
    together, single = marches(*make(), np.array(touching))
    assert together.n_touches == touches
    sizes = set()
    for follow, march in zip(itertools.product((False, True), repeat=touches), single, strict=True):
        values = together.modes(np.array(follow)).values
        expected = march.modes(np.zeros(0, dtype=bool)).values
        large = np.abs(expected) > 0.5
        assert large.any()
        np.testing.assert_allclose(np.abs(values[: large.sum()]), np.abs(expected[large]), rtol=1e-6)
        sizes.add(round(float(np.abs(values[large.sum() - 1])), 6))
    assert len(sizes) > 2  # a slider that follows matters


def test_the_law_exceeds_the_limits_that_the_changes_say() -> None:
    """The disturbances of pairs that stick, added to the motion: where the law exceeds the limit, the change is in the
    sense of a slider that follows."""
    pairs, motion = coulomb_pairs()
    together, _ = marches(pairs, motion, np.array([True, True, False]))
    limits, force = together.limits, pairs.cycle(motion).force
    sense = limits.sense(force[:, :, :2])
    random = np.random.default_rng(5)
    seen = set()
    for _ in range(20):
        constant = random.normal(size=(3, 3))
        change = np.einsum("ta,ta->t", limits.by_end + limits.by_start, constant[limits.pair]) * sense
        stuck = force[limits.step % SAMPLES, limits.pair, :2] + 1e-6 * 0.8 * constant[limits.pair, :2]
        normal = force[limits.step % SAMPLES, limits.pair, 2] + 1e-6 * constant[limits.pair, 2]
        beyond = np.linalg.norm(stuck, axis=1) - 0.5 * normal
        clear = np.abs(change) > 0.02
        np.testing.assert_array_equal((change > 0.0)[clear], (beyond > 0.0)[clear])
        seen |= set(beyond > 0.0)
    assert seen == {True, False}
