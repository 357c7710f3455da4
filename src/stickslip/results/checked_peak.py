"""How far peaks of a ridge can be trusted: checks with more harmonics, and points with a large estimated error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.core.validation import FloatArray

# Names in pictures.
DOUBTFUL_PEAKS, CHECKED_MINIMUM = "computed peaks, error above 1 %", "minimum with slip, checked"
DOUBTFUL = (
    0.01  # chosen: ten times the demand on a ridge; pictures show points of a larger estimated error as open ones
)

LARGEST_PAUSE = 8  # chosen: positions of a grid; the error is zero at each point, and eight positions are an interval


def percent_words(error: float) -> str:
    """A relative error in per cent; one of the size of the value itself says no more than that."""
    return f"{100.0 * error:.2g} %" if error < 1.0 else "100 % or more"


class CheckedPeak(NamedTuple):
    """The highest peak at a value of the parameter by a whole curve with more ``harmonics``.

    ``amplitude`` in m; ``error`` is the estimated relative one by the harmonics that it still neglects, with that of
    lower peaks which could be as high.
    """

    parameter: float
    amplitude: float
    frequency_hz: float
    error: float
    harmonics: int

    def words(self, at: str, of_ridge: float) -> str:
        """A sentence; ``at`` is the parameter in words, ``of_ridge`` the amplitude in m that the ridge has there."""
        return (
            f"Checked with {self.harmonics} harmonics by a whole curve at {at}: {1e6 * self.amplitude:.4g} µm at "
            f"{self.frequency_hz:.2f} Hz, estimated error {percent_words(self.error)}; the ridge has "
            f"{1e6 * of_ridge:.4g} µm."
        )


def is_doubtful(error: FloatArray | None, count: int) -> NDArray[np.bool_]:
    """(count,) whether the estimated error of a point is above ``DOUBTFUL``; of points without estimates none."""
    return np.zeros(count, dtype=bool) if error is None else np.asarray(error > DOUBTFUL)


def doubtful_words(parameter: FloatArray, error: FloatArray | None, named: Callable[[float], str]) -> Iterator[str]:
    """A sentence on doubtful points; ``named`` is a value of the parameter in words."""
    if error is None or not (doubtful := error > DOUBTFUL).any():
        return
    there, worst = parameter[doubtful], int(np.argmax(error))
    yield (
        f"By neglected harmonics, {int(doubtful.sum())} of {error.size} peaks have an estimated error above "
        f"{100.0 * DOUBTFUL:g} %, from {named(float(there.min()))} to {named(float(there.max()))}; the largest is "
        f"{percent_words(float(error[worst]))} at {named(float(parameter[worst]))}. Solve the study there before you "
        "use them."
    )


def uncertain_line_words(parameter: FloatArray, error: FloatArray, named: Callable[[float], str]) -> Iterator[str]:
    """A sentence on the ranges in which the line between the computed peaks has an estimated error above ``DOUBTFUL``.

    ``parameter`` (n,) are rising values, ``error`` (n,) the estimated ones there, NaN where no peak is known.
    """
    places = np.flatnonzero(error > DOUBTFUL)
    if not places.size:
        return
    ranges = [
        f"from {named(float(parameter[each[0]]))} to {named(float(parameter[each[-1]]))} "
        f"(up to {percent_words(float(error[each].max()))})"
        for each in np.split(places, np.flatnonzero(np.diff(places) > LARGEST_PAUSE) + 1)
    ]
    yield (
        f"The line between the computed peaks has an estimated error above {100.0 * DOUBTFUL:g} % {', '.join(ranges)}."
    )


def spread(estimates: Sequence[tuple[int, Mapping[int, float]]]) -> FloatArray:
    """(n,) errors of the points of a ridge: the number of harmonics of each, and its estimates by that number.

    A point without estimates has the larger one of the nearest ones on both sides, each with as many harmonics as the
    point where there is such an estimate, and the largest one with other harmonics.
    """
    known = [place for place, (_, own) in enumerate(estimates) if own]
    last = np.clip(np.searchsorted(known, np.arange(len(estimates)), side="right") - 1, 0, len(known) - 1)
    after = np.clip(np.searchsorted(known, np.arange(len(estimates))), 0, len(known) - 1)
    errors = np.zeros(len(estimates))
    for place, (harmonics, _) in enumerate(estimates):
        near = (estimates[known[int(side[place])]][1] for side in (last, after))
        errors[place] = max(each.get(harmonics, max(each.values())) for each in near)
    return errors
