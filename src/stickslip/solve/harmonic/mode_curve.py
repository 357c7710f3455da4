"""A nonlinear mode along its amplitude: ``M u'' + (C - xi M) u' + K u + B^T f(B u) = 0`` (extended periodic motion).

The balance of a forced response solves this equation too. In the first harmonic the inertia and the own damping of one
stuck mode r are on the right-hand side, as a load in the shape of this mode (docs/theory_modes.md):

    load = (w^2 - i w (c_r - xi)) q_r

Without this the compliance would be singular where the mode is linear. The load has the phase of the cosine: a free
vibration has no phase of its own. Source of the concept: M. Krack, "Nonlinear modal analysis of nonconservative
systems: extension of the periodic motion concept", Comput. Struct. 154 (2015) 59-71.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.curves import BalanceCurve, BalancePoint, LinearisedBalance, amplitude_row, plane_row
from stickslip.solve.harmonic.gain import SelfExcitation
from stickslip.solve.harmonic.reduced import EliminatedSystem, NewtonSystem, Row
from stickslip.solve.path.problem import Plane, Step

LN_10 = math.log(10.0)
# chosen: a change of the frequency by a twentieth counts as much in a step as a new shape. Where pairs begin to slip,
# the shape changes little, but frequency and damping do, and a figure must show it.
MEASURED_CHANGE = 20.0
# chosen: limits of the parameters of a trial, in decades and over the reference; a step of Newton's method beyond them
# has failed: numbers far beyond them would overflow, and with a negative frequency time runs backwards.
_HIGHEST, _LOWEST = np.array([100.0, 1e3, 1e6, 1e9]), np.array([-100.0, 1e-3, -1e6, -1e9])


@dataclass(frozen=True)
class ModePoint(BalancePoint):
    """A trial nonlinear mode.

    ``parameters`` are the decadic logarithm of the modal amplitude, the circular frequency (rad/s), xi (1/s) and the
    load over the product of modal amplitude and ``reference**2``; ``reference`` is a circular frequency (rad/s). In a
    linear mode only the first of them changes.
    """

    reference: float

    @property
    def modal_amplitude(self) -> float:
        """m kg^(1/2), mass norm of the first harmonic."""
        return amplitude_of(self.parameters)

    @property
    def measured(self) -> FloatArray:
        """The shape of the motion, its frequency and its damping, which are constant in a linear mode."""
        shape = self.trial.amplitude.ravel() / self.modal_amplitude
        change = self.parameters[1:3] / self.reference - np.array([1.0, 0.0])  # from the linear mode
        return np.concatenate([shape, MEASURED_CHANGE * change])


def amplitude_of(parameters: FloatArray) -> float:
    """The modal amplitude of the parameters of a point."""
    return float(10.0 ** parameters[0])


@dataclass(frozen=True)
class _Condition:
    """A condition: its value, and its derivatives by the modal amplitudes (2H, n) and by the parameters (4,)."""

    value: float
    weights: FloatArray
    parameters: FloatArray


class ModeCurve(BalanceCurve):
    """The nonlinear mode along the decadic logarithm of the modal amplitude.

    ``balance`` has the force ``M phi_r cos(w t)`` of a stuck mode: index ``mode``, damping ``mode_damping`` (1/s).
    ``reference`` (rad/s) is the scale of frequencies.
    """

    def __init__(self, balance: Balance, mode: int, mode_damping: float, reference: float) -> None:
        super().__init__(balance)
        self._mode, self._mode_damping, self._reference = mode, mode_damping, reference

    def with_balance(self, balance: Balance) -> ModeCurve:
        """The same mode with another balance of the structure."""
        return ModeCurve(balance, self._mode, self._mode_damping, self._reference)

    def sustained(self, growth: float, balance: Balance | None = None) -> Balance:
        """The balance, or another one of the same structure, with the damping ``-growth M``."""
        return (balance or self.balance).excited(SelfExcitation(growth, self._mode))

    def at(self, motion: FloatArray, omega: float, growth: float) -> ModePoint:
        """The point with the shape of ``motion`` (n,), modal amplitudes of the stuck modes that move in phase.

        Its phase makes the load a cosine.
        """
        size = float(np.linalg.norm(motion))
        own = motion[self._mode] / size
        turn = math.atan2(self._mode_damping - growth, omega)
        relative = np.zeros((2 * self.balance.harmonics + 1, self.balance.rows))
        shape = self.balance.compliance.relative_of(motion)
        relative[1], relative[2] = math.cos(turn) * shape, -math.sin(turn) * shape
        load = omega * math.hypot(omega, self._mode_damping - growth) * own / self._reference**2
        return self.evaluate(relative, np.array([math.log10(size), omega, growth, load]))

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> ModePoint:
        scale = np.array([1.0, self._reference, self._reference, 1.0])
        inside = np.clip(parameters, scale * _LOWEST, scale * _HIGHEST)
        _, omega, growth, load = map(float, inside)
        size = amplitude_of(inside)
        trial = self.sustained(growth).evaluate(unknowns, omega, size * self._reference**2 * load)
        values = np.array([each.value for each in self._conditions(trial, inside)])
        error = max(trial.error, float(np.abs(values).max())) if (inside == parameters).all() else math.inf
        return ModePoint(trial, inside, values, error, self._reference)

    def _conditions(self, trial: Trial, parameters: FloatArray) -> Sequence[_Condition]:
        """The load of the mode, both parts, and the modal amplitude."""
        omega, size = trial.omega, amplitude_of(parameters)
        scale = 1.0 / (size * self._reference**2)
        damping = self._mode_damping - trial.growth
        cosine, sine = (float(each) for each in trial.amplitude[:2, self._mode])
        in_phase = scale * (omega**2 * cosine - omega * damping * sine)
        across = scale * (omega**2 * sine + omega * damping * cosine)
        load, quadrature, amplitude = (np.zeros_like(trial.amplitude) for _ in range(3))
        load[:2, self._mode] = -scale * omega**2, scale * omega * damping
        quadrature[:2, self._mode] = scale * omega * damping, scale * omega**2
        first = trial.amplitude[:2]
        norm = max(float(np.linalg.norm(first)), 1e-300)
        amplitude[:2] = first / (norm * size)
        by_omega = 2.0 * omega * cosine - damping * sine, 2.0 * omega * sine + damping * cosine
        return (
            _Condition(
                float(parameters[3]) - in_phase,
                load,
                np.array([LN_10 * in_phase, -scale * by_omega[0], -scale * omega * sine, 1.0]),
            ),
            _Condition(
                across,
                quadrature,
                np.array([-LN_10 * across, scale * by_omega[1], -scale * omega * cosine, 0.0]),
            ),
            _Condition(norm / size - 1.0, amplitude, np.array([-LN_10 * norm / size, 0.0, 0.0, 0.0])),
        )

    def _amplitude_slopes(self, balance: Balance, trial: Trial, parameters: FloatArray) -> list[FloatArray]:
        """Derivatives (2H, n) of the modal amplitudes by the parameters, at fixed deviation."""
        by_load = balance.load_amplitude(trial.omega)
        return [
            LN_10 * trial.load * by_load,
            balance.amplitude_slope(trial),
            balance.growth_amplitude(trial),
            amplitude_of(parameters) * self._reference**2 * by_load,
        ]

    def linearised(self, point: ModePoint, plane: Plane | None) -> LinearisedBalance:
        trial, balance = point.trial, self.sustained(point.trial.growth)
        slopes = self._amplitude_slopes(balance, trial, point.parameters)
        rows = []
        for each in self._conditions(trial, point.parameters):
            row = amplitude_row(balance, trial, each.weights, slopes)
            rows.append(Row(row.parameters + each.parameters, deviation=row.deviation))
        rows.append(plane_row(plane, len(slopes)))
        by_parameters = [balance.residual_slope(slope) for slope in slopes]
        system = EliminatedSystem(NewtonSystem(balance, trial), by_parameters, rows, self._last_factor)
        return LinearisedBalance(system)

    def measured_change(self, point: ModePoint, step: Step) -> FloatArray:
        trial, balance = point.trial, self.sustained(point.trial.growth)
        change = balance.compliance.amplitude(trial.omega, None, step.detail)
        for slope, by in zip(self._amplitude_slopes(balance, trial, point.parameters), step.parameters, strict=True):
            change += float(by) * slope
        shape = (change - LN_10 * float(step.parameters[0]) * trial.amplitude) / point.modal_amplitude
        return np.concatenate([shape.ravel(), MEASURED_CHANGE * step.parameters[1:3] / self._reference])

    def named(self, parameter: float) -> str:
        return f"a modal amplitude of {10.0**parameter:.3g} m kg^0.5"
