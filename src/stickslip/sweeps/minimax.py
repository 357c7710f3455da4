"""Minimisation of the largest of several functions under constraints, from several starts at a time.

``min over z of max over i of f_i(z)``, ``c_j(z) >= 0``, ``0 <= z <= 1``, is solved as ``min t``, ``t >= f_i(z)``: each
function is smooth where the largest of them has a corner (D. P. Bertsekas, Nonlinear Programming, 1999, section 5.4).
Sequential quadratic programming (SLSQP: D. Kraft, DFVLR-FB 88-28, 1988; of scipy) solves it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any

import numpy as np
import scipy.optimize

from stickslip.core.validation import FloatArray

TOLERANCE = 3e-5  # of the logarithms that a design minimises: 0.003 %
MOST_ITERATIONS = 40  # chosen: of one descent; each is a frequency curve with its gradients
# A descent whose line search fails, at a corner or a jump, begins again from its best point, as often as it improves by
# WORTHWHILE, at most so often.
MOST_RESTARTS, WORTHWHILE = 3, 1e-3
_PENALTY = 3.0  # of a logarithm: a factor of 20


@dataclass(frozen=True)
class Functions:
    """Values of functions (m,) and constraints (k,) at a point."""

    functions: FloatArray
    constraints: FloatArray

    @property
    def merit(self) -> tuple[float, float]:
        """Smaller is better: violation of the constraints, then the largest function."""
        excess = max(0.0, -float(self.constraints.min(initial=0.0)))
        return excess, float(self.functions.max())


# What a descent asks for: values, or None at a point without; and their derivatives (m, n), (k, n).
AskValues = Callable[[FloatArray], Functions | None]
AskSlopes = Callable[[FloatArray], Functions]


@dataclass(frozen=True)
class Descent:
    """The end of a descent: best point, and the message of the optimiser."""

    best: FloatArray
    message: str


def descend(start: FloatArray, values: AskValues, slopes: AskSlopes) -> Descent:
    """A local minimum from ``start`` (n,), which has values."""
    path = _Path(start, values, slopes)
    message = ""
    for _ in range(1 + MOST_RESTARTS):
        before = path.best_merit
        message = path.minimise()
        gain = max(before[0] - path.best_merit[0], before[1] - path.best_merit[1])
        if message == "" or gain < WORTHWHILE:
            break
    return Descent(path.best, message or "converged")


class _Path:
    """The points of a descent; remembers the best one."""

    def __init__(self, start: FloatArray, values: AskValues, slopes: AskSlopes) -> None:
        self._ask, self._ask_slopes = values, slopes
        self.best = np.asarray(start, dtype=float)
        first = values(self.best)
        assert first is not None  # see descend
        self._good = first
        self.best_merit = first.merit

    def minimise(self) -> str:
        """One run of the optimiser from the best point; "" if it converged, else the reason of its end."""
        size, top = self.best.size, self._values(self.best).functions.max()
        solution = scipy.optimize.minimize(
            lambda y: y[-1],
            np.append(self.best, top),
            jac=lambda y: np.append(np.zeros(size), 1.0),
            method="SLSQP",
            bounds=[(0.0, 1.0)] * size + [(None, None)],
            constraints={"type": "ineq", "fun": self._constraints, "jac": self._jacobian},
            options={"ftol": TOLERANCE, "maxiter": MOST_ITERATIONS},
        )
        return "" if solution.success else str(solution.message).rstrip(".")

    def _constraints(self, unknowns: FloatArray) -> FloatArray:
        at = self._values(_inside(unknowns))
        return np.concatenate([unknowns[-1] - at.functions, at.constraints])

    def _jacobian(self, unknowns: FloatArray) -> FloatArray:
        slopes = self._ask_slopes(_inside(unknowns))
        count = slopes.functions.shape[0]
        by_top = np.append(np.ones(count), np.zeros(slopes.constraints.shape[0]))
        by_point = np.vstack([-slopes.functions, slopes.constraints])
        return np.column_stack([by_point, by_top])

    def _values(self, point: FloatArray) -> Functions:
        """Values at a point; far worse ones than the last where there are none, so that a step is shortened."""
        answer = self._ask(point)
        if answer is None:
            return Functions(self._good.functions + _PENALTY, self._good.constraints)
        self._good = answer
        if answer.merit < self.best_merit:
            self.best, self.best_merit = point, answer.merit
        return answer


def _inside(unknowns: FloatArray) -> FloatArray:
    return np.clip(unknowns[:-1], 0.0, 1.0)


@dataclass(frozen=True)
class _Ended:
    result: Any = None
    error: BaseException | None = None


class _StoppedError(Exception):
    """The requests of the others could not be answered."""


def in_step(
    tasks: Sequence[Callable[[Callable[[Any], Any]], Any]], answer: Callable[[list[Any]], list[Any]]
) -> list[Any]:
    """Run tasks that ask for values, each in its own thread; the requests of all of them are answered together.

    ``tasks`` receive a function ``ask(request)``; ``answer(requests)`` runs in this thread, in the order of the tasks,
    so that the result does not depend on the threads. Returns the results of the tasks; raises what ``answer`` or the
    first task raises.
    """
    posts: SimpleQueue[tuple[int, Any]] = SimpleQueue()
    replies: list[SimpleQueue[Any]] = [SimpleQueue() for _ in tasks]
    ended: dict[int, _Ended] = {}

    def run(number: int) -> None:
        def ask(request: Any) -> Any:
            posts.put((number, request))
            reply = replies[number].get()
            if isinstance(reply, _StoppedError):
                raise reply
            return reply

        try:
            posts.put((number, _Ended(tasks[number](ask))))
        except BaseException as error:
            posts.put((number, _Ended(error=error)))

    waiting: dict[int, Any] = {}
    with ThreadPoolExecutor(max(1, len(tasks))) as threads:
        for number in range(len(tasks)):
            threads.submit(run, number)
        try:
            while len(ended) < len(tasks):
                while len(waiting) + len(ended) < len(tasks):
                    number, post = posts.get()
                    (ended if isinstance(post, _Ended) else waiting)[number] = post
                order = sorted(waiting)
                for number, reply in zip(order, answer([waiting.pop(number) for number in order]), strict=True):
                    replies[number].put(reply)
        except BaseException:
            for reply_queue in replies:
                reply_queue.put(_StoppedError())
            raise
    for number in range(len(tasks)):
        error = ended[number].error
        if error is not None:
            raise error
    return [ended[number].result for number in range(len(tasks))]
