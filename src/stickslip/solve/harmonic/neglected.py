"""The error of a point by the harmonics that it neglects, from one step of Newton's method with more harmonics.

The point is evaluated with more harmonics, and Newton's equations are solved, usually once and to few digits, with the
tangent of the contact in all of them: what the neglected harmonics of the force move, what their motion changes in the
others, and how slip limits it. Where the steps stop with much of the residual left, the estimate is at least the first
one, which the tangent alone determines. (The residual of the neglected harmonics alone is not an estimate: it is the
motion of the structure with all contacts stuck, whose high modes may have a resonance there, and no damping.)

The error is the distance between the point and the curve with more harmonics, up to a shift in time: the change of the
motion of the structure over that motion (mass norm), and the change of the frequency over the half-power width ``2 zeta
w`` of a resonance with the equivalent damping ratio ``zeta`` of the point. On the sides of a resonance this is nearly
the relative change of the amplitude at the same frequency; at a fold, where that has no bound, it stays finite. The
phase against the force does not count: it changes by 90 degrees over the half-power width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.path.arc_length import Tangent
from stickslip.solve.path.newton import Newton, NewtonSettings
from stickslip.solve.path.problem import Plane, Step

# The estimate takes account of twice the harmonics, and at least this number more: two odd and two even ones.
LEAST_MORE = 4
# chosen: factor for harmonics beyond these and for the linearisation. Without it the estimate is 0.5 to 1.1 of the true
# error in 9 of 10 points (benchmarks/accuracy.py).
MARGIN = 1.5
# Relative accuracy of the linear solution of a step; an estimate needs no more.
TOLERANCE = 2e-2
# chosen: a step that leaves less than this fraction of the residual is enough; usually that is the first one. Contact
# that changes its state within the step requires more, at most this number.
ENOUGH, MOST_STEPS = 0.2, 6
# The estimate where the equations are singular: the whole motion.
UNKNOWN = 1.0
# A residual below that of converged points (NewtonSettings) is round-off, which no step lowers.
ROUND_OFF = 1e-8
# Floor of the width of a resonance without damping, over its frequency.
LEAST_WIDTH = 1e-6


@dataclass(frozen=True)
class Neglected:
    """The change of a point by the neglected harmonics.

    error:
        distance to the curve with more harmonics, relative.
    step:
        the correction: relative displacements (2H+1, m) with more harmonics, and the frequency; None where the
        equations are singular.
    """

    error: float
    step: Step | None

    def tail(self, relative: FloatArray, harmonics: int) -> float:
        """Norm of the relative displacements in the harmonics above ``harmonics``, of a point (2H+1, m) and its
        correction."""
        if self.step is None:
            return 0.0
        first = 2 * harmonics + 1
        corrected = self.step.unknowns.copy()
        corrected[: len(relative)] += relative
        return float(np.linalg.norm(corrected[first:]))


@dataclass(frozen=True)
class CurveAccuracy:
    """What a curve of varying harmonics has: the wanted accuracy, and harmonics and errors of its points.

    ``limited`` is True if some point has fewer harmonics than it requires, because more of them are too much work.
    """

    accuracy: float
    harmonics: NDArray[np.int64]  # (n_points,)
    errors: FloatArray  # (n_points,) estimated, relative
    at_peak: float  # that of the point with the largest motion
    limited: bool = False

    def words(self) -> str:
        """For the provenance."""
        return (
            f"{100.0 * self.accuracy:g} %, up to {self.harmonics.max()} harmonics, estimated error of the peak "
            f"{100.0 * self.at_peak:.2g} %"
        )


def more_harmonics(harmonics: int, samples: int, damped: int | None = None) -> int:
    """The number of harmonics of an estimate; ``samples`` of a period resolve no more than their half.

    Harmonics above those that are ``damped``, if given, meet modes without damping: their resonances, which are
    properties of the model and not of the structure, are omitted.
    """
    more = harmonics + max(harmonics, LEAST_MORE)
    if damped is not None:
        more = min(more, max(damped, harmonics + LEAST_MORE))
    return min(more, (samples - 1) // 2)


def resized_plane(plane: Plane, rows: int) -> Plane:
    """The same plane among unknowns with another number of harmonics."""
    return Plane(
        with_rows(plane.weights, rows),
        plane.parameter_weight,
        with_rows(plane.unknowns_target, rows),
        plane.parameter_target,
    )


def plane_across(trial: Trial, own: Balance, along: Tangent) -> Plane:
    """The plane through a trial of the balance ``own`` across a direction of its curve, with the harmonics of the
    trial.

    Displacements and frequency have the scales of :func:`distance`: beside a fold, where the direction has almost no
    change of the frequency, the plane lets the frequency vary.
    """
    normal = own.determined(with_rows(along.unknowns, len(trial.relative)))
    size = max(float(np.linalg.norm(own.determined(trial.relative))), 1e-150)
    return Plane(normal / size**2, along.parameter / _width(trial, own) ** 2, trial.relative, trial.omega)


def chord_of(before: Trial, after: Trial) -> Tangent:
    """The direction from one trial of a curve to another one."""
    rows = max(len(before.relative), len(after.relative))
    return Tangent(
        with_rows(after.relative, rows) - with_rows(before.relative, rows),
        with_rows(after.amplitude, rows - 1) - with_rows(before.amplitude, rows - 1),
        np.array([after.omega - before.omega]),
    )


def neglected(trial: Trial, own: Balance, fine: Balance, along: Tangent, last: LastFactor | None = None) -> Neglected:
    """The estimate for a trial of the balance ``own``, with the harmonics of ``fine``.

    ``along`` is the direction of the curve at the trial, ``last`` a factor for large systems. The error is UNKNOWN
    where the equations are singular.
    """
    rows = 2 * fine.harmonics + 1
    curve, plane = FrequencyCurve(fine, trial.load, last), resized_plane(plane_across(trial, own, along), rows)
    start = curve.at(with_rows(trial.relative, rows), trial.omega)
    point = _FewDigits.corrected(curve, start, plane)
    ahead = with_rows(along.measured, rows - 1), along.parameter
    away = point.measured - with_rows(trial.amplitude, rows - 1), point.trial.omega - trial.omega
    error = distance(trial, own, away, ahead)
    if point.error > max(ENOUGH * start.error, ROUND_OFF):
        first = curve.linearised(start, plane).solve(start.residual, start.conditions, 0.0, TOLERANCE)
        if not (np.isfinite(first.unknowns).all() and np.isfinite(first.parameters).all()):
            return Neglected(UNKNOWN, None)
        straight = curve.measured_change(start, first), float(first.parameters[0])
        error = max(error, distance(trial, own, straight, ahead))
    return Neglected(MARGIN * error, Step(point.unknowns - start.unknowns, point.parameters - start.parameters))


class _FewDigits(Newton[BalancePoint]):
    """Newton's method with steps of few digits, until a fraction of the residual is left."""

    @classmethod
    def corrected(cls, curve: FrequencyCurve, start: BalancePoint, plane: Plane) -> BalancePoint:
        """A point on the plane that has only a fraction of the residual of ``start``, or the best one."""
        enough = max(ENOUGH * start.error, ROUND_OFF)
        settings = NewtonSettings(tolerance=enough, max_iterations=MOST_STEPS, round_off_factor=1.0)
        return cls(curve, settings).correct(start, plane).point

    def _step_tolerance(self, error: float, sharper: float) -> float:
        return TOLERANCE


def distance(trial: Trial, own: Balance, away: tuple[FloatArray, float], along: tuple[FloatArray, float]) -> float:
    """The distance of a trial of the balance ``own`` to a curve, relative.

    ``away`` leads to a point of the curve, ``along`` is the direction of the curve there: changes of the modal
    amplitudes (2H, n), with any number of harmonics, and of the circular frequency.
    """
    width = _width(trial, own)
    size = max(float(np.linalg.norm(trial.amplitude)), 1e-300)

    def scaled(motion: FloatArray, omega: float) -> FloatArray:
        return np.append(motion.ravel() / size, omega / width)

    later = with_rows(_later(trial.amplitude), len(away[0]))
    directions = np.linalg.qr(np.column_stack([scaled(*along), scaled(later, 0.0)])).Q
    straight = scaled(*away)
    return float(np.linalg.norm(straight - directions @ (directions.T @ straight)))


def _width(trial: Trial, own: Balance) -> float:
    """Half-power width in rad/s of a resonance with the equivalent damping of a trial."""
    return max(2.0 * damping_ratio(trial, own), LEAST_WIDTH) * trial.omega


def _later(amplitude: FloatArray) -> FloatArray:
    """Derivative (2H, n) of coefficients by the phase of the first harmonic."""
    order = np.arange(1, len(amplitude) // 2 + 1)[:, None]
    shifted = np.empty_like(amplitude)
    shifted[0::2], shifted[1::2] = order * amplitude[1::2], -order * amplitude[0::2]
    return shifted


def damping_ratio(trial: Trial, balance: Balance) -> float:
    """Equivalent viscous damping ratio ``W / (4 pi E)`` of a trial.

    ``W`` is the work of the force per cycle, ``E = w^2 |q_1|^2 / 2`` twice the mean kinetic energy of the first
    harmonic.
    """
    force, amplitude = balance.modal_force(trial), trial.amplitude
    order = np.arange(1, balance.harmonics + 1)[:, None]
    work = np.pi * float((order * (amplitude[1::2] * force[0::2] - amplitude[0::2] * force[1::2])).sum())
    energy = 0.5 * trial.omega**2 * float((amplitude[:2] ** 2).sum())
    return work / (4.0 * np.pi * energy) if energy > 0.0 else 0.0
