"""Materials of a model file: tables of constants over the temperature, in the units of the file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.structure.anisotropy import orthotropic_matrix

Symmetry = Literal["isotropic", "engineering", "orthotropic", "anisotropic"]
# Number of constants of each: E, nu; E1, E2, E3, nu12, nu13, nu23, G12, G13, G23; D1111, D1122, D2222, D1133, D2233,
# D3333, D1212, D1313, D2323; and the upper triangle column by column in the order 11, 22, 33, 12, 13, 23.
COUNTS: dict[Symmetry, int] = {"isotropic": 2, "engineering": 9, "orthotropic": 9, "anisotropic": 21}
_DECK_ORDER = [0, 1, 2, 3, 5, 4]  # of 11, 22, 33, 12, 13, 23 among xx, yy, zz, xy, yz, zx


@dataclass(frozen=True)
class RawTable:
    """Constants (k, n), not a number where the file has none, at temperatures (k,) of the file, which rise."""

    rows: FloatArray
    temperatures: FloatArray

    @classmethod
    def constant(cls, *values: float | None) -> RawTable:
        """Constants that do not depend on temperature; None for one that is missing."""
        return cls(np.array([[np.nan if value is None else value for value in values]]), np.zeros(1))

    def at(self, temperature: float | None) -> FloatArray:
        """Constants (n,): the first row without a temperature, else linear between rows, constant beyond the ends."""
        if temperature is None or len(self.rows) == 1:
            return np.asarray(self.rows[0])
        return np.array([np.interp(temperature, self.temperatures, column) for column in self.rows.T])

    @property
    def depends_on_temperature(self) -> bool:
        """Whether there are several rows."""
        return len(self.rows) > 1


@dataclass(frozen=True)
class RawMaterial:
    """Elastic constants, by the order of their ``symmetry``, and density."""

    elastic: RawTable
    density: RawTable
    line: int
    symmetry: Symmetry = "isotropic"

    @classmethod
    def of_constants(cls, young: float | None, poisson: float | None, density: float | None, line: int) -> RawMaterial:
        """An isotropic material at one temperature; None for what the file does not have."""
        return cls(RawTable.constant(young, poisson), RawTable.constant(density), line)

    @property
    def depends_on_temperature(self) -> bool:
        """Whether any constant does."""
        return self.elastic.depends_on_temperature or self.density.depends_on_temperature


def deck_matrix(symmetry: Symmetry, values: FloatArray) -> FloatArray:
    """(6, 6) elastic matrix in the axes of the material, order xx, yy, zz, xy, yz, zx, from constants of a deck.

    Raises InputError for engineering constants whose elastic energy is not positive.
    """
    if symmetry == "engineering":
        return orthotropic_matrix(values[:3].tolist(), values[3:6].tolist(), values[6:].tolist())
    upper = np.zeros((6, 6))
    if symmetry == "orthotropic":
        upper[[0, 0, 1, 0, 1, 2, 3, 4, 5], [0, 1, 1, 2, 2, 2, 3, 4, 5]] = values
    else:
        columns, rows = np.tril_indices(6)
        upper[rows, columns] = values
    matrix = upper + np.triu(upper, 1).T
    order = np.argsort(_DECK_ORDER)
    return np.asarray(matrix[np.ix_(order, order)])
