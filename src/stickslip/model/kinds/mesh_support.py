"""Whether constraints, ties and contact support every part of a mesh."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.core.errors import InputError
from stickslip.formats.meshes.imported_model import ImportedModel
from stickslip.structure.constraints import Constraints
from stickslip.structure.mesh import IntArray, Mesh
from stickslip.structure.tied_parts import supported_groups


def require_support(
    mesh: Mesh,
    contact_nodes: IntArray,
    fixed: IntArray,
    constraints: Constraints | None,
    source: ImportedModel,
    spring_constraints: Any = None,
) -> None:
    """Raise InputError for a part that no constraint, spring or contact supports, and for a part with a hinge.

    ``spring_constraints``: csr rows of motions that springs at reference nodes constrain.
    """
    for group in supported_groups(mesh, fixed, constraints, spring_constraints):
        for part in group.parts:
            if part.is_hinged:
                raise InputError(
                    f"{_named_part(source, part.cells)} consists of {part.n_regions} regions that are connected at "
                    "nodes or edges only, like hinges, so its stiffness is singular with any constraint. Connect their "
                    "faces, or separate them.",
                    ("structure.file",),
                )
        in_contact = np.isin(contact_nodes, mesh.nodes_of_cells(group.cells)).any()
        if group.free and not in_contact:
            tied = f" with the {len(group.parts) - 1} others that ties connect to it" if len(group.parts) > 1 else ""
            raise InputError(
                f"{_named_part(source, group.cells)}{tied} can move freely ({group.free} rigid-body motions): neither "
                "structure.fixed nor a constraint of the file constrains it, and no interface touches it. Constrain, "
                "pair or remove it.",
                ("structure.fixed",),
            )


def _named_part(source: ImportedModel, cells: IntArray) -> str:
    """A part by one of its elements, and its bodies."""
    mesh = source.mesh
    bodies = ", ".join(mesh.body_names[body] for body in np.unique(mesh.body[cells]))
    return f"the part of the mesh with element {source.shown(source.element_labels[cells[0]])} ({bodies})"
