"""The benchmark problems in benchmarks/data: a friction-damped blade reduced to its contacts and 8 modes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class BladeProblem:
    """``M u'' + C u' + K u + sum of contact forces = F cos/sin + N0``.

    The first 3 * n_contacts unknowns are t1, t2, n of each contact; n > 0 closes.
    """

    mass: FloatArray  # (n, n) kg
    damping: FloatArray  # (n, n) N s/m
    stiffness: FloatArray  # (n, n) N/m, without contacts
    force_cos: FloatArray  # (n,) N
    force_sin: FloatArray  # (n,) N
    output: FloatArray  # (n,): tip displacement = output @ u
    tangential_stiffness: float  # N/m of each contact
    normal_stiffness: float  # N/m of each contact
    friction_coefficient: float
    preload: FloatArray  # (n_contacts,) N
    window_hz: tuple[float, float]  # sweep

    @property
    def n_contacts(self) -> int:
        """Number of contacts with the ground."""
        return int(self.preload.size)

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return int(self.mass.shape[0])

    def stuck_stiffness(self) -> FloatArray:
        """Stiffness (n, n) with every contact closed and stuck."""
        springs = [self.tangential_stiffness, self.tangential_stiffness, self.normal_stiffness] * self.n_contacts
        return self.stiffness + np.diag(np.pad(springs, (0, self.size - 3 * self.n_contacts)))

    def contact_operator(self) -> FloatArray:
        """(3 * n_contacts, n): picks t1, t2, n of each contact."""
        return np.eye(3 * self.n_contacts, self.size)


def load_blade_problem(n_contacts: int) -> BladeProblem:
    """The problem with 10, 40 or 110 contacts."""
    path = Path(__file__).parent / "data" / f"prob_Nc{n_contacts}.npz"
    with np.load(path) as data:
        return BladeProblem(
            mass=data["M"],
            damping=data["C"],
            stiffness=data["K"],
            force_cos=data["F1c"],
            force_sin=data["F1s"],
            output=data["resp"],
            tangential_stiffness=float(data["kt"]),
            normal_stiffness=float(data["kn"]),
            friction_coefficient=float(data["mu"]),
            preload=data["N0"],
            window_hz=(float(data["w_lo"]) / (2 * np.pi), float(data["w_hi"]) / (2 * np.pi)),
        )
