"""Interfaces that join the same faces twice, where contact would count double."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from stickslip.case.interface_sections import GROUND, MeshInterfaceSection
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import InputError
from stickslip.structure.mesh import Mesh

_PARALLEL = 0.99  # chosen: cosine between normals of pairs that press along one line


def require_single_joints(mesh: Mesh, interfaces: Mapping[str, MeshInterfaceSection]) -> None:
    """Raise InputError where two interfaces join the same element sides on both of their faces.

    Two interfaces may have one common face: two blocks may be on one face.
    """
    sides = {
        name: tuple(sides_of_face(mesh, face) for face in (each.first, each.second))
        for name, each in interfaces.items()
    }
    for (name, faces), (other, others) in combinations(sides.items(), 2):
        for opposite in (others, others[::-1]):
            common = [mine & theirs for mine, theirs in zip(faces, opposite, strict=True)]
            if all(common):
                _reject(name, other, f"{max(map(len, common))} element sides")


def require_single_pairs(names: tuple[str, ...], pairs: FacePairs) -> None:
    """Raise InputError where most node pairs of one interface are pairs of another one along the same normal."""
    ground = ~pairs.second_weights.any(axis=1)
    second = np.where(ground, -1, pairs.second_nodes[:, 0])
    keys = [set(zip(pairs.first_nodes[rows, 0].tolist(), second[rows].tolist(), strict=True)) for rows in _faces(pairs)]
    for (one, rows), (two, others) in combinations(enumerate(_faces(pairs)), 2):
        common = keys[one] & (keys[two] | {(after, before) for before, after in keys[two]})
        along = abs(float(pairs.normal[rows[0]] @ pairs.normal[others[0]])) > _PARALLEL
        if along and 2 * len(common) > min(len(keys[one]), len(keys[two])):
            _reject(names[one], names[two], f"{len(common)} node pairs")


def _faces(pairs: FacePairs) -> list[np.ndarray]:
    return [np.flatnonzero(pairs.face == face) for face in range(int(pairs.face.max()) + 1)]


def sides_of_face(mesh: Mesh, face: str | None) -> set[tuple[int, ...]]:
    """Sorted nodes of each element side of a face; the ground is one side of its own."""
    if face is None or face == GROUND:
        return {(-1,)}
    return {tuple(side) for group in mesh.sides(face) for side in np.sort(group, axis=1).tolist()}


def _reject(name: str, other: str, what: str) -> None:
    raise InputError(
        f"interfaces.{name} and interfaces.{other} both connect the same {what}, so their contact would count twice. "
        "Remove one of the two, or give them faces that do not overlap.",
        (f"interfaces.{name}", f"interfaces.{other}"),
    )
