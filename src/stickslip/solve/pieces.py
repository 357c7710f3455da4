"""A frequency curve in pieces: where the branch is lost it begins again beyond, and time integration tells why.

Friction bodies that rattle have no motion with the period of the force at some frequencies, and near them corners and
folds that no step passes. The curve then continues at the next frequency at which a solution exists.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Generic, TypeAlias

import numpy as np

from stickslip.core.errors import ConvergenceError
from stickslip.core.fourier import with_rows
from stickslip.core.shown_numbers import capital
from stickslip.solve.evidence import Evidence, Settling
from stickslip.solve.harmonic.curves import BalancePoint, BalancePointT
from stickslip.solve.path.continuation import Branch
from stickslip.solve.path.retreats import Crossing, crossing_of
from stickslip.solve.path.stepping import BranchPoint

# chosen: largest number of times that a curve begins again, and the distances beyond the place where it was lost at
# which a solution is looked for, as fractions of the range.
MOST_PIECES, DISTANCES = 6, (1e-4, 1e-3, 4e-3, 0.016, 0.06, 0.2, 0.5)
# chosen: a curve ends if more pieces one after the other than this number cover less than this fraction of the range:
# steps of round-off, not a curve.
MOST_SHORT, SHORT = 1, 0.01
# chosen: the smallest distance at which an amplitude ramp is tried, which takes long.
LEAST_RAMP = 0.016
# chosen: a curve is complete if its pieces leave out no more than this fraction of the range.
LARGEST_GAP = 0.01
# chosen: pieces whose motions at one frequency differ by no more than this fraction are one.
SAME_MOTION = 1e-3
# A motion and how it was found.
Found: TypeAlias = tuple[BalancePoint, str]


class Pieces(Generic[BalancePointT]):
    """The points of all pieces in the order of the curve, and what is known of their ends.

    Parameters
    ----------
    part:
        follows the branch from a solution to a frequency in rad/s.
    window:
        (start, stop) in rad/s.
    settling:
        finds solutions away from the curve, and counts the work, at whose limit the curve ends.
    varies:
        whether ``part`` chooses its harmonics by an accuracy: a lost curve then continues once from a motion to which a
        time integration settled and that more harmonics give. Else ``part`` has a fixed number of harmonics, but may
        begin with more: the curve continues from such a motion wherever its own number goes on nowhere.

    Attributes
    ----------
    breaks:
        numbers of the points after which the curve is interrupted.
    warnings:
        a sentence on each place where it is, and on a beginning without a solution.
    complete, message, retreats, corners, crossings:
        as those of :class:`Branch`; a curve that leaves out more than LARGEST_GAP of the window, or the rest of a
        branch that used its points, is not complete.
    """

    def __init__(
        self,
        part: Callable[[BalancePoint, float], Branch[BalancePointT]],
        window: tuple[float, float],
        settling: Settling,
        varies: bool = False,
    ) -> None:
        self._part, self._settling, self._window = part, settling, window
        self._varies, self._takes_settled = varies, True
        self._direction = math.copysign(1.0, window[1] - window[0])
        self._width = abs(window[1] - window[0])
        self._left_out, self._ran_out = 0.0, False
        self.points: list[BranchPoint[BalancePointT]] = []
        self.breaks: list[int] = []
        self.warnings: list[str] = []
        self.retreats: list[float] = []
        self.corners: list[float] = []
        self.crossings: list[Crossing] = []
        self.complete = False
        self.message = ""

    def follow(self, start: BalancePoint | None, reason: str = "") -> Pieces[BalancePointT]:
        """Follow from a solution at the start of the window, or from the first frequency at which there is one.

        ``reason`` says why there is none at the start. Raises ConvergenceError with this reason if there is none at
        all.
        """
        if start is not None:
            return self._follow(self._append(self._part(start, self._window[1])))
        first = self._window[0]
        at_start, evidence, is_settled = self._way_on(
            lambda: self._settling.solution((), first, ramp=False),
            functools.partial(self._settling.evidence_from_rest, first),
            first,
        )
        words = self._sentences(reason, evidence, goes_on=is_settled)
        if at_start is not None:
            if is_settled:
                self.warnings.append(f"{capital(words)} The curve begins from this motion.")
            return self._follow(self._append(self._part(at_start[0], self._window[1])))
        # A motion that exists, but that these harmonics or digits do not give, is no reason to begin elsewhere.
        exists = evidence is not None and evidence.repeats_after == 1
        found = None if exists else self._beyond(first, ())
        if found is None:
            raise ConvergenceError(self._with_limit(words))
        point, how = found
        back = self._part(point, first)
        gap = self._gap(first, back)
        words = capital(words)
        self.warnings.append(f"{words} The curve begins at {_hz(gap[1])} Hz, from a motion that was found {how}.")
        self._append(back, reverse=True)
        return self._follow(self._append(self._part(point, self._window[1])))

    def _follow(self, branch: Branch[BalancePointT]) -> Pieces[BalancePointT]:
        """Go on where a branch was lost."""
        short = 0
        for _ in range(MOST_PIECES):
            covered = abs(branch.points[-1].point.trial.omega - branch.points[0].point.trial.omega)
            short = short + 1 if covered < SHORT * self._width else 0
            if not branch.lost or short > MOST_SHORT:
                break
            self._ran_out |= branch.ran_out
            onward = self._go_on(branch)
            if onward is None:
                return self
            branch = onward
        if not branch.complete:
            self.message = self._sentences(branch.message, self._evidence_at_end())
        self.complete = branch.complete and self._left_out <= LARGEST_GAP * self._width and not self._ran_out
        if branch.complete and self._ran_out:
            self.message = (
                "The curve reached the stop frequency, but a part of it is missing: a branch that ran back used all of "
                "its points (the warnings give the frequency). Raise max_points or narrow the range."
            )
        elif branch.complete and not self.complete:
            self.message = (
                f"The curve reached the stop frequency, but has no points in {100.0 * self._left_out / self._width:.2g}"
                " % of the range: the warnings give the frequencies."
            )
        return self

    def _go_on(self, branch: Branch[BalancePointT]) -> Branch[BalancePointT] | None:
        """The branch from a solution beyond the end of the curve so far; None if there is no solution."""
        ahead = [self._direction * each.point.trial.omega for each in self.points]
        furthest, last = int(np.argmax(ahead)), self.points[-1].point
        edge = self.points[furthest].point
        place = edge.trial.omega
        found, evidence, is_settled = self._way_on(
            lambda: self._beyond(place, (last, edge)),
            functools.partial(self._settling.evidence, last, self._direction * self._width),
            place,
        )
        why = self._sentences(branch.message, evidence, goes_on=is_settled)
        if found is None:
            self.message = self._with_limit(why)
            return None
        point, how = found
        onward = self._part(point, self._window[1])
        # From a motion before the edge the way to it is known: nothing to look for.
        is_before = (point.trial.omega - place) * self._direction < 0.0
        back = None if is_before else self._part(point, place)
        if back is not None and back.complete and _are_same(back.points[-1].point, edge):
            self.crossings.append(crossing_of([each.point for each in self.points[furthest:]], onward.points[0].point))
            del self.points[furthest + 1 :]
            self._append(back, reverse=True, first=1)
            return self._append(onward)
        gap = (place, place) if back is None else self._gap(place, back)
        words = f"has no points from {_hz(min(gap))} to {_hz(max(gap))} Hz, so a peak there is not known"
        if gap[0] == gap[1]:
            words = "jumps there to another motion"
        self.breaks.append(len(self.points) - 1)
        self.warnings.append(
            f"The curve is interrupted at {_hz(place)} Hz and {words}; it continues from a motion that was "
            f"found {how} at {_hz(point.trial.omega)} Hz. The reason: {why}"
        )
        if back is not None:
            self._append(back, reverse=True)
        return self._append(onward)

    def _way_on(
        self, own: Callable[[], Found | None], evidence_of: Callable[..., Evidence | None], edge: float
    ) -> tuple[Found | None, Evidence | None, bool]:
        """A motion from which the curve goes on, what happens there, and whether a time integration settled on it.

        ``own`` looks for one with the harmonics of the curve. With an accuracy the settled motion comes first. With a
        fixed number it is the last resort, because a part with more harmonics costs more. Without any, the evidence is
        thorough.
        """
        evidence = evidence_of(thorough=self._varies)
        settled = self._settled(evidence, edge) if self._varies else None
        found = settled or own()
        if found is None and not self._varies:
            evidence = evidence_of(thorough=True)
            found = settled = self._settled(evidence, edge)
        return found, evidence, settled is not None

    def _evidence_at_end(self) -> Evidence | None:
        """What happens where the curve ends."""
        return self._settling.evidence(self.points[-1].point, self._direction * self._width, thorough=True)

    def _gap(self, edge: float, back: Branch[BalancePointT]) -> tuple[float, float]:
        """The frequencies without points between ``edge`` and a branch that leads back to it."""
        first = min((each.point.trial.omega for each in back.points), key=lambda omega: self._direction * omega)
        if back.complete or (first - edge) * self._direction <= 0.0:
            return edge, edge
        self._left_out += abs(first - edge)
        return edge, first

    def _beyond(self, edge: float, near: Sequence[BalancePoint]) -> Found | None:
        """A solution beyond a frequency, and how it was found: at the nearest distance first."""
        for distance in DISTANCES:
            if self._settling.work.limit_words:
                return None
            omega = edge + self._direction * distance * self._width
            if (self._window[1] - omega) * self._direction < 0.0:
                return None
            found = self._settling.solution(near, omega, ramp=distance >= LEAST_RAMP)
            if found is not None:
                return found
        return None

    def _settled(self, evidence: Evidence | None, edge: float) -> Found | None:
        """Once, if parts may have any number of harmonics: the motion close to a frequency, or beyond it, to which a
        time integration settled, with as many as it requires."""
        motion = evidence.motion if evidence is not None and self._takes_settled else None
        if evidence is None or motion is None:
            return None
        if (motion.trial.omega - edge) * self._direction < -SHORT * self._width:
            return None
        if not self._varies:
            if evidence.settled.given_by == evidence.harmonics:
                return None  # no more harmonics help: the search beyond finds such a motion
            self._settling.work.extend()
            if self._settling.work.limit_words:
                return None
        self._takes_settled = not self._varies
        return motion, f"by a time integration, with {evidence.settled.given_by} harmonics,"

    def _sentences(self, reason: str, evidence: Evidence | None, goes_on: bool = False) -> str:
        """Why a curve was lost, and what happens there; ``goes_on`` from there with more harmonics."""
        if evidence is None:
            return reason
        return f"{reason} {evidence.words(self._varies or goes_on)}"

    def _with_limit(self, words: str) -> str:
        """Sentences, and that on the limit of the work where they lack it."""
        limit = self._settling.work.limit_words
        return f"{words} {limit}" if limit and limit not in words else words

    def _append(self, branch: Branch[BalancePointT], reverse: bool = False, first: int = 0) -> Branch[BalancePointT]:
        """Add a branch; in reverse without its start, which the branch in the other direction has, and after the
        ``first`` points."""
        self.points += branch.points[:0:-1][first:] if reverse else branch.points
        self.retreats += branch.retreats
        self.corners += branch.corners
        self.crossings += branch.crossings
        self.message = branch.message
        return branch


def _are_same(first: BalancePoint, second: BalancePoint) -> bool:
    """Whether two motions at one frequency agree."""
    rows = max(len(first.measured), len(second.measured))
    ours, theirs = (with_rows(each.measured, rows) for each in (first, second))
    return float(np.linalg.norm(ours - theirs)) <= SAME_MOTION * float(np.linalg.norm(theirs))


def _hz(omega: float) -> str:
    return f"{omega / (2.0 * math.pi):.3f}"
