"""Frequency and damping of a mode from a static load in its shape: seconds, where a nonlinear mode takes minutes.

The load ``alpha M phi`` grows from the state at rest, and the pairs follow their laws step by step. With the amplitude
q of the mode prescribed, the static displacements follow from the compliance of all other modes, so that each step is a
:class:`stickslip.solve.joint_step.JointStep`:

    x = q B phi - A' d(x),   A' = sum_(j != r) B phi_j (B phi_j)^T / w_j^2,   alpha = w_r^2 q + (B phi)^T d

Masing's rule makes the hysteresis loop from this load curve. Source: R. M. Lacayo, M. S. Allen, Mech. Syst. Signal
Process. 118 (2019) 133-157.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.law.law import ContactState
from stickslip.core.completeness import reported
from stickslip.core.errors import ConvergenceError
from stickslip.core.threads import solver_threads, thread_count
from stickslip.core.validation import FloatArray, whole_number
from stickslip.results.quasi_static_mode import QuasiStaticMode
from stickslip.solve.harmonic.compliance import StuckStructure, stuck_structure
from stickslip.solve.joint_step import JointStep, StepPoint
from stickslip.solve.modes.linear_mode import LinearMode, checked_amplitudes
from stickslip.solve.path.newton import Newton
from stickslip.solve.static.load_ramp import NEWTON
from stickslip.structure.superelement import Superelement

# chosen: the damping ratio of the default study is within 0.15 % of that with four times as many; 40 have 0.7 %.
POINTS_PER_DECADE = 80
# chosen: the ramp starts two decades below the lowest amplitude, because the pairs may slip there already.
DECADES_BEFORE = 2
# chosen: a load step that fails is halved at most so often.
HALVINGS = 12
# chosen: a step longer than this multiple of the linear motion is a body without support.
LARGEST_STEP = 1e6
# chosen: change of a normal force over the load at rest above which Masing's rule is in doubt.
LARGEST_CHANGE_OF_LOAD = 0.1
# chosen: a loop below this multiple of the work of the load is round-off, and zero. Stuck pairs have up to 2e-14.
LEAST_LOOP = 1e-12


def quasi_static_mode(
    superelement: Superelement,
    pairs: ContactPairs,
    mode: int,
    amplitude: tuple[float, float],
    *,
    points_per_decade: int = POINTS_PER_DECADE,
    modal_damping_ratio: float | None = None,
    threads: int | None = None,
    raise_on_failure: bool = False,
) -> QuasiStaticMode:
    """Estimate frequency and damping ratio of a stuck mode against amplitude from a static load in its shape.

    It is valid for small changes of shape and frequency, constant normal loads, and slow modes: the inertia of all
    other modes is neglected. Theory: docs/theory_modes.md.

    Parameters
    ----------
    superelement, pairs, mode, amplitude, modal_damping_ratio, threads, raise_on_failure:
        as in :func:`nonlinear_mode` with the limit "stuck".
    points_per_decade:
        points for each factor of ten of the amplitude, also load steps.

    Returns
    -------
    QuasiStaticMode
        also if the load ends early: ``converged`` is then False and ``message`` gives the amplitude.

    Raises
    ------
    InputError
        for inputs that cannot be used. ConvergenceError if there is no first point.
    """
    result = unreported_estimate(superelement, pairs, mode, amplitude, points_per_decade, modal_damping_ratio, threads)
    return reported(result, raise_on_failure)


def unreported_estimate(
    superelement: Superelement, pairs: ContactPairs, mode: int, amplitude: tuple[float, float],
    points_per_decade: int, modal_damping_ratio: float | None, threads: int | None,
) -> QuasiStaticMode:  # fmt: skip
    """:func:`quasi_static_mode`, for a caller that reports a load that ends early itself."""
    began = time.perf_counter()
    bounds = checked_amplitudes(amplitude)
    density = whole_number("points_per_decade", points_per_decade, 1)
    with solver_threads(thread_count(threads)):
        linear = LinearMode.of(superelement, pairs, mode, "stuck")
        stuck = stuck_structure(superelement, pairs, linear.omega, modal_damping_ratio)
        result = unreported_static_mode(stuck, linear, bounds, density)
    return replace(result, provenance={"solve_seconds": f"{time.perf_counter() - began:.2f}"})


def unreported_static_mode(
    stuck: StuckStructure, linear: LinearMode, amplitude: tuple[float, float], points_per_decade: int
) -> QuasiStaticMode:
    """The estimate for a stuck mode whose modes are known; the caller reports a load that ends early."""
    lowest, highest = amplitude
    ramp = _ModeRamp.of(stuck, linear)
    count = math.ceil(points_per_decade * math.log10(highest / lowest)) + 1
    wanted = np.geomspace(lowest, highest, count)
    first = lowest / 10.0**DECADES_BEFORE
    before = np.geomspace(first, lowest, DECADES_BEFORE * points_per_decade, endpoint=False)
    levels = ramp.follow(np.concatenate([before, wanted]))
    if len(levels) <= before.size:
        raise ConvergenceError(
            f"the solver found no static equilibrium at a modal amplitude of {lowest:.3g} m kg^0.5. Give a lower one."
        )
    complete = len(levels) == before.size + wanted.size
    message = "The estimate covers the range of modal amplitudes."
    if not complete:
        message = (
            f"The solver found no static equilibrium above a modal amplitude of {levels[-1].amplitude:.3g} m kg^0.5 of "
            f"{highest:.3g}."
        )
    return _result(ramp, levels, before.size, complete, message)


@dataclass(frozen=True)
class _Level:
    """The joint at one amplitude of the mode: deviation force (m,) N and step."""

    amplitude: float
    deviation: FloatArray
    point: StepPoint


@dataclass(frozen=True)
class _ModeRamp:
    """Static loads in the shape of a stuck mode."""

    stuck: StuckStructure
    linear: LinearMode
    springs: FloatArray  # (n_pairs, 3) N/m
    compliance: FloatArray  # (m, m) m/N, of all modes but this one

    @classmethod
    def of(cls, stuck: StuckStructure, linear: LinearMode) -> _ModeRamp:
        """The ramp of a mode."""
        flexibility = 1.0 / stuck.circular_frequency**2
        flexibility[linear.load_mode] = 0.0
        contact = stuck.contact_modes
        springs = stuck.pairs.resting_stiffness().reshape(-1, 3)
        return cls(stuck, linear, springs, (contact * flexibility) @ contact.T)

    def follow(self, amplitudes: FloatArray) -> list[_Level]:
        """The joint at rising amplitudes, as far as there is an equilibrium."""
        memory, levels = self.stuck.pairs.memory_at_rest(), list[_Level]()
        start = 0.0
        for amplitude in map(float, amplitudes):
            point = self._advance(start, amplitude, memory, levels[-1].point if levels else None)
            if point is None:
                break
            deviation = (point.force - self.springs * point.unknowns).ravel()
            levels.append(_Level(amplitude, deviation, point))
            start, memory = amplitude, point.memory
        return levels

    def _advance(self, start: float, end: float, memory: Any, last: StepPoint | None) -> StepPoint | None:
        """The joint after steps from one amplitude to another; None without an equilibrium."""
        reached, step = start, end - start
        smallest = 0.5**HALVINGS * step
        while reached < end and step >= smallest:
            target = min(end, reached + step)
            shape = self.stuck.contact_modes[:, self.linear.load_mode]
            scale = target * float(np.linalg.norm(shape)) + 1e-300
            problem = JointStep(
                forces=partial(self.stuck.pairs.step, before=memory),
                springs=self.springs,
                compliance=self.compliance,
                linear=target * shape,
                scale=scale,
                largest_step=LARGEST_STEP * scale,
                name=f"a modal amplitude of {target:.3g} m kg^0.5",
            )
            estimate = (target * shape).reshape(-1, 3) if last is None else last.unknowns * (target / reached)
            correction = Newton(problem, NEWTON).correct(problem.evaluate(estimate))
            if not correction.converged:
                step *= 0.5
                continue
            last, memory, reached = correction.point, correction.point.memory, target
        return last if reached == end else None

    def motion(self, level: _Level) -> FloatArray:
        """(n,) amplitudes of the stuck modes."""
        answer = -(level.deviation @ self.stuck.contact_modes) / self.stuck.circular_frequency**2
        answer[self.linear.load_mode] = level.amplitude
        return answer


def _result(ramp: _ModeRamp, levels: Sequence[_Level], first: int, reached: bool, message: str) -> QuasiStaticMode:
    """The labelled result of the levels from ``first`` on."""
    stuck, linear, ratio = ramp.stuck, ramp.linear, ramp.stuck.origin[2]
    amplitude = np.array([level.amplitude for level in levels])
    # The force of the pairs in the mode beside their springs, whose work is that of the loop: the springs have none.
    released = np.array([level.deviation @ stuck.contact_modes[:, linear.load_mode] for level in levels])
    steps = np.diff(amplitude, prepend=0.0)
    work = np.cumsum(0.5 * steps * (released + np.concatenate([[0.0], released[:-1]])))
    loop = 8.0 * work - 4.0 * released * amplitude
    force = linear.omega**2 * amplitude + released
    loop[np.abs(loop) < LEAST_LOOP * force * amplitude] = 0.0
    omega = np.sqrt(force / amplitude)
    motions = np.array([ramp.motion(level) for level in levels])
    damping = stuck.modal_damping
    viscous = motions**2 @ damping if damping.ndim == 1 else ((motions @ damping) * motions).sum(axis=1)
    ratios = loop / (2.0 * np.pi * force * amplitude) + viscous / (2.0 * omega * amplitude**2)
    return QuasiStaticMode(
        modal_amplitude=amplitude[first:],
        frequency_hz=omega[first:] / (2.0 * np.pi),
        damping_ratio=ratios[first:],
        modal_force=force[first:],
        friction_energy=loop[first:],
        displacement=motions[first:] @ stuck.modes.T,
        contact_state=np.array([level.point.code for level in levels[first:]], dtype=np.int8),
        linear_frequency_hz=np.asarray(linear.omega / (2.0 * np.pi)),
        mode=linear.number,
        converged=reached,
        message=message,
        warnings=_warnings(stuck.pairs, levels[first:]),
        settings={} if ratio is None else {"modal_damping_ratio": ratio},
        provenance={},
    )


def _warnings(pairs: ContactPairs, levels: Sequence[_Level]) -> tuple[str, ...]:
    """A warning where normal forces change, because Masing's rule is for constant ones."""
    loaded = pairs.normal_load > 0.0
    for level in levels:
        change = np.abs(level.point.force[:, 2])
        opens = (level.point.code == ContactState.SEPARATING) & pairs.closed_at_rest
        changed = opens | (loaded & (change > LARGEST_CHANGE_OF_LOAD * pairs.normal_load))
        if changed.any():
            return (
                f"From a modal amplitude of {level.amplitude:.3g} m kg^0.5 on, normal forces change by more than "
                f"{100 * LARGEST_CHANGE_OF_LOAD:.0f} % of the load at rest (first at {int(changed.sum())} of "
                f"{changed.size} pairs). Masing's rule assumes constant ones: use a nonlinear mode there.",
            )
    return ()
