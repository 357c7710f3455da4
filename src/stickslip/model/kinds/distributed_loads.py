"""Loads of a mesh study on all bodies or on faces: rotation, gravity and pressures, for a solved preload."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.case.case import MeshCase
from stickslip.case.interface_sections import GROUND
from stickslip.core.errors import InputError, concerning
from stickslip.core.validation import FloatArray
from stickslip.model.kinds.entry import named_entry
from stickslip.model.overlap import sides_of_face
from stickslip.structure.attachments import Attachments
from stickslip.structure.body_load import centrifugal_load, translation_inertia
from stickslip.structure.constraints import Constraints
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.static_loads import pressure_load


def unit_loads(
    case: MeshCase,
    mesh: Mesh,
    materials: Sequence[Material],
    attached: tuple[Attachments | None, Constraints | None],
    fixed: IntArray,
) -> dict[str, FloatArray]:
    """Section -> (3 * n_nodes, k) N on the whole mesh for each unit of its sizes (:func:`load_sizes`).

    ``attached`` are mass points with the constraints that move those at reference nodes, ``fixed`` the constrained
    displacements. Raises InputError that names the section, and for a rotation of masses at reference nodes.
    """
    loads: dict[str, FloatArray] = {}
    points, constraints = attached
    masses = None if points is None else points.masses
    if case.rotation is not None:
        if points is not None and points.further_mass.any():
            raise InputError(
                f"[rotation]: the model has {points.reference_mass:.4g} kg at reference nodes of couplings, whose "
                "centrifugal force and stiffness at speed are not computed. Put this mass at nodes of solids, or "
                "remove [rotation].",
                ("rotation",),
            )
        turn = case.rotation
        axis, point = np.array(turn.axis), np.array(turn.point)
        loads["rotation"] = centrifugal_load(mesh, materials, axis, point, masses)[:, None]
    if case.gravity is not None:
        loads["gravity"] = translation_inertia(mesh, materials, masses)
        loads["gravity"] += 0.0 if points is None else points.translation_inertia(constraints)
    for name, each in case.pressures.items():
        section = f"pressures.{name}"
        with named_entry(section), concerning(f"{section}.set"):
            load = pressure_load(mesh, each.set)
        _require_usable(case, mesh, name, each.set, load, fixed)
        loads[section] = load[:, None]
    return loads


def load_sizes(case: MeshCase) -> Mapping[str, tuple[float, ...]]:
    """Section -> its sizes (k,): speed squared in 1/s2, acceleration along x, y, z in m/s2, pressure in Pa."""
    sizes: dict[str, tuple[float, ...]] = {}
    if case.rotation is not None:
        sizes["rotation"] = (case.rotation.speed**2,)
    if case.gravity is not None:
        sizes["gravity"] = tuple(case.gravity.acceleration * part for part in case.gravity.direction)
    return sizes | {f"pressures.{name}": (each.pressure,) for name, each in case.pressures.items()}


def _require_usable(case: MeshCase, mesh: Mesh, name: str, face: str, load: FloatArray, fixed: IntArray) -> None:
    """Raise InputError for a pressure on constrained nodes alone, or on sides of a contact face."""
    key = f"pressures.{name}.set"
    if not np.delete(load, fixed).any():
        raise InputError(
            f"pressures.{name}: all nodes of '{face}' are constrained, so the pressure has no effect. Give another "
            "face, or remove the section.",
            (key,),
        )
    sides = sides_of_face(mesh, face)
    for joint, each in case.interfaces.items():
        for contact in (each.first, each.second):
            common = len(sides & sides_of_face(mesh, contact)) if contact != GROUND else 0
            if common:
                raise InputError(
                    f"pressures.{name}: {common} of the {len(sides)} element sides of '{face}' are sides of the "
                    f"contact face '{contact}' of interfaces.{joint}. The pressure of a contact face is a result of "
                    "the solved preload. Give a set without these sides.",
                    (key, f"interfaces.{joint}"),
                )
