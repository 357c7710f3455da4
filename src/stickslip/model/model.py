"""From a validated case of any kind to what the solver needs: superelement, contact pairs, forces and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.core.errors import keys_of_section
from stickslip.core.plausible import suspecting
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.model.joint import FaceSettings, Joint, make_joint, odd_values
from stickslip.model.kinds import matrices as matrix_study
from stickslip.model.kinds import mesh as mesh_study
from stickslip.model.kinds import own as own_structure
from stickslip.model.kinds import two_blade
from stickslip.model.layout import Layout, Port, PortForce, Reading, Setup
from stickslip.model.solved_preload import SolvedPreload, resting_joint, resting_pairs, solve_preload
from stickslip.solve.harmonic.damping import rayleigh_damping_matrix
from stickslip.structure.cache import cached_superelement
from stickslip.structure.craig_bampton import ReductionRow, craig_bampton
from stickslip.structure.elasticity import Structure
from stickslip.structure.factor import best_backend
from stickslip.structure.finite_element_mesh import AnyMesh
from stickslip.structure.recovery import reduced_load
from stickslip.structure.superelement import Superelement

if TYPE_CHECKING:
    from stickslip.case.case import Case


class Geometry(Protocol):
    """What a module offers that finds the structure of a case and its joints."""

    def set_up(self, case: Case) -> Setup:
        """Mesh or matrices, and the layout on them. Raises InputError."""

    def find_layout(self, case: Case, mesh: AnyMesh) -> Layout:
        """The layout on a mesh that is there already. Raises InputError."""


class Kind(Protocol):
    """What a module offers that reads loads, responses and words of a case, beside what all kinds share here."""

    def preload(self, case: Case, layout: Layout) -> FloatArray:
        """(n_pairs,) N at rest. Raises InputError."""

    def face_settings(self, case: Case) -> tuple[FaceSettings, ...]:
        """Friction and stiffness of each face."""

    def forces(self, case: Case) -> tuple[PortForce, ...]:
        """The harmonic forces."""

    def static_forces(self, case: Case) -> tuple[PortForce, ...]:
        """The constant forces, beside rotation."""

    def outputs(self, case: Case) -> tuple[dict[str, Reading], dict[str, tuple[str, ...]]]:
        """Name -> what is read, the response of the curve first; heading -> names that are drawn together."""

    def force_amplitude(self, case: Case) -> float:
        """N, the force that a response is divided by where several forces are compared."""

    def description(self, case: Case) -> str:
        """One sentence on force, load and friction."""

    def rough_face_size(self, case: Case) -> tuple[float, float]:
        """m along and across a face, for a picture of its roughness."""

    def is_fitted(self, case: Case) -> bool:
        """Whether the structure is the one that was fitted to the paper's Table 2."""


_KINDS: dict[str, tuple[Geometry, Kind]] = {
    "two-blade": (two_blade, two_blade),
    "mesh": (mesh_study, own_structure),
    "matrices": (matrix_study, own_structure),
}


def kind_of(case: Case) -> Kind:
    """The module that reads the loads and responses of the case's kind of structure."""
    return _KINDS[case.structure.kind][1]


def _geometry_of(case: Case) -> Geometry:
    return _KINDS[case.structure.kind][0]


@dataclass(frozen=True)
class ReducedStructure:
    """A structure after reduction, as all cases with the same structure and layout share it.

    ports:
        name -> (3, n) rows that read the displacement x, y, z of a port; their transposes bring a force into the
        unknowns.
    body_load:
        (n,) N of the bodies at a rotation of 1 rad/s.
    mode_table:
        frequencies of the full and the reduced model with every pair closed, where they were compared.
    """

    superelement: Superelement
    ports: Mapping[str, FloatArray]
    body_load: FloatArray
    mode_table: tuple[ReductionRow, ...] = ()


@dataclass(frozen=True)
class ReducedModel:
    """What is needed to solve one case and to describe it; the mesh and its matrices are no longer part of it.

    The excitation is ``force_cos cos(w t) + force_sin sin(w t)``, (n,) N each; ``outputs`` are rows (n,);
    ``static_load`` (n,) N are the constant forces and the load of rotation; where the preload was solved from them,
    ``preload`` tells, and ``joint`` and ``pairs`` are those at rest.
    """

    superelement: Superelement
    joint: Joint
    pairs: ContactPairs
    force_cos: FloatArray
    force_sin: FloatArray
    static_load: FloatArray
    outputs: Mapping[str, FloatArray]
    signal_groups: Mapping[str, tuple[str, ...]]
    preload: SolvedPreload | None


@dataclass(frozen=True)
class Model(ReducedModel):
    """Everything that is needed to solve one case and to show it."""

    structure: Structure | Superelement


def set_up(case: Case) -> Setup:
    """The structure of a case before its matrices, with its layout. Raises InputError for what does not fit."""
    return _geometry_of(case).set_up(case)


def build_structure(case: Case) -> Structure | Superelement:
    """Matrices of the structure of a case. Raises InputError for what does not fit."""
    return set_up(case).assemble()


def build_joint(case: Case, structure: Structure) -> Joint:
    """Pairs, preload and stiffness. Raises RoughnessError where the roughness gives no usable contact."""
    return load_joint(case, _geometry_of(case).find_layout(case, structure.mesh))


def load_joint(case: Case, layout: Layout) -> Joint:
    """Preload and stiffness of given pairs. Raises RoughnessError where the roughness gives no usable contact."""
    kind = kind_of(case)
    with suspecting(odd_values(case, layout)):
        return make_joint(case, layout, kind.preload(case, layout), kind.face_settings(case))


def reduce_structure(
    case: Case,
    structure: Structure | Superelement,
    layout: Layout,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> ReducedStructure:
    """The structure in the unknowns of its contact nodes, its ports of one node and a few modes.

    A reduction that was made before comes from the disk.
    """
    if isinstance(structure, Superelement):
        superelement = structure
    else:
        nodes, n_modes = layout.boundary_nodes, case.reduction.modes
        backend = best_backend(structure.stiffness.shape[0])
        odd = odd_values(case, layout)
        with suspecting(odd), keys_of_section("reduction", {"n_modes": "modes"}):
            superelement = cached_superelement(
                structure, nodes, n_modes, lambda: craig_bampton(structure, nodes, n_modes, backend, threads, progress)
            )
    body_load = (
        np.zeros(superelement.size) if layout.body_load is None else reduced_load(superelement, layout.body_load)
    )
    return ReducedStructure(superelement, port_rows(superelement, layout), body_load)


def port_rows(superelement: Superelement, layout: Layout) -> dict[str, FloatArray]:
    """Name -> (3, n) rows that read the mean displacement x, y, z of a port."""
    return {name: _rows_of(superelement, port) for name, port in layout.ports.items()}


def _rows_of(superelement: Superelement, port: Port) -> FloatArray:
    if np.isin(port.nodes, superelement.boundary_nodes).all():
        rows = np.zeros((3, superelement.size))
        for node, share in zip(port.nodes, port.shares, strict=True):
            rows[np.arange(3), superelement.unknowns_of(int(node))] += share
        return rows
    full = np.zeros((superelement.recovery.shape[0], 3))
    for axis in range(3):
        full[3 * port.nodes + axis, axis] = port.shares
    return reduced_load(superelement, full).T


def build_model(
    case: Case,
    structure: Structure | Superelement,
    joint: Joint,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Model:
    """Reduce the structure and connect joint, forces and outputs to the reduced unknowns."""
    reduced = reduce_structure(case, structure, joint.layout, threads, progress)
    return Model(**vars(connect(case, reduced, joint)), structure=structure)


def connect(case: Case, reduced: ReducedStructure, joint: Joint) -> ReducedModel:
    """Connect joint, damping, forces and outputs of a case to a reduced structure, which several cases may share."""
    superelement, kind = reduced.superelement, kind_of(case)
    if case.damping.modal_damping_ratio is None:
        damping = rayleigh_damping_matrix(
            superelement, case.damping.rayleigh_alpha or 0.0, case.damping.rayleigh_beta or 0.0
        )
        if superelement.damping is not None:  # that of the matrix files
            damping = damping + superelement.damping
        superelement = replace(superelement, damping=damping)
    force_cos, force_sin = np.zeros(superelement.size), np.zeros(superelement.size)
    for force in kind.forces(case):
        row = np.asarray(force.direction) @ reduced.ports[force.port]
        force_cos += force.amplitude * np.sin(force.phase) * row
        force_sin += force.amplitude * np.cos(force.phase) * row
    static_load = np.zeros(superelement.size) if case.rotation is None else case.rotation.speed**2 * reduced.body_load
    for force in kind.static_forces(case):
        static_load = static_load + force.amplitude * (np.asarray(force.direction) @ reduced.ports[force.port])
    readings, groups = kind.outputs(case)
    outputs = {name: np.asarray(each.direction) @ reduced.ports[each.port] for name, each in readings.items()}
    solved = None
    if case.preload.method == "solved":
        settings = kind.face_settings(case)
        solved = solve_preload(case, joint, settings, superelement, static_load)
        joint = resting_joint(case, joint, settings, solved.state)
        pairs = resting_pairs(joint, superelement, solved.state, case.preload.residual_traction == "kept")
    else:
        pairs = ContactPairs(
            joint.face_pairs.operator(superelement),
            joint.normal_stiffness,
            joint.tangential_stiffness,
            joint.friction_coefficient,
            joint.preload,
        )
    return ReducedModel(superelement, joint, pairs, force_cos, force_sin, static_load, outputs, groups, solved)
