"""Where a branch has been, and which of its points the last step may have come back to.

A curve of solutions does not meet itself. But friction that keeps tractions has closed curves of other solutions close
beside it, and corners finer than a step: a step that is a little too long can come down on such a loop, which is then
followed for ever, or turn round and follow its own branch back to the start.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stickslip.solve.harmonic.balance import Trial

# A chord passes an earlier point of the same curve within this share of its length: an arc that turns by 45 degrees
# rises by 0.1 of its chord.
NEAR = 0.2
# The last points are neighbours of any new one.
NEIGHBOURS = 3


class Visited:
    """The points of a branch in their order, with what finds those near the last chord quickly."""

    def __init__(self) -> None:
        self.trials: list[Trial] = []
        self._sizes: list[float] = []

    def add(self, trial: Trial) -> None:
        """Append a point."""
        self.trials.append(trial)
        self._sizes.append(float(np.linalg.norm(trial.amplitude)))

    def keep(self, count: int) -> None:
        """Forget all but the first ``count`` points."""
        del self.trials[count:], self._sizes[count:]

    def near_last_chord(self, u_scale: float, w_scale: float) -> Iterator[tuple[int, float]]:
        """Earlier points that the last chord passes, the oldest first: their index, and the share of the chord there.

        Distances are measured in ``(amplitude / u_scale, omega / w_scale)``. Near is only a suspicion: different
        curves may run side by side.
        """
        last = len(self.trials) - 1
        if last < NEIGHBOURS + 1:
            return
        before, after = self.trials[-2], self.trials[-1]
        chord = (after.amplitude - before.amplitude) / u_scale
        rise = (after.omega - before.omega) / w_scale
        square = float((chord**2).sum()) + rise**2
        reach = (1.0 + NEAR) * square**0.5
        size = self._sizes[last - 1]
        for index in range(last - NEIGHBOURS):
            earlier = self.trials[index]
            lift = (earlier.omega - before.omega) / w_scale
            if abs(lift) > reach or abs(self._sizes[index] - size) > reach * u_scale:
                continue
            gap = (earlier.amplitude - before.amplitude) / u_scale
            share = (float((gap * chord).sum()) + lift * rise) / square
            away = float(((gap - share * chord) ** 2).sum()) + (lift - share * rise) ** 2
            if 0.0 <= share <= 1.0 and away <= NEAR**2 * square:
                yield index, share
