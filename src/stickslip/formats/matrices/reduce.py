"""From large matrices of another program to a superelement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.progress import ProgressCallback
from stickslip.formats.matrices.exchange import as_superelement
from stickslip.formats.matrices.model import MatrixModel
from stickslip.structure.craig_bampton import craig_bampton
from stickslip.structure.factor import Backend
from stickslip.structure.floating_parts import parts_of, require_contact_bodies, require_rigid_bodies
from stickslip.structure.superelement import Superelement


def reduce_matrices(
    model: MatrixModel,
    boundary_nodes: ArrayLike,
    n_modes: int = 30,
    backend: Backend = "superlu",
    threads: int = 1,
    progress: ProgressCallback | None = None,
    contact_nodes: ArrayLike | None = None,
) -> Superelement:
    """Reduce a model to its boundary nodes and ``n_modes`` fixed-interface modes (:func:`craig_bampton`).

    A model with no more than ``3 * n_boundary + n_modes`` unknowns stays unchanged: reduction would not make it
    smaller. Positions and node sets of the boundary nodes stay with the superelement; sets lose their other nodes.

    Parameters
    ----------
    boundary_nodes:
        node numbers, as the source counts them, each with unknowns along x, y and z: contact nodes, and nodes with
        forces or outputs.
    contact_nodes:
        those of the boundary nodes that a contact can support; by default all of them.

    Raises
    ------
    InputError
        as :func:`craig_bampton`; for a part that can move without strain and has no contact node; and for one that
        has contact nodes, but moves without strain in other ways than the six of a rigid body.
    """
    nodes = np.asarray(boundary_nodes).ravel()
    contact = nodes if contact_nodes is None else np.asarray(contact_nodes).ravel()
    if model.size <= 3 * nodes.size + n_modes:
        model.unknowns_of(nodes)
        superelement = as_superelement(model)
        require_contact_bodies(superelement, contact)
        return superelement
    superelement = craig_bampton(model, nodes, n_modes, backend, threads, progress)
    nodes, count = superelement.boundary_nodes, 3 * nodes.size
    positions = model.positions_of(nodes)
    # The boundary stiffness after static condensation has the same motions without strain as the whole, and is small.
    require_rigid_bodies(
        superelement.stiffness[:count, :count],
        parts_of(model.stiffness)[model.unknowns_of(nodes).ravel()],
        np.repeat(nodes, 3),
        np.repeat(np.isin(nodes, contact), 3),
        positions,
    )
    sets = {name: np.intersect1d(members, nodes) for name, members in model.node_sets.items()}
    return replace(superelement, positions=positions, node_sets=sets)
