"""Points at the highest peaks of many curves: the maxima of their outputs along the curves, in lockstep.

Three successive points of a curve contain a maximum if the middle one is the highest. The next point is at the vertex
of the parabola through them, over the distance along their chords, or in the middle of the longer side if parabolas do
not shorten it. It is a solution on the plane across the chord, so a peak beside a fold is no exception.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.batch.corrections import Corrections
from stickslip.solve.batch.curve_points import CurvePoints
from stickslip.solve.batch.equations import StackedBalance, norm, product
from stickslip.solve.batch.outputs import Outputs
from stickslip.solve.batch.systems import Planes
from stickslip.solve.harmonic.harmonic_modes import IndexArray

# chosen: lower maxima are not refined; where tangents turn by 15 degrees from point to point (wanted_angle_deg), a peak
# is some percent above its points.
HEIGHT = 0.9
# chosen: a peak is complete if the parabola of its last three points is higher than the middle one by less than this; a
# tenth of the accuracy of 1e-4 that the result promises.
RISE = 1e-5
# chosen: smooth peaks need two or three rounds; by halves alone, 12 shorten a bracket to 1/60 (6 of each side).
ROUNDS = 12
# chosen: a new point is no nearer to the others than this fraction of the bracket, so that it says something new.
APART = 0.02


@dataclass(frozen=True)
class Brackets:
    """Maxima between three points: ``curve`` (K,), ``place`` (K,) of the middle point in its curve, and ``points`` of
    them, before, at and behind it; ``height`` (K, 3) m of the output."""

    curve: IndexArray
    place: IndexArray
    points: list[CurvePoints]
    height: FloatArray

    @classmethod
    def of(cls, outputs: Outputs, curves: Sequence[CurvePoints], chosen: Sequence[int]) -> Brackets:
        """The highest maxima of some curves, without those at their ends."""
        found: list[tuple[int, int]] = []
        heights: list[FloatArray] = []
        for curve in chosen:
            height = outputs.amplitudes(np.full(len(curves[curve].omega), curve), curves[curve])
            middle = height[1:-1]
            is_peak = (middle > height[:-2]) & (middle >= height[2:]) & (middle >= HEIGHT * height.max())
            for place in np.flatnonzero(is_peak) + 1:
                found.append((curve, int(place)))
                heights.append(height[place - 1 : place + 2])
        places = np.array(found, dtype=np.int64).reshape(-1, 2)
        points = [
            CurvePoints.joined([curves[curve].take(np.array([place + step])) for curve, place in found])
            for step in (-1, 0, 1)
            if found
        ]
        return cls(places[:, 0], places[:, 1], points, np.array(heights).reshape(-1, 3))


@dataclass
class _Search:
    """The state of the search in K brackets: positions along the chords from the first middle points, in the plot."""

    position: FloatArray  # (K, 3)
    height: FloatArray  # (K, 3)
    relative: FloatArray  # (K, 3, m, W)
    omega: FloatArray  # (K, 3)
    best: CurvePoints
    is_complete: BoolArray
    is_new: BoolArray = field(init=False)
    side: FloatArray = field(init=False)  # (K,) the longer side of the round before the last

    def __post_init__(self) -> None:
        self.is_new = np.zeros(len(self.position), dtype=bool)
        self.side = np.full(len(self.position), np.inf)


def with_peaks(
    balance: StackedBalance, outputs: Outputs, curves: Sequence[CurvePoints], chosen: Sequence[int], width: float
) -> tuple[list[CurvePoints], list[str]]:
    """The points of all curves, the ``chosen`` ones with further points at the maxima of their outputs.

    The range of the curves has a ``width`` in rad/s. The second list gives a reason for each curve with a maximum that
    the search did not reach, and is empty for others.
    """
    points, reasons = list(curves), [""] * len(curves)
    brackets = Brackets.of(outputs, curves, chosen)
    if not brackets.curve.size:
        return points, reasons
    search = _begin(balance.take(brackets.curve), brackets, width)
    for round_ in range(ROUNDS):
        places = np.flatnonzero(~search.is_complete)
        target, vertex = _targets(search, places, halves=round_ % 2 == 1)
        # The parabola of the points of the curve itself is no proof: they may be far apart.
        is_done = (vertex - search.height[places, 1] < RISE * search.height[places, 1]) & search.is_new[places]
        search.is_complete[places[is_done]] = True
        going = places[~is_done]
        if not going.size:
            break
        _advance(balance, outputs, brackets.curve, search, going, target[~is_done], width)
    before = brackets.place + (search.position[:, 1] > 0.0)
    for curve in np.unique(brackets.curve):
        own = np.flatnonzero(brackets.curve == curve)
        new = own[search.position[own, 1] != 0.0]
        points[curve] = points[curve].with_points(before[new], search.best.take(new))
        if not search.is_complete[own].all():
            reasons[curve] = "The batch found no point at the maximum of a peak."
    return points, reasons


def _begin(balance: StackedBalance, brackets: Brackets, width: float) -> _Search:
    """The search from the points of the curves."""
    relative = np.stack([each.relative for each in brackets.points], axis=1)
    omega = np.stack([each.omega for each in brackets.points], axis=1)
    scale = norm(balance.determined(relative[:, 1]))

    def length(first: int, last: int) -> FloatArray:
        chord = balance.determined(relative[:, last] - relative[:, first])
        return np.hypot(norm(chord) / scale, (omega[:, last] - omega[:, first]) / width)

    position = np.stack([-length(0, 1), np.zeros(len(omega)), length(1, 2)], axis=1)
    complete = np.zeros(len(omega), dtype=bool)
    return _Search(position, brackets.height.copy(), relative, omega, brackets.points[1], complete)


def _targets(search: _Search, places: IndexArray, halves: bool) -> tuple[FloatArray, FloatArray]:
    """(S,) positions of the next points in some brackets, and (S,) the heights of the parabolas there.

    With ``halves``, brackets whose longer side is not half of that two rounds before get its middle.
    """
    position, height = search.position[places], search.height[places]
    left, right = position[:, 1] - position[:, 0], position[:, 2] - position[:, 1]
    slopes = (height[:, 1] - height[:, 0]) / left, (height[:, 2] - height[:, 1]) / right
    bend = (slopes[1] - slopes[0]) / (left + right)  # not positive
    slope = (slopes[0] * right + slopes[1] * left) / (left + right)
    offset = np.where(bend < 0.0, -0.5 * slope / np.where(bend < 0.0, bend, 1.0), 0.0)
    offset = np.clip(offset, -left, right)
    top = height[:, 1] + slope * offset + bend * offset**2
    apart, longer = APART * (left + right), np.maximum(left, right)
    side = np.where(offset == 0.0, np.where(right > left, 1.0, -1.0), np.sign(offset))
    room = np.where(side > 0.0, right, left)
    step = np.clip(np.abs(offset), np.minimum(apart, 0.5 * room), np.maximum(room - apart, 0.5 * room))
    if halves:
        is_slow = longer > 0.5 * search.side[places]
        search.side[places] = longer
        side = np.where(is_slow, np.where(right > left, 1.0, -1.0), side)
        step = np.where(is_slow, 0.5 * longer, step)
    return position[:, 1] + side * step, top


def _advance(
    balance: StackedBalance,
    outputs: Outputs,
    curve: IndexArray,
    search: _Search,
    going: IndexArray,
    target: FloatArray,
    width: float,
) -> None:
    """Solve at the targets (S,) of the brackets ``going`` (S,), and replace one of the points of each."""
    own = balance.take(curve[going])
    position, relative, omega = search.position[going], search.relative[going], search.omega[going]
    weights = _lagrange(position, target)
    guess = np.einsum("kp,kpmw->kmw", weights, relative)
    guess_omega = (weights * omega).sum(axis=1)
    chord = own.determined(relative[:, 2] - relative[:, 0])
    normal = chord / (norm(chord) ** 2)[:, None, None]
    anchor = product(normal, guess)
    slope = (omega[:, 2] - omega[:, 0]) / width**2
    solutions, converged = _solved(own, guess, guess_omega, Planes(normal, slope, anchor, guess_omega))
    height = outputs.amplitudes(curve[going], solutions)
    for row in np.flatnonzero(converged):
        place = going[row]
        old = search.position[place]
        new = int(target[row] > old[1])  # between the points new and new + 1
        order = np.insert(old, new + 1, target[row])
        heights = np.insert(search.height[place], new + 1, height[row])
        all_relative = np.insert(search.relative[place], new + 1, solutions.relative[row], axis=0)
        all_omega = np.insert(search.omega[place], new + 1, solutions.omega[row])
        first = min(max(int(heights.argmax()) - 1, 0), 1)
        kept = slice(first, first + 3)
        search.position[place], search.height[place] = order[kept], heights[kept]
        search.relative[place], search.omega[place] = all_relative[kept], all_omega[kept]
        search.is_new[place] = True
        if heights.argmax() == new + 1:
            search.best.put(int(place), solutions, int(row))
    lost = going[~converged]
    search.side[lost] = 0.0  # the middle of the longer side in the next round of halves


def _lagrange(position: FloatArray, target: FloatArray) -> FloatArray:
    """(K, 3) weights of three values at positions (K, 3) in that at a target (K,)."""
    answer = np.ones_like(position)
    for one in range(3):
        for other in range(3):
            if one != other:
                answer[:, one] *= (target - position[:, other]) / (position[:, one] - position[:, other])
    return answer


def _solved(
    balance: StackedBalance, relative: FloatArray, omega: FloatArray, planes: Planes
) -> tuple[CurvePoints, BoolArray]:
    """Solutions on planes, and whether each correction converged (K,); all others are trials."""
    corrections, ids = Corrections(balance), np.arange(len(omega))
    corrections.begin(ids, relative, omega, planes)
    parts, order, converged = [], [], np.zeros(len(omega), dtype=bool)
    with np.errstate(all="ignore"):  # numbers of a correction that diverges; it fails by its error
        while ids.size:
            outcome = corrections.tick()
            ended = np.flatnonzero(outcome.converged | outcome.failed)
            parts.append(CurvePoints.of(outcome.trial, ended))
            order.append(ids[ended])
            converged[ids[outcome.converged]] = True
            remaining = np.flatnonzero(~(outcome.converged | outcome.failed))
            ids = ids[remaining]
            corrections.take(remaining)
    return CurvePoints.joined(parts).take(np.argsort(np.concatenate(order))), converged
