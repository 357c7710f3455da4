"""The bench problem in pyHarm (PyPI ``pyHarm-os``, extra ``[bench]``), in the two variants where its law is right.

pyHarm's contact drops the normal force to zero instead of N0 at lift-off and keeps friction while open, so neither
variant opens. Its slider starts at zero and the third period is taken.
"""

from __future__ import annotations

import logging
from typing import Any

import jax
import numpy as np
from blade_problem import BladeProblem, FloatArray
from pyHarm.Maestro import Maestro

# pyHarm's 3-D contact runs in JAX, which computes in single precision unless told otherwise.
jax.config.update("jax_enable_x64", True)

BLADE = "blade"
# Local axes of a contact: pyHarm presses along its negative normal, the bench problem closes with n > 0.
CONTACT_AXES = [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]


def one_direction_stiffness(problem: BladeProblem) -> FloatArray:
    """Stiffness (n, n) with linear springs along t1 and n of each contact, so that friction acts along t2 only."""
    springs = [problem.tangential_stiffness, 0.0, problem.normal_stiffness] * problem.n_contacts
    return problem.stiffness + np.diag(np.pad(springs, (0, problem.size - 3 * problem.n_contacts)))


def friction_elements(problem: BladeProblem, variant: str) -> dict[str, dict[str, Any]]:
    """One pyHarm element for each contact: "line" (1-D, constant load) or "cone" (3-D, varying load)."""
    elements: dict[str, dict[str, Any]] = {}
    for i, preload in enumerate(problem.preload):
        element = {
            "connect": [(BLADE, [i]), ("GROUND", [0])],
            "mu": problem.friction_coefficient,
            "N0": float(preload),
        }
        if variant == "line":
            element |= {"type": "Jenkins", "dirs": [1], "k": problem.tangential_stiffness}
        else:
            element |= {
                "type": "Penalty3D",
                "coordinatesystem": "contact",
                "dirs": [0, 1, 2],
                "k_t": problem.tangential_stiffness,
                "k_n": problem.normal_stiffness,
                "g": 0.0,
            }
        elements[f"contact {i}"] = element
    return elements


def force_elements(problem: BladeProblem) -> dict[str, dict[str, Any]]:
    """One pyHarm element for each loaded unknown; it takes an amplitude and a phase."""
    elements: dict[str, dict[str, Any]] = {}
    for unknown in range(problem.size):
        node, direction = divmod(unknown, 3)
        if node >= problem.n_contacts:  # a modal unknown is a node of its own, its direction is called -1
            node, direction = problem.n_contacts + unknown - 3 * problem.n_contacts, -1
        cosine, sine = problem.force_cos[unknown], problem.force_sin[unknown]
        elements[f"force {unknown}"] = {
            "type": "GOForcing",
            "connect": [(BLADE, [node]), ("GROUND", [0])],
            "dirs": [direction],
            "dto": 0,
            "ho": 1,
            "amp": float(np.hypot(cosine, sine)),
            "phi": float(np.arctan2(sine, cosine)),
        }
    return elements


class PyHarmCase:
    """pyHarm's equations of one variant, solved by pyHarm's Newton at given frequencies."""

    def __init__(self, problem: BladeProblem, variant: str, harmonics: int, samples: int) -> None:
        stiffness = one_direction_stiffness(problem) if variant == "line" else problem.stiffness
        logging.disable(logging.INFO)  # pyHarm prints a banner and a line for each point
        self._maestro = Maestro(
            {
                "analysis": {
                    "points": {
                        "study": "frf",
                        "solver": "NewtonRaphson",
                        "solver_options": {"tol_residual": 1e-9, "tol_delta_x": 1e-12, "max_iter": 40},
                        "corrector": "nocontinuation",
                        "puls_inf": 1.0,
                        "puls_sup": 1e5,
                        "verbose": False,
                    }
                },
                "system": {"type": "Base", "nh": harmonics, "nti": samples},
                "coordinates": {"contact": CONTACT_AXES},
                "substructures": {
                    BLADE: {
                        "type": "substructure",
                        "ndofs": 3,
                        "nmodes": problem.size - 3 * problem.n_contacts,
                        "matrix": {"M": problem.mass, "C": problem.damping, "K": stiffness},
                    }
                },
                "connectors": friction_elements(problem, variant) | force_elements(problem),
            }
        )
        self._analysis = self._maestro.nls["points"]
        self._size = problem.size

    def solve(self, omega: float, start: FloatArray | None) -> FloatArray:
        """Coefficients (2 * harmonics + 1, n), mean, cos 1, sin 1, ..., from ``start`` or, None, pyHarm's own start."""
        self._analysis.analysis_options["puls_start"] = omega
        self._analysis.initialise(None if start is None else start.ravel().copy())
        solution = self._analysis.SolList[-1]
        if not solution.flag_accepted:
            raise RuntimeError(f"pyHarm did not converge at {omega / (2 * np.pi):.3f} Hz")
        return np.asarray(solution.x[:-1]).reshape(-1, self._size)
