"""Periodic motions that are not on the curve of a response: isolated curves, unsymmetric motions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.results.side_curves import SideCurves
from stickslip.results.variables import Count, Flags, stored


@dataclass(frozen=True, eq=False)
class OtherSolutions(SideCurves):
    """The result of a search for other solutions: its starts, and the curves beside the computed one.

    No curve proves nothing: a motion that few starts lead to can be missed.

    Parameters
    ----------
    names, complete, curve, frequency_hz, displacement:
        as in :class:`SideCurves`; a curve is complete if it is closed, or reaches both ends of the frequency range.
    closed:
        (n_curves,) whether the curve is closed: isolated, unless it crosses the computed one where motions branch off.
    stable_points:
        (n_side_points,) whether small disturbances decay, by Floquet multipliers; for contact laws without them, by the
        folds of the curve.
    random_starts, random_motions, seed:
        numbers of random states from which time integration started, and of random motions from which Newton's method
        did, and the seed that they follow from.
    without_solution:
        random starts that led to no periodic motion with the period of the excitation.
    changes:
        places of the curve where contact changes its state, from whose other side Newton's method started.
    doubtful_points:
        (n_side_points,) whether the verdict ``stable_points`` is doubtful, as ``ForcedResponse.doubtful``; None without
        multipliers.
    """

    DATASET_TITLE: ClassVar[str] = "Periodic motions that are not on the curve"

    closed: NDArray[np.bool_] = field(metadata=stored(Flags(("side_curve",), "1", "1 if the curve is closed")))
    stable_points: NDArray[np.bool_] = field(
        metadata=stored(Flags(("side_point",), "1", "1 if small disturbances decay", name="stable"))
    )
    random_starts: int = field(metadata=stored(Count("random states from which time integration started")))
    random_motions: int = field(metadata=stored(Count("random motions from which Newton's method started")))
    seed: int = field(metadata=stored(Count("seed of the random states")))
    without_solution: int = field(metadata=stored(Count("random starts without a periodic motion")))
    changes: int = field(metadata=stored(Count("changes of contact states from whose other side Newton started")))
    doubtful_points: NDArray[np.bool_] | None = field(
        default=None,
        metadata=stored(
            Flags(("side_point",), "1", "1 if the verdict on stability is doubtful", name="doubtful", optional=True)
        ),
    )

    def _stable(self, part: NDArray[np.int64]) -> NDArray[np.bool_]:
        return self.stable_points[part]

    def __repr__(self) -> str:
        return f"OtherSolutions({self.words()})"

    def words(self) -> str:
        """The extent and the result of the search, in one sentence."""
        starts = (
            f"time integration from {self.random_starts} random states and Newton's method from {self.random_motions} "
            f"random motions (seed {self.seed}) and {self.changes} changes of contact states"
        )
        lost = (
            f"; {self.without_solution} random states led to no periodic motion with the period of the excitation"
            if self.without_solution
            else ""
        )
        if not self.n_curves:
            return f"{starts} found no periodic motion off the curve, which proves nothing{lost}"
        noun = "curve" if self.n_curves == 1 else "curves"
        return f"{starts} found {self.n_curves} further {noun}: {', '.join(self._about())}{lost}"

    def _about(self) -> list[str]:
        """Each curve in words."""
        answer = []
        for number, name in enumerate(self.names):
            part = self.of(number)
            hertz = self.frequency_hz[part]
            early = "" if self.complete[number] else ", not complete"
            stable = "with stable parts" if self.stable_points[part].any() else "unstable throughout"
            stable += self._doubts(part)
            answer.append(f"{name} from {hertz.min():.2f} to {hertz.max():.2f} Hz ({stable}{early})")
        return answer

    def _doubts(self, part: NDArray[np.int64]) -> str:
        """The number of doubtful verdicts of a curve in words, if there are any."""
        doubtful = 0 if self.doubtful_points is None else int(self.doubtful_points[part].sum())
        return f", stability doubtful at {doubtful} of {part.size} points" if doubtful else ""
