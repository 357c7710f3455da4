"""Anisotropic materials of Nastran: MAT9 (21 constants) and MAT11 (orthotropic), with the axes CORDM of a PSOLID."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.bulk_data import BulkCard
from stickslip.formats.meshes.nastran_systems import Systems
from stickslip.formats.meshes.raw_materials import RawMaterial, RawTable
from stickslip.formats.meshes.raw_model import RawModel

# MAT9 has the upper triangle row by row, in the order xx, yy, zz, xy, yz, zx; a deck of Abaqus column by column in the
# order 11, 22, 33, 12, 13, 23.
_OF_MAT9 = [0, 1, 2, 3, 5, 4]
_N_MAT9, _N_MAT11 = 21, 9


class AnisotropicMaterials:
    """Reads the cards one after the other."""

    def __init__(self, raw: RawModel) -> None:
        self._raw = raw
        self.cards: dict[str, Callable[[BulkCard], None]] = {"MAT9": self._general, "MAT11": self._orthotropic}

    def axes(self, card: BulkCard, material: str, systems: Systems) -> FloatArray | None:
        """The axes of an anisotropic material in a PSOLID, as rows; None for x, y, z and for isotropic ones.

        Raises ImportFileError for axes that are not constant in the body.
        """
        known = self._raw.materials.get(material)
        word = card.word(2)
        if known is None or known.symmetry == "isotropic" or word in ("", "0"):
            return None
        if word.startswith("-"):
            card.fail(
                f"CORDM is {word[:24]}, so that each element has its own axes of the material, which is not read. Give "
                "a rectangular system."
            )
        frame = systems.frame(card.integer(2), card)
        if frame.kind != "rectangular":
            card.fail(
                f"CORDM is the {frame.kind} system {word}, whose axes are not constant in the body. Give a rectangular "
                "system for each part of it."
            )
        return frame.axes

    def _new(self, card: BulkCard, material: RawMaterial) -> None:
        name = str(card.integer(0))
        if name in self._raw.materials:
            card.fail(f"material {name} is defined twice.")
        self._raw.materials[name] = material

    def _general(self, card: BulkCard) -> None:
        values = np.array([card.real(1 + at, 0.0) for at in range(_N_MAT9)])
        matrix = np.zeros((6, 6))
        matrix[np.triu_indices(6)] = values
        matrix = (matrix + np.triu(matrix, 1).T)[np.ix_(_OF_MAT9, _OF_MAT9)]
        columns, rows = np.tril_indices(6)
        density = card.real(1 + _N_MAT9) if card.word(1 + _N_MAT9) else None
        table = RawTable.constant(*matrix[rows, columns].tolist())
        self._new(card, RawMaterial(table, RawTable.constant(density), card.line, "anisotropic"))

    def _orthotropic(self, card: BulkCard) -> None:
        values = [card.real(1 + at) for at in range(_N_MAT11)]
        density = card.real(1 + _N_MAT11) if card.word(1 + _N_MAT11) else None
        self._new(card, RawMaterial(RawTable.constant(*values), RawTable.constant(density), card.line, "engineering"))
