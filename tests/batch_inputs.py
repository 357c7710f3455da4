"""Small curves for the tests of batches: masses in a row with a pair each."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.solve.excitation import Excitation
from stickslip.solve.solver_input import SolverInput
from stickslip.structure.superelement import Superelement

WINDOW_HZ = (120.0, 240.0)


def row_of_masses(
    n_pairs: int = 1,
    preload: float = 60.0,
    force: float = 10.0,
    mass: float = 1.0,
    stiffness: float = 1.0e6,
    damping_ratio: float | None = 0.004,
    damping: np.ndarray | None = None,
    excitation: Excitation | None = None,
    **constants: Any,
) -> SolverInput:
    """Masses on springs to their neighbours and to the ground, with a pair to the ground; the output is t1 of the
    first. Under 10 N the pairs slip; the stuck structure of one mass has its resonance along t1 at 195 Hz, the free
    one at 159 Hz."""
    coupling = np.diff(np.eye(n_pairs), axis=0)
    chain = np.eye(n_pairs) + 0.5 * coupling.T @ coupling
    matrix = np.kron(chain, stiffness * np.diag([1.0, 2.0, 4.0]))
    size = 3 * n_pairs
    vector = np.zeros(size)
    vector[:3] = force * np.array([1.0, 0.3, 0.2])
    pairs = ContactPairs(np.eye(size), 1.0e6, 5.0e5, 0.3, np.full(n_pairs, preload), **constants)
    return SolverInput(
        Superelement(mass * np.eye(size), np.asarray(matrix, dtype=float), damping),
        pairs,
        excitation or Excitation.force(vector, np.zeros(size)),
        np.eye(size)[0],
        damping_ratio,
    )
