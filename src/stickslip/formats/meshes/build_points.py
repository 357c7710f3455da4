"""From the mass points and springs of a model file to those at nodes of the mesh, in SI units."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stickslip.formats.meshes.raw_model import RawModel
from stickslip.formats.meshes.unit_systems import UnitSystem
from stickslip.structure.attachments import Attachments
from stickslip.structure.cell_kinds import IntArray

# Numbers in the mesh of nodes by label, rising, without those that belong to no solid; and the line.
Numbers = Callable[[IntArray, int], IntArray]


def build_points(
    raw: RawModel, units: UnitSystem, numbers: Numbers, n_nodes: int, doubts: list[str]
) -> Attachments | None:
    """Mass points and springs at nodes of solids; None without any. ``doubts`` gets a sentence on those at other
    nodes.

    Raises ImportFileError for a mass or stiffness below 0, and for a node that does not exist.
    """
    masses = np.zeros(n_nodes)
    springs: list[tuple[int, int]] = []
    stiffnesses: list[float] = []
    lost_mass, lost_springs = 0.0, 0
    for mass in raw.masses:
        if mass.mass < 0.0:
            raw.fail(f"a mass point has the mass {mass.mass:g}; it must be 0 or more.", mass.line)
        mine = numbers(mass.nodes, mass.line)
        masses[mine] += units.mass * mass.mass
        lost_mass += units.mass * mass.mass * (mass.nodes.size - mine.size)
    for spring in raw.springs:
        if spring.stiffness < 0.0:
            raw.fail(f"a spring has the stiffness {spring.stiffness:g}; it must be 0 or more.", spring.line)
        mine = numbers(spring.nodes, spring.line)
        other = -1
        if spring.other is not None:
            end = numbers(np.array([spring.other[0]], dtype=np.int64), spring.line)
            other = 3 * int(end[0]) + spring.other[1] if end.size else -2
        nodes = mine if other != -2 else mine[:0]
        springs += [(3 * int(node) + spring.direction, other) for node in nodes]
        stiffnesses += [units.mass / units.time**2 * spring.stiffness] * nodes.size
        lost_springs += spring.nodes.size - nodes.size
    if lost_mass:
        doubts.append(
            f"mass points with {lost_mass:.6g} kg in all are at nodes that belong to no solid (reference nodes of "
            "couplings, for example); stickslip does not read these. Add the mass to the density of a solid."
        )
    if lost_springs:
        doubts.append(f"{lost_springs} springs end at nodes that belong to no solid; stickslip does not read these.")
    if not masses.any() and not springs:
        return None
    ends = np.array(springs, dtype=np.int64).reshape(-1, 2)
    return Attachments(masses, ends, np.array(stiffnesses))
