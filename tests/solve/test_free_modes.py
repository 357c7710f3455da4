"""The modes without contact, shared by the cases of one structure."""

from __future__ import annotations

import numpy as np
import pytest

from stickslip.solve import free_modes as module
from stickslip.solve.free_modes import free_modes
from stickslip.solve.harmonic.damping import modal_basis


def matrices(size: int, soft: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    return np.eye(size), soft * (2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1))


def test_equal_matrices_have_their_modes_once(monkeypatch: pytest.MonkeyPatch) -> None:
    mass, stiffness = matrices(6)
    known = free_modes(mass, stiffness)
    monkeypatch.setattr(module, "modal_basis", None)  # a second computation would fail
    again = free_modes(mass.copy(), stiffness.copy())
    assert again[0] is known[0]
    assert again[1] is known[1]


def test_other_or_changed_matrices_have_their_own() -> None:
    mass, stiffness = matrices(6)
    first = free_modes(mass, stiffness)[0]
    np.testing.assert_allclose(free_modes(mass, 4.0 * stiffness)[0], 2.0 * first)
    first = free_modes(mass, stiffness)[0]
    mass *= 0.25  # in its place, as a caller may
    np.testing.assert_allclose(free_modes(mass, stiffness)[0], 2.0 * first)
    stiffness *= 9.0
    np.testing.assert_allclose(free_modes(mass, stiffness)[0], modal_basis(mass, stiffness)[0], rtol=1e-12)


def test_a_large_structure_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LARGEST_SHARED", 3)
    mass, stiffness = matrices(4)
    assert free_modes(mass, stiffness)[1] is not free_modes(mass, stiffness)[1]
