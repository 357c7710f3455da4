"""Measured hysteresis loops: force against displacement in the order of time, divided into complete cycles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, finite_array

FEWEST_SAMPLES = 20  # chosen: of a cycle; two reversals with an elastic part and two parts of sliding
# chosen: a cycle passes the middle upward after it was below the middle by this fraction of the largest amplitude.
# Noise does not do this.
TURN_FRACTION = 0.25
# chosen: a loop that encloses less of its rectangle slides less than the reversals of a measurement can show.
LEAST_AREA = 0.02
FORCE_PERCENTILES = (10.0, 90.0)  # chosen: both are forces of sliding, without the peaks of noise


@dataclass(frozen=True)
class Loops:
    """Complete cycles of a measurement, from one upward passage of the middle to the last.

    ``displacement`` and ``force`` (n,) m and N; ``starts`` (n_cycles + 1,) first sample of each cycle, and n.
    """

    displacement: FloatArray
    force: FloatArray
    starts: tuple[int, ...]

    @classmethod
    def of(cls, displacement: ArrayLike, force: ArrayLike) -> Loops:
        """Raises InputError for arrays that are not closed loops."""
        path, along = finite_array("displacement", displacement), finite_array("force", force)
        if path.ndim != 1 or path.shape != along.shape:
            raise InputError(
                f"displacement has shape {path.shape} and force {along.shape}. Both must be lists of one length, in "
                "the order of time.",
                arguments=["displacement", "force"],
            )
        if path.size < FEWEST_SAMPLES:
            raise InputError(
                f"the loops have {path.size} samples; a cycle requires at least {FEWEST_SAMPLES}.",
                arguments=["displacement"],
            )
        starts = _passages(path)
        if len(starts) < 2:
            raise InputError(
                "the displacement closes no cycle: it must pass its middle upward at least twice. Give complete "
                "cycles in the order of time.",
                arguments=["displacement"],
            )
        fewest = min(after - before for before, after in pairwise(starts))
        if fewest < FEWEST_SAMPLES:
            raise InputError(
                f"a cycle has {fewest} samples; it requires at least {FEWEST_SAMPLES}. Sample faster, or remove "
                "noise from the displacement.",
                arguments=["displacement"],
            )
        first, last = starts[0], starts[-1]
        loops = cls(path[first:last], along[first:last], tuple(start - first for start in starts))
        loops._require_friction()
        return loops

    @property
    def count(self) -> int:
        """Number of cycles."""
        return len(self.starts) - 1

    @property
    def settled(self) -> FloatArray:
        """Path that begins with a copy of its first cycle, in which a slider settles."""
        return np.concatenate([self.displacement[: self.starts[1]], self.displacement])

    @property
    def kept(self) -> slice:
        """The measurement within :attr:`settled`."""
        return slice(self.starts[1], None)

    def amplitudes(self) -> FloatArray:
        """(n_cycles,) m, half of the range of displacement."""
        return np.array([0.5 * np.ptp(self.displacement[a:b]) for a, b in pairwise(self.starts)])

    def energies(self, force: FloatArray) -> FloatArray:
        """(n_cycles,) J: area of the loop of each cycle, closed from its last sample to its first."""
        return np.array([_area(self.displacement[a:b], force[a:b]) for a, b in pairwise(self.starts)])

    def _require_friction(self) -> None:
        """Raise InputError unless the loops enclose an area like that of friction."""
        level, reach = np.ptp(np.percentile(self.force, FORCE_PERCENTILES)), np.ptp(self.displacement)
        if not level > 0.0:
            raise InputError(
                "the force is constant over most of the loops, so it is not friction.", arguments=["force"]
            )
        energy = float(self.energies(self.force).mean())
        if energy < -LEAST_AREA * level * reach:
            raise InputError(
                f"the force gives {-energy:.3g} J to the motion in each cycle, but friction dissipates. Change the "
                "sign of the force or of the displacement.",
                arguments=["force"],
            )
        if energy < LEAST_AREA * level * reach:
            raise InputError(
                f"the loops enclose {100.0 * energy / (level * reach):.2g} % of the rectangle of force and "
                "displacement, so they do not show sliding and its limit. Measure with a larger amplitude of the "
                "displacement or a lower normal load.",
                arguments=["displacement"],
            )


def _passages(path: FloatArray) -> list[int]:
    """Samples after which the path has passed the middle of its range upward."""
    low, high = float(path.min()), float(path.max())
    middle, margin = 0.5 * (low + high), TURN_FRACTION * 0.5 * (high - low)
    sign = np.where(path < middle - margin, -1, np.where(path > middle + margin, 1, 0))
    marked = np.flatnonzero(sign)
    rises = [(int(a), int(b)) for a, b in pairwise(marked) if sign[a] < 0 < sign[b]]
    return [a + 1 + int(np.argmax(path[a + 1 : b + 1] >= middle)) for a, b in rises]


def _area(along: FloatArray, force: FloatArray) -> float:
    """Integral of the force along a closed loop."""
    step = np.roll(along, -1) - along
    return float(0.5 * (force + np.roll(force, -1)) @ step)
