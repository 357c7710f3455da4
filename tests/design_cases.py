"""Designs with closed forms: one mass on springs, forced along x, with one joint to the ground.

With one harmonic, the velocity at the peak is in phase with the force, so the force does the work of the friction:
``pi F a = 4 L (a - L / k)`` with the friction limit L and the stiffness k of a Jenkins element. Without other damping
the peak ``a = L^2 / (k (L - pi F / 4))`` is smallest, ``pi F / k``, for ``L = pi F / 2``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.optimize

from law_studies import REST, interface_text, write_masses, write_study
from stickslip.case.case import Case
from stickslip.case.load import load_case
from stickslip.results.sweep_table import SweepCurve
from stickslip.sweeps.design_task import DesignTask
from stickslip.sweeps.work import CaseOutcome

FORCE, STIFFNESS, BODY_STIFFNESS = 2.0, 1e4, 1e4  # N, N/m: of the joint and of the body
LIMIT = "interfaces.joint.constants.friction_limit"
JOINT_STIFFNESS = "interfaces.joint.tangential_stiffness"
DAMPING = 2e-3


def jenkins_file(folder: Path) -> Path:
    """The study file; 15.9 Hz free, 22.5 Hz stuck."""
    write_masses(folder)
    rest = REST.replace("[1, 0.5, 0.7]", "[1, 0, 0]").replace("ratio = 0.02", f"ratio = {DAMPING}")
    rest = rest.replace("[solver]", "[solver]\nharmonics = 1\nsamples = 128\nlargest_step = 0.2")
    rest = rest.replace('"15 Hz"', '"16 Hz"').replace('"30 Hz"', '"24 Hz"')
    return write_study(folder, interface_text("joint", "jenkins"), rest=rest)


def jenkins_case(folder: Path) -> Case:
    """The case of this file."""
    return load_case(jenkins_file(folder))


def loop_hz(limit_n: float, peak_m: float) -> float:
    """The resonance with the stiffness of the first harmonic of the hysteresis loop."""
    angle = math.acos(1.0 - 2.0 * limit_n / STIFFNESS / peak_m)
    stiffness = BODY_STIFFNESS + STIFFNESS / math.pi * (angle - 0.5 * math.sin(2.0 * angle))
    return math.sqrt(stiffness) / (2.0 * math.pi)


def jenkins_peak(limit_n: float) -> float:
    """The peak in m with the small viscous damping: ``pi F a = 4 L (a - L / k) + pi c w a^2``."""
    viscous = 2.0 * DAMPING * math.sqrt(BODY_STIFFNESS + STIFFNESS)

    def excess(peak: float) -> float:
        friction = 4.0 * limit_n * (peak - limit_n / STIFFNESS)
        work = math.pi * viscous * 2.0 * math.pi * loop_hz(limit_n, peak) * peak**2
        return friction + work - math.pi * FORCE * peak

    return float(scipy.optimize.brentq(excess, limit_n / STIFFNESS * (1.0 + 1e-12), 0.1, xtol=1e-12))


def optimum() -> tuple[float, float]:
    """Friction limit in N and peak in m of the lowest peak."""
    found = scipy.optimize.minimize_scalar(jenkins_peak, bounds=(2.0, 6.0), method="bounded", options={"xatol": 1e-6})
    return float(found.x), float(found.fun)


PeaksOf = Callable[[float], list[tuple[float, float]]]  # value of the key -> (amplitude in m, frequency in Hz)


def closed_form(limit_n: float) -> list[tuple[float, float]]:
    """The peak of the friction damper."""
    peak = jenkins_peak(limit_n)
    return [(peak, loop_hz(limit_n, peak))]


class FakeSolver:
    """A worker that answers with peaks of a function of the friction limit instead of a solution.

    ``solved`` are the names of its tasks; it raises KeyboardInterrupt instead of the task ``killed_at``.
    """

    def __init__(self, peaks_of: PeaksOf, has_gradients: bool = True, killed_at: int | None = None) -> None:
        self._peaks_of, self._has_gradients, self._killed_at = peaks_of, has_gradients, killed_at
        self.solved: list[str] = []

    def __call__(self, task: DesignTask) -> CaseOutcome:
        if len(self.solved) == self._killed_at:
            raise KeyboardInterrupt
        self.solved.append(task.name)
        sections = task.case.sections
        limit = sections["interfaces"]["joint"].constants.values["friction_limit"]
        factor = sections["forces"]["push"].amplitude / FORCE
        found = sorted(((factor * height, hertz) for height, hertz in self._peaks_of(limit)), reverse=True)
        if not found:
            return CaseOutcome(converged=False, message="The curve ended.", measures={})
        step = 1e-6 * limit
        beside = [np.array(sorted(self._peaks_of(limit + sign * step), reverse=True)) for sign in (-1.0, 1.0)]
        known = beside[0].shape == beside[1].shape  # not at an edge beyond which there is no result
        slopes = (beside[1] - beside[0]) / (2.0 * step) if known else np.zeros((len(found), 2))
        rows = []
        for (height, hertz), (by_height, by_hertz) in zip(found, slopes, strict=True):
            row = {"amplitude_m": height, "frequency_hz": hertz, "bracketed": hertz < 22.0}
            if task.gradient_keys and self._has_gradients:
                row |= {"by_amplitude": {LIMIT: factor * by_height}, "by_frequency_hz": {LIMIT: by_hertz}}
            rows.append(row)
        curve = SweepCurve(np.array([16.0, 24.0]), np.array([1e-4, found[0][0]]), np.ones(2, bool), np.zeros(2, int))
        details = {"peaks": rows, "messages": []}
        return CaseOutcome(True, "Done.", {}, curve, file=b"results" if task.wants_file else b"", details=details)
