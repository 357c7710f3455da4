"""A plain harmonic balance to compare with: all unknowns, dense Newton, friction by radial return, arc length.

Shares no code with the package. Run ``python benchmarks/dense_newton.py 10`` (or 40, 110) for the peak of a bench
problem.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from blade_problem import BladeProblem, FloatArray, load_blade_problem
from numba import njit

# Relative displacement coefficients (n_contacts, 3, m) -> force coefficients of that shape, and their derivative.
Law = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True)
class Point:
    """One solution: circular frequency rad/s and coefficients (2 * harmonics + 1, n): mean, cos 1, sin 1, ..."""

    omega: float
    coefficients: FloatArray


@njit(cache=True)
def contact_forces(relative, basis, kt, kn, mu, preload, cycles, opening):  # type: ignore[no-untyped-def]
    """Force (n_contacts, 3, samples) and its derivative (n_contacts, 3, samples, 3, m) to the coefficients.

    ``relative`` (n_contacts, 3, samples) m; ``basis`` (samples, m). The slider starts at zero and is marched through
    ``cycles`` periods; the last one is returned. Without ``opening`` the friction limit is ``mu * preload`` and the
    normal spring is bilateral.
    """
    n_contacts, _, samples = relative.shape
    m = basis.shape[1]
    force = np.zeros((n_contacts, 3, samples))
    rate = np.zeros((n_contacts, 3, samples, 3, m))
    for i in range(n_contacts):
        traction, previous = np.zeros(2), np.zeros(2)
        traction_rate, previous_basis = np.zeros((2, 3, m)), np.zeros(m)
        for step in range(cycles * samples):
            j = step % samples
            normal = preload[i] + kn * relative[i, 2, j]
            limit = mu * (normal if opening else preload[i])
            last = step >= (cycles - 1) * samples
            if opening and normal <= 0.0:
                traction[:] = 0.0
                traction_rate[:] = 0.0
                if last:
                    force[i, 2, j] = -preload[i]
            else:
                for axis in range(2):
                    traction[axis] += kt * (relative[i, axis, j] - previous[axis])
                    traction_rate[axis, axis] += kt * (basis[j] - previous_basis)
                size = np.sqrt(traction[0] ** 2 + traction[1] ** 2)
                if size > limit:
                    direction = traction / size
                    radial = direction[0] * traction_rate[0] + direction[1] * traction_rate[1]
                    for axis in range(2):
                        traction_rate[axis] = limit / size * (traction_rate[axis] - direction[axis] * radial)
                        if opening:
                            traction_rate[axis, 2] += mu * kn * direction[axis] * basis[j]
                    traction[:] = limit * direction
                if last:
                    force[i, 2, j] = kn * relative[i, 2, j]
                    rate[i, 2, j, 2] = kn * basis[j]
            previous[:] = relative[i, :2, j]
            previous_basis[:] = basis[j]
            if last:
                force[i, :2, j] = traction
                rate[i, :2, j] = traction_rate
    return force, rate


class DenseBalance:
    """Residual and Jacobian of the harmonic balance of one problem in all its unknowns."""

    def __init__(
        self,
        problem: BladeProblem,
        harmonics: int,
        samples: int,
        cycles: int = 2,
        opening: bool = True,
        law: Law | None = None,
    ) -> None:
        """``law`` replaces the friction law of this file by another one."""
        self.problem, self.harmonics, self.cycles, self.opening = problem, harmonics, cycles, opening
        self.law = law or self._plain_law
        angle = 2.0 * np.pi * np.arange(samples) / samples
        rows = [np.ones(samples)]
        for k in range(1, harmonics + 1):
            rows += [np.cos(k * angle), np.sin(k * angle)]
        self.basis = np.array(rows).T
        self.analysis = self.basis.T * (2.0 / samples)
        self.analysis[0] *= 0.5
        self.load = np.zeros((2 * harmonics + 1, problem.size))
        self.load[1], self.load[2] = problem.force_cos, problem.force_sin

    def linear_matrix(self, omega: float, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Dynamic stiffness of all harmonics and its derivative to omega, (m n, m n) each."""
        problem, n, m = self.problem, self.problem.size, 2 * self.harmonics + 1
        matrix, rate = np.zeros((m, n, m, n)), np.zeros((m, n, m, n))
        matrix[0, :, 0, :] = stiffness
        for k in range(1, self.harmonics + 1):
            c, s = 2 * k - 1, 2 * k
            for p in (c, s):
                matrix[p, :, p, :] = stiffness - (k * omega) ** 2 * problem.mass
                rate[p, :, p, :] = -2.0 * k * k * omega * problem.mass
            matrix[c, :, s, :], matrix[s, :, c, :] = k * omega * problem.damping, -k * omega * problem.damping
            rate[c, :, s, :], rate[s, :, c, :] = k * problem.damping, -k * problem.damping
        return matrix.reshape(m * n, m * n), rate.reshape(m * n, m * n)

    def evaluate(self, omega: float, unknowns: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Residual (m n,), Jacobian (m n, m n), derivative to omega (m n,)."""
        problem, n, m = self.problem, self.problem.size, 2 * self.harmonics + 1
        matrix, rate = self.linear_matrix(omega, problem.stiffness)
        count = problem.n_contacts
        force, tangent = self.law(unknowns.reshape(m, n)[:, : 3 * count].T.reshape(count, 3, m))
        residual = (matrix @ unknowns - self.load.ravel()).reshape(m, n)
        residual[:, : 3 * count] += force.reshape(3 * count, m).T
        jacobian = matrix.reshape(m, n, m, n)
        for i in range(count):
            jacobian[:, 3 * i : 3 * i + 3, :, 3 * i : 3 * i + 3] += tangent[i].transpose(1, 0, 3, 2)
        return residual.ravel(), jacobian.reshape(m * n, m * n), rate @ unknowns

    def _plain_law(self, relative: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force coefficients (n_contacts, 3, m) and their derivative (n_contacts, 3, m, 3, m) for ``relative``."""
        problem = self.problem
        force, rate = contact_forces(
            np.ascontiguousarray(relative @ self.basis.T),
            self.basis,
            problem.tangential_stiffness,
            problem.normal_stiffness,
            problem.friction_coefficient,
            problem.preload,
            self.cycles,
            self.opening,
        )
        count, samples, m = len(force), self.basis.shape[0], self.basis.shape[1]
        flat = rate.transpose(2, 0, 1, 3, 4).reshape(samples, -1)
        tangent = (self.analysis @ flat).reshape(m, count, 3, 3, m).transpose(1, 2, 0, 3, 4)
        return force @ self.analysis.T, tangent

    def linear_stuck(self, omega: float) -> FloatArray:
        """Response with every contact stuck, the start of a curve."""
        matrix, _ = self.linear_matrix(omega, self.problem.stuck_stiffness())
        return np.linalg.solve(matrix, self.load.ravel())

    def solve(self, omega: float, start: FloatArray, tolerance: float = 1e-10, max_iterations: int = 40) -> Point:
        """Newton at a fixed frequency; raises RuntimeError if it fails."""
        unknowns = start.copy()
        scale = np.linalg.norm(self.load)
        for _ in range(max_iterations):
            residual, jacobian, _ = self.evaluate(omega, unknowns)
            if np.linalg.norm(residual) <= tolerance * scale:
                return Point(omega, unknowns.reshape(2 * self.harmonics + 1, -1))
            unknowns -= np.linalg.solve(jacobian, residual)
        raise RuntimeError(f"Newton did not converge at {omega / (2 * np.pi):.3f} Hz")

    def sweep(self, start_hz: float, stop_hz: float, step: float = 0.02, max_points: int = 400) -> list[Point]:
        """Pseudo-arc-length from ``start_hz`` up to ``stop_hz``; ``step`` in scaled units, halved when Newton fails."""
        omega, stop = 2 * np.pi * start_hz, 2 * np.pi * stop_hz
        points = [self.solve(omega, self.linear_stuck(omega))]
        displacement_scale = np.linalg.norm(self.linear_stuck(0.98 * 0.5 * (omega + stop)))
        scale = np.append(np.full(self.load.size, displacement_scale), 0.1 * omega)
        here = np.append(points[0].coefficients.ravel(), omega)
        tangent = np.append(np.zeros(self.load.size), 1.0)
        while len(points) < max_points and here[-1] < stop:
            tangent = self.tangent(here, tangent, scale)
            trial, iterations = self._correct(here + step * scale * tangent, tangent, scale)
            if trial is None:
                step *= 0.5
                if step < 1e-6:
                    raise RuntimeError(f"the step became too small at {here[-1] / (2 * np.pi):.3f} Hz")
                continue
            here = trial
            points.append(Point(float(here[-1]), here[:-1].reshape(2 * self.harmonics + 1, -1)))
            step *= min(2.0, max(0.5, 4.0 / iterations))
        return points

    def tangent(self, here: FloatArray, ahead: FloatArray, scale: FloatArray) -> FloatArray:
        """Unit tangent in scaled unknowns (m n + 1,) of the curve at ``here``, on the side of ``ahead``."""
        _, jacobian, omega_rate = self.evaluate(here[-1], here[:-1])
        bordered = np.vstack([np.column_stack([jacobian, omega_rate]) * scale, ahead])
        direction = np.linalg.solve(bordered, np.append(np.zeros(self.load.size), 1.0))
        return np.asarray(direction / np.linalg.norm(direction))

    def refine(self, omega: float, coefficients: FloatArray, iterations: int = 3) -> Point:
        """Newton from a solution of another program, in the plane across the curve: works at folds too."""
        here = np.append(coefficients.ravel(), omega)
        scale = np.append(np.full(self.load.size, np.linalg.norm(coefficients)), omega)
        tangent = self.tangent(here, np.append(np.zeros(self.load.size), 1.0), scale)
        for _ in range(iterations):
            residual, jacobian, omega_rate = self.evaluate(here[-1], here[:-1])
            bordered = np.vstack([np.column_stack([jacobian, omega_rate]) * scale, tangent])
            here = here - scale * np.linalg.solve(bordered, np.append(residual, 0.0))
        return Point(float(here[-1]), here[:-1].reshape(2 * self.harmonics + 1, -1))

    def _correct(
        self, predicted: FloatArray, tangent: FloatArray, scale: FloatArray, max_iterations: int = 8
    ) -> tuple[FloatArray | None, int]:
        """Newton in the plane through ``predicted`` normal to ``tangent``; None if it fails."""
        here = predicted.copy()
        for iteration in range(1, max_iterations + 1):
            residual, jacobian, omega_rate = self.evaluate(here[-1], here[:-1])
            if np.linalg.norm(residual) <= 1e-9 * np.linalg.norm(self.load):
                return here, iteration
            bordered = np.vstack([np.column_stack([jacobian, omega_rate]) * scale, tangent])
            off_plane = tangent @ ((here - predicted) / scale)
            here = here - scale * np.linalg.solve(bordered, np.append(residual, off_plane))
        return None, max_iterations


def first_harmonic(point: Point, output: FloatArray) -> float:
    """Amplitude of the first harmonic of ``output @ u`` in m."""
    return float(np.hypot(output @ point.coefficients[1], output @ point.coefficients[2]))


def main() -> None:
    """Print the peak of one bench problem: 3 harmonics, 128 samples, two cycles."""
    problem = load_blade_problem(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
    balance = DenseBalance(problem, harmonics=3, samples=128)
    begin = time.perf_counter()
    points = balance.sweep(*problem.window_hz)
    seconds = time.perf_counter() - begin
    amplitude = np.array([first_harmonic(point, problem.output) for point in points])
    peak = int(amplitude.argmax())
    print(
        f"{problem.n_contacts} contacts: peak {amplitude[peak] * 1e6:.2f} um (first harmonic) at "
        f"{points[peak].omega / (2 * np.pi):.2f} Hz, {len(points)} points, {seconds / len(points):.3f} s a point"
    )


if __name__ == "__main__":
    main()
