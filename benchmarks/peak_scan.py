"""Whether curves step over a resonance: a dense Newton method of its own between the points of each curve.

    python benchmarks/peak_scan.py light,multi,close,narrow,wide 200:212 [--most-unknowns 400]

Shares no code with the package but the curve that it tests. The balance is dense, in the displacements that the pairs
feel; the friction law is a radial return from a slider at the mean of its motion, marched through three periods (the
product's slider follows a tractrix, which differs by the length of a sample). The program solves

* each point of the curve again;
* between each two neighbours, in the plane across the middle of their chord, and so on in both halves until the
  solution is closer to the chord than a fiftieth of it;
* at each natural frequency, and half a width beside it, of four structures, over each harmonic of the balance: stuck,
  free, and with the stiffness that the first harmonics see at both neighbours; from both neighbours' tangents.

A maximum of these solutions is a missed peak if it is more than 1 % higher than the peak that the curve itself gives
there, more than 1 % of its highest amplitude, and no warning names its frequency. The program does not see isolated
curves, and no other numbers of harmonics and samples than those of the curve.
"""

from __future__ import annotations

import argparse
import itertools
import re
import time
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg
from numba import njit
from torture import seed_range
from torture_problems import Problem, make, modal_damping_matrix, modes_of, with_springs
from torture_structures import FloatArray

import stickslip as ss
from stickslip.results.peaks import peaks

HIGHER, VISIBLE = 1.01, 0.01
CYCLES = 3
FLAT = 0.02  # distance of a middle from its chord over the chord
SHORTEST = 1e-4  # chord, in units of the plane of the curve
DEEPEST = 12
FAR = 50.0  # another branch, or a resonance far above the chord: no halves
NAMED_WITHIN = 2e-3
WIDTHS_BESIDE = 5.0  # natural frequencies count for a chord up to so many widths beyond its ends


@njit(cache=True)
def march(motion, mean, basis, kt, kn, mu, preload, cycles):  # type: ignore[no-untyped-def]
    """Force (p, 3, samples) of pairs beyond that at rest, and its derivative (p, 3, samples, 3, m)."""
    n_pairs, _, samples = motion.shape
    m = basis.shape[1]
    force = np.zeros((n_pairs, 3, samples))
    rate = np.zeros((n_pairs, 3, samples, 3, m))
    for i in range(n_pairs):
        traction, previous = np.zeros(2), mean[i].copy()
        change, before = np.zeros((2, 3, m)), np.zeros(m)
        before[0] = 1.0
        for step in range(cycles * samples):
            j = step % samples
            last = step >= (cycles - 1) * samples
            pressed = preload[i] + kn[i] * motion[i, 2, j]
            if pressed <= 0.0:
                traction[:] = 0.0
                change[:] = 0.0
            else:
                for axis in range(2):
                    traction[axis] += kt[i, axis] * (motion[i, axis, j] - previous[axis])
                    change[axis, axis] += kt[i, axis] * (basis[j] - before)
                size = np.sqrt(traction[0] ** 2 + traction[1] ** 2)
                limit = mu[i] * pressed
                if size > limit:
                    direction = traction / size
                    radial = direction[0] * change[0] + direction[1] * change[1]
                    for axis in range(2):
                        change[axis] = limit / size * (change[axis] - direction[axis] * radial)
                        change[axis, 2] += mu[i] * kn[i] * direction[axis] * basis[j]
                    traction[:] = limit * direction
                if last:
                    rate[i, 2, j, 2] = kn[i] * basis[j]
            if last:
                force[i, 2, j] = max(pressed, 0.0) - max(preload[i], 0.0)
                force[i, :2, j] = traction
                rate[i, :2, j] = change
            previous[:] = motion[i, :2, j]
            before[:] = basis[j]
    return force, rate


@dataclass(frozen=True)
class Solution:
    """A solution: circular frequency, displacements that the pairs feel (m, r), the output (m,), and derivatives."""

    omega: float
    felt: FloatArray
    output: FloatArray
    slope: FloatArray  # (m, r) along the curve for a unit of omega, if there is one
    stiffness: FloatArray  # (r, r) that the first harmonic sees

    @property
    def amplitude(self) -> float:
        """Largest absolute value of the output over the period, of 512 instants."""
        angle = 2.0 * np.pi * np.arange(512) / 512
        signal = np.full(512, self.output[0])
        for k in range(1, (len(self.output) + 1) // 2):
            signal += self.output[2 * k - 1] * np.cos(k * angle) + self.output[2 * k] * np.sin(k * angle)
        return float(np.abs(signal).max())


class Dense:
    """The harmonic balance of a problem in the r displacements that its pairs feel."""

    def __init__(self, problem: Problem, harmonics: int, samples: int = 128) -> None:
        structure = problem.structure
        self.problem, self.harmonics, self.m = problem, harmonics, 2 * harmonics + 1
        self.mass, self.stiffness = structure.mass, structure.stiffness
        springs = np.column_stack([problem.tangential_stiffness, problem.normal_stiffness])
        self.stuck_stiffness = with_springs(structure, np.where(problem.preload[:, None] >= 0.0, springs, 0.0))
        damping = problem.damping
        if damping is None:
            assert problem.modal_damping_ratio is not None
            stuck = modes_of(structure.mass, self.stuck_stiffness)
            damping = modal_damping_matrix(structure.mass, *stuck, problem.modal_damping_ratio)
        self.damping = damping
        self.space = scipy.linalg.orth(structure.operator.T, rcond=1e-12)  # (n, r)
        self.operator = structure.operator @ self.space
        angle = 2.0 * np.pi * np.arange(samples) / samples
        self.basis = np.ones((samples, self.m))
        for k in range(1, harmonics + 1):
            self.basis[:, 2 * k - 1], self.basis[:, 2 * k] = np.cos(k * angle), np.sin(k * angle)
        self.analysis = self.basis.T * (2.0 / samples)
        self.analysis[0] *= 0.5
        self.load = np.zeros((self.m, structure.mass.shape[0]))
        for k in range(problem.force_cos.shape[1]):
            self.load[2 * k + 1], self.load[2 * k + 2] = problem.force_cos[:, k], problem.force_sin[:, k]

    def forces(self, felt: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force coefficients (m, r) on the felt displacements (m, r), and derivative (m, r, m, r)."""
        problem, count = self.problem, self.problem.preload.size
        relative = np.ascontiguousarray((self.operator @ felt.T).reshape(count, 3, self.m))
        force, rate = march(
            np.ascontiguousarray(relative @ self.basis.T), np.ascontiguousarray(relative[:, :2, 0]), self.basis,
            problem.tangential_stiffness, problem.normal_stiffness, problem.friction_coefficient, problem.preload,
            CYCLES,
        )  # fmt: skip
        by_pair = np.tensordot(rate, self.analysis, axes=(2, 1))  # (p, 3, 3, m in, m out)
        operator = self.operator.reshape(count, 3, -1)
        derivative = np.einsum("pia,pijqk,pjb->kaqb", operator, by_pair, operator, optimize=True)
        coefficients = (force @ self.analysis.T).reshape(-1, self.m)
        return coefficients.T @ self.operator, derivative

    def structure(self, omega: float, pull: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Of forces (m, r): felt motion, its slope by omega, compliance (m, r, m, r), and the output."""
        output = self.problem.structure.output
        felt, slope = np.zeros_like(pull), np.zeros_like(pull)
        out = np.zeros(self.m)
        compliance = np.zeros((self.m, pull.shape[1], self.m, pull.shape[1]))
        for k in range(self.harmonics + 1):
            c, s = max(2 * k - 1, 0), 2 * k
            dynamic = self.stiffness - (k * omega) ** 2 * self.mass + 1j * k * omega * self.damping
            sides = self.load[c] - 1j * self.load[s] * (k > 0), self.space @ (pull[c] - 1j * pull[s] * (k > 0))
            factors = scipy.linalg.lu_factor(dynamic, check_finite=False)
            every = scipy.linalg.lu_solve(factors, np.column_stack([sides[0] - sides[1], self.space]))
            motion, flexible = every[:, 0], self.space.T @ every[:, 1:]
            rate = scipy.linalg.lu_solve(factors, (2 * k * k * omega * self.mass - 1j * k * self.damping) @ motion)
            moved, changed, value = self.space.T @ motion, self.space.T @ rate, output @ motion
            felt[c], slope[c], out[c] = moved.real, changed.real, value.real
            compliance[c, :, c] = flexible.real
            if k:
                felt[s], slope[s], out[s] = -moved.imag, -changed.imag, -value.imag
                compliance[s, :, s] = flexible.real
                compliance[c, :, s], compliance[s, :, c] = flexible.imag, -flexible.imag
        return felt, slope, compliance, out

    def solve(
        self, start: FloatArray, omega: float, plane: tuple[FloatArray, float] | None, scale: tuple[float, float]
    ) -> Solution | None:
        """Newton in a plane through the start (normal of felt displacements and omega, scaled), or at fixed omega."""
        felt, first, size = start.copy(), start.copy(), start.size
        began = omega
        for _ in range(25):
            pull, derivative = self.forces(felt)
            target, slope, compliance, out = self.structure(omega, pull)
            residual = (felt - target).ravel()
            matrix = np.eye(size) + np.tensordot(compliance, derivative, axes=2).reshape(size, size)
            if np.linalg.norm(residual) < 1e-9 * np.linalg.norm(felt):
                return Solution(omega, felt, out, self._slope(matrix, slope), self._seen(derivative))
            full = np.zeros((size + 1, size + 1))
            full[:size, :size], full[:size, size] = matrix, -slope.ravel() * scale[1] / scale[0]
            right = np.append(residual / scale[0], 0.0)
            if plane is None:
                full[size, size] = 1.0
            else:
                full[size, :size], full[size, size] = plane[0].ravel(), plane[1]
                right[size] = (
                    plane[0].ravel() @ (felt - first).ravel() / scale[0] + plane[1] * (omega - began) / scale[1]
                )
            try:
                step = np.linalg.solve(full, right)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(step).all():
                return None
            felt, omega = felt - scale[0] * step[:size].reshape(felt.shape), omega - scale[1] * step[size]
            if omega <= 0.0:
                return None
        return None

    def _slope(self, matrix: FloatArray, slope: FloatArray) -> FloatArray:
        try:
            return np.asarray(np.linalg.solve(matrix, slope.ravel()).reshape(slope.shape))
        except np.linalg.LinAlgError:
            return np.zeros_like(slope)

    def _seen(self, derivative: FloatArray) -> FloatArray:
        middle = 0.5 * (derivative[1, :, 1] + derivative[2, :, 2])
        return np.asarray(0.5 * (middle + middle.T))

    def resonances(self, seen: FloatArray | None) -> list[tuple[float, float]]:
        """Natural frequencies over each harmonic, and half-power widths, rad/s; None is the stuck structure."""
        stiffness = self.stuck_stiffness if seen is None else self.stiffness + self.space @ seen @ self.space.T
        omega, modes = modes_of(self.mass, stiffness)
        width = np.einsum("ij,ik,kj->j", modes, self.damping, modes)
        return [(w / k, b / k) for w, b in zip(omega, width, strict=True) for k in range(1, self.harmonics + 1)]


@dataclass
class Scan:
    """The solutions between the points of a curve."""

    dense: Dense
    scale: tuple[float, float]
    failed: list[float] = field(default_factory=list)
    solved: int = 0

    def between(self, a: Solution, b: Solution) -> list[Solution]:
        """All solutions between two points, in order."""
        marks = [mark for side in (a, b) for mark in self.dense.resonances(side.stiffness)]
        marks += self.dense.resonances(None) + self.dense.resonances(np.zeros_like(a.stiffness))
        inner = []
        low, high = sorted((a.omega, b.omega))
        places: set[float] = set()
        for omega, width in marks:
            if low - WIDTHS_BESIDE * width < omega < high + WIDTHS_BESIDE * width and width < high - low:
                places |= {omega + shift * width for shift in (-0.5, 0.0, 0.5)}
        for place in sorted(each for each in places if low < each < high):
            inner += self._at(a, b, place)
        inner.sort(key=lambda each: each.omega, reverse=bool(b.omega < a.omega))
        chain = [a, *inner, b]
        answer: list[Solution] = []
        for left, right in itertools.pairwise(chain):
            answer += self._halves(left, right, 0)
            answer.append(right)
        return answer[:-1]

    def _at(self, a: Solution, b: Solution, omega: float) -> list[Solution]:
        share = (omega - a.omega) / (b.omega - a.omega)
        near = a if share < 0.5 else b
        starts = [a.felt + share * (b.felt - a.felt), near.felt + near.slope * (omega - near.omega)]
        for start in starts:
            solved = self.dense.solve(start, omega, None, self.scale)
            self.solved += 1
            if solved is not None:
                return [solved]
        self.failed.append(omega / 2 / np.pi)
        return []

    def _halves(self, a: Solution, b: Solution, depth: int) -> list[Solution]:
        chord = (b.felt - a.felt) / self.scale[0], (b.omega - a.omega) / self.scale[1]
        length = float(np.sqrt((chord[0] ** 2).sum() + chord[1] ** 2))
        if length < SHORTEST or depth > DEEPEST:
            return []
        plane = chord[0] / length, chord[1] / length
        middle, omega = 0.5 * (a.felt + b.felt), 0.5 * (a.omega + b.omega)
        solved = self.dense.solve(middle, omega, plane, self.scale)
        self.solved += 1
        if solved is None:
            self.failed.append(omega / 2 / np.pi)
            return []
        away = np.sqrt(
            (((solved.felt - middle) / self.scale[0]) ** 2).sum() + ((solved.omega - omega) / self.scale[1]) ** 2
        )
        if away < FLAT * length or away > FAR * length:
            return [solved]
        return [*self._halves(a, solved, depth + 1), solved, *self._halves(solved, b, depth + 1)]


@dataclass(frozen=True)
class Finding:
    """A maximum that is higher than the curve: Hz, amplitude, that of the curve there, whether a warning names it."""

    frequency_hz: float
    amplitude: float
    tested: float
    named: bool


def named(warnings: tuple[str, ...], hertz: float) -> bool:
    """Whether a warning names a frequency."""
    lists = re.findall(r"((?:[\d.]+, )*[\d.]+(?:, \.\.\.)?) Hz", " ".join(warnings))
    numbers = [float(number) for words in lists for number in re.findall(r"\d+\.?\d*", words)]
    return any(abs(each - hertz) <= NAMED_WITHIN * hertz for each in numbers)


def scan(problem: Problem, response: ss.ForcedResponse, clock: float = 120.0) -> tuple[list[Finding], Scan, str]:
    """Maxima between the points of a curve, and words on what was not tested."""
    dense = Dense(problem, response.harmonics)
    heights = response.amplitude(problem.structure.output)
    raw = [response.pair_coefficients(i).reshape(-1, dense.m).T for i in range(response.n_points)]
    to_felt = np.linalg.pinv(dense.operator)
    felt = [coefficients @ to_felt.T for coefficients in raw]
    omega = 2.0 * np.pi * response.frequency_hz
    low, high = sorted(problem.window_hz)
    scale = max(float(np.linalg.norm(each)) for each in felt), 2.0 * np.pi * (high - low)
    scanner = Scan(dense, scale)
    own: list[Solution | None] = []
    for each, frequency in zip(felt, omega, strict=True):
        tangent = np.zeros_like(each), 1.0
        own.append(dense.solve(each, frequency, tangent, scale))
    lost = sum(each is None for each in own)
    own_heights = np.array([np.nan if each is None else each.amplitude for each in own])
    shift = np.nanmax(np.abs(own_heights / heights - 1.0)) if lost < len(own) else np.nan
    # The curve's own peaks between its points.
    tops = peaks(response.frequency_hz, heights)
    end, findings = time.process_time() + clock, []
    left_out = 0
    for i in range(len(own) - 1):
        a, b = own[i], own[i + 1]
        if a is None or b is None or response.part[i] != response.part[i + 1]:
            left_out += 1
            continue
        if time.process_time() > end:
            left_out += 1
            continue
        inner = scanner.between(a, b)
        if not inner:
            continue
        best = max(inner, key=lambda each: each.amplitude)
        tested = max(float(own_heights[i]), float(own_heights[i + 1]))
        tested = max([tested, *(top.amplitude for top in tops if abs(top.point - i - 0.5) < 2)])
        if best.amplitude > HIGHER * tested and best.amplitude > VISIBLE * heights.max():
            hertz = best.omega / 2 / np.pi
            findings.append(Finding(hertz, best.amplitude, tested, named(tuple(response.warnings), hertz)))
    words = (
        f"own points differ by up to {100 * shift:.2g} %, {lost} lost, {left_out} of {len(own) - 1} parts not tested"
    )
    return findings, scanner, words


def main() -> None:
    """Solve, scan, print."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("classes", type=lambda text: text.split(","))
    parser.add_argument("seeds", type=seed_range)
    parser.add_argument("--most-unknowns", type=int, default=400)
    options = parser.parse_args()
    for kind in options.classes:
        for seed in options.seeds:
            report(kind, seed, make(kind, seed), options.most_unknowns)


def doubts(response: ss.ForcedResponse) -> str:
    """Words on the points whose verdict on stability is doubtful."""
    if response.doubtful is None:
        return "no stability"
    return f"{int(response.doubtful.sum())} doubtful, {int((~response.stable_points).sum())} unstable"


def report(kind: str, seed: int, problem: Problem, most_unknowns: int) -> None:
    """One line for a problem, and one for each finding."""
    r = min(problem.structure.operator.shape)
    if 7 * r > most_unknowns:
        print(f"{kind} {seed}: {7 * r} unknowns, not tested", flush=True)
        return
    begin = time.process_time()
    try:
        response = problem.solve()
    except ss.ConvergenceError as error:
        print(f"{kind} {seed}: {str(error)[:100]}", flush=True)
        return
    middle = time.process_time()
    findings, scanner, words = scan(problem, response)
    print(
        f"{kind} {seed}: converged {response.converged}, {response.n_points} points, {scanner.solved} solved between, "
        f"{len(scanner.failed)} failed; {words}; {doubts(response)}; "
        f"{middle - begin:.1f} + {time.process_time() - middle:.1f} s",
        flush=True,
    )
    for each in findings:
        print(
            f"    {'named' if each.named else 'SILENT'} {each.frequency_hz:.5f} Hz: {each.amplitude:.5g} m, curve "
            f"{each.tested:.5g} m ({each.amplitude / each.tested:.3g}); highest "
            f"{response.amplitude(problem.structure.output).max():.4g}",
            flush=True,
        )


if __name__ == "__main__":
    main()
