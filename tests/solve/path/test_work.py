"""Branches that share their work end at its limit."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from plane_curves import PlaneCurve, PlanePoint, PlaneSystem, s_curve

from sentences import printed_sentence
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.path.stepping import ContinuationSettings
from stickslip.solve.path.work import Work


@dataclass(frozen=True)
class CountedCurve(PlaneCurve):
    """A curve that counts what it linearises."""

    work: Work = field(default_factory=Work)

    def linearised(self, point: PlanePoint, plane: Plane | None) -> PlaneSystem:
        self.work.iterate(1)
        return super().linearised(point, plane)


def branch(work: Work) -> Branch[PlanePoint]:
    plain = s_curve()
    curve = CountedCurve(plain.function, plain.slopes, work)
    newton = Newton(curve, NewtonSettings())
    answer = Branch(newton, curve.at(-2.0, -6.0), 6.0, ContinuationSettings(), work=work)
    answer.follow()
    return answer


def test_the_work_of_all_branches_has_one_limit() -> None:
    """The first one takes most of it, so that the second ends on its way."""
    free = Work()
    assert branch(free).complete
    assert free.limit_words == ""
    once = free.total
    limited = Work(most=1.5 * once)
    assert branch(limited).complete
    second = branch(limited)
    assert not second.complete
    assert second.lost
    printed_sentence(second.message, "y = ", numbers=False)
    assert 1.5 * once <= limited.total < 1.5 * once + 20  # a step may take a few corrections


def test_an_iteration_counts_by_its_coefficients_and_a_time_integration_beside_it() -> None:
    work = Work(coefficients=7, most=100.0)
    for _ in range(10):
        work.iterate(7)
        work.iterate(21)
    assert work.newton == pytest.approx(40.0)
    work.integrate(59.0)
    assert work.total == pytest.approx(99.0)
    assert work.limit_words == ""
    work.integrate(1.0)
    printed_sentence(work.limit_words, "100 iterations")
    assert repr(work) == "<Work: 100 of 100 iterations>"
    words = work.limit_words
    work.integrate(1.0)
    assert work.limit_words == words  # those of the moment at which it was reached


def test_a_limit_rises_once() -> None:
    work = Work(most=100.0)
    work.iterate(100)
    assert work.limit_words
    work.extend()
    assert not work.limit_words
    work.iterate(100)
    assert "200 iterations" in work.limit_words
    work.extend()
    assert "200 iterations" in work.limit_words
