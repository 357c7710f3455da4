"""Static loads of a mesh for a solved preload: pressure on faces and the weight of all bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.validation import FloatArray, argument_error, finite_array, real_number
from stickslip.structure.body_load import translation_inertia
from stickslip.structure.elasticity import Material
from stickslip.structure.mesh import Mesh
from stickslip.structure.shapes import side_rule, side_shape_functions


def pressure_load(mesh: Mesh, face: str, pressure: float = 1.0) -> FloatArray:
    """Consistent nodal forces ``f_i = -p * integral of N_i n dA`` of a uniform pressure on a face; n points outwards.

    Their sum is ``-p`` times the area vector of the face, and their moment that of the pressure. The integral is exact
    on the sides of all cells, also on curved sides with midside nodes.

    Parameters
    ----------
    face:
        name of a face set, or of a node set that contains whole sides.
    pressure:
        p in Pa, above 0 towards the body, below 0 for suction.

    Returns
    -------
    (3 * n_nodes,) N
        node, then x, y, z. ``superelement.recovery.project(load)`` is the load of :func:`static_preload`.

    Raises
    ------
    InputError
        for a set that does not exist, that is empty or contains no side, and for a pressure that is not a number.

    Source: O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, 5th ed. (2000), vol. 1, sec. 2.3.
    """
    size = real_number("pressure", pressure)
    load = np.zeros((mesh.n_nodes, 3))
    for sides in mesh.sides(face):
        where, weight = side_rule(sides.shape[1])
        values, gradients = side_shape_functions(sides.shape[1], where)
        along_xi, along_eta = (np.einsum("qk,mkx->mqx", gradients[..., axis], mesh.points[sides]) for axis in (0, 1))
        outward = np.cross(along_xi, along_eta)
        np.add.at(load, sides, -size * np.einsum("q,qk,mqx->mkx", weight, values, outward))
    return load.ravel()


def gravity_load(
    mesh: Mesh,
    materials: Material | Sequence[Material],
    acceleration: ArrayLike,
    masses: ArrayLike | None = None,
) -> FloatArray:
    """Weight ``f = M a`` of all nodes under a uniform acceleration of gravity, with the consistent mass.

    The forces sum up to the total mass times the acceleration, constrained nodes included.

    Parameters
    ----------
    materials:
        one for all bodies, or one for each.
    acceleration:
        (3,) m/s2 in the axes of the mesh, for example ``(0, 0, -9.81)``.
    masses:
        (n_nodes,) kg of mass points.

    Returns
    -------
    (3 * n_nodes,) N
        as for :func:`pressure_load`.

    Raises
    ------
    InputError
        for another number of materials, and for an acceleration that is zero or not three numbers.
    """
    field = finite_array("acceleration", acceleration)
    if field.shape != (3,) or not field.any():
        raise argument_error(
            "acceleration",
            f"acceleration is {field.tolist()}, but it must be three numbers in m/s2, not all of them zero, for "
            "example (0, 0, -9.81).",
        )
    n_bodies = int(mesh.body.max()) + 1
    each = [materials] * n_bodies if isinstance(materials, Material) else list(materials)
    if len(each) != n_bodies:
        raise argument_error(
            "materials",
            f"materials has {len(each)} entries, but the mesh has {n_bodies} bodies. Give one, or one for each.",
        )
    points = None if masses is None else finite_array("masses", masses)
    if points is not None and points.shape != (mesh.n_nodes,):
        raise argument_error(
            "masses",
            f"masses has the shape {points.shape}, but it must be ({mesh.n_nodes},): kg of each node of the mesh.",
        )
    return np.asarray(translation_inertia(mesh, each, points) @ field)
