"""Gradients of a peak beside central differences of peaks that are solved again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import stickslip as ss
from stickslip.case.case import Case
from stickslip.case.continuous_keys import continuous_keys
from stickslip.results.peaks import peaks
from stickslip.solve.gradients.peak_gradients import PeakSensitivity, RefinedPeak
from stickslip.solve.harmonic.curves import BalancePoint, FrequencyCurve
from stickslip.solve.harmonic.peak_values import friction_energy
from stickslip.solve.setting_up import Balances, prepare_balances
from stickslip.solve.solver_input import SolverInput


@dataclass(frozen=True)
class SolvedPeak:
    """A peak of a model, refined on a curve."""

    base: SolverInput
    harmonics: int
    samples: int
    highest_omega: float
    spacing: float
    around: Sequence[BalancePoint]

    @classmethod
    def of(
        cls, base: SolverInput, frequency_hz: tuple[float, float], harmonics: int, samples: int, spacing: float
    ) -> SolvedPeak:
        """The highest peak of a range."""
        response = ss.forced_response(
            base.superelement, base.pairs, base.excitation, frequency_hz=frequency_hz, harmonics=harmonics,
            samples=min(samples, 256), modal_damping_ratio=base.modal_damping_ratio,
        )  # fmt: skip
        assert response.converged
        point = peaks(response.frequency_hz, response.amplitude(base.output))[0].point
        omega = 2.0 * np.pi * response.frequency_hz
        start = cls(base, harmonics, samples, float(omega.max()), spacing, ())
        curve = FrequencyCurve(start.balances(base).exact(harmonics, samples))
        relative = (response.pairs.operator @ response.displacement).transpose(0, 2, 1)
        around = [curve.at(relative[each], float(omega[each])) for each in (point - 1, point, point + 1)]
        return cls(base, harmonics, samples, start.highest_omega, spacing, around)

    def balances(self, changed: SolverInput) -> Balances:
        return prepare_balances(
            changed.superelement, changed.pairs, changed.excitation, self.highest_omega, self.harmonics, self.samples,
            changed.modal_damping_ratio, "tractrix", lambda stage: None,
        )  # fmt: skip

    def refined(self, changed: SolverInput) -> RefinedPeak:
        """The peak of a changed model, by Newton's method from the points around that of the base."""
        balance = self.balances(changed).exact(self.harmonics, self.samples)
        curve = FrequencyCurve(balance)
        around = [curve.at(each.unknowns, each.trial.omega) for each in self.around]
        return RefinedPeak.of(balance, changed.output, around, self.spacing)

    def values(self, changed: SolverInput) -> np.ndarray:
        """Amplitude, frequency in Hz and friction energy of the peak of a changed model."""
        top = self.refined(changed).top
        trial = top.point.trial
        return np.array([top.amplitude.value, trial.omega / (2.0 * np.pi), friction_energy(trial).value])

    def differences(self, parameter: ss.Parameter, step: float) -> np.ndarray:
        """Central differences of the solved peaks; ``step`` relative to the value."""
        distance = step * parameter.value
        below, above = (self.values(parameter.change(parameter.value + sign * distance)) for sign in (-1, 1))
        return np.asarray((above - below) / (2.0 * distance))

    @cached_property
    def own(self) -> RefinedPeak:
        """The peak of the base."""
        return self.refined(self.base)

    @cached_property
    def sensitivity(self) -> PeakSensitivity:
        """The derivatives of this peak."""
        return PeakSensitivity(self.balances(self.base), self.base, self.own)

    def gradient(self, parameter: ss.Parameter) -> np.ndarray:
        """The derivatives of amplitude, frequency and friction energy."""
        return self.sensitivity.derivative(parameter).value


def solver_input(case: Case) -> SolverInput:
    """The input of the solver for a case, with its first output."""
    model = ss.build_model(case)
    output = next(iter(model.outputs.values()))
    return SolverInput(
        model.superelement, model.pairs, model.excitation, output, case.damping.modal_damping_ratio
    )  # fmt: skip


def built_again(case: Case, name: str) -> ss.Parameter:
    """A parameter that meshes, reduces and solves its model again."""
    keys = [key for key in continuous_keys(case) if name.startswith(key.path) or key.path in _joined(name)]

    def change(factor: float) -> SolverInput:
        changed = case
        for key in keys:
            changed = key.changed(changed, key.shown * factor)
        return solver_input(changed)

    return ss.Parameter(name, "1", 1.0, change, 1e-4)


def _joined(name: str) -> list[str]:
    first, *others = name.split(" = ")
    return [first, *(f"geometry.{other}" for other in others)]
