"""Contact pairs of an Ansys archive: elements CONTA173, 174, 175 and TARGE170 with one set of real constants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stickslip.formats.meshes.raw_contacts import GROUND, RawContact
from stickslip.formats.meshes.raw_model import RawModel, RawSides

CONTACT_FACES, CONTACT_NODES, TARGET = (173, 174), 175, 170
CONTACT_TYPES = (*CONTACT_FACES, CONTACT_NODES, TARGET)
# KEYOPT(12), behaviour of the contact surface.
_NO_SEPARATION, _BONDED = {2, 4}, {3, 5, 6}
_ROUGH = 1


@dataclass
class _Pair:
    """One set of real constants: corners of both faces, nodes of CONTA175, material, KEYOPT(12) and line."""

    first: list[tuple[int, ...]] = field(default_factory=list)
    second: list[tuple[int, ...]] = field(default_factory=list)
    nodes: list[int] = field(default_factory=list)
    material: int = 0
    behaviour: int = 0
    line: int = 0


@dataclass
class ContactElements:
    """The contact elements of an archive by their set of real constants."""

    pairs: dict[int, _Pair] = field(default_factory=dict)

    def add(self, kind: int, real: int, material: int, corners: tuple[int, ...], behaviour: int, line: int) -> None:
        """One element: ``kind`` such as 174, and its corner nodes."""
        pair = self.pairs.setdefault(real, _Pair())
        if kind == TARGET:
            pair.second.append(corners)
            return
        pair.material, pair.behaviour, pair.line = material, behaviour, pair.line or line
        if kind == CONTACT_NODES:
            pair.nodes += corners
        else:
            pair.first.append(corners)

    def write(self, raw: RawModel, solid_nodes: set[int], friction: Mapping[int, float]) -> None:
        """Face sets "contact 3" and "target 3", and the pairs; ``friction``: coefficient of each material with MU.

        A target of which no corner belongs to a solid is rigid.
        """
        for number, pair in self.pairs.items():
            names = f"contact {number}", f"target {number}"
            for name, sides in zip(names, (pair.first, pair.second), strict=True):
                elastic = [corners for corners in sides if len(corners) > 2 and not solid_nodes.isdisjoint(corners)]
                for width in sorted({len(corners) for corners in elastic}):
                    corners = np.array([each for each in elastic if len(each) == width], dtype=np.int64)
                    raw.face_sets.setdefault(name, []).append(RawSides(pair.line, corners=corners))
                    raw.set_lines.setdefault(name, pair.line)
            if pair.nodes and names[0] not in raw.face_sets:
                raw.node_sets[names[0]] = np.unique(np.array(pair.nodes, dtype=np.int64))
                raw.set_lines.setdefault(names[0], pair.line)
            is_face = [name in raw.face_sets or name in raw.node_sets for name in names]
            if not is_face[0]:
                raw.messages.append(
                    f"the contact pair of real constant set {number} has no contact elements on solids."
                )
                continue
            second = names[1] if is_face[1] else GROUND
            notes = _notes(pair, has_target=bool(pair.second), is_rigid=second == GROUND)
            raw.contacts.append(
                RawContact(
                    f"pair {number}",
                    names[0],
                    second,
                    friction.get(pair.material),
                    pair.line,
                    pair.behaviour in _BONDED,
                    notes,
                )
            )


def _notes(pair: _Pair, has_target: bool, is_rigid: bool) -> tuple[str, ...]:
    notes = []
    if pair.behaviour in _NO_SEPARATION:
        notes.append("the file allows no separation, which a joint of a study does")
    if pair.behaviour == _ROUGH:
        notes.append("the file allows no sliding (rough), which a joint of a study does")
    if is_rigid and has_target:
        notes.append("the target is rigid, so the second side is the ground with its shape that of the first face")
    if not has_target:
        notes.append("it has no target elements")
    return tuple(notes)
