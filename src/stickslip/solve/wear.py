"""Wear of the pairs of a joint under vibration: depth against the number of cycles.

Each cycle removes from a pair of area ``A_i`` the volume ``alpha E_i``, so that its depth ``h_i`` grows by

    d h_i / d n = alpha E_i(h) / A_i,

with the friction energy ``E_i`` of a cycle in the periodic motion. By Archard the volume is ``K`` times the integral of
normal force times slip; friction follows ``mu N`` while a pair slips, so that this is the same with ``alpha = K / mu``.
Material that is removed opens the joint: with the gaps ``h`` the joint is at rest under other normal loads, from its
static equilibrium. Many cycles pass in one step of a Runge-Kutta method, with an estimate of its error; within a step
nothing is assumed of the motion but that it is periodic at each stage (docs/theory_wear.md).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import RK23
from threadpoolctl import threadpool_limits

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.coulomb import CoulombLaw
from stickslip.contact.law.coulomb_harmonics import Update
from stickslip.contact.law.law import ContactState
from stickslip.core.errors import ConvergenceError, InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.threads import blas_threads, thread_count
from stickslip.core.validation import FloatArray, finite_array, real_number, require_allowed
from stickslip.results.wear import Wear
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.curves import BalancePoint
from stickslip.solve.harmonic.energy import work_per_cycle
from stickslip.solve.harmonic.peak import CurvePeak
from stickslip.solve.harmonic.start import first_point
from stickslip.solve.path.newton import NewtonSettings
from stickslip.solve.path.problem import Plane
from stickslip.solve.ridge_stage import RidgeOptions, RidgeStage
from stickslip.solve.setting_up import StageReport, checked_window
from stickslip.solve.static.ramp_to_rest import LocalStiffness, static_preload
from stickslip.structure.superelement import Superelement

# chosen: a wear of more states is slower than its pages are useful; the message gives the cycles that were reached.
MOST_STATES = 300
# chosen: range of the accuracy; below, sampled friction has no such digits.
FINEST, COARSEST = 1e-5, 0.2
# Stiffness (normal, tangential) in N/m of pairs under normal forces (n_pairs,) N, worn by depths (n_pairs,) m.
WornStiffness = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class WornJoint:
    """A joint at rest that wears: its pairs with any depths of wear.

    ``pairs`` are those without wear, about their state at rest; ``stiffness`` None keeps their springs.
    """

    superelement: Superelement
    pairs: ContactPairs
    stiffness: WornStiffness | None = None

    def pairs_after(self, depth: FloatArray) -> ContactPairs:
        """The pairs about the state at rest with worn depths (n_pairs,) m. Raises ConvergenceError without one."""
        law = self.pairs.coulomb
        unloaded = ContactPairs(
            self.pairs.operator,
            law.normal_stiffness,
            law.tangential_stiffness,
            law.friction_coefficient,
            self.pairs.preload - law.normal_stiffness * depth,
        )
        local: LocalStiffness | None = None
        if self.stiffness is not None:
            worn = self.stiffness

            def local(normal_force: FloatArray) -> tuple[FloatArray, FloatArray]:
                return worn(normal_force, depth)

        # The load that holds the unworn joint at rest: its displacement is zero without wear.
        load = self.pairs.operator[2::3].T @ np.maximum(self.pairs.preload, 0.0)
        state = static_preload(self.superelement, unloaded, load, friction=False, local_stiffness=local)
        return state.about(unloaded, keep_traction=False)


@dataclass(frozen=True)
class _State:
    """The worn joint at one number of cycles, and its periodic motion."""

    pairs: ContactPairs
    point: BalancePoint
    amplitude: float
    omega: float
    energy: FloatArray  # (n_pairs,) J per cycle
    peak: CurvePeak | None = None


class _Vibration:
    """The periodic motion of a worn joint: at a fixed frequency, or at the peak of an output that it follows."""

    def __init__(
        self,
        joint: WornJoint,
        excitation: Excitation,
        output: FloatArray,
        options: RidgeOptions,
        frequency_hz: float | None,
        modal_damping_ratio: float | None,
        report: StageReport,
    ) -> None:
        self._joint = joint
        self._excitation = excitation
        self._output = output
        self._options = options
        self._omega = None if frequency_hz is None else 2.0 * math.pi * frequency_hz
        self._ratio = modal_damping_ratio
        self._report = report
        self._stage: RidgeStage | None = None
        self.last: _State | None = None
        self.evaluations = 0

    def state_after(self, depth: FloatArray) -> _State:
        """The joint and its motion with worn depths (n_pairs,) m. Raises ConvergenceError."""
        self.evaluations += 1
        pairs = self._joint.pairs_after(depth)
        problem = self._joint.superelement, pairs, self._excitation
        stage = RidgeStage.of(problem, self._output, self._options, self._ratio, self._report, self._stage)
        self._stage = stage
        self.last = self._at_peak(stage, pairs) if self._omega is None else self._at_frequency(stage, pairs)
        return self.last

    def _at_frequency(self, stage: RidgeStage, pairs: ContactPairs) -> _State:
        """The motion at the frequency of operation, from the last one."""
        assert self._omega is not None
        if self.last is not None:
            guess = self.last.point.unknowns
            correction = stage.solver.correct(stage.curve.at(guess, self._omega), Plane.fixed(guess, self._omega))
            if correction.converged:
                return _state_of(stage, pairs, correction.point)
        point, _ = first_point(stage.solver, stage.curve, self._omega, stage.balances.with_harmonics)
        return _state_of(stage, pairs, point)

    def _at_peak(self, stage: RidgeStage, pairs: ContactPairs) -> _State:
        """The motion at the highest peak, close to the last one or else from a whole curve."""
        if self.last is not None and self.last.peak is not None:
            last = self.last.peak
            peak = stage.search.from_estimate(self.last.point.unknowns, last.omega, last.probe.tangent, last.curvature)
            if not isinstance(peak, str):
                return _state_of(stage, pairs, peak.probe.point, peak)
        branch = stage.whole_curve()
        points = [each.point for each in branch.points]
        amplitude = stage.amplitude(points)
        top = int(amplitude.argmax())
        if not branch.complete:
            raise ConvergenceError(f"the frequency curve of the worn joint is not complete. {branch.message}")
        if top in (0, len(points) - 1):
            raise ConvergenceError(
                "the largest amplitude of the worn joint is at an end of the frequency range. Widen the range."
            )
        peak = stage.search.from_point(points[top])
        if isinstance(peak, str):
            raise ConvergenceError(f"the peak of the worn joint was not found: {peak}.")
        return _state_of(stage, pairs, peak.probe.point, peak)


def _state_of(stage: RidgeStage, pairs: ContactPairs, point: BalancePoint, peak: CurvePeak | None = None) -> _State:
    amplitude = float(stage.amplitude([point])[0]) if peak is None else peak.amplitude
    omega = float(point.parameters[0]) if peak is None else peak.omega
    work = work_per_cycle(point.trial).reshape(-1, 3)[:, :2].sum(axis=1)
    slips = point.trial.contact.state != ContactState.STUCK
    return _State(pairs, point, amplitude, omega, np.where(slips, np.maximum(work, 0.0), 0.0), peak)


def wear(
    superelement: Superelement,
    pairs: ContactPairs,
    excitation: Excitation,
    output: ArrayLike,
    *,
    area: ArrayLike,
    energy_wear_coefficient: float,
    cycles: float,
    frequency_hz: tuple[float, float] | float,
    accuracy: float = 0.01,
    stiffness: WornStiffness | None = None,
    harmonics: int = 5,
    samples: int = 256,
    modal_damping_ratio: float | None = None,
    update: Update = "tractrix",
    newton: NewtonSettings | None = None,
    threads: int | None = None,
    progress: ProgressCallback | None = None,
) -> Wear:
    """Wear of the pairs over many cycles of vibration.

    ``d h_i / d n = alpha E_i(h) / A_i`` in steps of many cycles, with normal loads and gaps from the static equilibrium
    of the worn joint and the friction energy from its periodic motion. Theory: docs/theory_wear.md.

    Parameters
    ----------
    superelement, pairs, excitation:
        as in :func:`forced_response`; the pairs are all of Coulomb friction and begin without tractions. Loads and gaps
        are those before the wear.
    output:
        (n,) row whose amplitude is reported; with a range of frequencies its highest peak is the motion of the wear.
    area:
        (n_pairs,) m2.
    energy_wear_coefficient:
        alpha in m3/J: volume that both faces lose together for each joule of friction. Archard's coefficient in
        m3/(N m) divided by the friction coefficient is the same.
    cycles:
        number of cycles.
    frequency_hz:
        a number: the joint vibrates at this frequency. (start, stop): it vibrates at the highest peak in this range,
        which is followed while the joint wears.
    accuracy:
        error of the depth in one step, as a fraction of the elastic closure of the pairs at rest: what changes normal
        loads is depth against closure.
    stiffness:
        normal and tangential stiffness (n_pairs,) in N/m of pairs under normal forces (n_pairs,) N and worn by depths
        (n_pairs,) m, for example of a roughness that runs in; None keeps the springs.
    harmonics, samples, modal_damping_ratio, update, newton, threads, progress:
        as in :func:`forced_response`.

    Returns
    -------
    Wear
        with the states that were reached; ``converged`` is False if the wear ends early, and ``message`` says why.

    Raises
    ------
    InputError
        for inputs that cannot be used, pairs of other laws, or pairs that keep tractions. ConvergenceError without a
        motion before the wear.
    """
    began = time.perf_counter()
    row, areas = finite_array("output", output), np.broadcast_to(finite_array("area", area), (pairs.n_pairs,))
    coefficient = real_number("energy_wear_coefficient", energy_wear_coefficient)
    count = real_number("cycles", cycles)
    for name, value in (("energy_wear_coefficient", coefficient), ("cycles", count), ("area", float(areas.min()))):
        if not value > 0.0:
            raise InputError(f"{name} is {value:g}, but it must be above zero.", arguments=[name])
    require_allowed("accuracy", real_number("accuracy", accuracy), FINEST, COARSEST)
    if row.shape != (superelement.size,) or not row.any():
        raise InputError(
            f"output must have shape ({superelement.size},) with an entry that is not zero.", arguments=["output"]
        )
    _require_released_friction(pairs)
    at, window = _operation(frequency_hz)
    options = RidgeOptions(window, harmonics, samples, update, newton or NewtonSettings())
    report = StageReport(progress)
    with threadpool_limits(limits=blas_threads(3 * pairs.n_pairs, thread_count(threads))):
        vibration = _Vibration(
            WornJoint(superelement, pairs, stiffness), excitation, row, options, at, modal_damping_ratio, report
        )
        states, depths, places, message = _worn(vibration, coefficient / areas, count, accuracy, report)
    settings: dict[str, str | float | int] = {
        "energy_wear_coefficient_m3_per_j": coefficient,
        "cycles": count,
        "accuracy": accuracy,
        "motion": "highest peak" if at is None else f"{at:g} Hz",
        "harmonics": harmonics,
        "samples": samples,
        "evaluations": vibration.evaluations,
    }
    depth = np.array(depths)
    return Wear(
        cycles=np.array(places),
        depth=depth,
        normal_load=np.array([np.maximum(each.pairs.preload, 0.0) for each in states]),
        friction_energy=np.array([each.energy for each in states]),
        amplitude=np.array([each.amplitude for each in states]),
        frequency_hz=np.array([each.omega / (2.0 * math.pi) for each in states]),
        normal_stiffness=np.array([each.pairs.coulomb.normal_stiffness for each in states]),
        area=np.array(areas),
        converged=not message,
        message=message or f"The wear covers {count:.4g} cycles.",
        settings=settings,
        provenance={"solve_seconds": f"{time.perf_counter() - began:.2f}"},
    )


def _require_released_friction(pairs: ContactPairs) -> None:
    """Raise InputError for pairs whose wear is not defined here."""
    if pairs.law_names != (CoulombLaw.name,):
        raise InputError(
            f"the pairs follow the laws {', '.join(pairs.law_names)}, but wear requires Coulomb friction in all of "
            "them: other laws have no slip with a normal load.",
            arguments=["pairs"],
        )
    if not pairs.released:
        raise InputError(
            "some pairs keep a traction at rest, but wear releases tractions: the material that holds them is removed. "
            "Give pairs without residual_traction.",
            arguments=["pairs"],
        )
    if not (pairs.preload > 0.0).any():
        raise InputError(
            "no pair is closed at rest, so that nothing holds the joint while it wears. Give a normal load.",
            arguments=["normal_load"],
        )


def _operation(frequency_hz: tuple[float, float] | float) -> tuple[float | None, tuple[float, float]]:
    """The fixed frequency or None, and a window for it. Raises InputError."""
    if isinstance(frequency_hz, (int, float)):
        at = real_number("frequency_hz", frequency_hz)
        if not at > 0.0:
            raise InputError(f"frequency_hz is {at:g} Hz, but it must be above zero.", arguments=["frequency_hz"])
        return at, (0.99 * at, at)
    return None, checked_window(frequency_hz)


def _worn(
    vibration: _Vibration, rate: FloatArray, cycles: float, accuracy: float, report: StageReport
) -> tuple[list[_State], list[FloatArray], list[float], str]:
    """States, depths and cycles of the accepted steps, and why they end early, "" if they do not.

    ``rate`` (n_pairs,) m/J.
    """
    depth = np.zeros(len(rate))
    report.stage("motion before the wear", 0.0)
    first = vibration.state_after(depth)
    states, depths, places = [first], [depth], [0.0]
    closure = np.maximum(first.pairs.preload, 0.0) / first.pairs.coulomb.normal_stiffness
    speed = float((rate * first.energy).max())
    if speed == 0.0:
        report.stage("no pair slips", 1.0)
        return [first, first], [depth, depth], [0.0, cycles], ""
    tolerance = accuracy * float(closure.max())

    def slope(_: float, worn: FloatArray) -> FloatArray:
        # A stage of the method may undershoot zero by its error.
        return rate * vibration.state_after(np.maximum(worn, 0.0)).energy

    # The first step wears a tenth of the closure at most.
    step = min(cycles, 0.1 * float(closure.max()) / speed)
    try:
        solver = RK23(slope, 0.0, depth, cycles, first_step=step, rtol=1e-12, atol=tolerance)
        while solver.status == "running":
            if len(states) > MOST_STATES:
                return states, depths, places, f"The wear ends at {solver.t:.4g} cycles: {MOST_STATES} states are full."
            trouble = solver.step()
            if solver.status == "failed":
                return states, depths, places, f"The wear ends at {solver.t:.4g} cycles: {trouble}"
            # The last stage of the method is the motion at the end of the step.
            assert vibration.last is not None
            states.append(vibration.last)
            depths.append(np.maximum(solver.y, 0.0))
            places.append(float(solver.t))
            report.stage(f"{solver.t:.3g} of {cycles:.3g} cycles", min(solver.t / cycles, 0.999))
    except ConvergenceError as error:
        return states, depths, places, f"The wear ends after {places[-1]:.4g} cycles: {error}"
    report.stage(f"{cycles:.3g} cycles", 1.0)
    return states, depths, places, ""
