"""Eigenvalues near a shift: right where they exist, and an end with a sentence where round-off hides them."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse

from sentences import rejects
from stickslip.core.errors import ConvergenceError
from stickslip.structure import lanczos
from stickslip.structure.factor import factorize
from stickslip.structure.lanczos import eigenpairs_near


def chain(size: int) -> scipy.sparse.csr_matrix:
    """Stiffness of a chain of unit springs between two walls."""
    return scipy.sparse.diags([-np.ones(size - 1), 2.0 * np.ones(size), -np.ones(size - 1)], [-1, 0, 1], format="csr")


def test_values_of_a_chain() -> None:
    values, vectors = eigenpairs_near(chain(50), 3, 0.0, factorize(chain(50)))
    wanted = 4.0 * np.sin(0.5 * np.pi * np.arange(1, 4) / 51) ** 2
    np.testing.assert_allclose(np.sort(values), wanted, rtol=1e-10)
    np.testing.assert_allclose(chain(50) @ vectors, vectors * values, atol=1e-10)


def test_no_convergence_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanczos, "MOST_RESTARTS", 1)
    with rejects(ConvergenceError):
        eigenpairs_near(chain(5000), 30, 2.9, factorize(chain(5000) - 2.9 * scipy.sparse.identity(5000)))
