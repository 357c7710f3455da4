"""Structures whose nonlinear modes are known: one mass, two masses and a beam, each with one Jenkins element."""

from __future__ import annotations

import numpy as np
import scipy.linalg

import stickslip as ss

# The virtual RubBeR (M. Scheel, T. Weigele, M. Krack, JSV 2020, 10.1016/j.jsv.2020.115580; NLtest, example BT01).
LENGTH, HEIGHT, WIDTH, MODULUS, DENSITY, NODES = 0.710, 0.05, 0.06, 0.6725 * 210e9, 7850.0, 15
CONTACT_NODE, FIXED_MODES, BEAM_RATIO = 6, 3, 0.01


def slider(row: np.ndarray, stiffness: float, limit: float) -> ss.ContactPairs:
    """A Jenkins element along t1 on the displacement ``row @ u``."""
    operator = np.zeros((3, row.size))
    operator[0] = row
    element = ss.JenkinsElement(np.array([[stiffness, 0.0]]), np.array([[limit, limit]]))
    return ss.ContactPairs.with_laws(operator, [element])


def one_mass(ratio: float = 0.0) -> tuple[ss.Superelement, ss.ContactPairs]:
    """2 kg on 1e6 N/m, and a Jenkins element of 5e5 N/m with a limit of 10 N; ``ratio`` is that of the stuck mode."""
    damping = np.array([[2.0 * ratio * np.sqrt(1.5e6 * 2.0)]])
    return ss.Superelement(np.array([[2.0]]), np.array([[1e6]]), damping), slider(np.ones(1), 5e5, 10.0)


def two_masses(stiffness: float, damped: int = 1) -> tuple[ss.Superelement, ss.ContactPairs]:
    """M = I, K = [2 -1; -1 2], a dashpot of 0.1 on the mass ``damped``, a friction limit of 0.1 on the second mass."""
    damping = np.zeros((2, 2))
    damping[damped, damped] = 0.1
    superelement = ss.Superelement(np.eye(2), np.array([[2.0, -1.0], [-1.0, 2.0]]), damping)
    return superelement, slider(np.array([0.0, 1.0]), stiffness, 0.1)


def clamped_beam() -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness of a clamped-free Euler-Bernoulli beam; unknowns are translation and rotation of each node."""
    size = LENGTH / (NODES - 1)
    bending = MODULUS * WIDTH * HEIGHT**3 / 12.0 / size**3
    mass_per_element = DENSITY * WIDTH * HEIGHT * size
    stiffness = bending * np.array(
        [
            [12.0, 6.0 * size, -12.0, 6.0 * size],
            [6.0 * size, 4.0 * size**2, -6.0 * size, 2.0 * size**2],
            [-12.0, -6.0 * size, 12.0, -6.0 * size],
            [6.0 * size, 2.0 * size**2, -6.0 * size, 4.0 * size**2],
        ]
    )
    mass = (
        mass_per_element
        / 420.0
        * np.array(
            [
                [156.0, 22.0 * size, 54.0, -13.0 * size],
                [22.0 * size, 4.0 * size**2, 13.0 * size, -3.0 * size**2],
                [54.0, 13.0 * size, 156.0, -22.0 * size],
                [-13.0 * size, -3.0 * size**2, -22.0 * size, 4.0 * size**2],
            ]
        )
    )
    whole_mass, whole_stiffness = np.zeros((2, 2 * NODES, 2 * NODES))
    for element in range(NODES - 1):
        part = slice(2 * element, 2 * element + 4)
        whole_mass[part, part] += mass
        whole_stiffness[part, part] += stiffness
    return whole_mass[2:, 2:], whole_stiffness[2:, 2:]


def friction_beam() -> tuple[ss.Superelement, ss.ContactPairs, np.ndarray]:
    """The virtual RubBeR reduced to four unknowns, its Jenkins element, and the row of the displacement of the tip."""
    mass, stiffness = clamped_beam()
    contact, tip = 2 * (CONTACT_NODE - 2), 2 * (NODES - 2)
    inside = np.delete(np.arange(len(mass)), contact)
    reduction = np.zeros((len(mass), 1 + FIXED_MODES))
    reduction[contact, 0] = 1.0
    interior = stiffness[np.ix_(inside, inside)]
    reduction[inside, 0] = -np.linalg.solve(interior, stiffness[inside, contact])
    modes = scipy.linalg.eigh(interior, mass[np.ix_(inside, inside)])[1]
    reduction[inside, 1:] = modes[:, :FIXED_MODES]
    mass, stiffness = (reduction.T @ matrix @ reduction for matrix in (mass, stiffness))
    row = np.eye(1 + FIXED_MODES)[0]
    pairs = slider(row, 1e7, 15.0)
    squares, shapes = scipy.linalg.eigh(stiffness + 1e7 * np.outer(row, row), mass)
    weighted = mass @ shapes
    damping = (weighted * (2.0 * BEAM_RATIO * np.sqrt(squares))) @ weighted.T
    symmetric = (0.5 * (matrix + matrix.T) for matrix in (mass, stiffness, damping))
    return ss.Superelement(*symmetric), pairs, reduction[tip]
