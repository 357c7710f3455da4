"""Follow many curves in lockstep by pseudo-arc length, each with its own steps.

The control of a step is that of :mod:`stickslip.solve.path.continuation`. What is rare there is omitted: where a curve
has a corner, comes back or is lost, it leaves the batch with a reason, and is solved alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from stickslip.contact.law.law import BoolArray
from stickslip.core.validation import FloatArray
from stickslip.solve.batch.corrections import Corrections, Outcome
from stickslip.solve.batch.curve_points import CurvePoints
from stickslip.solve.batch.equations import StackedBalance, norm, product
from stickslip.solve.batch.resonances import ManyResonances
from stickslip.solve.batch.systems import Changes, Planes
from stickslip.solve.harmonic.gain import ComplexArray
from stickslip.solve.harmonic.harmonic_modes import IndexArray
from stickslip.solve.harmonic.resonances import Resonances
from stickslip.solve.path.continuation import LONGEST_EXCURSION, MOST_LANDINGS
from stickslip.solve.path.corrector import SMALLEST_MOTION
from stickslip.solve.path.landmarks import ON_IT, VISIBLE
from stickslip.solve.path.stepping import ContinuationSettings

SETTINGS = ContinuationSettings()
# chosen: a step that turns too far is repeated with this fraction of its length. Where a single pair begins to slip,
# the curve has a corner: all steps turn down to the shortest one, which accepts it. Halves would take twice the
# corrections.
OF_TURNING = 0.25
# chosen: ten times the points of usual curves, and twice those of curves with many resonances of the torture set; one
# with more is a loop, or the contact rattles.
MOST_POINTS = 1000
FIRST, STEP, LANDING = range(3)  # what the present correction of a curve is


@dataclass(frozen=True)
class Followed:
    """The points of each curve, and the reason why it left the batch; "" for a complete curve."""

    points: list[CurvePoints]
    reasons: list[str]


def follow(balance: StackedBalance, resonances: Sequence[Resonances], window: tuple[float, float]) -> Followed:
    """Follow B curves from the start to the stop of a range (rad/s)."""
    march = _March(balance, resonances, window)
    with np.errstate(all="ignore"):  # numbers of a correction that diverges; it fails by its error
        while march.ids.size:
            march.tick()
    return march.result()


@dataclass
class _Places:
    """Where each of B curves is: last point, unit tangent there, its change per length, and the present step."""

    relative: FloatArray
    omega: FloatArray
    amplitude: ComplexArray
    tangent: FloatArray
    tangent_omega: FloatArray
    tangent_amplitude: ComplexArray
    bend: FloatArray
    bend_omega: FloatArray
    largest: FloatArray  # norm of the motion so far
    length: FloatArray  # of the present step
    planned: FloatArray  # length without the resonance that shortened the step
    landmark: FloatArray  # rad/s at which the step ends, NaN for none
    stage: IndexArray
    landings: IndexArray
    count: IndexArray

    def take(self, chosen: IndexArray) -> _Places:
        """Those of some curves."""
        return _Places(**{item.name: getattr(self, item.name)[chosen] for item in fields(self)})


class _March:
    """The state of all curves that are not complete."""

    def __init__(self, balance: StackedBalance, resonances: Sequence[Resonances], window: tuple[float, float]) -> None:
        self._start, self._stop = window
        self._width, self._direction = abs(window[1] - window[0]), np.sign(window[1] - window[0])
        self._corrections = Corrections(balance)
        self._resonances = ManyResonances(resonances, balance.springs.shape[1])
        self.ids = np.arange(balance.count)
        self._reasons = [""] * balance.count
        self._parts: list[tuple[IndexArray, CurvePoints]] = []
        count, shape = balance.count, balance.springs.shape
        start = np.full(count, self._start)
        linear = balance.linear(start)
        modes = np.zeros((count, balance.structures.shapes.shape[2], (shape[2] - 1) // 2), dtype=complex)
        zeros, whole, none = np.zeros(shape), np.zeros(count), np.zeros(count, dtype=np.int64)
        self._places = _Places(
            linear, start, modes, zeros, whole, modes.copy(), zeros.copy(), whole.copy(),
            np.full(count, SMALLEST_MOTION), whole.copy(), whole.copy(), np.full(count, np.nan),
            np.full(count, FIRST), np.full(count, MOST_LANDINGS), none,
        )  # fmt: skip
        planes = Planes.fixed(np.full(count, self._direction / self._width**2), start, shape)
        self._corrections.begin(self.ids, linear, start, planes)

    def tick(self) -> None:
        """One evaluation of all curves, and what follows from it for each."""
        outcome, places = self._corrections.tick(), self._places
        stage, converged, failed = places.stage.copy(), outcome.converged, outcome.failed
        finished = self._leave(failed & (stage == FIRST), "Newton's method found no first point")
        self._begin(self._first(outcome, np.flatnonzero(converged & (stage == FIRST))))
        landed = converged & (stage == LANDING)
        self._record(outcome, np.flatnonzero(landed))
        lost = failed & (stage == LANDING) & (places.landings == 0)
        finished |= landed | self._leave(lost, "Newton's method found no point at the stop")
        self._retry(np.flatnonzero(failed & (stage == LANDING) & ~finished))
        finished |= self._advance(outcome, np.flatnonzero(converged & (stage == STEP)))
        finished |= self._shorten(np.flatnonzero(failed & (stage == STEP)), 0.5)
        if finished.any():
            remaining = np.flatnonzero(~finished)
            self.ids, self._places = self.ids[remaining], places.take(remaining)
            self._corrections.take(remaining)
            self._resonances.take(remaining)

    def result(self) -> Followed:
        """All curves."""
        order = np.concatenate([ids for ids, _ in self._parts] or [np.empty(0, dtype=np.int64)])
        points: list[CurvePoints] = []
        if order.size:
            together = CurvePoints.joined([part for _, part in self._parts])
            points = [together.take(np.flatnonzero(order == curve)) for curve in range(len(self._reasons))]
        return Followed(points, self._reasons)

    def _first(self, outcome: Outcome, chosen: IndexArray) -> IndexArray:
        """The first points of some curves, with their tangents."""
        places, motion = self._places, outcome.trial.amplitude[chosen]
        along = self._corrections.direction(chosen)
        size = norm(motion)
        at_rest = SETTINGS.first_step * self._width * norm(along.amplitude)  # a curve may start at rest
        places.largest[chosen] = np.maximum(np.where(size > 0.0, size, at_rest), SMALLEST_MOTION)
        self._accept(outcome, chosen, self._unit(chosen, along))
        places.planned[chosen] = SETTINGS.first_step
        return chosen

    def _advance(self, outcome: Outcome, chosen: IndexArray) -> BoolArray:
        """Accept the steps of some curves that do not turn too far, and begin the next; (B,) those that end."""
        places, trial = self._places, outcome.trial
        omega, motion = trial.omega[chosen], trial.amplitude[chosen]
        places.largest[chosen] = np.maximum(places.largest[chosen], norm(motion))
        along = self._unit(chosen, self._corrections.direction(chosen))
        angle = self._angles(chosen, omega, motion, along)
        change = omega - places.omega[chosen]
        value, width = self._resonances.first_crossed(chosen, places.omega[chosen], change)
        has_jumped = np.abs(omega - value) > ON_IT * width
        is_corner = places.length[chosen] < SETTINGS.smallest_step / OF_TURNING
        is_good = ((angle <= SETTINGS.largest_angle_deg) | is_corner) & ~has_jumped
        finished = self._shorten(chosen[~is_good], OF_TURNING)
        passes = is_good & ((omega - self._stop) * self._direction >= 0.0)
        self._land(outcome, chosen[passes])
        behind = (self._start - omega) * self._direction
        onward = is_good & ~passes
        is_lost = onward & (behind > LONGEST_EXCURSION * min(self._width, self._start))
        finished |= self._leave(self._mask(chosen[is_lost]), "the curve left the range through its start")
        kept = np.flatnonzero(onward & ~is_lost)
        going = chosen[kept]
        before, length = places.planned[going], places.length[going]
        after = self._next(going, length, angle[kept])
        is_cut = ~np.isnan(places.landmark[going])
        # Nothing narrow was there: the next step is that of a curve without the resonance.
        planned = np.where(is_cut, np.maximum(after, before * np.minimum(1.0, after / length)), after)
        tangents = Changes(along.relative[kept], along.amplitude[kept], along.omega[kept])
        self._accept(outcome, going, tangents, length)
        places.planned[going] = planned
        too_many = places.count[going] >= MOST_POINTS
        finished |= self._leave(self._mask(going[too_many]), f"{MOST_POINTS} points were not enough")
        self._begin(going[~too_many])
        return finished

    def _next(self, chosen: IndexArray, length: FloatArray, angle: FloatArray) -> FloatArray:
        """Lengths of the next steps, see :meth:`ContinuationSettings.next_step`."""
        by_angle = SETTINGS.wanted_angle_deg / np.maximum(angle, 1e-3)
        by_iterations = (SETTINGS.wanted_iterations + 1.0) / (self._corrections.iterations(chosen) + 1.0)
        factor = np.clip(np.minimum(by_angle, by_iterations), 0.4, 2.0)
        return np.asarray(np.clip(length * factor, SETTINGS.smallest_step, SETTINGS.largest_step))

    def _angles(self, chosen: IndexArray, omega: FloatArray, motion: ComplexArray, along: Changes) -> FloatArray:
        """(S,) degrees by which steps to new points turn: tangents, twice the chord, and both by the local motion."""
        places = self._places
        scale, start = places.largest[chosen], places.omega[chosen]
        before, tangent = places.amplitude[chosen], places.tangent_amplitude[chosen]
        slope = places.tangent_omega[chosen] / self._width
        near = self._resonances.is_long_near(chosen, start, omega)
        local = np.maximum(norm(before), norm(motion))
        local = np.where(near, np.maximum(local, VISIBLE * scale), scale)
        square, angles = product(tangent, tangent), np.zeros(len(chosen))
        for factor, other, rise in (
            (1.0, along.amplitude, along.omega / self._width),
            (2.0, motion - before, (omega - start) / self._width),
        ):
            inner, own = product(other, tangent), product(other, other)
            for size in (scale, local):
                lengths = (own / size**2 + rise**2) * (square / size**2 + slope**2)
                cosine = (inner / size**2 + rise * slope) / np.sqrt(lengths)
                angles = np.maximum(angles, factor * np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
        return angles

    def _unit(self, chosen: IndexArray, along: Changes) -> Changes:
        """Directions of length 1 in the plot."""
        motion = norm(along.amplitude) / self._places.largest[chosen]
        factor = 1.0 / np.hypot(motion, along.omega / self._width)
        return Changes(
            factor[:, None, None] * along.relative, factor[:, None, None] * along.amplitude, factor * along.omega
        )

    def _accept(self, outcome: Outcome, chosen: IndexArray, along: Changes, length: FloatArray | None = None) -> None:
        """New points of some curves, with their unit tangents, after steps of a ``length``; None for the first."""
        places, trial = self._places, outcome.trial
        if length is not None:
            places.bend[chosen] = (along.relative - places.tangent[chosen]) / length[:, None, None]
            places.bend_omega[chosen] = (along.omega - places.tangent_omega[chosen]) / length
        places.tangent[chosen], places.tangent_omega[chosen] = along.relative, along.omega
        places.tangent_amplitude[chosen] = along.amplitude
        places.relative[chosen], places.omega[chosen] = trial.relative[chosen], trial.omega[chosen]
        places.amplitude[chosen] = trial.amplitude[chosen]
        places.count[chosen] += 1
        self._record(outcome, chosen)
        self._resonances.reach(chosen, trial.moves[chosen])

    def _record(self, outcome: Outcome, chosen: IndexArray) -> None:
        if chosen.size:
            self._parts.append((self.ids[chosen], CurvePoints.of(outcome.trial, chosen)))

    def _begin(self, chosen: IndexArray) -> None:
        """Begin steps of the planned lengths, which end at the first resonance that they would cross."""
        places = self._places
        planned, slope = places.planned[chosen], places.tangent_omega[chosen]
        value, _ = self._resonances.first_crossed(chosen, places.omega[chosen], planned * slope)
        cut = (value - places.omega[chosen]) / slope
        is_cut = cut >= SETTINGS.smallest_step  # False for none
        places.landmark[chosen] = np.where(is_cut, value, np.nan)
        places.length[chosen] = np.where(is_cut, cut, planned)
        self._predict(chosen)

    def _predict(self, chosen: IndexArray) -> None:
        """Begin corrections from the predicted ends of steps; the planes are across the tangents, or at a resonance."""
        places, planes = self._places, self._corrections.balance.determined(self._places.tangent)[chosen]
        places.stage[chosen] = STEP
        length, landmark = places.length[chosen], places.landmark[chosen]
        along = length[:, None, None] * places.tangent[chosen]
        relative = places.relative[chosen] + along + 0.5 * length[:, None, None] ** 2 * places.bend[chosen]
        ahead = places.omega[chosen] + length * places.tangent_omega[chosen]
        omega = ahead + 0.5 * length**2 * places.bend_omega[chosen]
        size = np.maximum(norm(planes), SMALLEST_MOTION)
        at_landmark = ~np.isnan(landmark)
        weights = planes / (size**2)[:, None, None]
        weights[at_landmark] = 0.0
        anchor = product(weights, places.relative[chosen] + along)
        weight = places.tangent_omega[chosen] / self._width**2
        self._corrections.begin(
            chosen, relative, omega, Planes(weights, weight, anchor, np.where(at_landmark, landmark, ahead))
        )

    def _shorten(self, chosen: IndexArray, fraction: float) -> BoolArray:
        """Try a fraction of the present steps of some curves; (B,) those whose steps are too short."""
        places = self._places
        places.length[chosen] *= fraction
        places.landmark[chosen] = np.nan
        is_short = places.length[chosen] < SETTINGS.smallest_step
        self._predict(chosen[~is_short])
        return self._leave(
            self._mask(chosen[is_short]), f"steps of {SETTINGS.smallest_step:g} of the range are too long"
        )

    def _land(self, outcome: Outcome, chosen: IndexArray) -> None:
        """Begin corrections at the stop, which steps of some curves have passed."""
        places, trial = self._places, outcome.trial
        places.stage[chosen] = LANDING
        fraction = (self._stop - places.omega[chosen]) / (trial.omega[chosen] - places.omega[chosen])
        chord = trial.relative[chosen] - places.relative[chosen]
        guess = places.relative[chosen] + fraction[:, None, None] * chord
        stop = np.full(len(chosen), self._stop)
        weight = np.full(len(chosen), 1.0 / self._width**2)
        self._corrections.begin(chosen, guess, stop, Planes.fixed(weight, stop, guess.shape))

    def _retry(self, chosen: IndexArray) -> None:
        """Shorter steps of curves from which no landing succeeded: the stop is nearer from the next points."""
        places = self._places
        places.landings[chosen] -= 1
        places.planned[chosen] = 0.5 * places.length[chosen]
        self._begin(chosen)

    def _leave(self, mask: BoolArray, reason: str) -> BoolArray:
        """Some curves leave the batch for a reason; returns their mask (B,)."""
        for place in np.flatnonzero(mask):
            hertz = self._places.omega[place] / (2.0 * np.pi)
            self._reasons[self.ids[place]] = f"The batch lost the curve at {hertz:.3f} Hz: {reason}."
        return mask.copy()

    def _mask(self, chosen: IndexArray) -> BoolArray:
        mask = np.zeros(len(self.ids), dtype=bool)
        mask[chosen] = True
        return mask
