"""Displacements of the full mesh at rest: those of a solved preload, or under prescribed normal loads."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from stickslip.core.validation import FloatArray
from stickslip.model.model import Model
from stickslip.structure.elasticity import Structure, natural_frequencies
from stickslip.structure.factor import best_backend, factorize
from stickslip.structure.recovery import Recovery
from stickslip.structure.superelement import moves_freely

# chosen: over the lowest elastic eigenvalue, of which it is the relative error; round-off of 1e-16 over it is as small.
SHIFT = 1e-8


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
    if model.reduced.moving is not None:
        return "prescribed", _on_mesh(model, structure, load, normal.ravel())
    return "prescribed", _under_normal_loads(model, structure, recovery, load, normal.ravel())


def _on_mesh(model: Model, structure: Structure, load: FloatArray, contact: FloatArray) -> FloatArray:
    """The solution of :func:`_under_normal_loads` on the full mesh: a reduction to moving pairs lacks the responses to
    the normal loads of the others.

    ``K + c M`` is regular; the balanced load does not stretch free motions, and c is far below all other eigenvalues.
    """
    count = min(6 * (int(structure.mesh.body.max()) + 1) + 1, structure.stiffness.shape[0] - 1)
    frequency_hz, modes = natural_frequencies(structure.stiffness, structure.mass, count)
    is_free = moves_freely(structure.stiffness, modes)
    free, lowest = modes[:, is_free], 2.0 * np.pi * frequency_hz[~is_free].min()
    rows = structure.of_unknowns(model.joint.face_pairs.mesh_operator(structure.mesh.n_nodes))
    force = structure.gather(load) - rows.T @ contact
    balanced = force - structure.mass @ (free @ (free.T @ force))
    shifted = structure.stiffness + SHIFT * lowest**2 * structure.mass
    displacement = factorize(shifted, best_backend(shifted.shape[0])).solve(balanced)
    displacement -= free @ (free.T @ (structure.mass @ displacement))
    return structure.expand(displacement)[:, None]


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
