"""The modes of the blade of a sector with its root fixed, and how the reduced sector moves it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip.core.errors import InputError
from stickslip.core.validation import FloatArray, whole_number
from stickslip.structure.blade_alone import BladeAlone
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.cyclic_symmetry import CyclicSymmetry
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.mesh import IntArray, node_numbers
from stickslip.structure.phase_lag import LaggedModel
from stickslip.structure.sector_reduction import lagged_model

BLADE_MODES = 5  # chosen: bending and torsion of the families that engine orders excite


def blade_alone(structure: Structure, sector: CyclicSector, nodes: ArrayLike, n_modes: int = BLADE_MODES) -> BladeAlone:
    """The modes of the blade of a sector with its root fixed, for mistuning.

    Parameters
    ----------
    structure:
        the sector with both its boundaries, from which ``sector`` was reduced.
    sector:
        the reduced sector (:func:`cyclic_sector`).
    nodes:
        the nodes of the blade beyond its root: all other nodes count as fixed for the modes of the blade.
    n_modes:
        number of modes; those up to a few times the highest excitation matter.

    Raises
    ------
    InputError
        for a sector without a mesh or without its modes, nodes on its boundaries, nodes without unknowns, nodes that do
        not move if the others are fixed, and for fewer unknowns than modes.
    """
    symmetry = sector.symmetry
    if symmetry is None or any(each.modes is None for each in sector.diameters.values()):
        raise InputError(
            "sector has no mesh or no fixed-interface modes; give one of cyclic_sector.", arguments=["sector"]
        )
    model = lagged_model(structure, symmetry)
    own, frequency_hz, modes = fixed_root_modes(structure, symmetry, model, nodes, n_modes)
    squared = (2.0 * np.pi * frequency_hz) ** 2
    boundary = np.searchsorted(model.remaining, structure.unknowns_of(sector.boundary_nodes).ravel())
    interior = np.setdiff1d(np.arange(model.remaining.size), boundary)
    _, kept, place = np.intersect1d(own, boundary, return_indices=True)
    participation = {}
    for diameter, matrices in sector.diameters.items():
        rows = model.at(diameter, symmetry.sectors)[0][own]
        # Forces that hold the blade: of constraint modes only at kept nodes, of fixed-interface modes anywhere.
        force = np.zeros((own.size, sector.size), dtype=complex)
        force[:, boundary.size :] = rows[:, interior] @ matrices.modes
        force[kept, : boundary.size] = matrices.stiffness[place, : boundary.size]
        part = (modes.T @ force) / squared[:, None]
        participation[diameter] = part if np.iscomplexobj(matrices.stiffness) else part.real
    return BladeAlone(frequency_hz, participation)


def fixed_root_modes(
    structure: Structure, symmetry: CyclicSymmetry, model: LaggedModel, nodes: ArrayLike, n_modes: int
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Unknowns (k,) of a blade in the model of its sector, and frequencies (Hz) and modes (k, n_modes) of it with all
    other nodes fixed. Raises InputError, see :func:`blade_alone`."""
    whole_number("n_modes", n_modes, 1)
    blade = np.unique(np.atleast_1d(node_numbers("nodes", nodes, structure.mesh.n_nodes)))
    _require_own(blade, np.concatenate([symmetry.left, symmetry.right]))
    own = np.flatnonzero(np.isin(structure.node[model.remaining], blade))
    if own.size <= n_modes:
        raise InputError(
            f"the blade has {blade.size} nodes with {own.size} free unknowns, too few for {n_modes} modes. Give all "
            "nodes of the blade beyond its root.",
            arguments=["nodes"],
        )
    # No node of the blade is on a boundary, so its rows are the same for all lags but for their neighbours there.
    stiffness, mass, _ = model.at(0, symmetry.sectors)
    frequency_hz, modes = natural_frequencies(stiffness[own][:, own], mass[own][:, own], n_modes)
    if frequency_hz[0] <= 0.0:
        raise InputError(
            "the nodes of the blade are all nodes of a body, which moves freely then. Leave out the nodes of the root.",
            arguments=["nodes"],
        )
    return own, frequency_hz, modes


def _require_own(blade: IntArray, boundary: IntArray) -> None:
    """Raise InputError for nodes of a blade on the boundaries of its sector."""
    shared = np.intersect1d(blade, boundary)
    if shared.size:
        raise InputError(
            f"the nodes of the blade contain node {shared[0]} of a boundary of the sector ({shared.size} such nodes), "
            "but a blade ends inside its sector. Leave out the nodes of the disk.",
            arguments=["nodes"],
        )
