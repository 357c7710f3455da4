"""What a time integration tells where a curve is lost: whether the motion settles, to what, and in which words."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from lost_curves import lost_resonance
from stickslip.core.fourier import with_rows
from stickslip.solve import evidence as evidence_module
from stickslip.solve import settled_motion as settled_module
from stickslip.solve.evidence import Evidence, repeats_after


def test_motions_are_told_apart_by_the_starts_of_their_periods() -> None:
    """Also slow beats and decays, of which two successive starts agree."""
    rng, number = np.random.default_rng(1), np.arange(60)
    for along, wanted in (
        (np.zeros(60), 1),
        ((-1.0) ** number, 2),
        (number % 3, 3),
        (number % 9, None),
        (rng.normal(size=60), None),
        (0.1 * np.cos(2.0 * np.pi * 0.004 * number), None),
        (0.1 * 0.99**number, None),
        (0.1 * 0.7**number, 1),
    ):
        assert repeats_after(np.outer(along, [1.0, 1.0]), 1.0) == wanted, along
    assert repeats_after(np.zeros((3, 2)), 1.0) is None


@pytest.mark.long
def test_a_slow_resonance_has_not_settled_though_successive_periods_agree() -> None:
    settling = lost_resonance()
    evidence = settling.evidence_from_rest(2.0 * np.pi * 356.0)
    assert evidence is not None
    assert evidence.change < 1e-3
    assert evidence.repeats_after is None
    found = settling.solution((), 2.0 * np.pi * 341.0, ramp=False)
    assert found is not None
    assert found[1] == "from the linear stuck response"


@pytest.mark.long
def test_only_at_the_end_of_a_curve_shorter_steps_test_a_settled_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    settling, omega = lost_resonance(), 2.0 * np.pi * 341.0
    monkeypatch.setattr(evidence_module, "PERIODS", 1500)  # a slow resonance
    usual = settling.evidence_from_rest(omega)
    assert usual is not None
    assert (usual.repeats_after, usual.steps_change) == (1, None)
    before = settling.work.in_time
    thorough = settling.evidence_from_rest(omega, thorough=True)
    assert thorough is not None
    assert thorough.repeats_after == 1
    assert thorough.steps_change is not None
    assert 1e-5 < thorough.steps_change < 1e-2
    assert settling.work.in_time - before > 4.0 * before
    monkeypatch.setattr(evidence_module, "coulomb_alone", lambda pairs: False)
    slow = settling.evidence_from_rest(omega, thorough=True)
    assert slow is not None
    assert slow.steps_change is None


def test_a_large_system_has_no_longer_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settled_module, "MANY_ROWS", 20)  # 3 harmonics of one pair have 21
    balances = cast(Any, SimpleNamespace(samples=128, pairs=SimpleNamespace(n_pairs=1)))
    numbers = list(settled_module._numbers(balances, 3, 1000, thorough=True))
    assert numbers == [(3, 128, False), (6, 128, False), (12, 128, False), (24, 128, False)]
    monkeypatch.setattr(settled_module, "MANY_ROWS", 3000)
    numbers = list(settled_module._numbers(balances, 3, 1000, thorough=True))
    assert numbers[3:] == [(24, 128, True), (48, 384, True), (96, 768, True)]
    assert [each[0] for each in settled_module._numbers(balances, 3, 30, thorough=True)] == [3, 6, 12, 24]


@pytest.mark.parametrize(("repeats", "words"), [(3, "only after 3 periods"), (None, "has not settled")])
def test_words(repeats: int | None, words: str) -> None:
    assert words in Evidence(100.0, 300, 0.1, 0.5, repeats).words()
    assert evidence_module.LONGEST >= 3


@pytest.mark.long
@pytest.mark.parametrize(("factor", "is_given"), [(1.0, True), (1.5, False)])
def test_a_settled_motion_is_looked_for_with_more_harmonics(factor: float, is_given: bool) -> None:
    """A solution that Newton's method finds elsewhere does not count."""
    settling, omega = lost_resonance(), 2.0 * np.pi * 341.0
    found = settling.solution((), omega, ramp=False)
    assert found is not None
    unknowns = lambda motion, harmonics: factor * with_rows(found[0].unknowns, 2 * harmonics + 1)  # noqa: E731
    settling._in_time = cast(Any, SimpleNamespace(unknowns=unknowns))
    own, motion = settling._harmonics, cast(Any, SimpleNamespace(displacement=np.zeros((257, 3))))
    for thorough, most in ((False, 8), (True, 32)):
        settled = settling._with_harmonics(motion, omega, thorough)
        assert settled.tried == (own if is_given else most * own)
        assert settled.given_by == (own if is_given else None)
        assert settled.neglected == 0.0
