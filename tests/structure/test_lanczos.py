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


@pytest.mark.slow
@pytest.mark.parametrize("count", [7, 8, 10, 13])
@pytest.mark.parametrize("with_mass", [False, True])
def test_every_copy_of_a_multiple_value_is_found(count: int, with_mass: bool) -> None:
    """As of eight equal blades: a Krylov subspace alone finds copies by round-off only, and misses some here."""
    wanted = np.repeat(np.linspace(1.0, 3.0, 80) ** 6, 8)
    size = wanted.size
    mass = scipy.sparse.diags(np.linspace(1.0, 2.0, size)).tocsr() if with_mass else None
    matrix = scipy.sparse.diags(wanted if mass is None else wanted * mass.diagonal()).tocsr()
    values, vectors = eigenpairs_near(matrix, count, 0.0, factorize(matrix), mass)
    np.testing.assert_allclose(np.sort(values), wanted[:count], rtol=1e-10)
    weighted = vectors if mass is None else mass @ vectors
    np.testing.assert_allclose(vectors.T @ weighted, np.eye(count), atol=1e-8)
    np.testing.assert_allclose(matrix @ vectors, weighted * values, atol=1e-7 * wanted[count])


def test_all_but_one_of_few_values_are_found() -> None:
    values, _ = eigenpairs_near(chain(12), 11, 0.0, factorize(chain(12)))
    np.testing.assert_allclose(np.sort(values), 4.0 * np.sin(0.5 * np.pi * np.arange(1, 12) / 13) ** 2, rtol=1e-10)


def test_no_convergence_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanczos, "MOST_RESTARTS", 1)
    with rejects(ConvergenceError):
        eigenpairs_near(chain(5000), 30, 2.9, factorize(chain(5000) - 2.9 * scipy.sparse.identity(5000)))
