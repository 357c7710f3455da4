"""The Iwan joint along a path from its state without force: turning points that wait, and Masing's rules.

A motion loads along the backbone F. After it turned at ``x_r`` the force is ``F_r -+ 2 F(|x - x_r| / 2)``. A branch
that passes the turning point before its own closes that loop, and the branch that it interrupted continues; a branch
that reaches ``-x_0`` of the first turning point is on the backbone again. Displacements here count from the state
without force. The rules are exact for the continuous distribution of elements; nothing is discretised.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.contact.law.law import IndexArray
from stickslip.core.compiled import njit
from stickslip.core.validation import FloatArray


@dataclass(frozen=True)
class PathMemory:
    """Turning points (p, 2, m) m that wait, how many of them count (p, 2), and the displacement (p, 2) m."""

    turns: FloatArray
    depth: IndexArray
    displacement: FloatArray

    @classmethod
    def without_force(cls, n_pairs: int) -> PathMemory:
        """The state without force."""
        return cls(np.zeros((n_pairs, 2, 0)), np.zeros((n_pairs, 2), dtype=np.int64), np.zeros((n_pairs, 2)))

    def path_to_here(self) -> FloatArray:
        """(p, 2, 1 + m) m from here: where there is no force, then the turning points; no motion where fewer count."""
        counts = np.arange(self.turns.shape[2]) < self.depth[:, :, None]
        # Going on from the last turning point, or from the state without force, to itself is no motion.
        last = np.take_along_axis(
            np.concatenate([np.zeros((*self.depth.shape, 1)), self.turns], axis=2), self.depth[:, :, None], axis=2
        )
        path = np.concatenate([np.zeros((*self.depth.shape, 1)), np.where(counts, self.turns, last)], axis=2)
        return np.asarray(path - self.displacement[:, :, None])


def step_along(
    displacement: FloatArray, before: PathMemory, constants: FloatArray
) -> tuple[FloatArray, FloatArray, PathMemory]:
    """Force (p, 2) N, slope (p, 2) N/m and memory after a step to displacements (p, 2) m; constants (p, 2, 4)."""
    room = int(before.depth.max(initial=0)) + 1
    turns = np.zeros((*before.depth.shape, room))
    turns[:, :, : room - 1] = before.turns[:, :, : room - 1]
    depth, force, slope = before.depth.copy(), np.empty_like(displacement), np.empty_like(displacement)
    _step(displacement, before.displacement, constants, turns, depth, force, slope)
    return force, slope, PathMemory(turns, depth, displacement)


@njit(cache=True, nogil=True, error_model="numpy")
def backbone_force(x: float, stiffness: float, density: float, chi: float, largest: float) -> tuple[float, float]:
    """Force and its derivative at x >= 0."""
    if x >= largest:
        x = largest
    force = stiffness * x - density * x ** (chi + 2.0) / ((chi + 1.0) * (chi + 2.0))
    return force, 0.0 if x >= largest else stiffness - density * x ** (chi + 1.0) / (chi + 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
def loop_energy(amplitude: float, stiffness: float, density: float, chi: float, largest: float) -> float:
    """Energy of a closed loop of an amplitude."""
    inside = min(amplitude, largest)
    sliding, _ = backbone_force(largest, stiffness, density, chi, largest)
    micro = density * inside ** (chi + 3.0) / ((chi + 2.0) * (chi + 3.0))
    return float(4.0 * (micro + sliding * (amplitude - inside)))


@njit(cache=True, nogil=True, error_model="numpy")
def _moved(here: float, target: float, turns: FloatArray, depth: int) -> int:
    """The number of ``turns`` (m,) that count after a motion from ``here`` to ``target``; a new one is written."""
    if target == here:
        return depth
    sign = 1.0 if target > here else -1.0
    anchor = turns[depth - 1] if depth > 0 else 0.0
    if (here - anchor) * sign < 0.0:
        turns[depth] = here
        depth += 1
    while depth > 1 and (target - turns[depth - 2]) * sign >= 0.0:
        depth -= 2
    if depth == 1 and sign * target >= abs(turns[0]):
        depth = 0
    return depth


@njit(cache=True, nogil=True, error_model="numpy")
def _force(
    x: float, turns: FloatArray, depth: int, k: float, density: float, chi: float, largest: float
) -> tuple[float, float]:
    """Force and slope at x after the first ``depth`` of the turning points."""
    force, slope, anchor, factor = 0.0, 0.0, 0.0, 1.0
    for i in range(depth + 1):
        end = turns[i] if i < depth else x
        part, slope = backbone_force(abs(end - anchor) / factor, k, density, chi, largest)
        force += factor * (part if end >= anchor else -part)
        anchor, factor = end, 2.0
    return force, slope


@njit(cache=True, nogil=True, error_model="numpy")
def _step(
    displacement: FloatArray,
    before: FloatArray,
    constants: FloatArray,
    turns: FloatArray,
    depth: IndexArray,
    force: FloatArray,
    slope: FloatArray,
) -> None:
    """Update turns and depth, and fill force and slope (p, 2)."""
    for pair in range(displacement.shape[0]):
        for axis in range(2):
            k, density, chi, largest = constants[pair, axis]
            x, own = displacement[pair, axis], turns[pair, axis]
            depth[pair, axis] = _moved(before[pair, axis], x, own, depth[pair, axis])
            force[pair, axis], slope[pair, axis] = _force(x, own, depth[pair, axis], k, density, chi, largest)


@njit(cache=True, nogil=True, error_model="numpy")
def follow_from_rest(
    paths: FloatArray,
    turns_before: FloatArray,
    constants: FloatArray,
    synthesis: FloatArray,
    force: FloatArray,
    tangent: FloatArray,
) -> None:
    """Fill force (p, 2, n) and tangent (p, 2, n, width) of the second period of paths (p, 2, n); no width, no tangent.

    The motion goes along ``turns_before`` (p, 2, m) to rest and twice along the path. A period clips the force of each
    element to an interval, so the second one is periodic.
    """
    n, width, m = paths.shape[2], synthesis.shape[1], turns_before.shape[2]
    room = m + 2 * n + 2
    turns, by_turn, zero, by_here = np.empty(room), np.empty((room, width)), np.zeros(width), np.empty(width)
    for pair in range(paths.shape[0]):
        for axis in range(2):
            k, density, chi, largest = constants[pair, axis]
            depth, here = 0, 0.0
            by_here[:] = 0.0
            for step in range(m + 2 * n):
                j = (step - m) % n
                target = turns_before[pair, axis, step] if step < m else paths[pair, axis, j]
                by_turn[depth] = by_here  # counts where the motion turns here
                depth, here = _moved(here, target, turns, depth), target
                by_here[:] = zero if step < m else synthesis[j]
                if step < m + n:
                    continue
                value, anchor, factor = 0.0, 0.0, 1.0
                tangent[pair, axis, j] = 0.0
                for i in range(depth + 1):
                    end = turns[i] if i < depth else here
                    part, slope = backbone_force(abs(end - anchor) / factor, k, density, chi, largest)
                    value += factor * (part if end >= anchor else -part)
                    for q in range(width):
                        by_end = by_turn[i, q] if i < depth else by_here[q]
                        by_anchor = by_turn[i - 1, q] if i > 0 else 0.0
                        tangent[pair, axis, j, q] += slope * (by_end - by_anchor)
                    anchor, factor = end, 2.0
                force[pair, axis, j] = value
