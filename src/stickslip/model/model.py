"""From a validated case of any kind to the input of the solver: superelement, contact pairs, forces and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import Any

import numpy as np

from stickslip.case.case import Case, CyclicCase, MatrixCase, MeshCase, TwoBladeCase
from stickslip.case.sections import DampingSection
from stickslip.contact.law.contact_pairs import ContactPairs
from stickslip.contact.pairing.face_pairs import FacePairs
from stickslip.core.errors import keys_of_section
from stickslip.core.plausible import suspecting
from stickslip.core.progress import ProgressCallback
from stickslip.core.validation import FloatArray
from stickslip.model.joint import Joint, make_joint, odd_values
from stickslip.model.kinds.cyclic import CyclicKind
from stickslip.model.kinds.kind import Kind
from stickslip.model.kinds.matrices import MatrixKind
from stickslip.model.kinds.mesh import MeshKind
from stickslip.model.kinds.two_blade import TwoBladeKind
from stickslip.model.layout import Layout, NodeGroup, Setup
from stickslip.model.solved_preload import SolvedPreload, resting_joint, solve_preload
from stickslip.solve.excitation import Excitation
from stickslip.solve.harmonic.damping import rayleigh_damping_matrix
from stickslip.structure.cache import cached_superelement
from stickslip.structure.craig_bampton import ReductionRow, craig_bampton
from stickslip.structure.cyclic_sector import CyclicSector
from stickslip.structure.elasticity import Structure
from stickslip.structure.factor import best_backend
from stickslip.structure.recovery import reduced_load
from stickslip.structure.sector_structure import SectorStructure
from stickslip.structure.superelement import Superelement

Substructure = Superelement | CyclicSector
AnyStructure = Structure | Superelement | SectorStructure

# Class of the cases of a kind -> the kind; a further kind is one more file in ``kinds`` and one more line here.
KINDS: dict[type[Case], Kind[Any]] = {
    TwoBladeCase: TwoBladeKind(),
    MeshCase: MeshKind(),
    MatrixCase: MatrixKind(),
    CyclicCase: CyclicKind(),
}


def kind_of(case: Case) -> Kind[Any]:
    """The kind of the case's structure."""
    return KINDS[type(case)]


@dataclass(frozen=True)
class ReducedStructure:
    """A structure after reduction, common to all cases with the same structure and layout.

    substructure:
        the matrices: a superelement, or a sector of a disk.
    ports:
        name -> (3, n) rows of the displacement x, y, z of a node group; their transposes apply a force to the unknowns.
    body_load:
        (n,) N of the bodies at a rotation of 1 rad/s.
    base_inertia:
        (n, 3) kg, the force that resists an acceleration of the support of 1 m/s2 along x, y, z; None if it is fixed.
    mode_table:
        frequencies of the full and the reduced model with every pair closed, if the study compares them.
    """

    substructure: Substructure
    node_groups: Mapping[str, FloatArray]
    body_load: FloatArray
    base_inertia: FloatArray | None = None
    mode_table: tuple[ReductionRow, ...] = ()

    def without_recovery(self) -> ReducedStructure:
        """Without what only the motion of the mesh requires, to send it to a worker."""
        if isinstance(self.substructure, CyclicSector):
            return replace(self, substructure=self.substructure.without_modes())
        return replace(self, substructure=replace(self.substructure, recovery=None))


@dataclass(frozen=True)
class ReducedModel:
    """Data to solve one case and to describe it, without the mesh and its matrices.

    ``outputs`` are rows (n,); ``static_load`` (n,) N are the constant forces and the load of rotation; if the preload
    was solved from them, ``preload`` contains the state at rest, and ``joint`` and ``pairs`` are those of this state.
    Cases with other joints or forces share the ``reduced`` structure. The unknowns of a sector are those of this sector
    and of the next one.
    """

    substructure: Substructure
    joint: Joint
    pairs: ContactPairs
    excitation: Excitation
    static_load: FloatArray
    outputs: Mapping[str, FloatArray]
    signal_groups: Mapping[str, tuple[str, ...]]
    preload: SolvedPreload | None
    reduced: ReducedStructure

    @property
    def superelement(self) -> Superelement:
        """The matrices of a structure. Raises InputError for a sector of a disk, which has no single ones."""
        if isinstance(self.substructure, CyclicSector):
            raise self.substructure.no_structure()
        return self.substructure


@dataclass(frozen=True)
class Model(ReducedModel):
    """Data to solve one case and to show it."""

    structure: AnyStructure


def set_up(case: Case) -> Setup:
    """The structure of a case before its matrices, with its layout. Raises InputError for entries that do not fit."""
    return kind_of(case).set_up(case)


def build_structure(case: Case) -> AnyStructure:
    """Matrices of the structure of a case. Raises InputError for entries that do not fit."""
    return set_up(case).assemble()


def build_joint(case: Case, structure: Structure) -> Joint:
    """Pairs, preload and stiffness. Raises RoughnessError where the roughness gives no usable contact."""
    return load_joint(case, kind_of(case).find_layout(case, structure.mesh))


def load_joint(case: Case, layout: Layout) -> Joint:
    """Preload and stiffness of the pairs of a layout. Raises RoughnessError where the roughness gives no usable
    contact."""
    kind = kind_of(case)
    with suspecting(odd_values(case, layout)):
        return make_joint(case, layout, kind.preload(case, layout), kind.face_settings(case))


def reduce_structure(
    case: Case,
    structure: AnyStructure,
    layout: Layout,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> ReducedStructure:
    """The structure in the unknowns of its contact nodes, its groups of one node and a few modes.

    An earlier reduction is read from the disk.
    """
    if isinstance(structure, SectorStructure):
        with suspecting(odd_values(case, layout)), keys_of_section("reduction", {"n_modes": "modes"}):
            sector = structure.reduced(layout.boundary_nodes, case.reduction.modes, threads, progress)
        rows = {name: sector_rows(sector, each) for name, each in layout.node_groups.items()}
        return ReducedStructure(sector, rows, np.zeros(2 * sector.size))
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
    inertia = None if layout.base_inertia is None else reduced_load(superelement, layout.base_inertia)
    return ReducedStructure(superelement, node_group_rows(superelement, layout), body_load, inertia)


def node_group_rows(superelement: Superelement, layout: Layout) -> dict[str, FloatArray]:
    """Name -> (3, n) rows of the mean displacement x, y, z of a node group."""
    return {name: _rows_of(superelement, node_group) for name, node_group in layout.node_groups.items()}


def sector_rows(sector: CyclicSector, node_group: NodeGroup) -> FloatArray:
    """(3, 2n) rows of the mean displacement x, y, z of nodes of a sector, in its own axes."""
    assert sector.symmetry is not None  # that of cyclic_sector
    rows = np.zeros((3, 2 * sector.size))
    home, ahead = sector.symmetry.homes(node_group.nodes)
    for node, is_ahead, weight in zip(home, ahead, node_group.weights, strict=True):
        rows += weight * np.array([sector.selector(int(node), axis, of_next=bool(is_ahead)) for axis in np.eye(3)])
    return rows


def _rows_of(superelement: Superelement, node_group: NodeGroup) -> FloatArray:
    if node_group.blocks is None and np.isin(node_group.nodes, superelement.boundary_nodes).all():
        rows = np.zeros((3, superelement.size))
        for node, share in zip(node_group.nodes, node_group.weights, strict=True):
            rows[np.arange(3), superelement.unknowns_of(int(node))] += share
        return rows
    return reduced_load(superelement, node_group.unit_loads(superelement.recovery.shape[0])).T


def build_model(
    case: Case,
    structure: AnyStructure | None = None,
    joint: Joint | None = None,
    threads: int = 1,
    progress: ProgressCallback | None = None,
) -> Model:
    """The model of a case: superelement, contact pairs, excitation, and outputs by name.

    ``model.outputs["tip"] @ response.displacement`` is an output. ``structure`` and ``joint`` are those of the case, if
    they already exist; ``threads`` is for the reduction, and ``progress`` receives the finished fraction. Raises
    InputError for entries that do not fit, RoughnessError where the roughness gives no usable contact, and
    ConvergenceError if the solution of the preload does not converge.
    """
    if structure is None or joint is None:
        setup = set_up(case)
        structure, joint = structure or setup.assemble(), joint or load_joint(case, setup.layout)
    reduced = reduce_structure(case, structure, joint.layout, threads, progress)
    return Model(**vars(connect(case, reduced, joint)), structure=structure)


def connect(case: Case, reduced: ReducedStructure, joint: Joint) -> ReducedModel:
    """Connect joint, damping, forces and outputs of a case to a reduced structure, which may belong to several
    cases."""
    substructure, kind = reduced.substructure, kind_of(case)
    if case.damping.modal_damping_ratio is None:
        substructure = _with_rayleigh_damping(substructure, case.damping)
    excitation = make_excitation(case, reduced.node_groups, reduced.base_inertia)
    static_load = make_static_load(case, reduced.node_groups, reduced.body_load)
    named_outputs, groups = kind.outputs(case)
    outputs = {
        name: np.asarray(each.direction) @ reduced.node_groups[each.node_group] for name, each in named_outputs.items()
    }
    solved = None
    if case.preload.method == "solved" and isinstance(substructure, Superelement):
        settings = kind.face_settings(case)
        solved = solve_preload(case, joint, settings, substructure, static_load)
        pairs = solved.pairs_about(solved.state, case.preload.residual_traction == "kept")
        joint = resting_joint(case, joint, settings, solved.state, pairs)
    else:
        pairs = joint.contact_pairs(_operator(substructure, joint.face_pairs))
    return ReducedModel(substructure, joint, pairs, excitation, static_load, outputs, groups, solved, reduced)


def _with_rayleigh_damping(substructure: Substructure, section: DampingSection) -> Substructure:
    """With the damping of the study beside that of matrix files."""
    factors = section.rayleigh_alpha or 0.0, section.rayleigh_beta or 0.0
    if isinstance(substructure, CyclicSector):
        return substructure.with_rayleigh_damping(*factors)
    damping = rayleigh_damping_matrix(substructure, *factors)
    if substructure.damping is not None:  # that of the matrix files
        damping = damping + substructure.damping
    return replace(substructure, damping=damping)


def _operator(substructure: Substructure, pairs: FacePairs) -> FloatArray:
    """(3 * n_pairs, n) relative displacements t1, t2, n of pairs; (3 * n_pairs, 2n) on a sector."""
    return substructure.operator(pairs) if isinstance(substructure, CyclicSector) else pairs.operator(substructure)


def make_static_load(case: Case, node_groups: Mapping[str, FloatArray], body_load: FloatArray) -> FloatArray:
    """(n,) N of the constant forces and of rotation, on the unknowns of ``node_groups``, name -> rows (3, n).

    ``body_load`` (n,) N is that of the bodies at a rotation of 1 rad/s.
    """
    kind = kind_of(case)
    load = kind.rotation_speed(case) ** 2 * body_load
    for force in kind.static_forces(case):
        load = load + force.amplitude * (np.asarray(force.direction) @ node_groups[force.node_group])
    return load


def make_excitation(case: Case, node_groups: Mapping[str, FloatArray], base_inertia: FloatArray | None) -> Excitation:
    """The excitation of a case on the unknowns of ``node_groups``, name -> rows (3, n).

    ``base_inertia`` (n, 3) kg resists an acceleration of the support of 1 m/s2 along x, y, z.
    """
    kind = kind_of(case)
    forces, motion = kind.forces(case), kind.base_motion(case)
    parts = []
    if forces:
        size = next(iter(node_groups.values())).shape[1]
        shape = (size, max(force.harmonic for force in forces))
        cosine, sine = np.zeros(shape), np.zeros(shape)
        for force in forces:
            row = np.asarray(force.direction) @ node_groups[force.node_group]
            cosine[:, force.harmonic - 1] += force.amplitude * np.sin(force.phase) * row
            sine[:, force.harmonic - 1] += force.amplitude * np.cos(force.phase) * row
        wave = kind.wave(case)
        parts.append(
            Excitation.force(cosine, sine)
            if wave is None
            else Excitation.travelling_wave(wave.engine_order, cosine, sine, wave.direction)
        )
    for each in kind.unbalances(case):
        first, second = (across @ node_groups[each.node_group] for across in each.turning)
        parts.append(Excitation.unbalance(first, second, each.mass_times_radius))
    if motion is not None and base_inertia is not None:
        carried = base_inertia @ np.asarray(motion.direction)
        parts.append(Excitation.carried_base_motion(carried, motion.amplitude, motion.kind))
    return reduce(add, parts)
