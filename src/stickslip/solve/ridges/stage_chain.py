"""The equations of a ridge at one value after the other, with what they share; chains may go on side by side."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from stickslip.solve.ridges.ridge_stage import RidgeStage, StageMaker, Work

# Hears the equations at a new value.
Listener = Callable[[float, RidgeStage], None]


class StageChain:
    """The equations at values of the parameter: each has the modes and the last factor of those before.

    A chain, with its count of the ``work``, belongs to one thread at a time. Its digits depend on the values that it
    has had, so that tasks with a chain of their own (:meth:`apart`) have the same digits in any number of threads.
    """

    def __init__(self, make: StageMaker, work: Work, listener: Listener, earlier: RidgeStage | None = None) -> None:
        self._make, self._listener, self._earlier = make, listener, earlier
        self.work = work
        self._at = lru_cache(maxsize=2)(self._made)

    def __call__(self, value: float) -> RidgeStage:
        """The equations at a value. Raises StickslipError where they do not exist."""
        return self._at(value)

    def _made(self, value: float) -> RidgeStage:
        stage = self._make(value, self._earlier).counted(self.work)
        self.work.prepare(stage, self._earlier)
        self._earlier = stage
        self._listener(value, stage)
        return stage

    def apart(self) -> StageChain:
        """A chain that goes on from here for itself, with the work that is left."""
        work, earlier = self.work.rest(), self._earlier
        return StageChain(self._make, work, self._listener, None if earlier is None else earlier.apart(work))
