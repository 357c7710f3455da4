"""Surfaces of Abaqus and CalculiX decks on shells, membranes and other elements without volume, which are not read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.formats.meshes.raw_model import RawModel, RawSides
from stickslip.structure.cell_kinds import IntArray

SHELL_SIDES = ("SPOS", "SNEG")  # no solid has them


def omit_shell_sides(raw: RawModel, without_volume: IntArray) -> None:
    """Remove the sides of elements (k,) by label that have no volume from the surfaces, with a message for each.

    Surfaces without a side of a solid become no face set, and their ties and couplings are omitted, too.
    """
    gone = set()
    for name, entries in raw.face_sets.items():
        sides = [side for entry in entries if (side := _of_solids(entry, without_volume)) is not None]
        before, after = (sum(_count(each) for each in group) for group in (entries, sides))
        if sides and after < before:
            raw.messages.append(f"surface '{name}': its {before - after} elements without volume are omitted.")
        elif not sides:
            gone.add(name)
        raw.face_sets[name] = sides
    for name in gone:
        del raw.face_sets[name]
    if gone:
        names = ", ".join(f"'{name}'" for name in sorted(gone))
        raw.messages.append(
            f"surfaces of elements without volume, with their ties and couplings, are omitted: {names}."
        )
    ties = raw.ties
    ties.faces = [tie for tie in ties.faces if not {tie.dependent, tie.independent} & gone]
    ties.rigid = [each for each in ties.rigid if each.face not in gone]
    ties.distributing = [each for each in ties.distributing if each.face not in gone]


def _of_solids(entry: RawSides, without_volume: IntArray) -> RawSides | None:
    if entry.elements is None:
        return entry
    solids = entry.elements[~np.isin(entry.elements, without_volume)]
    return replace(entry, elements=solids) if solids.size else None


def _count(entry: RawSides) -> int:
    return 0 if entry.elements is None else entry.elements.size
