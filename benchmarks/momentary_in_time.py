"""Bench blade in time with contact laws in their simplest form: constant springs, and stiffness by momentary pressure.

An independent check of ``momentary_stiffness.py``: laws and integrator are of this file alone (Newmark's average
acceleration, Newton's method in each step, radial return), from rest until the amplitude settles.

OMP_NUM_THREADS=1 python benchmarks/momentary_in_time.py [FREQUENCY_HZ ...]
"""

from __future__ import annotations

import sys

import numba
import numpy as np
from blade_problem import BladeProblem, FloatArray, load_blade_problem

LAWS = ("constant springs", "exponential, k_t at rest", "exponential, incremental k_t(N)", "exponential, total k_t(N)")
CONSTANT, AT_REST, INCREMENTAL, TOTAL = range(4)
FREQUENCIES_HZ = (690.0, 688.0, 686.0, 684.0, 683.0, 682.0, 681.4, 681.0, 680.0, 679.0, 678.0, 677.0, 676.0)
STEPS, PERIODS, SETTLED = 250, 400, 2e-5


@numba.njit
def _normal(law, closure, load, stiffness):
    """Normal force and its derivative of one contact."""
    if law == CONSTANT:
        force = load + stiffness * closure
        return (force, stiffness) if force > 0.0 else (0.0, 0.0)
    force = load * np.exp(min(closure * stiffness / load, 40.0))
    return force, force * stiffness / load


@numba.njit
def _contacts(law, x, at, traction, before, load, normal, tangential, friction, force, tangent, pulled, pressed):
    """Forces (3 n,) and tangents (n, 3, 3) at displacements x, after a step that began at ``at``."""
    for c in range(load.size):
        now, slope = _normal(law, x[3 * c + 2], load[c], normal)
        spring, change = tangential, 0.0
        if law == CONSTANT and now == 0.0:
            spring = 0.0
        step = x[3 * c : 3 * c + 2] - at[c]
        start = traction[c].copy()
        if law == INCREMENTAL:
            spring, change = tangential * 0.5 * (now + before[c]) / load[c], tangential * 0.5 * slope / load[c]
        if law == TOTAL:  # the stretch of the spring remains, and its stiffness changes
            spring, change = tangential * now / load[c], tangential * slope / load[c]
            step = step + start / (tangential * before[c] / load[c])
            start[:] = 0.0
        trial = start + spring * step
        if spring == 0.0:
            trial[:] = 0.0
        size, limit = np.sqrt((trial**2).sum()) + 1e-300, friction * now
        along = trial / size
        project, limited = np.eye(2), 0.0
        if size > limit:
            project = limit / size * (np.eye(2) - np.outer(along, along))
            trial = limit * along
            limited = friction * slope
        force[3 * c : 3 * c + 2], force[3 * c + 2] = trial, now - load[c]
        pulled[c], pressed[c] = trial, now
        tangent[c] = 0.0
        tangent[c, :2, :2] = spring * project
        tangent[c, :2, 2] = project @ step * change + limited * along
        tangent[c, 2, 2] = slope


@numba.njit
def march(law, frequency_hz, mass, damping, stiffness, force_cos, force_sin, output, load, springs, state):
    """First harmonic of each period (k,) until it settles; ``state`` is changed: (u, v, at, traction, pressed)."""
    normal, tangential, friction = springs
    u, v, at, traction, before = state
    m, omega, h = 3 * load.size, 2 * np.pi * frequency_hz, 1.0 / frequency_hz / STEPS
    inverse = np.linalg.inv(4 / h**2 * mass + 2 / h * damping + stiffness)
    columns = np.ascontiguousarray(inverse[:, :m])
    rows = np.ascontiguousarray(columns[:m])
    force, tangent = np.zeros(m), np.zeros((load.size, 3, 3))
    pulled, pressed = traction.copy(), before.copy()
    _contacts(law, u[:m], at, traction, before, load, normal, tangential, friction, force, tangent, pulled, pressed)
    rest = force_cos - damping @ v - stiffness @ u
    rest[:m] -= force
    a = np.linalg.solve(mass, rest)
    found = np.zeros(PERIODS)
    for period in range(PERIODS):
        cosine = sine = 0.0
        for i in range(STEPS):
            phase = omega * (i + 1) * h
            known = mass @ (4 / h**2 * u + 4 / h * v + a) + damping @ (2 / h * u + v)
            free = inverse @ (known + force_cos * np.cos(phase) + force_sin * np.sin(phase))
            x = u[:m] + h * v[:m]
            for _ in range(40):
                _contacts(
                    law, x, at, traction, before, load, normal, tangential, friction, force, tangent, pulled, pressed
                )
                matrix = np.eye(m)
                for c in range(load.size):
                    matrix[:, 3 * c : 3 * c + 3] += np.ascontiguousarray(rows[:, 3 * c : 3 * c + 3]) @ tangent[c]
                change = np.linalg.solve(matrix, x - free[:m] + rows @ force)
                x -= change
                if np.abs(change).max() < 1e-13:
                    break
            _contacts(law, x, at, traction, before, load, normal, tangential, friction, force, tangent, pulled, pressed)
            after = free - columns @ force
            rate = 4 / h**2 * (after - u) - 4 / h * v - a
            v += h / 2 * (a + rate)
            u[:], a = after, rate
            at[:], traction[:], before[:] = x.reshape(-1, 3)[:, :2], pulled, pressed
            cosine += output @ u * np.cos(phase)
            sine += output @ u * np.sin(phase)
        found[period] = 2 / STEPS * np.sqrt(cosine**2 + sine**2)
        if period > 60 and np.abs(found[period - 20 : period] / found[period] - 1).max() < SETTLED:
            return found[: period + 1]
    return found


def sweep(blade: BladeProblem, law: int, frequencies_hz: tuple[float, ...]) -> FloatArray:
    """First harmonic (k,) in m of the output at each frequency, each from the motion at the one before."""
    n, size = blade.n_contacts, blade.size
    state = (np.zeros(size), np.zeros(size), np.zeros((n, 2)), np.zeros((n, 2)), blade.preload.copy())
    springs = (blade.normal_stiffness, blade.tangential_stiffness, blade.friction_coefficient)
    matrices = [np.ascontiguousarray(each) for each in (blade.mass, blade.damping, blade.stiffness)]
    forces = (blade.force_cos, blade.force_sin, np.ascontiguousarray(blade.output), blade.preload)
    amplitude = np.zeros(len(frequencies_hz))
    for place, frequency in enumerate(frequencies_hz):
        periods = march(law, frequency, *matrices, *forces, springs, state)
        amplitude[place] = periods[-1]
        print(f"{LAWS[law]}: {frequency:g} Hz, {1e6 * periods[-1]:.1f} um after {periods.size} periods", flush=True)
    return amplitude


def main(frequencies_hz: tuple[float, ...]) -> None:
    """Print the largest first harmonic of each law."""
    blade = load_blade_problem(10)
    for law, name in enumerate(LAWS):
        amplitude = sweep(blade, law, frequencies_hz)
        print(f"{name}: {1e6 * amplitude.max():.1f} um at {frequencies_hz[int(amplitude.argmax())]:g} Hz")


if __name__ == "__main__":
    main(tuple(float(each) for each in sys.argv[1:]) or FREQUENCIES_HZ)
