"""Displacements of the full mesh at rest: those of a solved preload, or under prescribed normal loads."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from stickslip.core.validation import FloatArray
from stickslip.model.model import Model
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.recovery import Recovery
from stickslip.structure.superelement import moves_freely


def displacement_at_rest(
    model: Model, structure: Structure, recovery: Recovery, load: FloatArray
) -> tuple[str, FloatArray]:
    """The source of the state at rest ("solved", "prescribed" or "none"), and (3 * n_nodes, 1) m.

    ``load`` (3 * n_nodes,) N are the constant loads on the full mesh.
    """
    if model.preload is not None:
        return "solved", recovery.with_omitted_modes(model.preload.state.displacement[:, None], load[:, None])
    normal = np.zeros((model.pairs.n_pairs, 3))
    normal[:, 2] = np.maximum(np.nan_to_num(model.pairs.normal_load), 0.0)
    if not model.static_load.any() and not normal.any():
        return "none", np.zeros((structure.full_size, 1))
    return "prescribed", _under_normal_loads(model, structure, recovery, load, normal.ravel())


def _under_normal_loads(
    model: Model, structure: Structure, recovery: Recovery, load: FloatArray, contact: FloatArray
) -> FloatArray:
    """``K u = F - B^T N - M R a``, with constant loads F and contact forces N (3 * n_pairs,).

    The accelerations a of the free motions R of unsupported bodies balance the loads on them (inertia relief), as the
    centrifugal force of a damper balances its contact forces; u has no part along R, which is without strain.
    """
    mass, stiffness = model.superelement.mass, model.superelement.stiffness
    count = min(6 * (int(structure.mesh.body.max()) + 1), len(mass) - 1)
    _, modes = natural_frequencies(stiffness, mass, count)
    free = modes[:, moves_freely(stiffness, modes)]
    reduced = model.static_load - model.pairs.operator.T @ contact
    acceleration = free @ (free.T @ reduced)
    carried = mass @ free
    # A spring along each free motion makes the matrix regular; the balanced load does not stretch it.
    spring = float(np.trace(stiffness) / np.trace(mass))
    displacement = scipy.linalg.solve(
        stiffness + spring * carried @ carried.T, reduced - mass @ acceleration, assume_a="pos"
    )
    whole = load.copy()
    moved = (recovery @ acceleration[:, None])[structure.free_unknowns, 0]
    # a force on each independent displacement alone: what follows it gets none of its own
    whole[structure.free_unknowns] -= structure.mass @ moved
    return recovery.with_omitted_modes(displacement[:, None], whole[:, None])
