"""The minimax optimiser against closed forms: valleys, corners, bounds, constraints, and points without a value."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np
import pytest

from stickslip.core.validation import FloatArray
from stickslip.sweeps.minimax import Descent, Functions, descend, in_step

Pair = Callable[[FloatArray], tuple[list[float], list[list[float]]]]


def solved(functions: Pair, constraints: Pair, start: list[float]) -> Descent:
    def values(z: FloatArray) -> Functions:
        return Functions(np.array(functions(z)[0]), np.array(constraints(z)[0]))

    def slopes(z: FloatArray) -> Functions:
        return Functions(*(np.array(each(z)[1]).reshape(-1, z.size) for each in (functions, constraints)))

    return descend(np.array(start), values, slopes)


def no_constraint(z: FloatArray) -> tuple[list[float], list[list[float]]]:
    return [], []


def parabola(z: FloatArray) -> tuple[list[float], list[list[float]]]:
    return [float((z - [0.3, 0.6]) @ (z - [0.3, 0.6]))], [(2.0 * (z - [0.3, 0.6])).tolist()]


def corner(z: FloatArray) -> tuple[list[float], list[list[float]]]:
    """The larger of 2 x and 1 - x, both with a valley along y: a corner at x = 1/3."""
    valley = (z[1] - 0.5) ** 2
    return [2.0 * z[0] + valley, 1.0 - z[0] + valley], [[2.0, 2.0 * z[1] - 1.0], [-1.0, 2.0 * z[1] - 1.0]]


def above(z: FloatArray) -> tuple[list[float], list[list[float]]]:
    """x + y of at least 1.2."""
    return [z[0] + z[1] - 1.2], [[1.0, 1.0]]


@pytest.mark.parametrize(
    ("functions", "constraints", "expected"),
    [
        (parabola, no_constraint, [0.3, 0.6]),
        (corner, no_constraint, [1.0 / 3.0, 0.5]),
        (parabola, above, [0.45, 0.75]),
        (lambda z: ([-z[0] + (z[1] - 0.2) ** 2], [[-1.0, 2.0 * (z[1] - 0.2)]]), no_constraint, [1.0, 0.2]),
    ],
)
def test_the_minimum_is_that_of_the_closed_form(functions: Pair, constraints: Pair, expected: list[float]) -> None:
    found = solved(functions, constraints, [0.9, 0.1])
    assert found.message == "converged"
    np.testing.assert_allclose(found.best, expected, atol=5e-3)


def test_a_point_without_a_value_shortens_the_step() -> None:
    """Right of 0.7 there is no value; the minimum of -x is approached from the left."""
    seen = []

    def values(z: FloatArray) -> Functions | None:
        seen.append(float(z[0]))
        return None if z[0] > 0.7 else Functions(-z, np.empty(0))

    found = descend(np.array([0.1]), values, lambda z: Functions(np.array([[-1.0]]), np.empty((0, 1))))
    assert max(seen) > 0.7
    assert 0.69 < found.best[0] <= 0.7


def test_requests_of_all_tasks_are_answered_together_in_their_order() -> None:
    batches = []

    def task(number: int) -> Callable[[Callable[[object], object]], list[object]]:
        return lambda ask: [ask((number, step)) for step in range(number)]

    def answer(requests: list[object]) -> list[object]:
        assert threading.current_thread() is threading.main_thread()
        batches.append(list(requests))
        return [("answer", each) for each in requests]

    found = in_step([task(number) for number in (1, 3, 2)], answer)
    assert found[1] == [("answer", (3, step)) for step in range(3)]
    assert batches[:3] == [[(1, 0), (3, 0), (2, 0)], [(3, 1), (2, 1)], [(3, 2)]]


def test_an_error_of_the_answer_ends_all_tasks() -> None:
    def answer(requests: list[object]) -> list[object]:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        in_step([lambda ask: ask(1), lambda ask: ask(2)], answer)


def test_an_error_of_a_task_is_raised() -> None:
    def fails(ask: object) -> None:
        raise ArithmeticError

    with pytest.raises(ArithmeticError):
        in_step([lambda ask: ask(1), fails], lambda requests: list(requests))
