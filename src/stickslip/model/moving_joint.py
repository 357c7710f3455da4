"""A structure of a study with those contact pairs as unknowns that can move (reduction.pairs = "moving")."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from stickslip.case.case import Case
from stickslip.contact.law.law import BoolArray
from stickslip.core.errors import InputError
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint
from stickslip.model.layout import AnyStructure
from stickslip.model.study_structure import ReducedStructure, study_structure
from stickslip.solve.excitation import Excitation
from stickslip.solve.moving_pairs import REACH, estimated_moving_pairs
from stickslip.structure.elasticity import Structure
from stickslip.structure.front_reduction import lowest_mesh_modes
from stickslip.structure.joined import stiffness_with_springs
from stickslip.structure.partial_reduction import partial_superelement

# chosen: modes of the first attempt, and most of all, to reach the highest excited frequency.
FIRST_MODES, MOST_MODES = 16, 256


def require_mesh_at_rest(structure: AnyStructure) -> Structure:
    """The structure, for reduction.pairs = "moving". Raises InputError for any other than a mesh at rest."""
    full = study_structure(structure).full_model
    if full is None:
        raise InputError(
            'reduction.pairs is "moving", which is for a mesh at rest. Set pairs = "all".', ("reduction.pairs",)
        )
    return full


def moving_pairs_of(
    case: Case,
    structure: Structure,
    joint: Joint,
    excitation_of: Callable[[FloatArray], Excitation],
    threads: int = 1,
) -> BoolArray:
    """(n_pairs,) the pairs that can move in the range of [solver], see :func:`estimated_moving_pairs`.

    ``excitation_of(modes)`` is the excitation on the amplitudes of modes (full_size, k) of the mesh. Raises InputError
    and ConvergenceError, see
    :func:`lowest_mesh_modes`.
    """
    window = 2.0 * np.pi * np.array([case.solver.frequency_start, case.solver.frequency_stop])
    rows = joint.face_pairs.mesh_operator(structure.mesh.n_nodes)
    stuck = stiffness_with_springs(structure, rows, joint.resting_springs)
    most = min(MOST_MODES, structure.stiffness.shape[0] - 1)
    count = min(FIRST_MODES, most)
    while True:
        frequency_hz, shapes = lowest_mesh_modes(structure, stuck, count, threads)
        modes = structure.expand(shapes)
        excitation = excitation_of(modes)
        if 2.0 * np.pi * frequency_hz[-1] > REACH * excitation.harmonics * window.max() or count == most:
            break
        count = min(2 * count, most)
    omega = 2.0 * np.pi * frequency_hz
    force = excitation.on(_Amplitudes(count), excitation.harmonics).coefficients(float(window.max()))[1:]
    size = np.hypot(force[0::2], force[1::2]).max(axis=0)
    elastic = omega > 0.0
    contact = rows @ modes[:, elastic]
    return estimated_moving_pairs(
        joint.contact_pairs(contact),
        omega[elastic],
        size[elastic],
        _damping_ratio(case, omega[elastic]),
        (float(window.min()), excitation.harmonics * float(window.max())),
    )


def reduced_to_moving(
    case: Case,
    structure: Structure,
    joint: Joint,
    moving: BoolArray,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> ReducedStructure:
    """The structure in the unknowns of its ``moving`` pairs, see :func:`partial_superelement`."""
    layout = joint.layout
    superelement = partial_superelement(
        structure, joint.face_pairs, joint.resting_springs, moving, layout.single_nodes, case.reduction.modes, threads,
        progress,
    )  # fmt: skip
    return replace(ReducedStructure.of_superelement(superelement, layout), moving=moving)


def _damping_ratio(case: Case, omega: FloatArray) -> FloatArray:
    """(k,) ratio of modes at circular frequencies (k,)."""
    damping = case.damping
    if damping.modal_damping_ratio is not None:
        return np.full(omega.shape, damping.modal_damping_ratio)
    return np.asarray(0.5 * ((damping.rayleigh_alpha or 0.0) / omega + (damping.rayleigh_beta or 0.0) * omega))


@dataclass(frozen=True)
class _Amplitudes:
    """The amplitudes of mass-normalised modes, as an excitation requires its unknowns."""

    size: int

    @property
    def mass(self) -> FloatArray:
        return np.eye(self.size)
