"""The error of a point by the harmonics that it neglects, from one linearised correction with more harmonics.

The point is evaluated with more harmonics, and Newton's equations are solved once with the tangent of the contact in
all of them: what the neglected harmonics of the force move, what their motion changes in the others, and how slip
limits it. (The residual of the neglected harmonics alone is no estimate: it is the motion of the structure with all
contacts stuck, whose high modes may have a resonance there, and no damping.)

The error is the distance between the point and the curve with more harmonics: the change of the motion of the structure
over that motion (mass norm), and the change of the frequency over the half-power half-width ``zeta w`` of a resonance
with the equivalent damping ratio ``zeta`` of the point. On a smooth resonance this is nearly the change at the same
frequency; at a fold, where that has no bound, it stays finite.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.core.fourier import with_rows
from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.curves import FrequencyCurve
from stickslip.solve.path.problem import Plane, Step

# The estimate takes account of twice the harmonics, and at least this number more: two odd and two even ones.
LEAST_MORE = 4
# chosen: factor for harmonics beyond these and for the linearisation. Without it the estimate is 0.5 to 1.1 of the true
# error in 9 of 10 points (benchmarks/accuracy.py).
MARGIN = 1.5
# Relative accuracy of the linear solution; an estimate needs no more.
TOLERANCE = 1e-3
# Floor of the half-width of a resonance without damping, over its frequency.
LEAST_HALF_WIDTH = 1e-6


@dataclass(frozen=True)
class Neglected:
    """What the neglected harmonics would change at a point.

    error:
        distance to the curve with more harmonics, relative.
    step:
        the correction: relative displacements (2H+1, m) with more harmonics, and the frequency.
    """

    error: float
    step: Step

    def tail(self, relative: FloatArray, harmonics: int) -> float:
        """Norm of the relative displacements in the harmonics above ``harmonics``, of a point (2H+1, m) and its
        correction."""
        first = 2 * harmonics + 1
        corrected = self.step.unknowns.copy()
        corrected[: len(relative)] += relative
        return float(np.linalg.norm(corrected[first:]))


@dataclass(frozen=True)
class CurveAccuracy:
    """What a curve of varying harmonics has: the wanted accuracy, and harmonics and errors of its points."""

    accuracy: float
    harmonics: NDArray[np.int64]  # (n_points,)
    errors: FloatArray  # (n_points,) estimated, relative


def more_harmonics(harmonics: int, samples: int) -> int:
    """The number of harmonics of an estimate; ``samples`` of a period resolve no more than their half."""
    return min(harmonics + max(harmonics, LEAST_MORE), (samples - 1) // 2)


def resized_plane(plane: Plane, rows: int) -> Plane:
    """The same plane among unknowns with another number of harmonics."""
    return Plane(
        with_rows(plane.weights, rows),
        plane.parameter_weight,
        with_rows(plane.unknowns_target, rows),
        plane.parameter_target,
    )


def plane_across(before: Trial, trial: Trial, after: Trial) -> Plane:
    """The plane through a trial across the chord of its neighbours on a curve, with the harmonics of the trial."""
    rows = len(trial.relative)
    chord = with_rows(after.relative, rows) - with_rows(before.relative, rows)
    rise = after.omega - before.omega
    size, reach = max(float(np.linalg.norm(chord)), 1e-150), max(abs(rise), LEAST_HALF_WIDTH * trial.omega)
    return Plane(chord / size**2, rise / reach**2, trial.relative, trial.omega)


def rough_error(trial: Trial, fine: Balance) -> float:
    """Motion by the neglected harmonics of the contact force of a trial alone, over its motion."""
    widened = fine.evaluate(with_rows(trial.relative, 2 * fine.harmonics + 1), trial.omega, trial.load)
    return _relative(widened.amplitude[len(trial.amplitude) :], trial.amplitude)


def neglected(trial: Trial, own: Balance, fine: Balance, plane: Plane) -> Neglected:
    """The estimate for a trial of the balance ``own``, with the harmonics of ``fine``.

    ``plane`` goes through the trial, across the curve. The error is infinite where the equations are singular.
    """
    rows = 2 * fine.harmonics + 1
    curve = FrequencyCurve(fine, trial.load)
    start = curve.at(with_rows(trial.relative, rows), trial.omega)
    system = curve.linearised(start, resized_plane(plane, rows))
    step = system.solve(start.residual, start.conditions, 0.0, TOLERANCE)
    along = system.solve(np.zeros_like(start.residual), start.conditions, -1.0, TOLERANCE)
    if not (np.isfinite(step.unknowns).all() and np.isfinite(along.unknowns).all()):
        return Neglected(np.inf, step)
    change = start.measured - with_rows(trial.amplitude, rows - 1) + curve.measured_change(start, step)
    slope = curve.measured_change(start, along)
    half_width = max(damping_ratio(trial, own), LEAST_HALF_WIDTH) * trial.omega
    size = max(float(np.linalg.norm(trial.amplitude)), 1e-300)

    def scaled(motion: FloatArray, omega: float) -> FloatArray:
        return np.append(motion.ravel() / size, omega / half_width)

    away, direction = scaled(change, float(step.parameters[0])), scaled(slope, float(along.parameters[0]))
    direction /= max(float(np.linalg.norm(direction)), 1e-300)
    across = away - float(away @ direction) * direction
    return Neglected(MARGIN * float(np.linalg.norm(across)), step)


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


def _relative(part: FloatArray, whole: FloatArray) -> float:
    size = float(np.linalg.norm(part))
    return size / max(float(np.linalg.norm(whole)), 1e-300) if size > 0.0 else 0.0
