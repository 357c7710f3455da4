"""The reduced, iterated Newton gives what a plain dense Newton in all unknowns gives, at every point of a curve."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from helpers import Blade
from stickslip.contact.law.coulomb_harmonics import harmonic_force, harmonic_tangent
from stickslip.results.response import ForcedResponse
from stickslip.solve.forced import forced_response
from stickslip.solve.harmonic import harmonic_modes, reduced
from stickslip.solve.harmonic.compliance import StuckStructure
from stickslip.solve.harmonic.low_rank import LowRankInverse

HARMONICS, SAMPLES = 3, 128


def curve_of(blade: Blade) -> ForcedResponse:
    return forced_response(
        blade.superelement,
        blade.pairs,
        blade.force_cos,
        blade.force_sin,
        frequency_hz=blade.window_hz,
        harmonics=HARMONICS,
        samples=SAMPLES,
    )


def dense_equations(blade: Blade, omega: float, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residual, Jacobian and derivative by omega of the harmonic balance in all unknowns, u (2H+1, n)."""
    m, c, k = blade.superelement.mass, blade.superelement.damping, blade.superelement.stiffness
    assert c is not None
    width, n = u.shape
    matrix, by_omega = np.zeros((width, n, width, n)), np.zeros((width, n, width, n))
    matrix[0, :, 0] = k
    for h in range(1, HARMONICS + 1):
        cosine, sine = 2 * h - 1, 2 * h
        for p in (cosine, sine):
            matrix[p, :, p], by_omega[p, :, p] = k - (h * omega) ** 2 * m, -2 * h * h * omega * m
        matrix[cosine, :, sine], matrix[sine, :, cosine] = h * omega * c, -h * omega * c
        by_omega[cosine, :, sine], by_omega[sine, :, cosine] = h * c, -h * c
    linear, slope = matrix.reshape(u.size, u.size), by_omega.reshape(u.size, u.size) @ u.ravel()
    relative = (u @ blade.operator.T).T.reshape(blade.n_pairs, 3, width)
    contact = harmonic_force(relative, blade.pairs, SAMPLES).force
    tangent = harmonic_tangent(relative, blade.pairs, SAMPLES, np.arange(blade.n_pairs))
    arms = blade.operator.reshape(blade.n_pairs, 3, n)
    joint = np.einsum("iau,iapbq,ibv->puqv", arms, tangent, arms, optimize=True)
    residual = (linear @ u.ravel()).reshape(u.shape) + contact.reshape(-1, width).T @ blade.operator
    residual[1] -= blade.force_cos
    residual[2] -= blade.force_sin
    return residual.ravel(), linear + joint.reshape(u.size, u.size), slope


def dense_correction(blade: Blade, omega: float, u: np.ndarray) -> float:
    """Relative change of a point by dense Newton in the plane across the curve, where folds are regular."""
    size, start = float(np.linalg.norm(u)), u.ravel().copy()
    here, frequency, across = start.copy(), omega, None
    for _ in range(3):
        residual, jacobian, slope = dense_equations(blade, frequency, here.reshape(u.shape))
        scaled = np.column_stack([jacobian * size, slope * omega])
        if across is None:
            across = np.linalg.svd(scaled)[2][-1]
        step = np.linalg.solve(np.vstack([scaled, across]), np.append(-residual, 0.0))
        here, frequency = here + size * step[:-1], frequency + omega * step[-1]
    return float(np.linalg.norm(here - start)) / size


def counted(solve: Callable[..., Any], calls: list[LowRankInverse]) -> Callable[..., Any]:
    """A method that adds its object to ``calls``."""

    def solve_counted(inverse: LowRankInverse, right: np.ndarray) -> np.ndarray:
        calls.append(inverse)
        return np.asarray(solve(inverse, right))

    return solve_counted


@pytest.mark.long
@pytest.mark.parametrize("way", ["factor", "iteration", "iteration with few near modes", "large joint"])
def test_every_point_equals_the_dense_newton(blade: Blade, way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if way != "factor":
        monkeypatch.setattr(reduced, "DIRECT_SIZE", -1)
    solved: list[LowRankInverse] = []
    if way == "large joint":
        monkeypatch.setattr("stickslip.solve.harmonic.compliance.FEW_MODES", 0)
        for module in (reduced, harmonic_modes):
            monkeypatch.setattr(module, "LARGE_ROWS", 1)
        monkeypatch.setattr(LowRankInverse, "solve", counted(LowRankInverse.solve, solved))
    if way == "iteration with few near modes":
        near_range = (3.0,)  # the only default value
        assert len(StuckStructure.compliance.__defaults__ or ()) == len(near_range)
        monkeypatch.setattr(StuckStructure.compliance, "__defaults__", near_range)
    curve = curve_of(blade)
    assert curve.converged
    assert (curve.contact_state == 2).any()
    assert bool(solved) == (way == "large joint")
    changes = [
        dense_correction(blade, 2 * np.pi * float(frequency), u.T)
        for frequency, u in zip(curve.frequency_hz, curve.displacement, strict=True)
    ]
    assert max(changes) < 1e-8
