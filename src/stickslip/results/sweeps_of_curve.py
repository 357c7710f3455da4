"""Slow sweeps of the frequency along a curve that may fold: their paths, their jumps and their peaks.

A slow sweep at constant excitation stays on stable motions. At a fold its branch ends, and the motion jumps to another
stable one at the same frequency. A *place* on a curve counts its points: 12.5 is halfway between the points 12 and 13.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray
from stickslip.results.peaks import Peak, checked_curve, peaks

Direction = Literal["up", "down"]
Flags = NDArray[np.bool_]
# chosen: a sweep reaches the highest peak if its own is no lower by more than this fraction; jumps below the second one
# are corners of the curve that no picture shows.
SAME_PEAK, SMALLEST_JUMP = 1e-3, 0.01


@dataclass(frozen=True)
class Jump:
    """A jump of a slow sweep, at constant frequency.

    direction:
        "up" or "down", of the sweep.
    frequency_hz, amplitude_from, amplitude_to:
        Hz, and the amplitude of the output before and after.
    place_from, place_to:
        places on the curve.
    """

    direction: Direction
    frequency_hz: float
    amplitude_from: float
    amplitude_to: float
    place_from: float
    place_to: float


@dataclass(frozen=True)
class SlowSweep:
    """The path of a slow sweep along a curve.

    direction:
        "up" or "down".
    runs:
        first and last place of each part of the curve that the sweep follows, in its order.
    jumps:
        between the runs.
    gaps_hz:
        frequencies, in the order of the sweep, between which the curve has no stable point where the sweep loses
        stability without a fold. What happens there is not on this curve.
    leaves_at_hz:
        frequency at which the sweep leaves the computed curve by a fold, because the curve does not come back to this
        frequency; None if the sweep runs to an end of the computed frequencies.
    peaks:
        local maxima along the path, highest first, also those before and after a jump; not bracketed at an end of the
        computed curve, at a gap and where the sweep leaves the curve, because the sweep may go higher there. Empty if
        no point of the curve is stable.
    """

    direction: Direction
    runs: tuple[tuple[float, float], ...]
    jumps: tuple[Jump, ...]
    gaps_hz: tuple[tuple[float, float], ...]
    leaves_at_hz: float | None
    peaks: tuple[Peak, ...]

    @property
    def peak(self) -> Peak | None:
        """The highest of the peaks, None without any."""
        return self.peaks[0] if self.peaks else None

    def points(self) -> NDArray[np.int64]:
        """(m,) computed points on the path, in the order of the sweep."""
        parts = [_points_between(first, last) for first, last in self.runs]
        return np.concatenate([np.zeros(0, dtype=np.int64), *parts])


def stable_between_folds(frequency_hz: ArrayLike) -> Flags:
    """(n_points,) False where the curve runs backward between two folds.

    At a fold one multiplier passes 1, so stability changes there. The curve begins far from resonance, on a stable
    part; parts that run in the direction of its first step are stable, those against it are not. This does not see
    motions that lose stability without a fold (period doubling, torus).
    """
    frequency = np.asarray(frequency_hz, dtype=float)
    step = np.diff(frequency)
    moving = step[step != 0.0]
    if not moving.size:
        return np.ones(frequency.size, dtype=bool)
    backward = step * moving[0] < 0.0
    before, after = np.concatenate([backward[:1], backward]), np.concatenate([backward, backward[-1:]])
    stable: Flags = ~(before & after)
    return stable


def unstable_steps(stable: Flags) -> Flags:
    """(n_points - 1,) steps between neighbouring points that figures draw as unstable: an end of them is unstable."""
    steps: Flags = ~(stable[:-1] & stable[1:])
    return steps


def joined_steps(part: NDArray[np.int64]) -> Flags:
    """(n_points - 1,) steps between neighbouring points of one uninterrupted part."""
    steps: Flags = np.diff(part) == 0
    return steps


def solid_words(stable: Flags | None) -> str:
    """What figures call the parts of a curve that are not drawn as unstable; ``stable`` is None where only folds are
    known."""
    return "stability not known" if stable is None else "stable"


def drawn_steps(values: FloatArray, drawn: Flags) -> FloatArray:
    """Values (n_points,) along the steps that are ``drawn`` (n_points - 1,), with a NaN between parts."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], drawn, [False]]).astype(np.int8)))
    parts = [[*values[first : last + 1], np.nan] for first, last in edges.reshape(-1, 2)]
    return np.concatenate([np.zeros(0), *parts])[:-1]


def reaches(highest: Peak, peak: Peak | None) -> bool:
    """Whether the peak of a sweep is the highest one on the curve, but for SAME_PEAK."""
    return peak is not None and peak.amplitude >= (1.0 - SAME_PEAK) * highest.amplitude


def notable_jumps(highest: Peak, jumps: Iterable[Jump]) -> tuple[Jump, ...]:
    """Jumps by more than SMALLEST_JUMP of the highest peak."""
    least = SMALLEST_JUMP * highest.amplitude
    return tuple(jump for jump in jumps if abs(jump.amplitude_to - jump.amplitude_from) > least)


def largest_jump(jumps: Sequence[Jump]) -> Jump:
    """The jump with the largest change of amplitude."""
    return max(jumps, key=lambda jump: abs(jump.amplitude_to - jump.amplitude_from))


def sweeps(
    frequency_hz: ArrayLike, amplitude: ArrayLike, stable: ArrayLike | None = None, part: ArrayLike | None = None
) -> tuple[SlowSweep, SlowSweep]:
    """The slow sweep up and the slow sweep down along a curve.

    A sweep begins at the first stable point of the curve in its direction and follows stable points while the frequency
    advances. At a fold it jumps along the curve, past the part that runs back, to the next stable part that passes the
    frequency of the fold: of several, this motion is the nearest along the curve. If all of them ahead are unstable, it
    takes the nearest stable part behind. The frequency of a fold is that of a parabola through three points. Where the
    curve is interrupted the sweep jumps in the same way, or leaves a gap.

    Parameters
    ----------
    frequency_hz, amplitude:
        (n_points,) along the curve, in either direction.
    stable:
        (n_points,) whether the motion is stable; without it the folds decide (:func:`stable_between_folds`).
    part:
        (n_points,) number of the uninterrupted part of each point; None for a curve of one part.

    Raises
    ------
    InputError
        for arrays of different or zero length.
    """
    frequency, height = checked_curve(frequency_hz, amplitude)
    flags = stable_between_folds(frequency) if stable is None else np.asarray(stable, dtype=bool)
    if flags.shape != frequency.shape:
        raise InputError(
            f"stable must have one entry for each of the {frequency.size} points, but its shape is {flags.shape}.",
            arguments=["stable"],
        )
    number = np.zeros(frequency.size, dtype=np.int64) if part is None else np.asarray(part, dtype=np.int64)
    return _sweep("up", frequency, height, flags, number), _sweep("down", frequency, height, flags, number)


def one_run(frequency_hz: FloatArray, amplitude: FloatArray) -> tuple[SlowSweep, SlowSweep]:
    """Both sweeps of a curve that a control follows through its folds: one run and no jump."""
    last = float(frequency_hz.size - 1)
    top = tuple(peaks(frequency_hz, amplitude))
    return (
        SlowSweep("up", ((0.0, last),), (), (), None, top),
        SlowSweep("down", ((last, 0.0),), (), (), None, top),
    )


def _sweep(
    direction: Direction, frequency: FloatArray, height: FloatArray, stable: Flags, part: NDArray[np.int64]
) -> SlowSweep:
    sign = 1.0 if direction == "up" else -1.0
    path = _Path(sign * frequency, stable, part)
    path.follow()

    jumps = tuple(
        Jump(direction, sign * x, _at(height, place_from), _at(height, place_to), place_from, place_to)
        for x, place_from, place_to in path.jumps
    )
    gaps = tuple((sign * first, sign * last) for first, last in path.gaps)
    leaves = None if path.leaves_at is None else sign * path.leaves_at
    tops = _peaks_of_path(frequency, height, part, path, {jump.place_from: jump.frequency_hz for jump in jumps})
    return SlowSweep(direction, tuple(path.runs), jumps, gaps, leaves, tops)


def _peaks_of_path(
    frequency: FloatArray,
    height: FloatArray,
    part: NDArray[np.int64],
    path: _Path,
    fold_hz: Mapping[float, float],
) -> tuple[Peak, ...]:
    """Local maxima along a path, highest first: those of the curve on it, and ends of runs above both neighbours."""
    open_ends = {0.0, height.size - 1.0, *path.open_ends}  # beyond them the sweep may go higher
    ends = []
    for number, (first, last) in enumerate(path.runs):
        before = path.runs[number - 1][1] if number else first
        after = path.runs[number + 1][0] if number + 1 < len(path.runs) else last
        inward = float(np.sign(last - first))
        for end, inner, outer in ((first, first + inward, before), (last, last - inward, after)):
            top, beside = _at(height, end), {_at(height, inner), *([] if end in open_ends else [_at(height, outer)])}
            if top >= max(beside):
                hertz = fold_hz.get(end, _at(frequency, end))
                ends.append(Peak(round(end), hertz, top, bracketed=end not in open_ends))
    inside = [
        peak
        for peak in peaks(frequency, height, part)
        if peak.bracketed and any(min(run) - 1.0 < peak.point < max(run) + 1.0 for run in path.runs)
    ]
    # the tip of a fold and the end of the run at it are one peak
    ends = [end for end in ends if all(abs(end.point - peak.point) > 1 for peak in inside)]
    return tuple(sorted([*inside, *ends], key=lambda peak: -peak.amplitude))


def _at(values: FloatArray, place: float) -> float:
    return float(np.interp(place, np.arange(values.size), values))


def _points_between(first: float, last: float) -> NDArray[np.int64]:
    low, high = int(np.ceil(min(first, last))), int(np.floor(max(first, last)))
    points = np.arange(low, high + 1)
    return points if first <= last else points[::-1]


class _Path:
    """The path of a sweep in which ``x`` rises: the frequency, or its negative for a sweep down."""

    def __init__(self, x: FloatArray, stable: Flags, part: NDArray[np.int64]) -> None:
        self._x, self._stable, self._part = x, stable, part
        self.runs: list[tuple[float, float]] = []
        self.jumps: list[tuple[float, float, float]] = []  # x, place before, place after
        self.gaps: list[tuple[float, float]] = []
        self.open_ends: list[float] = []
        self.leaves_at: float | None = None

    def follow(self) -> None:
        """Go from run to run; ``x`` at the end of each run is larger than at the end of the one before."""
        if not self._stable.any():
            self.gaps.append((float(self._x.min()), float(self._x.max())))
            return
        point = int(np.where(self._stable, self._x, np.inf).argmin())
        place, step = float(point), self._rising_step(point)
        self.open_ends.append(place)
        while True:
            point = self._climb(point, step)
            if not 0 <= point + step < self._x.size:
                self.runs.append((place, float(point)))
                return
            last, x, is_fold = self._end_of_run(point, step)
            self.runs.append((place, last))
            landing = self._landing(last, x, step, is_fold)
            if landing is not None:
                self.jumps.append((x, last, landing[0]))
                place, point, step = landing
                continue
            self.open_ends.append(last)
            if is_fold and not self._passes(x, round(last), step):
                self.leaves_at = x
                return
            beyond = np.where(self._stable & (self._x > x), self._x, np.inf)
            if not np.isfinite(beyond.min()):
                self.gaps.append((x, float(self._x.max())))
                return
            point = int(beyond.argmin())
            self.gaps.append((x, float(self._x[point])))
            self.open_ends.append(float(point))
            place, step = float(point), self._rising_step(point)

    def _rises(self, point: int, step: int) -> bool:
        there = point + step
        return self._are_joined(point, there) and bool(self._stable[there] and self._x[there] >= self._x[point])

    def _are_joined(self, point: int, there: int) -> bool:
        """Whether the curve has the second point, and is not interrupted between them."""
        return 0 <= there < self._x.size and bool(self._part[point] == self._part[there])

    def _rising_step(self, point: int) -> int:
        """The direction along the curve in which x rises over stable points."""
        return -1 if self._rises(point, -1) and not self._rises(point, 1) else 1

    def _climb(self, point: int, step: int) -> int:
        while self._rises(point, step):
            point += step
        return point

    def _end_of_run(self, point: int, step: int) -> tuple[float, float, bool]:
        """Place and x at which a run ends after ``point``, and whether by a fold.

        Stability may change one point before the largest x, because the fold is between points.
        """
        x, ahead = self._x, point + step
        if not self._are_joined(point, ahead):
            return float(point), float(x[point]), False
        top = point
        if x[ahead] > x[point]:
            if not (self._are_joined(ahead, ahead + step) and x[ahead + step] < x[ahead]):
                return float(point), float(x[point]), False
            top = ahead
        if not self._are_joined(top, top - 1) or not self._are_joined(top, top + 1):
            return float(top), float(x[top]), True
        if not x[top - 1] <= x[top] >= x[top + 1]:
            return float(top), float(x[top]), True
        bend, slope = 0.5 * (x[top - 1] + x[top + 1]) - x[top], 0.5 * (x[top + 1] - x[top - 1])
        if bend == 0.0:
            return float(top), float(x[top]), True
        return float(top - 0.5 * slope / bend), float(x[top] - 0.25 * slope**2 / bend), True

    def _landing(self, last: float, x: float, step: int, is_fold: bool) -> tuple[float, int, int] | None:
        """Place of the motion after a jump at ``x``, the next point from there, and the direction along the curve."""
        here = round(last)
        for way in (step, -step):
            if way == -step and is_fold and not self._passes(x, here, step):
                return None
            stop = self._x.size if way > 0 else -1
            for near in range(here, stop - way, way):
                landing = self._on_segment(near, near + way, x)
                if landing is not None:
                    return landing
        return None

    def _on_segment(self, near: int, far: int, x: float) -> tuple[float, int, int] | None:
        """The landing on the segment between two points if the segment passes ``x`` and is stable on its upper side."""
        low, high = (near, far) if self._x[near] < self._x[far] else (far, near)
        if not self._are_joined(near, far) or not self._x[low] <= x < self._x[high] or not self._stable[high]:
            return None
        share = float((x - self._x[low]) / (self._x[high] - self._x[low]))
        if share < 0.5 and not self._stable[low]:
            return None
        return low + share * (high - low), high, high - low

    def _passes(self, x: float, here: int, step: int) -> bool:
        """Whether the curve ahead of point ``here``, and of the part that runs back from it, comes to ``x`` again."""
        ahead = self._x[here + step :] if step > 0 else self._x[: here + step + 1][::-1]
        return bool((ahead > x).any())
