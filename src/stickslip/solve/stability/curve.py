"""Stability along a curve: multipliers of every point, verdicts, and where they change.

The multipliers have an error by sampling, which matters only near the unit circle. There a point is computed again with
more samples. Where a real multiplier is too close to 1, the verdict is that of the same side of the fold, because a
curve turns in frequency exactly where a multiplier is 1. The error by harmonics has no such bound: some points are
corrected with more harmonics, and a verdict is doubtful if the multipliers of the corrected motion contradict it, or if
they moved too far for a verdict and twice the harmonics again do not settle them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import BoolArray, IndexArray
from stickslip.core.fourier import with_rows
from stickslip.core.threads import in_shares
from stickslip.core.validation import FloatArray
from stickslip.results.stability import Bifurcation, BifurcationKind
from stickslip.solve.harmonic.balance import Trial
from stickslip.solve.harmonic.compliance import StuckStructure
from stickslip.solve.stability.contact_steps import laws_without_steps
from stickslip.solve.stability.disturbances import ComplexArray, is_real, stuck_multipliers
from stickslip.solve.stability.folds import (
    NEAR_FOLD,
    Fold,
    beside_folds_without_change,
    doubtful_range,
    fold_at,
    folds_of,
    sided_counts,
)
from stickslip.solve.stability.model import StabilityModel, stability_model
from stickslip.solve.stability.more_harmonics import Correction, unconfirmed_points
from stickslip.solve.stability.multipliers import BARELY, PointMultipliers
from stickslip.solve.stability.verdict import ROUND_OFF, Counts, Verdict, distances_to

# Samples of the period, and for each harmonic, at first; near the unit circle up to FINEST times as many.
FIRST_SAMPLES, SAMPLES_PER_HARMONIC, FINEST = 128, 16, 4
# What contact changes of a multiplier has this relative error with the first samples, and no more than the second
# number: 97 of 100 multipliers above 0.9 of the benchmark blades and the default two-blade case, against four times the
# samples.
FIRST_ERROR, LARGEST_ERROR = 0.15, 0.01
# How often more harmonics may confirm the verdict of a point.
MOST_CORRECTIONS = 3
# Number of multipliers of each point in a result.
STORED = 4


@dataclass(frozen=True)
class CurveStability:
    """The stability of n points.

    Attributes
    ----------
    stable:
        (n,).
    multipliers:
        (n, STORED), the largest first; 0 where there are fewer.
    bifurcations:
        in the order of the curve.
    undecided:
        (n,) points with a multiplier closer to the unit circle than its error, so that the verdict is that of its
        computed size. For real ones near 1 folds decide; such a point counts if they contradict its multipliers. Also
        points with multipliers inside of the circle that a disturbance away from a touched limit, or one that is larger
        than the slip of pairs, may leave; points beside folds at which no multiplier passes 1; and stable points
        whose pairs touch their limits, or nearly so, if such a point or an unstable one is within BARELY of their
        motion.
    unconfirmed:
        (n,) points at which the motion corrected with more harmonics has another verdict, multipliers that more
        harmonics still move as far as the circle, or is not known.
    error_at_folds:
        largest distance from 1 of the multiplier at a fold where the stability changes; a large one says that the
        harmonics are too few.
    """

    stable: BoolArray
    multipliers: ComplexArray
    bifurcations: tuple[Bifurcation, ...]
    undecided: BoolArray
    unconfirmed: BoolArray
    error_at_folds: float

    @property
    def doubtful(self) -> BoolArray:
        """(n,) points whose verdict is doubtful for one of both reasons."""
        return np.asarray(self.undecided | self.unconfirmed)

    @classmethod
    def joined(cls, parts: Sequence[CurveStability]) -> CurveStability:
        """That of parts of a curve, one after the other."""
        firsts = np.cumsum([0, *(part.stable.size for part in parts)]).tolist()
        return cls(
            np.concatenate([part.stable for part in parts]),
            np.concatenate([part.multipliers for part in parts]),
            tuple(
                replace(each, position=each.position + first)
                for first, part in zip(firsts, parts, strict=False)
                for each in part.bifurcations
            ),
            np.concatenate([part.undecided for part in parts]),
            np.concatenate([part.unconfirmed for part in parts]),
            max(part.error_at_folds for part in parts),
        )


def reason_without(pairs: ContactPairs) -> str:
    """Why the stability of a joint is not computed, as a sentence; empty if it is."""
    names = laws_without_steps(pairs)
    if not names:
        return ""
    return (
        f"Stability was not computed: the law {' and '.join(names)} does not give the derivatives of its steps "
        "(linear_steps, docs/extending.md)."
    )


def curve_stability(
    trials: Sequence[Trial],
    pairs: ContactPairs,
    stuck: StuckStructure,
    correction: Correction | None = None,
) -> CurveStability:
    """The stability of points in the order of a curve along which the force is constant.

    The laws must give their steps (:func:`reason_without`). ``correction`` gives points with more harmonics, by which
    verdicts are confirmed (:func:`stickslip.solve.stability.more_harmonics.correction_of`); without it none is
    ``unconfirmed``.
    """
    verdicts = _verdicts(pairs, stuck, trials)
    counts = [verdict.counts() for verdict in verdicts]
    omega = np.array([trial.omega for trial in trials])
    folds = folds_of(omega, [verdict.values for verdict in verdicts])
    distances = [doubtful_range(point, folds) for point in range(len(trials))]
    possible = [verdict.possible(distance) for verdict, distance in zip(verdicts, distances, strict=True)]
    near_one = [
        verdict.near_one(NEAR_FOLD) or verdict.has_pair_near_one(distance)
        for verdict, distance in zip(verdicts, distances, strict=True)
    ]
    positive = sided_counts([each.positive for each in counts], possible, near_one, folds)
    alone = [any(each) for each in counts]
    counts = [each._replace(positive=number) for each, number in zip(counts, positive, strict=True)]
    unsure = [verdict.undecided or own != any(each) for verdict, own, each in zip(verdicts, alone, counts, strict=True)]
    stable = np.array([not any(each) for each in counts])
    held = np.array([verdict.is_held_by_limits for verdict in verdicts]) & stable
    unexplained = beside_folds_without_change(positive, stable, folds)
    others = np.flatnonzero(~stable | unexplained)
    reach = [bool(each) and _reaches(trials, others, point) for point, each in enumerate(held)]

    def confirms(points: Sequence[int]) -> list[bool]:
        assert correction is not None
        limits = {point: (bool(stable[point]), distances[point]) for point in points}
        confirmed = _confirmed(pairs, stuck, trials, limits, correction)
        return [point in confirmed for point in points]

    unconfirmed = np.zeros(stable.size, dtype=bool)
    if correction is not None:
        moving = np.array([bool(trial.contact.moves.any()) for trial in trials])
        unconfirmed = unconfirmed_points(stable, moving, confirms)
    table = np.zeros((len(trials), STORED), dtype=complex)
    for row, verdict in zip(table, verdicts, strict=True):
        row[: verdict.values.size] = verdict.values[:STORED]
    return CurveStability(
        stable,
        table,
        tuple(_changes(verdicts, counts, omega / (2.0 * np.pi), folds)),
        np.array(unsure) | unexplained | reach,
        unconfirmed,
        max((fold.error for fold in folds if _changes_at(fold, positive)), default=0.0),
    )


def _reaches(trials: Sequence[Trial], others: IndexArray, point: int) -> bool:
    """Whether the nearest of ``others`` on the curve, on either side, is within BARELY of the motion of a point whose
    pairs hold a disturbance at their limits: one of this size makes them slip as they do there."""
    place = int(np.searchsorted(others, point))
    here = trials[point].relative[1:]
    size = BARELY * float(np.linalg.norm(here))
    for other in others[max(place - 1, 0) : place + 1]:
        there = with_rows(trials[int(other)].relative[1:], len(here))
        if float(np.linalg.norm(there - here)) <= size:
            return True
    return False


def _confirmed(
    pairs: ContactPairs,
    stuck: StuckStructure,
    trials: Sequence[Trial],
    limits: Mapping[int, tuple[bool, float]],
    correction: Correction,
) -> set[int]:
    """The points whose verdicts more harmonics confirm. ``limits`` are their verdicts and the distances from 1 up to
    which real multipliers do not decide."""
    confirmed: set[int] = set()
    motions = {point: trials[point] for point in limits}
    for _ in range(MOST_CORRECTIONS):
        finer = {point: trial for point, each in motions.items() if (trial := correction(point, each)) is not None}
        # One model for both motions: with more harmonics more modes have inertia, and with them multipliers.
        both = _verdicts(pairs, stuck, [*finer.values(), *(motions[point] for point in finer)])
        motions = {}
        for point, verdict, before in zip(finer, both, both[len(finer) :], strict=False):
            if not verdict.confirms(*limits[point]):
                continue
            if verdict.moved_from(before).settles(limits[point][0]):
                confirmed.add(point)
            else:
                motions[point] = finer[point]
        if not motions:
            break
    return confirmed


def _harmonics(trial: Trial) -> int:
    """Number of harmonics of a solution."""
    return len(trial.relative) // 2


def _verdicts(pairs: ContactPairs, stuck: StuckStructure, trials: Sequence[Trial]) -> list[Verdict]:
    """The verdict of each point; the points are shared among threads."""
    if not trials:
        return []
    moves = np.any([trial.contact.moves for trial in trials], axis=0)
    hidden = np.max([pairs.hidden_springs(trial.contact) for trial in trials], axis=0)
    model = stability_model(stuck, max(_harmonics(trial) for trial in trials), moves, hidden)
    verdicts: dict[int, Verdict] = {}

    def judge(start: int, stop: int) -> None:
        for point in range(start, stop):
            verdicts[point] = _verdict(model, pairs, trials[point])

    in_shares(judge, len(trials), 1)
    return [verdicts[point] for point in range(len(trials))]


def _verdict(model: StabilityModel, pairs: ContactPairs, trial: Trial) -> Verdict:
    """The multipliers of a point with as many samples as its verdict requires."""
    stuck = stuck_multipliers(model, trial.omega)
    if not trial.contact.moves.any():
        return Verdict(stuck, np.full(stuck.size, ROUND_OFF))
    first = max(FIRST_SAMPLES, SAMPLES_PER_HARMONIC * _harmonics(trial))
    point = PointMultipliers(model, pairs, trial, first)
    verdict = Verdict(point.values, _first_errors(point.values, stuck))
    # A pair or a negative multiplier outside of the circle has no fold that confirms it.
    counts, samples = verdict.counts(), first
    confirmed = verdict.is_surely_unstable or not (counts.negative or counts.complex)
    while samples < FINEST * first and (verdict.undecided or not confirmed):
        samples, confirmed = 2 * samples, True
        point = PointMultipliers(model, pairs, trial, samples)
        verdict = Verdict(point.values, np.maximum(distances_to(point.values, verdict.values), ROUND_OFF))
    counts = verdict.counts()
    if any(counts):
        to_one_side_alone = counts.positive and not (counts.negative or counts.complex)
        return replace(verdict, in_doubt=bool(to_one_side_alone and point.grows_in_doubt()))
    others, in_doubt = point.growing_otherwise()
    verdict = verdict.with_others(others, _first_errors(others, stuck))
    is_held = point.is_held_by_touches or point.nearly_touches
    return replace(verdict, in_doubt=in_doubt, is_held_by_limits=is_held)


def _first_errors(values: ComplexArray, stuck: ComplexArray) -> FloatArray:
    """Errors of multipliers that are known for one number of samples, from what contact changes of them."""
    return np.maximum(np.minimum(FIRST_ERROR * distances_to(values, stuck), LARGEST_ERROR), ROUND_OFF)


def _changes_at(fold: Fold, positive: Sequence[int]) -> bool:
    """Whether the number of real multipliers above 1 differs beside a fold."""
    before = int(fold.position)
    return positive[before] != positive[before + 1]


def _changes(
    verdicts: Sequence[Verdict], counts: Sequence[Counts], hertz: FloatArray, folds: Sequence[Fold]
) -> list[Bifurcation]:
    """The bifurcations between points whose counts differ."""
    found = []
    for point in range(len(counts) - 1):
        for place, kind in enumerate(("fold", "period doubling", "torus")):
            if counts[point][place] != counts[point + 1][place]:
                found.append(_bifurcation(kind, point, verdicts, hertz, folds))  # type: ignore[arg-type]
    return found


def _bifurcation(
    kind: BifurcationKind, point: int, verdicts: Sequence[Verdict], hertz: FloatArray, folds: Sequence[Fold]
) -> Bifurcation:
    """The bifurcation between a point and the next one."""
    if kind == "fold":
        fold = fold_at(point, folds)
        if fold is not None:
            return Bifurcation("fold", fold.omega / (2.0 * np.pi), fold.position)
        kind = "branch point"
    sizes = [float(_crossing_size(verdict.values, kind)) - 1.0 for verdict in verdicts[point : point + 2]]
    span = sizes[1] - sizes[0]
    fraction = float(np.clip(-sizes[0] / span, 0.0, 1.0)) if span else 0.5
    return Bifurcation(kind, float(hertz[point] + fraction * (hertz[point + 1] - hertz[point])), point + fraction)


def _crossing_size(values: ComplexArray, kind: BifurcationKind) -> float:
    """The largest size of the multipliers that cross in a bifurcation of a kind."""
    real = is_real(values)
    chosen = {"period doubling": real & (values.real < 0.0), "torus": ~real}.get(kind, real & (values.real > 0.0))
    return float(np.abs(values[chosen]).max(initial=0.0))
