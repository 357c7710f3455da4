"""Curves of a balance: their parameters and conditions.

Each class is one problem (:mod:`stickslip.solve.path.problem`) with the balance ``R(x, w, load) = 0``: the circular
frequency ``w`` in rad/s and the load, a factor of the external force, are fixed, free, or follow from a condition.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.solve.harmonic.balance import Balance, Trial
from stickslip.solve.harmonic.factors import LastFactor
from stickslip.solve.harmonic.reduced import BorderedSystem, NewtonSystem, Row
from stickslip.solve.path.problem import NO_PARAMETERS, Plane, Step
from stickslip.solve.path.work import Work

Control = Literal["amplitude", "phase"]


@dataclass(frozen=True)
class BalancePoint:
    """A trial solution of the balance as a point of a curve."""

    trial: Trial
    parameters: FloatArray
    conditions: FloatArray
    error: float

    @property
    def unknowns(self) -> FloatArray:
        """(2H+1, m) relative displacements."""
        return self.trial.relative

    @property
    def residual(self) -> FloatArray:
        """(2H+1, m) m."""
        return self.trial.residual

    @property
    def measured(self) -> FloatArray:
        """(2H, n) modal amplitudes, whose norm is the mass norm of the vibration."""
        return self.trial.amplitude


BalancePointT = TypeVar("BalancePointT", bound=BalancePoint)


class LinearisedBalance:
    """A bordered Newton system whose last row is the plane of the path, after those of the conditions."""

    def __init__(self, system: BorderedSystem) -> None:
        self._system = system

    def solve(self, residual: FloatArray, conditions: FloatArray, plane: float, tolerance: float) -> Step:
        return self._system.solve(residual, np.append(-conditions, -plane), tolerance)


def plane_row(plane: Plane | None, count: int) -> Row:
    """The row of a plane among ``count`` parameters."""
    assert plane is not None  # these problems have parameters, so a correction needs a plane
    parameters = np.zeros(count)
    parameters[0] = plane.parameter_weight
    return Row(parameters, relative=plane.weights)


def amplitude_row(balance: Balance, trial: Trial, weights: FloatArray, by_parameters: Sequence[FloatArray]) -> Row:
    """The row of a condition with the derivative ``weights`` (2H, n) by the modal amplitudes.

    ``by_parameters`` are the derivatives (2H, n) of the amplitudes by each parameter, at fixed deviation.
    """
    parameters = np.array([float((weights * slope).sum()) for slope in by_parameters])
    return Row(parameters, deviation=balance.compliance.amplitude_transposed(trial.omega, weights))


class BalanceCurve:
    """Common parts of all curves of a balance."""

    def __init__(self, balance: Balance, last: LastFactor | None = None) -> None:
        self.balance = balance
        self._last_factor = last or LastFactor()

    def determined(self, unknowns: FloatArray) -> FloatArray:
        """The relative displacements that some contact force depends on."""
        return self.balance.determined(unknowns)

    def _amplitude_change(self, trial: Trial, deviation: FloatArray, omega: float, load: float) -> FloatArray:
        """Change (2H, n) of the modal amplitudes."""
        change = self.balance.compliance.amplitude(trial.omega, None, deviation)
        if omega:
            change += omega * self.balance.amplitude_slope(trial)
        if load:
            change += load * self.balance.load_amplitude(trial.omega)
        return change


class FrequencyCurve(BalanceCurve):
    """The response along the frequency under a constant force; the parameter is the circular frequency.

    Curves that differ in their harmonics may share the ``last`` factor and the ``work``.
    """

    def __init__(
        self, balance: Balance, load: float = 1.0, last: LastFactor | None = None, work: Work | None = None
    ) -> None:
        super().__init__(balance, last)
        self.load = load
        self.work = work or Work()

    def at(self, unknowns: FloatArray, omega: float) -> BalancePoint:
        """The point at a circular frequency in rad/s."""
        return self.evaluate(unknowns, np.array([omega]))

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> BalancePoint:
        trial = self.balance.evaluate(unknowns, float(parameters[0]), self.load)
        return BalancePoint(trial, parameters, NO_PARAMETERS, trial.error)

    def stuck(self, before: BalancePoint, parameters: FloatArray) -> BalancePoint | None:
        """The motion with every contact stuck, a solution while no pair moves; None if one moved ``before``."""
        if before.trial.contact.moves.any():
            return None
        return self.evaluate(self.balance.linear(float(parameters[0]), self.load), parameters)

    def linearised(self, point: BalancePoint, plane: Plane | None) -> LinearisedBalance:
        self.work.iterate(2 * self.balance.harmonics + 1)
        slopes = [self.balance.frequency_slope(point.trial)]
        system = NewtonSystem(self.balance, point.trial)
        return LinearisedBalance(BorderedSystem(system, slopes, [plane_row(plane, 1)], self._last_factor))

    def measured_change(self, point: BalancePoint, step: Step) -> FloatArray:
        return self._amplitude_change(point.trial, step.detail, float(step.parameters[0]), 0.0)

    def named(self, parameter: float) -> str:
        return f"{parameter / (2.0 * math.pi):.3f} Hz"


class LoadCurve(BalanceCurve):
    """The response at one frequency while the force grows; the parameter is the load, a factor of the force."""

    def __init__(self, balance: Balance, omega: float, work: Work | None = None) -> None:
        super().__init__(balance)
        self.omega = omega
        self.work = work or Work()

    def at(self, unknowns: FloatArray, load: float) -> BalancePoint:
        """The point at a load."""
        return self.evaluate(unknowns, np.array([load]))

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> BalancePoint:
        trial = self.balance.evaluate(unknowns, self.omega, float(parameters[0]))
        return BalancePoint(trial, parameters, NO_PARAMETERS, trial.error)

    def linearised(self, point: BalancePoint, plane: Plane | None) -> LinearisedBalance:
        self.work.iterate(2 * self.balance.harmonics + 1)
        slopes = [self.balance.load_slope(point.trial)]
        system = NewtonSystem(self.balance, point.trial)
        return LinearisedBalance(BorderedSystem(system, slopes, [plane_row(plane, 1)], self._last_factor))

    def measured_change(self, point: BalancePoint, step: Step) -> FloatArray:
        return self._amplitude_change(point.trial, step.detail, 0.0, float(step.parameters[0]))

    def named(self, parameter: float) -> str:
        return f"{100.0 * parameter:.4g} % of the load"


class ControlledCurve(BalanceCurve):
    """The response along the frequency at a prescribed amplitude or phase of an output, with the force as unknown.

    The parameters are the circular frequency and the load. The condition is that the first harmonic of the output, ``o
    = output @ u_1`` as a complex amplitude ``c - i s`` of ``c cos + s sin``, has a prescribed amplitude, ``|o| / target
    - 1 = 0``, or phase, ``Im(o exp(-i target)) / |o| = 0`` with ``target`` in rad.

    Where the response folds over the frequency the force only passes a minimum and a maximum, so folds are no folds
    here (response-controlled testing: T. Karaagacli and H. N. Ozguven, Mech. Syst. Signal Process. 148 (2021) 107156).
    """

    def __init__(self, balance: Balance, output: FloatArray, control: Control, target: float) -> None:
        super().__init__(balance)
        self._modes = balance.compliance.output_modes(output)
        self._control = control
        self._target = target

    def evaluate(self, unknowns: FloatArray, parameters: FloatArray) -> BalancePoint:
        trial = self.balance.evaluate(unknowns, float(parameters[0]), float(parameters[1]))
        value, _ = self._condition(trial)
        return BalancePoint(trial, parameters, np.array([value]), max(trial.error, abs(value)))

    def _condition(self, trial: Trial) -> tuple[float, FloatArray]:
        """The condition, and its derivative (2H, n) by the modal amplitudes."""
        cosine, sine = (float(row @ self._modes) for row in trial.amplitude[:2])
        size = max(math.hypot(cosine, sine), 1e-300)
        weights = np.zeros_like(trial.amplitude)
        if self._control == "amplitude":
            weights[0], weights[1] = cosine / size * self._modes, sine / size * self._modes
            return size / self._target - 1.0, weights / self._target
        # Im((c - i s) exp(-i t)) / |o| = -(c sin t + s cos t) / |o|.
        across, along = -math.sin(self._target), -math.cos(self._target)
        value = (across * cosine + along * sine) / size
        weights[0] = (across - value * cosine / size) / size * self._modes
        weights[1] = (along - value * sine / size) / size * self._modes
        return value, weights

    def is_opposite(self, point: BalancePoint) -> bool:
        """Whether the output has the prescribed phase plus 180 degrees, which satisfies the condition of the phase
        too."""
        cosine, sine = (float(row @ self._modes) for row in point.trial.amplitude[:2])
        along = math.cos(self._target) * cosine - math.sin(self._target) * sine  # Re((c - i s) exp(-i t))
        return self._control == "phase" and point.trial.load * along < 0.0

    def linearised(self, point: BalancePoint, plane: Plane | None) -> LinearisedBalance:
        balance, trial = self.balance, point.trial
        _, weights = self._condition(trial)
        by_parameters = [balance.amplitude_slope(trial), balance.load_amplitude(trial.omega)]
        rows = [amplitude_row(balance, trial, weights, by_parameters), plane_row(plane, 2)]
        slopes = [balance.residual_slope(slope) for slope in by_parameters]
        return LinearisedBalance(BorderedSystem(NewtonSystem(balance, trial), slopes, rows, self._last_factor))

    def measured_change(self, point: BalancePoint, step: Step) -> FloatArray:
        return self._amplitude_change(point.trial, step.detail, *map(float, step.parameters))

    def named(self, parameter: float) -> str:
        return f"{parameter / (2.0 * math.pi):.3f} Hz"
