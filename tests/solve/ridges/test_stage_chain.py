"""Chains of equations side by side: their work, their digits, and intervals that are divided at the same time."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from helpers import Blade
from sentences import printed_sentence
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.ridges.ridge_intervals import AT_ONCE, NEIGHBOURS, Interval, apart
from stickslip.solve.ridges.ridge_stage import RidgeOptions, RidgeStage, Work, WorkStoppedError
from stickslip.solve.ridges.stage_chain import StageChain
from stickslip.solve.setting_up import StageReport

BLADE = Blade()


def made(value: float, earlier: RidgeStage | None) -> RidgeStage:
    force = ss.Excitation.force(value * BLADE.force_cos, value * BLADE.force_sin)
    options = RidgeOptions(BLADE.window_hz, harmonics=1, samples=32)
    problem = BLADE.superelement, BLADE.pairs, force
    return RidgeStage.of(problem, BLADE.tip, options, None, StageReport(None), earlier)


def test_a_chain_apart_has_its_own_factor_and_work_and_the_modes_of_the_other() -> None:
    heard: list[float] = []
    chain = StageChain(made, Work(100.0), lambda value, stage: heard.append(value))
    first = chain(1.0)
    assert chain(1.0) is first
    first.work.evaluate()
    other = chain.apart()
    stage = other(2.0)
    assert heard == [1.0, 2.0]
    assert stage.balances.stuck.modes is first.balances.stuck.modes
    assert stage.last is not first.last
    assert other(3.0).last is stage.last
    assert stage.work is other.work is not chain.work
    assert other.work.most == 100.0 - chain.work.done


def test_work_apart_is_counted_together_and_stops_together() -> None:
    work = Work(10.0)
    work.evaluate()
    tasks = [work.rest(), work.rest()]
    for task in tasks:
        assert task.most == 9.0
        task.evaluate()
        task.see_point()
        work.add(task)
    assert (work.done, work.points) == (3.0, 2)
    work.stop()
    for task in (*tasks, work):
        with pytest.raises(WorkStoppedError):
            task.evaluate()


def test_a_copy_of_a_last_factor_is_independent() -> None:
    last = LastFactor()
    last.store(SimpleNamespace(solve=lambda right: right), np.arange(2))
    copy = last.copy()
    last.forget()
    assert last.inverse(np.arange(2)) is None
    assert copy.inverse(np.arange(2)) is not None


@pytest.mark.parametrize("threads", [2, 3])
def test_a_ridge_has_the_same_digits_in_all_threads(threads: int) -> None:
    def ridge(count: int) -> ss.PeakRidge:
        def problem_at(factor: float) -> Any:
            force = ss.Excitation.force(factor * BLADE.force_cos, factor * BLADE.force_sin)
            return BLADE.superelement, BLADE.pairs, force

        return ss.peak_ridge(
            problem_at, (0.5, 2.0), BLADE.tip, frequency_hz=BLADE.window_hz, harmonics=1, samples=64, threads=count
        )

    one, several = ridge(1), ridge(threads)
    for name in ("parameter", "amplitude", "frequency_hz", "slope"):
        assert getattr(one, name).tobytes() == getattr(several, name).tobytes()
    assert one.settings == several.settings


def test_intervals_that_are_divided_at_once_are_large_and_not_close() -> None:
    ridges: list[Any] = [SimpleNamespace(name="first"), SimpleNamespace(name="second")]
    wide = [Interval(ridges[0], place, area) for place, area in enumerate([1.0, 5.0, 4.0, 3.0, 2.0, 9.0])]
    chosen = apart([*wide, Interval(ridges[1], 5, 7.0)])
    assert [(ridges.index(each.ridge), each.place) for each in chosen] == [(0, 5), (1, 5), (0, 1)]
    assert len(apart(Interval(ridges[0], (NEIGHBOURS + 1) * place, 1.0) for place in range(9))) == AT_ONCE


def test_a_whole_curve_ends_where_the_work_does() -> None:
    """A light damper that bounces would take as long as many curves."""
    stage = made(1.0, None)
    whole = stage.counted(Work()).whole_curve()
    assert whole.complete
    work = Work(20.0)
    part = stage.counted(work).whole_curve()
    assert not part.complete
    printed_sentence(part.message, "20 evaluations", numbers=False)
    assert 20.0 <= work.done < 40.0
    assert len(part.points) < len(whole.points)
