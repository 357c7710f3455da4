"""Bodies that friction alone supports and that slide on from cycle to cycle.

The mean displacement of a joint that retains its tractions is the way of many cycles (docs/theory_friction.md), so that
of a body that walks says nothing of a place. What belongs to the motion is the way of one cycle.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb_period import CYCLES
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.linear import LinearLimit
from stickslip.solve.harmonic.unbounded import sliding_shapes

# chosen: way of a body in one cycle, over the largest motion of a pair, above which it walks: the mean displacement of
# pairs that stick is no larger than their motion, and counts as a millionth of it.
LARGEST_WALK = 1e-5


def walking_points(pairs: ContactPairs, trials: Sequence[Trial]) -> tuple[NDArray[np.int64], FloatArray]:
    """The points at which a body walks, and the largest way (n_points,) of a pair in one cycle, m."""
    ways = np.linalg.norm(pairs.walk(np.array([trial.relative[0] for trial in trials])), axis=2).max(axis=1)
    motions = np.array([np.abs(trial.relative[1:]).max() for trial in trials])
    return np.flatnonzero(ways > LARGEST_WALK * motions), ways


def without_walk(
    mass: FloatArray, free: LinearLimit, pairs: ContactPairs, trials: Sequence[Trial], displacement: FloatArray
) -> tuple[FloatArray, FloatArray | None]:
    """Coefficients (n_points, 2H+1, n) without the way of bodies that walk, and (n_points, n) m that the unknowns go on
    in one cycle; None if no body walks.

    ``free`` is the structure without contact, ``mass`` (n, n) its mass.
    """
    points, _ = walking_points(pairs, trials)
    if not points.size:
        return displacement, None
    shapes = sliding_shapes(free, pairs)
    way = np.zeros((len(trials), displacement.shape[2]))
    way[points] = (displacement[points, 0] @ mass @ shapes) @ shapes.T
    motion = displacement.copy()
    motion[:, 0] -= way
    return motion, way / CYCLES


def mean_without_walk(
    mass: FloatArray, free: LinearLimit, pairs: ContactPairs, trial: Trial, output: FloatArray
) -> FloatArray:
    """(n,) the row whose product with the mean of ``displacement`` is that of ``output`` without the way of a walk."""
    if not walking_points(pairs, [trial])[0].size:
        return output
    shapes = sliding_shapes(free, pairs)
    return np.asarray(output - mass @ shapes @ (shapes.T @ output))


def walk_warnings(pairs: ContactPairs, trials: Sequence[Trial]) -> tuple[str, ...]:
    """A warning where a body slides on from cycle to cycle, so that the motion is periodic but for this way."""
    points, ways = walking_points(pairs, trials)
    if not points.size:
        return ()
    hertz = np.array([trials[point].omega for point in points]) / (2.0 * np.pi)
    most = int(points[ways[points].argmax()])
    often = trials[most].omega / (2.0 * np.pi)
    return (
        f"A body that only friction supports does not remain in its position: at {points.size} of {len(trials)} "
        f"points, {hertz.min():.2f} to {hertz.max():.2f} Hz, it slides on by up to {1e6 * ways[most]:.3g} um in each "
        f"cycle (at {often:.2f} Hz: {1e6 * ways[most] * often:.3g} um in a second). No periodic motion exists there; "
        "the curve shows the motion of the body that walks on faces without end. Constrain it along its free "
        "direction, press it harder, or lower the force.",
    )
