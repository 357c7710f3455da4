"""From the mass points and springs of a model file to those at nodes of the mesh, in SI units."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.core.validation import FloatArray
from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.raw_points import RawMass, RawSpring
from stickslip.formats.meshes.unit_systems import UnitSystem
from stickslip.structure.attachments import Attachments
from stickslip.structure.cell_kinds import IntArray
from stickslip.structure.equations import Equations, Key

# Numbers in the mesh of nodes by label, rising, without those that belong to no solid; and the line.
Numbers = Callable[[IntArray, int], IntArray]
_ROUND_OFF = 1e-6  # of the largest moment of inertia; decks give few digits


def build_points(
    raw: RawModel,
    units: UnitSystem,
    numbers: Numbers,
    n_nodes: int,
    equations: Equations | None,
    messages: list[str],
    doubts: list[str],
) -> Attachments | None:
    """Mass points and springs at nodes of solids and at reference nodes of ``equations``; None without any.

    ``messages`` gets a sentence on entries without effect, ``doubts`` one on those at other nodes. Raises
    ImportFileError for a mass or stiffness below 0, moments of inertia that no body has, and a node that does not
    exist.
    """
    writer = _Writer(raw, units, numbers, n_nodes, equations)
    for mass in raw.masses:
        writer.mass(mass)
    for spring in raw.springs:
        writer.spring(spring)
    messages += writer.without_effect()
    doubts += writer.lost()
    return writer.attachments()


class _Writer:
    """Writes mass points and springs one after the other, and counts those that are not read."""

    def __init__(
        self, raw: RawModel, units: UnitSystem, numbers: Numbers, n_nodes: int, equations: Equations | None
    ) -> None:
        self._raw, self._units, self._numbers = raw, units, numbers
        self._known = {} if equations is None else equations.further
        self._masses = np.zeros(n_nodes)
        self._springs: list[tuple[int, int]] = []
        self._stiffnesses: list[float] = []
        self._further: dict[Key, int] = {}
        self._tensors: dict[int, FloatArray] = {}  # label of a reference node -> its mass matrix (6, 6)
        self._lost_mass, self._lost_springs = 0.0, 0
        self._flat: list[int] = []  # lines of moments of inertia and rotations at nodes without rotation

    def mass(self, mass: RawMass) -> None:
        """Add the mass of its nodes."""
        if mass.mass < 0.0:
            self._raw.fail(f"a mass point has the mass {mass.mass:g}; it must be 0 or more.", mass.line)
        size = self._units.mass * mass.mass
        mine = self._numbers(mass.nodes, mass.line)
        self._masses[mine] += size
        references = [label for label in mass.nodes.tolist() if (label, 0) in self._known]
        for label in references:
            tensor = self._tensor(mass, has_rotation=(label, 3) in self._known)
            self._tensors[label] = self._tensors.get(label, np.zeros((6, 6))) + tensor
        self._lost_mass += size * (mass.nodes.size - mine.size - len(references))
        if not mass.is_point and (mine.size or any((label, 3) not in self._known for label in references)):
            self._flat.append(mass.line)

    def _tensor(self, mass: RawMass, has_rotation: bool) -> FloatArray:
        """(6, 6) of displacement and rotation: ``2 T = m |v + w x c|^2 + w . J w`` with the offset c."""
        size = self._units.mass * mass.mass
        tensor = np.zeros((6, 6))
        tensor[:3, :3] = size * np.eye(3)
        if not has_rotation or mass.is_point:
            return tensor
        if not mass.in_basic:
            self._raw.fail(
                "the offset and the moments of inertia of a mass at a reference node are along the axes of a "
                "coordinate system, which is not read. Give them along x, y, z.",
                mass.line,
            )
        x, y, z = self._units.length * np.array(mass.offset)
        arm = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])  # arm @ w = w x c
        xx, yy, zz, xy, xz, yz = self._units.mass * self._units.length**2 * np.array(mass.inertia)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        lowest, _, largest = np.linalg.eigvalsh(inertia)
        if lowest < -_ROUND_OFF * max(largest, 0.0):
            self._raw.fail("no body has these moments of inertia: a principal one is below 0.", mass.line)
        tensor[:3, 3:] = size * arm
        tensor[3:, :3] = size * arm.T
        tensor[3:, 3:] = size * arm.T @ arm + inertia
        return tensor

    def spring(self, spring: RawSpring) -> None:
        """Add the springs of its nodes."""
        if spring.stiffness < 0.0:
            self._raw.fail(f"a spring has the stiffness {spring.stiffness:g}; it must be 0 or more.", spring.line)
        other = -1 if spring.other is None else self._unknown(*spring.other, spring.line)
        for label in spring.nodes.tolist():
            ends = (self._unknown(label, spring.direction, spring.line), other)
            if None in ends:
                continue
            self._springs.append(ends)  # type: ignore[arg-type]
            per_rotation = 1.0 if spring.direction < 3 else self._units.length**2
            self._stiffnesses.append(self._units.mass / self._units.time**2 * spring.stiffness * per_rotation)

    def _unknown(self, label: int, direction: int, line: int) -> int | None:
        """The number of a displacement or rotation, None if neither solids nor couplings have it, which is counted."""
        found = self._numbers(np.array([label], dtype=np.int64), line)
        if direction < 3 and found.size:
            return 3 * int(found[0]) + direction
        if (label, direction) in self._known:
            return 3 * self._masses.size + self._further.setdefault((label, direction), len(self._further))
        if found.size or direction > 2:
            self._flat.append(line)
        else:
            self._lost_springs += 1
        return None

    def without_effect(self) -> list[str]:
        """A sentence on rotations of nodes that have none."""
        if not self._flat:
            return []
        return [
            f"{len(self._flat)} mass points and springs (first in {self._raw.where(self._flat[0])}) have offsets, "
            "moments of inertia or springs at rotations of nodes without rotation (nodes of solids), which have no "
            "effect; masses are read."
        ]

    def lost(self) -> list[str]:
        """Sentences on masses and springs that are not read."""
        sentences = []
        if self._lost_mass:
            sentences.append(
                f"mass points with {self._lost_mass:.6g} kg in all are at nodes that belong to no solid and to no "
                "coupling; stickslip does not read these. Add a coupling, or the mass to the density of a solid."
            )
        if self._lost_springs:
            sentences.append(
                f"{self._lost_springs} springs end at nodes that belong to no solid and to no coupling; stickslip does "
                "not read these."
            )
        return sentences

    def attachments(self) -> Attachments | None:
        """The result; None without masses and springs."""
        heavy = {label: tensor for label, tensor in self._tensors.items() if tensor.any()}
        if not (self._masses.any() or self._springs or heavy):
            return None
        for label, tensor in heavy.items():
            for direction in np.flatnonzero(tensor.any(axis=0)).tolist():
                self._further.setdefault((label, direction), len(self._further))
        further_mass = np.zeros((len(self._further), len(self._further)))
        for label, tensor in heavy.items():
            used = np.flatnonzero(tensor.any(axis=0))
            at = [self._further[label, direction] for direction in used.tolist()]
            further_mass[np.ix_(at, at)] += tensor[np.ix_(used, used)]
        ends = np.array(self._springs, dtype=np.int64).reshape(-1, 2)
        return Attachments(self._masses, ends, np.array(self._stiffnesses), tuple(self._further), further_mass)
