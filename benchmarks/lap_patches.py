"""What rigid patches of an interface do to microslip: a lap of CD1's size with elastic faces, and with five patches.

``python benchmarks/lap_patches.py`` needs no data. Two beams overlap by 120 x 25.4 mm2, pressed by three cones of
pressure, as in two_beam.py. Both interfaces have the same beams, pressure and frequency; either the faces move as the
mesh does, or each of five patches as the mean rigid motion of its faces, which is all that the reduced matrices of
CD1 know. Slip is of first order: the stuck mode, with the force T = mu p [1 - exp(-k d/(mu p))] per area of exponential
asperities (the one that the equal pairs of two_beam.py approximate) and Masing's loop. docs/validation.md has the
result.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.optimize
import scipy.sparse
from two_beam import BOLT_FORCE_N, CONE_RADIUS_M, TANGENTIAL_RATIO, bolt_pressure, rigid_rows

from stickslip.structure.elasticity import Material, Structure, assemble, natural_frequencies
from stickslip.structure.factor import factorize
from stickslip.structure.mesh import Mesh

STEEL = Material(2e11, 0.29, 7800.0)
LENGTH, LAP, WIDTH, HALF = 0.62, 0.12, 0.0254, 0.0127  # m; HALF: height of one beam inside of the lap
ALONG, OUTSIDE, ACROSS, THROUGH = 48, 14, 8, 3  # elements along the lap, along each end, across, through a half
BOLTS = 0.03 * np.array([(-1, 0), (0, 0), (1, 0)])
PATCH_EDGES = np.array([-0.036, -0.012, 0.012, 0.036])  # m, those of CD1
PATCH_STIFFNESS = 7e12  # N/m3, that of CD1: the patches then set the frequency of all cases
AMPLITUDES = (6.44e-6, 3.65e-5)  # m kg^0.5, lowest and highest of CD1
HEAD_RADIUS = 0.00635  # m
HARD = 3e13  # N/m3, nearly rigid contact
SOFT_SUPPORT = 1e3  # N/m at each unknown: makes the free beams regular


@dataclass(frozen=True)
class Lap:
    """``rows`` (3 n, n_unknowns) t1, t2, n of the pairs; ``position`` (n, 3) m; ``area`` (n,) m2; ``heads`` (N) a load
    of 11,580 N on each head and nut."""

    structure: Structure
    rows: Any
    position: np.ndarray
    area: np.ndarray
    heads: np.ndarray


def make_lap() -> Lap:
    """Bricks; the nodes of the interface are double, one for each beam."""
    outer = np.linspace(-LENGTH / 2, -LAP / 2, OUTSIDE + 1)[:-1]
    x = np.concatenate([outer, np.linspace(-LAP / 2, LAP / 2, ALONG + 1), -outer[::-1]])
    y = np.linspace(-WIDTH / 2, WIDTH / 2, ACROSS + 1)
    start, stop = OUTSIDE, OUTSIDE + ALONG
    number: dict[tuple[int, int, int, bool], int] = {}

    def node(i: int, j: int, k: int, upper: bool) -> int:
        return number.setdefault((i, j, k, upper), len(number))

    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = [
        [node(i + a, j + b, k + c, i >= stop or (i >= start and k >= 0)) for a, b, c in corners]
        for i in range(len(x) - 1)
        for j in range(ACROSS)
        for k in range(-THROUGH, THROUGH)
    ]
    points = np.array([(x[i], y[j], k * HALF / THROUGH) for i, j, k, _ in number])
    structure = assemble(Mesh(points, np.array(cells)), STEEL, fixed_nodes=[])
    places = [(i, j) for i in range(start, stop + 1) for j in range(ACROSS + 1)]
    lower, upper = (np.array([number[i, j, 0, side] for i, j in places]) for side in (False, True))
    one = scipy.sparse.eye_array(len(points), format="csr")
    width_x, width_y = _parts(x[start : stop + 1]), _parts(y)
    return Lap(
        structure,
        scipy.sparse.csr_matrix(scipy.sparse.kron(one[lower] - one[upper], np.eye(3))),
        points[lower],
        np.array([width_x[i - start] * width_y[j] for i, j in places]),
        _head_load(points),
    )


def _parts(edges: np.ndarray) -> np.ndarray:
    """Length that each point represents."""
    steps = np.diff(edges)
    return np.asarray(0.5 * (np.append(steps, 0.0) + np.insert(steps, 0, 0.0)))


def _head_load(points: np.ndarray) -> np.ndarray:
    load: np.ndarray = np.zeros(points.shape)
    for side in (-1.0, 1.0):
        outside = np.isclose(points[:, 2], side * HALF) & (np.abs(points[:, 0]) <= LAP / 2)
        for bolt in BOLTS:
            weight: np.ndarray = outside * np.exp(-((np.linalg.norm(points[:, :2] - bolt, axis=1) / HEAD_RADIUS) ** 4))
            load[:, 2] -= side * BOLT_FORCE_N * weight / weight.sum()
    return np.asarray(load.ravel())


def solved_pressure(lap: Lap) -> np.ndarray:
    """(n,) Pa of flat frictionless faces under the heads; the set of closed pairs is iterated."""
    normal, closed = lap.rows[2::3], np.ones(len(lap.area), bool)
    support = scipy.sparse.diags(np.full(lap.structure.stiffness.shape[0], SOFT_SUPPORT))
    for _ in range(50):
        spring = scipy.sparse.diags(np.where(closed, HARD * lap.area, 0.0))
        matrix = lap.structure.stiffness + support + normal.T @ spring @ normal
        closure = normal @ factorize(matrix.tocsc()).solve(lap.heads)
        if ((closure > 0.0) == closed).all():
            return np.where(closed, HARD * closure, 0.0)
        closed = closure > 0.0
    raise SystemExit("the set of closed pairs does not settle.")


def patch_motion(lap: Lap) -> Any:
    """(3 n, 3 n): each pair moves as the mean rigid motion of its patch, weighted by area."""
    patch = np.digitize(lap.position[:, 0], PATCH_EDGES)
    blocks, order = [], []
    for number in range(patch.max() + 1):
        inside = np.flatnonzero(patch == number)
        arm = lap.position[inside] - np.average(lap.position[inside], axis=0, weights=lap.area[inside])
        rigid, weight = rigid_rows(arm).reshape(-1, 6), np.repeat(lap.area[inside], 3)
        blocks.append(rigid @ np.linalg.solve(rigid.T @ (weight[:, None] * rigid), rigid.T * weight))
        order.append((3 * inside[:, None] + np.arange(3)).ravel())
    back = np.argsort(np.concatenate(order))
    return scipy.sparse.block_diag(blocks, format="csr")[back][:, back]


def stuck_mode(lap: Lap, rows: Any, stiffness: float, pressed: np.ndarray) -> tuple[float, np.ndarray]:
    """Hz of the first bending mode along the bolts, and its motion (n, 3) of the pairs with unit modal mass."""
    spring = np.outer(np.where(pressed, stiffness * lap.area, 0.0), [TANGENTIAL_RATIO, TANGENTIAL_RATIO, 1.0]).ravel()
    matrix = (lap.structure.stiffness + rows.T @ scipy.sparse.diags(spring) @ rows).tocsc()
    frequency_hz, modes = natural_frequencies(matrix, lap.structure.mass, 9)
    for frequency, mode in zip(frequency_hz, modes.T, strict=True):
        along = (mode.reshape(-1, 3) ** 2).sum(axis=0)
        if frequency > 5.0 and along[2] > along[1]:
            return float(frequency), (rows @ mode).reshape(-1, 3)
    raise SystemExit("no bending mode among the first nine.")


def microslip(
    motion: np.ndarray, area: np.ndarray, pressure: np.ndarray, stiffness: float, friction: float, frequency_hz: float
) -> list[tuple[float, float]]:
    """Relative change of the frequency and damping ratio at each of AMPLITUDES, of pressed pairs.

    x = k d/(mu p) with the sliding amplitude d; the secant stiffness is k (1 - exp(-x))/x, and Masing's loop has
    4 mu p d [2 - 2 (1 - exp(-x))/x - (1 - exp(-x))] per area.
    """
    result = []
    for amplitude in AMPLITUDES:
        slide = amplitude * np.hypot(motion[:, 0], motion[:, 1])
        spring, limit = TANGENTIAL_RATIO * stiffness * area, friction * pressure * area
        x = np.maximum(spring * slide / limit, 1e-9)
        secant = -np.expm1(-x) / x
        energy = (2.0 * np.pi * frequency_hz * amplitude) ** 2
        loop = 4.0 * limit * slide * (2.0 * (1.0 - secant) + np.expm1(-x))
        shift = -0.5 * float((spring * slide**2 * (1.0 - secant)).sum()) / energy
        result.append((shift, float(loop.sum()) / (2.0 * np.pi * energy)))
    return result


def report(lap: Lap, name: str, rows: Any, pressure: np.ndarray, wanted_hz: float) -> None:
    """Fit the stiffness to a frequency and print shift and damping."""
    pressed = pressure > 0.0
    logarithm = scipy.optimize.brentq(
        lambda value: stuck_mode(lap, rows, np.exp(value), pressed)[0] - wanted_hz,
        np.log(1e11),
        np.log(1e15),
        xtol=0.02,
    )
    stiffness = float(np.exp(logarithm))
    frequency, motion = stuck_mode(lap, rows, stiffness, pressed)
    for friction in (0.2, 0.4):
        low, high = microslip(motion[pressed], lap.area[pressed], pressure[pressed], stiffness, friction, frequency)
        print(
            f"{name}: {frequency:.2f} Hz, {stiffness:.2e} N/m3, friction {friction}: "
            f"shift {100.0 * (high[0] - low[0]):.3f} %, damping {low[1]:.2e} to {high[1]:.2e}",
            flush=True,
        )


def main() -> None:
    """Print the four cases."""
    lap = make_lap()
    patches = patch_motion(lap) @ lap.rows
    cones = bolt_pressure(lap.position, lap.area, BOLTS, CONE_RADIUS_M)
    wanted, _ = stuck_mode(lap, patches, PATCH_STIFFNESS, cones > 0.0)
    flat = solved_pressure(lap)
    print(f"flat faces touch on {100.0 * lap.area[flat > 0.0].sum() / lap.area.sum():.0f} % of the lap")
    for name, pressure in (("cones", cones), ("flat faces", flat)):
        report(lap, f"{name}, five rigid patches", patches, pressure, wanted)
        report(lap, f"{name}, elastic faces", lap.rows, pressure, wanted)


if __name__ == "__main__":
    main()
